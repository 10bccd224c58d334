// SPDX-License-Identifier: GPL-3.0-or-later
#include "capsule_response.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "baker/volumes/fit_volumes.h"

namespace spherechain::bench {
namespace {

constexpr int kRounds = 4, kSweeps = 40;
constexpr double kRelease = 0.03, kFastest = 8, kBudget = 1.05, kRoundMost = 0.4, kOffHinge = 0.25;
// Shares of the height. A row whose lever is no longer than `kSoft`, near a shoulder, gives way: else it would fling
// the arm.
constexpr double kEase = 0.005 / 1.75, kSlop = 0.001 / 1.75, kSoft = 0.025;

Vec3 shortened(const Vec3& v, double most) { return v.norm() > most ? Vec3(most / v.norm() * v) : v; }

Eigen::Quaterniond turn_of(const Vec3& v) {
  const double angle = v.norm();
  return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, v / angle)) : Eigen::Quaterniond::Identity();
}

Vec3 vector_of(const Eigen::Quaterniond& q) {
  const Eigen::AngleAxisd turn(q);
  return turn.angle() * turn.axis();
}

Eigen::Matrix3d axes_of(const Affine& of) { return of.linear().colwise().normalized(); }

// The nearest points of two segments, as shares of each.
std::pair<double, double> nearest(const Vec3& a, const Vec3& ab, const Vec3& c, const Vec3& cd) {
  const Vec3 r = a - c;
  const double e = std::max(ab.squaredNorm(), 1e-30), f = std::max(cd.squaredNorm(), 1e-30), g = ab.dot(cd),
               ar = ab.dot(r), cr = cd.dot(r), det = e * f - g * g;
  double s = det > 1e-9 * e * f ? std::clamp((g * cr - ar * f) / det, 0.0, 1.0) : 0.5;
  const double t = std::clamp((g * s + cr) / f, 0.0, 1.0);
  s = std::clamp((g * t - ar) / e, 0.0, 1.0);
  return {s, t};
}

}  // namespace

CapsuleResponse::CapsuleResponse(const baker::AnimatedAsset& animated)
    : animated_(animated), joints_(animated), height_(animated.frame().height) {
  const baker::OpenAsset& asset = animated.asset();
  const auto turning_of = [&](const std::string& part) -> Turning* {
    for (std::uint32_t p = 0; p < asset->part_count(); ++p) {
      const std::int32_t bone = asset->part(p).bone;
      if (bone < 0 || asset.model().part_name(p) != part) continue;
      const std::size_t joint = joints_.joint_of_bone()[static_cast<std::size_t>(bone)];
      const bool is_hand = part.ends_with(" hand");
      return &turning_.emplace_back(Turning{joint, is_hand ? 0.3 : 1.0, part.ends_with(" forearm")});
    }
    return nullptr;
  };
  for (const std::string side : {"left ", "right "}) {
    turning_of(side + "upper arm");
    const std::size_t before = turning_.size();
    const bool has_elbow = turning_of(side + "forearm") != nullptr;
    const Turning* const hand = turning_of(side + "hand");
    if (has_elbow && hand != nullptr) {
      turning_[before].below = hand->joint;
    } else if (has_elbow) {
      turning_[before].is_elbow = false;
    }
  }
  add_capsules(baker::fit_volumes(asset, baker::VolumeShape::kCapsules, 0));
}

void CapsuleResponse::add_capsules(const baker::Colliders& colliders) {
  const baker::Deformation first = animated_.deformation(0);
  locals_ = joints_.joints_of(first);
  place(world_, false);
  std::vector<int> body_of;
  for (std::size_t b = 0; b < colliders.bodies.size(); ++b) {
    const baker::ColliderBody& body = colliders.bodies[b];
    if (body.bone_index < 0) continue;
    const auto bone = static_cast<std::size_t>(body.bone_index);
    const std::size_t joint = joints_.joint_of_bone()[bone];
    unsigned moved_by = 0;
    for (std::uint32_t up = static_cast<std::uint32_t>(joint); up != SC_NO_JOINT; up = joints_.parents()[up]) {
      for (std::size_t t = 0; t < turning_.size(); ++t) moved_by |= turning_[t].joint == up ? 1U << t : 0U;
    }
    const Affine to_joint = Affine(world_[joint].inverse() * first.bones[bone]);
    for (const baker::Volume& volume : body.volumes) {
      const auto* const ball = std::get_if<baker::BallVolume>(&volume);
      const auto* const cone = std::get_if<baker::ConeVolume>(&volume);
      const auto in_joint = [&](const Vec3& at) {
        return Vec3(to_joint * (body.rest * at / colliders.metres_per_unit));
      };
      const double radius = (ball != nullptr ? ball->radius : cone->radius_a) / colliders.metres_per_unit;
      capsules_.push_back({joint, in_joint(ball != nullptr ? ball->center : cone->a),
                           in_joint(ball != nullptr ? ball->center : cone->b), radius, moved_by});
      body_of.push_back(static_cast<int>(b));
    }
  }
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    for (std::size_t k = i + 1; k < capsules_.size(); ++k) {
      const bool is_ignored = std::any_of(colliders.ignored.begin(), colliders.ignored.end(), [&](const auto& pair) {
        return std::minmax(pair.a, pair.b) == std::minmax(body_of[i], body_of[k]);
      });
      if (body_of[i] != body_of[k] && !is_ignored && capsules_[i].moved_by != capsules_[k].moved_by) {
        pairs_.emplace_back(i, k);
      }
    }
  }
}

// The joints in the world: as animated, or turned.
void CapsuleResponse::place(std::vector<Affine>& world, bool with_turns) const {
  world.resize(locals_.size());
  for (std::size_t j = 0; j < locals_.size(); ++j) {
    const auto& [t, q, s] = locals_[j];
    Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    for (const Turning& turning : turning_) {
      if (with_turns && turning.joint == j) rotation = turn_of(turning.turn) * rotation;
    }
    const Affine local =
        Eigen::Translation3d(t.x, t.y, t.z) * rotation.normalized() * Eigen::AlignedScaling3d(s.x, s.y, s.z);
    const std::uint32_t parent = joints_.parents()[j];
    world[j] = parent == SC_NO_JOINT ? local : Affine(world[parent] * local);
  }
}

void CapsuleResponse::place_capsules(const std::vector<Affine>& world) {
  placed_.clear();
  for (const Capsule& capsule : capsules_) {
    placed_.push_back({world[capsule.joint] * capsule.a, world[capsule.joint] * capsule.b, capsule.radius});
  }
}

double CapsuleResponse::gap_of(std::size_t pair, Vec3& on_a, Vec3& on_b) const {
  const Placed &a = placed_[pairs_[pair].first], &b = placed_[pairs_[pair].second];
  const auto [s, t] = nearest(a.a, a.b - a.a, b.a, b.b - b.a);
  on_a = a.a + s * (a.b - a.a);
  on_b = b.a + t * (b.b - b.a);
  return (on_a - on_b).norm() - a.radius - b.radius;
}

// The pairs that are near, with how far each is to open: little more than the animation lacks, and gradually.
void CapsuleResponse::find_rows(const std::vector<Affine>& world) {
  rows_.clear();
  const double ease = kEase * height_;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    Vec3 a, b;
    const double gap = gap_of(p, a, b), least = kSlop * height_, lacks = least - animated_gaps_[p],
                 eased = lacks <= -ease  ? 0
                         : lacks >= ease ? lacks
                                         : (lacks + ease) * (lacks + ease) / (4 * ease),
                 wanted = std::min(animated_gaps_[p] + eased, least + ease);
    if (gap > wanted + ease) continue;
    Row row{p, gap, wanted, 0, {}, {}};
    const Vec3 normal = (a - b).normalized();
    for (std::size_t t = 0; t < turning_.size(); ++t) {
      const Turning& joint = turning_[t];
      const Vec3 from = world[joint.joint].translation();
      Vec3 opens = Vec3::Zero();
      if ((capsules_[pairs_[p].first].moved_by >> t & 1) != 0) opens += (a - from).cross(normal);
      if ((capsules_[pairs_[p].second].moved_by >> t & 1) != 0) opens -= (b - from).cross(normal);
      Vec3 turns = opens;
      if (joint.is_elbow) {
        const Vec3 elbow = world_[joint.joint].translation(),
                   upper = elbow - world_[joints_.parents()[joint.joint]].translation(),
                   lower = world_[joint.below].translation() - elbow, hinge = upper.cross(lower);
        if (hinge.norm() > 0.1 * upper.norm() * lower.norm()) {
          turns = kOffHinge * opens + (1 - kOffHinge) * opens.dot(hinge.normalized()) * hinge.normalized();
        }
      }
      row.opens.push_back(opens);
      row.turns.push_back(joint.mobility * turns);
    }
    rows_.push_back(std::move(row));
  }
}

// The smallest turns, from `rest` on, that open the rows: by Gauss-Seidel, as sc_respond does.
void CapsuleResponse::solve(const std::vector<Affine>& world, const std::vector<Vec3>& rest) {
  std::vector<Vec3> change(turning_.size());
  std::vector<Eigen::Matrix3d> axes(turning_.size(), Eigen::Matrix3d::Identity());
  for (std::size_t t = 0; t < turning_.size(); ++t) {
    const std::uint32_t parent = joints_.parents()[turning_[t].joint];
    if (parent != SC_NO_JOINT) axes[t] = axes_of(world[parent]);
    change[t] = axes[t] * (rest[t] - turning_[t].turn);
  }
  const double soft = kSoft * kSoft * height_ * height_;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (Row& row : rows_) {
      double opened = 0, by_pull = 0;
      for (std::size_t t = 0; t < turning_.size(); ++t) {
        opened += row.opens[t].dot(change[t]);
        by_pull += row.opens[t].dot(row.turns[t]);
      }
      const double lacks = row.wanted - row.gap - opened - soft * row.pull,
                   pull = std::max(0.0, row.pull + lacks / (by_pull + soft));
      for (std::size_t t = 0; t < turning_.size(); ++t) change[t] += (pull - row.pull) * row.turns[t];
      row.pull = pull;
    }
  }
  for (std::size_t t = 0; t < turning_.size(); ++t) {
    const Vec3 by = shortened(axes[t].transpose() * change[t], kRoundMost);
    turning_[t].turn = vector_of(turn_of(by) * turn_of(turning_[t].turn));
  }
}

CapsuleResponse::Corrected CapsuleResponse::correct(const baker::Deformation& animated, double seconds,
                                                    bool starts_clip) {
  locals_ = joints_.joints_of(animated);
  const std::clock_t start = std::clock();
  place(world_, false);
  place_capsules(world_);
  animated_gaps_.resize(pairs_.size());
  Vec3 a, b;
  for (std::size_t p = 0; p < pairs_.size(); ++p) animated_gaps_[p] = gap_of(p, a, b);
  std::vector<Vec3> rest, last;
  for (Turning& turning : turning_) {
    if (starts_clip) turning.turn.setZero();
    last.push_back(turning.turn);
    rest.push_back(std::exp(-seconds / kRelease) * turning.turn);
  }
  std::vector<Affine> world;
  for (int round = 0; round < kRounds; ++round) {
    place(world, true);
    place_capsules(world);
    find_rows(world);
    solve(world, rest);
    for (std::size_t t = 0; t < turning_.size(); ++t) {
      const double most = starts_clip ? kFastest : kFastest * seconds;
      turning_[t].turn = shortened(last[t] + shortened(turning_[t].turn - last[t], most), kBudget);
    }
  }
  const double us = 1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  place(world, true);
  place_capsules(world);
  std::vector<sc_transform> turned = locals_;
  for (const Turning& turning : turning_) {
    float(&q)[4] = turned[turning.joint].rotation;
    const Eigen::Quaterniond out = turn_of(turning.turn) * Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
    for (int i = 0; i < 4; ++i) q[i] = static_cast<float>(out.coeffs()[i]);
  }
  Corrected out{animated, us};
  const std::vector<Affine> bones = joints_.bones_of(turned);
  std::copy_n(bones.begin(), out.pose.bones.size(), out.pose.bones.begin());
  return out;
}

}  // namespace spherechain::bench
