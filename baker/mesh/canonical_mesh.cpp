// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/canonical_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

using Key = std::array<double, 3>;

Mesh sorted_by(const Mesh& mesh, const std::vector<Key>& keys) {
  std::vector<Index> order(mesh.positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return keys[a] < keys[b]; });
  Mesh out;
  std::vector<Index> rank(order.size());
  for (Index i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    out.positions.push_back(mesh.positions[order[i]]);
  }
  for (const Triangle& t : mesh.triangles) {
    Triangle r{rank[t[0]], rank[t[1]], rank[t[2]]};
    std::rotate(r.begin(), std::min_element(r.begin(), r.end()), r.end());
    out.triangles.push_back(r);
  }
  std::sort(out.triangles.begin(), out.triangles.end());
  return out;
}

}  // namespace

CanonicalMesh make_canonical(const Mesh& original) {
  // Sums depend on the order of their terms: first an order that depends on positions alone.
  std::vector<Key> keys;
  for (const Vec3& p : original.positions) keys.push_back({p.x(), p.y(), p.z()});
  CanonicalMesh out;
  out.mesh = sorted_by(original, keys);

  const double area = surface_area(out.mesh);
  out.centroid = surface_centroid(out.mesh);
  out.scale = diameter(out.mesh);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) {
    const Vec3 d = (triangle_centroid(out.mesh, t) - out.centroid) / out.scale;
    covariance += triangle_area(out.mesh, t) / area * d * d.transpose();
  }
  out.axes = principal_axes(covariance).vectors;
  // An axis points to where the shape reaches farther out; the last one makes the frame right-handed.
  for (int k = 0; k < 2; ++k) {
    double skew = 0;
    for (std::size_t t = 0; t < out.mesh.triangles.size(); ++t) {
      skew += triangle_area(out.mesh, t) *
              std::pow((triangle_centroid(out.mesh, t) - out.centroid).dot(out.axes.col(k)), 3);
    }
    if (skew < 0) out.axes.col(k) = -out.axes.col(k);
  }
  if (out.axes.determinant() < 0) out.axes.col(2) = -out.axes.col(2);

  keys.clear();
  for (Vec3& p : out.mesh.positions) {
    p = out.axes.transpose() * (p - out.centroid) / out.scale;
    // Coarser than the noise of single precision positions, so that a turned mesh sorts alike.
    constexpr double kGrid = 1e-5;
    keys.push_back({std::round(p.x() / kGrid), std::round(p.y() / kGrid), std::round(p.z() / kGrid)});
  }
  out.mesh = sorted_by(out.mesh, keys);
  return out;
}

}  // namespace spherechain::baker
