// SPDX-License-Identifier: MIT
// Exact contacts, and pairs of spheres found and confirmed by them, from vertices and from bones; once more through the
// C API, on another target.
#include <algorithm>

#include "fuzz_case.h"
#include "spherechain/confirm.h"
#include "spherechain/detect_skin.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::test {
namespace {

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
    case 7:
      job.scope = draw_none<ContactScope>(c, 3);
      return spoiled.with(Status::kBadArgument);
    default:
      if (job.context != nullptr && job.pairs.size > 0) {
        job.pairs.data = reinterpret_cast<TrianglePair*>(job.context->words.data);
        spoiled.with(Status::kSharedMemory);
      }
  }
}

void spoil(Case& c, DetectSkinJob& job, Filter& filter, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
      job.asset = &c.closed;
      return spoiled.with(Status::kNotOpen);
    case 1:
      job.context = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 2:
      job.filter = &filter;
      if (filter.ignored.data == nullptr) filter = draw_filter(c);
      return spoil_filter(c, filter, spoiled);
    case 3:
      job.pairs.data = c.arena.add<Pair>(job.pairs.size + 1);
      put_askew(c, job.pairs.data);
      return spoiled.with(Status::kMisaligned);
    case 4:
      if (job.context != nullptr) {
        job.context->words.size = c.random.up_to(job.context->words.size - 1);
        spoiled.with(Status::kContextTooSmall);
      }
      return;
    default:
      if (job.context != nullptr && job.pairs.size > 0) {
        job.pairs.data = reinterpret_cast<Pair*>(job.context->words.data);
        spoiled.with(Status::kSharedMemory);
      }
  }
}

void spoil(Case& c, ConfirmJob& job, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
      job.asset = &c.closed;
      return spoiled.with(Status::kNotOpen);
    case 1:
      job.context = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 2:
      job.candidates = {nullptr, 1};
      return spoiled.with(Status::kNullArgument);
    case 3:
      job.pairs.data = c.arena.add<Pair>(job.pairs.size + 1);
      put_askew(c, job.pairs.data);
      return spoiled.with(Status::kMisaligned);
    case 4: {
      const auto bad = static_cast<std::uint32_t>(c.asset.spheres().size + c.random.below(1000));
      Pair* pair = c.arena.add<Pair>(1);
      *pair = c.random.one_in(2) ? Pair{bad, 0} : Pair{0, bad};
      job.candidates = {pair, 1};
      return spoiled.with(Status::kBadArgument);
    }
    default:
      if (job.context != nullptr && job.pairs.size > 0) {
        job.pairs.data = reinterpret_cast<Pair*>(job.context->words.data);
        spoiled.with(Status::kSharedMemory);
      }
  }
}

// Of an asset with vertices.
template <typename Job>
void draw_pose(Case& c, Job& job) {
  const std::size_t needed = c.asset.info().source_vertex_count;
  if (c.asset.bone_count() > 0 && c.random.one_in(2)) {
    float* matrices = c.arena.add<float>(12 * c.asset.bone_count());
    std::generate(matrices, matrices + 12 * c.asset.bone_count(), [&] { return c.random.figure(); });
    job.bones = {matrices, c.asset.bone_count()};
    return;
  }
  job.stride = 12 + 4 * (c.random.one_in(2) ? 0 : c.random.below(8));
  job.vertex_count = needed;
  const std::size_t floats = (needed - 1) * job.stride / sizeof(float) + 3;
  float* positions = c.arena.add<float>(floats);
  fill_figures(c, positions, floats);
  job.positions = positions;
}

// The same call on another target.
template <typename CJob, typename Job>
CJob to_c_job(Case& c, const Job& job, CJob out) {
  out.asset = job.asset == &c.closed ? c.c_closed : c.c_asset;
  out.positions = job.positions;
  out.vertex_count = job.vertex_count;
  out.stride = job.stride;
  out.bones = {job.bones.data, job.bones.count, job.bones.stride, static_cast<sc_matrix_layout>(job.bones.layout), 0};
  out.morph_weights = job.morph_weights.data;
  out.morph_weight_count = job.morph_weights.size;
  out.target = static_cast<sc_target>(draw_target(c));
  out.scratch = job.context == nullptr ? nullptr : job.context->words.data;
  out.scratch_words = job.context == nullptr ? 0 : job.context->words.size;
  return out;
}

// False where there is nothing to ask about, or too much.
bool draw_skin(Case& c) {
  if (!draw_asset(c)) {
    return false;
  }
  const std::size_t vertices = c.asset.info().source_vertex_count;
  return vertices > 0 && vertices <= kMostVertices &&
         TriangleContactContext::words_needed(c.asset) <= (std::size_t{1} << 17);
}

}  // namespace

void fuzz_triangle_contacts(Case& c) {
  if (!draw_skin(c)) {
    return;
  }
  const std::size_t words = TriangleContactContext::words_needed(c.asset);
  TriangleContactJob job;
  Spoiled spoiled;
  job.asset = &c.asset;
  job.target = draw_target(c);
  TriangleContactContext context{{c.arena.add<std::uint64_t>(words), words}};
  job.context = &context;
  draw_pose(c, job);
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
    spoil_some(c, 9, [&](std::uint32_t way) { spoil(c, job, filter, way, spoiled); });
  }
  if (spoiled.count == 0) {
    job.scope = static_cast<ContactScope>(c.random.below(3));
  }
  sc_triangle_contact_job c_job = to_c_job(c, job, sc_triangle_contact_job SC_TRIANGLE_CONTACT_JOB_INIT);
  const sc_filter c_filter = to_c(filter);
  c_job.filter = job.filter == nullptr ? nullptr : &c_filter;
  c_job.scope = static_cast<sc_contact_scope>(job.scope);
  c_job.pairs = reinterpret_cast<sc_triangle_pair*>(job.pairs.data);
  c_job.pair_capacity = job.pairs.size;
  c_job.contacts = reinterpret_cast<sc_triangle_contact*>(job.contacts.data);
  c_job.contact_capacity = job.contacts.size;
  c_job.sphere_contacts = reinterpret_cast<sc_sphere_contact*>(job.sphere_contacts.data);
  c_job.sphere_contact_capacity = job.sphere_contacts.size;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_triangle_contacts(&c_job); },
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
  c.expect(c_job.pair_count == job.pair_count && c_job.sphere_contact_count == job.sphere_contact_count,
           "the C API, or another target, counts something else");
  const std::size_t written = std::min(job.pairs.size, job.pair_count);
  if (spoiled.count == 0) {
    c.expect(std::is_sorted(job.pairs.data, job.pairs.data + written), "pairs that are not sorted");
  }
}

void fuzz_detect_skin(Case& c) {
  if (!draw_skin(c)) {
    return;
  }
  const std::size_t words = TriangleContactContext::words_needed(c.asset);
  DetectSkinJob job;
  Spoiled spoiled;
  job.asset = &c.asset;
  job.target = draw_target(c);
  TriangleContactContext context{{c.arena.add<std::uint64_t>(words), words}};
  job.context = &context;
  draw_pose(c, job);
  job.pairs.size = c.random.below(20);
  job.pairs.data = c.arena.add<Pair>(job.pairs.size);
  Filter filter;
  if (c.random.one_in(2)) {
    filter = draw_filter(c);
    job.filter = &filter;
  }
  if (c.asset.leaf_count() == 0) {
    spoiled.with(Status::kNotInAsset);
  } else {
    spoil_some(c, 6, [&](std::uint32_t way) { spoil(c, job, filter, way, spoiled); });
  }
  sc_detect_skin_job c_job = to_c_job(c, job, sc_detect_skin_job SC_DETECT_SKIN_JOB_INIT);
  const sc_filter c_filter = to_c(filter);
  c_job.filter = job.filter == nullptr ? nullptr : &c_filter;
  c_job.pairs = reinterpret_cast<sc_pair*>(job.pairs.data);
  c_job.pair_capacity = job.pairs.size;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_detect_skin(&c_job); },
      [&](Status) {
        return std::vector<Bytes>{bytes_of(job.pairs.data, std::min(job.pairs.size, job.pair_count)),
                                  bytes_of(context.words.data, words)};
      },
      [&](bool ran) {
        if (ran) {
          std::fill(context.words.begin(), context.words.end(), std::uint64_t{0});  // scratch: anything
        }
      });
  c.expect(c_job.pair_count == job.pair_count, "the C API, or another target, finds something else");
  const std::size_t written = std::min(job.pairs.size, job.pair_count);
  if (spoiled.count == 0) {
    c.expect(std::is_sorted(job.pairs.data, job.pairs.data + written), "pairs that are not sorted");
  }
}

void fuzz_confirm(Case& c) {
  if (!draw_skin(c)) {
    return;
  }
  const std::size_t words = TriangleContactContext::words_needed(c.asset), spheres = c.asset.spheres().size;
  ConfirmJob job;
  Spoiled spoiled;
  job.asset = &c.asset;
  job.target = draw_target(c);
  TriangleContactContext context{{c.arena.add<std::uint64_t>(words), words}};
  job.context = &context;
  draw_pose(c, job);
  if (spheres > 1) {
    const std::size_t count = c.random.below(40);
    Pair* candidates = c.arena.add<Pair>(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto a = static_cast<std::uint32_t>(c.random.below(static_cast<std::uint32_t>(spheres)));
      const auto step = 1 + c.random.below(static_cast<std::uint32_t>(spheres - 1));
      candidates[i] = {a, static_cast<std::uint32_t>((a + step) % spheres)};
    }
    job.candidates = {candidates, count};
  }
  job.pairs.size = c.random.below(20);
  job.pairs.data = c.arena.add<Pair>(job.pairs.size);
  if (c.asset.leaf_count() == 0) {
    spoiled.with(Status::kNotInAsset);
  } else {
    spoil_some(c, 6, [&](std::uint32_t way) { spoil(c, job, way, spoiled); });
  }
  sc_confirm_job c_job = to_c_job(c, job, sc_confirm_job SC_CONFIRM_JOB_INIT);
  c_job.candidates = reinterpret_cast<const sc_pair*>(job.candidates.data);
  c_job.candidate_count = job.candidates.size;
  c_job.pairs = reinterpret_cast<sc_pair*>(job.pairs.data);
  c_job.pair_capacity = job.pairs.size;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_confirm(&c_job); },
      [&](Status) {
        return std::vector<Bytes>{bytes_of(job.pairs.data, std::min(job.pairs.size, job.pair_count)),
                                  bytes_of(context.words.data, words)};
      },
      [&](bool ran) {
        if (ran) {
          std::fill(context.words.begin(), context.words.end(), std::uint64_t{0});  // scratch: anything
        }
      });
  c.expect(c_job.pair_count == job.pair_count, "the C API, or another target, confirms something else");
  c.expect(job.pair_count <= job.candidates.size || spoiled.count > 0, "more confirmed than asked about");
}

}  // namespace spherechain::test
