// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

#include "baker/mesh/mesh.h"
#include "baker/segment/body_plan.h"
#include "baker/segment/region_colours.h"

namespace spherechain::pictures {

using baker::Colour;
using baker::kRegionColours;
using baker::Vec3;

inline constexpr Colour kHighlight{0.835f, 0.369f, 0.000f};  // vermilion
inline constexpr Colour kSkin{0.82f, 0.78f, 0.74f};

struct PictureSphere {
  Vec3 center;
  double radius;
  Colour colour;
  bool highlighted = false;  // drawn in kHighlight, nearly opaque
};

// Drawn on top of everything.
struct PictureLine {
  Vec3 from, to;
  Colour colour;
};

// Where the viewer is, in the character's axes: x its left, y up, z forward.
using PictureView = Vec3;
inline const PictureView kFront(0, 0, 1), kLeftSide(1, 0, 0), kThreeQuarter(0.8, 0.35, 1), kBack(0, 0, -1);

struct Picture {
  baker::Mesh mesh;
  std::vector<Colour> triangle_colours;  // one a triangle, or none for skin
  std::vector<PictureSphere> spheres;
  std::vector<PictureLine> lines;
  std::vector<PictureView> views{kFront, kLeftSide, kThreeQuarter};  // side by side, to one scale
  baker::BodyFrame frame;
  double skin_opacity = 1;  // below 1 shows spheres inside
  int height = 900;         // pixels
};

// Writes a PNG. Throws baker::Error(kFile) where the file cannot be written.
void write_picture(const std::filesystem::path& path, const Picture& picture);

}  // namespace spherechain::pictures
