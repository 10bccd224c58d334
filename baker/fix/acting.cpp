// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/acting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kSamples = 64;  // vertices of an end
constexpr double kMoveMin = 3e-4;     // heights: a smaller move is none
constexpr double kTurnMin = 0.1;      // degrees

// Thresholds of the verdict: half of a hand's width; a hand that lay on the belly hangs beside it; a fast twitch.
constexpr double kHumanHeight = 1700;                  // mm
constexpr double kSmallMove = 40, kVisibleMove = 100;  // mm on a body of that height
constexpr double kSmallTurn = 10, kVisibleTurn = 30;   // degrees
constexpr double kSmallStep = 1;                       // % of the height a frame

ActingVerdict verdict_on(double move, double turn, double step) {
  if (move == 0 && turn == 0) return ActingVerdict::kUnchanged;
  if (move > kVisibleMove || turn > kVisibleTurn) return ActingVerdict::kChangesPose;
  if (move > kSmallMove || turn > kSmallTurn || step > kSmallStep) return ActingVerdict::kVisible;
  return ActingVerdict::kSmall;
}

// The parts that an animator looks at: head, hands and feet; without any of them, each part on which no other hangs.
std::vector<std::uint32_t> ends_of(const std::vector<BodyPart>& parts) {
  std::vector<std::uint32_t> out, tips;
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const std::string& name = parts[p].name;  // "left hand", "right forefoot"
    if (name.ends_with("head") || name.ends_with("hand") || name.ends_with("foot")) out.push_back(p);
    const auto hangs = [&](const BodyPart& other) { return other.parent == static_cast<int>(p); };
    if (std::none_of(parts.begin(), parts.end(), hangs)) tips.push_back(p);
  }
  return out.empty() ? tips : out;
}

std::vector<Index> vertices_of(std::uint32_t part, const BodyParts& parts, const std::vector<Triangle>& triangles) {
  std::set<Index> all;
  for (std::size_t t = 0; t < parts.of_triangle.size() && t < triangles.size(); ++t) {
    if (parts.of_triangle[t] == part) all.insert(triangles[t].begin(), triangles[t].end());
  }
  std::vector<Index> out;
  const std::size_t step = std::max<std::size_t>(1, all.size() / kSamples);
  std::size_t i = 0;
  for (const Index vertex : all) {
    if (i++ % step == 0) out.push_back(vertex);
  }
  return out;
}

bool is_left_alone(const MendedEvent& event) {
  return event.outcome == MendOutcome::kFold || event.outcome == MendOutcome::kAccepted;
}

bool share(const std::vector<Index>& a, const std::vector<Index>& b) {
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

using Named = std::vector<std::pair<std::string, double>>;

void largest_first(Named& list, double least) {
  std::erase_if(list, [&](const auto& entry) { return !(entry.second >= least); });
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
}

}  // namespace

const char* verdict_name(ActingVerdict verdict) {
  static constexpr std::array<const char*, 4> kNames{"unchanged", "small", "visible", "changes_pose"};
  return kNames[static_cast<std::size_t>(verdict)];
}

ActingMeasure::ActingMeasure(const ClipFacts& facts, const Roles& roles) : facts_(facts), roles_(roles), first_{0} {
  const Character& character = facts.animated.character();
  const BodyParts parts = body_parts_of(facts.animated.asset());
  const std::vector<VertexWeights>& weights = facts.animated.weights();
  for (const std::uint32_t part : ends_of(parts.parts)) {
    for (const Index vertex : vertices_of(part, parts, character.source_triangles)) {
      rest_.push_back(character.source_positions[vertex]);
      weights_.push_back(weights[vertex]);
    }
    if (rest_.size() == first_.back()) continue;
    ends_.push_back(parts.parts[part].name);
    first_.push_back(rest_.size());
  }
}

std::vector<Vec3> ActingMeasure::places(int frame, const std::vector<Vec3>& turns) const {
  const TurnedClip::Pose pose = facts_.clip.pose_of(frame, turns);
  const std::vector<Vec3> skin = deform(rest_, weights_, pose.deformation.bones);
  std::vector<Vec3> out;
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = first_[e]; i < first_[e + 1]; ++i) sum += skin[i];
    out.emplace_back(sum / static_cast<double>(first_[e + 1] - first_[e]));
  }
  for (const Affine& axes : pose.axes) out.emplace_back(axes.translation());
  return out;
}

Acting ActingMeasure::measure(const Turns& turns, Frames frames) {
  const std::size_t count = facts_.clip.count();
  Acting out;
  out.from = frames.from;
  out.to = frames.to;
  for (const std::string& end : ends_) out.moves_mm.emplace_back(end, 0);
  for (const TurningJoint& joint : facts_.clip.joints()) {
    out.turns.emplace_back(facts_.clip.rig().nodes[joint.node].name, 0);
  }
  const auto animated = [&](int f) -> const std::vector<Vec3>& {
    std::vector<Vec3>& known = animated_[f];
    if (known.empty()) known = places(f, std::vector<Vec3>(count, Vec3::Zero()));
    return known;
  };
  std::vector<Vec3> last;  // as `moved`, of the frame before
  bool was_turned = false;
  for (int f = std::max(0, frames.from - 1); f <= frames.to; ++f) {
    const std::vector<Vec3> turned = facts_.clip.turns_at(f, turns);
    std::vector<Vec3> moved(ends_.size() + count, Vec3::Zero());
    const bool is_turned = std::any_of(turned.begin(), turned.end(), [](const Vec3& turn) { return !turn.isZero(0); });
    if (is_turned) {
      const std::vector<Vec3>& own = animated(f);
      moved = places(f, turned);
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i] -= own[i];
    }
    for (std::size_t e = 0; e < ends_.size() && f >= frames.from; ++e) {
      out.moves_mm[e].second = std::max(out.moves_mm[e].second, facts_.mm * moved[e].norm());
    }
    for (std::size_t j = 0; j < count && f >= frames.from; ++j) {
      out.turns[j].second = std::max(out.turns[j].second, to_degrees(turned[j].norm()));
    }
    const bool may_step = !last.empty() && (is_turned || was_turned);
    const std::vector<Vec3> none, &here = may_step ? animated(f) : none, &before = may_step ? animated(f - 1) : none;
    for (std::size_t i = 0; i < here.size(); ++i) {
      const Vec3 own = here[i] - before[i];
      const double longer = (own + moved[i] - last[i]).norm() - own.norm();
      out.step_percent = std::max(out.step_percent, 100 * longer / facts_.height);
    }
    last = std::move(moved);
    was_turned = is_turned;
  }
  largest_first(out.moves_mm, kMoveMin * facts_.height * facts_.mm);
  largest_first(out.turns, kTurnMin);
  out.verdict = verdict_on(out.move_mm() * kHumanHeight / (facts_.mm * facts_.height),
                           out.turns.empty() ? 0 : out.turns.front().second, out.step_percent);
  return out;
}

Acting ActingMeasure::of_event(const std::vector<MendedEvent>& events, std::size_t event, const Turns& turns) {
  const int last = facts_.clip.frames() - 1, pad = static_cast<int>(std::ceil(kWindowPad * facts_.clip.fps()));
  const int from = static_cast<int>(events[event].before.from), to = static_cast<int>(events[event].before.to);
  const Frames window{std::max(0, from - pad), std::min(last, to + pad)};
  Acting out;
  if (!is_left_alone(events[event])) {
    const std::vector<Index> joints = joints_of_event(events[event], facts_, roles_);
    Frames own = window;
    for (std::size_t e = 0; e < events.size(); ++e) {
      if (e == event || is_left_alone(events[e]) || !share(joints, joints_of_event(events[e], facts_, roles_)))
        continue;
      const int its_from = static_cast<int>(events[e].before.from), its_to = static_cast<int>(events[e].before.to);
      if (its_to < from) own.from = std::max(own.from, (its_to + from + 1) / 2);
      if (its_from > to) own.to = std::min(own.to, (its_from + to) / 2);
    }
    Turns alone(turns.size(), Vec3::Zero());
    for (int f = std::max(0, own.from - 1); f <= own.to; ++f) {
      for (const Index joint : joints) {
        const std::size_t i = static_cast<std::size_t>(f) * facts_.clip.count() + joint;
        alone[i] = turns[i];
      }
    }
    out = measure(alone, own);
  }
  out.from = window.from;
  out.to = window.to;
  return out;
}

std::vector<Index> joints_of_event(const MendedEvent& event, const ClipFacts& facts, const Roles& roles) {
  const auto limb_of = [&](Index joint) {
    const Index node = facts.clip.joints()[joint].node;
    return node < roles.of_node.size() ? roles.of_node[node].limb : -1;
  };
  std::set<Index> out;
  std::set<int> limbs;
  for (const std::uint32_t part : {event.part, event.other}) {
    for (const Index joint : facts.parts.above(part)) {
      out.insert(joint);
      limbs.insert(limb_of(joint));
    }
  }
  limbs.erase(-1);
  for (Index joint = 0; joint < facts.clip.count(); ++joint) {
    if (limbs.contains(limb_of(joint))) out.insert(joint);
  }
  return {out.begin(), out.end()};
}

}  // namespace spherechain::baker
