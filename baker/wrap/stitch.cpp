// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/wrap/stitch.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <unordered_map>

namespace spherechain::baker {
namespace {

// Corner k of triangle t, and the side from there to the next corner: 3 t + k.
using Corner = Index;

Corner next(Corner c) { return c % 3 == 2 ? c - 2 : c + 1; }

class Sheets {
 public:
  explicit Sheets(const Mesh& mesh) : mesh_(mesh), triangles_(mesh.triangles) {
    join_sides();
    turn();
    // The sides' numbers have changed where triangles were turned.
    join_sides();
    part_conflicts();
  }

  Stitched close() {
    std::vector<std::vector<Corner>> holes = find_holes();
    for (std::vector<Corner>& hole : holes) zip(hole);
    Stitched out;
    out.turned = turned_;
    out.parted = parted_;
    number_vertices(out);
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      out.mesh.triangles.push_back({vertex_[3 * t], vertex_[3 * t + 1], vertex_[3 * t + 2]});
      out.of_triangle.push_back(static_cast<Index>(t));
    }
    for (const std::vector<Corner>& hole : holes) cap(hole, out);
    return out;
  }

 private:
  Index corner(Corner c) const { return triangles_[c / 3][c % 3]; }
  Index start(Corner side) const { return corner(side); }
  Index end(Corner side) const { return corner(next(side)); }

  void join_sides() {
    std::unordered_map<std::uint64_t, std::vector<Corner>> edges;
    edges.reserve(triangles_.size() * 2);
    const auto count = static_cast<Corner>(3 * triangles_.size());
    for (Corner side = 0; side < count; ++side) {
      const Index a = start(side), b = end(side);
      edges[(std::uint64_t{std::min(a, b)} << 32) | std::max(a, b)].push_back(side);
    }
    twin_.assign(count, kNoIndex);
    parted_ = 0;
    for (const auto& [edge, sides] : edges) {
      if (sides.size() == 2) {
        twin_[sides[0]] = sides[1];
        twin_[sides[1]] = sides[0];
      } else if (sides.size() > 2) {
        ++parted_;
      }
    }
  }

  // Neighbours come to face the same way; in each sheet the way of the larger area stays.
  void turn() {
    std::vector<std::uint8_t> state(triangles_.size(), 0);  // 1: as it was, 2: turned
    for (Index seed = 0; seed < triangles_.size(); ++seed) {
      if (state[seed] != 0) continue;
      std::vector<Index> sheet{seed};
      state[seed] = 1;
      double kept = 0, turned = 0;
      for (std::size_t head = 0; head < sheet.size(); ++head) {
        const Index t = sheet[head];
        (state[t] == 1 ? kept : turned) += triangle_area(mesh_, t);
        for (Corner side = 3 * t; side < 3 * t + 3; ++side) {
          const Corner other = twin_[side];
          if (other == kNoIndex || state[other / 3] != 0) continue;
          const bool agrees = start(side) == end(other);
          state[other / 3] = agrees ? state[t] : static_cast<std::uint8_t>(3 - state[t]);
          sheet.push_back(other / 3);
        }
      }
      const std::uint8_t wrong = kept >= turned ? 2 : 1;
      for (const Index t : sheet) {
        if (state[t] != wrong) continue;
        to_turn_.push_back(t);
      }
    }
    for (const Index t : to_turn_) std::swap(triangles_[t][1], triangles_[t][2]);
    turned_ = to_turn_.size();
  }

  // On a band with a twist no way is right all round.
  void part_conflicts() {
    for (Corner side = 0; side < twin_.size(); ++side) {
      if (twin_[side] == kNoIndex || start(side) == end(twin_[side])) continue;
      twin_[twin_[side]] = kNoIndex;
      twin_[side] = kNoIndex;
      ++parted_;
    }
  }

  // The border side that follows along the hole: around the end of this one.
  Corner following(Corner side) const {
    Corner at = next(side);
    while (twin_[at] != kNoIndex) at = next(twin_[at]);
    return at;
  }

  std::vector<std::vector<Corner>> find_holes() const {
    std::vector<std::vector<Corner>> holes;
    std::vector<bool> seen(twin_.size(), false);
    for (Corner side = 0; side < twin_.size(); ++side) {
      if (twin_[side] != kNoIndex || seen[side]) continue;
      holes.emplace_back();
      for (Corner at = side; !seen[at]; at = following(at)) {
        seen[at] = true;
        holes.back().push_back(at);
      }
    }
    return holes;
  }

  // A slit's two sides become one edge: from its ends inwards.
  void zip(std::vector<Corner>& hole) {
    std::vector<Corner> open;
    const auto meet = [&](Corner a, Corner b) { return start(a) == end(b) && end(a) == start(b) && a / 3 != b / 3; };
    const auto join = [&](Corner a, Corner b) {
      twin_[a] = b;
      twin_[b] = a;
    };
    for (const Corner side : hole) {
      if (!open.empty() && meet(open.back(), side)) {
        join(open.back(), side);
        open.pop_back();
      } else {
        open.push_back(side);
      }
    }
    std::size_t first = 0;
    while (open.size() >= first + 2 && meet(open[first], open.back())) {
      join(open[first], open.back());
      ++first;
      open.pop_back();
    }
    open.erase(open.begin(), open.begin() + static_cast<std::ptrdiff_t>(first));
    hole = std::move(open);
  }

  // A vertex for each fan of triangles: sheets that met in an edge or a point part there.
  void number_vertices(Stitched& out) {
    std::vector<Corner> group(twin_.size());
    std::iota(group.begin(), group.end(), Corner{0});
    const auto find = [&](Corner c) {
      while (group[c] != c) c = group[c] = group[group[c]];
      return c;
    };
    const auto join = [&](Corner a, Corner b) {
      const Corner root_a = find(a), root_b = find(b);
      group[std::max(root_a, root_b)] = std::min(root_a, root_b);
    };
    for (Corner side = 0; side < twin_.size(); ++side) {
      if (twin_[side] == kNoIndex) continue;
      join(side, next(twin_[side]));
      join(next(side), twin_[side]);
    }
    vertex_.assign(twin_.size(), kNoIndex);
    for (Corner c = 0; c < twin_.size(); ++c) {
      Index& v = vertex_[find(c)];
      if (v == kNoIndex) {
        v = static_cast<Index>(out.mesh.positions.size());
        out.mesh.positions.push_back(mesh_.positions[corner(c)]);
        out.of_vertex.push_back(corner(c));
      }
      vertex_[c] = v;
    }
  }

  void cap(const std::vector<Corner>& hole, Stitched& out) const {
    if (hole.size() < 3) return;
    ++out.holes;
    const auto add = [&](Index a, Index b, Index c) {
      out.mesh.triangles.push_back({a, b, c});
      out.of_triangle.push_back(kNoIndex);
    };
    // Against the direction of the sides around it.
    const auto v = [&](std::size_t i) { return vertex_[hole[i % hole.size()]]; };
    if (hole.size() == 3) {
      add(v(1), v(0), v(2));
      return;
    }
    Vec3 middle = Vec3::Zero();
    double length = 0;
    for (std::size_t i = 0; i < hole.size(); ++i) {
      const Vec3 &a = out.mesh.positions[v(i)], &b = out.mesh.positions[v(i + 1)];
      middle += (b - a).norm() * 0.5 * (a + b);
      length += (b - a).norm();
    }
    const auto center = static_cast<Index>(out.mesh.positions.size());
    out.mesh.positions.push_back(length > 0 ? Vec3(middle / length) : out.mesh.positions[v(0)]);
    out.of_vertex.push_back(kNoIndex);
    for (std::size_t i = 0; i < hole.size(); ++i) add(v(i + 1), v(i), center);
  }

  const Mesh& mesh_;
  std::vector<Triangle> triangles_;
  std::vector<Corner> twin_;  // the side across the edge
  std::vector<Index> to_turn_;
  std::vector<Index> vertex_;  // of a corner
  std::size_t turned_ = 0, parted_ = 0;
};

}  // namespace

Stitched stitch(const Mesh& mesh) { return Sheets(mesh).close(); }

}  // namespace spherechain::baker
