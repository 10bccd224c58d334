// SPDX-License-Identifier: MIT
#include "crowd_cases.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "crowd_launch.h"
#include "jobs.h"
#include "palette.h"
#include "tiny_moments.h"

namespace spherechain::test {
namespace {

constexpr Sphere kGap{0, 0, 0, std::numeric_limits<float>::infinity()};  // between instances: never to be looked at

void add_pairs(const Asset& asset, const std::vector<Sphere>& spheres, RadiusKind radius, const Filter* filter,
               Expected& to) {
  const Detected found = detect(asset, spheres, Method::kM2, radius, Target::kScalar, filter);
  REQUIRE(found.status == Status::kOk);
  to.counts.push_back(static_cast<std::uint32_t>(found.pairs.size()));
  to.bits.insert(to.bits.end(), found.bits.begin(), found.bits.end());
  to.pairs.insert(to.pairs.end(), found.pairs.begin(), found.pairs.end());
}

}  // namespace

Tables::Tables(const Asset& asset, RadiusKind radius, const Filter* filter)
    : words(cuda::CrowdTables::words_needed(asset)) {
  REQUIRE(tables.build(asset, radius, filter, {words.data(), words.size()}) == Status::kOk);
  REQUIRE(tables.words.size <= words.size());
  words.resize(tables.words.size);
}

GroupInput group_of(const Tables& tables, std::size_t instances) {
  GroupInput in;
  in.tables = &tables.tables;
  in.words = tables.words;
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
  const std::size_t bones = asset.bone_count(), floats = size_of(layout) / 4;
  in.layout = layout;
  in.bone_count = bones;
  in.bone_stride = size_of(layout);
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
  TinySkin skin = add_bones(tiny, bones, seed);
  add_moments(tiny, skin);
  return tiny;
}

BoneMatrices bones_of(const GroupInput& in, std::size_t i) {
  return {in.matrices.data() + in.offset + i * in.instance_stride / 4, in.bone_count, in.layout, in.bone_stride};
}

Expected pairs_of_spheres(const Asset& asset, const GroupInput& in, RadiusKind radius, const Filter* filter) {
  Expected out;
  const std::size_t n = asset.spheres().size, stride = in.stride == 0 ? n : in.stride;
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const auto first = in.spheres.begin() + static_cast<std::ptrdiff_t>(i * stride);
    add_pairs(asset, {first, first + static_cast<std::ptrdiff_t>(n)}, radius, filter, out);
  }
  return out;
}

Expected pairs_of_bones(const Asset& asset, const GroupInput& in, RadiusKind radius, const Filter* filter) {
  Expected out;
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    const Refitted refitted = refit_bones(asset, bones_of(in, i), {}, radius, Target::kScalar);
    REQUIRE(refitted.status == Status::kOk);
    out.spheres.insert(out.spheres.end(), refitted.spheres.begin(), refitted.spheres.end());
    add_pairs(asset, refitted.spheres, radius, filter, out);
  }
  return out;
}

void edit_randomly(const Asset& asset, Filter& filter, std::mt19937& random) {
  for (std::uint32_t i = 0; i < asset.spheres().size; ++i) {
    if (random() % 4 == 0) REQUIRE(disable_sphere(asset, filter, i) == Status::kOk);
    REQUIRE(pad_sphere(asset, filter, i, uniform(random, i % 6 == 0 ? -3 : -0.05F, 0.3F)) == Status::kOk);
    if (i > 0) {
      const auto other = static_cast<std::uint32_t>(random() % i);
      REQUIRE(ignore_pair(asset, filter, i, other, random() % 2 == 0) == Status::kOk);
    }
  }
}

void RunCounts::add(const Tables& tables) {
  const cuda::TableHeader& header = cuda::header_of(tables.tables);
  const auto* runs = reinterpret_cast<const cuda::MomentRun*>(&tables.words[header.runs]);
  for (std::uint32_t i = 0; i < header.run_count; ++i) ++of_kind[runs[i].kind];
}

}  // namespace spherechain::test
