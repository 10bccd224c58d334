// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/stack.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "baker/layers/pieces.h"
#include "runtime/src/base/double3.h"

namespace spherechain {
namespace {

// Lengths are shares of the height.
constexpr double kReach = 0.15;      // a layer that moves as what it lies over is not farther from it
constexpr double kLoose = 0.06;      // nor is another one
constexpr double kTight = 0.03;      // nor is one that buries
constexpr double kMoveAlike = 0.5;   // weight of bones that move both, where one buries the other
constexpr double kMoveAsOne = 0.95;  // and where it does so at any distance
constexpr double kNear = 0.035;      // between the vertices of two clusters that are layers of one place
constexpr double kMiddles = 0.07;    // between their middles; large clusters may be farther apart: see reach()
constexpr double kLarge = 0.06;      // in reach() no cluster counts as larger
constexpr double kStep = 1e-5;       // off a triangle, before a look
constexpr std::uint32_t kEvery = 8;  // triangles of a cluster, of which one is looked from

struct Hit {
  std::uint32_t cluster = kNoPlace, triangle = kNoPlace;
  double distance = HUGE_VAL;
  bool from_behind = false;
};

class Stacker {
 public:
  Stacker(const AssetView& asset, const Surface& surface)
      : surface_(surface), height_(double{asset.info().height}), pieces_(baker::number_pieces(surface)) {
    for (std::uint32_t c = 0; c < surface.clusters.size; ++c) {
      const BoxLanes& lanes = surface.boxes[c / kClusterLanes];
      const std::size_t k = c % kClusterLanes;
      boxes_.push_back({{double{lanes.x[k]}, double{lanes.y[k]}, double{lanes.z[k]}},
                        {double{lanes.half_x[k]}, double{lanes.half_y[k]}, double{lanes.half_z[k]}}});
    }
  }

  baker::Stack run(const baker::Layers::Pairs& rest_contacts) {
    baker::Stack out;
    for (std::uint32_t c = 0; c < surface_.clusters.size; ++c) {
      std::map<std::uint32_t, std::vector<double>> over;
      out.is_buried.push_back(look_from(c, over) ? 1 : 0);
      out.covers.push_back(cover_of(over));
    }
    for (const auto& [a, b] : rest_contacts) add_over(cluster_of(surface_, a), cluster_of(surface_, b));
    for (std::uint32_t a = 0; a < surface_.clusters.size; ++a) {
      for (std::uint32_t b = a + 1; b < surface_.clusters.size; ++b) {
        if (are_layers(a, b)) out.pairs.emplace_back(a, b);
      }
    }
    return out;
  }

 private:
  struct Box {
    Double3 middle, half;
  };
  struct Over {
    Double3 a, b;  // middles of the two clusters
  };

  std::uint32_t piece_of(std::uint32_t cluster) const {
    return pieces_[surface_.cluster_vertices[surface_.clusters[cluster].first_vertex]];
  }
  Double3 position(std::uint32_t vertex) const {
    const float* const at = surface_.rest_positions.data + 3 * std::size_t{vertex};
    return {double{at[0]}, double{at[1]}, double{at[2]}};
  }
  Double3 corner(std::uint32_t triangle, std::size_t k) const {
    return position(surface_.triangle_vertices[3 * std::size_t{triangle} + k]);
  }
  Double3 outward(std::uint32_t triangle) const {
    const Double3 p = corner(triangle, 0);
    const bool is_inside_out = (surface_.layers[triangle] & kIsInsideOut) != 0;
    return (is_inside_out ? -1.0 : 1.0) * cross(corner(triangle, 1) - p, corner(triangle, 2) - p);
  }

  // Moeller and Trumbore.
  double distance_along(std::uint32_t triangle, const Double3& from, const Double3& direction) const {
    const Double3 p = corner(triangle, 0), e = corner(triangle, 1) - p, f = corner(triangle, 2) - p;
    const Double3 q = cross(direction, f);
    const double determinant = dot(e, q);
    if (!(determinant > 0) && !(determinant < 0)) return HUGE_VAL;
    const Double3 r = from - p, s = cross(r, e);
    const double u = dot(r, q) / determinant, v = dot(direction, s) / determinant, t = dot(f, s) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : HUGE_VAL;
  }

  // Could a look that is `reach` long at most end in the box?
  static bool may_end_in(const Box& box, const Double3& from, const Double3& direction, double reach) {
    const Double3 away = box.middle - from;
    const double along = std::clamp(dot(away, direction), 0.0, reach), size = length(box.half);
    return length(away - along * direction) <= size;
  }

  // The nearest triangle of another piece.
  Hit look(std::uint32_t cluster, std::uint32_t triangle) const {
    Hit out;
    Double3 direction = outward(triangle);
    if (!normalize(direction)) return out;
    const Double3 middle = (1.0 / 3) * (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2));
    const Double3 from = middle + kStep * height_ * direction;
    const std::uint32_t own = piece_of(cluster);
    for (std::uint32_t c = 0; c < surface_.clusters.size; ++c) {
      const double reach = std::min(out.distance, kReach * height_);
      if (piece_of(c) == own || !may_end_in(boxes_[c], from, direction, reach)) continue;
      const Cluster& other = surface_.clusters[c];
      for (std::uint32_t t = other.first_triangle; t < other.first_triangle + other.triangle_count; ++t) {
        const double distance = distance_along(t, from, direction);
        if (distance < out.distance && distance <= kReach * height_) {
          out = {c, t, distance, dot(outward(t), direction) > 0};
        }
      }
    }
    return out;
  }

  // The mean over the corners.
  std::map<std::uint32_t, double> weights_of(std::uint32_t cluster, std::uint32_t triangle) const {
    const Cluster& of = surface_.clusters[cluster];
    const std::size_t slots = slot_count(of);
    std::map<std::uint32_t, double> out;
    for (std::size_t bone = 0; bone < of.bone_count; ++bone) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t slot = surface_.corners[3 * std::size_t{triangle} + k];
        out[surface_.cluster_bones[of.first_bone + bone]] +=
            double{surface_.slot_weights[of.first_weight + bone * slots + slot]} / 3;
      }
    }
    return out;
  }

  // Weight of the bones that move a triangle, and the one over it.
  double shared_weight(std::uint32_t cluster, std::uint32_t triangle, const Hit& hit) const {
    if (surface_.bone_boxes.size == 0) return 1;
    double shared = 0;
    const std::map<std::uint32_t, double> others = weights_of(hit.cluster, hit.triangle);
    for (const auto& [bone, weight] : weights_of(cluster, triangle)) {
      const auto other = others.find(bone);
      shared += other == others.end() ? 0 : std::min(weight, other->second);
    }
    return shared;
  }

  // `over`: distances by piece.
  static baker::Layers::Cover cover_of(std::map<std::uint32_t, std::vector<double>>& over) {
    const auto most = std::ranges::max_element(over, {}, [](const auto& entry) { return entry.second.size(); });
    if (most == over.end()) return {};
    std::vector<double>& distances = most->second;
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return {most->first + 1, static_cast<float>(*middle)};
  }

  // Notes what lies over a cluster. Does it bury it?
  bool look_from(std::uint32_t cluster, std::map<std::uint32_t, std::vector<double>>& over) {
    const Cluster& of = surface_.clusters[cluster];
    bool is_buried = true;
    for (std::uint32_t t = of.first_triangle; t < of.first_triangle + of.triangle_count; ++t) {
      is_buried = is_buried && is_covered(surface_, t);
      if ((t - of.first_triangle) % kEvery != 0) continue;
      const Hit hit = look(cluster, t);
      if (hit.cluster == kNoPlace) {
        is_buried = false;
        continue;
      }
      const double shared = shared_weight(cluster, t, hit);
      is_buried = is_buried && shared >= (hit.distance <= kTight * height_ ? kMoveAlike : kMoveAsOne);
      const bool is_near = hit.distance <= kLoose * height_ || shared >= kMoveAsOne;
      if (is_near && (hit.from_behind || is_covered(surface_, t))) {
        add_over(cluster, hit.cluster);
        over[piece_of(hit.cluster)].push_back(hit.distance);
      }
    }
    return is_buried;
  }

  void add_over(std::uint32_t a, std::uint32_t b) {
    if (piece_of(a) > piece_of(b)) std::swap(a, b);
    over_[{piece_of(a), piece_of(b)}].push_back({boxes_[a].middle, boxes_[b].middle});
  }

  // Pieces lie over each other where a look says so, and around it: they slide.
  bool are_layers(std::uint32_t a, std::uint32_t b) const {
    if (piece_of(a) > piece_of(b)) std::swap(a, b);
    if (piece_of(a) == piece_of(b) || !are_near(a, b)) return false;
    const auto found = over_.find({piece_of(a), piece_of(b)});
    const double most = reach(a, b);
    return found != over_.end() && std::any_of(found->second.begin(), found->second.end(), [&](const Over& over) {
             return length(over.a - boxes_[a].middle) < most && length(over.b - boxes_[b].middle) < most;
           });
  }

  // The middles of layers of one place are not farther apart.
  double reach(std::uint32_t a, std::uint32_t b) const {
    const auto size = [&](std::uint32_t c) { return std::min(length(boxes_[c].half), kLarge * height_); };
    return std::max(kMiddles * height_, kNear * height_ + 0.5 * (size(a) + size(b)));
  }

  bool are_near(std::uint32_t a, std::uint32_t b) const {
    const Box &box = boxes_[a], &other = boxes_[b];
    const Double3 apart = other.middle - box.middle, sum = box.half + other.half;
    const double most = kNear * height_;
    if (std::abs(apart.x) > sum.x + most || std::abs(apart.y) > sum.y + most || std::abs(apart.z) > sum.z + most ||
        length(apart) >= reach(a, b)) {
      return false;
    }
    const auto vertices = [&](std::uint32_t c) {
      const Cluster& of = surface_.clusters[c];
      return Span<const std::uint32_t>{surface_.cluster_vertices.data + of.first_vertex, of.vertex_count};
    };
    for (const std::uint32_t v : vertices(a)) {
      for (const std::uint32_t w : vertices(b)) {
        const Double3 between = position(w) - position(v);
        if (dot(between, between) < most * most) return true;
      }
    }
    return false;
  }

  const Surface& surface_;
  double height_;
  std::vector<std::uint32_t> pieces_;                                          // of each vertex
  std::vector<Box> boxes_;                                                     // of the clusters
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Over>> over_;  // by pieces, the lower first
};

}  // namespace

baker::Stack baker::find_stack(const AssetView& asset, const Surface& surface, const Layers::Pairs& rest_contacts) {
  return Stacker(asset, surface).run(rest_contacts);
}

}  // namespace spherechain
