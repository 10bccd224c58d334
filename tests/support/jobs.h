// SPDX-License-Identifier: MIT
// The runtime's jobs as one call each, their buffers on the heap and sized exactly, so that sanitizers see any overrun.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "spherechain/cover.h"
#include "spherechain/detect.h"
#include "spherechain/refit.h"
#include "spherechain/refit_bones.h"
#include "spherechain/skin.h"

namespace spherechain::test {

struct Refitted {
  Status status;
  std::vector<Sphere> spheres;
};

// `positions` are as many vertices as it has whole strides.
Refitted refit(const Asset& asset, const std::vector<float>& positions, RadiusKind radius, std::size_t stride = 12);

Refitted refit_bones(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights,
                     RadiusKind radius, Target target = Target::kBest);

struct Covered {
  Status status;
  std::vector<Sphere> leaves, spheres;
};
Covered cover(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights,
              Target target = Target::kBest);

struct SkinnedSurface {
  Status status;
  std::vector<float> positions;  // NaN where nothing was written
};
SkinnedSurface skin(const Asset& asset, const BoneMatrices& bones, const std::vector<float>& morph_weights,
                    Target target = Target::kBest, std::size_t stride = 12);

struct Detected {
  Status status;
  std::vector<Pair> pairs;
  std::vector<ChainPair> chain_pairs;
  std::vector<std::uint64_t> bits;
  std::size_t test_count;
};

// Runs three times: to count, then with buffers of exactly that many, then with a table. kCorrupt where that finds
// something else.
Detected detect(const Asset& asset, const std::vector<Sphere>& spheres, Method method, RadiusKind radius,
                Target target = Target::kBest, const Filter* filter = nullptr);

// Bit for bit, so that a NaN equals itself.
template <typename T>
bool same_bits(const std::vector<T>& l, const std::vector<T>& r) {
  return l.size() == r.size() && (l.empty() || std::memcmp(l.data(), r.data(), l.size() * sizeof(T)) == 0);
}

}  // namespace spherechain::test
