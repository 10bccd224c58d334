// SPDX-License-Identifier: GPL-3.0-or-later
#include "write/surface_table.h"

#include <algorithm>
#include <array>
#include <map>

#include "write/schema_values.h"

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

  void set(std::size_t lane, const Box& box) {
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

// All that eight leaves, one after another, have in common.
struct Groups {
  std::vector<schema::BallLanes> balls;
  std::vector<schema::BoxLanes> boxes;
  std::vector<std::uint32_t> term_counts, term_bones, morph_counts, morph_targets;
  std::vector<schema::CoverTerm> terms;
  std::vector<schema::BallLanes> morphs;
};

Groups group_leaves(const std::vector<Cluster>& leaves, bool moves) {
  Groups out;
  for (std::size_t first = 0; first < leaves.size(); first += kLanes) {
    EightBalls balls;
    EightBoxes boxes;
    std::map<Index, EightWeights> terms;
    std::map<Index, EightBalls> morphs;
    for (std::size_t lane = 0; lane < std::min(kLanes, leaves.size() - first); ++lane) {
      const Cluster& leaf = leaves[first + lane];
      balls.set(lane, leaf.ball);
      boxes.set(lane, leaf.box);
      for (const ClusterBone& bone : leaf.bones) {
        terms[bone.bone].weights[lane] = bone.weight;
        terms[bone.bone].deviations[lane] = bone.deviation;
      }
      for (const ClusterMorph& morph : leaf.morphs) morphs[morph.target].set(lane, morph.ball);
    }
    out.balls.push_back(balls.stored());
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

// The leaves' own runs.
struct Runs {
  std::vector<schema::Leaf> leaves;
  std::vector<std::uint32_t> vertices, bones;
  std::vector<std::uint8_t> corners;
  std::vector<float> positions, weights;
  std::vector<schema::SlotMorph> morphs;
};

void add_slots(const Character& character, const Clusters& in, const Cluster& leaf, Runs& out) {
  const std::size_t slots = (leaf.vertices.size() + kLanes - 1) / kLanes * kLanes;
  // The slots beyond the vertices repeat the last.
  const auto vertex_in = [&](std::size_t slot) -> const SurfaceVertex& {
    return in.vertices[leaf.vertices[std::min(slot, leaf.vertices.size() - 1)]];
  };
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (std::size_t slot = 0; slot < slots; ++slot) {
      out.positions.push_back(static_cast<float>(character.source_positions[vertex_in(slot).source][axis]));
    }
  }
  for (const ClusterBone& bone : leaf.bones) {
    for (std::size_t slot = 0; slot < slots; ++slot) {
      const std::vector<Influence>& influences = vertex_in(slot).influences;
      const auto found = std::ranges::find(influences, bone.bone, &Influence::bone);
      out.weights.push_back(found == influences.end() ? 0.0F : found->weight);
    }
  }
  for (const ClusterMorph& leaf_morph : leaf.morphs) {
    for (std::size_t slot = 0; slot < slots; ++slot) {
      const std::vector<MorphDelta>& morphs = vertex_in(slot).morphs;
      const auto found = std::ranges::find(morphs, leaf_morph.target, &MorphDelta::target);
      if (found == morphs.end()) continue;
      out.morphs.emplace_back(leaf_morph.target, static_cast<std::uint32_t>(slot), to_schema(found->delta));
    }
  }
}

Runs runs_of(const Character& character, const Clusters& in) {
  Runs out;
  for (const Cluster& leaf : in.clusters) {
    const auto size_of = [](const auto& run) { return static_cast<std::uint32_t>(run.size()); };
    const std::uint32_t first_triangle = size_of(out.corners) / 3, first_vertex = size_of(out.vertices),
                        first_bone = size_of(out.bones), first_slot = size_of(out.positions) / 3,
                        first_weight = size_of(out.weights), first_morph = size_of(out.morphs);
    add_slots(character, in, leaf, out);
    out.leaves.emplace_back(leaf.sphere, first_triangle, first_vertex, first_bone, first_slot, first_weight,
                            first_morph, size_of(out.morphs) - first_morph,
                            static_cast<std::uint16_t>(leaf.triangles.size()),
                            static_cast<std::uint16_t>(leaf.vertices.size()),
                            static_cast<std::uint16_t>(leaf.bones.size()), std::uint16_t{0});
    out.vertices.insert(out.vertices.end(), leaf.vertices.begin(), leaf.vertices.end());
    for (const ClusterBone& bone : leaf.bones) out.bones.push_back(bone.bone);
    for (const Index t : leaf.triangles) {
      for (const Index v : character.source_triangles[character.skin_source_triangle[t]]) {
        const auto slot = std::lower_bound(leaf.vertices.begin(), leaf.vertices.end(), in.vertex_of_source[v]);
        out.corners.push_back(static_cast<std::uint8_t>(slot - leaf.vertices.begin()));
      }
    }
  }
  return out;
}

struct Outlines {
  std::vector<schema::Outline> outlines;
  std::vector<schema::OutlineBone> bones;
  std::vector<float> points, weights;
};

Outlines outlines_of(const Character& character, const Clusters& in) {
  Outlines out;
  std::uint32_t leaf = 0;
  for (std::uint32_t s = 0; s < in.hulls.size(); ++s) {
    const Hull& outline = in.hulls[s];
    out.outlines.emplace_back(
        leaf, static_cast<std::uint32_t>(out.bones.size()), static_cast<std::uint32_t>(out.points.size() / 3),
        static_cast<std::uint32_t>(out.weights.size()), static_cast<std::uint16_t>(outline.bones.size()),
        static_cast<std::uint16_t>(outline.points.size()), to_schema(outline.center),
        static_cast<float>(outline.radius), static_cast<float>(outline.slack));
    while (leaf < in.clusters.size() && in.clusters[leaf].sphere == s) ++leaf;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (const Index v : outline.points) {
        out.points.push_back(static_cast<float>(character.source_positions[in.vertices[v].source][axis]));
      }
    }
    for (const HullBone& bone : outline.bones) {
      out.bones.emplace_back(bone.bone, bone.off[0], bone.off[1], bone.off[2], bone.off[3]);
      for (const Index v : outline.points) {
        const std::vector<Influence>& influences = in.vertices[v].influences;
        const auto found = std::ranges::find(influences, bone.bone, &Influence::bone);
        out.weights.push_back(found == influences.end() ? 0.0F : found->weight);
      }
    }
  }
  return out;
}

// Widest registers do not span two cache lines then, where the asset starts with one: 7 % of a frame without a contact.
// ForceVectorAlignment() goes up to 32.
auto aligned_floats(flatbuffers::FlatBufferBuilder& builder, const std::vector<float>& values) {
  constexpr std::size_t kCacheLine = 64;
  builder.PreAlign(values.size() * sizeof(float), kCacheLine);
  return builder.CreateVector(values);
}

}  // namespace

flatbuffers::Offset<schema::Surface> create_surface(flatbuffers::FlatBufferBuilder& builder, const Character& character,
                                                    const BoneBinding& bones, const Clusters& clusters,
                                                    const std::vector<TrianglePair>& rest_contacts) {
  const Runs runs = runs_of(character, clusters);
  const Groups groups = group_leaves(clusters.clusters, !bones.bones.empty());
  std::vector<std::uint32_t> sources, welds;
  for (const SurfaceVertex& vertex : clusters.vertices) {
    sources.push_back(vertex.source);
    welds.push_back(vertex.weld);
  }
  const auto leaves_at = builder.CreateVectorOfStructs(runs.leaves);
  const auto balls_at = aligned_vector(builder, groups.balls);
  const auto boxes_at = aligned_vector(builder, groups.boxes);
  const auto leaf_vertices_at = builder.CreateVector(runs.vertices);
  const auto leaf_bones_at = builder.CreateVector(runs.bones);
  const auto corners_at = builder.CreateVector(runs.corners);
  const auto sources_at = builder.CreateVector(sources);
  const auto welds_at = builder.CreateVector(welds);
  const auto positions_at = aligned_floats(builder, runs.positions);
  const auto weights_at = aligned_floats(builder, runs.weights);
  const auto morphs_at = builder.CreateVectorOfStructs(runs.morphs);
  const auto term_counts_at = builder.CreateVector(groups.term_counts);
  const auto term_bones_at = builder.CreateVector(groups.term_bones);
  const auto terms_at = aligned_vector(builder, groups.terms);
  const auto morph_counts_at = builder.CreateVector(groups.morph_counts);
  const auto morph_targets_at = builder.CreateVector(groups.morph_targets);
  const auto cover_morphs_at = aligned_vector(builder, groups.morphs);
  std::vector<schema::TrianglePair> pairs;
  for (const TrianglePair& pair : rest_contacts) pairs.emplace_back(pair.a, pair.b);
  const auto rest_contacts_at = builder.CreateVectorOfStructs(pairs);
  flatbuffers::Offset<flatbuffers::Vector<const schema::Outline*>> outlines_at;
  flatbuffers::Offset<flatbuffers::Vector<const schema::OutlineBone*>> outline_bones_at;
  flatbuffers::Offset<flatbuffers::Vector<float>> outline_points_at, outline_weights_at;
  if (!clusters.hulls.empty()) {
    const Outlines outlines = outlines_of(character, clusters);
    outlines_at = builder.CreateVectorOfStructs(outlines.outlines);
    outline_bones_at = builder.CreateVectorOfStructs(outlines.bones);
    outline_points_at = aligned_floats(builder, outlines.points);
    outline_weights_at = aligned_floats(builder, outlines.weights);
  }
  return schema::CreateSurface(builder, leaves_at, balls_at, leaf_vertices_at, leaf_bones_at, corners_at, sources_at,
                               welds_at, positions_at, weights_at, morphs_at, term_counts_at, term_bones_at, terms_at,
                               morph_counts_at, morph_targets_at, cover_morphs_at, rest_contacts_at, boxes_at,
                               outlines_at, outline_bones_at, outline_points_at, outline_weights_at);
}

}  // namespace spherechain::baker
