// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/by_bones.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "roles/skeleton.h"

namespace spherechain::baker {
namespace {

constexpr int kNone = -1;

// Triangles of the skin that move as one.
struct Part {
  int node = kNone;  // of the rig; none where nothing moves them
  std::vector<Index> triangles;
  int parent = kNone;  // another part
};

// The node of the rig that moves each triangle of the skin most.
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
    nodes.push_back(most == sum.end() ? kNone : most->first);
  }
  return nodes;
}

// Where the area of triangles lies: its centroid, and how far it spreads along its principal axes, the longest first.
struct Extent {
  Vec3 centroid = Vec3::Zero();
  std::array<Vec3, 3> axis;
  std::array<double, 3> spread;  // standard deviations
};

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
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto column = static_cast<Eigen::Index>(2 - i);
    extent.axis[i] = solver.eigenvectors().col(column);
    extent.spread[i] = std::sqrt(std::max(0.0, solver.eigenvalues()[column]));
  }
  return extent;
}

double area_of(const Mesh& mesh, const std::vector<Index>& triangles) {
  double area = 0;
  for (const Index t : triangles) area += triangle_area(mesh, t);
  return area;
}

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

double distance_of(const Mesh& mesh, const Part& a, const Part& b) {
  constexpr std::size_t kSamples = 100;
  const auto step = [](const Part& part) { return std::max<std::size_t>(1, part.triangles.size() / kSamples); };
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < a.triangles.size(); i += step(a)) {
    const Vec3 p = triangle_centroid(mesh, a.triangles[i]);
    for (std::size_t j = 0; j < b.triangles.size(); j += step(b)) {
      least = std::min(least, (p - triangle_centroid(mesh, b.triangles[j])).squaredNorm());
    }
  }
  return least;
}

class PartTree {
 public:
  PartTree(const Character& character, double least_area) : mesh_(character.skin), least_area_(least_area) {
    std::map<int, std::vector<Index>> of_node;
    const std::vector<int> nodes = heaviest_nodes(character);
    for (Index t = 0; t < nodes.size(); ++t) of_node[nodes[t]].push_back(t);
    std::vector<Index> unmoved = std::move(of_node[kNone]);
    of_node.erase(kNone);

    const std::vector<Node>& rig = character.rig.nodes;
    const auto above = [&](int node) {
      do node = rig[static_cast<std::size_t>(node)].parent;
      while (node != kNone && of_node.count(node) == 0);
      return node;
    };
    // Parents come before their children: from the last on, each small part is complete when it joins.
    for (int node = static_cast<int>(rig.size()) - 1; node >= 0; --node) {
      const auto part = of_node.find(node);
      if (part == of_node.end() || area_of(mesh_, part->second) >= least_area_) continue;
      const int parent = above(node);
      if (parent == kNone) continue;
      std::vector<Index>& joined = of_node[parent];
      joined.insert(joined.end(), part->second.begin(), part->second.end());
      of_node.erase(part);
    }
    std::map<int, int> part_of_node;
    for (auto& [node, triangles] : of_node) {
      const int parent = above(node);
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
      const double distance = distance_of(mesh_, at(root), at(i));
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

std::vector<Part> parts_of(const Character& character, std::size_t spheres) {
  constexpr double kShare = 0.3;       // of a sphere's even share of the area
  constexpr double kSmallest = 0.005;  // of the area: regions are numbered in a byte
  const double area = surface_area(character.skin);
  for (double share = std::max(kShare / static_cast<double>(spheres), kSmallest);; share *= 1.25) {
    std::vector<Part> parts = PartTree(character, share * area).take();
    if (parts.size() <= spheres || parts.size() == 1) return parts;
  }
}

// From the joint towards the one below it where the skin goes on longest, or the skin's own axis where it is much
// longer that way.
Vec3 axis_of(const Part& part, const Skeleton& skeleton, const Extent& extent, const Mesh& mesh) {
  constexpr double kMuchLonger = 1.8;
  if (part.node == kNone) return extent.axis[0];
  const Vec3& joint = skeleton.position[static_cast<std::size_t>(part.node)];
  Vec3 along = extent.centroid - joint;
  double farthest = 0;
  for (const int child : skeleton.children[static_cast<std::size_t>(part.node)]) {
    const auto c = static_cast<std::size_t>(child);
    const double reach = skeleton.bone(child) + skeleton.reach[c];
    if (!skeleton.alive[c] || reach <= farthest) continue;
    farthest = reach;
    along = skeleton.position[c] - joint;
  }
  const Vec3 principal = extent.axis[0].dot(along) < 0 ? Vec3(-extent.axis[0]) : extent.axis[0];
  if (!(along.norm() > 1e-6 * extent.spread[0])) return principal;
  along.normalize();
  double squares = 0, area = 0;
  for (const Index t : part.triangles) {
    for (const Index v : mesh.triangles[t]) {
      const double d = (mesh.positions[v] - extent.centroid).dot(along);
      squares += triangle_area(mesh, t) * d * d / 3;
    }
    area += triangle_area(mesh, t);
  }
  return extent.spread[0] > kMuchLonger * std::sqrt(squares / area) ? principal : along;
}

Polyline line_of(const Mesh& mesh, const Part& part, const Vec3& center, const Vec3& axis) {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const Index t : part.triangles) {
    for (const Index v : mesh.triangles[t]) {
      const double s = (mesh.positions[v] - center).dot(axis);
      low = std::min(low, s);
      high = std::max(high, s);
    }
  }
  return Polyline({center + low * axis, center + high * axis});
}

Side side_of(const Part& part, const Roles& roles) {
  if (part.node == kNone || roles.of_node.empty()) return Side::kNone;
  const NodeRole& role = roles.of_node[static_cast<std::size_t>(part.node)];
  const std::string& limb = role.limb < 0 ? role.role : roles.limbs[static_cast<std::size_t>(role.limb)].name;
  if (limb.starts_with("left_")) return Side::kLeft;
  return limb.starts_with("right_") ? Side::kRight : Side::kNone;
}

std::string name_of(const Part& part, const SourceRig& rig, std::set<std::string>& taken) {
  const std::string wish = part.node == kNone ? "part" : rig.nodes[static_cast<std::size_t>(part.node)].name;
  std::string name = wish.empty() ? "part" : wish;
  for (int i = 2; !taken.insert(name).second; ++i) name = (wish.empty() ? "part" : wish) + "_" + std::to_string(i);
  return name;
}

// The way up in the file's scene. A biped that lies there stands as its rig does: along the axis of the file that is
// next to the way from its pelvis to its head.
Vec3 up_of(const Character& character, const Roles& roles) {
  constexpr double kUpright = 0.5;
  const Vec3 up = character.up_hint.normalized();
  if (roles.kind != BodyKind::kBiped || roles.trunk.empty() || roles.neck_head.empty()) return up;
  const std::vector<Vec3> rest = rest_positions(character.rig);
  const Vec3 trunk =
      rest[static_cast<std::size_t>(roles.neck_head.back())] - rest[static_cast<std::size_t>(roles.trunk.front())];
  if (!(trunk.norm() > 0) || trunk.normalized().dot(up) > kUpright) return up;
  Eigen::Index axis = 0;
  trunk.cwiseAbs().maxCoeff(&axis);
  return trunk[axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
}

BodyFrame frame_of(const Character& character, const std::vector<Part>& parts, const Roles& roles,
                   std::string& facing) {
  Vec3 left = Vec3::Zero();
  for (const Part& part : parts) {
    const Side side = side_of(part, roles);
    if (side == Side::kNone) continue;
    const Vec3 from = extent_of(character.skin, part.triangles).centroid - surface_centroid(character.skin);
    left += area_of(character.skin, part.triangles) * (side == Side::kLeft ? from : Vec3(-from));
  }
  const Vec3 up = up_of(character, roles);
  left -= left.dot(up) * up;
  facing = "forward is as the rig's left and right have it";
  if (!(left.norm() > 1e-6 * surface_area(character.skin) * diameter(character.skin))) {
    facing = "forward is as the file's axes have it";
    left = std::abs(up.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    left -= left.dot(up) * up;
  }
  left.normalize();
  BodyFrame frame = with_up({Vec3::Zero(), left, up, left.cross(up), 0}, up, character.skin);
  for (const Vec3& axis : {frame.left, frame.forward}) {
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
    for (const Vec3& p : character.skin.positions) {
      low = std::min(low, p.dot(axis));
      high = std::max(high, p.dot(axis));
    }
    frame.height = std::max(frame.height, high - low);
  }
  return frame;
}

}  // namespace

Regions segment_by_bones(Character& character, const Roles& roles, std::size_t spheres) {
  take_all_pieces(character);
  const std::vector<Part> parts = parts_of(character, spheres);
  const Skeleton skeleton = make_skeleton(character.rig, character.source_positions);
  Regions regions;
  regions.provider = "bones";
  regions.frame = frame_of(character, parts, roles, regions.facing);
  regions.of_skin.resize(character.skin.triangles.size());
  std::set<std::string> taken;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    for (const Index t : part.triangles) regions.of_skin[t] = static_cast<std::uint8_t>(i);
    regions.parents.push_back(static_cast<std::uint8_t>(part.parent));
    const Extent extent = extent_of(character.skin, part.triangles);
    const Polyline line =
        line_of(character.skin, part, extent.centroid, axis_of(part, skeleton, extent, character.skin));
    const std::string name = name_of(part, character.rig, taken);
    if (i + 1 < parts.size()) {
      regions.limbs.push_back({name, side_of(part, roles), 0, line, line.length()});
      continue;
    }
    regions.torso_name = name;
    regions.spine = line;
    regions.hip = line.at(0);
    regions.chest = line.at(line.length());
    regions.spine_chest = regions.spine_neck = line.length();
    regions.torso = {0, regions.frame.height};
  }
  regions.of_triangle = regions.of_skin;
  return regions;
}

}  // namespace spherechain::baker
