// SPDX-License-Identifier: MIT
#include "crowd_cases.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "jobs.h"
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
  REQUIRE(tables.words() <= words.size());
  words.resize(tables.words());
}

Tables::Tables(const Asset& asset, Covers, const Filter* filter) : words(cuda::CrowdTables::cover_words_needed(asset)) {
  REQUIRE(tables.build_covers(asset, filter, {words.data(), words.size()}) == Status::kOk);
  REQUIRE(tables.words() <= words.size());
  words.resize(tables.words());
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

void put_matrix(const Matrix& matrix, MatrixLayout layout, float* to) {
  for (std::size_t at = 0; at < matrix.size(); ++at) {
    const std::size_t row = at / 4, column = at % 4;
    to[layout == MatrixLayout::kColumnMajor4x4   ? 4 * column + row
       : layout == MatrixLayout::kColumnMajor3x4 ? 3 * column + row
                                                 : 4 * row + column] = matrix[at];
  }
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

TinyAsset boned_asset(unsigned spheres, std::size_t bones, unsigned seed) {
  TinyAsset tiny = random_asset(spheres, seed);
  give_pivots(tiny, 5, 19, 2);
  give_pivots(tiny, 7, 1, 3);
  give_pivots(tiny, 8, 16, 4);
  add_bones(tiny, bones, seed);
  return tiny;
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

std::vector<float> morph_weights_of(const GroupInput& in, const Asset& asset, std::size_t i) {
  const auto first = in.morph_weights.begin() + static_cast<std::ptrdiff_t>(i * asset.morph_count());
  return in.morph_weights.empty() ? std::vector<float>()
                                  : std::vector<float>(first, first + static_cast<std::ptrdiff_t>(asset.morph_count()));
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
    const Refitted refitted =
        refit_bones(asset, bones_of(in, i), morph_weights_of(in, asset, i), radius, Target::kScalar);
    REQUIRE(refitted.status == Status::kOk);
    out.spheres.insert(out.spheres.end(), refitted.spheres.begin(), refitted.spheres.end());
    add_pairs(asset, refitted.spheres, radius, filter, out);
  }
  return out;
}

void check_pairs(const GroupInput& in, const GroupOutput& got, const Expected& wanted) {
  CHECK(got.counts == wanted.counts);
  if (in.wants_bits) CHECK(got.bits == wanted.bits);
  if (in.pair_capacity == 0) return;
  CHECK(got.pair_count == wanted.pairs.size());
  std::vector<bool> taken(in.pair_capacity);
  std::size_t before = 0;
  bool same = true;
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    for (std::size_t k = 0; k < wanted.counts[i]; ++k) {
      const std::size_t place = got.starts[i] + k;
      same &= place < wanted.pairs.size();
      if (place < in.pair_capacity) {
        same &= !taken[place] && got.pairs[place].instance == i && got.pairs[place].pair == wanted.pairs[before + k];
        taken[place] = true;
      }
    }
    before += wanted.counts[i];
  }
  CHECK(same);
}

}  // namespace spherechain::test
