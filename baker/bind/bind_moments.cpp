// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/bind_moments.h"

#include <algorithm>
#include <limits>
#include <map>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using Vec4 = Eigen::Vector4d;
using Matrix4 = Eigen::Matrix4d;

// Contribution of each bone to each pivot of a sphere.
using PivotParts = std::vector<std::map<Index, Vec4>>;

std::vector<PivotParts> pivot_contributions(const Character& character, const Binding& binding,
                                            const BoneBinding& bones, const std::vector<VertexWeights>& weights,
                                            const Vec3& origin) {
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

// A sphere on more bones than the runtime takes follows those that move it most; the rest of the weights goes to the
// first of them.
void keep_main_bones(PivotParts& parts) {
  std::map<Index, double> moved;
  for (const auto& part : parts) {
    for (const auto& [bone, q] : part) moved[bone] += q.w();
  }
  if (moved.size() <= kMaxMomentBones) return;
  std::vector<std::pair<double, Index>> order;
  for (const auto& [bone, weight] : moved) order.emplace_back(-weight, bone);
  std::ranges::sort(order);
  const Index main = order.front().second;
  for (std::size_t i = kMaxMomentBones; i < order.size(); ++i) {
    for (auto& part : parts) {
      const auto found = part.find(order[i].second);
      if (found == part.end()) continue;
      const Vec4 share = found->second;
      part.erase(found);
      part.try_emplace(main, Vec4::Zero()).first->second += share;
    }
  }
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
                           const std::vector<VertexWeights>& rig_weights, const Binding& binding) {
  MomentBinding out;
  if (binding.rule != RefitRule::kMoments || bones.bones.empty()) return out;
  if (bones.bones.size() > std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1) {
    throw Error(ExitCode::kFile, character.file + ": has more than 65536 bones");
  }
  out.origin = middle_of_pivots(character, binding);
  std::vector<PivotParts> parts =
      pivot_contributions(character, binding, bones, weights_to_bones(character, rig_weights), out.origin);
  std::ranges::for_each(parts, keep_main_bones);
  out.reference = find_reference(parts, bones.bones.size());
  std::vector<SphereMoments> spheres;
  for (std::uint32_t i = 0; i < binding.spheres.size(); ++i) {
    spheres.push_back(moments_of(i, binding.spheres[i], parts[i]));
  }
  out.batches = make_batches(spheres);
  return out;
}

}  // namespace spherechain::baker
