// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/part_joints.h"

#include <algorithm>
#include <iterator>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

constexpr double kCheap = 2.1;  // times the cheapest

}  // namespace

PartJoints::PartJoints(const AnimatedAsset& animated, const TurnedClip& clip, const std::vector<Index>& feet) {
  for (const BodyPart& part : body_parts_of(animated.asset()).parts) {
    above_.push_back(part.bone < 0 ? std::vector<Index>{} : clip.above(static_cast<Index>(part.bone)));
  }
  for (const TurningJoint& joint : clip.joints()) {
    costs_.push_back(principal_axes(joint.cost).values.minCoeff());
  }
  for (const Index foot : feet) {
    const std::vector<Index> all = clip.above_joint(foot);
    held_.insert(all.begin(), all.end());
  }
}

std::set<Index> PartJoints::cheap(std::uint32_t a, std::uint32_t b, double most, const std::set<Index>& without) const {
  const std::set<Index> one(above_[a].begin(), above_[a].end()), other(above_[b].begin(), above_[b].end());
  std::set<Index> out;
  std::set_symmetric_difference(one.begin(), one.end(), other.begin(), other.end(), std::inserter(out, out.end()));
  std::erase_if(out, [&](Index joint) { return without.contains(joint); });
  double least = HUGE_VAL;
  for (const Index joint : out) least = std::min(least, costs_[joint]);
  std::erase_if(out, [&](Index joint) { return costs_[joint] > most * least; });
  return out;
}

std::set<Index> PartJoints::parting(std::uint32_t a, std::uint32_t b, double most) const {
  return cheap(a, b, most, {});
}

std::set<Index> PartJoints::between(std::uint32_t a, std::uint32_t b) const { return cheap(a, b, kCheap, held_); }

std::vector<char> PartJoints::moved_by(const std::set<Index>& joints) const {
  std::vector<char> out;
  for (const std::vector<Index>& its : above_) {
    out.push_back(std::any_of(its.begin(), its.end(), [&](Index joint) { return joints.contains(joint); }) ? 1 : 0);
  }
  return out;
}

LimbInTrouble limb_in_trouble(const Goals& goals, const PartJoints& parts, std::size_t event,
                              const std::function<bool(const WorkingEvent&)>& is_included) {
  const auto joints_of = [&](std::size_t e) { return parts.between(goals.events[e].part, goals.events[e].other); };
  std::set<Index> joints = joints_of(event);
  LimbInTrouble out{{event}, {}, {}, goals.events[event].from(), goals.events[event].to(), {}};
  for (bool grows = !joints.empty(); grows;) {
    grows = false;
    for (std::size_t e = 0; e < goals.events.size(); ++e) {
      const WorkingEvent& other = goals.events[e];
      if (other.from() > out.to + 1 || other.to() < out.from - 1 || !is_included(other)) continue;
      if (std::find(out.events.begin(), out.events.end(), e) != out.events.end()) continue;
      const std::set<Index> its = joints_of(e);
      if (std::none_of(its.begin(), its.end(), [&](Index joint) { return joints.contains(joint); })) continue;
      out.events.push_back(e);
      joints.insert(its.begin(), its.end());
      out.from = std::min(out.from, other.from());
      out.to = std::max(out.to, other.to());
      grows = true;
    }
  }
  out.joints.assign(joints.begin(), joints.end());
  out.moves = parts.moved_by(joints);
  for (const std::size_t e : out.events) out.worst.push_back(goals.events[e].deepest());
  return out;
}

}  // namespace spherechain::baker
