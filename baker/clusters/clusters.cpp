// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/clusters/clusters.h"

#include <algorithm>
#include <map>

namespace spherechain::baker {
namespace {

std::vector<Cluster> cluster_regions(const Character& character, const Binding& binding,
                                     const ClusterSettings& settings) {
  const Components pieces = connected_components(character.skin);
  std::map<std::pair<std::uint32_t, Index>, std::vector<Index>> regions;  // by sphere, then piece
  for (Index t = 0; t < binding.sphere_of_triangle.size(); ++t) {
    regions[{binding.sphere_of_triangle[t], pieces.of_triangle[t]}].push_back(t);
  }
  std::vector<Cluster> out;
  for (const auto& [key, region] : regions) {
    const std::uint32_t s = key.first;
    for (std::vector<Index>& triangles : cluster_triangles(character.skin, region, settings)) {
      std::sort(triangles.begin(), triangles.end(), [&](Index a, Index b) {
        return character.skin_source_triangle[a] < character.skin_source_triangle[b];
      });
      Cluster& cluster = out.emplace_back();
      cluster.sphere = s;
      cluster.triangles = std::move(triangles);
    }
  }
  return out;
}

// Numbers the vertices anew, cluster by cluster, so that most vertices of a cluster are neighbours in memory.
void order_vertices(const Character& character, Clusters& out) {
  std::vector<SurfaceVertex> vertices;
  std::vector<Index> number(out.vertices.size(), kNoIndex);
  for (Cluster& cluster : out.clusters) {
    for (const Index t : cluster.triangles) {
      for (const Index v : character.source_triangles[character.skin_source_triangle[t]]) {
        cluster.vertices.push_back(out.vertex_of_source[v]);
      }
    }
    std::sort(cluster.vertices.begin(), cluster.vertices.end());
    cluster.vertices.erase(std::unique(cluster.vertices.begin(), cluster.vertices.end()), cluster.vertices.end());
    for (Index& v : cluster.vertices) {
      if (number[v] == kNoIndex) {
        number[v] = static_cast<Index>(vertices.size());
        vertices.push_back(std::move(out.vertices[v]));
      }
      v = number[v];
    }
    std::sort(cluster.vertices.begin(), cluster.vertices.end());
  }
  for (Index& v : out.vertex_of_source) {
    if (v != kNoIndex) v = number[v];
  }
  std::map<Index, Index> lowest;  // of a vertex of the skin
  for (Index v = 0; v < vertices.size(); ++v) vertices[v].weld = lowest.try_emplace(vertices[v].weld, v).first->second;
  out.vertices = std::move(vertices);
}

std::vector<std::vector<Index>> vertices_of_spheres(std::size_t sphere_count, const std::vector<Cluster>& clusters) {
  std::vector<std::vector<Index>> out(sphere_count);
  for (const Cluster& cluster : clusters) {
    out[cluster.sphere].insert(out[cluster.sphere].end(), cluster.vertices.begin(), cluster.vertices.end());
  }
  return out;
}

}  // namespace

Clusters make_clusters(const Character& character, const Binding& binding, const BoneBinding& bones,
                       const std::vector<VertexWeights>& rig_weights, const ClusterSettings& settings) {
  Clusters out;
  out.clusters = cluster_regions(character, binding, settings);
  out.vertices = surface_vertices(character, bones, rig_weights, out.vertex_of_source);
  order_vertices(character, out);
  for (Cluster& cluster : out.clusters) bound_cluster(character, out.vertices, cluster);
  if (!bones.bones.empty()) {
    out.hulls = make_hulls(character, out.vertices, vertices_of_spheres(binding.spheres.size(), out.clusters));
  }
  return out;
}

}  // namespace spherechain::baker
