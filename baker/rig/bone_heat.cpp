// SPDX-License-Identifier: GPL-3.0-or-later
// Automatic Rigging and Animation of 3D Characters (Baran and Popovic 2007), section 4: every bone in turn is hot, the
// others are cold; a vertex takes heat from the bone it sees and from its neighbours. The equilibrium is its weight.
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "baker/mesh/surface_query.h"
#include "baker/rig/rig.h"

namespace spherechain::baker {
namespace {

constexpr double kHeat = 3.0;        // c in H = c / d^2
constexpr double kWeightMin = 1e-3;  // lighter weights are dropped: what is far does not move at all
constexpr double kTie = 1e-6;        // relative difference of distances that is none
constexpr double kUnseen = 1e-3;     // pull on a vertex that sees no bone: its neighbours know better
constexpr double kDistanceRatioMax =
    2.0;                           // a bone in sight but that much farther than the nearest is not the vertex's own
constexpr double kInside = 1e-4;   // of the diameter: how far a line of sight starts below the skin
constexpr double kGiveWay = 0.25;  // of the lead that the strongest joint on another branch has is taken off a weight

struct Bone {
  Vec3 from, to;
  Index joint;
};

// Each joint's bone, and what joins it to children that do not sit at its tail (pelvis to hips, chest to clavicles).
std::vector<Bone> bones_of(const std::vector<Joint>& joints) {
  std::vector<Bone> bones;
  for (Index j = 0; j < joints.size(); ++j) bones.push_back({joints[j].position, joints[j].tail, j});
  for (const Joint& child : joints) {
    if (child.parent < 0) continue;
    const auto parent = static_cast<Index>(child.parent);
    if (child.position != joints[parent].tail) bones.push_back({joints[parent].position, child.position, parent});
  }
  return bones;
}

Vec3 closest_on(const Bone& bone, const Vec3& p) {
  const Vec3 d = bone.to - bone.from;
  const double length = d.squaredNorm();
  return length > 0 ? Vec3(bone.from + std::clamp((p - bone.from).dot(d) / length, 0.0, 1.0) * d) : bone.from;
}

std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const Index v : mesh.triangles[t]) normals[v] += triangle_cross(mesh, t);
  }
  for (Vec3& n : normals) n.normalize();
  return normals;
}

// A heat source of a vertex: the strength H, and the joints that share it.
struct Source {
  double heat;
  std::vector<Index> joints;
};

std::vector<Source> find_sources(const Mesh& mesh, const std::vector<Bone>& bones) {
  const SurfaceQuery surface(mesh);
  const std::vector<Vec3> normals = vertex_normals(mesh);
  const double size = diameter(mesh);
  std::vector<Source> sources;
  sources.reserve(mesh.positions.size());
  struct Candidate {
    double distance;
    Vec3 point;
    Index joint;
  };
  std::vector<Candidate> candidates(bones.size());
  for (Index v = 0; v < mesh.positions.size(); ++v) {
    const Vec3& p = mesh.positions[v];
    for (std::size_t b = 0; b < bones.size(); ++b) {
      const Vec3 q = closest_on(bones[b], p);
      candidates[b] = {(q - p).norm(), q, bones[b].joint};
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
    const Vec3 inside = p - kInside * size * normals[v];
    const double nearest = candidates.front().distance;
    const auto seen = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& c) {
      return c.distance > kDistanceRatioMax * nearest || !surface.crosses(inside, c.point);
    });
    const bool sees = seen != candidates.end() && seen->distance <= kDistanceRatioMax * nearest;
    const double distance = std::max(sees ? seen->distance : nearest, kInside * size);
    Source source{(sees ? 1.0 : kUnseen) * kHeat / (distance * distance), {}};
    for (const Candidate& c : candidates) {
      if (std::abs(c.distance - distance) > kTie * distance) continue;
      if (std::find(source.joints.begin(), source.joints.end(), c.joint) == source.joints.end()) {
        source.joints.push_back(c.joint);
      }
    }
    if (source.joints.empty()) source.joints.push_back(candidates.front().joint);
    sources.push_back(std::move(source));
  }
  return sources;
}

struct HeatSystem {
  Eigen::SparseMatrix<double> matrix;  // cotangent Laplacian + area * H
  Eigen::MatrixXd heat;                // area * H * p, a column a joint
};

HeatSystem build_system(const Mesh& mesh, const std::vector<Source>& sources, std::size_t joints) {
  const std::size_t n = mesh.positions.size();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(mesh.triangles.size() * 12 + n);
  std::vector<double> area(n, 0.0);
  double whole = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& v = mesh.triangles[t];
    const double twice = std::max(triangle_cross(mesh, t).norm(), 1e-300);
    whole += 0.5 * twice;
    for (std::size_t k = 0; k < 3; ++k) {
      const Index a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
      area[a] += twice / 6;
      // Obtuse angles would make some couplings negative, and with them weights.
      const double cotangent =
          (mesh.positions[a] - mesh.positions[c]).dot(mesh.positions[b] - mesh.positions[c]) / twice;
      const double w = 0.5 * std::max(cotangent, 0.0);
      const auto i = static_cast<int>(a), j = static_cast<int>(b);
      entries.emplace_back(i, j, -w);
      entries.emplace_back(j, i, -w);
      entries.emplace_back(i, i, w);
      entries.emplace_back(j, j, w);
    }
  }
  const double least = 1e-9 * whole / static_cast<double>(n);
  HeatSystem system;
  system.heat = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(joints));
  for (std::size_t v = 0; v < n; ++v) {
    const double pull = std::max(area[v], least) * sources[v].heat;
    const auto i = static_cast<Eigen::Index>(v);
    entries.emplace_back(static_cast<int>(v), static_cast<int>(v), pull);
    for (const Index j : sources[v].joints) system.heat(i, j) = pull / static_cast<double>(sources[v].joints.size());
  }
  system.matrix.resize(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  return system;
}

// Whether one joint hangs on the other: hip and knee do, the two hips do not.
std::vector<std::vector<bool>> same_branch(const std::vector<Joint>& joints) {
  std::vector<std::vector<bool>> same(joints.size(), std::vector<bool>(joints.size(), false));
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (int up = static_cast<int>(j); up >= 0; up = joints[static_cast<std::size_t>(up)].parent) {
      same[j][static_cast<std::size_t>(up)] = same[static_cast<std::size_t>(up)][j] = true;
    }
  }
  return same;
}

// Heat seeps through the crotch from one thigh into the other. Where a branch is strong the others give way, and do so
// gradually: a sudden end would crease the skin.
Eigen::RowVectorXd give_way(const Eigen::RowVectorXd& row, const std::vector<std::vector<bool>>& same) {
  Eigen::RowVectorXd out = row;
  for (Eigen::Index i = 0; i < row.size(); ++i) {
    double other = 0;
    for (Eigen::Index j = 0; j < row.size(); ++j) {
      if (!same[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]) other = std::max(other, row[j]);
    }
    if (other > row[i]) out[i] = std::max(0.0, row[i] - kGiveWay * (other - row[i]));
  }
  return out;
}

// The four largest, without traces, as a partition of one. The fifth is taken off each, so that a joint is at zero
// where it changes places with another: a cut would crease the skin.
VertexWeights largest_four(const Eigen::RowVectorXd& row) {
  std::vector<Index> order;
  for (Index j = 0; j < row.size(); ++j) {
    if (row[j] > kWeightMin) order.push_back(j);
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return row[a] > row[b]; });
  const double fifth = order.size() > 4 && row[order[0]] > row[order[4]] ? row[order[4]] : 0.0;
  VertexWeights weights;
  double sum = 0;
  for (std::size_t k = 0; k < std::min<std::size_t>(order.size(), 4); ++k) sum += row[order[k]] - fifth;
  for (std::size_t k = 0; k < std::min<std::size_t>(order.size(), 4) && row[order[k]] > fifth; ++k) {
    weights.joint[k] = order[k];
    weights.weight[k] = (row[order[k]] - fifth) / sum;
  }
  return weights;
}

}  // namespace

std::vector<VertexWeights> bone_heat_weights(const Mesh& mesh, const std::vector<Joint>& joints) {
  const HeatSystem system = build_system(mesh, find_sources(mesh, bones_of(joints)), joints.size());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system.matrix);
  const std::vector<std::vector<bool>> same = same_branch(joints);
  const Eigen::MatrixXd solution = solver.solve(system.heat);
  std::vector<VertexWeights> weights;
  weights.reserve(mesh.positions.size());
  for (Eigen::Index v = 0; v < solution.rows(); ++v) weights.push_back(largest_four(give_way(solution.row(v), same)));
  return weights;
}

}  // namespace spherechain::baker
