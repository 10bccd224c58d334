// SPDX-License-Identifier: MIT
// Assets and inputs that the crowd's tests share.
#pragma once

#include "crowd_runs.h"
#include "owned_filter.h"
#include "random_poses.h"

namespace spherechain::test {

std::vector<std::uint64_t> table_of(const Asset& asset, Radius radius, const Filter* filter = nullptr);

GroupInput group_of(const Asset& asset, Radius radius, std::size_t instances, const Filter* filter = nullptr);

// Some touch hardly at all, some are not finite or huge.
std::vector<Sphere> spheres_of(std::size_t n, std::size_t instances, std::size_t stride, std::mt19937& random);

// `layout`'s matrices, an instance's of `kind`, with NaN wherever none of them is.
void give_matrices(GroupInput& in, const Asset& asset, MatrixLayout layout, PoseKind kind, std::size_t gap,
                   std::mt19937& random);

// Refitted by moments; some spheres have fewer pivots than eight, and some more.
TinyAsset moment_asset(unsigned spheres, std::size_t bones, unsigned seed);

// Instance `i`'s.
Pose pose_of(const GroupInput& in, std::size_t i);

struct Expected {
  std::vector<Sphere> spheres;
  std::vector<std::uint32_t> counts;
  std::vector<std::uint64_t> bits;
  std::vector<Pair> pairs;  // instance after instance
};

// By the CPU's jobs.
Expected pairs_of_spheres(const Asset& asset, const GroupInput& in, Radius radius, const Filter* filter = nullptr);
Expected pairs_of_bones(const Asset& asset, const GroupInput& in, Radius radius, const Filter* filter = nullptr);

// Disables some spheres, pads all, ignores some pairs and takes up others.
void edit_randomly(const Asset& asset, OwnedFilter& filter, std::mt19937& random);

// How many there are of each kind (kTwoBones, kThreeBones, kAnyBones).
struct RunCounts {
  std::size_t of_kind[3] = {};
  void add(const std::vector<std::uint64_t>& table);
};

}  // namespace spherechain::test
