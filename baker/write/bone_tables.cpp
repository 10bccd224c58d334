// SPDX-License-Identifier: GPL-3.0-or-later
#include "write/bone_tables.h"

#include <algorithm>

#include "write/schema_values.h"

namespace spherechain::baker {
namespace {

static_assert(sizeof(schema::Lanes) == sizeof(GroupLanes));

schema::Matrix matrix_of(const Affine& affine) {
  std::array<float, 12> elements{};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    elements[i] =
        static_cast<float>(affine.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)));
  }
  return schema::Matrix(flatbuffers::span<const float, 12>(elements.data(), elements.size()));
}

}  // namespace

PackedPivots pack_pivots(const std::vector<schema::Pivot>& pivots) {
  PackedPivots out;
  for (const schema::Pivot& pivot : pivots) out.vertices.insert(out.vertices.end(), {pivot.a(), pivot.b(), pivot.c()});
  std::sort(out.vertices.begin(), out.vertices.end());
  out.vertices.erase(std::unique(out.vertices.begin(), out.vertices.end()), out.vertices.end());
  const auto number = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::lower_bound(out.vertices.begin(), out.vertices.end(), vertex) -
                                      out.vertices.begin());
  };
  for (const schema::Pivot& pivot : pivots) {
    out.pivots.emplace_back(number(pivot.a()), number(pivot.b()), number(pivot.c()), pivot.weight());
  }
  return out;
}

flatbuffers::Offset<schema::BoneRefit> create_bone_refit(flatbuffers::FlatBufferBuilder& builder,
                                                         const BoneBinding& in) {
  if (in.bones.empty()) return 0;
  std::vector<flatbuffers::Offset<schema::Bone>> bones;
  for (const MovingBone& bone : in.bones) {
    const schema::Matrix inverse_bind = matrix_of(bone.inverse_bind);
    bones.push_back(schema::CreateBoneDirect(builder, bone.name.c_str(), &inverse_bind, bone.is_rest));
  }
  std::vector<schema::Lanes> weights;
  std::vector<std::uint32_t> term_counts, term_bones, morph_term_counts, morph_targets;
  std::vector<schema::BoneTerm> terms;
  std::vector<schema::MorphTerm> morph_terms;
  for (const PivotGroup& group : in.groups) {
    weights.emplace_back(span_of(group.weights));
    term_counts.push_back(static_cast<std::uint32_t>(group.parts.size()));
    for (const BonePart& part : group.parts) {
      term_bones.push_back(part.bone);
      terms.emplace_back(span_of(part.q[0]), span_of(part.q[1]), span_of(part.q[2]), span_of(part.q[3]));
      morph_term_counts.push_back(static_cast<std::uint32_t>(part.morphs.size()));
      for (const MorphPart& morph : part.morphs) {
        morph_targets.push_back(morph.target);
        morph_terms.emplace_back(span_of(morph.delta[0]), span_of(morph.delta[1]), span_of(morph.delta[2]));
      }
    }
  }
  if (morph_terms.empty()) morph_term_counts.clear();
  const auto bones_at = builder.CreateVector(bones);
  const auto morphs_at = builder.CreateVectorOfStrings(in.morphs);
  const auto weights_at = aligned_vector(builder, weights);
  const auto term_counts_at = builder.CreateVector(term_counts);
  const auto term_bones_at = builder.CreateVector(term_bones);
  const auto terms_at = aligned_vector(builder, terms);
  const auto morph_term_counts_at = builder.CreateVector(morph_term_counts);
  const auto morph_targets_at = builder.CreateVector(morph_targets);
  const auto morph_terms_at = aligned_vector(builder, morph_terms);
  return schema::CreateBoneRefit(builder, bones_at, morphs_at, weights_at, term_counts_at, term_bones_at, terms_at,
                                 morph_term_counts_at, morph_targets_at, morph_terms_at);
}

}  // namespace spherechain::baker
