// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/play/play.h"
#include "baker/play/player.h"

// All that the page takes from the asset and the runtime; no other file of this folder calls them.
namespace spherechain::baker {

struct PageSphere {
  std::vector<std::uint32_t> triangles;  // source triangle numbers: those of the sphere
  std::vector<std::uint32_t> pivots;     // of these the ones that carry it
  double mean_abs_f, max_abs_f;  // the paper's F (section 3.2) over the triangles' corners at rest; source units
};
// True if the body has arms, and so stands upright.
bool has_arms(const OpenAsset& asset);

std::vector<PageSphere> page_spheres(const OpenAsset& asset, const Character& character);

inline constexpr std::uint8_t kNoPart = 255;
struct PageParts {
  std::vector<std::string> names;         // "left hand"
  std::vector<std::uint8_t> of_triangle;  // a source triangle's part, or kNoPart
};
PageParts page_parts(const OpenAsset& asset);

// Contents of one frame. Triangles are source triangle numbers.
struct PageFrame {
  std::vector<std::array<std::uint32_t, 2>> contacts;   // triangles of the skin that intersect
  std::vector<Penetration> penetrations;                // deepest first
  std::vector<float> spheres;                           // a sphere's x, y, z, fit radius, detect radius
  std::vector<std::array<std::uint16_t, 2>> fit_pairs;  // spheres that touch at these radii
  std::vector<std::array<std::uint16_t, 2>> detect_pairs;
};

class PageFrames {
 public:
  // Throws Error(kFile) where the asset cannot tell contacts.
  explicit PageFrames(const AnimatedAsset& animated);

  // `positions` are the deformed source vertices; `is_next`: of the clip's next frame.
  PageFrame run(const std::vector<float>& positions, const sc_pose& skin, bool is_next);

 private:
  Player fit_, detect_;
};

}  // namespace spherechain::baker
