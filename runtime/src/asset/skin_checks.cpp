// SPDX-License-Identifier: MIT
#include "runtime/src/asset/asset_checks.h"
#include "runtime/src/base/stream.h"

namespace spherechain {
namespace {

using Bytes = Span<const std::uint8_t>;
using Numbers = Span<const std::uint32_t>;

// The tables expand to at most this many entries each: a packed file must not ask for a giant table.
constexpr std::uint64_t kMaxEntries = std::uint64_t{1} << 31;

// Rows of eight lanes: those in use are finite, and at least 0 from row `first_length` on; the spare ones are 0.
template <typename Lanes>
bool lanes_are_valid(const Lanes& lanes, std::size_t used, std::size_t first_length) {
  const auto* row = reinterpret_cast<const float*>(&lanes);
  for (std::size_t r = 0; r < sizeof(Lanes) / (kClusterLanes * sizeof(float)); ++r, row += kClusterLanes) {
    const bool is_length = r >= first_length;
    if (!std::all_of(row, row + used, [=](float v) { return is_length ? is_at_least_0(v) : std::isfinite(v); }) ||
        !std::all_of(row + used, row + kClusterLanes, [](float v) { return v == 0.0F; })) {
      return false;
    }
  }
  return true;
}

// Checks one table after another and adds up what they expand to.
class SkinChecker {
 public:
  SkinChecker(const AssetView& asset, SkinSizes& sizes, Message& message)
      : asset_(asset), skin_(asset.skin()), sizes_(sizes), message_(message) {}

  bool run() {
    return check_vertices() && check_influences() && check_morphs() && check_clusters() && check_parts() &&
           check_bounds() && check_hulls() && check_pieces() && check_layers() && check_windings() && check_sizes();
  }

 private:
  // The next of a stream's numbers, below `limit`.
  bool take(Stream& stream, std::size_t limit, const char* name, std::uint64_t i, std::uint32_t& value) {
    return (stream.read(value) && value < limit) ||
           message_.wrong_at(name, i, "missing, or past the end of what it numbers");
  }
  bool ends(const Stream& stream, const char* name) {
    return !stream.has_more() || message_.wrong("%s: more of them than there should be", name);
  }

  // A stream of `count` numbers below `limit`.
  bool check_stream(Bytes bytes, std::uint64_t count, std::size_t limit, const char* name) {
    Stream stream(bytes);
    std::uint32_t value = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      if (!take(stream, limit, name, i, value)) {
        return false;
      }
    }
    return ends(stream, name);
  }

  // A stream of pairs of numbers below `limit`. `may_follow` gets the pair before, which is (0, 0) at first, and the
  // pair.
  template <typename MayFollow>
  bool check_pairs(Bytes bytes, std::size_t limit, const char* name, const char* fault, std::size_t& count,
                   const MayFollow& may_follow) {
    Stream stream(bytes);
    for (Pair pair{}, before{}; stream.has_more(); ++count, before = pair) {
      if (!take(stream, limit, name, count, pair.a) || !take(stream, limit, name, count, pair.b)) {
        return false;
      }
      if (!may_follow(before, pair)) {
        return message_.wrong_at(name, count, fault);
      }
    }
    return true;
  }

  bool check_vertices() {
    std::size_t weld_count = 0;
    return message_.has_size("skin.positions", skin_.positions.size, std::uint64_t{3} * sizes_.vertices,
                             "that the vertices have") &&
           (std::all_of(skin_.positions.begin(), skin_.positions.end(), is_finite<float>) ||
            message_.wrong("skin.positions: one is not finite")) &&
           check_stream(skin_.sources, sizes_.vertices, asset_.vertex_count(), "skin.sources") &&
           check_pairs(skin_.welds, sizes_.vertices, "skin.welds", "not the lowest vertex of its place, or not sorted",
                       weld_count,
                       [](const Pair& before, const Pair& weld) { return weld.b < weld.a && before.a < weld.a; });
  }

  bool check_influences() {
    if (!message_.has_size("skin.influence_counts", skin_.influence_counts.size, sizes_.vertices, "vertices")) {
      return false;
    }
    std::size_t left_out = 0;
    for (std::size_t v = 0; v < sizes_.vertices; ++v) {
      const unsigned stored = skin_.influence_counts[v], count = stored & ~unsigned{kOneWeightLeftOut};
      if ((count > 0) != (asset_.bone_count() > 0) || (count == 0 && stored != 0)) {
        return message_.wrong_at("skin.influence_counts", v, "no bone moves it, or there is none");
      }
      sizes_.influences += count;
      left_out += stored != count ? 1 : 0;
    }
    const Span<const float> weights = skin_.influence_weights;
    return message_.has_size("skin.influence_weights", weights.size, sizes_.influences - left_out,
                             "that the vertices have") &&
           (std::all_of(weights.begin(), weights.end(), [](float w) { return w >= 0 && w <= 1; }) ||
            message_.wrong("skin.influence_weights: one is not from 0 to 1")) &&
           check_stream(skin_.influence_bones, sizes_.influences, asset_.bone_count(), "skin.influence_bones");
  }

  std::uint32_t morphs_of(std::uint32_t vertex) const {
    return skin_.morph_counts.size == 0 ? 0 : skin_.morph_counts[vertex];
  }

  bool check_morphs() {
    const Span<const MorphDelta> morphs = skin_.morphs;
    if (skin_.morph_counts.size != 0 &&
        !message_.has_size("skin.morph_counts", skin_.morph_counts.size, sizes_.vertices, "vertices")) {
      return false;
    }
    std::size_t i = 0;
    for (const std::uint16_t count : skin_.morph_counts) {
      for (const std::size_t first = i, end = first + count; i < end; ++i) {
        if (i >= morphs.size || morphs[i].target >= asset_.morph_count() || !is_finite(morphs[i].delta) ||
            (i > first && morphs[i].target <= morphs[i - 1].target)) {
          return message_.wrong_at("skin.morphs", i, "missing, not finite, past the targets, or not sorted");
        }
      }
    }
    return message_.has_size("skin.morphs", morphs.size, i, "that the vertices have");
  }

  bool check_corners(const PackedCluster& cluster) {
    const std::uint8_t* corner = skin_.corners.data + 3 * sizes_.triangles;
    for (std::uint32_t t = 0; t < cluster.triangle_count; ++t, corner += 3) {
      if (std::max({corner[0], corner[1], corner[2]}) >= cluster.vertex_count || corner[0] == corner[1] ||
          corner[1] == corner[2] || corner[2] == corner[0]) {
        return message_.wrong_at("skin.corners", sizes_.triangles + t,
                                 "a corner that its cluster has not, or one twice");
      }
    }
    return true;
  }

  // The next `count` numbers of a stream ascend and are below `limit`. Number `first` comes next; `use` gets each.
  template <typename Use>
  bool check_run(Stream& stream, std::uint32_t count, std::size_t limit, const char* name, std::uint64_t first,
                 const Use& use) {
    for (std::uint32_t k = 0, value = 0, before = 0; k < count; ++k, before = value) {
      if (!take(stream, limit, name, first + k, value)) {
        return false;
      }
      if (k > 0 && value <= before) {
        return message_.wrong_at(name, first + k, "not above the one before it");
      }
      use(value);
    }
    return true;
  }

  bool check_cluster(std::size_t c, Stream& vertices, Stream& bones) {
    const PackedCluster& cluster = skin_.clusters[c];
    if (cluster.vertex_count == 0 || cluster.vertex_count > kMaxClusterVertices ||
        (cluster.bone_count > 0) != (asset_.bone_count() > 0) || cluster.is_buried > 1 || cluster.reserved != 0) {
      return message_.wrong_at("skin.clusters", c,
                               "its vertex_count is not 1 to 192, its bones are none, or a flag is not 0 or 1");
    }
    if (3 * (sizes_.triangles + cluster.triangle_count) > skin_.corners.size) {
      return message_.wrong_at("skin.clusters", c, "its corners are missing");
    }
    std::size_t morphs = 0, morphs_of_last = 0;
    const auto count_morphs = [&](std::uint32_t vertex) {
      morphs_of_last = morphs_of(vertex);
      morphs += morphs_of_last;
    };
    if (!check_corners(cluster) ||
        !check_run(vertices, cluster.vertex_count, sizes_.vertices, "skin.cluster_vertices", sizes_.cluster_vertices,
                   count_morphs) ||
        !check_run(bones, cluster.bone_count, asset_.bone_count(), "skin.cluster_bones", sizes_.cluster_bones,
                   [](std::uint32_t) {})) {
      return false;
    }
    // Slots beyond the vertices repeat the last.
    const std::size_t slots = (cluster.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes;
    sizes_.slot_morphs += morphs + (slots - cluster.vertex_count) * morphs_of_last;
    sizes_.triangles += cluster.triangle_count;
    sizes_.cluster_vertices += cluster.vertex_count;
    sizes_.cluster_bones += cluster.bone_count;
    sizes_.slots += slots;
    sizes_.weights += slots * cluster.bone_count;
    return true;
  }

  bool check_clusters() {
    Stream vertices(skin_.cluster_vertices), bones(skin_.cluster_bones);
    const Span<const PackedCluster> clusters = skin_.clusters;
    std::size_t& c = sizes_.clusters;
    for (std::size_t s = 0; s < asset_.spheres().size; ++s) {
      for (std::size_t left = asset_.spheres()[s].triangle_count; left > 0; ++c) {
        if (c == clusters.size || clusters[c].triangle_count == 0 ||
            clusters[c].triangle_count > std::min(left, kMaxClusterTriangles)) {
          return message_.wrong("skin.clusters[%zu]: the clusters do not tile the triangles of sphere %zu", c, s);
        }
        if (!check_cluster(c, vertices, bones)) {
          return false;
        }
        left -= clusters[c].triangle_count;
      }
    }
    return message_.has_size("skin.clusters", clusters.size, c, "that spheres have") &&
           message_.has_size("skin.corners", skin_.corners.size, 3 * sizes_.triangles, "that the triangles have") &&
           ends(vertices, "skin.cluster_vertices") && ends(bones, "skin.cluster_bones") &&
           check_stream(skin_.triangles, sizes_.triangles, asset_.info().triangle_count, "skin.triangles");
  }

  // Runs of triangles that tile them all: the value of each is below `limit`.
  bool check_runs(Bytes values, Bytes run_ends, std::size_t limit, const char* name) {
    Stream ends_of_runs(run_ends);
    std::uint32_t before = 0;
    for (std::size_t i = 0; i < values.size; ++i) {
      std::uint32_t end = 0;
      if (!ends_of_runs.read(end) || end <= before || values[i] >= limit) {
        return message_.wrong_at(name, i, "no such value, or its end is missing or not above the one before");
      }
      before = end;
    }
    return message_.has_size(name, before, sizes_.triangles, "triangles") && ends(ends_of_runs, name);
  }

  bool check_parts() { return check_runs(skin_.part_runs, skin_.part_run_ends, asset_.part_count(), "skin.part_runs"); }

  std::size_t lanes_of(std::size_t group) const {
    return std::min(kClusterLanes, skin_.clusters.size - kClusterLanes * group);
  }

  // Each group's entries follow those of the group before. An entry has the number of a bone or morph target, ascending
  // in the group, and its lanes.
  template <typename Lanes>
  bool check_groups(Numbers counts, const char* counts_name, Numbers names, const char* names_name, std::size_t limit,
                    Span<const Lanes> lanes, std::size_t first_length) {
    std::size_t i = 0;
    for (std::size_t group = 0; group < counts.size; ++group) {
      const std::size_t first = i, end = first + counts[group];
      if (counts[group] > names.size - first) {
        return message_.wrong_at(counts_name, group, "its entries are past the end");
      }
      for (; i < end; ++i) {
        if (names[i] >= limit || (i > first && names[i] <= names[i - 1]) ||
            !lanes_are_valid(lanes[i], lanes_of(group), first_length)) {
          return message_.wrong_at(
              names_name, i, "past the end, not sorted, or its lanes are not finite, below 0, or a spare is not 0");
        }
      }
    }
    return message_.has_size(names_name, names.size, i, "that the groups have");
  }

  bool check_bounds() {
    const std::size_t groups = (skin_.clusters.size + kClusterLanes - 1) / kClusterLanes;
    const std::size_t moving_groups = asset_.bone_count() == 0 ? 0 : groups;
    const std::size_t morphing_groups = skin_.bounds_morph_counts.size == 0 ? 0 : groups;
    if (!message_.has_size("skin.boxes", skin_.boxes.size, groups, "groups of clusters") ||
        !message_.has_size("skin.bounds_term_counts", skin_.bounds_term_counts.size, moving_groups,
                           "groups of clusters that move") ||
        !message_.has_size("skin.bounds_morph_counts", skin_.bounds_morph_counts.size, morphing_groups,
                           "groups of clusters") ||
        !message_.has_size("skin.bounds_terms", skin_.bounds_terms.size, skin_.bounds_term_bones.size,
                           "bounds_term_bones") ||
        !message_.has_size("skin.bounds_morphs", skin_.bounds_morphs.size, skin_.bounds_morph_targets.size,
                           "bounds_morph_targets")) {
      return false;
    }
    for (std::size_t group = 0; group < groups; ++group) {
      if (!lanes_are_valid(skin_.boxes[group], lanes_of(group), 3)) {
        return message_.wrong_at("skin.boxes", group, "not finite, an extent below 0, or a spare lane that is not 0");
      }
    }
    return check_groups(skin_.bounds_term_counts, "skin.bounds_term_counts", skin_.bounds_term_bones,
                        "skin.bounds_term_bones", asset_.bone_count(), skin_.bounds_terms, 0) &&
           check_groups(skin_.bounds_morph_counts, "skin.bounds_morph_counts", skin_.bounds_morph_targets,
                        "skin.bounds_morph_targets", asset_.morph_count(), skin_.bounds_morphs, 3);
  }

  bool check_hull(std::size_t s) {
    const PackedHull& hull = skin_.hulls[s];
    const bool has_clusters = asset_.spheres()[s].triangle_count > 0;
    if ((hull.bone_count > 0) != has_clusters || (hull.point_count > 0) != has_clusters ||
        hull.point_count % kHullLanes != 0) {
      return message_.wrong_at("skin.hulls", s, "its counts are not those of a sphere with, or without triangles");
    }
    if (!is_finite(hull.center) || !is_at_least_0(hull.radius) || !is_at_least_0(hull.slack)) {
      return message_.wrong_at("skin.hulls", s, "its center, radius or slack is not finite, or below 0");
    }
    std::size_t& i = sizes_.hull_bones;
    for (const std::size_t end = i + hull.bone_count; i < end; ++i) {
      if (i >= skin_.hull_bones.size) {
        return message_.wrong_at("skin.hull_bones", i, "missing");
      }
      const HullBone& bone = skin_.hull_bones[i];
      if (bone.bone >= asset_.bone_count() || !is_at_least_0(bone.x) || !is_at_least_0(bone.y) ||
          !is_at_least_0(bone.z) || !is_at_least_0(bone.w)) {
        return message_.wrong_at("skin.hull_bones", i, "past the bones, or a figure of it is not finite, or below 0");
      }
    }
    sizes_.hull_points += hull.point_count;
    sizes_.hull_weights += std::size_t{hull.point_count} * hull.bone_count;
    return true;
  }

  bool check_hulls() {
    sizes_.hulls = skin_.hulls.size;
    if (!message_.has_size("skin.hulls", sizes_.hulls, asset_.bone_count() == 0 ? 0 : asset_.spheres().size,
                           "spheres that move")) {
      return false;
    }
    for (std::size_t s = 0; s < sizes_.hulls; ++s) {
      if (!check_hull(s)) {
        return false;
      }
    }
    return message_.has_size("skin.hull_bones", skin_.hull_bones.size, sizes_.hull_bones, "that the hulls have") &&
           check_stream(skin_.hull_points, sizes_.hull_points, sizes_.vertices, "skin.hull_points");
  }

  bool check_pieces() {
    for (std::size_t i = 0; i < asset_.piece_count(); ++i) {
      if (!is_at_least_0(asset_.piece(i).border)) {
        return message_.wrong_at("skin.pieces", i, "its border is not finite, or below 0");
      }
    }
    for (std::size_t c = 0; c < skin_.cover_distances.size; ++c) {
      if (!is_at_least_0(skin_.cover_distances[c])) {
        return message_.wrong_at("skin.cover_distances", c, "not finite, or below 0");
      }
    }
    return message_.has_size("skin.cover_distances", skin_.cover_distances.size, sizes_.clusters, "clusters") &&
           check_stream(skin_.covers, sizes_.clusters, asset_.piece_count() + 1, "skin.covers");
  }

  bool check_layers() {
    const auto is_sorted = [](const Pair& before, const Pair& pair) { return pair.a < pair.b && before < pair; };
    const char* const fault = "a is not below b, or not sorted";
    return check_pairs(skin_.rest_contacts, asset_.info().triangle_count, "skin.rest_contacts", fault,
                       sizes_.rest_contacts, is_sorted) &&
           check_pairs(skin_.layer_pairs, sizes_.clusters, "skin.layer_pairs", fault, sizes_.layer_pairs, is_sorted) &&
           check_runs(skin_.layer_runs, skin_.layer_run_ends, std::size_t{2} * kIsDouble, "skin.layer_runs");
  }

  bool check_windings() {
    const std::size_t points = kCorePoints * asset_.part_count();
    return message_.has_size("skin.windings", skin_.windings.size, 3 * asset_.spheres().size, "spheres, thrice") &&
           message_.has_size("skin.core_windings", skin_.core_windings.size, 3 * points, "core points, thrice") &&
           check_stream(skin_.core_triangles, points, sizes_.triangles + 1, "skin.core_triangles");
  }

  bool check_sizes() {
    return std::max({sizes_.weights, sizes_.slot_morphs, sizes_.hull_weights}) <= kMaxEntries ||
           message_.wrong("skin: the tables would expand to more than 2^31 entries");
  }

  const AssetView& asset_;
  const SkinData& skin_;
  SkinSizes& sizes_;
  Message& message_;
};

}  // namespace

bool skin_values_are_valid(const AssetView& asset, SkinSizes& sizes, Message& message) {
  return SkinChecker(asset, sizes, message).run();
}

}  // namespace spherechain
