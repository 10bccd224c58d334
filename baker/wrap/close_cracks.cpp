// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/wrap/close_cracks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>

namespace spherechain::baker {
namespace {

struct BorderSide {
  Index triangle;
  std::size_t k;  // from corner k to the next
};

// The sides no other triangle has.
std::vector<BorderSide> border_sides(const Mesh& mesh) {
  std::unordered_map<std::uint64_t, int> count;
  const auto key = [&](const Triangle& v, std::size_t k) {
    const auto [low, high] = std::minmax(v[k], v[(k + 1) % 3]);
    return (std::uint64_t{low} << 32) | high;
  };
  for (const Triangle& v : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++count[key(v, k)];
  }
  std::vector<BorderSide> sides;
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (count[key(mesh.triangles[t], k)] == 1) sides.push_back({t, k});
    }
  }
  return sides;
}

// Points by the cube of a grid they are in.
class Grid {
 public:
  explicit Grid(double cell) : cell_(cell) {}

  void add(const Vec3& p, Index id) { cubes_[key(cube(p))].push_back(id); }

  // Visits everything within a cell's size of `p`, and some more.
  template <typename Visit>
  void around(const Vec3& p, const Visit& visit) const {
    const std::array<std::int64_t, 3> middle = cube(p);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = cubes_.find(key({middle[0] + x, middle[1] + y, middle[2] + z}));
          if (found == cubes_.end()) continue;
          for (const Index id : found->second) visit(id);
        }
      }
    }
  }

 private:
  std::array<std::int64_t, 3> cube(const Vec3& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / cell_)), static_cast<std::int64_t>(std::floor(p.y() / cell_)),
            static_cast<std::int64_t>(std::floor(p.z() / cell_))};
  }
  // Two cubes may share a key: who looks measures distances anyway.
  static std::uint64_t key(const std::array<std::int64_t, 3>& cube) {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cube) hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15U;
    return hash;
  }

  double cell_;
  std::unordered_map<std::uint64_t, std::vector<Index>> cubes_;
};

std::vector<Index> vertices_of(const Mesh& mesh, const std::vector<BorderSide>& sides) {
  std::vector<Index> vertices;
  for (const BorderSide& side : sides) {
    vertices.push_back(mesh.triangles[side.triangle][side.k]);
    vertices.push_back(mesh.triangles[side.triangle][(side.k + 1) % 3]);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

void weld(Uncracked& out, double tolerance) {
  const std::vector<Index> border = vertices_of(out.mesh, border_sides(out.mesh));
  Grid grid(tolerance);
  for (const Index v : border) {
    const Vec3& p = out.mesh.positions[v];
    Index nearest = kNoIndex;
    double least = tolerance;
    // Only to vertices that stay: chains of close vertices do not crawl.
    grid.around(p, [&](Index other) {
      const double distance = (out.mesh.positions[other] - p).norm();
      if (distance > least || (distance == least && other > nearest)) return;
      least = distance;
      nearest = other;
    });
    if (nearest == kNoIndex) {
      grid.add(p, v);
    } else {
      out.welded_to[v] = nearest;
      ++out.welded;
    }
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) {
    Triangle v = out.mesh.triangles[t];
    for (Index& corner : v) corner = out.welded_to[corner];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    out.mesh.triangles[kept] = v;
    out.of_triangle[kept++] = out.of_triangle[t];
  }
  out.mesh.triangles.resize(kept);
  out.of_triangle.resize(kept);
}

// Once for each triangle and pass: a triangle with vertices on two of its sides needs another.
bool split_pass(Uncracked& out, double tolerance) {
  Mesh& mesh = out.mesh;
  const std::vector<BorderSide> sides = border_sides(mesh);
  if (sides.empty()) return false;
  double length = 0;
  for (const BorderSide& side : sides) {
    const Triangle& v = mesh.triangles[side.triangle];
    length += (mesh.positions[v[side.k]] - mesh.positions[v[(side.k + 1) % 3]]).norm();
  }
  const std::vector<Index> border = vertices_of(mesh, sides);
  Eigen::AlignedBox3d box;
  for (const Index v : border) box.extend(mesh.positions[v]);
  // On a surface as large as its edges are long; in a cloud of large triangles about one vertex to a cube.
  const double cell = std::max(2 * tolerance, std::min(length / static_cast<double>(sides.size()),
                                                       box.diagonal().norm() / std::cbrt(border.size())));
  Grid grid(cell);
  for (const Index v : border) grid.add(mesh.positions[v], v);

  std::vector<bool> was_split(mesh.triangles.size(), false);
  bool any = false;
  for (const BorderSide& side : sides) {
    if (was_split[side.triangle]) continue;
    const Triangle corners = mesh.triangles[side.triangle];
    const Index a = corners[side.k], b = corners[(side.k + 1) % 3], c = corners[(side.k + 2) % 3];
    const Vec3 from = mesh.positions[a], along = mesh.positions[b] - from;
    const double size = along.norm();
    std::vector<std::pair<double, Index>> on_edge;
    const auto steps = static_cast<std::size_t>(std::ceil(size / cell));
    for (std::size_t i = 0; i <= steps; ++i) {
      grid.around(from + static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(steps, 1)) * along,
                  [&](Index v) {
                    if (v == a || v == b || v == c) return;
                    const Vec3 d = mesh.positions[v] - from;
                    const double s = d.dot(along) / size;
                    if (s < tolerance || s > size - tolerance) return;
                    if ((d - s / size * along).norm() <= tolerance) on_edge.emplace_back(s, v);
                  });
    }
    if (on_edge.empty()) continue;
    std::sort(on_edge.begin(), on_edge.end());
    on_edge.erase(std::unique(on_edge.begin(), on_edge.end()), on_edge.end());
    was_split[side.triangle] = any = true;
    out.t_junctions += on_edge.size();
    mesh.triangles[side.triangle] = {a, on_edge[0].second, c};
    for (std::size_t i = 0; i < on_edge.size(); ++i) {
      const Index next = i + 1 < on_edge.size() ? on_edge[i + 1].second : b;
      mesh.triangles.push_back({on_edge[i].second, next, c});
      out.of_triangle.push_back(out.of_triangle[side.triangle]);
    }
  }
  return any;
}

}  // namespace

Uncracked close_cracks(const Mesh& mesh, double tolerance) {
  Uncracked out;
  out.mesh = mesh;
  out.of_triangle.resize(mesh.triangles.size());
  std::iota(out.of_triangle.begin(), out.of_triangle.end(), Index{0});
  out.welded_to.resize(mesh.positions.size());
  std::iota(out.welded_to.begin(), out.welded_to.end(), Index{0});
  weld(out, tolerance);
  // One side a pass, and three sides; a mesh that goes on splitting is none that cracks explain.
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses && split_pass(out, tolerance); ++pass) {
  }
  return out;
}

}  // namespace spherechain::baker
