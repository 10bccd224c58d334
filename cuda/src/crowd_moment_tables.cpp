// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "crowd_table_parts.h"

namespace spherechain::cuda {
namespace {

// Where the asset has a sphere's bones and pairs.
struct alignas(16) Member {
  std::uint32_t sphere, bone_count;
  std::uint32_t first_bone, first_pair;
};

class RunWriter {
 public:
  RunWriter(const Asset& asset, RadiusKind kind, const std::uint32_t* bone_indices)
      : tables_(asset.moment_tables()), rest_(asset.spheres()), kind_(kind), bone_indices_(bone_indices) {}

  const std::uint16_t* bones_of(const Member& member) const { return tables_.bones.data + member.first_bone; }

  bool are_equal(const Member& a, const Member& b) const {
    return std::equal(bones_of(a), bones_of(a) + a.bone_count, bones_of(b), bones_of(b) + b.bone_count);
  }
  bool are_sorted(const Member& a, const Member& b) const {
    const std::uint16_t *l = bones_of(a), *r = bones_of(b);
    const bool equal = are_equal(a, b);
    return equal ? a.sphere < b.sphere : std::lexicographical_compare(l, l + a.bone_count, r, r + b.bone_count);
  }

  // Writes a run of one or two of the same bones.
  void add(const Member* members, std::uint32_t count) {
    MomentRun& run = runs[run_count_++];
    const std::uint32_t bones = members[0].bone_count, mask = (1U << count) - 1;
    run = {step_count_, moment_count_, bone_count_, center_count_, bones, count, count == kRunSpheres ? 1U : 0U, 0, {},
           {}};
    for (std::uint32_t s = 0; s < count; ++s) {
      const RestSphere& rest = rest_[members[s].sphere];
      run.spheres[s] = members[s].sphere;
      run.wanted[s] = kind_ == RadiusKind::kFit ? rest.radius : rest.detect_radius;
    }
    std::uint32_t pair = 0;
    for (std::uint32_t i = 0; i < bones; ++i) {
      run_bones[bone_count_++] = matrix_of(members[0], i) | mask;
      for (std::uint32_t s = 0; s < count; ++s) {
        const CenterTerm& term = tables_.centers[members[s].first_bone + i];
        center_terms[center_count_++] = {term.x, term.y, term.z, term.w};
      }
      for (std::uint32_t j = i; j < bones; ++j, ++pair) {
        steps[step_count_++] = matrix_of(members[0], j) | mask | (j + 1 == bones ? kLastStep : 0);
        for (std::uint32_t s = 0; s < count; ++s) {
          add_moment(tables_.moments[members[s].first_pair + pair]);
        }
      }
    }
  }

  std::uint32_t run_count() const { return run_count_; }

  MomentRun* runs = nullptr;
  std::uint32_t* steps = nullptr;
  Float4* moments = nullptr;
  std::uint32_t* run_bones = nullptr;
  Float4* center_terms = nullptr;

 private:
  std::uint32_t matrix_of(const Member& member, std::uint32_t i) const {
    return static_cast<std::uint32_t>(3 * bone_indices_[bones_of(member)[i]] * kPitch * sizeof(Float4));
  }
  void add_moment(const Moment& moment) {
    for (std::size_t column = 0; column < 4; ++column) {
      const float* values = moment.values + column;
      moments[moment_count_++] = {values[0], values[4], values[8], values[12]};
    }
  }

  const MomentTables& tables_;
  Span<const RestSphere> rest_;
  RadiusKind kind_;
  const std::uint32_t* bone_indices_;
  std::uint32_t run_count_ = 0, step_count_ = 0, moment_count_ = 0, bone_count_ = 0, center_count_ = 0;
};

// Those of the same bones next to each other.
void fill_members(const MomentTables& tables, const RunWriter& writer, Member* out) {
  std::uint32_t bone = 0, pair = 0;
  for (std::size_t i = 0; i < tables.spheres.size; ++i) {
    const std::uint32_t count = tables.bone_counts[i];
    out[i] = {tables.spheres[i], count, bone, pair};
    bone += count;
    pair += count * (count + 1) / 2;
  }
  std::sort(out, out + tables.spheres.size, [&](const Member& a, const Member& b) { return writer.are_sorted(a, b); });
}

std::uint32_t cost_of(const MomentRun& run) {
  const std::uint32_t pairs = run.bone_count * (run.bone_count + 1) / 2;
  return pairs * (3 + run.sphere_count);  // a Gram matrix is worth three times what a sphere makes of it
}

}  // namespace

std::size_t CrowdTables::moment_words_needed(const Asset& asset) noexcept {
  const MomentTables& tables = asset.moment_tables();
  const std::size_t n = tables.spheres.size;
  return words_of(n * sizeof(Member)) + words_of(n * sizeof(MomentRun)) +
         words_of((tables.moments.size + 1) * sizeof(std::uint32_t)) +
         words_of(tables.moments.size * 4 * sizeof(Float4)) + words_of(tables.bones.size * sizeof(std::uint32_t)) +
         words_of(tables.bones.size * sizeof(Float4)) + words_of((asset.bone_count() + 1) * sizeof(std::uint32_t)) +
         words_of(asset.bone_count() * sizeof(std::uint32_t));
}

void CrowdTables::add_moments(const Asset& asset, RadiusKind radius, TableMemory& entries) noexcept {
  const MomentTables& tables = asset.moment_tables();
  const std::size_t n = tables.spheres.size;
  std::uint32_t unread = 0;
  auto* used_bones = entries.take<std::uint32_t>(asset.bone_count() + 1, used_bones_at_);
  auto* bone_indices = entries.take<std::uint32_t>(asset.bone_count(), unread);
  used_bone_count_ = fill_bones(tables.bones, asset.bone_count(), used_bones,
                                [&](std::size_t t, std::uint32_t i) { bone_indices[tables.bones[t]] = i; });
  used_bones[used_bone_count_++] = tables.reference;
  RunWriter writer(asset, radius, bone_indices);
  auto* members = entries.take<Member>(n, unread);
  fill_members(tables, writer, members);
  writer.runs = entries.take<MomentRun>(n, runs_at_);
  writer.steps = entries.take<std::uint32_t>(tables.moments.size + 1, moment_steps_at_);
  writer.moments = entries.take<Float4>(4 * tables.moments.size, moments_at_);
  writer.run_bones = entries.take<std::uint32_t>(tables.bones.size, run_bones_at_);
  writer.center_terms = entries.take<Float4>(tables.bones.size, center_terms_at_);
  for (std::size_t i = 0; i < n;) {
    const bool are_two = i + 1 < n && writer.are_equal(members[i], members[i + 1]);
    writer.add(members + i, are_two ? 2 : 1);
    i += are_two ? 2 : 1;
  }
  run_count_ = writer.run_count();
  std::sort(writer.runs, writer.runs + run_count_, [](const MomentRun& l, const MomentRun& r) {
    const std::uint32_t left = cost_of(l), right = cost_of(r);
    return left != right ? left > right : l.spheres[0] < r.spheres[0];
  });
  origin_ = tables.origin;
}

}  // namespace spherechain::cuda
