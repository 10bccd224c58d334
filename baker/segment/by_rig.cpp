// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/by_rig.h"

#include <algorithm>

#include "baker/mesh/surface_query.h"
#include "baker/segment/body_plan.h"
#include "baker/segment/from_skin.h"
#include "baker/segment/islands.h"
#include "baker/segment/stature.h"
#include "baker/segment/trunk.h"

namespace spherechain::baker {
namespace {

Side side_of(const RoleLimb& limb) {
  if (limb.name.starts_with("left_")) return Side::kLeft;
  return limb.name.starts_with("right_") ? Side::kRight : Side::kNone;
}

Vec3 left_of(const Regions& regions) {
  Vec3 left = Vec3::Zero();
  for (const Limb& limb : regions.limbs) {
    if (limb.side != Side::kNone) left += (limb.side == Side::kLeft ? 1.0 : -1.0) * limb.line.at(0);
  }
  return left;
}

}  // namespace

Attempt<Regions> segment_by_rig(const Character& character, BodyMesh body, const Roles& roles,
                                const SegmentSettings& settings) {
  const auto because = [](const std::string& what) {
    return Reason{what + " (inspect --roles says what its joints are)"};
  };
  if (settings.body != BodyKind::kUnknown && roles.kind != settings.body) {
    return because(std::string("the rig's limbs are no ") + body_kind_name(settings.body) + "'s");
  }
  if (roles.trunk.empty()) return because("the rig has no trunk that limbs leave from");
  const std::vector<Vec3> joints = rest_positions(character.rig);
  const auto joint = [&](int node) { return joints[static_cast<std::size_t>(node)]; };
  const SkinRegions skin = segment_from_skin(character, body, roles);

  Regions regions;
  regions.provider = "rig";
  regions.facing = "forward is as the rig's left and right have it";
  std::vector<std::uint8_t> region_of(256, SkinRegions::kNoLimb);
  for (std::size_t i = 0; i < roles.limbs.size(); ++i) {
    if (skin.limbs[i].line.points().size() < 2) continue;  // it moves no skin
    region_of[i] = static_cast<std::uint8_t>(regions.limbs.size());
    const RoleLimb& limb = roles.limbs[i];
    regions.limbs.push_back(
        {limb.name, side_of(limb), limb.top ? 1.0 : 0.0, skin.limbs[i].line, skin.limbs[i].extremity});
  }
  if (regions.limbs.size() < 2) return because("the rig has fewer than two limbs that move skin");

  const Vec3 pelvis = joint(roles.trunk.front()), upper = joint(roles.trunk.back());
  const bool four = roles.kind == BodyKind::kBiped || roles.kind == BodyKind::kQuadruped;
  if (!four) place_along(regions, pelvis, upper);
  const Vec3 hip = middle_of_starts(regions, 0, pelvis), chest = middle_of_starts(regions, 1, upper);
  const Vec3 left = left_of(regions);
  if (!(left.cross(chest - hip).norm() > 0)) {
    return because("the rig's limbs do not tell left, right and up apart");
  }
  regions.frame.left = left.normalized();
  regions.frame = with_up(regions.frame, chest - hip, body.mesh);
  const bool biped = roles.kind == BodyKind::kBiped;
  if (biped) regions.frame.height = stature(character, roles);
  const Vec3& axis = biped ? regions.frame.forward : regions.frame.up;
  if (auto reason = check_facing(settings.facing, axis, biped ? "forward axis" : "trunk")) return *reason;
  if (settings.facing && settings.facing->dot(axis) < 0) {
    return because("the facing direction in the settings is against what the rig's joints say");
  }
  const auto in_plane = [&](const Vec3& p) {
    return Vec3(p - (p - regions.frame.origin).dot(regions.frame.left) * regions.frame.left);
  };
  regions.hip = in_plane(hip);
  regions.chest = in_plane(chest);

  for (const std::uint8_t limb : skin.of_triangle)
    regions.of_triangle.push_back(std::min(region_of[limb], regions.torso_region()));
  for (const std::uint8_t limb : skin.of_skin)
    regions.of_skin.push_back(std::min(region_of[limb], regions.torso_region()));
  for (std::uint8_t region = 0; region < regions.torso_region(); ++region) {
    if (std::count(regions.of_triangle.begin(), regions.of_triangle.end(), region) > 0) continue;
    return because("the rig's " + regions.name(region) + " moves no part of the body's largest piece");
  }
  if (std::count(regions.of_triangle.begin(), regions.of_triangle.end(), regions.torso_region()) == 0) {
    return because("the rig's trunk moves no skin");
  }
  if (!biped) {
    const SurfaceQuery trunk(body.mesh, triangles_of_region(regions, regions.torso_region()));
    const auto height = [&](const Vec3& p) { return (p - regions.frame.origin).dot(regions.frame.up); };
    const auto centred = [&](const Vec3& p) {
      const double rise = height(upper) - height(pelvis);
      const double f = std::abs(rise) > 0 ? (height(p) - height(pelvis)) / rise : 0.5;
      return middle_of_trunk(trunk, regions.frame, in_plane(pelvis + f * (upper - pelvis)));
    };
    regions.hip = centred(regions.hip);
    regions.chest = centred(regions.chest);
  }
  const bool has_neck = !roles.neck_head.empty();
  const Vec3 neck = has_neck ? joint(roles.neck_head.front()) : upper;
  regions.torso = ends_by_skin(body.mesh, regions, has_neck ? &neck : nullptr);

  std::vector<Vec3> spine{regions.hip};
  for (const int node : roles.trunk) {
    if (node != roles.trunk.front()) spine.push_back(joint(node));
  }
  for (const int node : roles.neck_head) spine.push_back(joint(node));
  regions.spine = Polyline(std::move(spine));
  regions.spine_chest = regions.spine.closest(regions.chest);
  regions.spine_neck = regions.spine.closest(neck);
  regions.body = std::move(body);
  return regions;
}

bool limbs_are_in_shards(const Mesh& skin, const Regions& regions) {
  constexpr double kHangsTogether = 0.5;  // of the limbs' area
  const Islands islands = find_islands(skin, triangle_neighbours(skin), regions.of_skin);
  std::vector<double> largest(regions.limbs.size(), 0.0);
  double all = 0, hangs_together = 0;
  for (std::size_t i = 0; i < islands.area.size(); ++i) {
    const std::uint8_t region = regions.of_skin[islands.triangles[i][0]];
    if (region == regions.torso_region()) continue;
    all += islands.area[i];
    largest[region] = std::max(largest[region], islands.area[i]);
  }
  for (const double area : largest) hangs_together += area;
  return hangs_together < kHangsTogether * all;
}

}  // namespace spherechain::baker
