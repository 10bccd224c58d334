// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/wrap/wrap_skin.h"

#include <algorithm>
#include <cmath>

#include "baker/mesh/surface_query.h"
#include "baker/wrap/alpha_wrap.h"
#include "baker/wrap/close_cracks.h"
#include "baker/wrap/largest_piece.h"
#include "baker/wrap/repair_body.h"
#include "baker/wrap/stitch.h"
#include "baker/wrap/stopwatch.h"

namespace spherechain::baker {
namespace {

// A wrap's offset, as a fraction of alpha, and the part of it that is left: with none, opposite sides of thin parts
// would coincide.
constexpr double kOffset = 0.05;
constexpr double kOffsetLeft = 0.1;

// Behind thin parts of a wrap there is its other side: cloth, or the wrap has got in and lines the skin.
double thin_share(const Mesh& wrap, double offset) {
  const SurfaceQuery surface(wrap);
  double thin = 0, all = 0;
  for (std::size_t t = 0; t < wrap.triangles.size(); ++t) {
    const double area = triangle_area(wrap, t);
    all += area;
    const Vec3 inwards = -triangle_cross(wrap, t).normalized();
    const auto hit = surface.first_hit(triangle_centroid(wrap, t) + 1e-3 * offset * inwards, inwards);
    if (hit && hit->distance < 3 * offset) thin += area;
  }
  return all > 0 ? thin / all : 1;
}

}  // namespace

bool Wrap::lines_skin() const {
  constexpr double kThinMax = 0.3;
  return thin > kThinMax;
}

Attempt<Wrap> wrap_skin(const Mesh& skin, const WrapSize& size, ClosingReport& report) {
  const Stopwatch stopwatch(report.seconds);
  ++report.wraps;
  const Mesh& inside = size.holes_first ? stitch(close_cracks(skin, crack_width(skin)).mesh).mesh : skin;
  const double alpha = diameter(skin) / size.fineness, offset = kOffset * alpha;
  Wrap wrap{largest_piece(alpha_wrap(inside, alpha, offset)).mesh, size, 0};
  if (wrap.surface.triangles.empty()) return Reason{"its triangles are lines, all of them"};
  if (wrap.surface.triangles.size() > kWrapTrianglesMax) {
    return Reason{"it would be of more triangles than a character"};
  }
  wrap.thin = thin_share(wrap.surface, offset);
  const SurfaceQuery query(inside);
  for (Vec3& p : wrap.surface.positions) {
    const SurfaceHit nearest = query.closest(p);
    if (nearest.distance < 2 * offset) p += (1 - kOffsetLeft) * (nearest.point - p);
  }
  return wrap;
}

BodyMesh body_of(const Wrap& wrap, const Character& character) {
  return {wrap.surface, std::vector<Index>(wrap.surface.triangles.size(), kNoIndex),
          std::vector<Index>(character.source_positions.size(), kNoIndex)};
}

void report_wrap(const Wrap& wrap, ClosingReport& report) {
  report.body = BodySource::kWrapped;
  report.alpha = 1 / wrap.size.fineness;
  report.offset = kOffset / wrap.size.fineness;
  report.thin = wrap.thin;
  report.holes_first = wrap.size.holes_first;
  report.triangles = wrap.surface.triangles.size();
}

}  // namespace spherechain::baker
