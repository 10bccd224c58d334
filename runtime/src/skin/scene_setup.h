// SPDX-License-Identifier: MIT
// A skin in a pose, laid out in a job's scratch memory.
#pragma once

#include <cstddef>

#include "pose/pose.h"
#include "skin/scene.h"
#include "spherechain/skin_contacts.h"

namespace spherechain {

// Table of the pairs of body parts that are found: a bit and an entry for each two parts, a <= b, in order.
struct PartTable {
  std::uint64_t* seen;
  sc_part_contact* contacts;
  std::size_t part_count, word_count;
};
constexpr std::size_t part_pairs(std::size_t part_count) { return part_count * (part_count + 1) / 2; }

std::size_t skin_scratch_words(const AssetView& asset);

// Of a checked pose, with enough words; no cluster is bounded yet. All pairs of spheres are paired but those that the
// asset or the filter, which may be null, ignores or disables.
ContactScene scene_of(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
                      std::uint64_t* words, PartTable& parts);

}  // namespace spherechain
