// SPDX-License-Identifier: GPL-3.0-or-later
// A PartFilter as JSON, there and back.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "baker/filter/confidence.h"
#include "baker/filter/part_filter.h"
#include "baker/mesh/error.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

class FilterReader {
 public:
  explicit FilterReader(const std::string& file) : file_(file) {
    const json object = json::parse(read_file(file), nullptr, false);
    if (!object.is_object() || !object.contains("spherechain") || !object.contains("pairs")) {
      fail("is not what filter writes (spherechain filter ASSET --source FILE -o FILE.json)");
    }
    if (object.contains("source")) source_ = object["source"];
    const json& poses = member(object, "poses", "the file");
    out_.clip_poses = count(poses, "clips", "'poses'");
    out_.random_poses = count(poses, "random", "'poses'");
    if (!object["pairs"].is_array()) fail("'pairs' is not a list");
    for (const json& entry : object["pairs"]) add(entry);
    if (poses.contains("settled_after")) out_.settled_after = count(poses, "settled_after", "'poses'");
  }

  // Rigs of one maker share their names: the source's bytes tell which character a filter is of.
  void check_source(const AssetInfo& info) const {
    if (source_.is_object() && source_.contains("sha256") && source_["sha256"] == info.source_sha256) return;
    fail(fmt::format("is of another character than the asset, which was baked from {} (run filter on this asset)",
                     info.source_file));
  }

  // Every two parts once; `parts` are those of an asset, or those that the file names.
  PartFilter finish(std::vector<std::string> parts) {
    out_.parts = std::move(parts);
    std::map<std::string, std::size_t> number;
    for (std::size_t p = 0; p < out_.parts.size(); ++p) number[out_.parts[p]] = p;
    for (std::size_t i = 0; i < out_.pairs.size(); ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        const auto found = number.find(names_[i][k]);
        if (found == number.end()) {
          fail("names '" + names_[i][k] + "', which is no body part of the asset (run filter on this asset)");
        }
        out_.pairs[i].parts[k] = found->second;
      }
      std::array<std::size_t, 2>& parts_of_pair = out_.pairs[i].parts;
      if (parts_of_pair[0] == parts_of_pair[1]) fail("pairs '" + names_[i][0] + "' with itself");
      std::sort(parts_of_pair.begin(), parts_of_pair.end());
    }
    std::sort(out_.pairs.begin(), out_.pairs.end(),
              [](const FilteredPair& a, const FilteredPair& b) { return a.parts < b.parts; });
    std::size_t i = 0;
    for (std::size_t a = 0; a < out_.parts.size(); ++a) {
      for (std::size_t b = a + 1; b < out_.parts.size(); ++b, ++i) {
        if (i < out_.pairs.size() && out_.pairs[i].parts == std::array{a, b}) continue;
        const bool is_twice = i > 0 && i < out_.pairs.size() && out_.pairs[i].parts == out_.pairs[i - 1].parts;
        const std::array<std::size_t, 2> wrong = is_twice ? out_.pairs[i].parts : std::array{a, b};
        fail((is_twice ? "has a pair twice: '" : "lacks the pair '") + out_.parts[wrong[0]] + "' and '" +
             out_.parts[wrong[1]] + "' (run filter on this asset)");
      }
    }
    if (i < out_.pairs.size()) fail("has a pair twice (run filter on this asset)");
    return std::move(out_);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& pair : names_) {
      for (const std::string& name : pair) {
        if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
      }
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  const json& member(const json& object, const char* key, const std::string& where) const {
    if (!object.is_object() || !object.contains(key)) fail(where + " has no '" + key + "'");
    return object[key];
  }

  int count(const json& object, const char* key, const std::string& where) const {
    const json& value = member(object, key, where);
    const bool is_count = value.is_number_integer() && value >= 0 && value <= 1000000000;
    if (!is_count) fail("'" + std::string(key) + "' of " + where + " is not a number of poses");
    return value.get<int>();
  }

  void add(const json& entry) {
    const std::string where = fmt::format("pair {}", names_.size());
    const json& parts = member(entry, "parts", where);
    const bool are_two = parts.is_array() && parts.size() == 2 && parts[0].is_string() && parts[1].is_string();
    if (!are_two) fail("'parts' of " + where + " are not two names");
    names_.push_back({parts[0].get<std::string>(), parts[1].get<std::string>()});
    const json& kind = member(entry, "kind", where);
    const std::array kinds{PairKind::kAdjacent, PairKind::kAlways, PairKind::kRest, PairKind::kSometimes,
                           PairKind::kNever};
    const auto* const found =
        std::find_if(kinds.begin(), kinds.end(), [&](PairKind k) { return kind == kind_name(k); });
    if (found == kinds.end()) fail("'kind' of " + where + " is not adjacent, always, rest, sometimes or never");
    const json& at_most = member(entry, "at_most", where);
    if (!at_most.is_number() || at_most < 0 || at_most > 1) fail("'at_most' of " + where + " is not from 0 to 1");
    out_.pairs.push_back(
        {{}, *found, count(entry, "clip_poses", where), count(entry, "random_poses", where), at_most.get<double>()});
  }

  std::string file_;
  json source_;
  PartFilter out_;
  std::vector<std::array<std::string, 2>> names_;  // of the pairs
};

// A list of which each entry has a line: a filter is read by people, too.
std::string lines(const ordered_json& list) {
  std::string out = "[";
  for (const ordered_json& entry : list) {
    out += (out.size() > 1 ? ",\n  " : "\n  ") + entry.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  }
  return out + (list.empty() ? "]" : "\n ]");
}

}  // namespace

std::string part_filter_json(const PartFilter& filter, const OpenAsset& asset, const std::string& asset_name) {
  const AssetInfo info = asset->info();
  const ordered_json head{
      {"spherechain", kVersion},
      {"asset", std::filesystem::path(asset_name).filename().string()},
      {"source", {{"file", info.source_file}, {"sha256", info.source_sha256}}},
      {"settings_sha256", info.settings_sha256},
      {"poses",
       {{"clips", filter.clip_poses}, {"random", filter.random_poses}, {"settled_after", filter.settled_after}}},
      {"confidence", kConfidence}};
  ordered_json pairs = ordered_json::array(), spheres = ordered_json::array();
  for (const FilteredPair& pair : filter.pairs) {
    pairs.push_back({{"parts", {filter.parts[pair.parts[0]], filter.parts[pair.parts[1]]}},
                     {"kind", kind_name(pair.kind)},
                     {"clip_poses", pair.clip_poses},
                     {"random_poses", pair.random_poses},
                     {"at_most", pair.at_most}});
  }
  for (const Pair& pair : idle_sphere_pairs(asset, filter)) spheres.push_back({pair.a, pair.b});
  std::string out = head.dump(1, ' ', false, ordered_json::error_handler_t::replace);
  out.resize(out.size() - 2);  // without its end
  return out + ",\n \"pairs\": " + lines(pairs) + ",\n \"idle_sphere_pairs\": " + spheres.dump() + "\n}\n";
}

PartFilter read_part_filter(const std::string& path, const OpenAsset& asset) {
  std::vector<std::string> parts;
  for (std::size_t p = 0; p < asset->part_count(); ++p) parts.push_back(asset->part(p).name);
  FilterReader reader(path);
  reader.check_source(asset->info());
  return reader.finish(std::move(parts));
}

PartFilter read_part_filter(const std::string& path) {
  FilterReader reader(path);
  return reader.finish(reader.names());
}

}  // namespace spherechain::baker
