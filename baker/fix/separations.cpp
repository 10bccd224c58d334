// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/separations.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {
namespace {

constexpr double kSameWay = 0.5;    // cosine
constexpr double kAtItsEnd = 0.5;   // mm
constexpr std::size_t kMemory = 4;  // separations of one penetration
// Lengths, in heights.
constexpr double kArm = 0.3;        // length of an arm
constexpr double kFarthest = 0.03;  // largest target of a separation in a round
// Weights of a residual of one arm's length, relative to the cost of a radian at a shoulder.
constexpr double kPullBack = 500;  // for shallow penetrations that end too far apart

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

SkinSpot spot_of(const Character& character, const SkinPoint& point) {
  SkinSpot out;
  for (std::size_t k = 0; k < 3; ++k) {
    out.vertices[k] = character.source_triangles[point.triangle][k];
    out.shares[k] = double{point.weights[k]};
  }
  return out;
}

}  // namespace

double Separations::gap(const Separation& separation, double frame, const Turns& turns) const {
  const TurnedClip::Pose pose = clip_.pose(frame, turns);
  const std::vector<Vec3> now = clip_.turns_at(frame, turns);
  const auto at = [&](const SkinSpot& spot) {
    return motion_of(clip_, pose, animated_.character().source_positions, animated_.weights(), spot, now.data()).at;
  };
  return to_vec3(separation.row.normal).dot(at(separation.at) - at(separation.at_other));
}

void Separations::add(const PenetrationKey& place, const Penetration& found, double allowed, bool is_shallow,
                      const Turns& turns) {
  const Character& character = animated_.character();
  const ContactRow row{.part = found.part,
                       .other = found.other,
                       .body = 0,
                       .at = found.deepest.position,
                       .at_other = found.deepest_other.position,
                       .normal = found.direction,
                       .gap = -found.distance,
                       .allowed = static_cast<float>(allowed)};
  const Separation separation{row, spot_of(character, found.deepest), spot_of(character, found.deepest_other),
                              is_shallow};
  const Vec3 way = to_vec3(row.normal);
  std::vector<Separation>& all = of_[place];
  const double end = kAtItsEnd / mm_per_unit(animated_.asset());
  const auto is_under_way = [&](const Separation& old) {
    return gap(old, place.frame, turns) < -double{old.row.allowed} - end;
  };
  if (!all.empty() && to_vec3(all.back().row.normal).dot(way) < kSameWay &&
      std::any_of(all.begin(), all.end(), is_under_way)) {
    return;
  }
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const Separation& old) { return to_vec3(old.row.normal).dot(way) < 0; }),
            all.end());
  if (all.size() == kMemory) all.erase(all.begin());
  all.push_back(separation);
}

void Separations::add_constraints(double weight, const Turns& turns, std::vector<Constraint>& constraints) const {
  const double height = animated_.frame().height, arm = kArm * height;
  for (const auto& [place, separations] : of_) {
    if (separations.empty()) continue;
    const TurnedClip::Pose pose = clip_.pose(place.frame, turns);
    const std::vector<Vec3> now = clip_.turns_at(place.frame, turns);
    const double share = place.frame - std::floor(place.frame);
    const int first = static_cast<int>(place.frame);
    const std::set<Index> joints = joints_of_(place.part, place.other);
    for (const Separation& separation : separations) {
      const auto motion = [&](const SkinSpot& spot) {
        return motion_of(clip_, pose, animated_.character().source_positions, animated_.weights(), spot, now.data());
      };
      const SpotMotion at = motion(separation.at), other = motion(separation.at_other);
      const Vec3 way = to_vec3(separation.row.normal);
      Constraint constraint;
      constraint.weight = weight / (arm * arm);
      constraint.weight_above = separation.is_shallow ? kPullBack / (arm * arm) : 0;
      constraint.target = std::min(-double{separation.row.allowed} - way.dot(at.at - other.at), kFarthest * height);
      std::map<Index, Vec3> by;
      const auto add = [&](const SpotMotion& of, double sign) {
        for (const auto& [joint, moves] : of.by_joint) {
          if (!joints.contains(joint)) continue;
          by.try_emplace(joint, Vec3::Zero()).first->second += sign * moves.transpose() * way;
        }
      };
      add(at, 1);
      add(other, -1);
      for (const auto& [joint, d] : by) {
        constraint.target += d.dot(now[joint]);
        constraint.terms.push_back({first, joint, (1 - share) * d});
        if (share > 0) constraint.terms.push_back({first + 1, joint, share * d});
      }
      constraints.push_back(std::move(constraint));
    }
  }
}

}  // namespace spherechain::baker
