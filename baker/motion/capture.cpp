// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/capture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "baker/mesh/decompose.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"

namespace spherechain::baker {
namespace {

constexpr int kSamples = 200;  // of a capture, where all of it is looked at

const Joint& joint(const RoleJoints& joints, const std::string& role) {
  return joints.joints[static_cast<std::size_t>(joints.find(role))];
}

// A spine ends at the neck, or at the head if there is no neck.
const char* spine_end(const RoleJoints& joints) { return joints.find("neck") >= 0 ? "neck" : "head"; }

bool has_legs_and_neck(const RoleJoints& joints) {
  for (const char* role :
       {"left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle", spine_end(joints)}) {
    if (joints.find(role) < 0) return false;
  }
  return true;
}

Vec3 middle_of_hips(const RoleJoints& joints) {
  return 0.5 * (joint(joints, "left_hip").position + joint(joints, "right_hip").position);
}

double leg_length(const RoleJoints& joints) {
  double sum = 0;
  for (const std::string side : {"left_", "right_"}) {
    const Vec3 &hip = joint(joints, side + "hip").position, &knee = joint(joints, side + "knee").position,
               &ankle = joint(joints, side + "ankle").position;
    sum += (knee - hip).norm() + (ankle - knee).norm();
  }
  return sum / 2;
}

std::vector<Vec3> places(const std::vector<Affine>& world) {
  std::vector<Vec3> out;
  for (const Affine& node : world) out.push_back(node.translation());
  return out;
}

// The axis of the space nearest to a direction.
Vec3 nearest_axis(const Vec3& direction) {
  Eigen::Index axis;
  direction.cwiseAbs().maxCoeff(&axis);
  return Vec3::Unit(axis) * (direction[axis] < 0 ? -1.0 : 1.0);
}

// Skeletons rest along the axes of their space; that the spine leans or a hip is higher is how their joints were put.
Vec3 straightened(const Vec3& direction) {
  constexpr double kLean = 0.94;  // 20 degrees
  const Vec3 axis = nearest_axis(direction);
  return direction.normalized().dot(axis) > kLean ? axis : direction.normalized();
}

Eigen::Matrix3d axes(const Vec3& left, const Vec3& up) {
  Eigen::Matrix3d out;
  out.col(1) = up;
  out.col(0) = (left - left.dot(up) * up).normalized();
  out.col(2) = out.col(0).cross(up);
  return out;
}

// Left, up and forward of a body that stands; nothing where it does not.
std::optional<Eigen::Matrix3d> standing_axes(const RoleJoints& joints) {
  constexpr double kSteep = 0.87;  // 30 degrees
  const Vec3 hips = middle_of_hips(joints), torso = joint(joints, spine_end(joints)).position - hips;
  const Vec3 left = joint(joints, "left_hip").position - joint(joints, "right_hip").position;
  const Vec3 feet = 0.5 * (joint(joints, "left_ankle").position + joint(joints, "right_ankle").position) - hips;
  if (torso.norm() == 0 || left.norm() == 0 || feet.norm() == 0) return std::nullopt;
  const Vec3 up = straightened(torso);
  if (-feet.normalized().dot(up) < kSteep || std::abs(left.normalized().dot(up)) > 1 - kSteep) return std::nullopt;
  return axes(straightened(left - left.dot(up) * up), up);
}

// The least turn of what `before` has turned already that brings `bone` onto `target`.
Eigen::Matrix3d turned_onto(const Eigen::Matrix3d& before, const Vec3& bone, const Vec3& target) {
  if (bone.norm() == 0 || target.norm() == 0) return before;
  return turn_between(before * bone, target).toRotationMatrix() * before;
}

bool ends_with(const std::string& text, const char* end) {
  const std::string_view tail(end);
  return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

std::vector<Index> of_role(const RoleJoints& joints, const std::string& role) {
  std::vector<Index> out;
  for (Index j = 0; j < joints.joints.size(); ++j) {
    if (joints.joints[j].name == role) out.push_back(j);
  }
  return out;
}

// The joint of `source` that joint j of `body` follows, -1 none. Where a body has several of a role (the spine), they
// are spread over those that the other has.
int counterpart(const RoleJoints& body, Index j, const RoleJoints& source) {
  const std::vector<Index> own = of_role(body, body.joints[j].name), others = of_role(source, body.joints[j].name);
  if (others.empty()) return -1;
  const auto at = static_cast<std::size_t>(std::find(own.begin(), own.end(), j) - own.begin());
  return static_cast<int>(others[(2 * at + 1) * others.size() / (2 * own.size())]);
}

// Against gravity: the body's own up in the pose in which it stands, unless the capture moves in other axes than those
// its skeleton rests in.
Vec3 up_of(const Capture& capture, const RoleJoints& reference, const Vec3& standing) {
  std::vector<std::pair<int, Vec3>> counts;
  int as_standing = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto world = world_at(capture.rig, capture.clip, capture.clip.duration * i / (kSamples - 1));
    const auto at = [&](const char* role) -> Vec3 {
      return world[reference.node[static_cast<std::size_t>(reference.find(role))]].translation();
    };
    const Vec3 axis = nearest_axis(at(spine_end(reference)) - 0.5 * (at("left_hip") + at("right_hip")));
    as_standing += axis == nearest_axis(standing) ? 1 : 0;
    auto found = std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.second == axis; });
    if (found == counts.end()) found = counts.insert(counts.end(), {0, axis});
    ++found->first;
  }
  if (4 * as_standing >= kSamples) return standing;
  return std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.first < b.first; })
      ->second;
}

}  // namespace

CaptureMotion::CaptureMotion(Capture capture, CaptureBody body) : capture_(std::move(capture)), body_(std::move(body)) {
  const SourceRig& rig = capture_.rig;
  // The rest pose, or where nobody could stand like that, the first of the clip in which somebody could.
  std::vector<Affine> world = world_of(rig.nodes);
  RoleJoints reference = joints_by_role(rig.nodes, capture_.roles, places(world));
  if (!has_legs_and_neck(reference)) {
    throw Error(ExitCode::kFile,
                capture_.file +
                    ": hips, knees, ankles and head cannot be recognised in its skeleton (name the joints "
                    "as usual)");
  }
  std::optional<Eigen::Matrix3d> standing = standing_axes(reference);
  for (int i = 0; i < kSamples && !standing; ++i) {
    world = world_at(rig, capture_.clip, capture_.clip.duration * i / (kSamples - 1));
    reference = joints_by_role(rig.nodes, capture_.roles, places(world));
    standing = standing_axes(reference);
  }
  if (!standing) throw Error(ExitCode::kFile, capture_.file + ": nobody stands upright in it (add a pose at rest)");

  hips_ = {reference.node[static_cast<std::size_t>(reference.find("left_hip"))],
           reference.node[static_cast<std::size_t>(reference.find("right_hip"))]};
  const std::vector<Affine> first = world_at(rig, capture_.clip, 0);
  const Vec3 left = first[hips_[0]].translation() - first[hips_[1]].translation();
  const Vec3 up = up_of(capture_, reference, standing->col(1));
  constexpr double kLying = 0.2;
  const bool heads = (left - left.dot(up) * up).norm() > kLying * left.norm();
  Eigen::Matrix3d own;
  own << body_.frame.left, body_.frame.up, body_.frame.forward;
  to_body_ = own * axes(heads ? left : Vec3(standing->col(0)), up).transpose();
  start_ = 0.5 * (first[hips_[0]].translation() + first[hips_[1]].translation());
  anchor_ = middle_of_hips(body_.joints);
  stride_ = leg_length(body_.joints) / leg_length(reference);
  align(reference, world, own * standing->transpose());
  lift_ = lift();
}

// `to_body`: from the reference pose's axes to those of the body at rest.
void CaptureMotion::align(const RoleJoints& reference, const std::vector<Affine>& world,
                          const Eigen::Matrix3d& to_body) {
  const std::vector<Joint>& joints = body_.joints.joints;
  const Vec3& up = body_.frame.up;
  std::vector<Eigen::Matrix3d> turns;  // of the body's joints, from its rest pose to the capture's
  for (Index j = 0; j < joints.size(); ++j) {
    const Joint& own = joints[j];
    const int source = counterpart(body_.joints, j, reference);
    const Eigen::Matrix3d parent =
        own.parent < 0 ? Eigen::Matrix3d::Identity() : turns[static_cast<std::size_t>(own.parent)];
    turns.push_back(parent);
    followers_.emplace_back();
    if (source < 0) continue;
    const Joint& theirs = reference.joints[static_cast<std::size_t>(source)];
    Vec3 bone = own.tail - own.position, target = to_body * (theirs.tail - theirs.position);
    const std::string& role = own.name;
    if (ends_with(role, "ankle") || ends_with(role, "toe")) {
      // Soles are flat at rest, wherever their joints were put.
      bone -= bone.dot(up) * up;
      target -= target.dot(up) * up;
      turns[j] = ends_with(role, "toe") ? parent : turned_onto(Eigen::Matrix3d::Identity(), bone, target);
    } else if (role.find('_') != std::string::npos && !ends_with(role, "clavicle")) {
      turns[j] = turned_onto(parent, bone, target);
    }
    const Index node = reference.node[static_cast<std::size_t>(source)];
    followers_[j].source = static_cast<int>(node);
    followers_[j].from_rest = turn_in(world[node].linear()).transpose() * to_body.transpose() * turns[j];
  }
}

double CaptureMotion::rate() const { return rate_of(capture_.clip); }

std::vector<Affine> CaptureMotion::joints_at(double t) const {
  const std::vector<Affine> world = world_at(capture_.rig, capture_.clip, t * duration());
  const Vec3 hips = 0.5 * (world[hips_[0]].translation() + world[hips_[1]].translation());
  const Vec3 travelled = stride_ * (to_body_ * (hips - start_)) + lift_ * body_.frame.up;
  std::vector<Affine> out;
  for (std::size_t j = 0; j < followers_.size(); ++j) {
    const Joint& own = body_.joints.joints[j];
    const Affine* parent = own.parent < 0 ? nullptr : &out[static_cast<std::size_t>(own.parent)];
    const Vec3& pivot = parent == nullptr ? anchor_ : own.position;
    Affine joint = parent == nullptr ? Affine::Identity() : *parent;
    if (followers_[j].source >= 0) {
      joint.linear() =
          to_body_ * turn_in(world[static_cast<std::size_t>(followers_[j].source)].linear()) * followers_[j].from_rest;
    }
    const Vec3 moved = parent == nullptr ? Vec3(anchor_ + travelled) : *parent * own.position;
    joint.translation() = moved - joint.linear() * pivot;
    out.push_back(joint);
  }
  return out;
}

Eigen::Matrix3d CaptureMotion::source_rotation(Index joint, const Eigen::Matrix3d& turned) const {
  return to_body_.transpose() * turned * followers_[joint].from_rest.transpose();
}

// So much that in all but the lowest tenth of the capture no foot is lower than at rest.
double CaptureMotion::lift() const {
  std::vector<double> clearances;
  for (int i = 0; i < kSamples; ++i) {
    const std::vector<Affine> moved = joints_at(static_cast<double>(i) / (kSamples - 1));
    double lowest = std::numeric_limits<double>::max();
    for (std::size_t j = 0; j < moved.size(); ++j) {
      const Joint& own = body_.joints.joints[j];
      if (!ends_with(own.name, "ankle")) continue;
      for (const Vec3& p : {own.position, own.tail}) lowest = std::min(lowest, (moved[j] * p - p).dot(body_.frame.up));
    }
    clearances.push_back(lowest);
  }
  std::nth_element(clearances.begin(), clearances.begin() + kSamples / 10, clearances.end());
  return -clearances[kSamples / 10];
}

Deformation CaptureMotion::at(double t) const {
  const std::vector<Affine> joints = joints_at(t);
  Deformation out;
  for (const Index joint : body_.joint_of_bone) out.bones.push_back(joints[joint]);
  return out;
}

}  // namespace spherechain::baker
