// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/swallowed_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace spherechain::baker {
namespace {

constexpr int kDepth = 5;  // a triangle that is crossed is cut in four so often, where a line is near

// A region that is bounded by a line that does not close is inside and outside: its corners on lines do not agree.
constexpr double kAgreement = 0.75;

// Corners of crossed triangles.
struct Votes {
  int behind = 0, all = 0;
};

// A line in which another triangle crosses this one.
struct Line {
  Vec3 from, to;
  Vec3 at, normal;  // of the other one's plane
};

double squared_distance(const Vec3& p, const Line& line) {
  const Vec3 along = line.to - line.from;
  const double length = along.squaredNorm();
  const double t = length > 0 ? std::clamp((p - line.from).dot(along) / length, 0.0, 1.0) : 0;
  return (line.from + t * along - p).squaredNorm();
}

// Where a point of the triangle is to the nearest of these that cross it.
struct Side {
  double distance;
  bool is_behind;
};

Side side_of(const Vec3& p, const std::vector<Line>& lines) {
  const Line* nearest = nullptr;
  double least = HUGE_VAL;
  for (const Line& line : lines) {
    const double d = squared_distance(p, line);
    if (d < least) {
      least = d;
      nearest = &line;
    }
  }
  return {std::sqrt(least), nearest != nullptr && (p - nearest->at).dot(nearest->normal) < 0};
}

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

// The sums that give area, middle and volume.
struct Flux {
  double area = 0, outward = 0;  // the sum of p . dA
  Vec3 vector = Vec3::Zero(), middle = Vec3::Zero();

  void add(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 half = 0.5 * (b - a).cross(c - a), centre = (a + b + c) / 3;
    const double size = half.norm();
    area += size;
    vector += half;
    middle += size * centre;
    outward += centre.dot(half);
  }
  // As much of a triangle as is behind the lines.
  void add_behind(const Vec3& a, const Vec3& b, const Vec3& c, const std::vector<Line>& lines, int depth) {
    const Vec3 centre = (a + b + c) / 3;
    const auto [distance, is_behind] = side_of(centre, lines);
    const double reach = std::max({(a - centre).norm(), (b - centre).norm(), (c - centre).norm()});
    if (depth == kDepth || distance > reach) {
      if (is_behind) add(a, b, c);
      return;
    }
    const Vec3 ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    add_behind(a, ab, ca, lines, depth + 1);
    add_behind(ab, b, bc, lines, depth + 1);
    add_behind(ca, bc, c, lines, depth + 1);
    add_behind(ab, bc, ca, lines, depth + 1);
  }
};

}  // namespace

SwallowedSkin::SwallowedSkin(const ScoredSkin& skin) : skin_(skin), triangles_at_(skin.rest.size()) {
  for (Index t = 0; t < skin.triangles.size(); ++t) {
    for (const Index v : skin.triangles[t]) triangles_at_[skin.joined[v]].push_back(t);
  }
}

Swallowed SwallowedSkin::measure(const std::vector<Vec3>& positions, const std::vector<TriangleContact>& contacts,
                                 const std::vector<TriangleContact>& others) const {
  const auto corner = [&](Index t, std::size_t k) -> const Vec3& { return positions[skin_.triangles[t][k]]; };
  using LinesOf = std::map<Index, std::vector<Line>>;  // by triangle
  const auto add_lines = [&](const std::vector<TriangleContact>& from, LinesOf& to) {
    const auto add = [&](Index of, Index by, const TriangleContact& contact) {
      const Vec3 &a = corner(by, 0), normal = (corner(by, 1) - a).cross(corner(by, 2) - a);
      to[of].push_back({to_vec3(contact.from), to_vec3(contact.to), a, normal});
    };
    for (const TriangleContact& contact : from) {
      add(contact.triangle_a, contact.triangle_b, contact);
      add(contact.triangle_b, contact.triangle_a, contact);
    }
  };
  Flux flux;
  LinesOf lines;
  add_lines(contacts, lines);
  for (const auto& [t, of] : lines) flux.add_behind(corner(t, 0), corner(t, 1), corner(t, 2), of, 0);
  std::set<Index> counted;  // joined vertices of these triangles
  for (const auto& [t, of] : lines) {
    for (const Index v : skin_.triangles[t]) counted.insert(skin_.joined[v]);
  }
  add_lines(others, lines);
  std::map<Index, Votes> votes;  // by joined vertex
  for (const auto& [t, of] : lines) {
    for (std::size_t k = 0; k < 3; ++k) {
      Votes& vote = votes[skin_.joined[skin_.triangles[t][k]]];
      vote.behind += side_of(corner(t, k), of).is_behind ? 1 : 0;
      ++vote.all;
    }
  }
  std::vector<char> is_taken(skin_.triangles.size(), 0), is_seen(skin_.rest.size(), 0);
  for (const auto& [t, of] : lines) is_taken[t] = 1;
  std::vector<Index> region, corners;
  for (const auto& [start, vote] : votes) {
    if (is_seen[start] != 0) continue;
    // The triangles that lines bound, from one line to the next.
    region.clear();
    corners.assign({start});
    is_seen[start] = 1;
    Votes sum;
    bool is_counted = false;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      if (const auto found = votes.find(corners[c]); found != votes.end()) {
        sum.behind += found->second.behind;
        sum.all += found->second.all;
        is_counted |= counted.contains(corners[c]);
      }
      for (const Index t : triangles_at_[corners[c]]) {
        if (is_taken[t] != 0) continue;
        is_taken[t] = 1;
        region.push_back(t);
        for (const Index v : skin_.triangles[t]) {
          const Index vertex = skin_.joined[v];
          if (is_seen[vertex] == 0) corners.push_back(vertex);
          is_seen[vertex] = 1;
        }
      }
    }
    if (!is_counted || sum.behind < kAgreement * sum.all) continue;
    for (const Index t : region) flux.add(corner(t, 0), corner(t, 1), corner(t, 2));
  }
  if (flux.area == 0) return {};
  return {flux.area, std::max(0.0, (flux.outward - (flux.middle / flux.area).dot(flux.vector)) / 3)};
}

}  // namespace spherechain::baker
