// SPDX-License-Identifier: MIT
#include "tiny_surface.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace spherechain::test {
namespace {

using Point = std::array<float, 3>;

// Contains the points with room to spare: about the middle of their box.
void set_ball(const std::vector<Point>& points, std::size_t lane, BallLanes& balls) {
  Point low = points[0], high = points[0];
  for (const Point& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  Point center;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = (low[axis] + high[axis]) / 2;
  }
  double radius = 0;
  for (const Point& p : points) {
    radius = std::max(radius, std::hypot(double{p[0]} - center[0], double{p[1]} - center[1], double{p[2]} - center[2]));
  }
  balls.x[lane] = center[0];
  balls.y[lane] = center[1];
  balls.z[lane] = center[2];
  balls.radius[lane] = static_cast<float>(radius * 1.000001);
}

Point position_of(const TinyAsset& tiny, std::uint32_t v) {
  return {tiny.rest[std::size_t{3} * v], tiny.rest[std::size_t{3} * v + 1], tiny.rest[std::size_t{3} * v + 2]};
}

float weight_of(const TinySkin& skin, std::uint32_t v, std::uint32_t bone) {
  double sum = 0;
  for (const auto& [b, weight] : skin.weights[v]) {
    sum += b == bone ? weight : 0;
  }
  return static_cast<float>(sum);
}

// What fills the slots of `sources`, which are a multiple of eight.
void add_slots(const TinyAsset& tiny, const TinySkin* skin, const std::vector<std::uint32_t>& sources, Leaf& leaf,
               SurfaceParts& out) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const std::uint32_t v : sources) {
      out.slot_positions.push_back(position_of(tiny, v)[axis]);
    }
  }
  if (skin == nullptr) {
    return;
  }
  std::map<std::uint32_t, std::vector<SlotMorph>> morphs;
  std::map<std::uint32_t, bool> bones;
  for (std::uint32_t slot = 0; slot < sources.size(); ++slot) {
    for (const auto& [bone, weight] : skin->weights[sources[slot]]) {
      bones[bone] = true;
    }
    for (const auto& [target, delta] : skin->morphs[sources[slot]]) {
      morphs[target].push_back({target, slot, {delta[0], delta[1], delta[2]}});
    }
  }
  for (const auto& [bone, used] : bones) {
    out.leaf_bones.push_back(bone);
    for (const std::uint32_t v : sources) {
      out.slot_weights.push_back(weight_of(*skin, v, bone));
    }
  }
  for (const auto& [target, of_target] : morphs) {
    out.slot_morphs.insert(out.slot_morphs.end(), of_target.begin(), of_target.end());
  }
  leaf.bone_count = static_cast<std::uint16_t>(bones.size());
  leaf.morph_count = static_cast<std::uint32_t>(out.slot_morphs.size()) - leaf.first_morph;
}

// The triangles of the asset have vertices of their own: 3t, 3t + 1, 3t + 2.
void add_leaf(const TinyAsset& tiny, const TinySkin* skin, std::uint32_t sphere, std::uint32_t first,
              std::uint32_t count, SurfaceParts& out) {
  const auto size_of = [](const auto& run) { return static_cast<std::uint32_t>(run.size()); };
  Leaf leaf{};
  leaf.sphere = sphere;
  leaf.first_triangle = first;
  leaf.first_vertex = size_of(out.leaf_vertices);
  leaf.first_bone = size_of(out.leaf_bones);
  leaf.first_slot = size_of(out.slot_positions) / 3;
  leaf.first_weight = size_of(out.slot_weights);
  leaf.first_morph = size_of(out.slot_morphs);
  leaf.triangle_count = static_cast<std::uint16_t>(count);
  leaf.vertex_count = static_cast<std::uint16_t>(3 * count);
  std::vector<std::uint32_t> sources;
  for (std::uint32_t corner = 0; corner < 3 * count; ++corner) {
    sources.push_back(3 * tiny.parts.triangles[first + corner / 3] + corner % 3);
    out.leaf_vertices.push_back(size_of(out.source_vertices));
    out.corners.push_back(static_cast<std::uint8_t>(corner));
    out.welds.push_back(size_of(out.source_vertices));
    out.source_vertices.push_back(sources.back());
  }
  sources.resize(slot_count(leaf), sources.back());
  add_slots(tiny, skin, sources, leaf, out);
  out.leaves.push_back(leaf);
}

// About the middle, which is rounded; with room for the roundings of the extents.
void set_box(const std::vector<Point>& points, std::size_t lane, BoxLanes& out) {
  float* const centers[3] = {out.x, out.y, out.z};
  float* const halves[3] = {out.half_x, out.half_y, out.half_z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto less = [&](const Point& a, const Point& b) { return a[axis] < b[axis]; };
    const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
    const auto center = static_cast<float>((double{(*low)[axis]} + double{(*high)[axis]}) / 2);
    centers[axis][lane] = center;
    const double half = std::max(double{(*high)[axis]} - center, center - double{(*low)[axis]});
    halves[axis][lane] = static_cast<float>(half * 1.000001);
  }
  double radius = 0;
  for (const Point& p : points) {
    radius = std::max(radius,
                      std::hypot(double{p[0]} - out.x[lane], double{p[1]} - out.y[lane], double{p[2]} - out.z[lane]));
  }
  out.radius[lane] = static_cast<float>(radius * 1.000001);
}

// Mean weights: they add up to 1 by themselves.
void add_terms(const SurfaceParts& in, const Leaf& leaf, std::size_t lane, std::map<std::uint32_t, CoverTerm>& terms) {
  for (std::size_t b = 0; b < leaf.bone_count; ++b) {
    const float* weights = &in.slot_weights[leaf.first_weight + b * slot_count(leaf)];
    double mean = 0, deviation = 0;
    for (std::size_t slot = 0; slot < leaf.vertex_count; ++slot) {
      mean += double{weights[slot]} / leaf.vertex_count;
    }
    const auto stored = static_cast<float>(mean);
    for (std::size_t slot = 0; slot < leaf.vertex_count; ++slot) {
      deviation = std::max(deviation, std::abs(double{weights[slot]} - stored));
    }
    CoverTerm& term = terms[in.leaf_bones[leaf.first_bone + b]];
    term.weights[lane] = stored;
    term.deviations[lane] = static_cast<float>(deviation * 1.000001);
  }
}

void add_morphs(const SurfaceParts& in, const Leaf& leaf, std::size_t lane,
                std::map<std::uint32_t, BallLanes>& morphs) {
  std::map<std::uint32_t, std::vector<Point>> deltas;
  for (std::uint32_t i = leaf.first_morph; i < leaf.first_morph + leaf.morph_count; ++i) {
    const SlotMorph& morph = in.slot_morphs[i];
    std::vector<Point>& points = deltas.try_emplace(morph.target, slot_count(leaf), Point{}).first->second;
    points[morph.slot] = {morph.delta.x, morph.delta.y, morph.delta.z};
  }
  for (const auto& [target, points] : deltas) {
    set_ball(points, lane, morphs[target]);
  }
}

void add_groups(const TinyAsset& tiny, SurfaceParts& out) {
  for (std::size_t first = 0; first < out.leaves.size(); first += kLeafLanes) {
    BallLanes& balls = out.leaf_balls.emplace_back();
    BoxLanes& boxes = out.leaf_boxes.emplace_back();
    std::map<std::uint32_t, CoverTerm> terms;
    std::map<std::uint32_t, BallLanes> morphs;
    for (std::size_t lane = 0; lane < std::min(kLeafLanes, out.leaves.size() - first); ++lane) {
      const Leaf& leaf = out.leaves[first + lane];
      std::vector<Point> points;
      for (std::uint32_t i = 0; i < leaf.vertex_count; ++i) {
        points.push_back(position_of(tiny, out.source_vertices[out.leaf_vertices[leaf.first_vertex + i]]));
      }
      set_ball(points, lane, balls);
      set_box(points, lane, boxes);
      add_terms(out, leaf, lane, terms);
      add_morphs(out, leaf, lane, morphs);
    }
    if (!out.slot_weights.empty()) {
      out.cover_term_counts.push_back(static_cast<std::uint32_t>(terms.size()));
    }
    for (const auto& [bone, term] : terms) {
      out.cover_term_bones.push_back(bone);
      out.cover_terms.push_back(term);
    }
    out.cover_morph_counts.push_back(static_cast<std::uint32_t>(morphs.size()));
    for (const auto& [target, ball] : morphs) {
      out.cover_morph_targets.push_back(target);
      out.cover_morphs.push_back(ball);
    }
  }
  if (out.cover_morphs.empty()) {
    out.cover_morph_counts.clear();
  }
}

// Of every second sphere all vertices are points, and nothing is off; of the others at most five, and the vertices'
// shares are a fifth each.
void add_outline(const TinyAsset& tiny, const TinySkin& skin, std::uint32_t s, SurfaceParts& out) {
  const auto size_of = [](const auto& run) { return static_cast<std::uint32_t>(run.size()); };
  Outline outline{};
  while (outline.first_leaf < out.leaves.size() && out.leaves[outline.first_leaf].sphere < s) {
    ++outline.first_leaf;
  }
  outline.first_bone = size_of(out.outline_bones);
  outline.first_point = size_of(out.outline_points) / 3;
  outline.first_weight = size_of(out.outline_weights);
  std::vector<std::uint32_t> vertices;
  std::map<std::uint32_t, bool> bones;
  for (const Leaf& leaf : out.leaves) {
    for (std::uint32_t i = 0; leaf.sphere == s && i < leaf.vertex_count; ++i) {
      vertices.push_back(out.source_vertices[out.leaf_vertices[leaf.first_vertex + i]]);
      for (const auto& [bone, weight] : skin.weights[vertices.back()]) {
        bones[bone] = true;
      }
    }
  }
  if (vertices.empty()) {
    out.outlines.push_back(outline);
    return;
  }
  const bool all = s % 2 == 0;
  std::vector<std::uint32_t> points(vertices.begin(), all ? vertices.end() : vertices.begin() + 5);
  const std::size_t chosen = points.size();
  points.resize((chosen + kOutlineLanes - 1) / kOutlineLanes * kOutlineLanes, points.back());
  const Point center = position_of(tiny, vertices[0]);
  outline.center = {center[0], center[1], center[2]};
  const auto lifted = [&](std::uint32_t v, std::uint32_t bone) {
    const Point p = position_of(tiny, v);
    const double weight = weight_of(skin, v, bone);
    return std::array<double, 4>{weight * (double{p[0]} - center[0]), weight * (double{p[1]} - center[1]),
                                 weight * (double{p[2]} - center[2]), weight};
  };
  double radius = 0, slack = 0;
  std::map<std::uint32_t, std::array<double, 4>> most;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::array<double, 4> sum{};
    for (const auto& [bone, used] : bones) {
      std::array<double, 4> off = lifted(vertices[i], bone);
      for (std::size_t k = 0; k < chosen; ++k) {
        const std::array<double, 4> part = lifted(points[k], bone);
        const double share = all ? (k == i ? 1 : 0) : 1.0 / static_cast<double>(chosen);
        for (std::size_t j = 0; j < 4; ++j) {
          off[j] -= share * part[j];
        }
      }
      for (std::size_t j = 0; j < 4; ++j) {
        most[bone][j] = std::max(most[bone][j], std::abs(off[j]));
        sum[j] += off[j];
      }
    }
    slack = std::max(slack, std::hypot(sum[0], sum[1], sum[2]));
    const Point p = position_of(tiny, vertices[i]);
    radius = std::max(radius, std::hypot(double{p[0]} - center[0], double{p[1]} - center[1], double{p[2]} - center[2]));
  }
  const auto up = [](double value) { return static_cast<float>(value * 1.000001); };
  outline.radius = up(radius);
  outline.slack = up(slack);
  outline.bone_count = static_cast<std::uint16_t>(bones.size());
  outline.point_count = static_cast<std::uint16_t>(points.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const std::uint32_t v : points) {
      out.outline_points.push_back(position_of(tiny, v)[axis]);
    }
  }
  for (const auto& [bone, off] : most) {
    out.outline_bones.push_back({bone, up(off[0]), up(off[1]), up(off[2]), up(off[3])});
    for (const std::uint32_t v : points) {
      out.outline_weights.push_back(weight_of(skin, v, bone));
    }
  }
  out.outlines.push_back(outline);
}

}  // namespace

void add_surface(TinyAsset& tiny, const TinySkin* skin, std::size_t triangles_of_leaf) {
  SurfaceParts& out = tiny.parts.surface;
  for (std::uint32_t s = 0; s < tiny.parts.spheres.size(); ++s) {
    const RestSphere& sphere = tiny.parts.spheres[s];
    for (std::uint32_t first = 0; first < sphere.triangle_count;) {
      const auto count = std::min(static_cast<std::uint32_t>(triangles_of_leaf), sphere.triangle_count - first);
      add_leaf(tiny, skin, s, sphere.first_triangle + first, count, out);
      first += count;
    }
  }
  add_groups(tiny, out);
  for (std::uint32_t s = 0; skin != nullptr && s < tiny.parts.spheres.size(); ++s) {
    add_outline(tiny, *skin, s, out);
  }
  out.rest_contacts = {{0, tiny.parts.triangle_count - 1}, {1, 2}};
}

}  // namespace spherechain::test
