// SPDX-License-Identifier: MIT
// A skin in a pose, laid out in a job's scratch memory.
#pragma once

#include <cstddef>
#include <cstring>

#include "depth/penetration_jobs.h"
#include "pose/pose.h"
#include "skin/scene.h"

namespace spherechain {

// Table of the pairs of body parts that are found: a bit and an entry for each two parts, in order.
template <class Entry>
struct TableOfParts {
  std::uint64_t* seen = nullptr;
  Entry* contacts = nullptr;
  std::size_t count_b = 0;  // parts of body b
  std::size_t word_count = 0;

  // Place of the pair a, b. In one body only pairs with a <= b have a place.
  std::size_t place(std::size_t a, std::size_t b, bool are_one) const {
    return a * count_b + b - (are_one ? a * (a + 1) / 2 : 0);
  }
  void take(WordMemory& memory, std::size_t count_a, std::size_t parts_of_b, bool are_one) {
    count_b = parts_of_b;
    const std::size_t pairs = are_one ? count_a * (count_a + 1) / 2 : count_a * count_b;
    word_count = (pairs + 63) / 64;
    memory.take(seen, word_count);
    memory.take(contacts, pairs);
  }
  void clear() const { std::memset(seen, 0, word_count * sizeof(std::uint64_t)); }
  // The entry; `is_new`: it holds nothing yet.
  Entry& at(std::size_t a, std::size_t b, bool are_one, bool& is_new) const {
    const std::size_t i = place(a, b, are_one);
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    is_new = (seen[i / 64] & bit) == 0;
    seen[i / 64] |= bit;
    return contacts[i];
  }
};
using PartTable = TableOfParts<PartContact>;

// Is it open, with a skin?
Status check_asset(const Asset* asset);
// Checks the skin of a job: it exists, the pose fits it, and the table was made from it.
Status check_skin(const Asset* asset, const Pose& pose, const std::uint64_t* skin_table, Surface& surface);

bool has_skin(const AssetView& asset);

struct Bounds3 {
  float low[3], high[3];
};
// Bounds all of the skin in a checked pose of bones. `boxes`, if not null, receives the bounds of the skin that each
// bone moves, in six floats: the low corner, then the high one.
Bounds3 bound_bones(const AssetView& asset, const Surface& surface, const Pose& pose, float* boxes);
Bounds3 bound_vertices(const Surface& surface, const Pose& pose);
// Bounds the bones of two bodies, both moved by bones, in their scenes.
void bound_bones_of_two(const AssetView& asset_a, ContactScene& a, const AssetView& asset_b, ContactScene& b,
                        const Pose& pose_a, const Pose& pose_b, WordMemory& memory);

// The memory that a job reads of a body.
struct BodyRanges {
  MemoryRange vertices, bones, morph_weights, skin_table, ignored_parts;

  explicit BodyRanges(const JobBody& body);
};

// Scratch memory, in words, of one scene and one body's table of parts.
std::size_t skin_scratch_words(const AssetView& asset);
// Scratch memory, in words, of two scenes and their table of parts.
std::size_t body_scratch_words(const AssetView& a, const AssetView& b);

// The scratch memory of a scene; and a pose for one that has it.
void lay_out(const AssetView& asset, WordMemory& memory, ContactScene& scene);
void set_pose(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
              ContactScene& scene);
// Makes the scene of a checked pose; there must be enough words. No cluster is bounded yet. All pairs of spheres are
// paired but those that the asset or the filter, which may be null, ignores or disables.
ContactScene scene_of(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
                      WordMemory& memory);

}  // namespace spherechain
