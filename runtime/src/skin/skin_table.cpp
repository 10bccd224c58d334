// SPDX-License-Identifier: MIT
#include "skin/skin_table.h"

#include <algorithm>
#include <type_traits>

#include "asset/memory.h"
#include "asset/status.h"
#include "asset/stream.h"
#include "spherechain/skin_contacts.h"

namespace spherechain {
namespace {

constexpr std::uint64_t kMagic = 0x6B736E696B736373;  // says that the words are a table
enum Place : std::size_t { kIsTable, kAsset, kTriangles, kVertices, kAlignment, kHeaderWords };

std::uint64_t key_of(const AssetView& asset) { return reinterpret_cast<std::uintptr_t>(asset.spheres().data); }

// The arrays start at cache lines: a table that was copied to another place in its line is none.
std::uint64_t alignment_of(const std::uint64_t* words) { return reinterpret_cast<std::uintptr_t>(words) % 64; }

// Hands out the table's arrays, each from a cache line on; of null words only counts them.
class Layout {
 public:
  Layout(const AssetView& asset, std::uint64_t* words) : words_(words), used_(kHeaderWords) {
    const SkinSizes& sizes = asset.skin().sizes;
    take(triangles, sizes.triangles);
    take(clusters, sizes.clusters);
    take(cluster_vertices, sizes.cluster_vertices);
    take(cluster_bones, sizes.cluster_bones);
    take(parts, sizes.triangles);
    take(source_vertices, sizes.vertices);
    take(welds, sizes.vertices);
    take(slot_positions, 3 * sizes.slots);
    take(slot_weights, sizes.weights);
    take(slot_morphs, sizes.slot_morphs);
    take(rest_contacts, sizes.rest_contacts);
    take(hulls, sizes.hulls);
    take(hull_points, 3 * sizes.hull_points);
    take(hull_weights, sizes.hull_weights);
    // While the table is filled: where a vertex' bones, weights and morphs start; and the bones.
    take(first_bones, sizes.vertices + 1);
    take(first_weights, sizes.vertices);
    take(first_morphs, sizes.vertices + 1);
    take(bones, sizes.influences);
  }

  std::size_t words() const { return used_; }

  Span<std::uint32_t> triangles, cluster_vertices, cluster_bones, source_vertices, welds;
  Span<std::uint8_t> parts;
  Span<Cluster> clusters;
  Span<float> slot_positions, slot_weights, hull_points, hull_weights;
  Span<SlotMorph> slot_morphs;
  Span<Pair> rest_contacts;
  Span<Hull> hulls;
  Span<std::uint32_t> first_bones, first_weights, first_morphs, bones;

 private:
  // Vectors of any target may be read this far past an array's end.
  static constexpr std::size_t kLine = 64 / sizeof(std::uint64_t);

  template <typename T>
  void take(Span<T>& out, std::size_t count) {
    const auto misplaced = reinterpret_cast<std::uintptr_t>(words_ + used_) / sizeof(std::uint64_t) % kLine;
    used_ += words_ == nullptr ? kLine : (kLine - misplaced) % kLine;
    out = {words_ == nullptr ? nullptr : reinterpret_cast<T*>(words_ + used_), count};
    used_ += (count * sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t) + kLine;
  }

  std::uint64_t* words_;
  std::size_t used_;
};

class Filler {
 public:
  Filler(const AssetView& asset, const Layout& out) : asset_(asset), skin_(asset.skin()), out_(out) {}

  void run() {
    fill_vertices();
    fill_clusters();
    fill_parts();
    fill_hulls();
    Stream triangles(skin_.triangles), pairs(skin_.rest_contacts);
    for (std::uint32_t& triangle : out_.triangles) {
      triangle = triangles.next();
    }
    for (Pair& pair : out_.rest_contacts) {
      pair.a = pairs.next();
      pair.b = pairs.next();
    }
  }

 private:
  void fill_vertices() {
    Stream sources(skin_.sources), bones(skin_.influence_bones), welds(skin_.welds);
    std::uint32_t bone = 0, weight = 0, morph = 0, v = 0;
    for (; v < out_.source_vertices.size; ++v) {
      out_.source_vertices[v] = sources.next();
      out_.welds[v] = v;
      out_.first_bones[v] = bone;
      out_.first_weights[v] = weight;
      out_.first_morphs[v] = morph;
      bone += bones_of(v);
      weight += bones_of(v) - (leaves_one_out(v) ? 1U : 0U);
      morph += skin_.morph_counts.size == 0 ? 0U : skin_.morph_counts[v];
    }
    out_.first_bones[v] = bone;
    out_.first_morphs[v] = morph;
    for (std::uint32_t& entry : out_.bones) {
      entry = bones.next();
    }
    while (welds.has_more()) {
      const std::uint32_t vertex = welds.next();
      out_.welds[vertex] = welds.next();
    }
  }

  std::uint32_t bones_of(std::size_t vertex) const {
    return skin_.influence_counts[vertex] & ~unsigned{kOneWeightLeftOut};
  }
  bool leaves_one_out(std::size_t vertex) const { return skin_.influence_counts[vertex] >= kOneWeightLeftOut; }

  // 0 where the bone does not move the vertex.
  float weight_of(std::uint32_t vertex, std::uint32_t bone) const {
    const std::uint32_t count = bones_of(vertex);
    const std::uint32_t* const bones = out_.bones.data + out_.first_bones[vertex];
    const float* const weights = skin_.influence_weights.data + out_.first_weights[vertex];
    const auto k = static_cast<std::uint32_t>(std::find(bones, bones + count, bone) - bones);
    if (k == count) {
      return 0;
    }
    if (!leaves_one_out(vertex)) {
      return weights[k];
    }
    if (k > 0) {
      return weights[k - 1];
    }
    float others = 0;
    for (std::uint32_t i = 0; i + 1 < count; ++i) {
      others += weights[i];
    }
    return 1 - others;
  }

  void fill_clusters() {
    Stream vertices(skin_.cluster_vertices), bones(skin_.cluster_bones);
    Cluster next{};
    std::uint32_t left = asset_.spheres()[0].triangle_count;
    for (std::size_t c = 0; c < out_.clusters.size; ++c) {
      while (left == 0) {
        left = asset_.spheres()[++next.sphere].triangle_count;
      }
      const PackedCluster& packed = skin_.clusters[c];
      Cluster& cluster = out_.clusters[c];
      cluster = next;
      cluster.triangle_count = packed.triangle_count;
      cluster.vertex_count = packed.vertex_count;
      cluster.bone_count = packed.bone_count;
      for (std::uint32_t i = 0; i < cluster.vertex_count; ++i) {
        out_.cluster_vertices[cluster.first_vertex + i] = vertices.next();
      }
      for (std::uint32_t i = 0; i < cluster.bone_count; ++i) {
        out_.cluster_bones[cluster.first_bone + i] = bones.next();
      }
      fill_slots(cluster);
      fill_morphs(cluster);
      const auto slots = static_cast<std::uint32_t>(slot_count(cluster));
      left -= cluster.triangle_count;
      next.first_triangle += cluster.triangle_count;
      next.first_vertex += cluster.vertex_count;
      next.first_bone += cluster.bone_count;
      next.first_slot += slots;
      next.first_weight += slots * cluster.bone_count;
      next.first_morph += cluster.morph_count;
    }
  }

  // Slots beyond the vertices repeat the last.
  std::uint32_t vertex_in(const Cluster& cluster, std::size_t slot) const {
    const std::size_t last = cluster.vertex_count - std::size_t{1};
    return out_.cluster_vertices[cluster.first_vertex + std::min(slot, last)];
  }

  void fill_slots(const Cluster& cluster) const {
    const std::size_t slots = slot_count(cluster);
    for (std::size_t slot = 0; slot < slots; ++slot) {
      const std::uint32_t vertex = vertex_in(cluster, slot);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        out_.slot_positions[3 * std::size_t{cluster.first_slot} + axis * slots + slot] =
            skin_.positions[3 * std::size_t{vertex} + axis];
      }
      for (std::size_t k = 0; k < cluster.bone_count; ++k) {
        out_.slot_weights[cluster.first_weight + k * slots + slot] =
            weight_of(vertex, out_.cluster_bones[cluster.first_bone + k]);
      }
    }
  }

  void fill_morphs(Cluster& cluster) const {
    SlotMorph* const first = out_.slot_morphs.data + cluster.first_morph;
    SlotMorph* end = first;
    for (std::uint32_t slot = 0; slot < slot_count(cluster); ++slot) {
      const std::uint32_t vertex = vertex_in(cluster, slot);
      for (std::uint32_t i = out_.first_morphs[vertex]; i < out_.first_morphs[vertex + 1]; ++i) {
        *end++ = {skin_.morphs[i].target, slot, skin_.morphs[i].delta};
      }
    }
    std::sort(first, end, [](const SlotMorph& l, const SlotMorph& r) {
      return l.target != r.target ? l.target < r.target : l.slot < r.slot;
    });
    cluster.morph_count = static_cast<std::uint32_t>(end - first);
  }

  void fill_parts() const {
    Stream ends(skin_.part_run_ends);
    std::size_t triangle = 0;
    for (const std::uint8_t part : skin_.part_runs) {
      for (const std::size_t end = ends.next(); triangle < end; ++triangle) {
        out_.parts[triangle] = part;
      }
    }
  }

  void fill_hulls() {
    Stream points(skin_.hull_points);
    Hull next{};
    std::uint32_t cluster = 0;
    for (std::size_t s = 0; s < out_.hulls.size; ++s) {
      const PackedHull& packed = skin_.hulls[s];
      Hull& hull = out_.hulls[s];
      hull = next;
      hull.bone_count = packed.bone_count;
      hull.point_count = packed.point_count;
      hull.center = packed.center;
      hull.radius = packed.radius;
      hull.slack = packed.slack;
      const std::size_t count = hull.point_count;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t vertex = points.next();
        for (std::size_t axis = 0; axis < 3; ++axis) {
          out_.hull_points[3 * std::size_t{hull.first_point} + axis * count + i] =
              skin_.positions[3 * std::size_t{vertex} + axis];
        }
        for (std::size_t k = 0; k < hull.bone_count; ++k) {
          out_.hull_weights[hull.first_weight + k * count + i] =
              weight_of(vertex, skin_.hull_bones[hull.first_bone + k].bone);
        }
      }
      while (cluster < out_.clusters.size && out_.clusters[cluster].sphere == s) {
        ++cluster;
      }
      next.first_cluster = cluster;
      next.first_bone += packed.bone_count;
      next.first_point += packed.point_count;
      next.first_weight += static_cast<std::uint32_t>(packed.point_count) * packed.bone_count;
    }
  }

  const AssetView& asset_;
  const SkinData& skin_;
  const Layout& out_;
};

}  // namespace

std::size_t skin_table_words(const AssetView& asset) {
  return asset.is_open() && asset.skin().sizes.clusters > 0 ? Layout(asset, nullptr).words() : 0;
}

void fill_skin_table(const AssetView& asset, std::uint64_t* words) {
  const Layout layout(asset, words);
  words[kIsTable] = kMagic;
  words[kAsset] = key_of(asset);
  words[kTriangles] = asset.skin().sizes.triangles;
  words[kVertices] = asset.skin().sizes.vertices;
  words[kAlignment] = alignment_of(words);
  Filler(asset, layout).run();
}

Status read_skin_table(const AssetView& asset, const std::uint64_t* words, Surface& out) {
  if (words == nullptr) {
    return refuse(SC_NULL, SC_FIELD_SKIN_TABLE);
  }
  if (any_misaligned(words)) {
    return refuse(SC_MISALIGNED, SC_FIELD_SKIN_TABLE);
  }
  // The bytes of another asset may have come to lie at the same address.
  const SkinData& skin = asset.skin();
  if (words[kIsTable] != kMagic || words[kAsset] != key_of(asset) || words[kTriangles] != skin.sizes.triangles ||
      words[kVertices] != skin.sizes.vertices || words[kAlignment] != alignment_of(words)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_SKIN_TABLE);
  }
  const Layout table(asset, const_cast<std::uint64_t*>(words));
  const auto view = [](const auto& span) {
    return Span<const std::remove_pointer_t<decltype(span.data)>>{span.data, span.size};
  };
  out = {view(table.triangles),
         view(table.clusters),
         view(table.cluster_vertices),
         view(table.cluster_bones),
         skin.corners,
         view(table.parts),
         view(table.source_vertices),
         view(table.welds),
         view(table.slot_positions),
         view(table.slot_weights),
         view(table.slot_morphs),
         skin.boxes,
         skin.bounds_term_counts,
         skin.bounds_term_bones,
         skin.bounds_terms,
         skin.bounds_morph_counts,
         skin.bounds_morph_targets,
         skin.bounds_morphs,
         view(table.rest_contacts),
         view(table.hulls),
         skin.hull_bones,
         view(table.hull_points),
         view(table.hull_weights)};
  return done();
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_skin_table_words(const sc_asset* asset) noexcept {
  return asset == nullptr ? 0 : skin_table_words(view_of(*asset));
}

sc_status sc_prepare_skin(const sc_asset* asset, uint64_t* words, size_t word_count) noexcept {
  if (asset == nullptr || words == nullptr) {
    return refuse(SC_NULL, asset == nullptr ? SC_FIELD_ASSET : SC_FIELD_SKIN_TABLE);
  }
  const AssetView& view = view_of(*asset);
  if (!view.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  if (any_misaligned(words)) {
    return refuse(SC_MISALIGNED, SC_FIELD_SKIN_TABLE);
  }
  if (view.skin().sizes.clusters == 0) {
    return refuse(SC_NOT_IN_ASSET, SC_FIELD_ASSET);
  }
  if (word_count < skin_table_words(view)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SKIN_TABLE);
  }
  fill_skin_table(view, words);
  return done();
}

}  // extern "C"
