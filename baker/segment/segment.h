// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "import/import.h"
#include "mesh/polyline.h"
#include "segment/body_plan.h"
#include "segment/limb_trace.h"

namespace spherechain::baker {

// R0 .. R3 of the paper are the limbs, R4 the torso (with neck and head).
inline constexpr std::uint8_t kTorso = 4;
inline constexpr std::size_t kRegionCount = 5;

struct Limb {
  bool left, top;    // which side of the torso it leaves, and whether from the chest (arms) or the hip (legs)
  Polyline line;     // centre line from the cut at shoulder or hip to the tip of hand or foot
  double extremity;  // arc length of wrist or ankle: where hand or foot begin
};

// Which part of the body every triangle is.
struct Regions {
  BodyFrame frame;
  std::string facing;
  std::array<Limb, 4> limbs;  // in the order of kRegionNames
  Vec3 hip, chest;            // in the plane of symmetry, between the legs' and between the arms' starts
  TorsoEnds torso;
  Polyline spine;                         // the skeleton's curve from hip to chest junction and on to the head's tip
  double spine_chest, spine_neck;         // arc lengths on `spine` of the chest junction and the neck's base
  std::vector<std::uint8_t> of_triangle;  // a triangle of Character::body -> region
  std::vector<std::uint8_t> of_other;  // a triangle of Character::others -> region, that of the nearest body triangle
};

struct SegmentSettings {
  int rays = 80;               // N_r
  std::optional<Vec3> facing;  // overrides what the feet say
};

// Segments by shape alone. Throws Error(kSegmentation) where the body is not one closed surface or lacks a limb.
Regions segment(const Character& character, const SegmentSettings& settings);

}  // namespace spherechain::baker
