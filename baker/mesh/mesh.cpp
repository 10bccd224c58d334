// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace spherechain::baker {
namespace {

// An edge as a triangle has it: edge k runs from corner k to the next one.
struct EdgeUse {
  Index high;  // the edge's vertex with the higher number
  Index triangle;
  std::uint8_t k;
  bool forward;  // from its lower vertex to its higher one
};

// Visits each edge of two vertices once, with its uses in the order of the triangles. They are sorted by the lower
// vertex first, which is faster than a hash table of all edges.
template <class Visit>
void for_each_edge(const Mesh& mesh, const Visit& visit) {
  const auto ends = [](const Triangle& t, std::size_t k) { return std::minmax(t[k], t[(k + 1) % 3]); };
  std::vector<std::size_t> first(mesh.positions.size() + 1);
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = ends(t, k);
      if (low != high) ++first[low + 1];
    }
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<EdgeUse> uses(3 * mesh.triangles.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    for (std::uint8_t k = 0; k < 3; ++k) {
      const auto [low, high] = ends(corners, k);
      if (low != high) uses[next[low]++] = {high, t, k, corners[k] == low};
    }
  }
  for (std::size_t v = 0; v + 1 < first.size(); ++v) {
    const std::span<EdgeUse> around(uses.data() + first[v], uses.data() + first[v + 1]);
    std::ranges::sort(around, {}, [](const EdgeUse& use) { return std::tuple(use.high, use.triangle, use.k); });
    for (std::size_t begin = 0, end = 0; begin < around.size(); begin = end) {
      while (end < around.size() && around[end].high == around[begin].high) ++end;
      visit(std::span<const EdgeUse>(around.subspan(begin, end - begin)));
    }
  }
}

}  // namespace

Vec3 triangle_centroid(const Mesh& mesh, std::size_t t) {
  const Triangle& v = mesh.triangles[t];
  return (mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]]) / 3.0;
}

Vec3 triangle_cross(const Mesh& mesh, std::size_t t) {
  const Triangle& v = mesh.triangles[t];
  const Vec3& a = mesh.positions[v[0]];
  return (mesh.positions[v[1]] - a).cross(mesh.positions[v[2]] - a);
}

double triangle_area(const Mesh& mesh, std::size_t t) { return 0.5 * triangle_cross(mesh, t).norm(); }

std::vector<std::array<Index, 3>> triangle_neighbours(const Mesh& mesh) {
  std::vector<std::array<Index, 3>> neighbours(mesh.triangles.size(), {kNoIndex, kNoIndex, kNoIndex});
  for_each_edge(mesh, [&](std::span<const EdgeUse> uses) {
    if (uses.size() != 2) return;
    neighbours[uses[0].triangle][uses[0].k] = uses[1].triangle;
    neighbours[uses[1].triangle][uses[1].k] = uses[0].triangle;
  });
  return neighbours;
}

Components connected_components(const Mesh& mesh) {
  std::vector<Index> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& v : mesh.triangles) {
    parent[root(v[1])] = root(v[0]);
    parent[root(v[2])] = root(v[0]);
  }
  Components components;
  components.of_triangle.reserve(mesh.triangles.size());
  std::vector<Index> label(mesh.positions.size(), kNoIndex);
  for (const Triangle& v : mesh.triangles) {
    Index& l = label[root(v[0])];
    if (l == kNoIndex) l = components.count++;
    components.of_triangle.push_back(l);
  }
  return components;
}

std::size_t count_open_edges(const Mesh& mesh) {
  std::size_t open = 0;
  for_each_edge(mesh, [&](std::span<const EdgeUse> uses) {
    const auto forward = static_cast<std::size_t>(std::ranges::count_if(uses, &EdgeUse::forward));
    const std::size_t back = uses.size() - forward;
    if (forward != 1 || back != 1) open += (forward > 0) + (back > 0);
  });
  return open;
}

double surface_area(const Mesh& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area += triangle_area(mesh, t);
  return area;
}

Vec3 surface_centroid(const Mesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += triangle_area(mesh, t) * triangle_centroid(mesh, t);
  return sum / surface_area(mesh);
}

double weighted_quantile(std::vector<std::pair<double, double>> weighted, double share) {
  double total = 0;
  for (const auto& [value, weight] : weighted) total += weight;
  std::sort(weighted.begin(), weighted.end());
  double sum = 0;
  for (const auto& [value, weight] : weighted) {
    sum += weight;
    if (sum >= share * total) return value;
  }
  return weighted.empty() ? 0 : weighted.back().first;
}

double diameter(const Mesh& mesh) {
  const Vec3 centroid = surface_centroid(mesh);
  double farthest = 0;
  for (const Vec3& p : mesh.positions) farthest = std::max(farthest, (p - centroid).norm());
  return 2 * farthest;
}

}  // namespace spherechain::baker
