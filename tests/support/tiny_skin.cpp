// SPDX-License-Identifier: MIT
#include "tiny_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace spherechain::test {
namespace {

using Point = std::array<float, 3>;

float rounded_up(double value) { return static_cast<float>(value * 1.000001); }

// A box along the axes, by its middle, which is rounded, and what is in it; with room for roundings.
struct Around {
  explicit Around(const std::vector<Point>& points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto less = [&](const Point& a, const Point& b) { return a[axis] < b[axis]; };
      const auto [low, high] = std::minmax_element(points.begin(), points.end(), less);
      center[axis] = static_cast<float>((double{(*low)[axis]} + double{(*high)[axis]}) / 2);
      half[axis] = rounded_up(
          std::max(double{(*high)[axis]} - double{center[axis]}, double{center[axis]} - double{(*low)[axis]}));
    }
    double farthest = 0;
    for (const Point& p : points) {
      farthest = std::max(farthest, std::hypot(double{p[0]} - double{center[0]}, double{p[1]} - double{center[1]},
                                               double{p[2]} - double{center[2]}));
    }
    radius = rounded_up(farthest);
  }
  Point center{}, half{};
  float radius = 0;
};

// A vertex of the packed skin.
struct Vertex {
  std::uint32_t source;
  Point position;
  std::map<std::uint32_t, float> weights;  // by bone
  std::map<std::uint32_t, Point> morphs;   // by target
};

class Packer {
 public:
  Packer(TinyAsset& tiny, const TinySkin* skin) : tiny_(tiny), skin_(skin), out_(tiny.parts.skin) {}

  void run(std::size_t triangles_of_cluster) {
    out_ = {};
    pack_vertices();
    for (std::size_t s = 0; s < tiny_.triangles.size(); ++s) {
      const Numbers& own = tiny_.triangles[s];
      tiny_.parts.spheres[s].triangle_count = static_cast<std::uint32_t>(own.size());
      const std::size_t first_cluster = out_.clusters.size();
      for (std::size_t first = 0; first < own.size(); first += triangles_of_cluster) {
        const std::size_t count = std::min(triangles_of_cluster, own.size() - first);
        pack_cluster({own.begin() + static_cast<std::ptrdiff_t>(first),
                      own.begin() + static_cast<std::ptrdiff_t>(first + count)});
      }
      if (skin_ != nullptr) {
        pack_hull(s, first_cluster);
      }
    }
    pack_groups();
    pack_layers();
    out_.rest_contacts = {0, tiny_.parts.triangle_count - 1, 1, 2};
  }

 private:
  Vertex vertex_of(std::uint32_t source) const {
    Vertex vertex{source, {tiny_.rest[3 * source], tiny_.rest[3 * source + 1], tiny_.rest[3 * source + 2]}, {}, {}};
    if (skin_ != nullptr) {
      for (const auto& [bone, weight] : skin_->weights[source]) {
        vertex.weights[bone] = static_cast<float>(weight);
      }
      vertex.morphs.insert(skin_->morphs[source].begin(), skin_->morphs[source].end());
    }
    return vertex;
  }

  // Keeps the vertices that triangles use: the lowest of those with the same position and motion.
  void pack_vertices() {
    std::set<std::uint32_t> used;
    for (const Numbers& own : tiny_.triangles) {
      for (const std::uint32_t t : own) {
        used.insert(tiny_.corners[t].begin(), tiny_.corners[t].end());
      }
    }
    std::map<Point, std::uint32_t> lowest;
    for (const std::uint32_t source : used) {
      Vertex vertex = vertex_of(source);
      const auto twin = std::find_if(vertices_.begin(), vertices_.end(), [&](const Vertex& v) {
        return v.position == vertex.position && v.weights == vertex.weights && v.morphs == vertex.morphs;
      });
      const auto number = static_cast<std::uint32_t>(twin - vertices_.begin());
      number_of_[source] = number;
      if (twin != vertices_.end()) {
        continue;
      }
      pack_vertex(vertex);
      if (const auto [weld, is_first] = lowest.emplace(vertex.position, number); !is_first) {
        out_.welds.insert(out_.welds.end(), {number, weld->second});
      }
      vertices_.push_back(std::move(vertex));
    }
    out_.vertex_count = static_cast<std::uint32_t>(vertices_.size());
    if (out_.morphs.empty()) {
      out_.morph_counts.clear();
    }
  }

  // The greatest weight comes first, and is left out where it is what the others leave of 1.
  void pack_vertex(const Vertex& vertex) {
    out_.sources.push_back(vertex.source);
    out_.positions.insert(out_.positions.end(), vertex.position.begin(), vertex.position.end());
    const auto greatest = std::max_element(vertex.weights.begin(), vertex.weights.end(),
                                           [](const auto& l, const auto& r) { return l.second < r.second; });
    float others = 0;
    for (auto entry = vertex.weights.begin(); entry != vertex.weights.end(); ++entry) {
      others += entry == greatest ? 0 : entry->second;
    }
    const bool leaves_out = greatest != vertex.weights.end() && 1 - others == greatest->second;
    out_.influence_counts.push_back(
        static_cast<std::uint8_t>(vertex.weights.size() | (leaves_out ? kOneWeightLeftOut : 0U)));
    if (greatest != vertex.weights.end()) {
      out_.influence_bones.push_back(greatest->first);
    }
    if (greatest != vertex.weights.end() && !leaves_out) {
      out_.influence_weights.push_back(greatest->second);
    }
    for (auto entry = vertex.weights.begin(); entry != vertex.weights.end(); ++entry) {
      if (entry != greatest) {
        out_.influence_bones.push_back(entry->first);
        out_.influence_weights.push_back(entry->second);
      }
    }
    out_.morph_counts.push_back(static_cast<std::uint16_t>(vertex.morphs.size()));
    for (const auto& [target, delta] : vertex.morphs) {
      out_.morphs.push_back({target, {delta[0], delta[1], delta[2]}});
    }
  }

  // Some clusters, and pairs of them, are layers.
  static std::uint8_t is_buried(std::size_t cluster) { return cluster % 11 == 5 ? 1 : 0; }
  void pack_layers() {
    for (std::uint32_t a = 0; a < out_.clusters.size(); ++a) {
      for (std::uint32_t b = a + 1 + a % 3; b < out_.clusters.size(); b += 3) {
        out_.layer_pairs.insert(out_.layer_pairs.end(), {a, b});
      }
    }
    out_.pieces = {{"band", 2.0F}, {"cloth", 0.0F}};
    for (std::uint32_t c = 0; c < out_.clusters.size(); ++c) out_.covers.push_back(c % 3);
    out_.cover_distances.assign(out_.clusters.size(), 0.25F);
    out_.layer_runs = {0};
    out_.layer_run_ends = {static_cast<std::uint32_t>(out_.triangles.size())};
    out_.windings.assign(3 * tiny_.parts.spheres.size(), 0);
    out_.core_triangles.assign(kCorePoints * tiny_.parts.parts.size(), 0);
    out_.core_windings.assign(3 * out_.core_triangles.size(), 0);
  }

  void pack_cluster(const Numbers& triangles) {
    std::set<std::uint32_t> vertices;
    for (const std::uint32_t t : triangles) {
      for (const std::uint32_t source : tiny_.corners[t]) {
        vertices.insert(number_of_[source]);
      }
    }
    for (const std::uint32_t t : triangles) {
      out_.triangles.push_back(t);
      for (const std::uint32_t source : tiny_.corners[t]) {
        const auto slot = std::distance(vertices.begin(), vertices.find(number_of_[source]));
        out_.corners.push_back(static_cast<std::uint8_t>(slot));
      }
      if (out_.part_runs.empty() || out_.part_runs.back() != tiny_.part_of_triangle[t]) {
        out_.part_runs.push_back(tiny_.part_of_triangle[t]);
        out_.part_run_ends.push_back(0);
      }
      out_.part_run_ends.back() = static_cast<std::uint32_t>(out_.triangles.size());
    }
    std::set<std::uint32_t> bones;
    for (const std::uint32_t v : vertices) {
      for (const auto& [bone, weight] : vertices_[v].weights) {
        bones.insert(bone);
      }
    }
    out_.clusters.push_back({static_cast<std::uint8_t>(triangles.size()), static_cast<std::uint8_t>(vertices.size()),
                             static_cast<std::uint16_t>(bones.size()), is_buried(out_.clusters.size()), 0});
    out_.cluster_vertices.insert(out_.cluster_vertices.end(), vertices.begin(), vertices.end());
    out_.cluster_bones.insert(out_.cluster_bones.end(), bones.begin(), bones.end());
    members_.emplace_back(vertices.begin(), vertices.end());
  }

  float weight_of(std::uint32_t vertex, std::uint32_t bone) const {
    const auto found = vertices_[vertex].weights.find(bone);
    return found == vertices_[vertex].weights.end() ? 0 : found->second;
  }

  // For every second sphere, all vertices are hull points and nothing is off. The others have at most five points, and
  // each vertex has equal shares in them, which add up to 1.
  void pack_hull(std::size_t sphere, std::size_t first_cluster) {
    std::set<std::uint32_t> all, bones;
    for (std::size_t c = first_cluster; c < members_.size(); ++c) {
      all.insert(members_[c].begin(), members_[c].end());
    }
    if (all.empty()) {
      out_.hulls.push_back({});
      return;
    }
    for (const std::uint32_t v : all) {
      for (const auto& [bone, weight] : vertices_[v].weights) {
        bones.insert(bone);
      }
    }
    Numbers points(all.begin(), all.end());
    const bool has_all = sphere % 2 == 0;
    points.resize(has_all ? points.size() : std::min<std::size_t>(points.size(), 5));
    const Point center = vertices_[points[0]].position;
    const auto lifted = [&](std::uint32_t v, std::uint32_t bone) {
      const double weight = weight_of(v, bone);
      std::array<double, 4> out{0, 0, 0, weight};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out[axis] = weight * (double{vertices_[v].position[axis]} - double{center[axis]});
      }
      return out;
    };
    double radius = 0, slack = 0;
    std::map<std::uint32_t, std::array<double, 4>> offsets;
    for (const std::uint32_t v : all) {
      std::array<double, 4> sum{};
      for (const std::uint32_t bone : bones) {
        std::array<double, 4> off = lifted(v, bone);
        for (const std::uint32_t point : points) {
          const double share = has_all ? (point == v ? 1 : 0) : 1.0 / static_cast<double>(points.size());
          for (std::size_t j = 0; j < 4; ++j) {
            off[j] -= share * lifted(point, bone)[j];
          }
        }
        for (std::size_t j = 0; j < 4; ++j) {
          offsets[bone][j] = std::max(offsets[bone][j], std::abs(off[j]));
          sum[j] += off[j];
        }
      }
      slack = std::max(slack, std::hypot(sum[0], sum[1], sum[2]));
      const Point& p = vertices_[v].position;
      radius = std::max(radius, std::hypot(double{p[0]} - double{center[0]}, double{p[1]} - double{center[1]},
                                           double{p[2]} - double{center[2]}));
    }
    points.resize((points.size() + kHullLanes - 1) / kHullLanes * kHullLanes, points.back());
    out_.hulls.push_back({static_cast<std::uint16_t>(bones.size()),
                          static_cast<std::uint16_t>(points.size()),
                          {center[0], center[1], center[2]},
                          rounded_up(radius),
                          rounded_up(slack)});
    for (const auto& [bone, off] : offsets) {
      out_.hull_bones.push_back({bone, rounded_up(off[0]), rounded_up(off[1]), rounded_up(off[2]), rounded_up(off[3])});
    }
    out_.hull_points.insert(out_.hull_points.end(), points.begin(), points.end());
  }

  // Mean weights: they add up to 1 by themselves.
  void add_terms(const Numbers& members, std::size_t lane, std::map<std::uint32_t, BoundsTerm>& terms) const {
    std::map<std::uint32_t, double> means;
    for (const std::uint32_t v : members) {
      for (const auto& [bone, weight] : vertices_[v].weights) {
        means[bone] += double{weight} / static_cast<double>(members.size());
      }
    }
    for (const auto& [bone, mean] : means) {
      const auto stored = static_cast<float>(mean);
      double deviation = 0;
      for (const std::uint32_t v : members) {
        deviation = std::max(deviation, std::abs(double{weight_of(v, bone)} - double{stored}));
      }
      terms[bone].weights[lane] = stored;
      terms[bone].deviations[lane] = rounded_up(deviation);
    }
  }

  void add_morphs(const Numbers& members, std::size_t lane, std::map<std::uint32_t, BallLanes>& morphs) const {
    std::map<std::uint32_t, std::vector<Point>> deltas;
    for (std::size_t i = 0; i < members.size(); ++i) {
      for (const auto& [target, delta] : vertices_[members[i]].morphs) {
        deltas.try_emplace(target, members.size(), Point{}).first->second[i] = delta;
      }
    }
    for (const auto& [target, points] : deltas) {
      const Around around(points);
      BallLanes& ball = morphs[target];
      ball.x[lane] = around.center[0];
      ball.y[lane] = around.center[1];
      ball.z[lane] = around.center[2];
      ball.radius[lane] = around.radius;
    }
  }

  void pack_groups() {
    for (std::size_t first = 0; first < members_.size(); first += kClusterLanes) {
      BoxLanes boxes{};
      std::map<std::uint32_t, BoundsTerm> terms;
      std::map<std::uint32_t, BallLanes> morphs;
      for (std::size_t lane = 0; lane < std::min(kClusterLanes, members_.size() - first); ++lane) {
        const Numbers& members = members_[first + lane];
        std::vector<Point> points;
        for (const std::uint32_t v : members) {
          points.push_back(vertices_[v].position);
        }
        const Around around(points);
        float* const figures[] = {boxes.x, boxes.y, boxes.z, boxes.half_x, boxes.half_y, boxes.half_z};
        for (std::size_t k = 0; k < 6; ++k) {
          figures[k][lane] = k < 3 ? around.center[k] : around.half[k - 3];
        }
        boxes.radius[lane] = around.radius;
        add_terms(members, lane, terms);
        add_morphs(members, lane, morphs);
      }
      out_.boxes.push_back(boxes);
      if (skin_ != nullptr) {
        out_.bounds_term_counts.push_back(static_cast<std::uint32_t>(terms.size()));
      }
      for (const auto& [bone, term] : terms) {
        out_.bounds_term_bones.push_back(bone);
        out_.bounds_terms.push_back(term);
      }
      out_.bounds_morph_counts.push_back(static_cast<std::uint32_t>(morphs.size()));
      for (const auto& [target, ball] : morphs) {
        out_.bounds_morph_targets.push_back(target);
        out_.bounds_morphs.push_back(ball);
      }
    }
    if (out_.bounds_morphs.empty()) {
      out_.bounds_morph_counts.clear();
    }
  }

  TinyAsset& tiny_;
  const TinySkin* skin_;
  SkinParts& out_;
  std::vector<Vertex> vertices_;
  std::map<std::uint32_t, std::uint32_t> number_of_;  // of a source vertex: its vertex
  std::vector<Numbers> members_;                      // of each cluster: its vertices
};

}  // namespace

void add_skin(TinyAsset& tiny, const TinySkin* skin, std::size_t triangles_of_cluster) {
  Packer(tiny, skin).run(triangles_of_cluster);
}

}  // namespace spherechain::test
