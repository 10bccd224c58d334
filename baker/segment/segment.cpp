// SPDX-License-Identifier: GPL-3.0-or-later
#include "segment/segment.h"

#include <algorithm>
#include <map>

#include "mesh/error.h"
#include "mesh/surface_query.h"
#include "segment/limb_cut.h"

namespace spherechain::baker {
namespace {

using Neighbours = std::vector<std::array<Index, 3>>;

// The triangles beyond the plane through the limb's start, in one piece with its tip. Near the plane they must also be no
// farther from the centre line than the section there reaches: armpit and crotch are not crossed.
void label_limb(const Mesh& mesh, const Neighbours& neighbours, const SurfaceQuery& surface, const Limb& limb,
                double radius, double tangent_window, std::uint8_t region, std::vector<std::uint8_t>& labels) {
  const Vec3 point = limb.line.at(0), normal = limb.line.tangent(0, tangent_window);
  const auto beyond = [&](Index t) {
    const Vec3 from_start = triangle_centroid(mesh, t) - point;
    const double along = from_start.dot(normal);
    return along > 0 && (along > 2 * radius || (from_start - along * normal).norm() < 1.1 * radius + 0.5 * along);
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
  regions.frame = plan.frame;
  regions.facing = plan.facing;
  std::array<double, 4> radius{};
  for (std::size_t i = 0; i < plan.limbs.size(); ++i) {
    const Polyline line = centre_in_sections(surface, plan.limbs[i], plan.frame, settings.rays);
    std::string name = kRegionNames[i];
    std::replace(name.begin(), name.end(), '_', ' ');
    const LimbCut cut = find_limb_cut(surface, line, plan.frame, settings.rays, name, character.file);
    radius[i] = cut.radius;
    regions.limbs[i] = {i % 2 == 0, i < 2, line.part(cut.start, line.length()), cut.extremity - cut.start, line.at(0)};
  }

  const Polyline head = centre_in_sections(surface, plan.head, plan.frame, settings.rays);
  std::vector<Vec3> spine = plan.spine.points();
  regions.chest = plan.spine.length();
  regions.neck = regions.chest + find_neck_base(surface, head, plan.frame, settings.rays);
  spine.insert(spine.end(), head.points().begin(), head.points().end());
  regions.spine = Polyline(std::move(spine));

  const Neighbours neighbours = triangle_neighbours(mesh);
  regions.of_triangle.assign(mesh.triangles.size(), kTorso);
  for (std::uint8_t i = 0; i < regions.limbs.size(); ++i) {
    label_limb(mesh, neighbours, surface, regions.limbs[i], radius[i], 0.02 * plan.frame.height, i, regions.of_triangle);
  }
  smooth_loops(neighbours, regions.of_triangle);
  join_islands(mesh, neighbours, regions.of_triangle);
  regions.of_other = label_others(character, surface, regions.of_triangle);
  return regions;
}

}  // namespace spherechain::baker
