// SPDX-License-Identifier: MIT
#include "runtime/src/skin/skin_table.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "runtime/src/base/double3.h"
#include "runtime/src/base/memory.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/status.h"
#include "runtime/src/base/stream.h"
#include "runtime/src/skin/job_body.h"

namespace spherechain {
namespace {

// The header of a table. It holds the asset's sizes, because the bytes of another asset may lie at the same address.
// The arrays start at cache lines, so a table copied to another place in its line is invalid.
struct Header {
  std::uint64_t magic, asset, triangles, vertices, alignment;
};

constexpr std::uint64_t kMagic = 0x6B736E696B736373;  // says that the words are a table

Header header_of(const AssetView& asset, const std::uint64_t* words) {
  const SkinSizes& sizes = asset.skin().sizes;
  return {kMagic, reinterpret_cast<std::uintptr_t>(asset.spheres().data), sizes.triangles, sizes.vertices,
          reinterpret_cast<std::uintptr_t>(words) % 64};
}

// While the table is filled: where a vertex' bones, weights and morphs start; and the bones.
struct VertexTable {
  Span<std::uint32_t> first_bones, first_weights, first_morphs, bones;
};

// Sets the table's arrays; of null words only counts them.
std::size_t lay_out(const AssetView& asset, std::uint64_t* words, Surface& out, VertexTable& vertices) {
  const SkinData& skin = asset.skin();
  const SkinSizes& sizes = skin.sizes;
  WordMemory memory(words, sizeof(Header) / sizeof(std::uint64_t));
  memory.take(out.triangles, sizes.triangles);
  memory.take(out.clusters, sizes.clusters);
  memory.take(out.first_clusters, asset.spheres().size + 1);
  memory.take(out.cluster_vertices, sizes.cluster_vertices);
  memory.take(out.cluster_bones, sizes.cluster_bones);
  memory.take(out.parts, sizes.triangles);
  memory.take(out.layers, sizes.triangles);
  memory.take(out.triangle_vertices, 3 * sizes.triangles);
  memory.take(out.triangle_spheres, sizes.triangles);
  memory.take(out.place_of_source, asset.info().triangle_count);
  memory.take(out.part_runs, skin.part_runs.size + sizes.clusters);
  memory.take(out.first_of_part, asset.part_count() + 1);
  memory.take(out.part_areas, asset.part_count());
  memory.take(out.pieces, sizes.vertices);
  memory.take(out.source_vertices, sizes.vertices);
  memory.take(out.welds, sizes.vertices);
  memory.take(out.slot_positions, 3 * sizes.slots);
  memory.take(out.slot_weights, sizes.weights);
  memory.take(out.slot_morphs, sizes.slot_morphs);
  memory.take(out.bounds_first_terms, skin.bounds_term_counts.size + 1);
  memory.take(out.bounds_first_morphs, skin.bounds_morph_counts.size == 0 ? 0 : skin.bounds_morph_counts.size + 1);
  memory.take(out.rest_contacts, sizes.rest_contacts);
  memory.take(out.bone_boxes, asset.bone_count());
  memory.take(out.morph_reach, asset.morph_count());
  memory.take(out.hulls, sizes.hulls);
  memory.take(out.hull_points, 3 * sizes.hull_points);
  memory.take(out.hull_weights, sizes.hull_weights);
  memory.take(out.first_of_layers, sizes.clusters + 1);
  memory.take(out.layer_words, 2 * sizes.layer_pairs);
  memory.take(out.layer_bits, 2 * sizes.layer_pairs);
  memory.take(out.buried, words_for(sizes.clusters));
  memory.take(out.core_triangles, kCorePoints * asset.part_count());
  memory.take(vertices.first_bones, sizes.vertices + 1);
  memory.take(vertices.first_weights, sizes.vertices);
  memory.take(vertices.first_morphs, sizes.vertices + 1);
  memory.take(vertices.bones, sizes.influences);
  out.rest_positions = skin.positions;
  out.corners = skin.corners;
  out.boxes = skin.boxes;
  out.bounds_term_bones = skin.bounds_term_bones;
  out.bounds_terms = skin.bounds_terms;
  out.bounds_morph_targets = skin.bounds_morph_targets;
  out.bounds_morphs = skin.bounds_morphs;
  out.hull_bones = skin.hull_bones;
  out.windings = skin.windings;
  out.core_windings = skin.core_windings;
  return memory.used();
}

class Filler {
 public:
  Filler(const AssetView& asset, const Surface& out, const VertexTable& vertices)
      : asset_(asset), skin_(asset.skin()), out_(out), vertices_(vertices) {}

  void run() {
    fill_vertices();
    fill_clusters();
    fill_reach();
    fill_runs(skin_.part_runs, skin_.part_run_ends, out_.parts);
    fill_runs(skin_.layer_runs, skin_.layer_run_ends, out_.layers);
    fill_layers();
    fill_hulls();
    fill_starts(skin_.bounds_term_counts, out_.bounds_first_terms);
    fill_starts(skin_.bounds_morph_counts, out_.bounds_first_morphs);
    Stream triangles(skin_.triangles), pairs(skin_.rest_contacts), cores(skin_.core_triangles);
    std::fill(out_.place_of_source.begin(), out_.place_of_source.end(), kNoPlace);
    for (std::uint32_t t = 0; t < out_.triangles.size; ++t) {
      out_.triangles[t] = triangles.next();
      out_.place_of_source[out_.triangles[t]] = t;
    }
    fill_part_runs();
    fill_pieces();
    fill_part_areas();
    for (Pair& pair : out_.rest_contacts) {
      pair.a = pairs.next();
      pair.b = pairs.next();
    }
    for (std::uint32_t& core : out_.core_triangles) {
      core = cores.next() - 1;  // 0 is kNoPlace
    }
  }

 private:
  void fill_vertices() {
    Stream sources(skin_.sources), bones(skin_.influence_bones), welds(skin_.welds);
    std::uint32_t bone = 0, weight = 0, morph = 0, v = 0;
    for (; v < out_.source_vertices.size; ++v) {
      out_.source_vertices[v] = sources.next();
      out_.welds[v] = v;
      vertices_.first_bones[v] = bone;
      vertices_.first_weights[v] = weight;
      vertices_.first_morphs[v] = morph;
      bone += bones_of(v);
      weight += bones_of(v) - (leaves_one_out(v) ? 1U : 0U);
      morph += skin_.morph_counts.size == 0 ? 0U : skin_.morph_counts[v];
    }
    vertices_.first_bones[v] = bone;
    vertices_.first_morphs[v] = morph;
    for (std::uint32_t& entry : vertices_.bones) {
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
    const std::uint32_t* const bones = vertices_.bones.data + vertices_.first_bones[vertex];
    const float* const weights = skin_.influence_weights.data + vertices_.first_weights[vertex];
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
    std::uint32_t c = 0;
    for (; next.sphere < asset_.spheres().size; ++next.sphere) {
      out_.first_clusters[next.sphere] = c;
      for (std::uint32_t left = asset_.spheres()[next.sphere].triangle_count; left > 0; ++c) {
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
        std::fill_n(out_.triangle_spheres.data + cluster.first_triangle, cluster.triangle_count,
                    static_cast<std::uint16_t>(cluster.sphere));
        for (std::size_t i = 0; i < 3 * std::size_t{cluster.triangle_count}; ++i) {
          const std::size_t corner = 3 * std::size_t{cluster.first_triangle} + i;
          out_.triangle_vertices[corner] = out_.cluster_vertices[cluster.first_vertex + skin_.corners[corner]];
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
    out_.first_clusters[next.sphere] = c;
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
      for (std::uint32_t i = vertices_.first_morphs[vertex]; i < vertices_.first_morphs[vertex + 1]; ++i) {
        *end++ = {skin_.morphs[i].target, slot, skin_.morphs[i].delta};
      }
    }
    std::sort(first, end, [](const SlotMorph& l, const SlotMorph& r) {
      return l.target != r.target ? l.target < r.target : l.slot < r.slot;
    });
    cluster.morph_count = static_cast<std::uint32_t>(end - first);
  }

  void fill_reach() const {
    for (std::size_t bone = 0; bone < out_.bone_boxes.size; ++bone) {
      out_.bone_boxes[bone] = {{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};  // low and high so far
    }
    for (const Cluster& cluster : out_.clusters) {
      const std::size_t slots = slot_count(cluster);
      const float* const rest = out_.slot_positions.data + 3 * std::size_t{cluster.first_slot};
      for (std::size_t k = 0; k < cluster.bone_count; ++k) {
        BoneBox& box = out_.bone_boxes[out_.cluster_bones[cluster.first_bone + k]];
        const float* const weights = out_.slot_weights.data + cluster.first_weight + k * slots;
        for (std::size_t slot = 0; slot < slots; ++slot) {
          if (weights[slot] != 0) {
            const Vec3 p{rest[slot], rest[slots + slot], rest[2 * slots + slot]};
            box.center = {std::min(box.center.x, p.x), std::min(box.center.y, p.y), std::min(box.center.z, p.z)};
            box.half = {std::max(box.half.x, p.x), std::max(box.half.y, p.y), std::max(box.half.z, p.z)};
          }
        }
      }
    }
    for (BoneBox& box : out_.bone_boxes) {
      const Vec3 low = box.center, high = box.half;
      if (low.x <= high.x) {
        box.center = {0.5F * (low.x + high.x), 0.5F * (low.y + high.y), 0.5F * (low.z + high.z)};
        box.half = {0.5F * (high.x - low.x), 0.5F * (high.y - low.y), 0.5F * (high.z - low.z)};
      } else {
        box = {{0, 0, 0}, {-1, -1, -1}};
      }
    }
    std::fill(out_.morph_reach.begin(), out_.morph_reach.end(), 0.0F);
    for (const SlotMorph& morph : out_.slot_morphs) {
      const Vec3& d = morph.delta;
      float& reach = out_.morph_reach[morph.target];
      reach = std::max(reach, std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
    }
  }

  static void fill_runs(Span<const std::uint8_t> values, Span<const std::uint8_t> run_ends, Span<std::uint8_t> out) {
    Stream ends(run_ends);
    std::size_t triangle = 0;
    for (const std::uint8_t value : values) {
      for (const std::size_t end = ends.next(); triangle < end; ++triangle) {
        out[triangle] = value;
      }
    }
  }

  template <typename Visit>
  void for_layers(const Visit& visit) const {
    Stream pairs(skin_.layer_pairs);
    while (pairs.has_more()) {
      const std::uint32_t a = pairs.next(), b = pairs.next();
      visit(a, b);
      visit(b, a);
    }
  }
  // Pairs are sorted, so that the words of a row ascend, too.
  void fill_layers() const {
    std::fill(out_.buried.begin(), out_.buried.end(), std::uint64_t{0});
    for (std::size_t c = 0; c < out_.clusters.size; ++c) {
      out_.buried[c / 64] |= std::uint64_t{skin_.clusters[c].is_buried} << c % 64;
    }
    // A row's start is first its length, then where it has been filled up to, which is the next one's start.
    std::uint32_t* const ends = out_.first_of_layers.data;
    std::fill(out_.first_of_layers.begin(), out_.first_of_layers.end(), 0U);
    for_layers([&](std::uint32_t of, std::uint32_t) { ++ends[of + 1]; });
    for (std::size_t c = 1; c < out_.first_of_layers.size; ++c) {
      ends[c] += ends[c - 1];
    }
    for_layers([&](std::uint32_t of, std::uint32_t other) {
      out_.layer_words[ends[of]] = other / 64;
      out_.layer_bits[ends[of]++] = std::uint64_t{1} << other % 64;
    });
    std::uint32_t first = 0, kept = 0;
    for (std::size_t c = 0; c < out_.clusters.size; ++c) {
      const std::uint32_t end = ends[c], own = kept;
      for (; first < end; ++first) {
        const bool goes_on = kept > own && out_.layer_words[kept - 1] == out_.layer_words[first];
        const std::uint64_t bits = (goes_on ? out_.layer_bits[kept - 1] : 0) | out_.layer_bits[first];
        kept += goes_on ? 0 : 1;
        out_.layer_words[kept - 1] = out_.layer_words[first];
        out_.layer_bits[kept - 1] = bits;
      }
      ends[c] = own;
    }
    ends[out_.clusters.size] = kept;
  }

  // Calls visit(part, run) for each run of consecutive triangles of one part within a cluster.
  template <typename Visit>
  void for_part_runs(const Visit& visit) const {
    for (std::uint32_t c = 0; c < out_.clusters.size; ++c) {
      const std::uint32_t end = out_.clusters[c].first_triangle + out_.clusters[c].triangle_count;
      for (std::uint32_t t = out_.clusters[c].first_triangle, next = t; t < end; t = next) {
        while (next < end && out_.parts[next] == out_.parts[t]) {
          ++next;
        }
        visit(out_.parts[t], TriangleRun{c, t, next - t});
      }
    }
  }
  void fill_part_runs() const {
    std::fill(out_.first_of_part.begin(), out_.first_of_part.end(), 0U);
    for_part_runs([&](std::size_t part, const TriangleRun&) { ++out_.first_of_part[part + 1]; });
    for (std::size_t part = 1; part < out_.first_of_part.size; ++part) {
      out_.first_of_part[part] += out_.first_of_part[part - 1];
    }
    // Each start moves on to the part's end, which is the next one's start.
    for_part_runs([&](std::size_t part, const TriangleRun& run) { out_.part_runs[out_.first_of_part[part]++] = run; });
    for (std::size_t part = out_.first_of_part.size - 1; part > 0; --part) {
      out_.first_of_part[part] = out_.first_of_part[part - 1];
    }
    out_.first_of_part[0] = 0;
  }

  void fill_part_areas() const {
    for (std::size_t part = 0; part < out_.part_areas.size; ++part) {
      double area = 0, seen_area = 0;
      for (std::uint32_t i = out_.first_of_part[part]; i < out_.first_of_part[part + 1]; ++i) {
        for (std::uint32_t t = out_.part_runs[i].first; t < out_.part_runs[i].first + out_.part_runs[i].count; ++t) {
          const double of_triangle = area_of(out_.triangle_vertices.data + 3 * std::size_t{t});
          area += of_triangle;
          seen_area += is_covered(out_, t) ? 0 : of_triangle;
        }
      }
      out_.part_areas[part] = static_cast<float>(seen_area > 0 ? seen_area : area);
    }
  }
  double area_of(const std::uint32_t* vertices) const {
    Double3 p[3];
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const at = skin_.positions.data + 3 * std::size_t{vertices[i]};
      p[i] = {double{at[0]}, double{at[1]}, double{at[2]}};
    }
    return 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
  }

  // Each vertex points to one of its piece with a number no higher than its own; the lowest stands for the piece.
  std::uint32_t piece_of(std::uint32_t vertex) const {
    while (out_.pieces[vertex] != vertex) {
      vertex = out_.pieces[vertex] = out_.pieces[out_.pieces[vertex]];
    }
    return vertex;
  }
  void join(std::uint32_t v, std::uint32_t w) const {
    const std::uint32_t a = piece_of(v), b = piece_of(w);
    out_.pieces[std::max(a, b)] = std::min(a, b);
  }
  void fill_pieces() const {
    for (std::uint32_t v = 0; v < out_.pieces.size; ++v) {
      out_.pieces[v] = v;
    }
    for (std::uint32_t v = 0; v < out_.pieces.size; ++v) {
      join(v, out_.welds[v]);
    }
    for (std::size_t t = 0; t < out_.triangles.size; ++t) {
      join(out_.triangle_vertices[3 * t], out_.triangle_vertices[3 * t + 1]);
      join(out_.triangle_vertices[3 * t], out_.triangle_vertices[3 * t + 2]);
    }
    for (std::uint32_t v = 0; v < out_.pieces.size; ++v) {
      out_.pieces[v] = piece_of(v);
    }
  }

  void fill_hulls() {
    Stream points(skin_.hull_points);
    Hull next{};
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
      next.first_bone += packed.bone_count;
      next.first_point += packed.point_count;
      next.first_weight += static_cast<std::uint32_t>(packed.point_count) * packed.bone_count;
    }
  }

  // Start of each run, from the runs' counts of entries, and the end of the last.
  static void fill_starts(Span<const std::uint32_t> counts, Span<std::uint32_t> starts) {
    for (std::size_t i = 0; i < starts.size; ++i) {
      starts[i] = i == 0 ? 0 : starts[i - 1] + counts[i - 1];
    }
  }

  const AssetView& asset_;
  const SkinData& skin_;
  const Surface& out_;
  const VertexTable& vertices_;
};

}  // namespace

std::size_t skin_table_words(const AssetView& asset) {
  Surface surface;
  VertexTable vertices;
  return asset.is_open() && asset.skin().sizes.clusters > 0 ? lay_out(asset, nullptr, surface, vertices) : 0;
}

Status read_skin_table(const AssetView& asset, const std::uint64_t* words, Surface& out) {
  if (words == nullptr) {
    return refuse(SC_NULL, SC_FIELD_SKIN_TABLE);
  }
  if (any_misaligned(words)) {
    return refuse(SC_MISALIGNED, SC_FIELD_SKIN_TABLE);
  }
  const Header header = header_of(asset, words);
  if (std::memcmp(words, &header, sizeof header) != 0) {
    return refuse(SC_BAD_VALUE, SC_FIELD_SKIN_TABLE);
  }
  VertexTable vertices;
  lay_out(asset, const_cast<std::uint64_t*>(words), out, vertices);
  return done();
}

std::size_t skin_table_words(const Asset* asset) noexcept {
  return asset == nullptr ? 0 : skin_table_words(view_of(*asset));
}

Status prepare_skin(const Asset* asset, std::uint64_t* words, std::size_t word_count) noexcept {
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
  Surface surface;
  VertexTable vertices;
  lay_out(view, words, surface, vertices);
  const Header header = header_of(view, words);
  std::memcpy(words, &header, sizeof header);
  Filler(view, surface, vertices).run();
  return done();
}

}  // namespace spherechain
