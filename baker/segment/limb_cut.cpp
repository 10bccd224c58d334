// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/limb_cut.h"

#include <algorithm>
#include <limits>

#include "mesh/error.h"
#include "mesh/ring.h"

namespace spherechain::baker {
namespace {

// Fractions of the character's height.
constexpr double kLineSpacing = 0.01;
constexpr double kScanStep = 0.0025;
constexpr double kTangentWindow = 0.02;

// A ray this many times the median's length left the section through a gap: a section's longest radius is under 1.7 times
// the median even across a palm or a shoulder.
constexpr double kEscaped = 2.0;

Ring section(const SurfaceQuery& surface, const Polyline& line, double s, const BodyFrame& frame, int rays) {
  // Any vector that turns with the body serves; this one is parallel to no limb of a standing or T-posed figure.
  const Vec3 reference = frame.up + 0.7 * frame.left + 0.3 * frame.forward;
  return cast_ring(surface, line.at(s), line.tangent(s, kTangentWindow * frame.height), reference, rays);
}

double escaped_fraction(const Ring& ring) {
  const double limit = kEscaped * ring.median_distance();
  const auto escaped = std::count_if(ring.hits.begin(), ring.hits.end(),
                                     [&](const auto& hit) { return !hit || hit->distance > limit; });
  return static_cast<double>(escaped) / static_cast<double>(ring.hits.size());
}

double mean_distance(const Ring& ring) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& hit : ring.hits) {
    if (!hit) continue;
    sum += hit->distance;
    ++count;
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

}  // namespace

Polyline centre_in_sections(const SurfaceQuery& surface, const Polyline& branch, const BodyFrame& frame, int rays) {
  Polyline line = branch.resampled(kLineSpacing * frame.height);
  // Each pass turns the sections to the line the last one found; four leave less than a millimetre of change on a man.
  for (int pass = 0; pass < 4; ++pass) {
    std::vector<Vec3> points = line.points();
    const double spacing = line.length() / static_cast<double>(points.size() - 1);
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const Ring ring = section(surface, line, spacing * static_cast<double>(i), frame, rays);
      if (escaped_fraction(ring) == 0) points[i] = ring.section_centroid();
    }
    std::vector<Vec3> smooth = points;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) smooth[i] = 0.25 * (points[i - 1] + 2 * points[i] + points[i + 1]);
    line = Polyline(std::move(smooth)).resampled(kLineSpacing * frame.height);
  }
  return line;
}

LimbCut find_limb_cut(const SurfaceQuery& surface, const Polyline& line, const BodyFrame& frame, int rays,
                      const std::string& limb, const std::string& file) {
  const double ball = surface.closest(line.at(0)).distance;
  const double step = kScanStep * frame.height;
  const double middle = 0.5 * line.length();
  double start = middle;
  while (start - step > 0 && (line.at(start - step) - line.at(0)).norm() > ball &&
         escaped_fraction(section(surface, line, start - step, frame, rays)) == 0) {
    start -= step;
  }
  if (start == middle) {
    throw Error(ExitCode::kSegmentation, file + ": the " + limb + " has no section of its own: it merges with the torso");
  }
  // One step back: between two rays of the last section a gap may have opened already.
  start += step;
  double radius = 0;
  for (const auto& hit : section(surface, line, start, frame, rays).hits) radius = std::max(radius, hit ? hit->distance : 0);
  const double rest = line.length() - start;
  // Wrists were seen at 0.71 and ankles at 0.76 of the way from the cut to the tip; past 0.85 fingers and toes are thinner.
  return {start, radius, narrowest_section(surface, line, start + 0.5 * rest, start + 0.85 * rest, frame, rays)};
}

double find_neck_base(const SurfaceQuery& surface, const Polyline& head, const BodyFrame& frame, int rays) {
  // The skull is wider than the neck, and a skeleton's last part wanders towards the face.
  double s = narrowest_section(surface, head, 0.3 * head.length(), 0.7 * head.length(), frame, rays);
  const double limit = 1.5 * mean_distance(section(surface, head, s, frame, rays));
  const double step = kScanStep * frame.height;
  while (s > step) {
    const Ring below = section(surface, head, s - step, frame, rays);
    if (mean_distance(below) > limit) break;
    s -= step;
  }
  return s;
}

double narrowest_section(const SurfaceQuery& surface, const Polyline& line, double from, double to,
                         const BodyFrame& frame, int rays) {
  double best = std::numeric_limits<double>::max(), where = from;
  for (double s = from; s <= to; s += kScanStep * frame.height) {
    const Ring ring = section(surface, line, s, frame, rays);
    const double mean = mean_distance(ring);
    if (escaped_fraction(ring) <= 0.05 && mean < best) {
      best = mean;
      where = s;
    }
  }
  return where;
}

}  // namespace spherechain::baker
