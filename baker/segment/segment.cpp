// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/segment.h"

#include <algorithm>
#include <map>

#include "mesh/error.h"
#include "mesh/surface_query.h"
#include "segment/limb_trace.h"

namespace spherechain::baker {
namespace {

using Neighbours = std::vector<std::array<Index, 3>>;

// The triangles beyond the plane through the limb's start, in one piece with its tip. Near the plane they must also be no
// farther from the centre line than the section there reaches, and closer to this limb than to another: armpit and crotch
// are not crossed.
void label_limb(const Mesh& mesh, const Neighbours& neighbours, const SurfaceQuery& surface,
                const std::array<LimbTrace, 4>& traces, std::uint8_t region, std::vector<std::uint8_t>& labels) {
  const LimbTrace& limb = traces[region];
  const Vec3 start = limb.line.at(0);
  const auto distance_to = [&](std::size_t i, const Vec3& p) { return (traces[i].line.at(traces[i].line.closest(p)) - p).norm(); };
  const auto beyond = [&](Index t) {
    const Vec3 centroid = triangle_centroid(mesh, t);
    const double along = (centroid - start).dot(limb.direction);
    if (along <= 0) return false;
    if (along > 2 * limb.radius) return true;
    if ((centroid - start - along * limb.direction).norm() > 1.1 * limb.radius + 0.5 * along) return false;
    const double own = distance_to(region, centroid);
    for (std::size_t i = 0; i < traces.size(); ++i) {
      if (i != region && distance_to(i, centroid) < own) return false;
    }
    return true;
  };
  std::vector<Index> stack{surface.closest(limb.line.points().back()).triangle};
  labels[stack.back()] = region;
  while (!stack.empty()) {
    const Index t = stack.back();
    stack.pop_back();
    for (const Index n : neighbours[t]) {
      if (n == kNoIndex || labels[n] != kTorso || !beyond(n)) continue;
      labels[n] = region;
      stack.push_back(n);
    }
  }
}

// A plane cuts through triangles, labels cannot: teeth along the loop go to the side that two of their neighbours are on.
void smooth_loops(const Neighbours& neighbours, std::vector<std::uint8_t>& labels) {
  for (int pass = 0; pass < 8; ++pass) {
    std::vector<std::uint8_t> next = labels;
    for (std::size_t t = 0; t < labels.size(); ++t) {
      std::array<int, kRegionCount> votes{};
      for (const Index n : neighbours[t]) {
        if (n != kNoIndex) ++votes[labels[n]];
      }
      const auto most = std::max_element(votes.begin(), votes.end()) - votes.begin();
      if (votes[static_cast<std::size_t>(most)] >= 2) next[t] = static_cast<std::uint8_t>(most);
    }
    if (next == labels) break;
    labels = std::move(next);
  }
}

// Keeps each region's largest piece; every other piece joins the region it borders on most.
void join_islands(const Mesh& mesh, const Neighbours& neighbours, std::vector<std::uint8_t>& labels) {
  std::vector<Index> piece(labels.size(), kNoIndex);
  std::vector<std::vector<Index>> pieces;
  for (Index seed = 0; seed < labels.size(); ++seed) {
    if (piece[seed] != kNoIndex) continue;
    const auto id = static_cast<Index>(pieces.size());
    pieces.push_back({seed});
    piece[seed] = id;
    for (std::size_t head = 0; head < pieces[id].size(); ++head) {
      for (const Index n : neighbours[pieces[id][head]]) {
        if (n == kNoIndex || piece[n] != kNoIndex || labels[n] != labels[seed]) continue;
        piece[n] = id;
        pieces[id].push_back(n);
      }
    }
  }
  std::array<double, kRegionCount> largest{};
  std::array<Index, kRegionCount> keep{};
  for (Index id = 0; id < pieces.size(); ++id) {
    double area = 0;
    for (const Index t : pieces[id]) area += triangle_area(mesh, t);
    const std::uint8_t region = labels[pieces[id][0]];
    if (area > largest[region]) {
      largest[region] = area;
      keep[region] = id;
    }
  }
  for (Index id = 0; id < pieces.size(); ++id) {
    const std::uint8_t region = labels[pieces[id][0]];
    if (keep[region] == id) continue;
    std::array<int, kRegionCount> votes{};
    for (const Index t : pieces[id]) {
      for (const Index n : neighbours[t]) {
        if (n != kNoIndex && piece[n] != id) ++votes[labels[n]];
      }
    }
    const auto most = static_cast<std::uint8_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
    for (const Index t : pieces[id]) labels[t] = most;
  }
}

std::vector<std::uint8_t> label_others(const Character& character, const SurfaceQuery& surface,
                                       const std::vector<std::uint8_t>& body) {
  const Components pieces = connected_components(character.others);
  std::vector<Vec3> centroid(pieces.count, Vec3::Zero());
  std::vector<double> area(pieces.count, 0.0);
  for (std::size_t t = 0; t < character.others.triangles.size(); ++t) {
    centroid[pieces.of_triangle[t]] += triangle_area(character.others, t) * triangle_centroid(character.others, t);
    area[pieces.of_triangle[t]] += triangle_area(character.others, t);
  }
  std::vector<std::uint8_t> labels;
  for (const Index piece : pieces.of_triangle) {
    labels.push_back(body[surface.closest(centroid[piece] / area[piece]).triangle]);
  }
  return labels;
}

Vec3 in_symmetry_plane(const BodyFrame& frame, const Vec3& p) { return p - (p - frame.origin).dot(frame.left) * frame.left; }

// Arc length of the first point of a rising curve at a height along frame.up.
double arc_at_height(const Polyline& line, const BodyFrame& frame, double height) {
  const double step = 1e-3 * frame.height;
  double s = 0;
  while (s < line.length() && (line.at(s) - frame.origin).dot(frame.up) < height) s += step;
  return std::min(s, line.length());
}

}  // namespace

Regions segment(const Character& character, const SegmentSettings& settings) {
  const Mesh& mesh = character.body;
  if (const std::size_t open = count_open_edges(mesh); open > 0) {
    throw Error(ExitCode::kSegmentation,
                character.file + ": the body is not one closed surface (" + std::to_string(open) +
                    " edges are open or shared by more than two triangles; close its holes)");
  }
  const BodyPlan plan = find_body_plan(mesh, extract_curve_skeleton(mesh), settings.facing, character.file);
  const SurfaceQuery surface(mesh);

  Regions regions;
  regions.facing = plan.facing;
  std::array<LimbTrace, 4> traces;
  for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
    std::string name = kRegionNames[i];
    std::replace(name.begin(), name.end(), '_', ' ');
    traces[i] = trace_limb(surface, plan.limbs[i], plan.frame, settings.rays, name, character.file);
    regions.limbs[i] = {i % 2 == 0, i < 2, traces[i].line, traces[i].extremity, plan.limbs[i].at(0)};
  }
  // Where the limbs start is known better than where the skeleton forks: the torso's axis is taken from there.
  const auto start = [&](std::size_t i) { return regions.limbs[i].line.at(0); };
  const Vec3 chest = 0.5 * (start(0) + start(1)), hip = 0.5 * (start(2) + start(3));
  regions.frame = with_up(plan.frame, chest - hip, mesh);
  regions.hip = in_symmetry_plane(regions.frame, hip);
  regions.chest = in_symmetry_plane(regions.frame, chest);
  regions.torso = find_torso_ends(surface, regions.hip, regions.chest, regions.frame, settings.rays, character.file);
  std::vector<Vec3> spine = plan.spine.points();
  spine.insert(spine.end(), plan.head.points().begin(), plan.head.points().end());
  regions.spine = Polyline(std::move(spine));
  regions.spine_chest = plan.spine.length();
  regions.spine_neck = arc_at_height(regions.spine, regions.frame, regions.torso.neck);

  const Neighbours neighbours = triangle_neighbours(mesh);
  regions.of_triangle.assign(mesh.triangles.size(), kTorso);
  for (std::uint8_t i = 0; i < regions.limbs.size(); ++i) {
    label_limb(mesh, neighbours, surface, traces, i, regions.of_triangle);
  }
  smooth_loops(neighbours, regions.of_triangle);
  join_islands(mesh, neighbours, regions.of_triangle);
  regions.of_other = label_others(character, surface, regions.of_triangle);
  return regions;
}

}  // namespace spherechain::baker
