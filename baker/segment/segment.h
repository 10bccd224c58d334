// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/mesh/polyline.h"
#include "baker/roles/roles.h"
#include "baker/segment/body_plan.h"
#include "baker/segment/limb_trace.h"

namespace spherechain::baker {

struct Limb {
  std::string name;  // its region's
  Side side;         // of the torso; none: in the plane of symmetry (a tail)
  double along;      // where it leaves the torso: 0 is the hip, 1 the chest
  Polyline line;     // centre line from the cut at shoulder or hip to the tip of hand or foot
  double extremity;  // arc length of wrist or ankle, where hand or foot begins
};

// The region of every triangle. Limbs are regions 0 to k - 1; region k is the torso with neck and head. A biped's
// regions are the paper's R0 to R4. Where regions follow the bones they are a tree instead: any number of parts, each a
// limb whose line is its axis, and the root in the place of the torso. Limbs that fit well may be parts of the tree.
struct Regions {
  BodyFrame frame;
  std::string provider;  // "shape", "rig" or "bones"
  std::string facing;    // how forward was decided, for people
  std::vector<Limb> limbs;
  bool has_torso = true;  // a snake has none
  std::string torso_name = "torso";
  std::vector<std::uint8_t> parents;  // of a tree: the region that each hangs on, the root on itself; else empty
  std::vector<bool> by_bones;         // of a tree: whether a region is what a bone moves, or a limb or torso after all
  Vec3 hip, chest;                    // in the plane of symmetry: between the starts of the legs, and of the arms
  TorsoEnds torso;
  Polyline spine;                         // the skeleton's curve from hip to chest junction and on to the head's tip
  double spine_chest, spine_neck;         // arc lengths on `spine` of the chest junction and the neck's base
  BodyMesh body;                          // the surface that was segmented
  std::vector<std::uint8_t> of_triangle;  // a triangle of the body -> region
  std::vector<std::uint8_t> of_skin;      // a triangle of Character::skin -> region

  std::uint8_t torso_region() const { return static_cast<std::uint8_t>(limbs.size()); }
  std::size_t count() const { return limbs.size() + (has_torso ? 1 : 0); }
  std::string name(std::size_t region) const { return region < limbs.size() ? limbs[region].name : torso_name; }
  bool is_tree() const { return !parents.empty(); }
  bool is_by_bones(std::size_t region) const { return is_tree() && by_bones[region]; }
};

// The body's triangles of a region.
std::vector<Index> triangles_of_region(const Regions& regions, std::uint8_t region);

// Left and right; the middle is neither's opposite.
inline bool opposite(Side a, Side b) { return a != Side::kNone && b != Side::kNone && a != b; }

// Two arms and two legs, in the order of kRegionNames.
bool is_biped(const Regions& regions);

// The torso's region of a biped: R4 of the paper.
inline constexpr std::uint8_t kTorso = 4;

struct SegmentSettings {
  // Biped or quadruped. kUnknown: by shape, a biped where the long branches are those of one, else as many limbs as
  // there are; by rig, what the rig's limbs are.
  BodyKind body = BodyKind::kUnknown;
  int rays = 80;               // N_r
  std::optional<Vec3> facing;  // overrides what the feet say
};

}  // namespace spherechain::baker
