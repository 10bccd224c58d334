// SPDX-License-Identifier: GPL-3.0-or-later
#include "bind/bind_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace spherechain::baker {
namespace {

using Vec4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

// What each bone adds to each pivot of a sphere.
using PivotParts = std::vector<std::map<Index, Vec4>>;

std::vector<PivotParts> parts_of(const Character& character, const Binding& binding, const BoneBinding& bones,
                                 const std::vector<VertexWeights>& weights, const Vec3& origin) {
  std::vector<PivotParts> out;
  for (const BoundSphere& sphere : binding.spheres) {
    PivotParts& parts = out.emplace_back();
    for (const BoundPivot& pivot : sphere.pivots) {
      std::map<Index, Vec4>& part = parts.emplace_back();
      for (const Index v : character.source_triangles[character.skin_source_triangle[pivot.triangle]]) {
        const Vec4 corner = Vec3(character.source_positions[v] - origin).homogeneous();
        for (const auto& [bone, share] : bone_shares(weights, v, bones.rest_bone())) {
          part.try_emplace(bone, Vec4::Zero()).first->second += share / 3 * corner;
        }
      }
    }
  }
  return out;
}

std::vector<Index> bones_of(const PivotParts& parts) {
  std::vector<Index> out;
  for (const auto& part : parts) {
    for (const auto& entry : part) out.push_back(entry.first);
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

bool allows_moments(const Binding& binding, const BoneBinding& bones) {
  if (binding.rule != RefitRule::kCalibrated || bones.bones.empty() ||
      bones.bones.size() > std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1) {
    return false;
  }
  return std::ranges::all_of(bones.groups, [](const PivotGroup& group) {
    return std::ranges::all_of(group.parts, [](const BonePart& part) { return part.morphs.empty(); });
  });
}

Vec3 middle_of_pivots(const Character& character, const Binding& binding) {
  Eigen::AlignedBox3d box;
  for (const BoundSphere& sphere : binding.spheres) {
    for (const BoundPivot& pivot : sphere.pivots) box.extend(triangle_centroid(character.skin, pivot.triangle));
  }
  return box.center();
}

// The lowest of those that move most.
Index find_reference(const std::vector<PivotParts>& parts, std::size_t bone_count) {
  std::vector<double> moved(bone_count, 0.0);
  for (const PivotParts& sphere : parts) {
    for (const auto& pivot : sphere) {
      for (const auto& [bone, q] : pivot) moved[bone] += q.w();
    }
  }
  return static_cast<Index>(std::ranges::max_element(moved) - moved.begin());
}

double root_mean_square_spread(const Mesh& skin, const BoundSphere& sphere) {
  Vec3 center = Vec3::Zero();
  for (const BoundPivot& pivot : sphere.pivots) center += pivot.weight * triangle_centroid(skin, pivot.triangle);
  double sum = 0;
  for (const BoundPivot& pivot : sphere.pivots) sum += (triangle_centroid(skin, pivot.triangle) - center).squaredNorm();
  return std::sqrt(sum / static_cast<double>(sphere.pivots.size()));
}

SphereMoments moments_of(std::uint32_t number, const BoundSphere& sphere, const PivotParts& parts) {
  SphereMoments out{number, bones_of(parts), {}, {}, {}};
  std::vector<std::vector<Vec4>> from_center;  // of each bone, each pivot's part less the centre's
  for (const Index bone : out.bones) {
    std::vector<Vec4>& all = from_center.emplace_back();
    Vec4 center = Vec4::Zero();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const auto found = parts[i].find(bone);
      all.push_back(found == parts[i].end() ? Vec4(Vec4::Zero()) : found->second);
      center += sphere.pivots[i].weight * all.back();
    }
    for (Vec4& part : all) part -= center;
    out.centers.push_back(center);
  }
  const double unit = static_cast<double>(parts.size()) * sphere.spread * sphere.spread;
  for (std::size_t k = 0; k < out.bones.size(); ++k) {
    for (std::size_t l = k; l < out.bones.size(); ++l) {
      Matrix4 sum = Matrix4::Zero();
      for (std::size_t i = 0; i < parts.size(); ++i) sum += from_center[k][i] * from_center[l][i].transpose();
      out.moments.push_back((k == l ? 1 : 2) / unit * sum);
    }
  }
  return out;
}

}  // namespace

MomentBinding bind_moments(const Character& character, const BoneBinding& bones,
                           const std::vector<VertexWeights>& rig_weights, Binding& binding) {
  MomentBinding out;
  if (!allows_moments(binding, bones)) return out;
  out.origin = middle_of_pivots(character, binding);
  const std::vector<PivotParts> parts =
      parts_of(character, binding, bones, weights_to_bones(character, rig_weights), out.origin);
  if (std::ranges::any_of(parts, [](const PivotParts& sphere) { return bones_of(sphere).size() > kMaxMomentBones; })) {
    return out;
  }
  out.reference = find_reference(parts, bones.bones.size());
  binding.rule = RefitRule::kMoments;
  std::vector<SphereMoments> spheres;
  for (std::uint32_t i = 0; i < binding.spheres.size(); ++i) {
    binding.spheres[i].spread = root_mean_square_spread(character.skin, binding.spheres[i]);
    spheres.push_back(moments_of(i, binding.spheres[i], parts[i]));
  }
  out.batches = make_batches(spheres);
  return out;
}

}  // namespace spherechain::baker
