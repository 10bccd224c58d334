// SPDX-License-Identifier: MIT
// Which body parts are inside another: their spheres' centres are probes, and the core points of parts that have such a
// sphere. From a probe a half-line goes through the posed skin; as often as it leaves, less as often as it enters, the
// skin winds around the probe. A probe is inside another part where the skin winds around it more often than at rest.
#pragma once

#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/skin/job_body.h"

namespace spherechain {

inline constexpr std::uint16_t kOutside = 0xFFFF;

// A sphere's centre that no skin encloses at rest says nothing of its part.
bool is_core(const Surface& surface, std::size_t sphere);

// The centres of one body's spheres, and the skin in which they may be: the body's own, or another body's.
struct InsideTest {
  const AssetView& asset;  // of the spheres
  const Surface& surface;
  Span<const Sphere> centers;
  Span<const std::uint64_t> asked;     // a bit a sphere: the others are outside
  PosedClusters& skin;                 // with the pairs of spheres that are ignored
  PosedClusters& own;                  // the body's; of one body the same
  const std::uint64_t* ignored_parts;  // a bit each of another body's; or null
  bool are_one;
  Target target;             // resolved
  std::int16_t* windings;    // scratch: three a sphere
  Span<std::uint16_t> part;  // out: the part of the skin that each probe is in, or kOutside
};
// Counts the probes of a body: its spheres, then the core points of part after part.
inline std::size_t probe_count(const AssetView& asset) {
  return asset.spheres().size + kCorePoints * asset.part_count();
}
void find_inside(const InsideTest& test);

// A line along an axis through the skin in a pose.
struct Line {
  float from[3];
  std::size_t axis;
  bool goes_up, goes_down;  // from there
};

// A triangle's corners in the pose.
void find_corners(Target resolved, const PosedClusters& skin, std::uint32_t triangle, float (&out)[3][3]);

// Gets each crossing of a line that is followed.
class Crossings {
 public:
  virtual void add(std::uint32_t triangle, int side, double height) = 0;

 protected:
  ~Crossings() = default;
};

// Bounds the skin's spheres first, where they are not yet.
void follow(Target resolved, const PosedClusters& skin, const Line& line, Crossings& found);

}  // namespace spherechain
