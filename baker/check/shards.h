// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/check/verdict.h"

namespace spherechain::baker {

// A part of a library that one machine checked. It lies in a folder with its results.
struct ShardResult {
  Shard shard;
  std::vector<CharacterRules> characters;  // of the whole library
  std::vector<CheckedClip> clips;          // of this part
};

// The store in a shard's folder.
inline constexpr const char* kShardStore = "results";
// The file that names the results, in that folder.
inline constexpr const char* kShardFile = "shard.json";

// Writes the folder, with the results that are in `store`: that in it or another. Throws Error(kFile).
void write_shard(const std::string& folder, const ShardResult& result, const Store& store);

// All clips of a library, in its order, from the folders of all of its shards; `store` takes their results. Throws
// Error(kFile) where a shard is missing, is there twice, or is of another library.
ShardResult merge_shards(const std::vector<std::string>& folders, const Store& store);

}  // namespace spherechain::baker
