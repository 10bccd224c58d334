// SPDX-License-Identifier: GPL-3.0-or-later
#include "capsules.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include "baker/bind/bind.h"
#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

double distance_to_segment(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - from).dot(along) / length, 0.0, 1.0) : 0.0;
  return (from + t * along - p).norm();
}

// The distance of the axes.
double axis_distance(const Capsule& a, const Capsule& b) {
  const Vec3 u = a.to - a.from, v = b.to - b.from, w = a.from - b.from;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), determinant = uu * vv - uv * uv;
  if (determinant > 1e-12 * uu * vv) {
    const double s = (uv * v.dot(w) - vv * u.dot(w)) / determinant, t = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) return (w + s * u - t * v).norm();
  }
  return std::min({distance_to_segment(a.from, b.from, b.to), distance_to_segment(a.to, b.from, b.to),
                   distance_to_segment(b.from, a.from, a.to), distance_to_segment(b.to, a.from, a.to)});
}

double area_quantile(const std::vector<double>& values, const std::vector<double>& areas, double share) {
  std::vector<std::pair<double, double>> weighted;
  for (std::size_t i = 0; i < values.size(); ++i) weighted.emplace_back(values[i], areas[i]);
  return weighted_quantile(std::move(weighted), share);
}

// The bone that moves a triangle most; one past the last where none does.
std::size_t bone_of(const Triangle& corners, const std::vector<VertexWeights>& weights, std::size_t bones) {
  std::map<std::size_t, double> sum;
  for (const Index corner : corners) {
    for (std::size_t k = 0; k < kMaxInfluences; ++k) sum[weights[corner].joint[k]] += weights[corner].weight[k];
  }
  const auto most =
      std::max_element(sum.begin(), sum.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
  return most->second > 0 ? most->first : bones;
}

// Each bone's parent bone, itself where it has none; that of a source's bone is the next node up that is a bone.
std::vector<std::size_t> bone_parents(const AnimatedAsset& animated) {
  std::vector<std::size_t> parents(animated.bone_names().size());
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  const SourceRig& rig = animated.character().rig;
  if (rig.bones.empty()) {
    for (std::size_t i = 0; i < parents.size(); ++i) {
      if (const int parent = animated.asset()->joint(i).parent; parent >= 0) {
        parents[i] = static_cast<std::size_t>(parent);
      }
    }
    return parents;
  }
  std::map<int, std::size_t> bone_at;
  for (std::size_t i = rig.bones.size(); i-- > 0;) bone_at[static_cast<int>(rig.bones[i].node)] = i;
  for (std::size_t i = 0; i < parents.size(); ++i) {
    int node = rig.nodes[rig.bones[i].node].parent;
    while (node >= 0 && bone_at.count(node) == 0) node = rig.nodes[static_cast<std::size_t>(node)].parent;
    if (node >= 0) parents[i] = bone_at[node];
  }
  return parents;
}

Capsule moved(const Capsule& capsule, const std::vector<Affine>& bones, std::size_t bone) {
  if (bone >= bones.size()) return capsule;
  return {bones[bone] * capsule.from, bones[bone] * capsule.to, capsule.radius};
}

}  // namespace

Capsule fit_capsule(const std::vector<Vec3>& points, const std::vector<double>& areas, double quantile) {
  const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
  Vec3 center = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) center += areas[i] / total * points[i];
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    spread += areas[i] * (points[i] - center) * (points[i] - center).transpose();
  }
  const Vec3 axis = principal_axes(spread).vectors.col(2);
  double low = 0, high = 0;
  std::vector<double> distances;
  for (const Vec3& p : points) {
    const double along = (p - center).dot(axis);
    low = std::min(low, along);
    high = std::max(high, along);
    distances.push_back((p - center - along * axis).norm());
  }
  const double radius = area_quantile(distances, areas, quantile);
  low += radius;
  high -= radius;
  if (low > high) low = high = (low + high) / 2;
  Capsule capsule{center + low * axis, center + high * axis, 0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    distances[i] = distance_to_segment(points[i], capsule.from, capsule.to);
  }
  capsule.radius = area_quantile(distances, areas, quantile);
  return capsule;
}

double gap(const Capsule& a, const Capsule& b) { return axis_distance(a, b) - a.radius - b.radius; }

CapsuleRagdoll::CapsuleRagdoll(const AnimatedAsset& animated, const TruthSurface& surface, double quantile)
    : surface_(surface) {
  const std::size_t bones = animated.bone_names().size();
  if (bones == 0 || animated.weights().empty()) return;
  const Character& character = animated.character();
  std::map<std::size_t, std::vector<Index>> of_bone;  // places in the surface
  for (Index place = 0; place < surface_.corners.size(); ++place) {
    of_bone[bone_of(surface_.corners[place], animated.weights(), bones)].push_back(place);
  }
  surface_.of_sphere.clear();
  std::map<std::size_t, std::size_t> capsule_of;
  for (auto& [bone, places] : of_bone) {
    std::vector<Vec3> points;
    std::vector<double> areas;
    for (const Index place : places) {
      const Triangle& t = surface_.corners[place];
      const std::array<Vec3, 3> p{character.source_positions[t[0]], character.source_positions[t[1]],
                                  character.source_positions[t[2]]};
      points.push_back((p[0] + p[1] + p[2]) / 3);
      areas.push_back((p[1] - p[0]).cross(p[2] - p[0]).norm() / 2);
      surface_.sphere[place] = static_cast<std::uint32_t>(capsules_.size());
    }
    capsule_of[bone] = capsules_.size();
    capsules_.push_back(fit_capsule(points, areas, quantile));
    bone_.push_back(bone);
    surface_.of_sphere.push_back(std::move(places));
  }
  ignored_.assign(capsules_.size(), std::vector<bool>(capsules_.size()));
  const std::vector<std::size_t> parents = bone_parents(animated);
  for (const auto& [bone, capsule] : capsule_of) {
    if (bone >= bones) continue;
    std::size_t above = parents[bone];
    while (capsule_of.count(above) == 0 && parents[above] != above) above = parents[above];
    const auto found = capsule_of.find(above);
    if (found == capsule_of.end() || found->second == capsule) continue;
    ignored_[capsule][found->second] = ignored_[found->second][capsule] = true;
  }
}

bool CapsuleRagdoll::is_ignored(std::uint32_t a, std::uint32_t b) const { return ignored_[a][b]; }

std::vector<Pair> CapsuleRagdoll::pairs(const Deformation& deformation) const {
  std::vector<Capsule> now;
  for (std::size_t i = 0; i < capsules_.size(); ++i) now.push_back(moved(capsules_[i], deformation.bones, bone_[i]));
  std::vector<Pair> out;
  for (std::uint32_t a = 0; a < now.size(); ++a) {
    for (std::uint32_t b = a + 1; b < now.size(); ++b) {
      if (is_ignored(a, b) || gap(now[a], now[b]) >= 0) continue;
      if (axis_distance(now[a], now[b]) >= kPaperRestScale * axis_distance(capsules_[a], capsules_[b])) continue;
      out.push_back({a, b});
    }
  }
  return out;
}

FrameTruth CapsuleRagdoll::by_capsules(const FrameTruth& truth) const {
  FrameTruth out = truth;
  std::map<Pair, std::vector<Pair>> contacts;
  for (const Pair& pair : truth.pairs) {
    const auto [a, b] =
        std::minmax({surface_.sphere[surface_.of_source[pair.a]], surface_.sphere[surface_.of_source[pair.b]]});
    contacts[{a, b}].push_back(pair);
  }
  out.contacts.clear();
  for (auto& [capsules, triangles] : contacts) out.contacts.push_back({capsules, std::move(triangles)});
  return out;
}

}  // namespace spherechain::baker
