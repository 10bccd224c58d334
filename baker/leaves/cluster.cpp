// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <tuple>

#include "leaves/leaves.h"

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
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
}

void split(Item* items, std::size_t count, std::size_t leaves, std::vector<std::vector<Index>>& out) {
  if (leaves == 1) {
    std::vector<Index>& leaf = out.emplace_back();
    for (std::size_t i = 0; i < count; ++i) leaf.push_back(items[i].triangle);
    std::sort(leaf.begin(), leaf.end());
    return;
  }
  const Vec3 axis = main_axis(items, count);
  for (std::size_t i = 0; i < count; ++i) items[i].along = axis.dot(items[i].centroid);
  const std::size_t first_leaves = leaves / 2, first_count = count * first_leaves / leaves;
  std::sort(items, items + count,
            [](const Item& a, const Item& b) { return std::tie(a.along, a.triangle) < std::tie(b.along, b.triangle); });
  split(items, first_count, first_leaves, out);
  split(items + first_count, count - first_count, leaves - first_leaves, out);
}

std::size_t count_leaves(std::size_t triangles, const LeafSettings& settings) {
  const auto most = static_cast<std::size_t>(settings.triangles);
  const std::size_t fewest = (triangles + most - 1) / most;
  if (settings.branching == 0) return fewest;
  std::size_t count = 1;
  while (count < fewest) count *= static_cast<std::size_t>(settings.branching);
  return std::min(count, triangles);
}

}  // namespace

std::vector<std::vector<Index>> cluster_triangles(const Mesh& mesh, const std::vector<Index>& triangles,
                                                  const LeafSettings& settings) {
  std::vector<Item> items;
  for (const Index t : triangles) items.push_back({t, triangle_centroid(mesh, t)});
  std::vector<std::vector<Index>> out;
  if (!items.empty()) split(items.data(), items.size(), count_leaves(items.size(), settings), out);
  return out;
}

}  // namespace spherechain::baker
