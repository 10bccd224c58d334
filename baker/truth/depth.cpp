// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/depth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "mesh/surface_query.h"

namespace spherechain::baker {
namespace {

using Corners = std::array<Vec3, 3>;

Vec3 vertex_at(const std::vector<float>& positions, Index v) {
  const float* p = &positions[std::size_t{3} * v];
  return {p[0], p[1], p[2]};
}

Corners corners_at(const TruthSurface& surface, const std::vector<float>& positions, Index place) {
  Corners out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = vertex_at(positions, surface.corners[place][k]);
  return out;
}

// How far `triangle` pokes through the other's plane.
double poke(const Corners& triangle, const Corners& other) {
  const Vec3 normal = (other[1] - other[0]).cross(other[2] - other[0]).normalized();
  double above = 0, below = 0;
  for (const Vec3& corner : triangle) {
    const double height = normal.dot(corner - other[0]);
    above = std::max(above, height);
    below = std::max(below, -height);
  }
  return std::min(above, below);
}

// The point of a triangle nearest to `p`, as weights of its corners: a weight of exactly 0 says the corner has no part.
Vec3 nearest_weights(const Corners& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], normal = ab.cross(ac);
  const double area = normal.squaredNorm();
  if (area > 0) {
    const Vec3 d = p - t[0];
    const double wb = d.cross(ac).dot(normal) / area, wc = ab.cross(d).dot(normal) / area;
    if (wb >= 0 && wc >= 0 && wb + wc <= 1) return {1 - wb - wc, wb, wc};
  }
  Vec3 best = Vec3::UnitX();
  double least = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vec3 edge = t[next] - t[k];
    const double length = edge.squaredNorm();
    const double along = length > 0 ? std::clamp((p - t[k]).dot(edge) / length, 0.0, 1.0) : 0.0;
    const double distance = (t[k] + along * edge - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = Vec3::Zero();
    best[static_cast<Eigen::Index>(k)] = 1 - along;
    best[static_cast<Eigen::Index>(next)] = along;
  }
  return best;
}

Mesh region_mesh(const TruthSurface& surface, const std::vector<float>& positions, std::uint32_t sphere) {
  Mesh mesh;
  for (const Index place : surface.of_sphere[sphere]) {
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Vec3& corner : corners_at(surface, positions, place)) mesh.positions.push_back(corner);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

// One sphere's triangles, deformed, that points can be behind of.
class Patch {
 public:
  Patch(const TruthSurface& surface, const std::vector<float>& positions, std::uint32_t sphere)
      : query_(region_mesh(surface, positions, sphere)) {
    for (const Index place : surface.of_sphere[sphere]) {
      triangles_.push_back(corners_at(surface, positions, place));
      welded_.push_back(surface.welded[place]);
    }
    for (std::size_t i = 0; i < triangles_.size(); ++i) add_normals(i);
    for (const auto& [edge, count] : edge_count_) {
      if (count == 2) continue;
      border_.insert({edge.first, edge.first});
      border_.insert({edge.second, edge.second});
      border_.insert(edge);
    }
  }

  // 0 where `p` is not behind, or cannot be told to be.
  double depth_of(const Vec3& p) const {
    const SurfaceHit nearest = query_.closest(p);
    const Vec3 weights = nearest_weights(triangles_[nearest.triangle], p);
    const std::optional<Vec3> normal = normal_at(nearest.triangle, weights);
    return normal && normal->dot(p - nearest.point) < 0 ? nearest.distance : 0;
  }

 private:
  using Edge = std::pair<Index, Index>;  // of welded vertices, the lesser first; a vertex: itself twice

  void add_normals(std::size_t i) {
    const Corners& t = triangles_[i];
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    normals_.push_back(normal);
    for (std::size_t k = 0; k < 3; ++k) {
      const Index v = welded_[i][k], next = welded_[i][(k + 1) % 3];
      const Vec3 to = (t[(k + 1) % 3] - t[k]).normalized(), from = (t[(k + 2) % 3] - t[k]).normalized();
      add({v, v}, std::acos(std::clamp(to.dot(from), -1.0, 1.0)) * normal);
      add(std::minmax(v, next), normal);
      ++edge_count_[std::minmax(v, next)];
    }
  }
  void add(const Edge& edge, const Vec3& normal) { at_edge_.try_emplace(edge, Vec3::Zero()).first->second += normal; }

  // Of the face, edge (both faces' sum) or vertex (each face by its angle) that a point is on: with these the nearest
  // point's side is that of the surface. None on the border.
  std::optional<Vec3> normal_at(std::size_t i, const Vec3& weights) const {
    std::vector<Index> on;
    for (std::size_t k = 0; k < 3; ++k) {
      if (weights[static_cast<Eigen::Index>(k)] > 0) on.push_back(welded_[i][k]);
    }
    if (on.size() == 3) return normals_[i];
    const Edge edge = std::minmax(on.front(), on.back());
    if (border_.count(edge) > 0) return std::nullopt;
    return at_edge_.at(edge);
  }

  SurfaceQuery query_;
  std::vector<Corners> triangles_;
  std::vector<Triangle> welded_;
  std::vector<Vec3> normals_;
  std::map<Edge, Vec3> at_edge_;
  std::map<Edge, int> edge_count_;
  std::set<Edge> border_;
};

double deepest(const TruthSurface& surface, const std::vector<float>& positions, std::uint32_t of,
               const Patch& behind) {
  std::set<Index> seen;
  double depth = 0;
  for (const Index place : surface.of_sphere[of]) {
    for (const Index v : surface.corners[place]) {
      if (seen.insert(v).second) depth = std::max(depth, behind.depth_of(vertex_at(positions, v)));
    }
  }
  return depth;
}

}  // namespace

double penetration(const TrueContact& contact, const TruthSurface& surface, const std::vector<float>& positions) {
  double depth = 0;
  for (const Pair& pair : contact.triangles) {
    const Corners a = corners_at(surface, positions, surface.of_source[pair.a]),
                  b = corners_at(surface, positions, surface.of_source[pair.b]);
    depth = std::max(depth, std::min(poke(a, b), poke(b, a)));
  }
  const auto [a, b] = contact.spheres;
  depth = std::max(depth, deepest(surface, positions, a, Patch(surface, positions, b)));
  return std::max(depth, deepest(surface, positions, b, Patch(surface, positions, a)));
}

}  // namespace spherechain::baker
