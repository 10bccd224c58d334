// SPDX-License-Identifier: GPL-3.0-or-later
#include "moving_joints.h"

#include <doctest/doctest.h>

#include <string>

#include "runtime/src/depth/distance.h"

namespace spherechain::test {
namespace {

const AssetView& human_view() { return view_of(*moving_human().asset.handle()); }

std::size_t joint_count() {
  std::size_t count = 0;
  while (count < human_view().bone_count() && !human_view().bone(count).is_rest) ++count;
  return count;
}

// The matrix of a joint in its parent's space.
Transform transform_of(const Eigen::Affine3d& m, double scale) {
  const Eigen::Quaterniond q(m.rotation());
  const Eigen::Vector3d t = m.translation();
  const auto f = [](double x) { return static_cast<float>(x); };
  return {{f(t.x()), f(t.y()), f(t.z())}, {f(q.x()), f(q.y()), f(q.z()), f(q.w())}, {f(scale), 1, f(scale)}};
}

Eigen::Quaterniond rotation_of(const Transform& joint) {
  const float* const r = joint.rotation;
  return Eigen::Quaterniond(double{r[3]}, double{r[0]}, double{r[1]}, double{r[2]}).normalized();
}

Eigen::Vector3d vector_of(const Vec3& v) { return {double{v.x}, double{v.y}, double{v.z}}; }

Eigen::Affine3d joint_between(const Transform& start, const Transform& end, double time, Blend blend) {
  Eigen::Quaterniond p = rotation_of(start), q = rotation_of(end);
  if (p.dot(q) < 0) q.coeffs() *= -1;
  const Eigen::Quaterniond r = blend == SC_BLEND_SLERP
                                   ? p.slerp(time, q)
                                   : Eigen::Quaterniond((1 - time) * p.coeffs() + time * q.coeffs()).normalized();
  const auto lerp = [&](const Vec3& a, const Vec3& b) -> Eigen::Vector3d {
    return (1 - time) * vector_of(a) + time * vector_of(b);
  };
  return Eigen::Translation3d(lerp(start.translation, end.translation)) * r *
         Eigen::Scaling(lerp(start.scale, end.scale));
}

}  // namespace

Eigen::Affine3d matrix_of(const float* rows) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  for (Eigen::Index i = 0; i < 12; ++i) out(i / 4, i % 4) = double{rows[i]};
  return out;
}

MovingJoints::MovingJoints(const std::vector<float>& from, const std::vector<float>& to, Order order,
                           double end_scale) {
  const AssetView& view = human_view();
  const std::size_t count = joint_count();
  const auto world = [&](const std::vector<float>& palette, std::size_t bone) {
    return Eigen::Affine3d(matrix_of(&palette[12 * bone]) * matrix_of(view.bone(bone).inverse_bind).inverse());
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t bone = order == Order::kFlat ? count - 1 - i : i;
    Eigen::Affine3d up[2] = {Eigen::Affine3d::Identity(), Eigen::Affine3d::Identity()};
    if (order == Order::kDownTheSkeleton) {
      REQUIRE(std::string(view.bone(bone).name) == view.joint(bone).name);
      const std::int32_t parent = view.joint(bone).parent;
      parents_.push_back(parent < 0 ? SC_NO_JOINT : static_cast<std::uint32_t>(parent));
      if (parent >= 0) {
        up[0] = world(from, static_cast<std::size_t>(parent)).inverse();
        up[1] = world(to, static_cast<std::size_t>(parent)).inverse();
      }
    } else {
      joint_of_bone_.insert(joint_of_bone_.begin(), static_cast<std::uint32_t>(i));
    }
    start_.push_back(transform_of(up[0] * world(from, bone), 1));
    end_.push_back(transform_of(up[1] * world(to, bone), end_scale));
  }
  if (!joint_of_bone_.empty()) joint_of_bone_.resize(view.bone_count(), SC_NO_JOINT);
}

Motion MovingJoints::motion(Blend blend) const {
  Motion out;
  out.body.asset = moving_human().asset.handle();
  out.body.skin_table = human_skin_table();
  out.blend = blend;
  out.start_joints = start_.data();
  out.end_joints = end_.data();
  out.joint_count = start_.size();
  out.parents = parents_.empty() ? nullptr : parents_.data();
  out.joint_of_bone = joint_of_bone_.empty() ? nullptr : joint_of_bone_.data();
  return out;
}

std::vector<float> MovingJoints::palette_at(double time, Blend blend) const {
  std::vector<Eigen::Affine3d> worlds;
  for (std::size_t i = 0; i < start_.size(); ++i) {
    const Eigen::Affine3d own = joint_between(start_[i], end_[i], time, blend);
    const bool has_parent = !parents_.empty() && parents_[i] != SC_NO_JOINT;
    worlds.push_back(has_parent ? worlds[parents_[i]] * own : own);
  }
  std::vector<float> out;
  for (std::size_t b = 0; b < human_view().bone_count(); ++b) {
    const std::size_t joint = joint_of_bone_.empty() ? b : std::size_t{joint_of_bone_[b]};
    Eigen::Affine3d m = Eigen::Affine3d::Identity();
    if (joint < worlds.size()) m = worlds[joint] * matrix_of(human_view().bone(b).inverse_bind);
    for (Eigen::Index i = 0; i < 12; ++i) out.push_back(static_cast<float>(m(i / 4, i % 4)));
  }
  return out;
}

std::vector<float> rest_palette() {
  std::vector<float> out(12 * human_view().bone_count(), 0.0F);
  for (std::size_t i = 0; i < out.size(); i += 12) out[i] = out[i + 5] = out[i + 10] = 1;
  return out;
}

std::size_t bone_named(const std::string& name) {
  std::size_t bone = 0;
  while (bone < human_view().bone_count() && name != human_view().bone(bone).name) ++bone;
  REQUIRE(bone < human_view().bone_count());
  return bone;
}

std::uint32_t part_of_bone(const std::string& name) {
  const auto& parts = moving_human().bake.body_parts.parts;
  std::uint32_t part = 0;
  while (part < parts.size() && parts[part].bone != static_cast<int>(bone_named(name))) ++part;
  REQUIRE(part < parts.size());
  return part;
}

PosedTriangles::PosedTriangles(const std::vector<float>& palette)
    : vertices(skin(*moving_human().asset.handle(), bones_of(palette))) {}

TriangleCorners PosedTriangles::operator[](std::uint32_t source_triangle) const {
  const Surface& surface = moving_human().asset.surface();
  const std::size_t place = surface.place_of_source[source_triangle];
  TriangleCorners out;
  for (std::size_t k = 0; k < 3; ++k) {
    const float* const p =
        &vertices[3 * std::size_t{surface.source_vertices[surface.triangle_vertices[3 * place + k]]}];
    out.p[k] = {p[0], p[1], p[2]};
  }
  return out;
}

double step_tolerance() { return 1e-4 * double{sc_asset_get_info(moving_human().asset.handle()).height}; }

double distance_between(const TriangleCorners& a, const TriangleCorners& b) {
  if (triangles_intersect(a, b)) return 0;
  const auto corners = [](const TriangleCorners& t) {
    return Corners{{to_double(t.p[0]), to_double(t.p[1]), to_double(t.p[2])}};
  };
  return distance_of(corners(a), corners(b));
}

}  // namespace spherechain::test
