// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_characters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace spherechain::bench {

using baker::Affine, baker::Deformation, baker::Vec3;

namespace {

constexpr double kHeight = 1.75, kShoulders = 1.4;  // metres
constexpr double kLater = 0.5;                      // seconds: else two of a kind would move as one

sc_transform transform_of(const Affine& affine, double scale) {
  const Eigen::Quaterniond turn(Eigen::Matrix3d(affine.linear() / scale));
  const auto part = [](double x) { return static_cast<float>(x); };
  return {{part(affine(0, 3)), part(affine(1, 3)), part(affine(2, 3))},
          {part(turn.x()), part(turn.y()), part(turn.z()), part(turn.w())},
          {part(scale), part(scale), part(scale)}};
}

}  // namespace

TwoCharacters::Character::Character(const baker::AnimatedAsset& own, const baker::AnimatedAsset& other, Target target,
                                    int first)
    : animated(own),
      joints(own),
      responder(own, target, 0, &other.asset()),
      meter(own, target),
      skin(own.asset(), target, &other.asset()),
      later(first) {
  const baker::BodyFrame body = own.frame();
  upright.linear() << body.left.transpose(), body.up.transpose(), body.forward.transpose();
  upright = Eigen::Scaling(kHeight / body.height) * upright * Eigen::Translation3d(-body.origin);
  const auto [left, right] = shoulders(later);
  Vec3 across = left - right;
  across.y() = 0;
  upright = Eigen::Quaterniond::FromTwoVectors(across, Vec3::UnitX()) * upright;
}

// Puts the middle of its shoulders over `where`.
void TwoCharacters::Character::stand(const Affine& where, int frame) {
  const auto [left, right] = shoulders(frame);
  to_world = where * Eigen::Translation3d(Vec3(0, kShoulders, 0) - (left + right) / 2) * upright;
  place = transform_of(to_world, kHeight / animated.frame().height);
}

std::pair<Vec3, Vec3> TwoCharacters::Character::shoulders(int frame) const {
  const Deformation pose = animated.deformation(frame);
  const baker::OpenAsset& asset = animated.asset();
  Vec3 left = Vec3::Zero(), right = Vec3::Zero();
  for (std::uint32_t part = 0; part < asset->part_count(); ++part) {
    const std::string_view name = asset.model().part_name(part);
    const std::int32_t bone = asset.model().part(part).bone;
    if (bone < 0 || !name.ends_with(" upper arm")) continue;
    (name.starts_with("left") ? left : right) = upright * joints.place_of(pose, static_cast<std::size_t>(bone));
  }
  return {left, right};
}

Deformation TwoCharacters::Character::placed(const Deformation& pose) const {
  Deformation out = pose;
  for (Affine& bone : out.bones) bone = to_world * bone;
  return out;
}

TwoCharacters::TwoCharacters(const baker::AnimatedAsset& first, const baker::AnimatedAsset& second, Target target,
                             Stance stance, double metres)
    : first_(first, second, target, 0),
      second_(second, first, target, static_cast<int>(kLater * second.fps())),
      stance_(stance),
      metres_(metres) {}

// Where the second stands; the first is at the origin and looks along z.
Affine TwoCharacters::second_at(double seconds) const {
  Affine out = Affine::Identity();
  out.translation() = stance_ == Stance::kFacing ? Vec3(0, 0, metres_) : Vec3(metres_, 0, 0);
  if (stance_ == Stance::kPassing) out.translation().z() = std::sin(std::numbers::pi / 2 * seconds);
  if (stance_ != Stance::kBeside) out.rotate(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitY()));
  return out;
}

int TwoCharacters::frame_count() const {
  return std::min(first_.animated.frame_count(), second_.animated.frame_count() - second_.later);
}

void TwoCharacters::measure(const std::array<Deformation, 2>& poses, baker::ArmPose& arms, bool& is_faulty) {
  const baker::BonePose first(first_.animated.asset(), poses[0]), second(second_.animated.asset(), poses[1]);
  first_.skin.set_pose(first.pose());
  second_.skin.set_pose(second.pose());
  is_faulty = false;
  for (const Penetration& found : first_.skin.measure(second_.skin, false)) {
    if (!baker::is_deep_fault(found)) continue;
    is_faulty = true;
    if (baker::is_of_arm(first_.animated.asset().model().part_name(found.part)) ||
        baker::is_of_arm(second_.animated.asset().model().part_name(found.other))) {
      arms.faults.push_back(found);
    }
  }
}

TwoCharacters::Frame TwoCharacters::frame(int number) {
  Frame out;
  first_.stand(Affine::Identity(), number);
  second_.stand(second_at(number / second_.animated.fps()), number + second_.later);
  Character* const both[] = {&first_, &second_};
  // As docs/response.md says: bodies are posed as animated first. The second then finds the first as corrected.
  const Deformation animated = second_.placed(second_.animated.deformation(number + second_.later));
  const baker::BonePose pose(second_.animated.asset(), animated);
  baker::check_runtime(second_.responder.body().set_pose(pose.pose()));
  out.us = 0;
  out.starts_clip = false;
  for (std::size_t i = 0; i < 2; ++i) {
    Character& own = *both[i];
    const baker::Responder::Corrected made =
        own.responder.correct(number + own.later, &own.place, &both[1 - i]->responder.body());
    out.us += made.us;
    out.starts_clip = out.starts_clip || number == 0 || made.starts_clip;
    out.animated[i] = own.placed(made.animated);
    out.corrected[i] = own.placed(made.corrected);
    out.alone_before[i] = own.meter.look_at(made.animated);
    out.alone_after[i] = made.is_turned ? own.meter.look_at(made.corrected) : out.alone_before[i];
    const auto add = [&](const std::vector<Vec3>& from, std::vector<Vec3>& to) {
      for (const Vec3& place : from) to.push_back(own.to_world * place);
    };
    add(out.alone_before[i].wrists, out.before.wrists);
    add(out.alone_before[i].elbows, out.before.elbows);
    add(out.alone_after[i].wrists, out.after.wrists);
    add(out.alone_after[i].elbows, out.after.elbows);
  }
  measure(out.animated, out.before, out.is_faulty_before);
  measure(out.corrected, out.after, out.is_faulty_after);
  return out;
}

}  // namespace spherechain::bench
