// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_inputs.h"

#include <nlohmann/json.hpp>

#include "baker/import/json_depth.h"
#include "baker/mesh/error.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;

// A value of the file, and what an error calls it.
class Value {
 public:
  Value(const json& value, std::string where, const std::string& file, const char* writer)
      : value_(value), where_(std::move(where)), file_(file), writer_(writer) {}

  Value operator[](const char* key) const {
    if (!value_.is_object()) fail("is not an object");
    const auto found = value_.find(key);
    const std::string where = where_.empty() ? key : where_ + "." + key;
    if (found == value_.end()) Value(value_, where, file_, writer_).fail("is missing");
    return {*found, where, file_, writer_};
  }
  template <typename Each>
  void each(const Each& check) const {
    if (!value_.is_array()) fail("is not a list");
    for (std::size_t i = 0; i < value_.size(); ++i)
      check(Value(value_[i], where_ + "[" + std::to_string(i) + "]", file_, writer_));
  }
  void numbers(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) (*this)[key].number();
  }
  void number() const {
    if (!value_.is_number()) fail("is not a number");
  }
  const std::string& text() const {
    if (!value_.is_string()) fail("is not a text");
    return value_.get_ref<const std::string&>();
  }
  void object() const {
    if (!value_.is_object()) fail("is not an object");
  }
  void size(std::size_t wanted) const {
    if (value_.size() != wanted) fail("has not " + std::to_string(wanted) + " entries");
  }
  void index(std::size_t count) const {
    if (!value_.is_number_unsigned() || value_.get<std::uint64_t>() >= count)
      fail("is not the number of one of the asset's " + std::to_string(count) + " spheres");
  }
  const json& raw() const { return value_; }

  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ExitCode::kFile,
                file_ + ": " + (where_.empty() ? "it" : where_) + " " + what + " (give what " + writer_ + " wrote)");
  }

 private:
  const json& value_;
  std::string where_;
  const std::string& file_;
  const char* writer_;
};

json parse(const std::string& text, const std::string& file) {
  constexpr int kNestedMax = 16;  // a report has 6; the page's script and the JSON library go down by recursion
  if (json_depth(text) > kNestedMax) throw Error(ExitCode::kFile, file + ": its JSON is nested too deeply");
  json out = json::parse(text, nullptr, false);
  if (!out.is_object()) throw Error(ExitCode::kFile, file + ": is not a JSON object");
  return out;
}

[[noreturn]] void refuse(const std::string& file, const std::string& asset_file, const std::string& what) {
  throw Error(ExitCode::kFile, file + ": is not about " + asset_file + ": " + what + " (give what was written for it)");
}

void check_source(const Value& root, const OpenAsset& asset, const std::string& file, const std::string& asset_file) {
  const Value source = root["source"];
  const std::string &sha256 = source["sha256"].text(), &name = source["file"].text();
  const AssetInfo info = asset->info();
  if (sha256 != info.source_sha256) {
    refuse(file, asset_file,
           "their sources differ, " + name + " of sha256 " + sha256.substr(0, 64) + " and " + info.source_file +
               " of sha256 " + info.source_sha256);
  }
}

// A share of nothing is null.
void check_score(const Value& score) {
  for (const char* share : {"pair_recall", "precision"}) {
    if (!score[share].raw().is_null()) score[share].number();
  }
  score["reported_per_frame"].number();
}

}  // namespace

std::string read_bake_report(const std::string& file, const OpenAsset& asset, const std::string& asset_file) {
  std::string text = read_file(file);
  const json found = parse(text, file);
  const Value report(found, "", file, "bake --report");
  check_source(report, asset, file, asset_file);
  report["settings"].object();
  if (found["settings"] != json::parse(asset->info().settings, nullptr, false)) {
    refuse(file, asset_file, "it was baked with other settings");
  }
  const Value counts = report["counts"];
  counts["why"].text();
  const Value quality = report["bind"]["quality"];
  quality["grade"].text();
  quality.numbers({"far_area", "protrusion"});
  report["missed_targets"].each([](const Value& target) { target.text(); });
  report["edits"]["missed"].each([](const Value& edit) { edit.text(); });
  report["stages"].each([](const Value& stage) {
    stage["stage"].text();
    stage["seconds"].number();
  });
  report.numbers({"total_seconds", "peak_memory_mb"});
  return text;
}

std::string read_validation(const std::string& file, const OpenAsset& asset, const std::string& asset_file) {
  std::string text = read_file(file);
  const json found = parse(text, file);
  const Value validation(found, "", file, "validate --json");
  check_source(validation, asset, file, asset_file);
  if (validation["settings_sha256"].text() != asset->info().settings_sha256) {
    refuse(file, asset_file, "it is of an asset with other settings");
  }
  check_score(validation);
  for (const char* of : {"skin", "all_pairs"}) check_score(validation[of]);
  validation["radius"].text();
  validation["reported"].text();
  validation.numbers({"raw_pairs", "truth_pairs"});
  validation["out_of_scope"].numbers({"rest", "same_sphere", "ignored"});
  validation["worst_misses"].each([&](const Value& miss) {
    miss.numbers({"time", "triangle_pairs", "depth_mm"});
    const Value spheres = miss["spheres"];
    spheres.each([&](const Value& sphere) { sphere.index(asset->spheres().size); });
    spheres.size(2);
  });
  return text;
}

}  // namespace spherechain::baker
