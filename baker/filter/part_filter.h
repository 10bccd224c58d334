// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "baker/play/asset_file.h"

namespace spherechain::baker {

// Relation of two body parts over the poses seen. The first that applies, in this order:
enum class PairKind {
  kAdjacent,   // one hangs on the other
  kAlways,     // their skins intersect in every pose
  kRest,       // at rest, and in others or none
  kSometimes,  // in some poses
  kNever,      // in none
};
const char* kind_name(PairKind kind);  // "adjacent", "always" ...

// True if a physics engine should test the two against each other.
inline bool needs_test(PairKind kind) { return kind == PairKind::kRest || kind == PairKind::kSometimes; }

struct FilteredPair {
  std::array<std::size_t, 2> parts;  // a < b: indices in PartFilter::parts
  PairKind kind;
  int clip_poses, random_poses;  // in which their skins intersect
  double at_most;                // upper bound of the share of random poses in which they do, at 95 %
};

// Which pairs of body parts need testing.
struct PartFilter {
  std::vector<std::string> parts;        // in the asset's order
  std::vector<FilteredPair> pairs;       // each two parts once, sorted
  int clip_poses = 0, random_poses = 0;  // seen
  int settled_after = 0;                 // the fewest random poses that give the same kinds

  const FilteredPair& of(std::size_t a, std::size_t b) const;  // a != b, in any order
};

// Pairs of spheres, a < b, sorted, that the asset does not ignore and that find nothing: no two body parts of their
// triangles met in any pose seen.
std::vector<Pair> idle_sphere_pairs(const OpenAsset& asset, const PartFilter& filter);

// docs/json.md; `asset_name` is for people.
std::string part_filter_json(const PartFilter& filter, const OpenAsset& asset, const std::string& asset_name);

// Reads a file that `filter` wrote. Throws Error(kFile) with the file's name if it is broken, lacks a pair, or names a
// part that the asset does not have.
PartFilter read_part_filter(const std::string& path, const OpenAsset& asset);
// Reads a filter without its asset: `parts` are the parts that the file names.
PartFilter read_part_filter(const std::string& path);

}  // namespace spherechain::baker
