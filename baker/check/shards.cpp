// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/shards.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/mesh/error.h"
#include "baker/os/written_file.h"
#include "baker/play/asset_file.h"
#include "baker/report/json_text.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json rules_json(const Rules& rules) {
  ordered_json allow = ordered_json::array();
  for (const auto& [parts, depth] : rules.allowed)
    allow.push_back({{"parts", parts}, {"depth_mm", depth.mm}, {"depth_percent", depth.percent}});
  const auto name = [](Severity severity) {
    return severity == Severity::kError ? "error" : severity == Severity::kWarning ? "warning" : "ignore";
  };
  return {{"allow", allow},
          {"leave_out", rules.left_out},
          {"max_depth_mm", rules.max_depth.mm},
          {"max_depth_percent", rules.max_depth.percent},
          {"severity", {{"penetration", name(rules.penetration)}, {"deep_fold", name(rules.deep_fold)}}}};
}

ShardResult read_shard(const fs::path& folder) {
  const std::string file = (folder / kShardFile).string();
  const ordered_json json = ordered_json::parse(read_file(file), nullptr, false);
  ShardResult out;
  try {
    json.at("shard").get_to(out.shard.index);
    json.at("of").get_to(out.shard.count);
    for (const ordered_json& c : json.at("characters")) {
      out.characters.push_back({c.at("name").get<std::string>(), c.at("file").get<std::string>(),
                                read_config(c.at("rules").dump(), file, default_config()).rules});
    }
    for (const ordered_json& c : json.at("clips")) {
      out.clips.push_back({c.at("character").get<std::size_t>(), c.at("order").get<std::size_t>(),
                           c.at("clip").get<std::string>(), c.at("error").get<std::string>(),
                           c.at("key").get<std::string>(), c.at("character_key").get<std::string>()});
      if (out.clips.back().character >= out.characters.size()) throw Error(ExitCode::kFile, file + ": is damaged");
    }
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::kFile, file + ": is not what check --shard wrote");
  }
  return out;
}

// Reads the whole results in `from`. A clip's result without one of its files is none.
void copy_results(const CheckedClip& clip, const Store& from, const Store& store) {
  const auto copy = [&](const std::string& key, const std::string& kind) {
    if (key.empty() || store.has(key, kind)) return;
    const std::optional<std::string> bytes = from.read(key, kind);
    if (!bytes) {
      throw Error(ExitCode::kFile,
                  from.folder().string() + ": has lost the results of '" + clip.clip + "' (check this shard again)");
    }
    store.write(key, kind, *bytes);
  };
  if (!clip.error.empty()) return;
  copy(clip.character_key, kResultFile);
  if (clip.clip.empty()) return;
  copy(clip.key, kResultFile);
  const std::optional<ClipResult> result = read_clip_result(store.read(clip.key, kResultFile).value_or(""));
  if (result) {
    for (const std::string& kind : files_of(*result)) copy(clip.key, kind);
  }
  copy(clip.character_key, kPageFile);
}

std::string to_bytes(const ShardResult& result) {
  ordered_json characters = ordered_json::array(), clips = ordered_json::array();
  for (const CharacterRules& c : result.characters) {
    characters.push_back({{"name", c.name}, {"file", c.file}, {"rules", rules_json(c.rules)}});
  }
  for (const CheckedClip& c : result.clips) {
    clips.push_back({{"character", c.character},
                     {"order", c.order},
                     {"clip", c.clip},
                     {"error", c.error},
                     {"key", c.key},
                     {"character_key", c.character_key}});
  }
  return json_text({{"writer", kWriter},
                    {"shard", result.shard.index},
                    {"of", result.shard.count},
                    {"characters", std::move(characters)},
                    {"clips", std::move(clips)}},
                   1) +
         "\n";
}

}  // namespace

void write_shard(const std::string& folder, const ShardResult& result, const Store& store) {
  const Store own(fs::path(folder) / kShardStore);
  for (const CheckedClip& clip : result.clips) copy_results(clip, store, own);
  write_atomically(fs::path(folder) / kShardFile, to_bytes(result));
}

ShardResult merge_shards(const std::vector<std::string>& folders, const Store& store) {
  ShardResult out;
  std::set<int> there;
  for (const std::string& folder : folders) {
    ShardResult shard = read_shard(folder);
    if (there.empty()) {
      out.shard = {1, shard.shard.count};
      out.characters = shard.characters;
    }
    const auto same = [](const CharacterRules& l, const CharacterRules& r) {
      return l.name == r.name && l.file == r.file;
    };
    if (shard.shard.count != out.shard.count || !std::equal(shard.characters.begin(), shard.characters.end(),
                                                            out.characters.begin(), out.characters.end(), same)) {
      throw Error(ExitCode::kFile, folder + ": is a shard of another library than " + folders.front());
    }
    if (!there.insert(shard.shard.index).second) {
      throw Error(ExitCode::kFile, fmt::format("{}: shard {} is there twice", folder, shard.shard.index));
    }
    const Store from(fs::path(folder) / kShardStore);
    for (const CheckedClip& clip : shard.clips) {
      copy_results(clip, from, store);
      out.clips.push_back(clip);
    }
  }
  for (int i = 1; i <= out.shard.count; ++i) {
    if (there.count(i) > 0) continue;
    throw Error(ExitCode::kFile, fmt::format("{}: shard {} of {} is missing (check --shard {}/{})", folders.front(), i,
                                             out.shard.count, i, out.shard.count));
  }
  // A character that cannot be read is in each shard that has a part of it.
  const auto key = [](const CheckedClip& c) { return std::pair(c.character, c.order); };
  std::stable_sort(out.clips.begin(), out.clips.end(), [&](const auto& l, const auto& r) { return key(l) < key(r); });
  out.clips.erase(
      std::unique(out.clips.begin(), out.clips.end(), [&](const auto& l, const auto& r) { return key(l) == key(r); }),
      out.clips.end());
  return out;
}

}  // namespace spherechain::baker
