// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_characters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <stdexcept>
#include <string>

namespace spherechain::bench {

using baker::Affine, baker::Deformation, baker::Vec3;

namespace {

constexpr double kHeight = 1.75, kLater = 0.5;  // metres; seconds: else two of a kind would move as one

sc_transform transform_of(const Affine& affine, double scale) {
  const Eigen::Quaterniond turn(Eigen::Matrix3d(affine.linear() / scale));
  const auto part = [](double x) { return static_cast<float>(x); };
  return {{part(affine(0, 3)), part(affine(1, 3)), part(affine(2, 3))},
          {part(turn.x()), part(turn.y()), part(turn.z()), part(turn.w())},
          {part(scale), part(scale), part(scale)}};
}

BodyDef meets(const baker::OpenAsset& other) {
  BodyDef def;
  def.largest_other = other.model().handle();
  return def;
}

}  // namespace

TwoCharacters::Character::Character(const baker::AnimatedAsset& own, const baker::AnimatedAsset& other, Target target,
                                    int first)
    : animated(own),
      joints(own),
      responder(own, target, 0, &other.asset()),
      meter(own, target),
      skin(own.asset(), target, &other.asset()),
      looker(own.asset().model(), meets(other.asset())),
      later(first) {}

// Puts the middle of its shoulders in this frame above `where`, and its soles at rest on the floor, y = 0. It looks
// along z there.
void TwoCharacters::Character::stand(const Affine& where, int frame) {
  const baker::BodyFrame body = animated.frame();
  const double scale = kHeight / body.height;
  Affine upright = Affine::Identity();
  upright.linear() << body.left.transpose(), body.up.transpose(), body.forward.transpose();
  upright = Eigen::Scaling(scale) * upright * Eigen::Translation3d(-body.origin);
  const Deformation pose = animated.deformation(frame);
  Vec3 left = upright * shoulder(pose, "left upper arm"), right = upright * shoulder(pose, "right upper arm");
  left.y() = right.y() = 0;
  upright = Eigen::Quaterniond::FromTwoVectors(left - right, Vec3::UnitX()) *
            Eigen::Translation3d(-(left + right) / 2) * upright;
  to_world = where * upright;
  place = transform_of(to_world, scale);
}

Vec3 TwoCharacters::Character::shoulder(const Deformation& pose, std::string_view name) const {
  const baker::OpenAsset& asset = animated.asset();
  for (std::uint32_t part = 0; part < asset->part_count(); ++part) {
    const std::int32_t bone = asset.model().part(part).bone;
    if (asset.model().part_name(part) == name && bone >= 0)
      return joints.place_of(pose, static_cast<std::size_t>(bone));
  }
  throw std::runtime_error("no " + std::string(name));
}

Deformation TwoCharacters::Character::placed(const Deformation& pose) const {
  Deformation out = pose;
  for (Affine& bone : out.bones) bone = to_world * bone;
  return out;
}

TwoCharacters::TwoCharacters(const baker::AnimatedAsset& first, const baker::AnimatedAsset& second, Target target,
                             Stance stance, double metres, Seen seen)
    : first_(first, second, target, 0),
      second_(second, first, target, static_cast<int>(kLater * second.fps())),
      seen_(seen) {
  Affine where = Affine::Identity();
  where.translation() = stance == Stance::kFacing ? Vec3(0, 0, metres) : Vec3(metres, 0, 0);
  if (stance != Stance::kBeside) where.rotate(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitY()));
  const int met = stance == Stance::kPassing ? frame_count() / 2 : 0;
  first_.stand(Affine::Identity(), met);
  second_.stand(where, met + second_.later);
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
  Character* const both[] = {&first_, &second_};
  if (seen_ != Seen::kLastFrame || number == 0) {
    for (Character* one : both) {
      const Deformation animated = one->placed(one->animated.deformation(number + one->later));
      const baker::BonePose pose(one->animated.asset(), animated);
      baker::check_runtime(one->looker.set_pose(pose.pose()));
    }
  }
  const bool is_last = seen_ == Seen::kLastFrame && number > 0;
  const Body* const met[] = {is_last ? &second_.responder.body() : &second_.looker,
                             seen_ == Seen::kEach ? &first_.looker : &first_.responder.body()};
  out.us = 0;
  out.starts_clip = false;
  for (std::size_t i = 0; i < 2; ++i) {
    Character& own = *both[i];
    const baker::Responder::Corrected made = own.responder.correct(number + own.later, &own.place, met[i]);
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
