// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/limb_trace.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "baker/mesh/ring.h"

namespace spherechain::baker {
namespace {

// Fractions of the character's height.
constexpr double kStep = 0.0025;  // between sections
constexpr double kDirectionWindow =
    0.06;  // a section stands across the last part of the line: longer than a joint's crease

// A tail whose sections widen inwards by this much of the way, over their own radius, has come into the trunk: there
// all rays grow alike, and none escapes.
constexpr double kFlare = 0.5;

// A ray this many times the median's length left the section through a gap: a limb's longest radius stays under 1.7
// times the median.
constexpr double kEscaped = 2.0;

bool closed(const Ring& ring) {
  const double limit = kEscaped * ring.median_distance();
  return std::all_of(ring.hits.begin(), ring.hits.end(),
                     [&](const auto& hit) { return hit && hit->distance <= limit; });
}

double mean_distance(const Ring& ring) {
  double sum = 0;
  for (const auto& hit : ring.hits) sum += hit->distance;
  return sum / static_cast<double>(ring.hits.size());
}

double longest_distance(const Ring& ring) {
  double longest = 0;
  for (const auto& hit : ring.hits) longest = std::max(longest, hit->distance);
  return longest;
}

struct Section {
  Vec3 center;
  double mean, longest;
};

bool flares(const std::vector<Section>& inwards, const Section& next) {
  const auto before = std::find_if(inwards.rbegin(), inwards.rend(),
                                   [&](const Section& s) { return (next.center - s.center).norm() >= s.mean; });
  return before != inwards.rend() && next.mean - before->mean > kFlare * (next.center - before->center).norm();
}

class March {
 public:
  March(const SurfaceQuery& surface, const BodyFrame& frame, int rays)
      : surface_(surface),
        frame_(frame),
        step_(kStep * frame.height),
        window_(kDirectionWindow * frame.height),
        rays_(rays) {}

  double step() const { return step_; }

  // Re-centres a section until it stays: nothing where it is not closed.
  std::optional<Section> section(const Vec3& at, const Vec3& direction) const {
    Ring ring = cast(at, direction, rays_);
    for (int pass = 0; pass < 3; ++pass) {
      if (!closed(ring)) return std::nullopt;
      ring = cast(ring.section_centroid(), direction, rays_);
    }
    // A gap opens between two rays first: the limb's end is looked for with more of them.
    if (!closed(cast(ring.center, direction, 4 * rays_))) return std::nullopt;
    return Section{ring.center, mean_distance(ring), longest_distance(ring)};
  }

  // Appends sections from the last one on, each step along the last part of the line, until one is not closed or `stop`
  // says so. The last step is halved until the end is known to a hundredth of a step.
  // A ring of a tube has no end: no line is twice as long as its branch.
  template <typename Stop>
  void run(std::vector<Section>& sections, Vec3 direction, double branch, const Stop& stop) const {
    double length = step_;
    while (length > 0.01 * step_ && static_cast<double>(sections.size()) * step_ < 2 * (branch + window_)) {
      const Vec3 last = sections.back().center;
      const auto earlier = std::find_if(sections.rbegin(), sections.rend(),
                                        [&](const Section& s) { return (last - s.center).norm() >= window_; });
      if (earlier != sections.rend()) direction = (last - earlier->center).normalized();
      const auto next = section(last + length * direction, direction);
      if (next && !stop(*next)) {
        sections.push_back(*next);
      } else {
        length *= 0.5;
      }
    }
  }

 private:
  // Ray 0 lies to the body's left, or to the front of a limb that points there.
  Ring cast(const Vec3& center, const Vec3& direction, int rays) const {
    const bool sideways = std::abs(direction.dot(frame_.left)) > 0.95;
    return cast_ring(surface_, center, direction, sideways ? frame_.forward : frame_.left, rays);
  }

  const SurfaceQuery& surface_;
  const BodyFrame& frame_;
  double step_;
  double window_;
  int rays_;
};

std::vector<Vec3> centers(const std::vector<Section>& sections) {
  std::vector<Vec3> points;
  for (const Section& section : sections) points.push_back(section.center);
  return points;
}

// The middle of the stretch about as narrow as the narrowest section: a minimum this flat has no place of its own.
double narrowest(const Polyline& line, const std::vector<Section>& sections, double from, double to) {
  constexpr double kAlike = 1.04;
  std::vector<double> arc{0};
  for (std::size_t i = 1; i < sections.size(); ++i)
    arc.push_back(arc.back() + (sections[i].center - sections[i - 1].center).norm());
  std::size_t least = sections.size();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    if (arc[i] < from || arc[i] > to) continue;
    if (least == sections.size() || sections[i].mean < sections[least].mean) least = i;
  }
  if (least == sections.size()) return std::min(to, line.length());
  const double limit = kAlike * sections[least].mean;
  const auto crossing = [&](std::size_t inside, std::size_t outside) {
    const double a = sections[inside].mean, b = sections[outside].mean;
    return arc[inside] + (limit - a) / (b - a) * (arc[outside] - arc[inside]);
  };
  std::size_t low = least, high = least;
  while (low > 0 && sections[low - 1].mean <= limit) --low;
  while (high + 1 < sections.size() && sections[high + 1].mean <= limit) ++high;
  const double start = low > 0 ? crossing(low, low - 1) : arc[low];
  const double end = high + 1 < sections.size() ? crossing(high, high + 1) : arc[high];
  return 0.5 * (start + end);
}

// Where a ball on the line first touches the tip: in a round end, its centre; in a point, all but the tip itself.
double last_center(const SurfaceQuery& surface, const Polyline& line, double step) {
  constexpr double kTouches = 0.9;
  double s = 0.5 * line.length();
  while (s < line.length() && surface.closest(line.at(s)).distance < kTouches * (line.length() - s)) s += step;
  return std::min(s, line.length());
}

}  // namespace

Attempt<LimbTrace> trace_limb(const SurfaceQuery& surface, const Polyline& branch, LimbEnd end, const BodyFrame& frame,
                              int rays, const std::string& limb) {
  const March march(surface, frame, rays);
  const double ball = surface.closest(branch.at(0)).distance;
  const double middle = 0.5 * branch.length();
  const Vec3 outward = branch.tangent(middle, 0.5 * kDirectionWindow * frame.height);
  const auto start = march.section(branch.at(middle), outward);
  if (!start) return Reason{"the " + limb + " has no section of its own: it merges with the torso"};

  // Out to hand or foot, then in from there, so that both directions follow a line of sections.
  const auto never = [](const Section&) { return false; };
  std::vector<Section> sections{*start};
  march.run(sections, outward, branch.length(), never);
  std::reverse(sections.begin(), sections.end());
  const bool is_tail = end == LimbEnd::kTip && ball > start->mean;  // and not a body that is one tube
  march.run(sections, -outward, branch.length(), [&](const Section& next) {
    return (next.center - branch.at(0)).norm() < ball || (is_tail && flares(sections, next));
  });
  std::reverse(sections.begin(), sections.end());

  LimbTrace trace;
  // Between two rays of the last section a gap may have opened already: back by a step.
  const Polyline all(centers(sections));
  while (sections.size() > 2 && all.closest(sections.front().center) < march.step()) sections.erase(sections.begin());
  sections.insert(sections.begin(), {all.at(march.step()), sections.front().mean, sections.front().longest});
  const Polyline own(centers(sections));
  trace.direction = own.tangent(0, kDirectionWindow * frame.height);
  trace.radius = sections.front().longest;
  // Wrists were seen at 0.71 and ankles at 0.76 of the way from the cut to the tip; past 0.85 fingers and toes are
  // thinner.
  const double tip = own.length() + (branch.points().back() - own.points().back()).norm();
  trace.extremity =
      end == LimbEnd::kTip ? last_center(surface, own, march.step()) : narrowest(own, sections, 0.5 * tip, 0.85 * tip);

  std::vector<Vec3> points = own.part(0, trace.extremity).points();
  const double from = branch.closest(points.back()) + march.step();
  if (from < branch.length()) {
    const std::vector<Vec3> rest = branch.part(from, branch.length()).points();
    points.insert(points.end(), rest.begin(), rest.end());
  }
  trace.line = Polyline(std::move(points));
  return trace;
}

Attempt<TorsoEnds> find_torso_ends(const SurfaceQuery& surface, const Vec3& hip, const Vec3& chest,
                                   const BodyFrame& frame, int rays) {
  const auto height = [&](const Vec3& p) { return (p - frame.origin).dot(frame.up); };
  TorsoEnds ends{};
  // From well inside: between the legs' starts the skin may be just below.
  const auto floor = surface.first_hit(hip + 0.25 * (chest - hip), -frame.up);
  if (!floor) return Reason{"the torso has no floor between the legs"};
  ends.crotch = height(floor->point);

  // Up from the chest the body's width falls to the neck's and grows again to the head's.
  const double step = kStep * frame.height;
  std::vector<double> widths, heights;
  Vec3 center = chest;
  std::size_t least = 0;
  while (true) {
    const Ring disk = cast_ring(surface, center, frame.up, frame.left, rays);
    const auto half = static_cast<std::size_t>(rays / 2);
    if (!disk.hits[0] || !disk.hits[half]) break;
    const double width = disk.hits[0]->distance + disk.hits[half]->distance;
    // Shoulders may end suddenly; a neck does not: the disk's centre has come into a mouth, or out through the skin.
    if (!widths.empty() && widths[least] < 0.5 * widths[0] && width < 0.7 * widths.back()) break;
    widths.push_back(width);
    heights.push_back(height(center));
    if (widths.back() < widths[least]) least = widths.size() - 1;
    if (widths[least] < 0.5 * widths[0] && widths.back() > 1.15 * widths[least]) break;
    // Sideways the disk stays in the plane of symmetry; front to back it follows the body.
    const double limit = kEscaped * disk.median_distance();
    double front = 0, back = 0;
    for (const auto& hit : disk.hits) {
      if (!hit || hit->distance > limit) continue;
      front = std::max(front, (hit->point - center).dot(frame.forward));
      back = std::min(back, (hit->point - center).dot(frame.forward));
    }
    center += 0.5 * (front + back) * frame.forward + step * frame.up;
  }
  if (widths.empty() || widths[least] >= 0.5 * widths[0]) return Reason{"there is no neck between chest and head"};
  const double limit = 1.5 * widths[least];
  std::size_t base = least;
  while (base > 0 && widths[base] < limit) --base;
  ends.neck = heights[base];
  if (base < least) ends.neck += (widths[base] - limit) / (widths[base] - widths[base + 1]) * step;
  return ends;
}

}  // namespace spherechain::baker
