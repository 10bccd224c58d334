// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <tuple>

#include "baker/clusters/clusters.h"
#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

struct Item {
  Index triangle;
  Vec3 centroid;
  double along = 0;
};

// The direction the centroids are spread out most in: it turns with the mesh, as a coordinate axis would not.
Vec3 main_axis(const Item* items, std::size_t count) {
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) mean += items[i].centroid / static_cast<double>(count);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    spread += (items[i].centroid - mean) * (items[i].centroid - mean).transpose();
  }
  return principal_axes(spread).vectors.col(2);
}

void split(Item* items, std::size_t count, std::size_t clusters, std::vector<std::vector<Index>>& out) {
  if (clusters == 1) {
    std::vector<Index>& cluster = out.emplace_back();
    for (std::size_t i = 0; i < count; ++i) cluster.push_back(items[i].triangle);
    std::sort(cluster.begin(), cluster.end());
    return;
  }
  const Vec3 axis = main_axis(items, count);
  for (std::size_t i = 0; i < count; ++i) items[i].along = axis.dot(items[i].centroid);
  const std::size_t first_clusters = clusters / 2, first_count = count * first_clusters / clusters;
  std::sort(items, items + count,
            [](const Item& a, const Item& b) { return std::tie(a.along, a.triangle) < std::tie(b.along, b.triangle); });
  split(items, first_count, first_clusters, out);
  split(items + first_count, count - first_count, clusters - first_clusters, out);
}

std::size_t count_clusters(std::size_t triangles, const ClusterSettings& settings) {
  const auto most = static_cast<std::size_t>(settings.triangles);
  const std::size_t fewest = (triangles + most - 1) / most;
  if (settings.branching == 0) return fewest;
  std::size_t count = 1;
  while (count < fewest) count *= static_cast<std::size_t>(settings.branching);
  return std::min(count, triangles);
}

}  // namespace

std::vector<std::vector<Index>> cluster_triangles(const Mesh& mesh, const std::vector<Index>& triangles,
                                                  const ClusterSettings& settings) {
  std::vector<Item> items;
  for (const Index t : triangles) items.push_back({t, triangle_centroid(mesh, t)});
  std::vector<std::vector<Index>> out;
  if (!items.empty()) split(items.data(), items.size(), count_clusters(items.size(), settings), out);
  return out;
}

}  // namespace spherechain::baker
