// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/bodies.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "baker/bind/body_parts.h"
#include "baker/mesh/area_samples.h"
#include "baker/play/play.h"

namespace spherechain::baker {
namespace {

Vec3 vec3_of(const sc_vec3& v) { return {v.x, v.y, v.z}; }

Affine affine_of(const float* rows) {
  Affine out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) out.matrix()(row, column) = double{rows[4 * row + column]};
  }
  return out;
}

// Parts in an order in which each comes after the one that it hangs on.
std::vector<int> parents_first(const std::vector<BodyPart>& parts) {
  std::vector<int> order;
  std::vector<bool> taken(parts.size(), false);
  const auto take = [&](auto&& self, int part) -> void {
    const auto i = static_cast<std::size_t>(part);
    if (taken[i]) return;
    taken[i] = true;
    if (parts[i].parent >= 0) self(self, parts[i].parent);
    order.push_back(part);
  };
  for (int part = 0; part < static_cast<int>(parts.size()); ++part) take(take, part);
  return order;
}

}  // namespace

Colliders find_bodies(const OpenAsset& asset) {
  const AssetInfo info = asset->info();
  Colliders out;
  out.source_file = info.source_file;
  out.metres_per_unit = asset.metres_per_unit();
  out.height = double{info.height} * out.metres_per_unit;
  out.left = vec3_of(info.left).normalized();
  out.up = (vec3_of(info.up) - vec3_of(info.up).dot(out.left) * out.left).normalized();
  out.forward = out.left.cross(out.up);
  const BodyParts parts = body_parts_of(asset);
  const std::vector<int> order = parents_first(parts.parts);
  std::vector<int> body_of_part(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) body_of_part[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  for (const int p : order) {
    const BodyPart& part = parts.parts[static_cast<std::size_t>(p)];
    ColliderBody body;
    body.name = part.name;
    if (part.parent >= 0) body.parent = body_of_part[static_cast<std::size_t>(part.parent)];
    if (part.bone >= 0) {
      const BoneView bone = asset->bone(static_cast<std::size_t>(part.bone));
      body.bone = bone.name;
      body.bone_index = part.bone;
      const Affine inverse_bind = affine_of(bone.inverse_bind);
      Affine rest = inverse_bind.inverse();
      rest.translation() *= out.metres_per_unit;
      body.rest = rigid_part(rest);
      body.to_bone = inverse_bind * Eigen::Scaling(1 / out.metres_per_unit) * Affine(body.rest);
    }
    out.bodies.push_back(std::move(body));
  }
  return out;
}

std::vector<int> body_of_parts(const OpenAsset& asset, const Colliders& colliders) {
  std::map<std::string, int> by_name;
  for (std::size_t i = 0; i < colliders.bodies.size(); ++i) by_name[colliders.bodies[i].name] = static_cast<int>(i);
  std::vector<int> out;
  for (std::size_t i = 0; i < asset->part_count(); ++i) out.push_back(by_name.at(asset->part(i).name));
  return out;
}

std::vector<Eigen::Isometry3d> at_rest(const Colliders& colliders) {
  std::vector<Eigen::Isometry3d> out;
  for (const ColliderBody& body : colliders.bodies) out.push_back(body.rest);
  return out;
}

std::vector<Vec3> skin_positions(const OpenAsset& asset) {
  const Surface& surface = asset.surface();
  std::vector<Vec3> out;
  for (std::size_t v = 0; v < surface.rest_positions.size / 3; ++v) {
    const float* p = surface.rest_positions.data + 3 * v;
    out.push_back(asset.metres_per_unit() * Vec3(double{p[0]}, double{p[1]}, double{p[2]}));
  }
  return out;
}

std::vector<Vec3> skin_positions(const OpenAsset& asset, const std::vector<Vec3>& source) {
  const Surface& surface = asset.surface();
  std::vector<Vec3> out;
  for (const std::uint32_t v : surface.source_vertices) {
    out.push_back(asset.metres_per_unit() * source[v]);
  }
  return out;
}

std::vector<SkinSample> sample_skin(const OpenAsset& asset, const Colliders& colliders,
                                    const std::vector<Vec3>& positions, int count) {
  const Surface& surface = asset.surface();
  const std::vector<int> body_of_part = body_of_parts(asset, colliders);
  Mesh mesh{positions, {}};
  std::vector<double> areas(colliders.bodies.size(), 0);
  for (std::size_t t = 0; t < surface.triangles.size; ++t) {
    const std::uint32_t* v = surface.triangle_vertices.data + 3 * t;
    mesh.triangles.push_back({v[0], v[1], v[2]});
    areas[static_cast<std::size_t>(body_of_part[surface.parts[t]])] += triangle_area(mesh, t);
  }
  std::vector<SkinSample> out;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int body = body_of_part[surface.parts[t]];
    const Vec3 cross = triangle_cross(mesh, t);
    if (cross.norm() <= 0) continue;
    const double fine = std::sqrt(2 * areas[static_cast<std::size_t>(body)] / count);
    for_each_area_sample(mesh, t, fine, [&](const Vec3& point, double area) {
      out.push_back({point, cross.normalized(), area, body});
    });
  }
  return out;
}

void ignore_by_rest(Colliders& colliders) {
  colliders.ignored.clear();
  std::map<std::pair<int, int>, IgnoredReason> found;
  for (const auto& [a, b] : overlapping(colliders, at_rest(colliders))) found[{a, b}] = IgnoredReason::kRest;
  for (int b = 0; b < static_cast<int>(colliders.bodies.size()); ++b) {
    const int a = colliders.bodies[static_cast<std::size_t>(b)].parent;
    if (a >= 0) found[{a, b}] = IgnoredReason::kAdjacent;
  }
  for (const auto& [pair, reason] : found) colliders.ignored.push_back({pair.first, pair.second, reason});
}

}  // namespace spherechain::baker
