// SPDX-License-Identifier: GPL-3.0-or-later
#include "closed_shapes.h"

#include <cmath>
#include <map>
#include <numbers>
#include <set>

using namespace spherechain::baker;

namespace {

// A surface of revolution about z through (radius, z) profile points between two poles.
SourceMesh revolve(const std::vector<std::pair<double, double>>& profile, double bottom, double top, int around) {
  SourceMesh mesh;
  mesh.importer = "test";
  for (const auto& [radius, z] : profile) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  const auto at = [&](std::size_t ring, int i) {
    return static_cast<Index>(ring * static_cast<std::size_t>(around) + static_cast<std::size_t>(i % around));
  };
  const auto low = static_cast<Index>(mesh.positions.size()), high = low + 1;
  mesh.positions.emplace_back(0, 0, bottom);
  mesh.positions.emplace_back(0, 0, top);
  for (int i = 0; i < around; ++i) {
    mesh.triangles.push_back({low, at(0, i + 1), at(0, i)});
    for (std::size_t r = 0; r + 1 < profile.size(); ++r) {
      mesh.triangles.push_back({at(r, i), at(r, i + 1), at(r + 1, i)});
      mesh.triangles.push_back({at(r, i + 1), at(r + 1, i + 1), at(r + 1, i)});
    }
    mesh.triangles.push_back({high, at(profile.size() - 1, i), at(profile.size() - 1, i + 1)});
  }
  return mesh;
}

}  // namespace

SourceMesh tube_mesh(double length, int rings) {
  std::vector<std::pair<double, double>> profile;
  for (int i = 1; i < rings; ++i) {
    const double angle = std::numbers::pi * (static_cast<double>(i) / rings - 0.5);
    if (2 * i == rings) profile.emplace_back(1.0, 0.0);
    const double shift = length * (2 * i < rings ? 0 : 1);
    if (2 * i != rings) profile.emplace_back(std::cos(angle), std::sin(angle) + shift);
    if (2 * i == rings) {
      for (int k = 1; k <= 40; ++k) profile.emplace_back(1.0, length * k / 40);
    }
  }
  return revolve(profile, -1, length + 1, 2 * rings);
}

SourceMesh ball_mesh(int rings) {
  std::vector<std::pair<double, double>> profile;
  for (int i = 1; i < rings; ++i) {
    const double angle = std::numbers::pi * (static_cast<double>(i) / rings - 0.5);
    profile.emplace_back(std::cos(angle), std::sin(angle));
  }
  return revolve(profile, -1, 1, 2 * rings);
}

SourceMesh without_region(const Bake& bake, std::uint8_t region, std::uint8_t other) {
  SourceMesh mesh;
  mesh.importer = "test";
  mesh.positions = bake.regions.body.mesh.positions;
  std::map<std::pair<Index, Index>, bool> directed;
  for (std::size_t t = 0; t < bake.regions.body.mesh.triangles.size(); ++t) {
    if (bake.regions.of_triangle[t] == region || bake.regions.of_triangle[t] == other) continue;
    const Triangle& v = bake.regions.body.mesh.triangles[t];
    mesh.triangles.push_back(v);
    for (std::size_t k = 0; k < 3; ++k) directed[{v[k], v[(k + 1) % 3]}] = true;
  }
  // Walk each border loop against its triangles' direction and fan it from its middle.
  std::map<Index, Index> next;
  for (const auto& [edge, yes] : directed) {
    if (!directed.count({edge.second, edge.first})) next[edge.second] = edge.first;
  }
  while (!next.empty()) {
    std::vector<Index> loop{next.begin()->first};
    Vec3 middle = Vec3::Zero();
    while (true) {
      const auto step = next.find(loop.back());
      middle += mesh.positions[loop.back()];
      const Index to = step->second;
      next.erase(step);
      if (to == loop.front()) break;
      loop.push_back(to);
    }
    const auto centre = static_cast<Index>(mesh.positions.size());
    mesh.positions.push_back(middle / static_cast<double>(loop.size()));
    for (std::size_t i = 0; i < loop.size(); ++i)
      mesh.triangles.push_back({loop[i], loop[(i + 1) % loop.size()], centre});
  }
  return mesh;
}
