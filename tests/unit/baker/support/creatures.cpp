// SPDX-License-Identifier: GPL-3.0-or-later
#include "creatures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

using namespace spherechain::baker;

namespace {

// In plain numbers: it is called millions of times, and tests are not optimised.
double distance(const Tube& tube, const Vec3& p) {
  const double *a = tube.from.data(), *b = tube.to.data(), *q = p.data();
  double along = 0, length = 0, off = 0;
  for (int k = 0; k < 3; ++k) {
    along += (q[k] - a[k]) * (b[k] - a[k]);
    length += (b[k] - a[k]) * (b[k] - a[k]);
  }
  const double f = std::clamp(along / length, 0.0, 1.0);
  for (int k = 0; k < 3; ++k) {
    const double from_axis = q[k] - a[k] - f * (b[k] - a[k]);
    off += from_axis * from_axis;
  }
  return std::sqrt(off) - (tube.from_radius + f * (tube.to_radius - tube.from_radius));
}

// A smooth minimum, so that limbs grow out of the trunk.
double field(const std::vector<Tube>& tubes, const Vec3& p, double blend) {
  double sum = 0, least = std::numeric_limits<double>::max();
  std::vector<double> distances;
  for (const Tube& tube : tubes) distances.push_back(distance(tube, p));
  for (const double one : distances) least = std::min(least, one);
  for (const double one : distances) sum += std::exp(-(one - least) / blend);
  return least - blend * std::log(sum);
}

}  // namespace

SourceMesh melt(const std::vector<Tube>& tubes, double cell) {
  const double blend = 0.3 * cell;
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const Tube& tube : tubes) {
    for (const auto& [p, r] : {std::pair(tube.from, tube.from_radius), std::pair(tube.to, tube.to_radius)}) {
      low = low.cwiseMin(p - Vec3::Constant(r + 3 * cell));
      high = high.cwiseMax(p + Vec3::Constant(r + 3 * cell));
    }
  }
  // A plane of symmetry at x = 0 stays one.
  const double half = std::max(-low.x(), high.x());
  low.x() = -cell * std::ceil(half / cell);
  high.x() = -low.x();
  std::array<int, 3> n{};
  for (int k = 0; k < 3; ++k)
    n[static_cast<std::size_t>(k)] = static_cast<int>(std::ceil((high[k] - low[k]) / cell - 1e-9)) + 1;
  const auto node = [&](int x, int y, int z) {
    return (static_cast<Index>(z) * static_cast<Index>(n[1]) + static_cast<Index>(y)) * static_cast<Index>(n[0]) +
           static_cast<Index>(x);
  };
  std::vector<Vec3> points;
  std::vector<double> values;
  for (int z = 0; z < n[2]; ++z) {
    for (int y = 0; y < n[1]; ++y) {
      for (int x = 0; x < n[0]; ++x) {
        points.push_back(low + cell * Vec3(x, y, z));
        values.push_back(field(tubes, points.back(), blend));
      }
    }
  }
  SourceMesh mesh;
  std::map<std::pair<Index, Index>, Index> crossings;
  const auto crossing = [&](Index a, Index b) {
    const auto [found, is_new] = crossings.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.positions.size()));
    if (is_new) {
      // Away from the nodes, or triangles without area appear.
      const double f = std::clamp(values[a] / (values[a] - values[b]), 0.05, 0.95);
      mesh.positions.push_back(points[a] + f * (points[b] - points[a]));
    }
    return found->second;
  };
  const auto add = [&](Index a, Index b, Index c, const Vec3& outwards) {
    const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
    const bool flipped = (q - p).cross(r - p).dot(outwards) < 0;
    mesh.triangles.push_back(flipped ? Triangle{a, c, b} : Triangle{a, b, c});
  };
  const auto tetrahedron = [&](const std::array<Index, 4>& corners) {
    std::vector<Index> in, out;
    for (const Index c : corners) (values[c] < 0 ? in : out).push_back(c);
    if (in.empty() || out.empty()) return;
    Vec3 outwards = Vec3::Zero();
    for (const Index c : out) outwards += points[c] / static_cast<double>(out.size());
    for (const Index c : in) outwards -= points[c] / static_cast<double>(in.size());
    if (in.size() == 2) {
      const Index a = crossing(in[0], out[0]), b = crossing(in[0], out[1]), c = crossing(in[1], out[1]),
                  d = crossing(in[1], out[0]);
      add(a, b, c, outwards);
      add(a, c, d, outwards);
      return;
    }
    const bool one_in = in.size() == 1;
    const Index lone = one_in ? in[0] : out[0];
    const std::vector<Index>& others = one_in ? out : in;
    add(crossing(lone, others[0]), crossing(lone, others[1]), crossing(lone, others[2]), outwards);
  };
  // Six tetrahedra around a cell's diagonal, mirrored where x is on the other side.
  constexpr std::array<std::array<int, 2>, 6> kPaths{{{1, 2}, {1, 4}, {2, 1}, {2, 4}, {4, 1}, {4, 2}}};
  for (int z = 0; z + 1 < n[2]; ++z) {
    for (int y = 0; y + 1 < n[1]; ++y) {
      for (int x = 0; x + 1 < n[0]; ++x) {
        const bool mirrored = low.x() + cell * x < -0.5 * cell;
        const auto corner = [&](int bits) {
          const int dx = (bits & 1) ^ (mirrored ? 1 : 0);
          return node(x + dx, y + ((bits >> 1) & 1), z + ((bits >> 2) & 1));
        };
        for (const auto& [first, second] : kPaths) {
          tetrahedron({corner(0), corner(first), corner(first | second), corner(7)});
        }
      }
    }
  }
  mesh.importer = "melt";
  mesh.meshes = 1;
  return mesh;
}

std::vector<Tube> quadruped_tubes() {
  std::vector<Tube> tubes{{{0, 0.75, -0.4}, {0, 0.78, 0.35}, 0.17, 0.2},    // trunk
                          {{0, 0.85, 0.42}, {0, 1.1, 0.62}, 0.11, 0.09},    // neck
                          {{0, 1.12, 0.64}, {0, 1.08, 0.86}, 0.11, 0.06},   // head
                          {{0, 0.82, -0.5}, {0, 0.62, -1.0}, 0.06, 0.03}};  // tail
  for (const double side : {1.0, -1.0}) {
    tubes.push_back({{side * 0.13, 0.7, 0.35}, {side * 0.14, 0.38, 0.33}, 0.085, 0.06});
    tubes.push_back({{side * 0.14, 0.38, 0.33}, {side * 0.14, 0.06, 0.35}, 0.06, 0.045});
    tubes.push_back({{side * 0.14, 0.05, 0.35}, {side * 0.14, 0.05, 0.43}, 0.055, 0.045});
    tubes.push_back({{side * 0.12, 0.68, -0.4}, {side * 0.14, 0.4, -0.36}, 0.1, 0.065});
    tubes.push_back({{side * 0.14, 0.4, -0.36}, {side * 0.14, 0.06, -0.44}, 0.065, 0.045});
    tubes.push_back({{side * 0.14, 0.05, -0.44}, {side * 0.14, 0.05, -0.36}, 0.055, 0.045});
  }
  return tubes;
}

std::vector<Tube> six_legged_tubes() {
  std::vector<Tube> tubes{{{0, 0.4, -0.5}, {0, 0.4, 0.5}, 0.16, 0.16}, {{0, 0.42, 0.5}, {0, 0.45, 0.75}, 0.13, 0.1}};
  for (const double side : {1.0, -1.0}) {
    for (const double z : {-0.42, 0.0, 0.42}) {
      tubes.push_back({{side * 0.12, 0.42, z}, {side * 0.55, 0.5, 1.2 * z}, 0.055, 0.045});
      tubes.push_back({{side * 0.55, 0.5, 1.2 * z}, {side * 0.75, 0.05, 1.4 * z}, 0.045, 0.03});
    }
  }
  return tubes;
}

std::vector<Tube> snake_tubes() {
  std::vector<Tube> tubes;
  const auto at = [](int i) { return Vec3(0.12 * std::sin(0.9 * i), 0.1, -1.25 + 0.25 * i); };
  for (int i = 0; i < 10; ++i) tubes.push_back({at(i), at(i + 1), 0.03 + 0.007 * i, 0.037 + 0.007 * i});
  return tubes;
}
