// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/neighbours.h"

#include <algorithm>
#include <array>
#include <limits>
#include <queue>

namespace spherechain::baker {
namespace {

void add_touching(const Mesh& mesh, const std::vector<std::uint32_t>& owner, SpherePairs& pairs) {
  const std::vector<std::array<Index, 3>> neighbours = triangle_neighbours(mesh);
  for (std::size_t t = 0; t < neighbours.size(); ++t) {
    for (const Index n : neighbours[t]) {
      if (n != kNoIndex && owner[t] != owner[n]) pairs.insert(std::minmax(owner[t], owner[n]));
    }
  }
}

// Shortest ways along edges, grown from one region after another and no farther than the gap.
class EdgeGraph {
 public:
  EdgeGraph(const Mesh& mesh, const std::vector<std::uint32_t>& owner)
      : mesh_(mesh), owner_(owner), triangles_of_(mesh.positions.size()), way_(mesh.positions.size(), kFar) {
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      for (const Index v : mesh.triangles[t]) triangles_of_[v].push_back(t);
    }
  }

  void add_within(std::uint32_t sphere, const std::vector<Index>& region, double gap, SpherePairs& pairs) {
    using Step = std::pair<double, Index>;
    std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
    std::vector<Index> touched;
    const auto reach = [&](Index v, double way) {
      if (way >= way_[v]) return;
      if (way_[v] == kFar) touched.push_back(v);
      way_[v] = way;
      open.emplace(way, v);
    };
    for (const Index t : region) {
      for (const Index v : mesh_.triangles[t]) reach(v, 0);
    }
    while (!open.empty()) {
      const auto [way, v] = open.top();
      open.pop();
      if (way > way_[v]) continue;
      for (const Index t : triangles_of_[v]) {
        if (owner_[t] != sphere) pairs.insert(std::minmax(sphere, owner_[t]));
        for (const Index next : mesh_.triangles[t]) {
          const double on = way + (mesh_.positions[next] - mesh_.positions[v]).norm();
          if (on < gap) reach(next, on);
        }
      }
    }
    for (const Index v : touched) way_[v] = kFar;
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::max();

  const Mesh& mesh_;
  const std::vector<std::uint32_t>& owner_;
  std::vector<std::vector<Index>> triangles_of_;
  std::vector<double> way_;
};

}  // namespace

void add_neighbours(const Mesh& mesh, const std::vector<std::uint32_t>& owner, double gap, SpherePairs& pairs) {
  add_touching(mesh, owner, pairs);
  if (gap <= 0 || owner.empty()) return;
  std::vector<std::vector<Index>> regions(*std::max_element(owner.begin(), owner.end()) + 1);
  for (Index t = 0; t < owner.size(); ++t) regions[owner[t]].push_back(t);
  EdgeGraph graph(mesh, owner);
  for (std::uint32_t sphere = 0; sphere < regions.size(); ++sphere) {
    graph.add_within(sphere, regions[sphere], gap, pairs);
  }
}

}  // namespace spherechain::baker
