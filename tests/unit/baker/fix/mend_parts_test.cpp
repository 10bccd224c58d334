// SPDX-License-Identifier: GPL-3.0-or-later
// The parts that a mend is made of, on a human of sticks whose every frame is its rest pose.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "baker/fix/constraints.h"
#include "baker/fix/goals.h"
#include "baker/fix/joints.h"
#include "baker/fix/obstacle.h"
#include "baker/fix/part_joints.h"
#include "baker/fix/smoothing.h"
#include "baker/fix/solve.h"
#include "baker/fix/step_limit.h"
#include "baker/fix/time_windows.h"
#include "baker/fix/ways_out.h"
#include "baker/fix/working_event.h"
#include "named_rig.h"

using namespace spherechain::baker;

namespace {

constexpr double kStickHeight = 1.75, kDegree = std::numbers::pi / 180;
constexpr int kClipFrames = 60;

const NamedRig& sticks() {
  static const NamedRig rig = named_rig(R"(
pelvis = pelvis
  spine = spine
    chest = chest
      upper_arm.L = left_shoulder
        forearm.L = left_elbow
          hand.L = left_wrist
            fingers.L = left_finger
      upper_arm.R = right_shoulder
        forearm.R = right_elbow
          hand.R = right_wrist
            fingers.R = right_finger
  thigh.L = left_hip
    shin.L = left_knee
      foot.L = left_ankle
        toe.L = left_toe
)");
  return rig;
}

Index node(const std::string& name) {
  const auto& nodes = sticks().rig.nodes;
  for (Index n = 0; n < nodes.size(); ++n) {
    if (nodes[n].name == name) return n;
  }
  throw std::runtime_error(name);
}

Channel rotations(const std::string& name, const Vec3& axis, const std::vector<double>& degrees) {
  Channel out{ChannelPath::kRotation, node(name), Interpolation::kLinear, {}, {}};
  for (std::size_t i = 0; i < degrees.size(); ++i) {
    out.times.push_back(static_cast<double>(i) / 30);
    const Eigen::Quaterniond q(Eigen::AngleAxisd(degrees[i] * kDegree, axis));
    out.values.insert(out.values.end(), {q.x(), q.y(), q.z(), q.w()});
  }
  return out;
}

// A clip, and these of its joints.
struct Sticks {
  Clip clip{"still", (kClipFrames - 1) / 30.0, {}, 0};
  std::vector<TurningJoint> joints;
  TurnedClip turned;
  Turns turns;

  explicit Sticks(const std::vector<std::string>& names, std::vector<Channel> channels = {})
      : clip{"still", (kClipFrames - 1) / 30.0, std::move(channels), 0},
        joints(turning(names)),
        turned(sticks().rig, clip, 30, kClipFrames, joints),
        turns(kClipFrames * joints.size(), Vec3::Zero()) {}

  std::vector<TurningJoint> turning(const std::vector<std::string>& names) const {
    const Roles roles = find_roles(sticks().rig, sticks().positions);
    std::vector<TurningJoint> out;
    for (const TurningJoint& joint : turning_joints(sticks().rig, roles, clip)) {
      for (const std::string& name : names) {
        if (joint.node == node(name)) out.push_back(joint);
      }
    }
    REQUIRE(out.size() == names.size());
    return out;
  }

  Vec3 at(int frame, Index joint) const { return turned.pose(frame, turns).axes[joint].translation(); }

  // Gauss-Newton: moves a joint by `by` under the constraints that `hold` adds.
  template <typename Hold>
  void move(int frame, Index joint, const Vec3& by, const Hold& hold) {
    const Vec3 to = at(frame, joint) + by;
    for (int round = 0; round < 12; ++round) {
      std::vector<Constraint> constraints;
      const TurnedClip::Pose pose = turned.pose(frame, turns);
      const std::vector<Vec3> now = turned.turns_at(frame, turns);
      const Vec3 here = pose.axes[joint].translation();
      for (int axis = 0; axis < 3; ++axis) {
        Constraint constraint;
        constraint.weight = constraint.weight_above = 1e4;
        constraint.target = to[axis] - here[axis];
        for (const Index above : turned.above_joint(joint)) {
          const Vec3 d = turn_moves(pose.axes[above], here, now[above]).row(axis).transpose();
          constraint.target += d.dot(now[above]);
          constraint.terms.push_back({frame, above, d});
        }
        constraints.push_back(constraint);
      }
      for (int f = 0; f < kClipFrames; ++f) hold(f, constraints);
      turns = solve_turns(turned, std::vector<char>(kClipFrames, 1), constraints, turns, 0);
    }
  }
};

}  // namespace

TEST_CASE("mend: a foot that is pinned stays, whatever its knee does") {
  Sticks s({"thigh.L", "shin.L", "foot.L"}), loose({"thigh.L", "shin.L", "foot.L"});
  const Vec3 foot = s.at(30, 2);
  const auto pins = [&](int f, std::vector<Constraint>& constraints) {
    add_pinned_joints(s.turned, {2}, f, kStickHeight, s.turns, constraints);
  };
  s.move(30, 1, {0.02, 0, 0}, pins);
  CHECK(s.turns[30 * s.turned.count()].norm() > 0.1 * kDegree);
  CHECK((s.at(30, 2) - foot).norm() < 1e-4);
  CHECK((s.turned.pose(30, s.turns).axes[2].linear() - Eigen::Matrix3d::Identity()).norm() < 0.01);
  loose.move(30, 1, {0.02, 0, 0}, [](int, std::vector<Constraint>&) {});
  CHECK((loose.at(30, 2) - foot).norm() > 0.01);
}

TEST_CASE("mend: a step limit allows a step as far as it goes, to first order") {
  Sticks s({"upper_arm.L", "forearm.L", "hand.L"});
  const auto turn = [&](int frame, Index joint) -> Vec3& {
    return s.turns[static_cast<std::size_t>(frame) * s.turned.count() + joint];
  };
  for (int f = 30; f < kClipFrames; ++f) turn(f, 0) = {0.05, 0.1, 0.2};
  std::vector<Constraint> limits;
  add_step_limits(s.turned, kStickHeight, s.turns, limits);
  REQUIRE(limits.size() == 2);  // the forearm's joint and the hand step into frame 30; the upper arm's joint does not
  const auto over = [&](const Constraint& limit) {
    double sum = -limit.target;
    for (const Constraint::Term& term : limit.terms) sum += term.by.dot(turn(term.frame, term.joint));
    return sum;
  };
  const auto step = [&](std::size_t end) {
    return kStickHeight * (EndSteps(s.turned, s.turns, kStickHeight).extra(end, 30) - EndSteps::kStepTarget);
  };
  for (std::size_t i = 0; i < limits.size(); ++i) {
    CHECK(limits[i].weight == 0);
    CHECK(over(limits[i]) == doctest::Approx(step(i + 1)));
  }
  const double before[] = {step(1), step(2)};
  turn(29, 0) = {0.002, -0.001, 0.001};
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const double longer = step(i + 1) - before[i];
    CHECK(std::abs(longer) > 1e-4);
    CHECK(std::abs(over(limits[i]) - before[i] - longer) < 0.03 * std::abs(longer));
  }
}

TEST_CASE("mend: hands that hold one thing keep their grip") {
  Sticks s({"upper_arm.L", "forearm.L", "hand.L", "upper_arm.R", "forearm.R", "hand.R"});
  const auto seen = [&] {
    const TurnedClip::Pose pose = s.turned.pose(30, s.turns);
    return Affine(pose.axes[5].inverse() * pose.axes[2]);
  };
  const Affine before = seen();
  const Vec3 hand = s.at(30, 2);
  const auto holds = [&](int f, std::vector<Constraint>& constraints) {
    add_hand_constraint(s.turned, 2, 5, f, kStickHeight, s.turns, constraints);
  };
  s.move(30, 2, {0, 0.03, 0}, holds);
  CHECK((s.at(30, 2) - hand).norm() > 0.02);
  CHECK((seen().matrix() - before.matrix()).norm() < 0.01);
}

TEST_CASE("mend: it sees which hands stand, and which hold one thing") {
  // At rest the hands are far from the ground and from each other.
  const std::vector<std::string> names{"upper_arm.L", "hand.L", "upper_arm.R", "hand.R", "foot.L"};
  const Vec3 up(0, 1, 0), forward(0, 0, 1);
  const Sticks still(names);
  for (const auto& hands : planted_hands(still.turned, {1, 3}, {4}, up, kStickHeight)) CHECK(hands.empty());
  for (const char holds : frames_with_joined_hands(still.turned, 1, 3, kStickHeight)) CHECK(holds == 0);
  // The body bends over: a ground as high as the hands is one that they stand on.
  CHECK(planted_hands(still.turned, {1, 3}, {1}, up, kStickHeight)[30] == std::vector<Index>{1, 3});
  // Arms across the body, still but for the last frames.
  std::vector<double> left(kClipFrames, -75), right(kClipFrames, 75);
  for (int f = 45; f < kClipFrames; ++f) left[static_cast<std::size_t>(f)] += 3 * (f - 44);
  const Sticks held(names, {rotations("upper_arm.L", forward, left), rotations("upper_arm.R", forward, right)});
  const std::vector<char> holds = frames_with_joined_hands(held.turned, 1, 3, 2 * kStickHeight);
  CHECK(holds[20] == 1);
  CHECK(holds[50] == 0);
}

TEST_CASE("mend: an elbow bends, but not backward") {
  // The clip bends it by up to 40 degrees, about one axis.
  std::vector<double> bends(kClipFrames);
  for (int f = 0; f < kClipFrames; ++f) bends[static_cast<std::size_t>(f)] = 40.0 * f / (kClipFrames - 1);
  const auto& rig = sticks().rig;
  const Vec3 upper = rig.nodes[node("forearm.L")].translation.normalized(),
             axis = upper.cross(Vec3(0, 0, 1)).normalized();
  const Sticks s({"forearm.L"}, {rotations("forearm.L", axis, bends)});
  REQUIRE(s.joints[0].hinge);
  const double straight = s.turned.bend(0, 0), bent = s.turned.bend(kClipFrames - 1, 0);
  CHECK(bent - straight == doctest::Approx(40 * kDegree).epsilon(0.05));
  const Vec3 hinge = s.joints[0].hinge->axis;
  CHECK(hinge.dot(s.turned.within_limits(0, 0, 0.3 * hinge, 1)) == doctest::Approx(0.3));
  CHECK(std::abs(hinge.dot(s.turned.within_limits(0, 0, -0.3 * hinge, 1)) + straight) < 0.02);  // it is straight then
  CHECK(hinge.dot(s.turned.within_limits(kClipFrames - 1, 0, -0.3 * hinge, 1)) == doctest::Approx(-0.3));
  CHECK(s.turned.within_limits(kClipFrames - 1, 0, 0.3 * hinge, 0.1).norm() == doctest::Approx(0.1));
  // A turn aside bends it backward, too: straightened, it still turns no farther than allowed.
  for (int aside = 0; aside < 12; ++aside) {
    const Vec3 out = Eigen::AngleAxisd(30 * kDegree * aside, upper) * Vec3(hinge);
    CHECK(s.turned.within_limits(0, 0, 3 * out, 0.5).norm() < 0.5 + 1e-9);
  }
}

TEST_CASE("mend: a way out turns as little as it must, and changes sides only where it must") {
  Sticks s({"upper_arm.L"});
  const LimbInTrouble limb{{0}, {0}, {}, 10, 40, {25}};
  // Two ways lead out, about z: early one side, late the other; between them the shorter one changes by the frame.
  const auto evaluate = [&](const std::vector<TriedPose>& poses) {
    std::vector<double> out;
    for (const TriedPose& pose : poses) {
      const double z = pose.turns[0].z(), even = pose.frame % 2 == 0 ? 0.5 : -0.5;
      const double left = (pose.frame < 18 ? 40 : 10 + even) * kDegree,
                   right = (pose.frame > 32 ? 40 : 10 - even) * kDegree;
      out.push_back(std::max(0.0, std::min(left + z, right - z)));
    }
    return out;
  };
  const auto way = find_way_out(s.turned, limb, 25 * kDegree, s.turns, evaluate);
  REQUIRE(way.size() == 31);
  int changes = 0;
  for (const auto& [frame, turns] : way) {
    CHECK(evaluate({{frame, turns}})[0] == 0);
    CHECK(std::abs(turns[0].z()) > 9 * kDegree);
    CHECK(std::abs(turns[0].z()) < 12 * kDegree);
    if (frame > 10 && turns[0].z() * way.at(frame - 1)[0].z() < 0) ++changes;
  }
  CHECK(changes == 1);
  // Nothing leads out: what is best within the budget.
  const auto never = [](const std::vector<TriedPose>& poses) {
    std::vector<double> out;
    for (const TriedPose& pose : poses) out.push_back(1 - pose.turns[0].z());
    return out;
  };
  for (const auto& [frame, turns] : find_way_out(s.turned, limb, 25 * kDegree, s.turns, never)) {
    CHECK(turns[0].z() == doctest::Approx(25 * kDegree).epsilon(0.01));
  }
}

TEST_CASE("mend: it says why a limb stays where it is") {
  const Sticks s({"forearm.L"});
  REQUIRE(s.joints[0].hinge);
  const Vec3 hinge = s.joints[0].hinge->axis, along = sticks().rig.nodes[node("hand.L")].translation.normalized();
  const LimbInTrouble limb{{0}, {0}, {}, 10, 40, {25}};
  // The limb is free once the forearm points so many degrees forward; backward where they are negative.
  const auto obstacle_of = [&](double degrees) {
    const Vec3 wanted = (degrees < 0 ? -1 : 1) * hinge.cross(along);
    return find_obstacle(s.turned, limb, 25, 25, [&](const std::vector<TriedPose>& poses) {
      std::vector<double> out;
      for (const TriedPose& pose : poses) {
        const Vec3 turn = pose.turns[0], now = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()) * along;
        out.push_back(std::max(0.0, std::sin(std::abs(degrees) * kDegree) - now.dot(wanted)));
      }
      return out;
    });
  };
  CHECK(obstacle_of(20).outcome == MendOutcome::kNoWayOut);  // it is free alone: another limb is in its way
  CHECK(obstacle_of(40).outcome == MendOutcome::kOverBudget);
  CHECK(obstacle_of(40).needed_degrees >= 40);
  CHECK(obstacle_of(40).needed_degrees < 50);
  CHECK(obstacle_of(-60).outcome == MendOutcome::kJointLimits);
  const auto never = [](const std::vector<TriedPose>& poses) { return std::vector<double>(poses.size(), 1); };
  CHECK(find_obstacle(s.turned, limb, 25, 25, never).outcome == MendOutcome::kNoWayOut);
}

TEST_CASE("mend: a joint that shakes or jumps is seen and calmed; one that swings is let be") {
  Sticks s({"upper_arm.L", "forearm.L", "hand.L", "upper_arm.R", "hand.R"});
  for (int f = 0; f < kClipFrames; ++f) {
    const std::size_t first = static_cast<std::size_t>(f) * s.turned.count();
    s.turns[first] = {0, 0, f % 2 == 0 ? 0.1 : 0.14};
    s.turns[first + 3] = {0, 0, 0.1 + 0.05 * std::sin(f / 8.0)};
  }
  const MarkedTurns shaking = shaking_turns(s.turned, s.turns, kStickHeight);
  CHECK(shaking.count(0) == 1);
  CHECK(shaking.count(3) == 0);
  calm_turns(s.turned, kStickHeight, false, s.turns);
  CHECK(shaking_turns(s.turned, s.turns, kStickHeight).empty());
  CHECK(s.turns[30 * s.turned.count()].z() == doctest::Approx(0.12).epsilon(0.05));
  // An arm that is turned for ten frames only: it then turns longer, and its hand moves by no step.
  for (int f = 0; f < kClipFrames; ++f) {
    s.turns[static_cast<std::size_t>(f) * s.turned.count()] = {0, 0, f >= 25 && f < 35 ? 0.3 : 0};
  }
  CHECK(shaking_turns(s.turned, s.turns, kStickHeight).at(0)[25] == 1);
  calm_turns(s.turned, kStickHeight, false, s.turns);
  CHECK(shaking_turns(s.turned, s.turns, kStickHeight).empty());
  CHECK(s.turns[30 * s.turned.count()].z() > 0.2);
  CHECK(s.turns[20 * s.turned.count()].z() > 0.05);
}

TEST_CASE("mend: turns are calmed and fade over a loop's seam") {
  Sticks s({"upper_arm.L", "forearm.L", "hand.L"});
  const std::size_t count = s.turned.count(), last = (kClipFrames - 1) * count;
  for (int f = 48; f < 57; ++f) s.turns[static_cast<std::size_t>(f) * count] = {0, 0, 0.3};
  calm_turns(s.turned, kStickHeight, true, s.turns);
  CHECK((s.turns[last] - s.turns[0]).norm() < 1e-9);
  CHECK(s.turns[0].z() > 0.05);
  std::vector<char> marked(kClipFrames, 0);
  marked.back() = 1;
  fade_out(s.turned, 0, marked, 0.2, 0, true, s.turns);
  CHECK(s.turns[0].norm() + s.turns[last].norm() == 0);
}

// A hand that goes into a part of one skin with it, in these frames.
std::vector<PosePenetration> faults_in(std::uint32_t part, std::uint32_t other, int from, int to, bool is_one_piece) {
  std::vector<PosePenetration> out;
  for (int f = from; f <= to; ++f) {
    spherechain::Penetration found{};
    found.part = part;
    found.other = other;
    found.kind = SC_CLASS_PENETRATION;
    found.measures.depth = found.fault_depth = 0.05F;
    found.measures.is_one_piece = is_one_piece ? 1 : 0;
    found.measures.rest_distance = 1;
    out.push_back({static_cast<double>(f), found});
  }
  return out;
}

TEST_CASE("mend: flesh on flesh is left unless it is asked for; what is a fault only to a strict eye stays as it is") {
  std::vector<BodyPart> parts(3);
  parts[0] = {"abdomen", Side::kNone, 0, -1, 0};
  parts[1] = {"left thigh", Side::kLeft, 1, 0, 3};
  parts[2] = {"left hand", Side::kLeft, 2, 0, 8};
  const auto leave = [](const Event&) { return false; };
  const auto goals = [&](std::uint32_t part, bool is_one_piece, bool is_soft_parted) {
    MendOptions options;
    options.is_soft_parted = is_soft_parted;
    return goals_of(faults_in(part, 0, 5, 25, is_one_piece), faults_in(part, 0, 10, 20, is_one_piece), 60, parts, 1000,
                    options, leave);
  };
  CHECK(goals(1, true, false).events.at(0).state == WorkingState::kFold);
  CHECK(goals(1, true, true).events.at(0).state == WorkingState::kOpen);
  CHECK(goals(1, false, false).events.at(0).state == WorkingState::kOpen);  // trousers
  const Goals hand = goals(2, true, false);
  CHECK(hand.events.at(0).from() == 10);
  CHECK(hand.too_deep(faults_in(2, 0, 15, 15, true)[0]) == doctest::Approx(0.05));
  CHECK(hand.too_deep(faults_in(2, 0, 6, 6, true)[0]) == doctest::Approx(0.05));
  const Goals thigh = goals(1, true, false);
  CHECK(thigh.too_deep(faults_in(1, 0, 6, 6, true)[0]) == 0);
  CHECK(thigh.too_deep(faults_in(1, 0, 40, 40, true)[0]) == doctest::Approx(0.05));  // new
}

TEST_CASE("mend: what lies together in time is one span, over a loop's seam too") {
  const std::vector<char> windows{1, 1, 0, 0, 1, 0, 1};
  using Spans = std::vector<std::vector<std::size_t>>;
  CHECK(contiguous_runs(windows, false) == Spans{{0, 1}, {4}, {6}});
  CHECK(contiguous_runs(windows, true) == Spans{{0, 1, 6}, {4}});
}

TEST_CASE("mend: windows open around a frame, and over a loop's seam") {
  const Sticks s({"upper_arm.L"});
  const int pad = static_cast<int>(std::ceil(kWindowPad * s.turned.fps()));
  const std::vector<int> middle = marked_frames(windows_around({30}, s.turned, false));
  CHECK(middle.front() == 30 - pad);
  CHECK(middle.back() == 31 + pad);  // a penetration may lie between a frame and the next
  CHECK(middle.size() == static_cast<std::size_t>(2 * pad + 2));
  CHECK(marked_frames(windows_around({0}, s.turned, false)).back() == 1 + pad);
  CHECK(marked_frames(windows_around({0}, s.turned, true)).back() == kClipFrames - 1);
}

TEST_CASE("mend: a residual gets better only if it falls clearly") {
  LeastResidual least;
  CHECK(least.gets_better(10, 0));
  CHECK(!least.gets_better(9.5, 1));
  CHECK(least.round == 0);
  CHECK(least.gets_better(8, 2));
  CHECK(least.round == 2);
  CHECK(least.value == 8);
}

TEST_CASE("mend: an event contains penetrations of its parts up to a frame away") {
  Event found;
  found.from = 10;
  found.to = 12;
  const WorkingEvent event{found, 3, 5};
  CHECK(event.is_open());
  CHECK(event.contains({9.5, 3, 5}));
  CHECK(event.contains({13, 3, 5}));
  CHECK(!event.contains({13.5, 3, 5}));
  CHECK(!event.contains({11, 3, 4}));
}
