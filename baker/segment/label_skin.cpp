// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/label_skin.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "baker/segment/islands.h"

namespace spherechain::baker {
namespace {

constexpr std::uint8_t kNoRegion = 255;

std::vector<std::uint8_t> label_by_pieces(const Character& character, const BodyMesh& body, const SurfaceQuery& surface,
                                          const std::vector<std::uint8_t>& labels_of_body) {
  const Mesh& skin = character.skin;
  std::vector<std::uint8_t> of_source(character.source_triangles.size(), kNoRegion);
  for (std::size_t t = 0; t < labels_of_body.size(); ++t) {
    if (body.source_triangle[t] != kNoIndex) of_source[body.source_triangle[t]] = labels_of_body[t];
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
    of_piece.push_back(labels_of_body[surface.closest(centroid[piece] / area[piece]).triangle]);
  }
  std::vector<std::uint8_t> labels;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const std::uint8_t own = of_source[character.skin_source_triangle[t]];
    labels.push_back(own == kNoRegion ? of_piece[pieces.of_triangle[t]] : own);
  }
  return labels;
}

std::uint8_t nearest_label(const Character& character, const BodyMesh& body, const SurfaceQuery& surface,
                           const std::vector<std::uint8_t>& labels_of_body, std::size_t t) {
  constexpr double kParallel = 0.5;  // cosine
  // Across a gap no wider than this many times the nearest surface's distance.
  constexpr double kFarther = 3;
  const Vec3 p = triangle_centroid(character.skin, t), normal = triangle_cross(character.skin, t).normalized();
  const auto parallel = [&](Index triangle) {
    return std::abs(triangle_cross(body.mesh, triangle).normalized().dot(normal)) >= kParallel;
  };
  const SurfaceHit nearest = surface.closest(p);
  if (parallel(nearest.triangle)) return labels_of_body[nearest.triangle];
  double distance = kFarther * nearest.distance;
  Index best = nearest.triangle;
  for (const Vec3& direction : {normal, Vec3(-normal)}) {
    const auto hit = surface.first_hit(p, direction);
    if (!hit || hit->distance >= distance || !parallel(hit->triangle)) continue;
    distance = hit->distance;
    best = hit->triangle;
  }
  return labels_of_body[best];
}

// On each piece of the skin, a region's small islands join the region with the longest common border.
void join_small_islands(const Mesh& skin, std::vector<std::uint8_t>& labels) {
  constexpr double kSmall = 0.25;
  const Components pieces = connected_components(skin);
  const Neighbours neighbours = triangle_neighbours(skin);
  const Islands islands = find_islands(skin, neighbours, labels);
  const auto piece_of = [&](Index id) { return pieces.of_triangle[islands.triangles[id][0]]; };
  const auto label_of = [&](Index id) { return labels[islands.triangles[id][0]]; };
  std::vector<std::array<double, 256>> largest(pieces.count);
  for (auto& of_region : largest) of_region.fill(0);
  for (Index id = 0; id < islands.area.size(); ++id) {
    double& most = largest[piece_of(id)][label_of(id)];
    most = std::max(most, islands.area[id]);
  }
  std::vector<Index> order;
  for (Index id = 0; id < islands.area.size(); ++id) {
    if (islands.area[id] < kSmall * largest[piece_of(id)][label_of(id)]) order.push_back(id);
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return islands.area[a] < islands.area[b]; });
  for (const Index id : order) {
    const std::array<double, 256> border = border_lengths(skin, neighbours, islands, labels, id);
    const auto most = std::max_element(border.begin(), border.end());
    if (!(*most > 0)) continue;
    for (const Index t : islands.triangles[id]) labels[t] = static_cast<std::uint8_t>(most - border.begin());
  }
}

}  // namespace

std::vector<std::uint8_t> label_skin(const Character& character, const BodyMesh& body, const SurfaceQuery& surface,
                                     const std::vector<std::uint8_t>& labels_of_body) {
  if (is_part_of_skin(body)) return label_by_pieces(character, body, surface, labels_of_body);
  std::vector<std::uint8_t> labels;
  for (std::size_t t = 0; t < character.skin.triangles.size(); ++t) {
    labels.push_back(nearest_label(character, body, surface, labels_of_body, t));
  }
  join_small_islands(character.skin, labels);
  return labels;
}

}  // namespace spherechain::baker
