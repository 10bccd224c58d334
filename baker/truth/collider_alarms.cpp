// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/collider_alarms.h"

// GCC 12 sees a use of freed memory in CGAL's counted transforms, GCC 14 a copy out of bounds in its polygon soups.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wuse-after-free"
#pragma GCC diagnostic ignored "-Warray-bounds"
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#endif

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Rigid_triangle_mesh_collision_detection.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include <deque>
#include <map>
#include <set>

namespace spherechain::baker {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Solid = CGAL::Surface_mesh<Kernel::Point_3>;
using BonePairs = std::set<std::array<Index, 2>>;

Solid solid_of(const Mesh& mesh, bool is_convex) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : mesh.positions) points.emplace_back(p.x(), p.y(), p.z());
  Solid out;
  if (is_convex) {
    CGAL::convex_hull_3(points.begin(), points.end(), out);
    return out;
  }
  std::vector<std::vector<std::size_t>> triangles;
  for (const Triangle& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  pmp::repair_polygon_soup(points, triangles);
  pmp::orient_polygon_soup(points, triangles);
  pmp::polygon_soup_to_polygon_mesh(points, triangles, out);
  return out;
}

// Rigid bodies on bones.
class Bodies {
 public:
  void add(Index bone, Solid solid) {
    if (solid.number_of_faces() == 0) return;
    detection_.add_mesh(solids_.emplace_back(std::move(solid)));
    bone_of_.push_back(bone);
    Eigen::AlignedBox3d& box = boxes_.emplace_back();
    for (const Kernel::Point_3& p : solids_.back().points()) box.extend(Vec3(p.x(), p.y(), p.z()));
  }

  // Pairs of bones whose bodies intersect in a pose, but for `excluded`.
  BonePairs meeting(const std::vector<Affine>& bones, const BonePairs& excluded) {
    for (std::size_t i = 0; i < bone_of_.size(); ++i) {
      const Affine& m = bones[bone_of_[i]];
      detection_.set_transformation(
          i, CGAL::Aff_transformation_3<Kernel>(m(0, 0), m(0, 1), m(0, 2), m(0, 3), m(1, 0), m(1, 1), m(1, 2), m(1, 3),
                                                m(2, 0), m(2, 1), m(2, 2), m(2, 3)));
    }
    const std::vector<Eigen::AlignedBox3d> placed = boxes_in(bones);
    BonePairs out;
    for (std::size_t i = 0; i < bone_of_.size(); ++i) {
      std::vector<std::size_t> near;
      for (std::size_t j = i + 1; j < bone_of_.size(); ++j) {
        const std::array<Index, 2> pair = pair_of(i, j);
        if (pair[0] != pair[1] && !excluded.contains(pair) && !out.contains(pair) && placed[i].intersects(placed[j]))
          near.push_back(j);
      }
      if (near.empty()) continue;
      for (const auto& [j, is_inside] : detection_.get_all_intersections_and_inclusions(i, near))
        out.insert(pair_of(i, j));
    }
    return out;
  }

 private:
  std::array<Index, 2> pair_of(std::size_t i, std::size_t j) const {
    return {std::min(bone_of_[i], bone_of_[j]), std::max(bone_of_[i], bone_of_[j])};
  }

  // A box around each body in a pose.
  std::vector<Eigen::AlignedBox3d> boxes_in(const std::vector<Affine>& bones) const {
    constexpr double kRounding = 1e-9;
    std::vector<Eigen::AlignedBox3d> out;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      Eigen::AlignedBox3d& box = out.emplace_back();
      for (int c = 0; c < 8; ++c)
        box.extend(bones[bone_of_[i]] * boxes_[i].corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)));
      const Vec3 margin = Vec3::Constant(kRounding * box.diagonal().norm());
      box.extend(box.min() - margin);
      box.extend(box.max() + margin);
    }
    return out;
  }

  std::deque<Solid> solids_;  // which stay in place: the search refers to them
  CGAL::Rigid_triangle_mesh_collision_detection<Solid> detection_;
  std::vector<Index> bone_of_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // at rest
};

// The skin of each bone that has a collider.
Bodies bodies_of_skin(const Character& robot, const std::set<Index>& with_collider) {
  std::map<Index, Mesh> of_bone;
  for (const Triangle& t : robot.source_triangles) {
    const Index bone = robot.rig.weights[t[0]].joint[0];
    if (!with_collider.contains(bone)) continue;
    Mesh& mesh = of_bone[bone];
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Index v : t) mesh.positions.push_back(robot.source_positions[v]);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  Bodies out;
  for (const auto& [bone, mesh] : of_bone) out.add(bone, solid_of(mesh, false));
  return out;
}

}  // namespace

ColliderAlarms find_collider_alarms(const Character& robot, int poses,
                                    const std::function<std::vector<Affine>(int)>& bones) {
  const RobotRig& rig = robot.rig.robot;
  const BonePairs excluded(rig.excluded.begin(), rig.excluded.end());
  Bodies colliders;
  std::set<Index> with_collider;
  for (const RigCollider& collider : rig.colliders) {
    colliders.add(collider.bone, solid_of(collider.mesh, collider.is_convex));
    with_collider.insert(collider.bone);
  }
  Bodies skin = bodies_of_skin(robot, with_collider);
  std::map<std::array<Index, 2>, ColliderAlarms::Counts> pairs;
  ColliderAlarms out;
  for (out.poses = 0; out.poses < poses; ++out.poses) {
    const std::vector<Affine> pose = bones(out.poses);
    const BonePairs alarmed = colliders.meeting(pose, excluded), real = skin.meeting(pose, excluded);
    for (const auto& pair : alarmed) {
      ++pairs[pair].alarms;
      pairs[pair].wrong += real.contains(pair) ? 0 : 1;
    }
    bool is_missed = false;
    for (const auto& pair : real) {
      if (alarmed.contains(pair)) continue;
      ++pairs[pair].missed;
      is_missed = true;
    }
    out.any.alarms += alarmed.empty() ? 0 : 1;
    out.any.wrong += !alarmed.empty() && real.empty() ? 1 : 0;
    out.any.missed += is_missed ? 1 : 0;
  }
  for (const auto& [pair, counts] : pairs) out.pairs.push_back({pair, counts});
  return out;
}

}  // namespace spherechain::baker
