// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/part_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {

Extent extent_of(const Mesh& mesh, const std::vector<Index>& triangles) {
  Extent extent;
  double area = 0;
  for (const Index t : triangles) {
    extent.centroid += triangle_area(mesh, t) * triangle_centroid(mesh, t);
    area += triangle_area(mesh, t);
  }
  extent.centroid /= area;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Index t : triangles) {
    for (const Index v : mesh.triangles[t]) {
      const Vec3 d = mesh.positions[v] - extent.centroid;
      covariance += triangle_area(mesh, t) / (3 * area) * d * d.transpose();
    }
  }
  const PrincipalAxes axes = principal_axes(covariance);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto column = static_cast<Eigen::Index>(2 - i);
    extent.axis[i] = axes.vectors.col(column);
    extent.spread[i] = std::sqrt(std::max(0.0, axes.values[column]));
  }
  return extent;
}

double area_of(const Mesh& mesh, const std::vector<Index>& triangles) {
  double area = 0;
  for (const Index t : triangles) area += triangle_area(mesh, t);
  return area;
}

double distance_of(const Mesh& mesh, const std::vector<Index>& a, const std::vector<Index>& b) {
  constexpr std::size_t kSamples = 100;
  const auto step = [](const std::vector<Index>& part) { return std::max<std::size_t>(1, part.size() / kSamples); };
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < a.size(); i += step(a)) {
    const Vec3 p = triangle_centroid(mesh, a[i]);
    for (std::size_t j = 0; j < b.size(); j += step(b)) {
      least = std::min(least, (p - triangle_centroid(mesh, b[j])).squaredNorm());
    }
  }
  return least;
}

std::vector<int> heaviest_nodes(const Character& character) {
  const SourceRig& rig = character.rig;
  std::vector<int> nodes;
  for (const Index source : character.skin_source_triangle) {
    std::map<int, double> sum;
    for (const Index corner : character.source_triangles[source]) {
      if (rig.weights.empty()) break;
      const VertexWeights& weights = rig.weights[corner];
      for (std::size_t k = 0; k < kMaxInfluences; ++k) {
        if (weights.weight[k] > 0) sum[static_cast<int>(rig.bones[weights.joint[k]].node)] += weights.weight[k];
      }
    }
    const auto most =
        std::max_element(sum.begin(), sum.end(), [](const auto& l, const auto& r) { return l.second < r.second; });
    nodes.push_back(most == sum.end() ? Part::kNone : most->first);
  }
  return nodes;
}

namespace {

constexpr int kNone = Part::kNone;

// Pieces of triangles that no bone moves, halved across the longest until there are enough.
std::vector<std::vector<Index>> cut_in_pieces(const Mesh& mesh, std::vector<Index> triangles, std::size_t count) {
  constexpr std::size_t kFewest = 8;  // triangles of what is still cut
  std::vector<std::vector<Index>> pieces{std::move(triangles)};
  std::vector<Extent> extents{extent_of(mesh, pieces[0])};
  while (pieces.size() < count) {
    std::size_t longest = pieces.size();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (pieces[i].size() < kFewest) continue;
      if (longest == pieces.size() || extents[i].spread[0] > extents[longest].spread[0]) longest = i;
    }
    if (longest == pieces.size()) break;
    const Extent cut = extents[longest];
    const auto above = [&](Index t) { return (triangle_centroid(mesh, t) - cut.centroid).dot(cut.axis[0]) > 0; };
    const auto middle = std::stable_partition(pieces[longest].begin(), pieces[longest].end(), above);
    std::vector<Index> below(middle, pieces[longest].end());
    if (below.empty() || below.size() == pieces[longest].size()) break;
    pieces[longest].erase(middle, pieces[longest].end());
    extents[longest] = extent_of(mesh, pieces[longest]);
    extents.push_back(extent_of(mesh, below));
    pieces.push_back(std::move(below));
  }
  return pieces;
}

class PartTree {
 public:
  PartTree(const Character& character, const std::vector<bool>& left_out, double least_area)
      : mesh_(character.skin), least_area_(least_area) {
    std::map<int, std::vector<Index>> of_node;
    const std::vector<int> nodes = heaviest_nodes(character);
    for (Index t = 0; t < nodes.size(); ++t) {
      if (left_out.empty() || !left_out[t]) of_node[nodes[t]].push_back(t);
    }
    std::vector<Index> unmoved = std::move(of_node[kNone]);
    of_node.erase(kNone);

    const std::vector<Node>& rig = character.rig.nodes;
    // For each node, finds the nearest ancestor that has a part.
    const auto find_above = [&] {
      std::vector<int> out(rig.size(), kNone);
      for (std::size_t n = 0; n < rig.size(); ++n) {
        const int parent = rig[n].parent;
        if (parent >= 0) out[n] = of_node.count(parent) > 0 ? parent : out[static_cast<std::size_t>(parent)];
      }
      return out;
    };
    std::vector<int> above = find_above();
    // Parents come before their children: from the last on, each small part is complete when it joins.
    for (int node = static_cast<int>(rig.size()) - 1; node >= 0; --node) {
      const auto part = of_node.find(node);
      if (part == of_node.end() || area_of(mesh_, part->second) >= least_area_) continue;
      const int parent = above[static_cast<std::size_t>(node)];
      if (parent == kNone) continue;
      std::vector<Index>& joined = of_node[parent];
      joined.insert(joined.end(), part->second.begin(), part->second.end());
      of_node.erase(part);
    }
    above = find_above();
    std::map<int, int> part_of_node;
    for (auto& [node, triangles] : of_node) {
      const int parent = above[static_cast<std::size_t>(node)];
      part_of_node[node] = static_cast<int>(parts_.size());
      std::sort(triangles.begin(), triangles.end());
      parts_.push_back({node, std::move(triangles), parent == kNone ? kNone : part_of_node[parent]});
    }
    add_unmoved(std::move(unmoved));
    join_roots();
  }

  // The root is the last.
  std::vector<Part> take() {
    std::vector<int> order;
    for (int i = 0; i < count(); ++i) {
      if (at(i).parent != kNone) order.push_back(i);
    }
    for (int i = 0; i < count(); ++i) {
      if (at(i).parent == kNone) order.push_back(i);
    }
    std::vector<int> place(parts_.size());
    for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
    std::vector<Part> sorted;
    for (const int i : order) {
      sorted.push_back(std::move(at(i)));
      int& parent = sorted.back().parent;
      parent = parent == kNone ? count() - 1 : place[static_cast<std::size_t>(parent)];
    }
    return sorted;
  }

 private:
  int count() const { return static_cast<int>(parts_.size()); }
  Part& at(int i) { return parts_[static_cast<std::size_t>(i)]; }
  double area(int i) { return area_of(mesh_, at(i).triangles); }

  void add_unmoved(std::vector<Index> triangles) {
    constexpr std::size_t kPieces = 16;
    if (triangles.empty()) return;
    if (!parts_.empty() && area_of(mesh_, triangles) < least_area_) {
      parts_.push_back({kNone, std::move(triangles), kNone});  // join_roots() finds it a place
      return;
    }
    for (std::vector<Index>& piece : cut_in_pieces(mesh_, std::move(triangles), kPieces)) {
      parts_.push_back({kNone, std::move(piece), kNone});
    }
  }

  bool hangs_on(int part, int other) {
    for (; part != kNone; part = at(part).parent) {
      if (part == other) return true;
    }
    return false;
  }

  // The part nearest to a root, of another tree.
  int nearest_to(int root) {
    int nearest = kNone;
    double least = std::numeric_limits<double>::max();
    for (int i = 0; i < count(); ++i) {
      if (hangs_on(i, root)) continue;
      const double distance = distance_of(mesh_, at(root).triangles, at(i).triangles);
      if (distance >= least) continue;
      least = distance;
      nearest = i;
    }
    return nearest;
  }

  // One tree: the root of most area stays, every other one hangs on the part next to it; a small one joins that.
  void join_roots() {
    int main = kNone;
    double most = 0;
    for (int root = 0; root < count(); ++root) {
      if (at(root).parent != kNone) continue;
      double sum = 0;
      for (int i = 0; i < count(); ++i) sum += hangs_on(i, root) ? area(i) : 0;
      if (sum > most) {
        most = sum;
        main = root;
      }
    }
    std::vector<bool> gone(parts_.size(), false);
    for (int root = 0; root < count(); ++root) {
      if (at(root).parent != kNone || root == main) continue;
      at(root).parent = nearest_to(root);
      if (area(root) < least_area_) gone[static_cast<std::size_t>(root)] = true;
    }
    for (int i = 0; i < count(); ++i) {
      if (!gone[static_cast<std::size_t>(i)]) continue;
      Part& into = at(at(i).parent);
      into.triangles.insert(into.triangles.end(), at(i).triangles.begin(), at(i).triangles.end());
      std::sort(into.triangles.begin(), into.triangles.end());
      at(i).triangles.clear();
      for (Part& part : parts_) {
        if (part.parent == i) part.parent = at(i).parent;
      }
    }
    std::vector<int> place;
    std::vector<Part> kept;
    for (int i = 0; i < count(); ++i) {
      place.push_back(static_cast<int>(kept.size()));
      if (!gone[static_cast<std::size_t>(i)]) kept.push_back(std::move(at(i)));
    }
    for (Part& part : kept) {
      if (part.parent != kNone) part.parent = place[static_cast<std::size_t>(part.parent)];
    }
    parts_ = std::move(kept);
  }

  const Mesh& mesh_;
  double least_area_;
  std::vector<Part> parts_;
};

}  // namespace

std::vector<Part> build_part_tree(const Character& character, std::size_t spheres, const std::vector<bool>& left_out) {
  constexpr double kShare = 0.3;       // of a sphere's even share of the area
  constexpr double kSmallest = 0.005;  // of the area: regions are numbered in a byte
  const double area = surface_area(character.skin);
  for (double share = std::max(kShare / static_cast<double>(spheres), kSmallest);; share *= 1.25) {
    std::vector<Part> parts = PartTree(character, left_out, share * area).take();
    if (parts.size() <= spheres || parts.size() == 1) return parts;
  }
}

}  // namespace spherechain::baker
