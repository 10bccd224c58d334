// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/branches.h"

#include <algorithm>
#include <limits>
#include <set>

namespace spherechain::baker {
namespace {

struct Walk {
  std::vector<Index> path;  // from a node to the next node whose degree is not two
  double length = 0;
};

using Graph = std::vector<std::set<Index>>;

Walk walk(const Graph& graph, const std::vector<Vec3>& points, Index from, Index next) {
  Walk result{{from, next}, (points[next] - points[from]).norm()};
  while (graph[result.path.back()].size() == 2) {
    const Index here = result.path.back(), before = result.path[result.path.size() - 2];
    const auto& sides = graph[here];
    const Index onward = *sides.begin() == before ? *sides.rbegin() : *sides.begin();
    if (onward == from) break;  // a loop
    result.path.push_back(onward);
    result.length += (points[onward] - points[here]).norm();
  }
  return result;
}

// The spanning tree by breadth first: surfaces of higher genus have loops in their skeletons.
Graph spanning_tree(const CurveSkeleton& skeleton) {
  Graph tree(skeleton.points.size());
  std::vector<bool> seen(skeleton.points.size(), false);
  std::vector<Index> queue{0};
  if (skeleton.points.empty()) return tree;
  seen[0] = true;
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const Index here = queue[head];
    for (const Index next : skeleton.neighbours[here]) {
      if (seen[next]) continue;
      seen[next] = true;
      tree[here].insert(next);
      tree[next].insert(here);
      queue.push_back(next);
    }
  }
  return tree;
}

double longest_path(const Graph& tree, const std::vector<Vec3>& points) {
  const auto farthest = [&](Index start) {
    std::vector<std::pair<Index, double>> stack{{start, 0.0}};
    std::vector<bool> seen(points.size(), false);
    seen[start] = true;
    std::pair<Index, double> best{start, 0.0};
    while (!stack.empty()) {
      const auto [here, d] = stack.back();
      stack.pop_back();
      if (d > best.second) best = {here, d};
      for (const Index next : tree[here]) {
        if (seen[next]) continue;
        seen[next] = true;
        stack.emplace_back(next, d + (points[next] - points[here]).norm());
      }
    }
    return best;
  };
  return points.empty() ? 0 : farthest(farthest(0).first).second;
}

}  // namespace

std::size_t BranchTree::tip_count() const {
  return static_cast<std::size_t>(std::count_if(at.begin(), at.end(), [](const auto& b) { return b.size() == 1; }));
}

BranchTree find_long_branches(const CurveSkeleton& skeleton, double shortest) {
  Graph graph = spanning_tree(skeleton);
  const std::vector<Vec3>& points = skeleton.points;
  const double limit = shortest * longest_path(graph, points);

  // The shortest tip goes first: when it is gone, two branches may have become one long one.
  while (true) {
    Walk shortest_tip;
    shortest_tip.length = std::numeric_limits<double>::max();
    for (Index v = 0; v < graph.size(); ++v) {
      if (graph[v].size() != 1) continue;
      Walk candidate = walk(graph, points, v, *graph[v].begin());
      if (graph[candidate.path.back()].size() == 1) continue;  // all that is left is one curve
      if (candidate.length < shortest_tip.length) shortest_tip = std::move(candidate);
    }
    if (shortest_tip.length >= limit) break;
    for (std::size_t i = 0; i + 1 < shortest_tip.path.size(); ++i) {
      const Index a = shortest_tip.path[i], b = shortest_tip.path[i + 1];
      graph[a].erase(b);
      graph[b].erase(a);
    }
  }

  BranchTree tree;
  tree.at.resize(points.size());
  for (Index v = 0; v < graph.size(); ++v) {
    if (graph[v].size() == 2) continue;
    for (const Index next : graph[v]) {
      const Walk w = walk(graph, points, v, next);
      const Index end = w.path.back();
      if (end < v) continue;  // seen from its other end
      std::vector<Vec3> line;
      for (const Index i : w.path) line.push_back(points[i]);
      tree.at[v].push_back(static_cast<Index>(tree.branches.size()));
      tree.at[end].push_back(static_cast<Index>(tree.branches.size()));
      tree.branches.push_back({v, end, Polyline(std::move(line))});
    }
  }
  return tree;
}

}  // namespace spherechain::baker
