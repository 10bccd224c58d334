// SPDX-License-Identifier: MIT
// With a bone's matrix M(t), of linear part A(t) and origin o(t), a vertex is at v(t) = sum_b w_b M_b(t) p(t), where
// the weights add up to 1 and p(t) = p + m(t) d is its place at rest, morphed. From a straight line over a time h it is
// off by h^2 / 8 times the greatest length of its second derivative, which is at most the greatest of a bone's
//   |M'' p| + 2 |A' p'|  <=  |A''| |p| + |o''| + 2 |A'| |p'|.
// Down a skeleton, of a parent P and a joint with the rotation R, the scale S and the translation l,
//   A = P R S,   o = P l + o_P,   so   |A''| <= |P''||B| + 2 |P'||B'| + |P||B''| of B = R S, and o'' likewise.
// S and l are linear in time. A rotation by the angle a in all has |R'| = a and |R''| = a^2 where its speed is
// constant; as a normalised sum of quaternions that are an angle g apart, c = cos g, its speed is 2 g', with
//   g' = sin g / D,   g'' = - sin g D' / D^2,   D = 1 - 2 t (1 - t) (1 - c)  >=  (1 + c) / 2,   |D'| <= 2 (1 - c).
#include "runtime/src/step/motion.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"

namespace spherechain {
namespace {

// Where a joint's rotation starts, and where it ends: on the same side, so that the way is the shorter one.
struct Turn {
  Quaternion from, to;

  Turn(const sc_transform& start, const sc_transform& end) : from(quaternion_of(start)), to(quaternion_of(end)) {
    if (inner(from, to) < 0) {
      to = scaled(-1, to);
    }
  }
};

Quaternion between(const Turn& turn, double time, Blend blend) {
  if (blend == SC_BLEND_NLERP) {
    return unit(sum(scaled(1 - time, turn.from), scaled(time, turn.to)));
  }
  if (time >= 1) {
    return turn.to;
  }
  Quaternion low = turn.from, high = turn.to;
  for (; time > 0; time -= time >= 1 ? 1 : 0) {
    const Quaternion middle = unit(sum(low, high));
    time *= 2;
    (time >= 1 ? low : high) = middle;
  }
  return low;
}

double length_of(const Vec3& v) { return length(to_double(v)); }

double greatest(const Vec3& v) {
  return std::max({std::abs(double{v.x}), std::abs(double{v.y}), std::abs(double{v.z})});
}

// A joint's own, apart from its parent's.
struct LocalSpeeds {
  double size, turn, turn_change;  // of rotation times scale
  double reach, velocity;          // of the translation
};

LocalSpeeds local_speeds(const sc_transform& start, const sc_transform& end, Blend blend) {
  const Turn turn(start, end);
  const Quaternion apart = sum(turn.to, scaled(-1, turn.from));
  const double chord = std::sqrt(inner(apart, apart));  // 2 sin(g / 2), of an angle g of at most a quarter turn
  double speed = 0, change = 0;                         // |R'|, |R''|
  if (blend == SC_BLEND_SLERP) {
    speed = 2 * std::min(1.1108 * chord, 1.5708);  // the arc is at most that much longer than its chord
    change = speed * speed;
  } else {
    const double c = std::max(1 - chord * chord / 2, 0.0), s = std::sqrt(std::max(1 - c * c, 0.0));
    const double least = (1 + c) / 2;
    speed = 2 * s / least;
    change = speed * speed + 2 * s * 2 * (1 - c) / (least * least);
  }
  const double size = std::max(greatest(start.scale), greatest(end.scale));
  const double grow = length(difference(end.scale, start.scale));
  return {size, speed * size + grow, change * size + 2 * speed * grow,
          std::max(length_of(start.translation), length_of(end.translation)),
          length(difference(end.translation, start.translation))};
}

// At least the norm of the linear part of three rows of four.
double norm_of(const double (&m)[3][4]) {
  double sum = 0;
  for (const auto& row : m) {
    sum += row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
  }
  return std::sqrt(sum);
}

std::uint32_t joint_of(const Motion& motion, std::size_t bone) {
  return motion.joint_of_bone == nullptr ? static_cast<std::uint32_t>(bone) : motion.joint_of_bone[bone];
}

Status check_joints(const Motion& motion, const AssetView& asset) {
  if (motion.start_joints == nullptr || motion.end_joints == nullptr) {
    return refuse(SC_NULL, SC_FIELD_JOINTS);
  }
  if (any_misaligned(motion.start_joints, motion.end_joints)) {
    return refuse(SC_MISALIGNED, SC_FIELD_JOINTS);
  }
  if (any_misaligned(motion.parents, motion.joint_of_bone)) {
    return refuse(SC_MISALIGNED, SC_FIELD_PARENTS);
  }
  for (const Pose* pose : {&motion.body.pose, &motion.end}) {
    if (pose->bones != nullptr || pose->vertices != nullptr) {
      return refuse(SC_BAD_VALUE, SC_FIELD_JOINTS);
    }
    if (any_misaligned(pose->morph_weights)) {
      return refuse(SC_MISALIGNED, SC_FIELD_MORPH_WEIGHTS);
    }
    if (pose->morph_weights != nullptr && pose->morph_weight_count < asset.morph_count()) {
      return refuse(SC_TOO_SMALL, SC_FIELD_MORPH_WEIGHTS);
    }
  }
  for (std::size_t i = 0; i < motion.joint_count; ++i) {
    if (!is_sound(motion.start_joints[i]) || !is_sound(motion.end_joints[i])) {
      return refuse(SC_BAD_VALUE, SC_FIELD_JOINTS);
    }
    if (motion.parents != nullptr && motion.parents[i] != SC_NO_JOINT && motion.parents[i] >= i) {
      return refuse(SC_BAD_VALUE, SC_FIELD_PARENTS);
    }
  }
  for (std::size_t bone = 0; bone < asset.bone_count(); ++bone) {
    const bool rests =
        motion.joint_of_bone == nullptr ? asset.bone(bone).is_rest : motion.joint_of_bone[bone] == SC_NO_JOINT;
    if (!rests && joint_of(motion, bone) >= motion.joint_count) {
      return refuse(SC_TOO_SMALL, SC_FIELD_JOINTS);
    }
  }
  return asset.bone_count() == 0 ? refuse(SC_NOT_IN_ASSET, SC_FIELD_JOINTS) : done();
}

}  // namespace

Status check_motion(const Motion& motion, Surface& surface) {
  if (motion.blend != SC_BLEND_LINEAR && motion.blend != SC_BLEND_SLERP && motion.blend != SC_BLEND_NLERP) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BLEND);
  }
  if (motion.joint_count > kJointsMax) {
    return refuse(SC_BAD_VALUE, SC_FIELD_JOINTS);
  }
  const JobBody& body = motion.body;
  if (motion.blend == SC_BLEND_LINEAR) {
    const Status status = check_skin(body.asset, body.pose, body.skin_table, surface);
    if (status != SC_OK) {
      return status;
    }
    const Status at_end = check_skin_pose(view_of(*body.asset), motion.end);
    return at_end != SC_OK                                                       ? at_end
           : (body.pose.vertices == nullptr) != (motion.end.vertices == nullptr) ? refuse(SC_BAD_VALUE, SC_FIELD_END)
                                                                                 : done();
  }
  Status status = check_asset(body.asset);
  if (status == SC_OK) {
    status = check_joints(motion, view_of(*body.asset));
  }
  return status == SC_OK ? read_skin_table(view_of(*body.asset), body.skin_table, surface) : status;
}

void BodyMotion::take(WordMemory& memory, const AssetView& asset, std::size_t joint_count) {
  memory.take(strays_, asset.spheres().size);
  memory.take(bone_strays_, asset.bone_count());
  memory.take(speeds_, joint_count);
  memory.take(chain_, joint_count);
  for (Skeleton& skeleton : skeletons_) {
    memory.take(skeleton.joints, joint_count);
    memory.take(skeleton.has_joint, joint_count);
    memory.take(skeleton.bones, 12 * asset.bone_count());
    memory.take(skeleton.has_bone, asset.bone_count());
  }
}

void BodyMotion::start(const Motion& motion, const AssetView& asset, const Surface& surface) {
  motion_ = &motion;
  asset_ = &asset;
  surface_ = &surface;
  std::fill(strays_, strays_ + asset.spheres().size, 0.0F);
  const bool morphs = motion.body.pose.morph_weights != nullptr || motion.end.morph_weights != nullptr;
  if (motion.body.pose.vertices != nullptr || (!has_joints() && !morphs)) {
    return;
  }
  find_speeds();
  for (std::size_t bone = 0; bone < asset.bone_count(); ++bone) {
    bone_strays_[bone] = stray_of_bone(bone);
  }
  for (std::size_t s = 0; s < surface.hulls.size; ++s) {
    const Hull& hull = surface.hulls[s];
    double most = 0;
    for (std::size_t k = 0; k < hull.bone_count; ++k) {
      const double stray = bone_strays_[surface.hull_bones[hull.first_bone + k].bone];
      most = std::isnan(stray) ? HUGE_VAL : std::max(most, stray);
    }
    strays_[s] = static_cast<float>(most * (1 + 1e-6));
  }
}

void BodyMotion::find_speeds() {
  for (std::size_t i = 0; has_joints() && i < motion_->joint_count; ++i) {
    const LocalSpeeds own = local_speeds(motion_->start_joints[i], motion_->end_joints[i], motion_->blend);
    const bool has_parent = motion_->parents != nullptr && motion_->parents[i] != SC_NO_JOINT;
    const Speeds up = has_parent ? speeds_[motion_->parents[i]] : Speeds{1, 0, 0, 0, 0};
    speeds_[i] = {up.size * own.size, up.turn * own.size + up.size * own.turn,
                  up.turn_change * own.size + 2 * up.turn * own.turn + up.size * own.turn_change,
                  up.turn * own.reach + up.size * own.velocity + up.velocity,
                  up.turn_change * own.reach + 2 * up.turn * own.velocity + up.acceleration};
  }
}

double BodyMotion::stray_of_bone(std::size_t bone) const {
  const BoneBox& box = surface_->bone_boxes[bone];
  if (!(box.half.x >= 0)) {
    return 0;
  }
  double morphed = 0, change = 0;  // how far morphs take a vertex, and how fast they change that
  const float *const from = motion_->body.pose.morph_weights, *const to = motion_->end.morph_weights;
  for (std::size_t i = 0; i < surface_->morph_reach.size; ++i) {
    const double at_start = from == nullptr ? 0.0 : double{from[i]}, at_end = to == nullptr ? 0.0 : double{to[i]};
    const double reach = double{surface_->morph_reach[i]};
    morphed += std::max(std::abs(at_start), std::abs(at_end)) * reach;
    change += std::abs(at_end - at_start) * reach;
  }
  if (!has_joints()) {
    const BoneMatrices start = matrices_of(motion_->body.pose), end = matrices_of(motion_->end);
    double turn[3][4];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        turn[i][j] = double{end.data[bone * end.stride + i * end.row + j * end.column]} -
                     double{start.data[bone * start.stride + i * start.row + j * start.column]};
      }
    }
    const double norm = norm_of(turn);
    return std::isfinite(norm) ? 2 * norm * change / 8 : 0.0;  // what is not finite touches nothing
  }
  const std::uint32_t joint = joint_of(*motion_, bone);
  const BoneView view = asset_->bone(bone);
  if (joint >= motion_->joint_count) {
    return 0;  // the bone that rests
  }
  double bind[3][4];
  for (std::size_t i = 0; i < 12; ++i) {
    bind[i / 4][i % 4] = double{view.inverse_bind[i]};
  }
  const Double3 center = to_double(box.center);
  const double middle[3] = {center.x, center.y, center.z};
  double squared = 0;
  for (const auto& row : bind) {
    const double at = row[0] * middle[0] + row[1] * middle[1] + row[2] * middle[2] + row[3];
    squared += at * at;
  }
  const double norm = norm_of(bind);
  const double reach = std::sqrt(squared) + norm * (length_of(box.half) + morphed);
  const Speeds& speeds = speeds_[joint];
  return (speeds.turn_change * reach + speeds.acceleration + 2 * speeds.turn * norm * change) / 8;
}

Skeleton& BodyMotion::skeleton_at(double time) {
  for (Skeleton& skeleton : skeletons_) {
    if (skeleton.time == time) {
      return skeleton;
    }
  }
  Skeleton& skeleton = skeletons_[oldest_];
  oldest_ = (oldest_ + 1) % kSkeletons;
  skeleton.time = time;
  if (has_joints()) {
    std::fill(skeleton.has_joint, skeleton.has_joint + motion_->joint_count, std::uint8_t{0});
  }
  std::fill(skeleton.has_bone, skeleton.has_bone + asset_->bone_count(), std::uint8_t{0});
  return skeleton;
}

Affine BodyMotion::local_at(double time, std::size_t joint) const {
  const sc_transform &start = motion_->start_joints[joint], &end = motion_->end_joints[joint];
  const Quaternion q = between(Turn(start, end), time, motion_->blend);
  const auto lerp = [&](const Vec3& a, const Vec3& b) { return to_double(a) + time * difference(b, a); };
  return affine_of(lerp(start.translation, end.translation), q, lerp(start.scale, end.scale));
}

const Affine& BodyMotion::joint_at(Skeleton& skeleton, std::size_t joint) {
  std::size_t count = 0;
  std::uint32_t at = static_cast<std::uint32_t>(joint);
  while (at != SC_NO_JOINT && skeleton.has_joint[at] == 0) {
    chain_[count++] = at;
    at = motion_->parents == nullptr ? SC_NO_JOINT : motion_->parents[at];
  }
  while (count > 0) {
    const std::uint32_t next = chain_[--count];
    const Affine own = local_at(skeleton.time, next);
    skeleton.joints[next] = at == SC_NO_JOINT ? own : product(skeleton.joints[at], own);
    skeleton.has_joint[next] = 1;
    at = next;
  }
  return skeleton.joints[joint];
}

const float* BodyMotion::bone_at(Skeleton& skeleton, std::size_t bone) {
  float* const out = skeleton.bones + 12 * bone;
  if (skeleton.has_bone[bone] != 0) {
    return out;
  }
  skeleton.has_bone[bone] = 1;
  if (!has_joints()) {
    const BoneMatrices start = matrices_of(motion_->body.pose), end = matrices_of(motion_->end);
    for (std::size_t i = 0; i < 12; ++i) {
      const std::size_t row = i / 4, column = i % 4;
      const double from{start.data[bone * start.stride + row * start.row + column * start.column]};
      const double to{end.data[bone * end.stride + row * end.row + column * end.column]};
      out[i] = static_cast<float>(from + skeleton.time * (to - from));
    }
    return out;
  }
  const std::uint32_t joint = joint_of(*motion_, bone);
  if (joint >= motion_->joint_count) {
    for (std::size_t i = 0; i < 12; ++i) {
      out[i] = i % 5 == 0 ? 1.0F : 0.0F;
    }
    return out;
  }
  Affine bind;
  const float* const inverse_bind = asset_->bone(bone).inverse_bind;
  for (std::size_t i = 0; i < 12; ++i) {
    bind.m[i / 4][i % 4] = double{inverse_bind[i]};
  }
  const Affine skinning = product(joint_at(skeleton, joint), bind);
  for (std::size_t i = 0; i < 12; ++i) {
    out[i] = static_cast<float>(skinning.m[i / 4][i % 4]);
  }
  return out;
}

float BodyMotion::morph_weight_at(double time, std::size_t morph) const {
  const float *const from = motion_->body.pose.morph_weights, *const to = motion_->end.morph_weights;
  const double at_start = from == nullptr ? 0.0 : double{from[morph]}, at_end = to == nullptr ? 0.0 : double{to[morph]};
  return static_cast<float>(at_start + time * (at_end - at_start));
}

Double3 BodyMotion::vertex_at_time(double time, std::size_t vertex) const {
  const Pose &start = motion_->body.pose, &end = motion_->end;
  const float* const from = vertex_at(start.vertices, vertex, vertex_stride(start));
  const float* const to = vertex_at(end.vertices, vertex, vertex_stride(end));
  const Double3 p{double{from[0]}, double{from[1]}, double{from[2]}}, q{double{to[0]}, double{to[1]}, double{to[2]}};
  return p + time * (q - p);
}

Pose BodyMotion::pose_at(double time, float* bones, float* morph_weights, float* vertices) {
  if (!has_joints() && (time <= 0 || time >= 1)) {
    return time <= 0 ? motion_->body.pose : motion_->end;
  }
  Pose pose;
  if (has_vertices()) {
    for (std::size_t v = 0; v < asset_->vertex_count(); ++v) {
      const Vec3 at = to_float(vertex_at_time(time, v));
      vertices[3 * v] = at.x;
      vertices[3 * v + 1] = at.y;
      vertices[3 * v + 2] = at.z;
    }
    pose.vertices = vertices;
    pose.vertex_count = asset_->vertex_count();
    return pose;
  }
  Skeleton& skeleton = skeleton_at(time);
  for (std::size_t bone = 0; bone < asset_->bone_count(); ++bone) {
    const float* const from = bone_at(skeleton, bone);
    std::copy(from, from + 12, bones + 12 * bone);
  }
  pose.bones = bones;
  pose.bone_count = asset_->bone_count();
  pose.bone_layout = SC_ROWS_3X4;
  if (motion_->body.pose.morph_weights != nullptr || motion_->end.morph_weights != nullptr) {
    for (std::size_t i = 0; i < asset_->morph_count(); ++i) {
      morph_weights[i] = morph_weight_at(time, i);
    }
    pose.morph_weights = morph_weights;
    pose.morph_weight_count = asset_->morph_count();
  }
  return pose;
}

void BodyMotion::corners_at(double time, std::size_t cluster_index, std::size_t triangle, Double3* corners) {
  const Cluster& cluster = surface_->clusters[cluster_index];
  if (has_vertices()) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t vertex = cluster.first_vertex + std::size_t{surface_->corners[3 * triangle + corner]};
      corners[corner] = vertex_at_time(time, surface_->source_vertices[surface_->cluster_vertices[vertex]]);
    }
    return;
  }
  Skeleton& skeleton = skeleton_at(time);
  const std::size_t slots = slot_count(cluster);
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const std::size_t slot = surface_->corners[3 * triangle + corner];
    double p[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[axis] = double{surface_->slot_positions[3 * std::size_t{cluster.first_slot} + axis * slots + slot]};
    }
    for (std::size_t i = 0; i < cluster.morph_count; ++i) {
      const SlotMorph& morph = surface_->slot_morphs[cluster.first_morph + i];
      if (morph.slot == slot) {
        const double weight{morph_weight_at(time, morph.target)};
        p[0] += weight * double{morph.delta.x};
        p[1] += weight * double{morph.delta.y};
        p[2] += weight * double{morph.delta.z};
      }
    }
    double moved[3] = {};
    for (std::size_t k = 0; k < cluster.bone_count; ++k) {
      const double weight{surface_->slot_weights[cluster.first_weight + k * slots + slot]};
      if (weight > 0) {
        const float* const m = bone_at(skeleton, surface_->cluster_bones[cluster.first_bone + k]);
        for (std::size_t i = 0; i < 3; ++i) {
          moved[i] += weight * (double{m[4 * i]} * p[0] + double{m[4 * i + 1]} * p[1] + double{m[4 * i + 2]} * p[2] +
                                double{m[4 * i + 3]});
        }
      }
    }
    corners[corner] = {moved[0], moved[1], moved[2]};
  }
}

}  // namespace spherechain
