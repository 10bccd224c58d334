// SPDX-License-Identifier: MIT
#include "crowd_cases.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "jobs.h"
#include "palette.h"

namespace spherechain::test {
namespace {

constexpr Sphere kGap{0, 0, 0, std::numeric_limits<float>::infinity()};  // between instances: never to be looked at

void add_pairs(const Asset& asset, const std::vector<Sphere>& spheres, Radius radius, const Filter* filter,
               Expected& to) {
  const Detected found = detect(asset, spheres, radius, SC_TARGET_SCALAR, filter);
  REQUIRE(found.status == SC_OK);
  to.counts.push_back(static_cast<std::uint32_t>(found.pairs.size()));
  to.bits.insert(to.bits.end(), found.bits.begin(), found.bits.end());
  to.pairs.insert(to.pairs.end(), found.pairs.begin(), found.pairs.end());
}

}  // namespace

std::vector<std::uint64_t> table_of(const Asset& asset, Radius radius, const Filter* filter) {
  std::vector<std::uint64_t> table(cuda::crowd_table_words(asset));
  REQUIRE(cuda::prepare_crowd(asset, radius, filter == nullptr ? nullptr : filter->ignored, table.data(),
                              table.size()) == SC_OK);
  return table;
}

GroupInput group_of(const Asset& asset, Radius radius, std::size_t instances, const Filter* filter) {
  GroupInput in;
  in.table = table_of(asset, radius, filter);
  in.instance_count = instances;
  return in;
}

// Some touch hardly at all, some are not finite or huge.
std::vector<Sphere> spheres_of(std::size_t n, std::size_t instances, std::size_t stride, std::mt19937& random) {
  std::vector<Sphere> out(instances * stride, kGap);
  for (std::size_t i = 0; i < instances; ++i) {
    std::vector<Sphere> one = random_spheres(n, random);
    for (Sphere& sphere : one) sphere.radius *= i % 3 == 0 ? 0.1F : 1.0F;
    if (i % 7 == 5) one[i % n].x = std::numeric_limits<float>::quiet_NaN();
    if (i % 7 == 6) one[i % n].radius = i % 2 == 0 ? 3e38F : -kGap.radius;
    if (i % 11 == 4) one[i % n].z = 1e30F;
    std::copy(one.begin(), one.end(), out.begin() + static_cast<std::ptrdiff_t>(i * stride));
  }
  return out;
}

void give_matrices(GroupInput& in, const Asset& asset, MatrixLayout layout, PoseKind kind, std::size_t gap,
                   std::mt19937& random) {
  const std::size_t bones = view_of(asset).bone_count(), floats = floats_of(layout);
  in.pose.bone_layout = layout;
  in.pose.bone_count = bones;
  in.instance_stride = (bones * floats + gap) * 4;
  in.matrices.assign(in.offset + in.instance_count * in.instance_stride / 4, std::nanf(""));
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const std::vector<Matrix> own = random_pose(bones, kind, 1.0F, random);
    for (std::size_t bone = 0; bone < bones; ++bone) {
      put_matrix(own[bone], layout, &in.matrices[in.offset + i * in.instance_stride / 4 + bone * floats]);
    }
  }
}

TinyAsset moment_asset(unsigned spheres, std::size_t bones, unsigned seed) {
  TinyAsset tiny = random_asset(spheres, seed);
  if (spheres > 8) {
    give_pivots(tiny, 5, 19, 2);
    give_pivots(tiny, 7, 1, 3);
    give_pivots(tiny, 8, 16, 4);
  }
  add_bones(tiny, bones, seed);
  return tiny;
}

Pose pose_of(const GroupInput& in, std::size_t i) {
  Pose pose = in.pose;
  pose.bones = in.matrices.data() + in.offset + i * in.instance_stride / 4;
  return pose;
}

Expected pairs_of_spheres(const Asset& asset, const GroupInput& in, Radius radius, const Filter* filter) {
  Expected out;
  const std::size_t n = view_of(asset).spheres().size, stride = in.instance_stride == 0 ? n : in.instance_stride;
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const auto first = in.spheres.begin() + static_cast<std::ptrdiff_t>(i * stride);
    add_pairs(asset, {first, first + static_cast<std::ptrdiff_t>(n)}, radius, filter, out);
  }
  return out;
}

Expected pairs_of_bones(const Asset& asset, const GroupInput& in, Radius radius, const Filter* filter) {
  Expected out;
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const Refitted refitted = refit(asset, pose_of(in, i), radius, SC_TARGET_SCALAR);
    REQUIRE(refitted.status == SC_OK);
    out.spheres.insert(out.spheres.end(), refitted.spheres.begin(), refitted.spheres.end());
    add_pairs(asset, refitted.spheres, radius, filter, out);
  }
  return out;
}

void edit_randomly(const Asset& asset, OwnedFilter& filter, std::mt19937& random) {
  for (std::uint32_t i = 0; i < view_of(asset).spheres().size; ++i) {
    if (i > 0) {
      const auto other = static_cast<std::uint32_t>(random() % i);
      filter.ignore(i, other, random() % 2 == 0);
    }
  }
}

void RunCounts::add(const std::vector<std::uint64_t>& table) {
  const cuda::TableHeader& header = cuda::header_of(table.data());
  const auto* runs = reinterpret_cast<const cuda::MomentRun*>(&table[header.runs]);
  for (std::uint32_t i = 0; i < header.run_count; ++i) ++of_kind[runs[i].kind];
}

}  // namespace spherechain::test
