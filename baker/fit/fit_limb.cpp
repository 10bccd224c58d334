// SPDX-License-Identifier: GPL-3.0-or-later
// The marching circumference of section 3.1: a ring of rays moves along the limb and a sphere is placed where it
// overlaps the last one by PD.
#include <algorithm>

#include "baker/fit/fit.h"
#include "baker/fit/march.h"
#include "baker/mesh/ring.h"

namespace spherechain::baker {
namespace {

constexpr double kSkinShareGood = 0.95, kSkinShareMin = 0.6;  // of the rays
// Share of the limb's thickest sphere: at a tail's tip, spheres would shrink without end.
constexpr double kThinEnd = 0.2;
constexpr std::size_t kLimbSpheresMax = 100;

class LimbMarch {
 public:
  LimbMarch(const Mesh& mesh, const SurfaceQuery& body, const Regions& regions, std::uint8_t region,
            const FitSettings& settings)
      : body_(body),
        skin_(mesh, triangles_of_region(regions, region)),
        regions_(regions),
        region_(region),
        line_(regions.limbs[region].line),
        window_(0.02 * regions.frame.height),
        rays_(settings.rays) {}

  // The share of the rays that meet the limb's own skin.
  double own_share(double s) const {
    const Ring ring = cast(s);
    const auto own = std::count_if(ring.hits.begin(), ring.hits.end(), [&](const auto& hit) {
      return hit && regions_.of_triangle[hit->triangle] == region_;
    });
    return static_cast<double>(own) / static_cast<double>(ring.hits.size());
  }

  // The largest sphere around a point of the ring's plane that does not leave the skin: it touches.
  Ball sphere_at(double s) const {
    const Ring ring = cast(s);
    const Vec3 middle = ring.section_centroid();
    Vec3 center = middle;
    // Where the limb's own skin is open, the way out has no end: the section's does.
    const double reach = ring.median_distance();
    // Skin that was closest before tells of most candidates that they are no farther from the skin.
    std::vector<Vec3> near;
    const auto distance_from_skin = [&](const Vec3& p) {
      const SurfaceHit hit = skin_.closest(p);
      near.push_back(hit.point);
      return hit.distance;
    };
    double radius = distance_from_skin(center);
    // A compass search: the distance to the skin has one maximum in a section as round as a limb's.
    for (double step = 0.25 * radius; step > 1e-4 * radius;) {
      bool moved = false;
      for (const Vec3& direction : {ring.u, ring.v, Vec3(-ring.u), Vec3(-ring.v)}) {
        const Vec3 candidate = center + step * direction;
        if ((candidate - middle).norm() > reach) continue;
        const auto is_near = [&](const Vec3& p) { return (candidate - p).norm() <= radius; };
        if (std::any_of(near.rbegin(), near.rend(), is_near)) continue;
        const double distance = distance_from_skin(candidate);
        if (distance > radius) {
          center = candidate;
          radius = distance;
          moved = true;
          break;
        }
      }
      if (!moved) step *= 0.5;
    }
    return {center, radius};
  }

  Vec3 axis(double s) const { return line_.tangent(s, window_); }

 private:
  Ring cast(double s) const {
    const Vec3 reference = regions_.frame.up + 0.7 * regions_.frame.left + 0.3 * regions_.frame.forward;
    return cast_ring(body_, line_.at(s), axis(s), reference, rays_);
  }

  const SurfaceQuery& body_;
  SurfaceQuery skin_;
  const Regions& regions_;
  std::uint8_t region_;
  const Polyline& line_;
  double window_;
  int rays_;
};

}  // namespace

Attempt<std::vector<FittedSphere>> fit_limb(const Mesh& mesh, const SurfaceQuery& body, const Regions& regions,
                                            std::uint8_t region, const FitSettings& settings) {
  if (triangles_of_region(regions, region).empty()) return Reason{"the " + regions.name(region) + " has no skin"};
  const LimbMarch march(mesh, body, regions, region, settings);
  const double end = regions.limbs[region].extremity, step = settings.limb_step * regions.frame.height;

  // The first ring on the limb's own skin; a few large triangles with a border of teeth may have none, and then the
  // ring that has most of it.
  double s = 0, most = 0;
  const double thin = kThinEnd * march.sphere_at(0.5 * end).radius;
  for (double at = 0; at < end && most < kSkinShareGood; at += step) {
    const double share = march.sphere_at(at).radius < thin ? 0 : march.own_share(at);
    if (share <= most) continue;
    most = share;
    s = at;
  }
  if (most < kSkinShareMin) {
    return Reason{"no section of the " + regions.name(region) + " is closed by its own skin"};
  }
  std::vector<FittedSphere> spheres;
  const auto place = [&](double at, const Ball& ball) {
    spheres.push_back({ball, region, -1, Side::kNone, march.axis(at), false});
  };
  Ball last = march.sphere_at(s);
  place(s, last);
  double thickest = last.radius;
  const auto far_enough = [&](double at) {
    return penetration_depth(last, march.sphere_at(at)) <= settings.penetration_depth;
  };
  while (const auto next = first_where(s, end, step, far_enough)) {
    s = *next;
    last = march.sphere_at(s);
    if (last.radius < kThinEnd * thickest) return spheres;
    thickest = std::max(thickest, last.radius);
    place(s, last);
    if (spheres.size() > kLimbSpheresMax) {
      return Reason{"the " + regions.name(region) + " is so thin that it takes more than " +
                    std::to_string(kLimbSpheresMax) + " spheres"};
    }
  }
  // The closing pair overlaps by whatever is left.
  if (march.own_share(end) < kSkinShareMin) return spheres;
  const Ball closing = march.sphere_at(end);
  if (closing.radius >= kThinEnd * thickest && penetration_depth(last, closing) < kClosingDepth) place(end, closing);
  return spheres;
}

}  // namespace spherechain::baker
