// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/by_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/mesh/surface_query.h"
#include "baker/segment/islands.h"
#include "baker/segment/label_skin.h"
#include "baker/segment/limb_trace.h"
#include "baker/segment/limbed_plan.h"
#include "baker/segment/shortest_loop.h"
#include "baker/segment/trunk.h"

namespace spherechain::baker {
namespace {

// Half the width of the strip around a cut in which the loop may run, as a fraction of the height.
constexpr double kStripHalfWidth = 0.015;

// The triangles beyond the plane through the limb's start, in one piece with its tip. Near the plane they must also be
// no farther from the centre line than the section there reaches, and closer to this limb than to another: armpit and
// crotch are not crossed. The loop is then the shortest in a strip around the plane.
class LimbLabeller {
 public:
  LimbLabeller(const Mesh& mesh, const std::vector<LimbTrace>& traces, double height)
      : mesh_(mesh),
        neighbours_(triangle_neighbours(mesh)),
        traces_(traces),
        torso_(static_cast<std::uint8_t>(traces.size())),
        half_width_(kStripHalfWidth * height) {}

  void label(std::uint8_t region, Index tip, std::vector<std::uint8_t>& labels) const {
    const LimbTrace& limb = traces_[region];
    std::vector<Index> stack{tip};
    labels[tip] = region;
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (const Index n : neighbours_[t]) {
        if (n == kNoIndex || labels[n] != torso_) continue;
        const double along = along_of(limb, n);
        if (along <= 0 || (along <= 2 * limb.radius && !near(region, n, along))) continue;
        labels[n] = region;
        stack.push_back(n);
      }
    }
    std::vector<Index> strip;
    for (Index t = 0; t < labels.size(); ++t) {
      if (labels[t] != region && labels[t] != torso_) continue;
      const double along = along_of(limb, t);
      if (std::abs(along) < half_width_ && near(region, t, std::abs(along))) strip.push_back(t);
    }
    shorten_loop(mesh_, neighbours_, strip, region, torso_, labels);
  }

  const Neighbours& neighbours() const { return neighbours_; }

 private:
  double along_of(const LimbTrace& limb, Index t) const {
    return (triangle_centroid(mesh_, t) - limb.line.at(0)).dot(limb.direction);
  }

  bool near(std::uint8_t region, Index t, double along) const {
    const LimbTrace& limb = traces_[region];
    const Vec3 centroid = triangle_centroid(mesh_, t), from_start = centroid - limb.line.at(0);
    const double across = (from_start - from_start.dot(limb.direction) * limb.direction).norm();
    if (across > 1.1 * limb.radius + 0.5 * along) return false;
    const double own = distance_to(region, centroid);
    for (std::size_t i = 0; i < traces_.size(); ++i) {
      if (i != region && distance_to(i, centroid) < own) return false;
    }
    return true;
  }

  double distance_to(std::size_t limb, const Vec3& p) const {
    const Polyline& line = traces_[limb].line;
    return (line.at(line.closest(p)) - p).norm();
  }

  const Mesh& mesh_;
  Neighbours neighbours_;
  const std::vector<LimbTrace>& traces_;
  std::uint8_t torso_;
  double half_width_;
};

// Keeps each region's largest island; every other one joins the region it borders on most.
void join_islands(const Mesh& mesh, const Neighbours& neighbours, std::size_t regions,
                  std::vector<std::uint8_t>& labels) {
  const Islands islands = find_islands(mesh, neighbours, labels);
  std::vector<double> largest(regions, 0.0);
  std::vector<Index> keep(regions, kNoIndex);
  for (Index id = 0; id < islands.triangles.size(); ++id) {
    const std::uint8_t region = labels[islands.triangles[id][0]];
    if (islands.area[id] > largest[region]) {
      largest[region] = islands.area[id];
      keep[region] = id;
    }
  }
  for (Index id = 0; id < islands.triangles.size(); ++id) {
    const std::uint8_t region = labels[islands.triangles[id][0]];
    if (keep[region] == id) continue;
    std::vector<int> votes(regions, 0);
    for (const Index t : islands.triangles[id]) {
      for (const Index n : neighbours[t]) {
        if (n != kNoIndex && islands.of_triangle[n] != id) ++votes[labels[n]];
      }
    }
    const auto most = static_cast<std::uint8_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
    for (const Index t : islands.triangles[id]) labels[t] = most;
  }
}

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Vec3 in_symmetry_plane(const BodyFrame& frame, const Vec3& p) {
  return p - (p - frame.origin).dot(frame.left) * frame.left;
}

// Arc length of the first point of a rising curve at a height along frame.up.
double arc_at_height(const Polyline& line, const BodyFrame& frame, double height) {
  const double step = 1e-3 * frame.height;
  double s = 0;
  while (s < line.length() && (line.at(s) - frame.origin).dot(frame.up) < height) s += step;
  return std::min(s, line.length());
}

// All but a ball around its centroid: CGAL's skeleton of one may take for ever.
bool is_ball(const Mesh& mesh) {
  constexpr double kRound = 0.7;
  const Vec3 centroid = surface_centroid(mesh);
  double least = std::numeric_limits<double>::max(), most = 0;
  for (const Vec3& p : mesh.positions) {
    least = std::min(least, (p - centroid).norm());
    most = std::max(most, (p - centroid).norm());
  }
  return least > kRound * most;
}

// A biped, any number of limbs, or what is missing of a biped.
Attempt<BodyPlan> find_plan(const Mesh& mesh, const SegmentSettings& settings) {
  if (is_ball(mesh)) return Reason{"the shape is a ball: arms and legs are missing"};
  const CurveSkeleton skeleton = extract_curve_skeleton(mesh);
  const bool automatic = settings.body == BodyKind::kUnknown;
  if (settings.body == BodyKind::kBiped || (automatic && looks_like_biped(skeleton))) {
    return find_biped_plan(mesh, skeleton, settings.facing);
  }
  Attempt<BodyPlan> limbed = find_limbed_plan(mesh, skeleton, !automatic, settings.facing);
  if (limbed || limbed.reason().cause == Reason::Cause::kSettings) return limbed;
  // Most characters are bipeds: the limb that a biped would need is the better reason.
  if (automatic && count_ends(skeleton) <= 5) return find_biped_plan(mesh, skeleton, settings.facing);
  return limbed;
}

// Where the limbs start is known better than where the skeleton forks: the torso's axis is taken from there.
void place_torso(Regions& regions, const BodyPlan& plan, const Mesh& mesh) {
  Vec3 hip = middle_of_starts(regions, 0, plan.spine.points().front());
  Vec3 chest = middle_of_starts(regions, 1, plan.spine.points().back());
  if (plan.limbs.size() > 4) place_along(regions, hip, chest);
  regions.frame = with_up(plan.frame, chest - hip, mesh);
  regions.hip = in_symmetry_plane(regions.frame, hip);
  regions.chest = in_symmetry_plane(regions.frame, chest);
  std::vector<Vec3> spine = plan.spine.points();
  spine.insert(spine.end(), plan.head.points().begin(), plan.head.points().end());
  regions.spine = Polyline(std::move(spine));
  regions.spine_chest = plan.spine.length();
}

Attempt<TorsoEnds> find_ends(Regions& regions, const BodyPlan& plan, const Mesh& mesh, const SurfaceQuery& surface,
                             int rays) {
  if (is_biped(regions)) return find_torso_ends(surface, regions.hip, regions.chest, regions.frame, rays);
  const SurfaceQuery trunk(mesh, triangles_of_region(regions, regions.torso_region()));
  regions.hip = middle_of_trunk(trunk, regions.frame, regions.hip);
  regions.chest = middle_of_trunk(trunk, regions.frame, regions.chest);
  // The neck leaves the trunk's maximal ball at the chest.
  const double ball = surface.closest(plan.spine.points().back()).distance;
  const bool has_head = plan.head.length() > ball;
  const Vec3 neck = has_head ? plan.head.at(ball) : regions.chest;
  return ends_by_skin(mesh, regions, has_head ? &neck : nullptr);
}

}  // namespace

Attempt<Regions> segment_by_shape(const Character& character, const BodyMesh& body, const SegmentSettings& settings) {
  const Mesh& mesh = body.mesh;
  if (const std::size_t open = count_open_edges(mesh); open > 0) {
    return Reason{"the body is not one closed surface (" + std::to_string(open) +
                  " edges are open or shared by more than two triangles; close its holes)"};
  }
  const Attempt<BodyPlan> found = find_plan(mesh, settings);
  if (!found) return found.reason();
  const BodyPlan& plan = *found;
  const SurfaceQuery surface(mesh);

  Regions regions;
  regions.provider = "shape";
  regions.facing = plan.facing;
  regions.has_torso = !plan.spine.points().empty();
  std::vector<LimbTrace> traces;
  for (const BodyPlan::Limb& limb : plan.limbs) {
    Attempt<LimbTrace> trace = trace_limb(surface, limb.line, limb.end, plan.frame, settings.rays, in_words(limb.name));
    if (!trace) return trace.reason();
    regions.limbs.push_back({limb.name, limb.side, limb.along, trace->line, trace->extremity});
    traces.push_back(std::move(*trace));
  }
  regions.of_triangle.assign(mesh.triangles.size(), regions.has_torso ? regions.torso_region() : std::uint8_t{0});
  if (regions.has_torso) {
    place_torso(regions, plan, mesh);
    const LimbLabeller labeller(mesh, traces, regions.frame.height);
    for (std::uint8_t i = 0; i < regions.limbs.size(); ++i) {
      labeller.label(i, surface.closest(regions.limbs[i].line.points().back()).triangle, regions.of_triangle);
    }
    join_islands(mesh, labeller.neighbours(), regions.count(), regions.of_triangle);
    const Attempt<TorsoEnds> ends = find_ends(regions, plan, mesh, surface, settings.rays);
    if (!ends) return ends.reason();
    regions.torso = *ends;
    regions.spine_neck = arc_at_height(regions.spine, regions.frame, regions.torso.neck);
  } else {
    regions.frame = plan.frame;
  }
  regions.of_skin = label_skin(character, body, surface, regions.of_triangle);
  regions.body = body;
  return regions;
}

}  // namespace spherechain::baker
