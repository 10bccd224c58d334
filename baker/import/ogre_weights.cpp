// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/ogre_weights.h"

#include <assimp/commonMetaData.h>

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace spherechain::baker {
namespace {

using BoneWeights = std::multiset<std::tuple<std::string, unsigned, float>>;  // bone, vertex, weight

BoneWeights weights_of(const aiMesh& mesh) {
  BoneWeights out;
  for (unsigned b = 0; b < mesh.mNumBones; ++b) {
    const aiBone& bone = *mesh.mBones[b];
    for (unsigned w = 0; w < bone.mNumWeights; ++w)
      out.emplace(bone.mName.C_Str(), bone.mWeights[w].mVertexId, bone.mWeights[w].mWeight);
  }
  return out;
}

// Whether some vertex has the weights of two.
bool is_heavy(const aiMesh& mesh, const BoneWeights& weights) {
  std::vector<double> sums(mesh.mNumVertices, 0);
  for (const auto& [bone, vertex, weight] : weights) {
    if (vertex < sums.size()) sums[vertex] += static_cast<double>(weight);
  }
  constexpr double kTwo = 1.5;
  return std::any_of(sums.begin(), sums.end(), [](double sum) { return sum > kTwo; });
}

bool includes(const BoneWeights& weights, const BoneWeights& others, unsigned vertices) {
  return std::all_of(others.begin(), others.end(), [&](const auto& entry) {
    return std::get<1>(entry) >= vertices || weights.count(entry) >= others.count(entry);
  });
}

}  // namespace

void separate_shared_weights(aiScene& scene) {
  aiString format;
  if (scene.mMetaData == nullptr || !scene.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, format) ||
      !std::string_view(format.C_Str()).starts_with("Ogre")) {
    return;
  }
  BoneWeights before;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    aiMesh& mesh = *scene.mMeshes[m];
    BoneWeights own = weights_of(mesh);
    if (!before.empty() && is_heavy(mesh, own) && includes(own, before, mesh.mNumVertices)) {
      for (const auto& entry : before) {
        if (const auto found = own.find(entry); found != own.end()) own.erase(found);
      }
      BoneWeights left = own;
      for (unsigned b = 0; b < mesh.mNumBones; ++b) {
        aiBone& bone = *mesh.mBones[b];
        unsigned kept = 0;
        for (unsigned w = 0; w < bone.mNumWeights; ++w) {
          const auto found = left.find({bone.mName.C_Str(), bone.mWeights[w].mVertexId, bone.mWeights[w].mWeight});
          if (found == left.end()) continue;
          left.erase(found);
          bone.mWeights[kept++] = bone.mWeights[w];
        }
        bone.mNumWeights = kept;
      }
    }
    before.insert(own.begin(), own.end());
  }
}

}  // namespace spherechain::baker
