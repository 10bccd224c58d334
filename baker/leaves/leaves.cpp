// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaves/leaves.h"

#include <algorithm>
#include <map>

namespace spherechain::baker {
namespace {

std::vector<Leaf> cluster_regions(const Character& character, const Binding& binding, const LeafSettings& settings) {
  std::vector<std::vector<Index>> regions(binding.spheres.size());
  for (Index t = 0; t < binding.sphere_of_triangle.size(); ++t) regions[binding.sphere_of_triangle[t]].push_back(t);
  std::vector<Leaf> out;
  for (std::uint32_t s = 0; s < regions.size(); ++s) {
    for (std::vector<Index>& cluster : cluster_triangles(character.skin, regions[s], settings)) {
      std::sort(cluster.begin(), cluster.end(), [&](Index a, Index b) {
        return character.skin_source_triangle[a] < character.skin_source_triangle[b];
      });
      Leaf& leaf = out.emplace_back();
      leaf.sphere = s;
      leaf.triangles = std::move(cluster);
    }
  }
  return out;
}

// Numbers the vertices anew, leaf by leaf: most of a leaf's are one after another in memory then.
void order_vertices(const Character& character, Leaves& out) {
  std::vector<SurfaceVertex> vertices;
  std::vector<Index> number(out.vertices.size(), kNoIndex);
  for (Leaf& leaf : out.leaves) {
    for (const Index t : leaf.triangles) {
      for (const Index v : character.source_triangles[character.skin_source_triangle[t]]) {
        leaf.vertices.push_back(out.vertex_of_source[v]);
      }
    }
    std::sort(leaf.vertices.begin(), leaf.vertices.end());
    leaf.vertices.erase(std::unique(leaf.vertices.begin(), leaf.vertices.end()), leaf.vertices.end());
    for (Index& v : leaf.vertices) {
      if (number[v] == kNoIndex) {
        number[v] = static_cast<Index>(vertices.size());
        vertices.push_back(std::move(out.vertices[v]));
      }
      v = number[v];
    }
    std::sort(leaf.vertices.begin(), leaf.vertices.end());
  }
  for (Index& v : out.vertex_of_source) {
    if (v != kNoIndex) v = number[v];
  }
  std::map<Index, Index> lowest;  // of a vertex of the skin
  for (Index v = 0; v < vertices.size(); ++v) vertices[v].weld = lowest.try_emplace(vertices[v].weld, v).first->second;
  out.vertices = std::move(vertices);
}

std::vector<std::vector<Index>> vertices_of_spheres(std::size_t sphere_count, const std::vector<Leaf>& leaves) {
  std::vector<std::vector<Index>> out(sphere_count);
  for (const Leaf& leaf : leaves) {
    out[leaf.sphere].insert(out[leaf.sphere].end(), leaf.vertices.begin(), leaf.vertices.end());
  }
  return out;
}

}  // namespace

Leaves make_leaves(const Character& character, const Binding& binding, const BoneBinding& bones,
                   const std::vector<VertexWeights>& rig_weights, const LeafSettings& settings) {
  Leaves out;
  out.leaves = cluster_regions(character, binding, settings);
  out.vertices = surface_vertices(character, bones, rig_weights, out.vertex_of_source);
  order_vertices(character, out);
  for (Leaf& leaf : out.leaves) bound_leaf(character, out.vertices, leaf);
  if (!bones.bones.empty()) {
    out.outlines = outline_spheres(character, out.vertices, vertices_of_spheres(binding.spheres.size(), out.leaves));
  }
  return out;
}

}  // namespace spherechain::baker
