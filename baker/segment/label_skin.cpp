// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/label_skin.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace spherechain::baker {
namespace {

constexpr std::uint8_t kNoRegion = 255;

std::vector<std::uint8_t> label_by_pieces(const Character& character, const SurfaceQuery& surface,
                                          const std::vector<std::uint8_t>& body) {
  const Mesh& skin = character.skin;
  std::vector<std::uint8_t> of_source(character.source_triangles.size(), kNoRegion);
  for (std::size_t t = 0; t < body.size(); ++t) {
    if (character.body_source_triangle[t] != kNoIndex) of_source[character.body_source_triangle[t]] = body[t];
  }
  const Components pieces = connected_components(skin);
  std::vector<Vec3> centroid(pieces.count, Vec3::Zero());
  std::vector<double> area(pieces.count, 0.0);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    centroid[pieces.of_triangle[t]] += triangle_area(skin, t) * triangle_centroid(skin, t);
    area[pieces.of_triangle[t]] += triangle_area(skin, t);
  }
  std::vector<std::uint8_t> of_piece;
  for (Index piece = 0; piece < pieces.count; ++piece) {
    of_piece.push_back(body[surface.closest(centroid[piece] / area[piece]).triangle]);
  }
  std::vector<std::uint8_t> labels;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const std::uint8_t own = of_source[character.skin_source_triangle[t]];
    labels.push_back(own == kNoRegion ? of_piece[pieces.of_triangle[t]] : own);
  }
  return labels;
}

std::uint8_t nearest_label(const Character& character, const SurfaceQuery& surface,
                           const std::vector<std::uint8_t>& body, std::size_t t) {
  constexpr double kParallel = 0.5;  // cosine
  // Across a gap no wider than this many times the nearest surface's distance.
  constexpr double kFarther = 3;
  const Vec3 p = triangle_centroid(character.skin, t), normal = triangle_cross(character.skin, t).normalized();
  const auto parallel = [&](Index triangle) {
    return std::abs(triangle_cross(character.body, triangle).normalized().dot(normal)) >= kParallel;
  };
  const SurfaceHit nearest = surface.closest(p);
  if (parallel(nearest.triangle)) return body[nearest.triangle];
  double distance = kFarther * nearest.distance;
  Index best = nearest.triangle;
  for (const Vec3& direction : {normal, Vec3(-normal)}) {
    const auto hit = surface.first_hit(p, direction);
    if (!hit || hit->distance >= distance || !parallel(hit->triangle)) continue;
    distance = hit->distance;
    best = hit->triangle;
  }
  return body[best];
}

// Of each region's islands on a piece of the skin those small against the largest join the region they border on most.
void join_small_islands(const Mesh& skin, std::vector<std::uint8_t>& labels) {
  constexpr double kSmall = 0.25;
  const Components pieces = connected_components(skin);
  const std::vector<std::array<Index, 3>> neighbours = triangle_neighbours(skin);
  std::vector<Index> island_of(labels.size(), kNoIndex);
  std::vector<std::vector<Index>> islands;
  std::vector<double> area;
  std::vector<std::array<double, 256>> largest(pieces.count);
  for (auto& of_region : largest) of_region.fill(0);
  for (Index seed = 0; seed < labels.size(); ++seed) {
    if (island_of[seed] != kNoIndex) continue;
    const auto id = static_cast<Index>(islands.size());
    islands.push_back({seed});
    area.push_back(0);
    island_of[seed] = id;
    for (std::size_t head = 0; head < islands[id].size(); ++head) {
      area[id] += triangle_area(skin, islands[id][head]);
      for (const Index n : neighbours[islands[id][head]]) {
        if (n == kNoIndex || island_of[n] != kNoIndex || labels[n] != labels[seed]) continue;
        island_of[n] = id;
        islands[id].push_back(n);
      }
    }
    double& most = largest[pieces.of_triangle[seed]][labels[seed]];
    most = std::max(most, area[id]);
  }
  std::vector<Index> order;
  for (Index id = 0; id < islands.size(); ++id) {
    const Index seed = islands[id][0];
    if (area[id] < kSmall * largest[pieces.of_triangle[seed]][labels[seed]]) order.push_back(id);
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return area[a] < area[b]; });
  for (const Index id : order) {
    std::array<double, 256> border{};
    double total = 0;
    for (const Index t : islands[id]) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index n = neighbours[t][k];
        if (n == kNoIndex || island_of[n] == id) continue;
        const Triangle& v = skin.triangles[t];
        const double length = (skin.positions[v[k]] - skin.positions[v[(k + 1) % 3]]).norm();
        border[labels[n]] += length;
        total += length;
      }
    }
    if (!(total > 0)) continue;
    const auto most = static_cast<std::uint8_t>(std::max_element(border.begin(), border.end()) - border.begin());
    for (const Index t : islands[id]) labels[t] = most;
  }
}

}  // namespace

std::vector<std::uint8_t> label_skin(const Character& character, const SurfaceQuery& body,
                                     const std::vector<std::uint8_t>& labels_of_body) {
  if (is_part_of_skin(character)) return label_by_pieces(character, body, labels_of_body);
  std::vector<std::uint8_t> labels;
  for (std::size_t t = 0; t < character.skin.triangles.size(); ++t) {
    labels.push_back(nearest_label(character, body, labels_of_body, t));
  }
  join_small_islands(character.skin, labels);
  return labels;
}

}  // namespace spherechain::baker
