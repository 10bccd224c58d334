// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/write/skin_packing.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <map>
#include <type_traits>

#include "baker/mesh/error.h"
#include "baker/write/schema_values.h"
#include "baker/write/stream.h"
#include "runtime/src/asset/skin_data.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kLanes = 8;
using Eight = std::array<float, kLanes>;

struct EightBalls {
  std::array<Eight, 4> values{};

  void set(std::size_t lane, const Ball& ball) {
    for (std::size_t i = 0; i < 3; ++i) {
      values[i][lane] = static_cast<float>(ball.center[static_cast<Eigen::Index>(i)]);
    }
    values[3][lane] = static_cast<float>(ball.radius);
  }
  schema::BallLanes stored() const {
    return {span_of(values[0]), span_of(values[1]), span_of(values[2]), span_of(values[3])};
  }
};

struct EightBoxes {
  std::array<Eight, 7> values{};

  void set(std::size_t lane, const ClusterBox& box) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      values[i][lane] = static_cast<float>(box.center[axis]);
      values[3 + i][lane] = static_cast<float>(box.half[axis]);
    }
    values[6][lane] = static_cast<float>(box.radius);
  }
  schema::BoxLanes stored() const {
    return {span_of(values[0]), span_of(values[1]), span_of(values[2]), span_of(values[3]),
            span_of(values[4]), span_of(values[5]), span_of(values[6])};
  }
};

struct EightWeights {
  Eight weights{}, deviations{};
};

// Bounds of groups of eight successive clusters.
struct Groups {
  std::vector<schema::BoxLanes> boxes;
  std::vector<std::uint32_t> term_counts, term_bones, morph_counts, morph_targets;
  std::vector<schema::BoundsTerm> terms;
  std::vector<schema::BallLanes> morphs;
};

Groups group_clusters(const std::vector<Cluster>& clusters, bool moves) {
  Groups out;
  for (std::size_t first = 0; first < clusters.size(); first += kLanes) {
    EightBoxes boxes;
    std::map<Index, EightWeights> terms;
    std::map<Index, EightBalls> morphs;
    for (std::size_t lane = 0; lane < std::min(kLanes, clusters.size() - first); ++lane) {
      const Cluster& cluster = clusters[first + lane];
      boxes.set(lane, cluster.box);
      for (const ClusterBone& bone : cluster.bones) {
        terms[bone.bone].weights[lane] = bone.weight;
        terms[bone.bone].deviations[lane] = bone.deviation;
      }
      for (const ClusterMorph& morph : cluster.morphs) morphs[morph.target].set(lane, morph.ball);
    }
    out.boxes.push_back(boxes.stored());
    if (moves) out.term_counts.push_back(static_cast<std::uint32_t>(terms.size()));
    for (const auto& [bone, term] : terms) {
      out.term_bones.push_back(bone);
      out.terms.emplace_back(span_of(term.weights), span_of(term.deviations));
    }
    out.morph_counts.push_back(static_cast<std::uint32_t>(morphs.size()));
    for (const auto& [target, ball] : morphs) {
      out.morph_targets.push_back(target);
      out.morphs.push_back(ball.stored());
    }
  }
  if (out.morphs.empty()) out.morph_counts.clear();
  return out;
}

struct Vertices {
  StreamWriter sources, welds, bones;
  std::vector<float> positions, weights;
  std::vector<std::uint8_t> counts;
  std::vector<std::uint16_t> morph_counts;
  std::vector<schema::MorphDelta> morphs;
};

// The greatest weight first; left out where it is what the others leave of 1, to the last bit, as it is for most.
void add_influences(std::vector<Influence> influences, Vertices& out) {
  constexpr std::uint8_t kOneIsLeftOut = 128;
  if (influences.empty()) {
    out.counts.push_back(0);
    return;
  }
  std::rotate(influences.begin(), std::ranges::max_element(influences, {}, &Influence::weight),
              std::ranges::max_element(influences, {}, &Influence::weight) + 1);
  float others = 0;
  for (std::size_t k = 1; k < influences.size(); ++k) others += influences[k].weight;
  const bool one_is_left_out =
      std::bit_cast<std::uint32_t>(1 - others) == std::bit_cast<std::uint32_t>(influences.front().weight);
  out.counts.push_back(static_cast<std::uint8_t>(influences.size() | (one_is_left_out ? kOneIsLeftOut : 0)));
  for (std::size_t k = 0; k < influences.size(); ++k) {
    out.bones.put(influences[k].bone);
    if (k > 0 || !one_is_left_out) out.weights.push_back(influences[k].weight);
  }
}

Vertices vertices_of(const Character& character, const Clusters& in) {
  Vertices out;
  for (Index v = 0; v < in.vertices.size(); ++v) {
    const SurfaceVertex& vertex = in.vertices[v];
    out.sources.put(vertex.source);
    if (vertex.weld != v) {
      out.welds.put(v);
      out.welds.put(vertex.weld);
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      out.positions.push_back(static_cast<float>(character.source_positions[vertex.source][axis]));
    }
    add_influences(vertex.influences, out);
    if (vertex.morphs.size() > std::numeric_limits<std::uint16_t>::max()) {
      throw Error(ExitCode::kFile, character.file + ": a vertex has more than 65535 morph targets");
    }
    out.morph_counts.push_back(static_cast<std::uint16_t>(vertex.morphs.size()));
    for (const MorphDelta& morph : vertex.morphs) out.morphs.emplace_back(morph.target, to_schema(morph.delta));
  }
  if (out.morphs.empty()) out.morph_counts.clear();
  return out;
}

// Runs of equal bytes, and where they end.
struct RunsOfBytes {
  std::vector<std::uint8_t> values;
  StreamWriter ends;

  RunsOfBytes() = default;
  explicit RunsOfBytes(const std::vector<std::uint8_t>& bytes) {
    for (std::uint32_t i = 0; i < bytes.size(); ++i) {
      if (i == 0 || bytes[i] != bytes[i - 1]) values.push_back(bytes[i]);
      if (i + 1 == bytes.size() || bytes[i] != bytes[i + 1]) ends.put(i + 1);
    }
  }
};

struct Runs {
  StreamWriter triangles, vertices, bones;
  std::vector<std::uint8_t> corners;
  RunsOfBytes parts, layers;
  std::vector<schema::Cluster> clusters;
};

Runs runs_of(const Character& character, const Clusters& in, const BodyParts& parts, const Layers& layers) {
  Runs out;
  std::vector<std::uint8_t> part_of_triangle;
  for (const Cluster& cluster : in.clusters) {
    out.clusters.emplace_back(
        static_cast<std::uint8_t>(cluster.triangles.size()), static_cast<std::uint8_t>(cluster.vertices.size()),
        static_cast<std::uint16_t>(cluster.bones.size()),
        layers.is_buried.empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(layers.is_buried[out.clusters.size()]),
        std::uint8_t{0});
    for (const Index vertex : cluster.vertices) out.vertices.put(vertex);
    for (const ClusterBone& bone : cluster.bones) out.bones.put(bone.bone);
    for (const Index t : cluster.triangles) {
      const Index source = character.skin_source_triangle[t];
      out.triangles.put(source);
      for (const Index v : character.source_triangles[source]) {
        const auto slot = std::ranges::lower_bound(cluster.vertices, in.vertex_of_source[v]);
        out.corners.push_back(static_cast<std::uint8_t>(slot - cluster.vertices.begin()));
      }
      part_of_triangle.push_back(parts.of_triangle[source]);
    }
  }
  out.parts = RunsOfBytes(part_of_triangle);
  out.layers = RunsOfBytes(layers.of_triangle.empty() ? std::vector<std::uint8_t>(part_of_triangle.size(), 0)
                                                      : layers.of_triangle);
  return out;
}

StreamWriter stream_of(const Layers::Pairs& pairs) {
  StreamWriter out;
  for (const auto& [a, b] : pairs) {
    out.put(a);
    out.put(b);
  }
  return out;
}

struct PackedHulls {
  std::vector<schema::Hull> hulls;
  std::vector<schema::HullBone> bones;
  StreamWriter points;
};

PackedHulls hulls_of(const Clusters& in) {
  PackedHulls out;
  for (const Hull& hull : in.hulls) {
    out.hulls.emplace_back(static_cast<std::uint16_t>(hull.bones.size()),
                           static_cast<std::uint16_t>(hull.points.size()), to_schema(hull.center),
                           static_cast<float>(hull.radius), static_cast<float>(hull.slack));
    for (const HullBone& bone : hull.bones) {
      out.bones.emplace_back(bone.bone, bone.off[0], bone.off[1], bone.off[2], bone.off[3]);
    }
    for (const Index point : hull.points) out.points.put(point);
  }
  return out;
}

}  // namespace

flatbuffers::Offset<schema::Skin> create_skin(flatbuffers::FlatBufferBuilder& builder, const Character& character,
                                              const BoneBinding& bones, const Clusters& clusters,
                                              const BodyParts& parts, const Layers& layers, std::size_t sphere_count) {
  const Vertices vertices = vertices_of(character, clusters);
  const Runs runs = runs_of(character, clusters, parts, layers);
  const Groups groups = group_clusters(clusters.clusters, !bones.bones.empty());
  const PackedHulls hulls = hulls_of(clusters);
  // Where nothing is known yet, there are as many zeros as the runtime expects numbers.
  const auto or_zeros = [](const auto& numbers, std::size_t count) {
    return numbers.empty() ? std::decay_t<decltype(numbers)>(count, 0) : numbers;
  };
  const std::size_t cores = kCorePoints * parts.parts.size();
  StreamWriter core_triangles;
  for (const std::uint32_t t : or_zeros(layers.core_triangles, cores)) core_triangles.put(t);
  const auto bytes = [&](const StreamWriter& stream) { return builder.CreateVector(stream.bytes()); };
  const auto triangles_at = bytes(runs.triangles);
  const auto corners_at = builder.CreateVector(runs.corners);
  const auto parts_at = builder.CreateVector(runs.parts.values);
  const auto part_ends_at = bytes(runs.parts.ends);
  const auto clusters_at = builder.CreateVectorOfStructs(runs.clusters);
  const auto cluster_vertices_at = bytes(runs.vertices);
  const auto cluster_bones_at = bytes(runs.bones);
  const auto sources_at = bytes(vertices.sources);
  const auto welds_at = bytes(vertices.welds);
  const auto positions_at = builder.CreateVector(vertices.positions);
  const auto counts_at = builder.CreateVector(vertices.counts);
  const auto bones_at = bytes(vertices.bones);
  const auto weights_at = builder.CreateVector(vertices.weights);
  const auto morph_counts_at = builder.CreateVector(vertices.morph_counts);
  const auto morphs_at = builder.CreateVectorOfStructs(vertices.morphs);
  const auto boxes_at = aligned_vector(builder, groups.boxes);
  const auto term_counts_at = builder.CreateVector(groups.term_counts);
  const auto term_bones_at = builder.CreateVector(groups.term_bones);
  const auto terms_at = aligned_vector(builder, groups.terms);
  const auto bounds_morph_counts_at = builder.CreateVector(groups.morph_counts);
  const auto bounds_morph_targets_at = builder.CreateVector(groups.morph_targets);
  const auto bounds_morphs_at = aligned_vector(builder, groups.morphs);
  std::vector<flatbuffers::Offset<schema::Piece>> pieces;
  for (const SkinPiece& piece : layers.pieces) {
    pieces.push_back(
        schema::CreatePiece(builder, builder.CreateSharedString(piece.name), static_cast<float>(piece.border)));
  }
  StreamWriter covers;
  std::vector<float> cover_distances;
  for (std::size_t c = 0; c < clusters.clusters.size(); ++c) {
    const Layers::Cover cover = layers.covers.empty() ? Layers::Cover{} : layers.covers[c];
    covers.put(cover.piece);
    cover_distances.push_back(cover.distance);
  }
  const auto pieces_at = builder.CreateVector(pieces);
  const auto covers_at = bytes(covers);
  const auto cover_distances_at = builder.CreateVector(cover_distances);
  const auto contacts_at = bytes(stream_of(layers.rest_contacts)), layer_pairs_at = bytes(stream_of(layers.pairs));
  const auto layers_at = builder.CreateVector(runs.layers.values);
  const auto layer_ends_at = bytes(runs.layers.ends);
  const auto windings_at = builder.CreateVector(or_zeros(layers.windings, 3 * sphere_count));
  const auto core_triangles_at = bytes(core_triangles);
  const auto core_windings_at = builder.CreateVector(or_zeros(layers.core_windings, 3 * cores));
  const auto hulls_at = builder.CreateVectorOfStructs(hulls.hulls);
  const auto hull_bones_at = builder.CreateVectorOfStructs(hulls.bones);
  const auto hull_points_at = bytes(hulls.points);
  return schema::CreateSkin(builder, static_cast<std::uint32_t>(clusters.vertices.size()), triangles_at, corners_at,
                            parts_at, part_ends_at, clusters_at, cluster_vertices_at, cluster_bones_at, sources_at,
                            welds_at, positions_at, counts_at, bones_at, weights_at, morph_counts_at, morphs_at,
                            boxes_at, term_counts_at, term_bones_at, terms_at, bounds_morph_counts_at,
                            bounds_morph_targets_at, bounds_morphs_at, pieces_at, covers_at, cover_distances_at,
                            contacts_at, layer_pairs_at, layers_at, layer_ends_at, windings_at, core_triangles_at,
                            core_windings_at, hulls_at, hull_bones_at, hull_points_at);
}

}  // namespace spherechain::baker
