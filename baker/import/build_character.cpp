// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

#include "baker/import/import.h"
#include "baker/import/notes.h"
#include "baker/import/pivots.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

// Limits of a character's diagonal: beyond them, squared lengths overflow single precision or CGAL's inexact steps.
constexpr double kSizeMin = 1e-6, kSizeMax = 1e12;

bool same_position(const Vec3& a, const Vec3& b) { return a.x() == b.x() && a.y() == b.y() && a.z() == b.z(); }

// The first source vertex at each vertex's position, so that the welded numbering follows the source's.
std::vector<Index> weld(const std::vector<Vec3>& positions) {
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index i, Index j) {
    const Vec3 &a = positions[i], &b = positions[j];
    if (a.x() != b.x()) return a.x() < b.x();
    if (a.y() != b.y()) return a.y() < b.y();
    if (a.z() != b.z()) return a.z() < b.z();
    return i < j;
  });
  std::vector<Index> first(positions.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool joins = k > 0 && same_position(positions[order[k]], positions[order[k - 1]]);
    first[order[k]] = joins ? first[order[k - 1]] : order[k];
  }
  return first;
}

// A subset of triangles as a mesh of its own, vertices in source order.
struct Piece {
  Mesh mesh;
  std::vector<Index> of_source;  // welded representative -> vertex of mesh
};

Piece extract(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  Piece piece;
  piece.of_source.assign(positions.size(), kNoIndex);
  for (const Triangle& t : triangles) {
    for (const Index v : t) piece.of_source[v] = 0;
  }
  for (Index v = 0; v < positions.size(); ++v) {
    if (piece.of_source[v] == kNoIndex) continue;
    piece.of_source[v] = static_cast<Index>(piece.mesh.positions.size());
    piece.mesh.positions.push_back(positions[v]);
  }
  for (const Triangle& t : triangles) {
    piece.mesh.triangles.push_back({piece.of_source[t[0]], piece.of_source[t[1]], piece.of_source[t[2]]});
  }
  return piece;
}

void check_positions(const SourceMesh& source, const std::string& name) {
  if (source.triangles.empty()) throw Error(ExitCode::kFile, name + ": has no triangles (a character needs a surface)");
  for (std::size_t v = 0; v < source.positions.size(); ++v) {
    if (!source.positions[v].allFinite()) {
      throw Error(ExitCode::kFile, name + ": vertex " + std::to_string(v) + " has a position that is not finite");
    }
  }
  for (std::size_t t = 0; t < source.triangles.size(); ++t) {
    for (const Index v : source.triangles[t]) {
      if (v >= source.positions.size()) {
        throw Error(ExitCode::kFile, name + ": triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) +
                                         " of " + std::to_string(source.positions.size()));
      }
    }
  }
}

}  // namespace

bool is_whole(const Character& character) {
  return count_open_edges(character.largest_piece.mesh) == 0 &&
         surface_area(character.largest_piece.mesh) > kBodyShareMin * surface_area(character.skin);
}

bool is_part_of_skin(const BodyMesh& body) {
  const std::vector<Index>& source = body.source_triangle;
  return std::any_of(source.begin(), source.end(), [](Index t) { return t != kNoIndex; });
}

BodyMesh all_pieces(const Character& character) {
  return {character.skin, character.skin_source_triangle, character.skin_of_source};
}

std::vector<float> pack(const std::vector<Vec3>& positions) {
  std::vector<float> packed;
  packed.reserve(positions.size() * 3);
  for (const Vec3& p : positions) {
    for (int k = 0; k < 3; ++k) packed.push_back(static_cast<float>(p[k]));
  }
  return packed;
}

Character build_character(const SourceMesh& source, const std::string& name) {
  check_positions(source, name);
  Character character;
  character.source_triangles = source.triangles;
  character.buffers = source.buffers;
  character.rig = source.rig;
  character.metres_per_unit = source.metres_per_unit;
  character.up_hint = source.up_hint;
  ImportReport& report = character.report;
  report.importer = source.importer;
  report.meshes = source.meshes;
  report.points_and_lines_dropped = source.points_and_lines_dropped;
  report.bones_dropped = source.bones_dropped;

  // The runtime's buffers are float: what the baker measures must be what the runtime sees.
  for (const Vec3& p : source.positions) {
    const Eigen::Vector3f f = p.cast<float>();
    if (!f.allFinite()) throw Error(ExitCode::kFile, name + ": a position is too large for single precision");
    character.source_positions.push_back(f.cast<double>());
  }
  const std::vector<Vec3>& positions = character.source_positions;
  std::vector<Vec3> pivots = pivots_of(character.rig, positions);
  if (!pivots.empty()) {
    character.rig.pivots = std::move(pivots);
    character.rig.are_pivots_from_skin = true;
    add_note(name +
             ": its joints are bound at one place: where they turn is guessed from the skin (bind each joint where " +
             "it turns)");
  }

  Eigen::AlignedBox3d box;
  for (const Triangle& t : source.triangles) {
    for (const Index v : t) box.extend(positions[v]);
  }
  const double extent = box.diagonal().norm();
  if (extent <= 0) throw Error(ExitCode::kFile, name + ": has no size (all positions coincide)");
  if (extent < kSizeMin || extent > kSizeMax) {
    std::ostringstream size;
    size << extent << " units across (a character is from " << kSizeMin << " to " << kSizeMax << ": scale it)";
    throw Error(ExitCode::kFile, name + ": is " + size.str());
  }

  const std::vector<Index> welded = weld(positions);
  // Sine of an angle no real triangle has: below it three corners lie on a line as far as floats can tell.
  constexpr double kFlat = 1e-7;
  Mesh all{positions, {}};
  std::vector<Index> source_triangle;
  std::set<Triangle> seen;
  for (Index t = 0; t < source.triangles.size(); ++t) {
    const Triangle& v = source.triangles[t];
    const Triangle w{welded[v[0]], welded[v[1]], welded[v[2]]};
    all.triangles.push_back(w);
    const Vec3 &a = positions[w[0]], &b = positions[w[1]], &c = positions[w[2]];
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const bool degenerate = w[0] == w[1] || w[1] == w[2] || w[2] == w[0] ||
                            triangle_cross(all, all.triangles.size() - 1).norm() <= kFlat * longest;
    Triangle sorted = w;
    std::sort(sorted.begin(), sorted.end());
    if (degenerate) {
      ++report.degenerate_dropped;
      all.triangles.pop_back();
    } else if (!seen.insert(sorted).second) {
      ++report.duplicates_dropped;
      all.triangles.pop_back();
    } else {
      source_triangle.push_back(t);
    }
  }
  if (all.triangles.empty()) {
    throw Error(ExitCode::kFile, name + ": has no triangles with an area (all " +
                                     std::to_string(source.triangles.size()) + " are degenerate)");
  }

  const Components components = connected_components(all);
  report.components = components.count;
  std::vector<double> area(components.count, 0.0);
  for (std::size_t t = 0; t < all.triangles.size(); ++t) area[components.of_triangle[t]] += triangle_area(all, t);
  const auto body = static_cast<Index>(std::max_element(area.begin(), area.end()) - area.begin());

  std::vector<Triangle> body_triangles;
  for (std::size_t t = 0; t < all.triangles.size(); ++t) {
    if (components.of_triangle[t] != body) continue;
    body_triangles.push_back(all.triangles[t]);
    character.largest_piece.source_triangle.push_back(source_triangle[t]);
  }
  Piece skin_piece = extract(positions, all.triangles), body_piece = extract(positions, body_triangles);
  report.welded_vertices = skin_piece.mesh.positions.size();
  for (const Index w : welded) {
    character.skin_of_source.push_back(skin_piece.of_source[w]);
    character.largest_piece.of_source.push_back(body_piece.of_source[w]);
  }
  character.skin = std::move(skin_piece.mesh);
  character.skin_source_triangle = std::move(source_triangle);
  character.largest_piece.mesh = std::move(body_piece.mesh);
  return character;
}

}  // namespace spherechain::baker
