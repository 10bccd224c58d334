// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <map>
#include <tuple>

#include "baker/clusters/clusters.h"

namespace spherechain::baker {
namespace {

// In single precision, as the asset has them. Weights that are 0 in single precision are left out.
std::vector<Influence> influences_of(const VertexWeights* weights, Index rest_bone) {
  std::map<Index, double> sums;
  for (std::size_t k = 0; weights != nullptr && k < kMaxInfluences && weights->weight[k] > 0; ++k) {
    sums[weights->joint[k]] += weights->weight[k];
  }
  std::vector<Influence> out;
  for (const auto& [bone, weight] : sums) {
    const auto single = static_cast<float>(std::min(weight, 1.0));
    if (single > 0) out.push_back({bone, single});
  }
  if (out.empty()) out.push_back({rest_bone, 1});
  return out;
}

std::vector<std::vector<MorphDelta>> morphs_by_vertex(const Character& character) {
  std::vector<std::vector<MorphDelta>> out(character.source_positions.size());
  const std::vector<Morph>& morphs = character.rig.morphs;
  for (Index m = 0; m < morphs.size(); ++m) {
    for (std::size_t i = 0; i < morphs[m].vertices.size(); ++i) {
      const Vec3 delta = morphs[m].deltas[i].cast<float>().cast<double>();
      if (!delta.isZero(0)) out[morphs[m].vertices[i]].push_back({m, delta});
    }
  }
  return out;
}

bool moves_before(const SurfaceVertex& a, const SurfaceVertex& b) {
  const auto influence = [](const Influence& i) { return std::tuple(i.bone, i.weight); };
  const auto morph = [](const MorphDelta& m) { return std::tuple(m.target, m.delta.x(), m.delta.y(), m.delta.z()); };
  if (a.weld != b.weld) return a.weld < b.weld;
  if (a.influences != b.influences) {
    return std::ranges::lexicographical_compare(a.influences, b.influences, {}, influence, influence);
  }
  return std::ranges::lexicographical_compare(a.morphs, b.morphs, {}, morph, morph);
}

}  // namespace

std::vector<SurfaceVertex> surface_vertices(const Character& character, const BoneBinding& bones,
                                            const std::vector<VertexWeights>& rig_weights,
                                            std::vector<Index>& vertex_of_source) {
  const std::vector<VertexWeights>& weights = character.rig.bones.empty() ? rig_weights : character.rig.weights;
  std::vector<bool> used(character.source_positions.size());
  for (const Index t : character.skin_source_triangle) {
    for (const Index v : character.source_triangles[t]) used[v] = true;
  }
  std::vector<std::vector<MorphDelta>> morphs;
  if (!bones.bones.empty()) morphs = morphs_by_vertex(character);

  std::vector<SurfaceVertex> out;
  const auto before = [&](Index a, Index b) { return moves_before(out[a], out[b]); };
  std::map<Index, Index, decltype(before)> found(before);
  vertex_of_source.assign(used.size(), kNoIndex);
  for (Index v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    SurfaceVertex vertex{v, character.skin_of_source[v], {}, {}};
    if (!bones.bones.empty()) {
      vertex.influences = influences_of(weights.empty() ? nullptr : &weights[v], bones.rest_bone());
      vertex.morphs = std::move(morphs[v]);
    }
    out.push_back(std::move(vertex));
    const auto last = static_cast<Index>(out.size() - 1);
    const auto [place, is_new] = found.try_emplace(last, last);
    vertex_of_source[v] = place->second;
    if (!is_new) out.pop_back();
  }
  return out;
}

}  // namespace spherechain::baker
