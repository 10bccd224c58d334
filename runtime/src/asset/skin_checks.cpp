// SPDX-License-Identifier: MIT
#include "asset/skin_checks.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <limits>

#include "asset/stream.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

using Lanes = flatbuffers::Array<float, kClusterLanes>;
using Bytes = flatbuffers::Vector<std::uint8_t>;
using Numbers = flatbuffers::Vector<std::uint32_t>;
constexpr std::uint32_t kLanes = kClusterLanes;

// The tables expand to at most this many entries each: a packed file must not ask for a giant table.
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 31;

Stream stream_of(const Bytes& bytes) { return Stream({bytes.data(), bytes.size()}); }

bool has_size(std::uint64_t size, std::uint64_t wanted, const char* name, const char* of, Message& message) {
  return size == wanted || message.wrong("skin.%s: %" PRIu64 " of them, but %" PRIu64 " %s", name, size, wanted, of);
}

bool wrong_at(const char* name, std::uint64_t i, const char* what, Message& message) {
  return message.wrong("skin.%s[%" PRIu64 "]: %s", name, i, what);
}

bool is_finite(const schema::Vec3& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

bool are_finite(const flatbuffers::Vector<float>& values, const char* name, Message& message) {
  return std::all_of(values.data(), values.data() + values.size(), [](float v) { return std::isfinite(v); }) ||
         message.wrong("skin.%s: one is not finite", name);
}

// Whether `used` lanes are finite and at least `least`, and the spare ones 0.
bool lanes_are_valid(const Lanes& lanes, std::uint32_t used, float least) {
  for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
    const float value = lanes.Get(lane);
    if (lane < used ? !(std::isfinite(value) && value >= least) : value != 0.0F) {
      return false;
    }
  }
  return true;
}

constexpr float kLowest = std::numeric_limits<float>::lowest();

bool ball_is_valid(const schema::BallLanes& balls, std::uint32_t used) {
  return lanes_are_valid(*balls.x(), used, kLowest) && lanes_are_valid(*balls.y(), used, kLowest) &&
         lanes_are_valid(*balls.z(), used, kLowest) && lanes_are_valid(*balls.radius(), used, 0.0F);
}

bool box_is_valid(const schema::BoxLanes& boxes, std::uint32_t used) {
  return lanes_are_valid(*boxes.x(), used, kLowest) && lanes_are_valid(*boxes.y(), used, kLowest) &&
         lanes_are_valid(*boxes.z(), used, kLowest) && lanes_are_valid(*boxes.half_x(), used, 0.0F) &&
         lanes_are_valid(*boxes.half_y(), used, 0.0F) && lanes_are_valid(*boxes.half_z(), used, 0.0F) &&
         lanes_are_valid(*boxes.radius(), used, 0.0F);
}

// What is checked, one table after another; `sizes` grows on the way.
class Checker {
 public:
  Checker(const schema::Asset& root, SkinSizes& sizes, Message& message)
      : root_(root), skin_(*root.skin()), sizes_(sizes), message_(message) {}

  bool run() {
    sizes_ = {};
    return check_vertices() && check_influences() && check_morphs() && check_clusters() && check_triangles() &&
           check_parts() && check_bounds() && check_hulls() && check_rest_contacts() && check_sizes();
  }

 private:
  std::uint32_t bone_count() const { return root_.bones()->size(); }

  // The next of a stream's numbers, below `limit`.
  bool take(Stream& stream, std::uint32_t limit, const char* name, std::uint64_t i, std::uint32_t& value) {
    return (stream.read(value) && value < limit) ||
           wrong_at(name, i, "missing, or past the end of what it numbers", message_);
  }
  bool ends(const Stream& stream, const char* name) {
    return !stream.has_more() || message_.wrong("skin.%s: more of them than there should be", name);
  }

  bool check_vertices() {
    const std::uint32_t count = skin_.vertex_count();
    sizes_.vertices = count;
    if (!has_size(skin_.positions()->size(), std::uint64_t{3} * count, "positions", "that the vertices have",
                  message_) ||
        !are_finite(*skin_.positions(), "positions", message_)) {
      return false;
    }
    Stream sources = stream_of(*skin_.sources());
    for (std::uint32_t v = 0, source = 0; v < count; ++v) {
      if (!take(sources, root_.source()->vertex_count(), "sources", v, source)) {
        return false;
      }
    }
    Stream welds = stream_of(*skin_.welds());
    for (std::uint32_t i = 0, last = 0; welds.has_more(); ++i) {
      std::uint32_t vertex = 0, weld = 0;
      if (!take(welds, count, "welds", i, vertex) || !take(welds, count, "welds", i, weld)) {
        return false;
      }
      if (weld >= vertex || (i > 0 && vertex <= last)) {
        return wrong_at("welds", i, "not the lowest vertex of its place, or not sorted", message_);
      }
      last = vertex;
    }
    return ends(sources, "sources");
  }

  bool check_influences() {
    const Bytes& counts = *skin_.influence_counts();
    if (!has_size(counts.size(), skin_.vertex_count(), "influence_counts", "vertices", message_)) {
      return false;
    }
    Stream bones = stream_of(*skin_.influence_bones());
    std::uint64_t weights = 0;
    std::size_t& i = sizes_.influences;
    for (std::uint32_t v = 0; v < counts.size(); ++v) {
      const unsigned count = counts.Get(v) & ~kOneWeightLeftOut;
      if ((count > 0) != (bone_count() > 0) || (count == 0 && counts.Get(v) != 0)) {
        return wrong_at("influence_counts", v, "no bone moves it, or there is none", message_);
      }
      for (std::uint32_t k = 0, bone = 0; k < count; ++k, ++i) {
        if (!take(bones, bone_count(), "influence_bones", i, bone)) {
          return false;
        }
      }
      weights += count - ((counts.Get(v) & kOneWeightLeftOut) != 0 ? 1 : 0);
    }
    const auto& stored = *skin_.influence_weights();
    if (!has_size(stored.size(), weights, "influence_weights", "that the vertices have", message_)) {
      return false;
    }
    return (std::all_of(stored.data(), stored.data() + stored.size(), [](float w) { return w >= 0 && w <= 1; }) ||
            message_.wrong("skin.influence_weights: one is not from 0 to 1")) &&
           ends(bones, "influence_bones");
  }

  std::uint32_t morphs_of(std::uint32_t vertex) const {
    return skin_.morph_counts()->size() == 0 ? 0 : skin_.morph_counts()->Get(vertex);
  }

  bool check_morphs() {
    const auto& morphs = *skin_.morphs();
    if (skin_.morph_counts()->size() != 0 &&
        !has_size(skin_.morph_counts()->size(), skin_.vertex_count(), "morph_counts", "vertices", message_)) {
      return false;
    }
    std::uint32_t i = 0;
    for (std::uint32_t v = 0; v < skin_.vertex_count(); ++v) {
      for (const std::uint64_t first = i, end = first + morphs_of(v); i < end; ++i) {
        if (i >= morphs.size() || morphs.Get(i)->target() >= root_.morphs()->size() ||
            !is_finite(morphs.Get(i)->delta()) ||
            (i > first && morphs.Get(i)->target() <= morphs.Get(i - 1)->target())) {
          return wrong_at("morphs", i, "missing, not finite, past the targets, or not sorted", message_);
        }
      }
    }
    return has_size(morphs.size(), i, "morphs", "that the vertices have", message_);
  }

  bool check_corners(std::uint64_t first, const schema::Cluster& cluster) {
    const std::uint8_t* corner = skin_.corners()->data() + 3 * first;
    for (std::uint32_t t = 0; t < cluster.triangle_count(); ++t, corner += 3) {
      if (std::max({corner[0], corner[1], corner[2]}) >= cluster.vertex_count() || corner[0] == corner[1] ||
          corner[1] == corner[2] || corner[2] == corner[0]) {
        return wrong_at("corners", first + t, "a corner that its cluster has not, or one twice", message_);
      }
    }
    return true;
  }

  // Ascending numbers below `limit`; `use` is called with each.
  template <typename Use>
  bool check_run(Stream& stream, std::uint32_t count, std::uint32_t limit, const char* name, std::uint64_t first,
                 const Use& use) {
    for (std::uint32_t k = 0, value = 0, last = 0; k < count; ++k, last = value) {
      if (!take(stream, limit, name, first + k, value)) {
        return false;
      }
      if (k > 0 && value <= last) {
        return wrong_at(name, first + k, "not above the one before it", message_);
      }
      use(value);
    }
    return true;
  }

  bool check_clusters() {
    const auto& clusters = *skin_.clusters();
    Stream vertices = stream_of(*skin_.cluster_vertices()), bones = stream_of(*skin_.cluster_bones());
    std::uint32_t c = 0;
    for (std::uint32_t s = 0; s < root_.spheres()->size(); ++s) {
      std::uint64_t left = root_.spheres()->Get(s)->triangle_count();
      for (; left > 0; ++c) {
        if (c == clusters.size() || clusters.Get(c)->triangle_count() == 0 ||
            clusters.Get(c)->triangle_count() > std::min<std::uint64_t>(left, kMaxClusterTriangles)) {
          return message_.wrong("skin.clusters[%" PRIu32 "]: the clusters do not tile the triangles of sphere %" PRIu32,
                                c, s);
        }
        const schema::Cluster& cluster = *clusters.Get(c);
        if (cluster.vertex_count() == 0 || cluster.vertex_count() > kMaxClusterVertices ||
            (cluster.bone_count() > 0) != (bone_count() > 0)) {
          return wrong_at("clusters", c, "its vertex_count is not 1 to 192, or its bones are none", message_);
        }
        left -= cluster.triangle_count();
        if (3 * (sizes_.triangles + cluster.triangle_count()) > skin_.corners()->size()) {
          return wrong_at("clusters", c, "its corners are missing", message_);
        }
        if (!check_corners(sizes_.triangles, cluster)) {
          return false;
        }
        const std::size_t slots = (cluster.vertex_count() + kSlotLanes - 1) / kSlotLanes * kSlotLanes;
        std::size_t morphs_of_last = 0;
        if (!check_run(vertices, cluster.vertex_count(), skin_.vertex_count(), "cluster_vertices",
                       sizes_.cluster_vertices,
                       [&](std::uint32_t v) {
                         morphs_of_last = morphs_of(v);
                         sizes_.slot_morphs += morphs_of_last;
                       }) ||
            !check_run(bones, cluster.bone_count(), bone_count(), "cluster_bones", sizes_.cluster_bones,
                       [](std::uint32_t) {})) {
          return false;
        }
        // Slots beyond the vertices repeat the last.
        sizes_.slot_morphs += (slots - cluster.vertex_count()) * morphs_of_last;
        sizes_.triangles += cluster.triangle_count();
        sizes_.cluster_vertices += cluster.vertex_count();
        sizes_.cluster_bones += cluster.bone_count();
        sizes_.slots += slots;
        sizes_.weights += slots * cluster.bone_count();
      }
    }
    sizes_.clusters = c;
    return has_size(clusters.size(), c, "clusters", "that spheres have", message_) &&
           has_size(skin_.corners()->size(), 3 * sizes_.triangles, "corners", "that the triangles have", message_) &&
           ends(vertices, "cluster_vertices") && ends(bones, "cluster_bones");
  }

  bool check_triangles() {
    Stream triangles = stream_of(*skin_.triangles());
    for (std::uint64_t i = 0; i < sizes_.triangles; ++i) {
      std::uint32_t triangle = 0;
      if (!take(triangles, root_.source()->triangle_count(), "triangles", i, triangle)) {
        return false;
      }
    }
    return ends(triangles, "triangles");
  }

  bool check_parts() {
    const Bytes& runs = *skin_.part_runs();
    Stream ends_of_runs = stream_of(*skin_.part_run_ends());
    std::uint32_t last = 0;
    for (std::uint32_t i = 0, end = 0; i < runs.size(); ++i, last = end) {
      if (!ends_of_runs.read(end) || end <= last || runs.Get(i) >= root_.parts()->size()) {
        return wrong_at("part_runs", i, "past the parts, or its end is missing or not above the one before", message_);
      }
    }
    return has_size(last, sizes_.triangles, "part_runs", "triangles", message_) && ends(ends_of_runs, "part_run_ends");
  }

  std::uint32_t lanes_of(std::uint32_t group) const {
    return std::min(kLanes, skin_.clusters()->size() - kLanes * group);
  }

  // A group's entries each, one group after another, that name bones or morph targets.
  template <typename IsValid>
  bool check_groups(const Numbers& counts, const Numbers& names, std::uint32_t limit, const char* counts_name,
                    const char* names_name, const IsValid& is_valid) {
    std::uint64_t next = 0;
    for (std::uint32_t group = 0; group < counts.size(); ++group) {
      const auto first = static_cast<std::uint32_t>(next);
      next += counts.Get(group);
      if (next > names.size()) {
        return wrong_at(counts_name, group, "its entries are past the end", message_);
      }
      for (auto i = first; i < next; ++i) {
        if (names.Get(i) >= limit || (i > first && names.Get(i) <= names.Get(i - 1)) || !is_valid(group, i)) {
          return wrong_at(names_name, i,
                          "past the end, not sorted, or its lanes are not finite, below 0, or a spare is not 0",
                          message_);
        }
      }
    }
    return has_size(names.size(), next, names_name, "that the groups have", message_);
  }

  bool check_bounds() {
    const std::uint32_t groups = (skin_.clusters()->size() + kLanes - 1) / kLanes;
    if (!has_size(skin_.boxes()->size(), groups, "boxes", "groups of clusters", message_) ||
        !has_size(skin_.bounds_term_counts()->size(), bone_count() == 0 ? 0 : groups, "bounds_term_counts",
                  "groups of clusters that move", message_) ||
        !has_size(skin_.bounds_terms()->size(), skin_.bounds_term_bones()->size(), "bounds_terms", "bounds_term_bones",
                  message_) ||
        !has_size(skin_.bounds_morphs()->size(), skin_.bounds_morph_targets()->size(), "bounds_morphs",
                  "bounds_morph_targets", message_)) {
      return false;
    }
    if (skin_.bounds_morph_counts()->size() != 0 &&
        !has_size(skin_.bounds_morph_counts()->size(), groups, "bounds_morph_counts", "groups of clusters", message_)) {
      return false;
    }
    for (std::uint32_t group = 0; group < groups; ++group) {
      if (!box_is_valid(*skin_.boxes()->Get(group), lanes_of(group))) {
        return wrong_at("boxes", group, "not finite, an extent below 0, or a spare lane that is not 0", message_);
      }
    }
    const auto term_is_valid = [&](std::uint32_t group, std::uint32_t i) {
      const schema::BoundsTerm& term = *skin_.bounds_terms()->Get(i);
      return lanes_are_valid(*term.weights(), lanes_of(group), 0.0F) &&
             lanes_are_valid(*term.deviations(), lanes_of(group), 0.0F);
    };
    const auto morph_is_valid = [&](std::uint32_t group, std::uint32_t i) {
      return ball_is_valid(*skin_.bounds_morphs()->Get(i), lanes_of(group));
    };
    return check_groups(*skin_.bounds_term_counts(), *skin_.bounds_term_bones(), bone_count(), "bounds_term_counts",
                        "bounds_term_bones", term_is_valid) &&
           check_groups(*skin_.bounds_morph_counts(), *skin_.bounds_morph_targets(), root_.morphs()->size(),
                        "bounds_morph_counts", "bounds_morph_targets", morph_is_valid);
  }

  bool check_hull(std::uint32_t s) {
    const schema::Hull& hull = *skin_.hulls()->Get(s);
    const bool has_clusters = root_.spheres()->Get(s)->triangle_count() > 0;
    if ((hull.bone_count() > 0) != has_clusters || (hull.point_count() > 0) != has_clusters ||
        hull.point_count() % kHullLanes != 0) {
      return wrong_at("hulls", s, "its counts are not those of a sphere with, or without triangles", message_);
    }
    if (!is_finite(hull.center()) || !(std::isfinite(hull.radius()) && hull.radius() >= 0.0F) ||
        !(std::isfinite(hull.slack()) && hull.slack() >= 0.0F)) {
      return wrong_at("hulls", s, "its center, radius or slack is not finite, or below 0", message_);
    }
    const std::size_t end = sizes_.hull_bones + hull.bone_count();
    for (std::size_t i = sizes_.hull_bones; i < end; ++i) {
      if (i >= skin_.hull_bones()->size()) {
        return wrong_at("hull_bones", i, "missing", message_);
      }
      const schema::HullBone& bone = *skin_.hull_bones()->Get(static_cast<std::uint32_t>(i));
      const float off[4] = {bone.x(), bone.y(), bone.z(), bone.w()};
      if (bone.bone() >= bone_count() ||
          !std::all_of(off, off + 4, [](float v) { return std::isfinite(v) && v >= 0.0F; })) {
        return wrong_at("hull_bones", i, "past the bones, or a figure of it is not finite, or below 0", message_);
      }
    }
    sizes_.hull_bones = end;
    sizes_.hull_points += hull.point_count();
    sizes_.hull_weights += std::size_t{hull.point_count()} * hull.bone_count();
    return true;
  }

  bool check_hulls() {
    sizes_.hulls = skin_.hulls()->size();
    if (!has_size(sizes_.hulls, bone_count() == 0 ? 0 : root_.spheres()->size(), "hulls", "spheres that move",
                  message_)) {
      return false;
    }
    for (std::uint32_t s = 0; s < sizes_.hulls; ++s) {
      if (!check_hull(s)) {
        return false;
      }
    }
    Stream points = stream_of(*skin_.hull_points());
    for (std::uint64_t i = 0; i < sizes_.hull_points; ++i) {
      std::uint32_t point = 0;
      if (!take(points, skin_.vertex_count(), "hull_points", i, point)) {
        return false;
      }
    }
    return has_size(skin_.hull_bones()->size(), sizes_.hull_bones, "hull_bones", "that the hulls have", message_) &&
           ends(points, "hull_points");
  }

  bool check_rest_contacts() {
    Stream pairs = stream_of(*skin_.rest_contacts());
    const std::uint32_t limit = root_.source()->triangle_count();
    for (Pair last{}; pairs.has_more(); ++sizes_.rest_contacts) {
      Pair pair{};
      if (!take(pairs, limit, "rest_contacts", sizes_.rest_contacts, pair.a) ||
          !take(pairs, limit, "rest_contacts", sizes_.rest_contacts, pair.b)) {
        return false;
      }
      if (pair.a >= pair.b || (sizes_.rest_contacts > 0 && !(last < pair))) {
        return wrong_at("rest_contacts", sizes_.rest_contacts, "a is not below b, or not sorted", message_);
      }
      last = pair;
    }
    return true;
  }

  bool check_sizes() {
    return std::max({std::uint64_t{sizes_.weights}, std::uint64_t{sizes_.slot_morphs},
                     std::uint64_t{sizes_.hull_weights}}) <= kMaxEntries ||
           message_.wrong("skin: the tables would expand to more than 2^31 entries");
  }

  const schema::Asset& root_;
  const schema::Skin& skin_;
  SkinSizes& sizes_;
  Message& message_;
};

}  // namespace

bool skin_values_are_valid(const schema::Asset& root, SkinSizes& sizes, Message& message) {
  return Checker(root, sizes, message).run();
}

}  // namespace spherechain
