// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "baker/import/import.h"
#include "baker/mesh/attempt.h"
#include "baker/mesh/surface_query.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

struct Ball {
  Vec3 center;
  double radius;
};

struct FittedSphere {
  Ball ball;
  std::uint8_t region;
  int level;       // torso: the disk's number from the bottom, which the head continues; else -1
  Side side;       // torso: which part of the disk; limbs, head and the middle of a level: none
  Vec3 axis;       // unit direction of the chain here: along the limb or part towards its tip, up the torso
  bool extremity;  // in head, hand or foot, where the paper has no spheres
  std::optional<double> detect_radius = std::nullopt;  // where a person chose it; else it is found when it is bound
  int body_part = -1;                                  // where it was made for one: its number
};

// The three fits of one torso sphere. All are measured at the vertices of its part of the disk's band, which goes from
// halfway to the level below to halfway to the level above. F = radius - |centre - vertex| (section 3.2).
struct TorsoFit {
  Ball phi1, phi1_adjusted, phi2;
  std::vector<Index> vertices;  // of Character::body
  std::uint32_t sphere = 0;     // its number
};

// F of a vertex: positive inside the ball.
double signed_f(const Ball& ball, const Vec3& vertex);

struct FError {
  double mean_abs = 0, max_abs = 0;
};
FError f_error(const Ball& ball, const Mesh& mesh, const std::vector<Index>& vertices);

// All spheres of the body. The torso comes first, level by level from the bottom, left before right (the paper's
// numbering), then neck and head, then the limbs in region order, each from shoulder or hip to its tip.
struct Spheres {
  std::vector<FittedSphere> spheres;
  std::vector<std::vector<std::uint32_t>>
      of_region;                      // in the order above; the torso is last, and empty where there is none
  std::vector<TorsoFit> torso;        // without the head; of spheres that a person changed there is none
  std::vector<double> level_heights;  // along frame.up from frame.origin; without the head
  // Neighbours on the body, a < b, sorted: along a limb, on the same or the next torso level, limb and torso, neck and
  // torso. By halves: of a part and the one it hangs on, where their skins are joined, and of skin that moves alike.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  // For a tree: the sphere fitted to each triangle of Character::skin. Else empty.
  std::vector<std::uint32_t> of_skin;

  std::uint8_t torso_region() const { return static_cast<std::uint8_t>(of_region.size() - 1); }
  // The torso level at a place from 0, the hip, to 1, the chest.
  int level_at(double along) const;
};

// Spheres that fit_halves takes where no limit is set: the first, and up to the second where more than a twentieth of
// the skin is still far from its sphere.
inline constexpr int kHalvedSpheres = 75, kHalvedSpheresMax = 110;

// How far the skin may be from the surface of its sphere to count as well fitted, in heights.
inline constexpr double kWellFitted = 0.02, kFarAreaGood = 0.05;

// Lengths are fractions of the character's height; the letters are the paper's.
struct FitSettings {
  int rays = 80;                    // N_r
  double penetration_depth = 0.30;  // PD of neighbours on a limb, and of torso levels
  double delta = 0.015;             // climb of the disk
  double limb_step = 0.0015;        // march of the circumference
  int spheres_per_level = 2;        // N_s: 1 to 3
  bool extremities = true;          // spheres in head, hands and feet
  std::optional<int> spheres;       // at most so many; else what the march needs; by halves kHalvedSpheres
  bool few = false;                 // by halves: none that gains little

  bool operator==(const FitSettings&) const = default;
};

// The paper's fit: the march along limbs, the disk up the torso. There is none where a limb or the torso has no section
// that a sphere fits in.
Attempt<Spheres> fit_spheres(const Regions& regions, const FitSettings& settings);

// Spheres of the paper's fit that regions of a tree keep.
struct KeptSpheres {
  const Spheres* spheres = nullptr;
  std::vector<int>
      region;  // of each region of the tree: the one in `spheres` that it was, or -1; empty: none keeps any

  bool keeps(std::size_t id) const { return !region.empty() && region[id] >= 0; }
  const std::vector<std::uint32_t>& of_region(std::size_t id) const {
    return spheres->of_region[static_cast<std::size_t>(region[id])];
  }
};

// The fit for any body, of a tree of regions: a sphere for each, and the skin that gains most by it halved, until there
// are enough. Mirrored regions are halved as often.
Spheres fit_halves(const Character& character, const Regions& regions, const FitSettings& settings,
                   const KeptSpheres& kept = {});

// Neighbours on the body (Spheres::links) of fit_spheres', and of fit_halves'.
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_links(const Spheres& spheres, const Regions& regions);
std::vector<std::pair<std::uint32_t, std::uint32_t>> find_links(const Character& character, const Regions& regions,
                                                                const Spheres& spheres);

// Which of some spheres each of a part's triangles belongs to, by fit_halves' rule. Each sphere gets one, where there
// are enough.
std::vector<std::size_t> share_triangles(const Mesh& skin, const BodyFrame& frame, const std::vector<Index>& triangles,
                                         const std::vector<Ball>& balls);

// The sphere in `among` whose centre is nearest to `point`.
std::uint32_t nearest_sphere(const Spheres& spheres, const std::vector<std::uint32_t>& among, const Vec3& point);

// fit_spheres' parts. `body` searches all of the mesh.
Attempt<std::vector<FittedSphere>> fit_limb(const Mesh& mesh, const SurfaceQuery& body, const Regions& regions,
                                            std::uint8_t region, const FitSettings& settings);
std::optional<Reason> fit_torso(const Mesh& mesh, const Regions& regions, const FitSettings& settings, Spheres& out);
// Spheres of the hand or foot past the limb's last sphere; none where the limb ends there.
std::vector<FittedSphere> fit_hand_or_foot(const Mesh& mesh, const Regions& regions, std::uint8_t region,
                                           const Ball& last, const FitSettings& settings);
// Neck and head above the torso's top level; one sphere a level.
std::vector<FittedSphere> fit_head(const Mesh& mesh, const Regions& regions, const Spheres& torso,
                                   const FitSettings& settings);

// phi2: the smallest sphere around the points (CGAL).
Ball minimum_enclosing_ball(const std::vector<Vec3>& points);
Ball minimum_enclosing_ball(const Mesh& mesh, const std::vector<Index>& vertices);

// Penetration depth PD of two neighbours: 0 where they touch, 0.5 for equal spheres that overlap by half.
double penetration_depth(const Ball& a, const Ball& b);

}  // namespace spherechain::baker
