// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/from_skin.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "baker/mesh/ring.h"
#include "baker/mesh/surface_query.h"
#include "baker/segment/islands.h"

namespace spherechain::baker {
namespace {

constexpr std::uint8_t kNoLimb = SkinRegions::kNoLimb;
constexpr std::uint8_t kUnknown = 254;  // nothing moves it

constexpr int kRays = 40;
constexpr int kSteps = 200;         // along the limb
constexpr double kWindow = 0.02;    // either side, for its direction
constexpr double kOwnRays = 0.95;   // share of a ring's rays that meet the limb's own skin where it stands free
constexpr double kLengthMin = 0.2;  // of the free part's length, of a limb before its hand or foot
constexpr int kStartsBy = 120;      // of its steps: a limb that stands free nowhere before is cut at its joint

// Limb of each bone of the rig.
std::vector<std::uint8_t> limb_of_bone(const SourceRig& rig, const Roles& roles) {
  std::vector<std::uint8_t> limbs;
  for (const Bone& bone : rig.bones) {
    const int limb = roles.of_node[bone.node].limb;
    limbs.push_back(limb < 0 ? kNoLimb : static_cast<std::uint8_t>(limb));
  }
  return limbs;
}

// For each vertex of a welded mesh a source vertex whose weights it has.
std::vector<Index> weighted_source(const SourceRig& rig, const std::vector<Index>& of_source, std::size_t vertices) {
  std::vector<Index> source(vertices, kNoIndex);
  for (Index v = 0; v < of_source.size(); ++v) {
    if (of_source[v] != kNoIndex && source[of_source[v]] == kNoIndex && rig.weights[v].weight[0] > 0) {
      source[of_source[v]] = v;
    }
  }
  return source;
}

std::vector<std::uint8_t> dominant_limbs(const SourceRig& rig, const Roles& roles, const Mesh& mesh,
                                         const std::vector<Index>& of_source) {
  const std::vector<std::uint8_t> limb_of = limb_of_bone(rig, roles);
  const std::vector<Index> source = weighted_source(rig, of_source, mesh.positions.size());
  std::vector<std::uint8_t> labels;
  for (const Triangle& triangle : mesh.triangles) {
    std::map<std::uint8_t, double> sum;
    for (const Index corner : triangle) {
      if (source[corner] == kNoIndex) continue;
      const VertexWeights& weights = rig.weights[source[corner]];
      for (std::size_t k = 0; k < kMaxInfluences; ++k) {
        if (weights.weight[k] > 0) sum[limb_of[weights.joint[k]]] += weights.weight[k];
      }
    }
    const auto most =
        std::max_element(sum.begin(), sum.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
    labels.push_back(most == sum.end() ? kUnknown : most->first);
  }
  return labels;
}

// On each part of the mesh, keeps each region's largest island; every other one joins the region it shares most of its
// border with. A part is what hangs together over edges: where clothes meet in a seam of three triangles an edge, each
// is one.
void join_islands(const Mesh& mesh, const Neighbours& neighbours, std::vector<std::uint8_t>& labels) {
  const Islands islands = find_islands(mesh, neighbours, labels);
  const std::vector<Index> parts =
      find_islands(mesh, neighbours, std::vector<std::uint8_t>(labels.size(), 0)).of_triangle;
  using Region = std::pair<Index, std::uint8_t>;  // on a part
  const auto region_of = [&](Index id) {
    const Index t = islands.triangles[id][0];
    return Region(parts[t], labels[t]);
  };
  std::map<Region, std::pair<double, Index>> largest;
  for (Index id = 0; id < islands.triangles.size(); ++id) {
    auto& kept = largest[region_of(id)];
    if (islands.area[id] > kept.first) kept = {islands.area[id], id};
  }
  // From the largest on, so that an island in an island joins what its surroundings have become.
  std::vector<Index> joining;
  for (Index id = 0; id < islands.triangles.size(); ++id) {
    const Region region = region_of(id);
    if (region.second == kUnknown || largest[region].second != id) joining.push_back(id);
  }
  std::stable_sort(joining.begin(), joining.end(),
                   [&](Index l, Index r) { return islands.triangles[l].size() > islands.triangles[r].size(); });
  for (const Index id : joining) {
    std::array<double, 256> border = border_lengths(mesh, neighbours, islands, labels, id);
    border[kUnknown] = 0;
    const auto longest = std::max_element(border.begin(), border.end());
    const std::uint8_t label = *longest > 0 ? static_cast<std::uint8_t>(longest - border.begin()) : kNoLimb;
    for (const Index t : islands.triangles[id]) labels[t] = label;
  }
}

Vec3 centroid(const Mesh& mesh, const std::vector<Index>& triangles) {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (const Index t : triangles) {
    sum += triangle_area(mesh, t) * triangle_centroid(mesh, t);
    area += triangle_area(mesh, t);
  }
  return sum / area;
}

// The vertex farthest beyond the last joint.
Vec3 tip_of(const Mesh& mesh, const std::vector<Index>& own, const Vec3& from, const Vec3& direction) {
  Vec3 tip = from;
  double farthest = 0;
  for (const Index t : own) {
    for (const Index corner : mesh.triangles[t]) {
      const double along = (mesh.positions[corner] - from).dot(direction);
      if (along <= farthest) continue;
      farthest = along;
      tip = mesh.positions[corner];
    }
  }
  return tip;
}

Ring ring_at(const SurfaceQuery& surface, const Vec3& center, const Vec3& normal, const Vec3& reference) {
  const bool usable = normal.cross(reference).norm() > 0.1 * reference.norm();
  return cast_ring(surface, center, normal, usable ? reference : Vec3(normal.unitOrthogonal()), kRays);
}

// Through the joints, each moved to the middle of the limb's section there, and on to the tip.
SkinLimb centre_line(const Mesh& mesh, const std::vector<Index>& own, const RoleLimb& role,
                     const std::vector<Vec3>& joints, const Vec3& reference) {
  std::vector<Vec3> points;
  std::size_t wrist = role.nodes.size();
  for (std::size_t i = 0; i < role.nodes.size(); ++i) {
    const Vec3& p = joints[role.nodes[i]];
    if (points.empty() || (p - points.back()).norm() > 0) points.push_back(p);
    if (static_cast<int>(i) == role.extremity) wrist = points.size() - 1;
  }
  const Vec3 before = points.size() > 1 ? points[points.size() - 2] : Vec3(2 * points[0] - centroid(mesh, own));
  const Vec3 tip = tip_of(mesh, own, points.back(), points.back() - before);
  if ((tip - points.back()).norm() > 0) points.push_back(tip);
  const SurfaceQuery surface(mesh, own);
  std::vector<Vec3> centred = points;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Vec3 normal = (points[i + 1] - points[i]).normalized() + (points[i] - points[i - 1]).normalized();
    if (normal.norm() < 0.1) continue;  // folded back on itself
    centred[i] = ring_at(surface, points[i], normal.normalized(), reference).section_centroid();
  }
  const Polyline line(centred);
  return {line, wrist < centred.size() ? line.closest(centred[wrist]) : line.length()};
}

// Arc length of the first ring that meets (almost) nothing but the limb; 0 where there is none soon enough.
double free_start(const SurfaceQuery& surface, const std::vector<std::uint8_t>& labels, std::uint8_t limb,
                  const Polyline& line, const Vec3& reference) {
  const double length = line.length();
  for (int k = 0; k < kStartsBy; ++k) {
    const double s = k * length / kSteps;
    const Ring ring = ring_at(surface, line.at(s), line.tangent(s, kWindow * length), reference);
    const auto own = std::count_if(ring.hits.begin(), ring.hits.end(),
                                   [&](const auto& hit) { return hit && labels[hit->triangle] == limb; });
    if (static_cast<double>(own) >= kOwnRays * kRays) return s;
  }
  return 0;
}

}  // namespace

SkinRegions segment_from_skin(const Character& character, const BodyMesh& body, const Roles& roles) {
  const Mesh& mesh = character.skin;
  const std::vector<Vec3> joints = rest_positions(character.rig);
  const Neighbours neighbours = triangle_neighbours(mesh);
  const SurfaceQuery surface(mesh);
  const Vec3 middle = surface_centroid(mesh);
  SkinRegions regions;
  std::vector<std::uint8_t> dominant = dominant_limbs(character.rig, roles, mesh, character.skin_of_source);
  join_islands(mesh, neighbours, dominant);
  std::vector<std::uint8_t> labels = dominant;
  for (std::uint8_t i = 0; i < roles.limbs.size(); ++i) {
    std::vector<Index> own;
    for (Index t = 0; t < dominant.size(); ++t) {
      if (dominant[t] == i) own.push_back(t);
    }
    regions.limbs.emplace_back();
    if (own.empty()) continue;
    const Vec3 reference = middle - joints[roles.limbs[i].nodes[0]];
    SkinLimb limb = centre_line(mesh, own, roles.limbs[i], joints, reference);
    if (!(limb.line.length() > 0)) continue;
    const double start = free_start(surface, dominant, i, limb.line, reference);
    const Vec3 at = limb.line.at(start), normal = limb.line.tangent(start, kWindow * limb.line.length());
    for (const Index t : own) {
      if ((triangle_centroid(mesh, t) - at).dot(normal) < 0) labels[t] = kNoLimb;
    }
    // One that stands free from hand or foot on only is no more than that.
    const Polyline line = limb.line.part(start, limb.line.length());
    const double extremity = limb.extremity - start;
    regions.limbs.back() = {line, extremity > kLengthMin * line.length() ? extremity : line.length()};
  }
  join_islands(mesh, neighbours, labels);
  regions.of_skin = std::move(labels);
  std::vector<std::uint8_t> of_source(character.source_triangles.size(), kNoLimb);
  for (std::size_t t = 0; t < regions.of_skin.size(); ++t) {
    of_source[character.skin_source_triangle[t]] = regions.of_skin[t];
  }
  for (const Index source : body.source_triangle) regions.of_triangle.push_back(of_source[source]);
  return regions;
}

}  // namespace spherechain::baker
