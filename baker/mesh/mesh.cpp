// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace spherechain::baker {
namespace {

std::uint64_t directed_edge(Index a, Index b) { return (std::uint64_t{a} << 32) | b; }

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
  constexpr Index kShared = kNoIndex - 1;  // more than two triangles: nobody's neighbour
  struct Sides {
    Index first = kNoIndex, second = kNoIndex;
  };
  std::unordered_map<std::uint64_t, Sides> edges;
  edges.reserve(mesh.triangles.size() * 2);
  const auto key = [&](const Triangle& v, int k) {
    const Index a = v[static_cast<std::size_t>(k)], b = v[static_cast<std::size_t>((k + 1) % 3)];
    return directed_edge(std::min(a, b), std::max(a, b));
  };
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      Sides& sides = edges[key(mesh.triangles[t], k)];
      if (sides.first == kNoIndex) {
        sides.first = t;
      } else {
        sides.second = sides.second == kNoIndex ? t : kShared;
      }
    }
  }
  std::vector<std::array<Index, 3>> neighbours(mesh.triangles.size());
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Sides sides = edges[key(mesh.triangles[t], k)];
      neighbours[t][static_cast<std::size_t>(k)] =
          sides.second == kShared ? kNoIndex : (sides.first == t ? sides.second : sides.first);
    }
  }
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
  std::unordered_map<std::uint64_t, int> directed;
  directed.reserve(mesh.triangles.size() * 3);
  for (const Triangle& v : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++directed[directed_edge(v[k], v[(k + 1) % 3])];
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : directed) {
    const auto opposite = directed.find(directed_edge(static_cast<Index>(edge), static_cast<Index>(edge >> 32)));
    if (count != 1 || opposite == directed.end() || opposite->second != 1) ++open;
  }
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
