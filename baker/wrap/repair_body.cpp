// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/wrap/repair_body.h"

#include <utility>

#include "baker/wrap/close_cracks.h"
#include "baker/wrap/largest_piece.h"
#include "baker/wrap/stitch.h"
#include "baker/wrap/stopwatch.h"

namespace spherechain::baker {
namespace {

double volume(const Mesh& mesh) {
  const Vec3 origin = mesh.positions[0];
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]] - origin, b = mesh.positions[t[1]] - origin, c = mesh.positions[t[2]] - origin;
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

}  // namespace

bool covers_skin(const BodyMesh& body, const Mesh& skin) {
  constexpr double kAll = 0.98;
  return surface_area(body.mesh) > kAll * surface_area(skin);
}

double crack_width(const Mesh& skin) {
  // Share of the diameter: rounding by exporters and single precision separates equal vertices by less.
  constexpr double kCrack = 1e-4;
  return kCrack * diameter(skin);
}

Attempt<BodyMesh> repair_body(const Character& character, ClosingReport& report) {
  const Stopwatch stopwatch(report.seconds);
  const Mesh& skin = character.skin;
  const Uncracked uncracked = close_cracks(skin, crack_width(skin));
  const Stitched stitched = stitch(uncracked.mesh);
  report.welded = uncracked.welded;
  report.t_junctions = uncracked.t_junctions;
  report.turned = stitched.turned;
  report.parted = stitched.parted;
  report.holes = stitched.holes;

  LargestPiece piece = largest_piece(stitched.mesh);
  double area = 0;
  std::vector<Index> source_triangle;
  for (std::size_t t = 0; t < piece.of_triangle.size(); ++t) {
    const Index of_uncracked = stitched.of_triangle[piece.of_triangle[t]];
    const bool fan = of_uncracked == kNoIndex;
    source_triangle.push_back(fan ? kNoIndex : character.skin_source_triangle[uncracked.of_triangle[of_uncracked]]);
    if (!fan) area += triangle_area(piece.mesh, t);
  }
  if (count_open_edges(piece.mesh) > 0) return Reason{"its holes and cracks cannot all be closed"};
  if (area <= kBodyShareMin * surface_area(skin)) return Reason{"it is of many pieces, none of which is most of it"};
  if (volume(piece.mesh) < 0) {
    for (Triangle& t : piece.mesh.triangles) std::swap(t[1], t[2]);
  }
  std::vector<Index> of_skin(skin.positions.size(), kNoIndex);
  for (Index v = 0; v < piece.of_vertex.size(); ++v) {
    const Index welded = stitched.of_vertex[piece.of_vertex[v]];
    if (welded != kNoIndex && of_skin[welded] == kNoIndex) of_skin[welded] = v;
  }
  BodyMesh body{std::move(piece.mesh), std::move(source_triangle), {}};
  for (const Index on_skin : character.skin_of_source) {
    body.of_source.push_back(on_skin == kNoIndex ? kNoIndex : of_skin[uncracked.welded_to[on_skin]]);
  }
  report.body = BodySource::kRepaired;
  return body;
}

}  // namespace spherechain::baker
