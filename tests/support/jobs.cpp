// SPDX-License-Identifier: MIT
#include "jobs.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_inputs.h"

namespace spherechain::test {
namespace {

constexpr std::uint64_t kDirty = 0xDDDDDDDDDDDDDDDD;

Refitted run_refit(const Asset& asset, const Pose& pose, Radius radius, Target target) {
  Refitted result{{}, std::vector<Sphere>(sc_asset_get_info(&asset).sphere_count)};
  RefitJob job;
  job.asset = &asset;
  job.pose = pose;
  job.radius = radius;
  job.target = target;
  job.spheres = result.spheres.data();
  job.sphere_capacity = result.spheres.size();
  result.status = job.run();
  return result;
}

}  // namespace

Refitted refit(const Asset& asset, const std::vector<float>& vertices, Radius radius, std::size_t stride) {
  Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() * sizeof(float) / stride;
  pose.vertex_stride = stride;
  return run_refit(asset, pose, radius, SC_TARGET_BEST);
}

Refitted refit(const Asset& asset, const Pose& pose, Radius radius, Target target) {
  return run_refit(asset, pose, radius, target);
}

namespace {

// With a table the job finds all that it found without: `job` has run and `expected` is its buffers.
bool is_same_by_table(DetectJob job, const Detected& expected) {
  std::vector<std::uint64_t> table(detect_table_words(job.asset), kDirty);
  if (prepare_detect(job.asset, job.radius, job.filter, table.data(), table.size()) != SC_OK) {
    return false;
  }
  Detected found = expected;
  std::fill(found.pairs.begin(), found.pairs.end(), Pair{77, 77});
  std::fill(found.bits.begin(), found.bits.end(), kDirty);
  job.table = table.data();
  job.filter = nullptr;
  job.pairs = found.pairs.data();
  job.bits = found.bits.data();
  const auto is_same = [&](sc_code code) {
    return job.run() == code && job.pair_count == expected.pairs.size() && same_bits(found.pairs, expected.pairs) &&
           same_bits(found.bits, expected.bits);
  };
  if (!is_same(SC_OK) || job.pair_capacity < 2) {
    return job.pair_capacity < 2;
  }
  // A list one short is as far as it goes the same.
  found.pairs.back() = expected.pairs.back();
  --job.pair_capacity;
  return is_same(SC_OVERFLOW);
}

}  // namespace

Detected detect(const Asset& asset, const std::vector<Sphere>& spheres, Radius radius, Target target,
                const Filter* filter) {
  DetectJob job;
  job.asset = &asset;
  job.spheres = spheres.data();
  job.sphere_count = spheres.size();
  job.radius = radius;
  job.target = target;
  job.filter = filter;
  Detected result{job.run(), {}, {}};
  if (result.status != SC_OK) {
    return result;
  }
  result.pairs.resize(job.pair_count);
  result.bits.assign(sc_pair_words(&asset), kDirty);
  job.bits = result.bits.data();
  job.bit_words = result.bits.size();
  job.pairs = result.pairs.data();
  job.pair_capacity = result.pairs.size();
  result.status = job.run();
  if (result.status == SC_OK && !is_same_by_table(job, result)) {
    result.status = {SC_CORRUPT, SC_FIELD_TABLE};
  }
  return result;
}

PreparedSkin::PreparedSkin(const Asset& asset) : words(skin_table_words(&asset), kDirty) {
  status = prepare_skin(&asset, words.data(), words.size());
  if (status == SC_OK) {
    status = read_skin_table(view_of(asset), words.data(), surface);
  }
}

std::vector<float> skin(const Asset& asset, const Pose& pose, Target target) {
  const PreparedSkin table(asset);
  std::vector<float> vertices(3 * view_of(asset).vertex_count(), std::numeric_limits<float>::quiet_NaN());
  Target resolved = target;
  if (table.status == SC_OK && resolve_target(target, resolved)) {
    skin_surface(table.surface, pose, resolved, vertices.data(), 3);
  }
  return vertices;
}

namespace {

template <typename Job>
SkinContacts find_all(Job job, std::size_t scratch_words) {
  std::vector<std::uint64_t> scratch(scratch_words, kDirty);
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  SkinContacts out;
  out.status = job.run();
  if (out.status != SC_OK) {
    return out;
  }
  out.parts.resize(job.part_count);
  out.spheres.resize(job.sphere_count);
  out.triangles.resize(job.triangle_count);
  job.parts = job.spheres_only != 0 ? nullptr : out.parts.data();
  job.part_capacity = out.parts.size();
  job.spheres = out.spheres.data();
  job.sphere_capacity = out.spheres.size();
  job.triangles = job.spheres_only != 0 ? nullptr : out.triangles.data();
  job.triangle_capacity = out.triangles.size();
  out.status = job.run();
  if (out.status == SC_OK && (job.part_count != out.parts.size() || job.sphere_count != out.spheres.size() ||
                              job.triangle_count != out.triangles.size())) {
    out.status = {SC_CORRUPT, SC_FIELD_NONE};
  }
  return out;
}

}  // namespace

namespace {

// Prepares the skin table if the job has none.
std::unique_ptr<PreparedSkin> prepare(const Asset* asset, const std::uint64_t*& skin_table) {
  if (skin_table != nullptr || asset == nullptr) return nullptr;
  auto made = std::make_unique<PreparedSkin>(*asset);
  skin_table = made->words.data();
  return made;
}

}  // namespace

SkinContacts find_contacts(SkinContactJob job) {
  const auto table = prepare(job.asset, job.skin_table);
  return find_all(job, skin_scratch_words(job.asset));
}

SkinContacts find_contacts(BodyContactJob job) {
  const auto a = prepare(job.a.asset, job.a.skin_table), b = prepare(job.b.asset, job.b.skin_table);
  return find_all(job, body_scratch_words(job.a.asset, job.b.asset));
}

const StepContact* StepContacts::of(std::uint32_t part_a, std::uint32_t part_b) const {
  for (const StepContact& contact : contacts) {
    if (contact.part_a == part_a && contact.part_b == part_b) return &contact;
  }
  return nullptr;
}

StepContacts find_contacts(StepJob job) {
  const auto a = prepare(job.a.body.asset, job.a.body.skin_table), b = prepare(job.b.body.asset, job.b.body.skin_table);
  const bool has_two = job.b.body.asset != nullptr;
  std::vector<std::uint64_t> scratch(step_scratch_words(&job.a, has_two ? &job.b : nullptr), kDirty);
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  StepContacts out;
  out.status = job.run();
  if (out.status != SC_OK) return out;
  out.contacts.resize(job.contact_count);
  job.contacts = out.contacts.data();
  job.contact_capacity = out.contacts.size();
  out.status = job.run();
  return out;
}

namespace {

template <typename Job>
std::vector<Penetration> measure_all(Job job, std::size_t scratch_words, Target target) {
  std::vector<std::uint64_t> scratch(scratch_words, kDirty);
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.target = target;
  std::vector<Penetration> out;
  if (job.run() == SC_OK) {
    out.resize(job.penetration_count);
    job.penetrations = out.data();
    job.penetration_capacity = out.size();
    out.resize(job.run() == SC_OK ? out.size() : 0);
  }
  return out;
}

}  // namespace

std::vector<Penetration> measure(PenetrationJob job, Target target) {
  const PreparedSkin table(*job.asset);
  job.skin_table = table.words.data();
  return measure_all(job, penetration_scratch_words(job.asset, job.contact_count), target);
}

std::vector<Penetration> measure(BodyPenetrationJob job, Target target) {
  const PreparedSkin a(*job.a.asset), b(*job.b.asset);
  job.a.skin_table = a.words.data();
  job.b.skin_table = b.words.data();
  return measure_all(job, body_penetration_scratch_words(job.a.asset, job.b.asset, job.contact_count), target);
}

std::vector<std::uint16_t> find_inside(const Asset& asset, const Pose& pose, Target target) {
  const Refitted spheres = refit(asset, pose, SC_RADIUS_DETECT, target);
  const Detected pairs = detect(asset, spheres.spheres, SC_RADIUS_DETECT, target);
  const PreparedSkin skin(asset);
  std::vector<std::uint16_t> out(probe_count(view_of(asset)));
  std::vector<std::uint64_t> scratch(inside_scratch_words(view_of(asset), view_of(asset)));
  std::vector<Pair> of_pairs = pairs.pairs;
  InsideJob job;
  job.body.asset = job.skin.asset = &asset;
  job.body.pose = job.skin.pose = pose;
  job.body.skin_table = job.skin.skin_table = skin.words.data();
  resolve_target(target, job.target);
  job.centers = {spheres.spheres.data(), spheres.spheres.size()};
  job.pairs = {of_pairs.data(), of_pairs.size()};
  job.scratch = scratch.data();
  job.part = {out.data(), out.size()};
  job.run();
  return out;
}

}  // namespace spherechain::test
