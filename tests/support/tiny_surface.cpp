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

void add_vertex(const TinyAsset& tiny, const TinySkin* skin, std::uint32_t v, SurfaceParts& out) {
  const Point p = position_of(tiny, v);
  SurfaceVertex vertex{{p[0], p[1], p[2]},
                       static_cast<std::uint32_t>(out.influences.size()),
                       static_cast<std::uint32_t>(out.morphs.size()),
                       0,
                       0};
  if (skin != nullptr) {
    for (const auto& [bone, weight] : skin->weights[v]) {
      out.influences.push_back({bone, static_cast<float>(weight)});
    }
    for (const auto& [target, delta] : skin->morphs[v]) {
      out.morphs.push_back({target, {delta[0], delta[1], delta[2]}});
    }
    vertex.influence_count = static_cast<std::uint16_t>(skin->weights[v].size());
    vertex.morph_count = static_cast<std::uint16_t>(skin->morphs[v].size());
  }
  out.source_vertices.push_back(v);
  out.welds.push_back(static_cast<std::uint32_t>(out.welds.size()));
  out.vertices.push_back(vertex);
}

// The triangles of the asset have vertices of their own: 3t, 3t + 1, 3t + 2.
void add_leaf(const TinyAsset& tiny, const TinySkin* skin, std::uint32_t sphere, std::uint32_t first,
              std::uint32_t count, SurfaceParts& out) {
  Leaf leaf{sphere,
            first,
            static_cast<std::uint32_t>(out.leaf_vertices.size()),
            static_cast<std::uint32_t>(out.leaf_bones.size()),
            static_cast<std::uint16_t>(count),
            static_cast<std::uint16_t>(3 * count),
            0,
            0};
  std::map<std::uint32_t, bool> bones;
  for (std::uint32_t corner = 0; corner < 3 * count; ++corner) {
    const std::uint32_t v = 3 * tiny.parts.triangles[first + corner / 3] + corner % 3;
    out.leaf_vertices.push_back(static_cast<std::uint32_t>(out.vertices.size()));
    out.corners.push_back(static_cast<std::uint8_t>(corner));
    add_vertex(tiny, skin, v, out);
    for (std::uint32_t i = out.vertices.back().first_influence; i < out.influences.size(); ++i) {
      bones[out.influences[i].bone] = true;
    }
  }
  for (const auto& [bone, used] : bones) {
    out.leaf_bones.push_back(bone);
  }
  leaf.bone_count = static_cast<std::uint16_t>(bones.size());
  out.leaves.push_back(leaf);
}

void add_terms(const SurfaceParts& in, const Leaf& leaf, std::size_t lane, std::map<std::uint32_t, CoverTerm>& terms) {
  std::map<std::uint32_t, std::vector<double>> weights;
  for (std::uint32_t i = 0; i < leaf.vertex_count; ++i) {
    const SurfaceVertex& vertex = in.vertices[in.leaf_vertices[leaf.first_vertex + i]];
    for (std::uint32_t k = 0; k < vertex.influence_count; ++k) {
      const Influence& influence = in.influences[vertex.first_influence + k];
      weights[influence.bone].push_back(influence.weight);
    }
  }
  // Mean weights: they add up to 1 by themselves.
  for (auto& [bone, of_bone] : weights) {
    of_bone.resize(leaf.vertex_count, 0.0);
    double mean = 0, deviation = 0;
    for (const double weight : of_bone) {
      mean += weight / leaf.vertex_count;
    }
    const auto stored = static_cast<float>(mean);
    for (const double weight : of_bone) {
      deviation = std::max(deviation, std::abs(weight - stored));
    }
    terms[bone].weights[lane] = stored;
    terms[bone].deviations[lane] = static_cast<float>(deviation * 1.000001);
  }
}

void add_morphs(const SurfaceParts& in, const Leaf& leaf, std::size_t lane,
                std::map<std::uint32_t, BallLanes>& morphs) {
  std::map<std::uint32_t, std::vector<Point>> deltas;
  for (std::uint32_t i = 0; i < leaf.vertex_count; ++i) {
    const SurfaceVertex& vertex = in.vertices[in.leaf_vertices[leaf.first_vertex + i]];
    for (std::uint32_t k = 0; k < vertex.morph_count; ++k) {
      const MorphDelta& morph = in.morphs[vertex.first_morph + k];
      deltas[morph.target].push_back({morph.delta.x, morph.delta.y, morph.delta.z});
    }
  }
  for (auto& [target, points] : deltas) {
    points.resize(leaf.vertex_count, Point{});
    set_ball(points, lane, morphs[target]);
  }
}

void add_groups(const TinyAsset& tiny, SurfaceParts& out) {
  for (std::size_t first = 0; first < out.leaves.size(); first += kLeafLanes) {
    BallLanes& balls = out.leaf_balls.emplace_back();
    std::map<std::uint32_t, CoverTerm> terms;
    std::map<std::uint32_t, BallLanes> morphs;
    for (std::size_t lane = 0; lane < std::min(kLeafLanes, out.leaves.size() - first); ++lane) {
      const Leaf& leaf = out.leaves[first + lane];
      std::vector<Point> points;
      for (std::uint32_t i = 0; i < leaf.vertex_count; ++i) {
        points.push_back(position_of(tiny, out.source_vertices[out.leaf_vertices[leaf.first_vertex + i]]));
      }
      set_ball(points, lane, balls);
      add_terms(out, leaf, lane, terms);
      add_morphs(out, leaf, lane, morphs);
    }
    if (!out.influences.empty()) {
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
  out.rest_contacts = {{0, tiny.parts.triangle_count - 1}, {1, 2}};
}

}  // namespace spherechain::test
