// SPDX-License-Identifier: GPL-3.0-or-later
#include "write/surface_table.h"

#include <algorithm>
#include <array>
#include <map>

namespace spherechain::baker {
namespace {

constexpr std::size_t kLanes = 8;
using Eight = std::array<float, kLanes>;

flatbuffers::span<const float, kLanes> span_of(const Eight& lanes) {
  return flatbuffers::span<const float, kLanes>(lanes.data(), kLanes);
}

schema::Vec3 to_schema(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

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

struct EightWeights {
  Eight weights{}, deviations{};
};

// All that eight leaves, one after another, have in common.
struct Groups {
  std::vector<schema::BallLanes> balls;
  std::vector<std::uint32_t> term_counts, term_bones, morph_counts, morph_targets;
  std::vector<schema::CoverTerm> terms;
  std::vector<schema::BallLanes> morphs;
};

Groups group_leaves(const std::vector<Leaf>& leaves, bool moves) {
  Groups out;
  for (std::size_t first = 0; first < leaves.size(); first += kLanes) {
    EightBalls balls;
    std::map<Index, EightWeights> terms;
    std::map<Index, EightBalls> morphs;
    for (std::size_t lane = 0; lane < std::min(kLanes, leaves.size() - first); ++lane) {
      const Leaf& leaf = leaves[first + lane];
      balls.set(lane, leaf.ball);
      for (const LeafBone& bone : leaf.bones) {
        terms[bone.bone].weights[lane] = bone.weight;
        terms[bone.bone].deviations[lane] = bone.deviation;
      }
      for (const LeafMorph& morph : leaf.morphs) morphs[morph.target].set(lane, morph.ball);
    }
    out.balls.push_back(balls.stored());
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
};

Runs runs_of(const Character& character, const Leaves& in) {
  Runs out;
  for (const Leaf& leaf : in.leaves) {
    out.leaves.emplace_back(
        leaf.sphere, static_cast<std::uint32_t>(out.corners.size() / 3),
        static_cast<std::uint32_t>(out.vertices.size()), static_cast<std::uint32_t>(out.bones.size()),
        static_cast<std::uint16_t>(leaf.triangles.size()), static_cast<std::uint16_t>(leaf.vertices.size()),
        static_cast<std::uint16_t>(leaf.bones.size()), std::uint16_t{0});
    out.vertices.insert(out.vertices.end(), leaf.vertices.begin(), leaf.vertices.end());
    for (const LeafBone& bone : leaf.bones) out.bones.push_back(bone.bone);
    for (const Index t : leaf.triangles) {
      for (const Index v : character.source_triangles[character.skin_source_triangle[t]]) {
        const auto slot = std::lower_bound(leaf.vertices.begin(), leaf.vertices.end(), in.vertex_of_source[v]);
        out.corners.push_back(static_cast<std::uint8_t>(slot - leaf.vertices.begin()));
      }
    }
  }
  return out;
}

struct Vertices {
  std::vector<schema::SurfaceVertex> vertices;
  std::vector<std::uint32_t> sources, welds;
  std::vector<schema::Influence> influences;
  std::vector<schema::MorphDelta> morphs;
};

Vertices vertices_of(const Character& character, const std::vector<SurfaceVertex>& in) {
  Vertices out;
  for (const SurfaceVertex& vertex : in) {
    out.vertices.emplace_back(
        to_schema(character.source_positions[vertex.source]), static_cast<std::uint32_t>(out.influences.size()),
        static_cast<std::uint32_t>(out.morphs.size()), static_cast<std::uint16_t>(vertex.influences.size()),
        static_cast<std::uint16_t>(vertex.morphs.size()));
    out.sources.push_back(vertex.source);
    out.welds.push_back(vertex.weld);
    for (const Influence& influence : vertex.influences) out.influences.emplace_back(influence.bone, influence.weight);
    for (const MorphDelta& morph : vertex.morphs) out.morphs.emplace_back(morph.target, to_schema(morph.delta));
  }
  return out;
}

// Lanes that start at a multiple of their own size never straddle two cache lines.
template <typename Struct>
auto aligned_vector(flatbuffers::FlatBufferBuilder& builder, const std::vector<Struct>& values) {
  builder.ForceVectorAlignment(values.size(), sizeof(Struct), sizeof(Eight));
  return builder.CreateVectorOfStructs(values);
}

}  // namespace

flatbuffers::Offset<schema::Surface> create_surface(flatbuffers::FlatBufferBuilder& builder, const Character& character,
                                                    const BoneBinding& bones, const Leaves& leaves) {
  const Runs runs = runs_of(character, leaves);
  const Vertices vertices = vertices_of(character, leaves.vertices);
  const Groups groups = group_leaves(leaves.leaves, !bones.bones.empty());
  const auto leaves_at = builder.CreateVectorOfStructs(runs.leaves);
  const auto balls_at = aligned_vector(builder, groups.balls);
  const auto leaf_vertices_at = builder.CreateVector(runs.vertices);
  const auto leaf_bones_at = builder.CreateVector(runs.bones);
  const auto corners_at = builder.CreateVector(runs.corners);
  const auto vertices_at = builder.CreateVectorOfStructs(vertices.vertices);
  const auto sources_at = builder.CreateVector(vertices.sources);
  const auto welds_at = builder.CreateVector(vertices.welds);
  const auto influences_at = builder.CreateVectorOfStructs(vertices.influences);
  const auto morphs_at = builder.CreateVectorOfStructs(vertices.morphs);
  const auto term_counts_at = builder.CreateVector(groups.term_counts);
  const auto term_bones_at = builder.CreateVector(groups.term_bones);
  const auto terms_at = aligned_vector(builder, groups.terms);
  const auto morph_counts_at = builder.CreateVector(groups.morph_counts);
  const auto morph_targets_at = builder.CreateVector(groups.morph_targets);
  const auto cover_morphs_at = aligned_vector(builder, groups.morphs);
  return schema::CreateSurface(builder, leaves_at, balls_at, leaf_vertices_at, leaf_bones_at, corners_at, vertices_at,
                               sources_at, welds_at, influences_at, morphs_at, term_counts_at, term_bones_at, terms_at,
                               morph_counts_at, morph_targets_at, cover_morphs_at);
}

}  // namespace spherechain::baker
