// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/from_runtime.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "baker/play/target.h"

namespace spherechain::baker {
namespace {

void measure_f(PageSphere& out, const RestSphere& sphere, const Character& character) {
  std::set<Index> vertices;
  for (const std::uint32_t t : out.triangles) {
    vertices.insert(character.source_triangles[t].begin(), character.source_triangles[t].end());
  }
  const Vec3 center(sphere.center.x, sphere.center.y, sphere.center.z);
  double sum = 0;
  out.max_abs_f = 0;
  for (const Index v : vertices) {
    const double f = std::abs(sphere.radius - (center - character.source_positions[v]).norm());
    sum += f;
    out.max_abs_f = std::max(out.max_abs_f, f);
  }
  out.mean_abs_f = vertices.empty() ? 0 : sum / static_cast<double>(vertices.size());
}

// Pivots are recognised by their corners.
void find_pivots(PageSphere& out, const RestSphere& sphere, const OpenAsset& asset, const Character& character) {
  for (std::uint32_t p = 0; p < sphere.pivot_count; ++p) {
    const Pivot& pivot = asset->pivots()[sphere.first_pivot + p];
    const auto found = std::find_if(out.triangles.begin(), out.triangles.end(), [&](std::uint32_t t) {
      return character.source_triangles[t] == Triangle{pivot.a, pivot.b, pivot.c};
    });
    if (found != out.triangles.end()) out.pivots.push_back(*found);
  }
}

std::vector<std::array<std::uint16_t, 2>> pairs_of(const Player& player) {
  std::vector<std::array<std::uint16_t, 2>> out;
  for (const Pair& pair : player.pairs()) {
    out.push_back({static_cast<std::uint16_t>(pair.a), static_cast<std::uint16_t>(pair.b)});
  }
  return out;
}

const AnimatedAsset& checked(const AnimatedAsset& animated) {
  animated.check_clusters();
  return animated;
}

}  // namespace

bool has_arms(const OpenAsset& asset) {
  for (std::size_t r = 0; r < asset->region_count(); ++r) {
    if (std::string(asset->region(r).name).find("_arm") != std::string::npos) return true;
  }
  return false;
}

std::vector<PageSphere> page_spheres(const OpenAsset& asset, const Character& character) {
  std::vector<PageSphere> out;
  for (std::size_t s = 0; s < asset->spheres().size; ++s) {
    const RestSphere& sphere = asset->spheres()[s];
    PageSphere& made = out.emplace_back();
    for (const std::uint32_t t : asset.triangles_of(s)) {
      if (t < character.source_triangles.size()) made.triangles.push_back(t);
    }
    find_pivots(made, sphere, asset, character);
    measure_f(made, sphere, character);
  }
  return out;
}

PageParts page_parts(const OpenAsset& asset) {
  BodyParts parts = body_parts_of(asset);
  PageParts out;
  for (const BodyPart& part : parts.parts) out.names.push_back(part.name);
  out.of_triangle = std::move(parts.of_triangle);
  return out;
}

PageFrames::PageFrames(const AnimatedAsset& animated)
    : fit_(checked(animated).asset(), SC_RADIUS_FIT, choose_target("auto")),
      detect_(animated.asset(), SC_RADIUS_DETECT, choose_target("auto")) {}

PageFrame PageFrames::run(const std::vector<float>& positions, const sc_pose& skin, bool is_next) {
  PageFrame out;
  fit_.run(positions);
  detect_.run(positions);
  out.fit_pairs = pairs_of(fit_);
  out.detect_pairs = pairs_of(detect_);
  for (std::size_t s = 0; s < fit_.spheres().size(); ++s) {
    const Sphere& sphere = fit_.spheres()[s];
    out.spheres.insert(out.spheres.end(), {sphere.x, sphere.y, sphere.z, sphere.radius, detect_.spheres()[s].radius});
  }
  const Player::TriangleDetection found = detect_.detect_triangles(skin, is_next);
  out.penetrations = found.penetrations;
  for (const Pair& pair : found.pairs) out.contacts.push_back({pair.a, pair.b});
  return out;
}

}  // namespace spherechain::baker
