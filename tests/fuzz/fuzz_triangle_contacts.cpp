// SPDX-License-Identifier: MIT
// Exact contacts, from vertices and from bones; once more on another target.
#include <algorithm>

#include "fuzz_case.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kMostVertices = 20000;  // a changed asset may ask for more

void spoil(Case& c, TriangleContactJob& job, Filter& filter, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
      job.asset = &c.closed;
      return spoiled.with(Status::kNotOpen);
    case 1:
      job.context = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 2:
      if (job.context != nullptr) {
        job.context->words.size = c.random.up_to(job.context->words.size - 1);
        spoiled.with(Status::kContextTooSmall);
      }
      return;
    case 3:
      job.pairs = {nullptr, 1};
      return spoiled.with(Status::kNullArgument);
    case 4:
      job.filter = &filter;
      if (filter.ignored.data == nullptr) filter = draw_filter(c);
      return spoil_filter(c, filter, spoiled);
    case 5:
      job.contacts.data = c.arena.add<TriangleContact>(job.contacts.size + 1);
      put_askew(c, job.contacts.data);
      return spoiled.with(Status::kMisaligned);
    case 6:
      if (job.positions != nullptr) {
        job.vertex_count = 0;
        spoiled.with(Status::kTooFewVertices);
      }
      return;
    default:
      if (job.context != nullptr && job.pairs.size > 0) {
        job.pairs.data = reinterpret_cast<TrianglePair*>(job.context->words.data);
        spoiled.with(Status::kSharedMemory);
      }
  }
}

}  // namespace

void fuzz_triangle_contacts(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  const std::size_t needed = c.asset.info().source_vertex_count;
  const std::size_t words = TriangleContactContext::words_needed(c.asset);
  if (needed == 0 || needed > kMostVertices || words > (std::size_t{1} << 17)) {
    return;
  }
  TriangleContactJob job;
  Spoiled spoiled;
  job.asset = &c.asset;
  job.target = draw_target(c);
  TriangleContactContext context{{c.arena.add<std::uint64_t>(words), words}};
  job.context = &context;
  const bool from_bones = c.asset.bone_count() > 0 && c.random.one_in(2);
  if (from_bones) {
    float* matrices = c.arena.add<float>(12 * c.asset.bone_count());
    std::generate(matrices, matrices + 12 * c.asset.bone_count(), [&] { return c.random.figure(); });
    job.bones = {matrices, c.asset.bone_count()};
  } else {
    job.stride = 12 + 4 * (c.random.one_in(2) ? 0 : c.random.below(8));
    job.vertex_count = needed;
    const std::size_t floats = (needed - 1) * job.stride / sizeof(float) + 3;
    float* positions = c.arena.add<float>(floats);
    fill_figures(c, positions, floats);
    job.positions = positions;
  }
  job.pairs.size = c.random.below(300);
  job.pairs.data = c.arena.add<TrianglePair>(job.pairs.size);
  job.contacts.size = c.random.below(300);
  job.contacts.data = c.arena.add<TriangleContact>(job.contacts.size);
  job.sphere_contacts.size = c.random.below(20);
  job.sphere_contacts.data = c.arena.add<SphereContact>(job.sphere_contacts.size);
  Filter filter;
  if (c.random.one_in(2)) {
    filter = draw_filter(c);
    job.filter = &filter;
  }
  if (c.asset.leaf_count() == 0) {
    spoiled.with(Status::kNotInAsset);
  } else {
    spoil_some(c, 8, [&](std::uint32_t way) { spoil(c, job, filter, way, spoiled); });
  }
  TriangleContactJob again = job;
  again.target = draw_target(c);
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return again.run(); },
      [&](Status) {
        return std::vector<Bytes>{
            bytes_of(job.pairs.data, std::min(job.pairs.size, job.pair_count)),
            bytes_of(job.contacts.data, std::min(job.contacts.size, job.pair_count)),
            bytes_of(job.sphere_contacts.data, std::min(job.sphere_contacts.size, job.sphere_contact_count)),
            bytes_of(context.words.data, words)};
      },
      [&](bool ran) {
        if (ran) {
          std::fill(context.words.begin(), context.words.end(), std::uint64_t{0});  // scratch: anything
        }
      });
  c.expect(again.pair_count == job.pair_count && again.sphere_contact_count == job.sphere_contact_count,
           "the other target counts something else");
  const std::size_t written = std::min(job.pairs.size, job.pair_count);
  if (spoiled.count == 0) {
    c.expect(std::is_sorted(job.pairs.data, job.pairs.data + written), "pairs that are not sorted");
  }
}

}  // namespace spherechain::test
