// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/pushes.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {
namespace {

constexpr double kSameWay = 0.5;    // cosine
constexpr double kAtItsEnd = 0.5;   // mm
constexpr std::size_t kMemory = 4;  // pushes of a place
// Lengths, in heights.
constexpr double kArm = 0.3;        // an arm's
constexpr double kFarthest = 0.03;  // what a push asks for in a round, at most
// Weights of a miss of an arm's length, against a radian of a shoulder.
constexpr double kPullBack = 500;  // of what was shallow, where it is too far

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

double Pushes::gap(const Push& push, double frame, const Turns& turns) const {
  const TurnedClip::Pose pose = clip_.pose(frame, turns);
  const std::vector<Vec3> now = clip_.turns_at(frame, turns);
  const auto at = [&](const SkinSpot& spot) {
    return motion_of(clip_, pose, animated_.character().source_positions, animated_.weights(), spot, now.data()).at;
  };
  return push.way.dot(at(push.b) - at(push.a));
}

void Pushes::add(const MeetingPlace& place, const Penetration& found, double target, bool is_shallow,
                 const Turns& turns) {
  const Character& character = animated_.character();
  const Push push{spot_of(character, found.deepest_other), spot_of(character, found.deepest), to_vec3(found.direction),
                  target, is_shallow};
  std::vector<Push>& all = of_[place];
  const double end = kAtItsEnd / mm_per_unit(animated_.asset());
  const auto is_under_way = [&](const Push& old) { return gap(old, place.frame, turns) < old.target - end; };
  if (!all.empty() && all.back().way.dot(push.way) < kSameWay && std::any_of(all.begin(), all.end(), is_under_way)) {
    return;
  }
  all.erase(std::remove_if(all.begin(), all.end(), [&](const Push& old) { return old.way.dot(push.way) < 0; }),
            all.end());
  if (all.size() == kMemory) all.erase(all.begin());
  all.push_back(push);
}

void Pushes::add_wishes(double weight, const Turns& turns, std::vector<Wish>& wishes) const {
  const double height = animated_.frame().height, arm = kArm * height;
  for (const auto& [place, pushes] : of_) {
    if (pushes.empty()) continue;
    const TurnedClip::Pose pose = clip_.pose(place.frame, turns);
    const std::vector<Vec3> now = clip_.turns_at(place.frame, turns);
    const double share = place.frame - std::floor(place.frame);
    const int first = static_cast<int>(place.frame);
    for (const Push& push : pushes) {
      const auto motion = [&](const SkinSpot& spot) {
        return motion_of(clip_, pose, animated_.character().source_positions, animated_.weights(), spot, now.data());
      };
      const SpotMotion a = motion(push.a), b = motion(push.b);
      Wish wish;
      wish.weight = weight / (arm * arm);
      wish.weight_over = push.is_shallow ? kPullBack / (arm * arm) : 0;
      wish.value = std::min(push.target - push.way.dot(b.at - a.at), kFarthest * height);
      std::map<Index, Vec3> by;
      const auto add = [&](const SpotMotion& of, double sign) {
        for (const auto& [joint, moves] : of.by_joint) {
          by.try_emplace(joint, Vec3::Zero()).first->second += sign * moves.transpose() * push.way;
        }
      };
      add(b, 1);
      add(a, -1);
      for (const auto& [joint, d] : by) {
        wish.value += d.dot(now[joint]);
        wish.parts.push_back({first, joint, (1 - share) * d});
        if (share > 0) wish.parts.push_back({first + 1, joint, share * d});
      }
      wishes.push_back(std::move(wish));
    }
  }
}

}  // namespace spherechain::baker
