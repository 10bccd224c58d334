// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/collada_names.h"

#include <assimp/commonMetaData.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>

namespace spherechain::baker {
namespace {

bool has_own_name(const aiNode& node) {
  // Assimp calls a node so that has neither.
  return node.mName.length > 0 && !std::string_view(node.mName.C_Str()).starts_with("$ColladaAutoName$_");
}

void count_names(const aiNode& node, std::map<std::string, int>& names) {
  ++names[has_own_name(node) ? node.mName.C_Str() : ""];
  for (unsigned c = 0; c < node.mNumChildren; ++c) count_names(*node.mChildren[c], names);
}

void pair_up(const aiNode& by_id, const aiNode& by_name, std::unordered_map<std::string, std::string>& names) {
  if (has_own_name(by_name)) names.emplace(by_id.mName.C_Str(), by_name.mName.C_Str());
  for (unsigned c = 0; c < std::min(by_id.mNumChildren, by_name.mNumChildren); ++c)
    pair_up(*by_id.mChildren[c], *by_name.mChildren[c], names);
}

}  // namespace

bool is_collada(const aiScene& scene) {
  aiString format;
  return scene.mMetaData != nullptr && scene.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, format) &&
         std::string_view(format.C_Str()).starts_with("Collada");
}

bool names_are_unique(const aiScene& scene) {
  std::map<std::string, int> names;
  count_names(*scene.mRootNode, names);
  return names.count("") == 0 &&
         std::all_of(names.begin(), names.end(), [](const auto& name) { return name.second == 1; });
}

std::unordered_map<std::string, std::string> names_of_ids(const aiScene& by_id, const aiScene& by_name) {
  std::unordered_map<std::string, std::string> names;
  pair_up(*by_id.mRootNode, *by_name.mRootNode, names);
  return names;
}

}  // namespace spherechain::baker
