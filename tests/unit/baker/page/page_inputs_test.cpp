// SPDX-License-Identifier: GPL-3.0-or-later
// Files that `view` takes from other commands: about the same asset, and all there that the page's script reads.
#include "baker/page/page_inputs.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/play/asset_file.h"
#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

using Reader = std::string (*)(const std::string&, const OpenAsset&, const std::string&);

struct Made {
  OpenAsset asset = open_asset(tool::baked_files().asset.string());
  json report = json::parse(tool::contents(tool::baked_files().report)), validation;

  Made() {
    const TemporaryFolder folder;
    const std::string file = (folder.path / "validation.json").string();
    const tool::Run run =
        tool::run(fmt::format("validate {} --source {} --poses {}/poses/arms_crossed.json --frames 2 --radius fit "
                              "--spheres-alone --json {}",
                              tool::baked_files().asset.string(), kHumanFile, SPHERECHAIN_SAMPLES, file),
                  "SPHERECHAIN_CACHE=off");
    REQUIRE_MESSAGE(run.code == 0, run.error);
    validation = json::parse(tool::contents(file));
    REQUIRE(!validation["worst_misses"].empty());
  }
};

const Made& made() {
  static const Made files;
  return files;
}

// "accepted", or what is wrong, which begins with the file's name.
std::string refusal(Reader read, const std::string& text) {
  const TemporaryFolder folder;
  const std::string file = folder.write("given.json", text).string();
  try {
    const std::string given = read(file, made().asset, "human.sphc");
    CHECK(given == text);
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kFile);
    const std::string what = error.what();
    CHECK(what.find(file + ": ") == 0);
    return what.substr(file.size() + 2);
  }
  return "accepted";
}

// "/skin/precision" -> "skin.precision", "/stages/0/seconds" -> "stages[0].seconds"
std::string dotted(const std::string& pointer) {
  std::string out;
  for (std::size_t i = 1, end = 0; i < pointer.size(); i = end + 1) {
    end = std::min(pointer.find('/', i), pointer.size());
    const std::string key = pointer.substr(i, end - i);
    out += key.find_first_not_of("0123456789") == std::string::npos ? "[" + key + "]" : (out.empty() ? "" : ".") + key;
  }
  return out;
}

// A share of nothing is null.
bool may_be_null(const std::string& pointer) { return pointer.ends_with("_recall") || pointer.ends_with("precision"); }

void check_each_is_needed(Reader read, const json& whole, const std::vector<const char*>& pointers) {
  CHECK(refusal(read, whole.dump()) == "accepted");
  for (const char* pointer : pointers) {
    CAPTURE(pointer);
    const json::json_pointer at(pointer);
    REQUIRE(whole.contains(at));
    const std::string name = dotted(pointer);
    for (const json& wrong : {json(), json("x"), json(1), json(json::array({json::array({1})})), json(true),
                              json({{"x", json({{"x", 1}})}})}) {
      const json& right = whole[at];
      if (wrong.is_null() && may_be_null(pointer)) continue;
      if (wrong.type() == right.type() || (wrong.is_number() && right.is_number())) continue;
      json broken = whole;
      broken[at] = wrong;
      const std::string what = refusal(read, broken.dump());
      CHECK_MESSAGE(what.find(name) == 0, what);
    }
    json broken = whole;
    if (broken[at.parent_pointer()].is_array()) continue;
    broken[at.parent_pointer()].erase(at.back());
    const std::string what = refusal(read, broken.dump());
    CHECK_MESSAGE(what.find(name + " is missing") == 0, what);
  }
}

}  // namespace

TEST_CASE("a bake report is shown only whole: each key that the page reads is asked for by name" *
          doctest::test_suite("many bakes")) {
  check_each_is_needed(
      read_bake_report, made().report,
      {"/source", "/source/sha256", "/source/file", "/settings", "/counts", "/counts/why", "/bind", "/bind/quality",
       "/bind/quality/grade", "/bind/quality/protrusion", "/edits", "/edits/missed", "/missed_targets", "/stages",
       "/stages/0", "/stages/1/stage", "/stages/2/seconds", "/total_seconds", "/peak_memory_mb"});
}

TEST_CASE("a validation is shown only whole, and of spheres that the asset has") {
  const json& whole = made().validation;
  check_each_is_needed(read_validation, whole,
                       {"/source",
                        "/source/sha256",
                        "/settings_sha256",
                        "/pair_recall",
                        "/precision",
                        "/reported_per_frame",
                        "/all_pairs",
                        "/all_pairs/pair_recall",
                        "/all_pairs/reported_per_frame",
                        "/radius",
                        "/reported",
                        "/skin",
                        "/skin/precision",
                        "/raw_pairs",
                        "/truth_pairs",
                        "/out_of_scope",
                        "/out_of_scope/rest",
                        "/out_of_scope/same_sphere",
                        "/out_of_scope/ignored",
                        "/worst_misses",
                        "/worst_misses/0",
                        "/worst_misses/0/time",
                        "/worst_misses/0/triangle_pairs",
                        "/worst_misses/0/depth_mm",
                        "/worst_misses/0/spheres",
                        "/worst_misses/0/spheres/1"});
  for (const json& number : {json(-1), json(1.5), json(made().asset->spheres().size)}) {
    json broken = whole;
    broken["worst_misses"][0]["spheres"][1] = number;
    CHECK(refusal(read_validation, broken.dump()).find("worst_misses[0].spheres[1] is not the number of") == 0);
  }
  for (const json& spheres : {json::array({1}), json::array({1, 2, 3})}) {
    json broken = whole;
    broken["worst_misses"][0]["spheres"] = spheres;
    CHECK(refusal(read_validation, broken.dump()).find("worst_misses[0].spheres has not 2") == 0);
  }
}

TEST_CASE("a report or a validation of another source or of other settings is refused, and both files named") {
  const std::string sha256(64, 'a');
  for (const auto& [read, whole] : {std::pair<Reader, json>(read_bake_report, made().report),
                                    std::pair<Reader, json>(read_validation, made().validation)}) {
    json other = whole;
    other["source"]["sha256"] = sha256;
    const std::string what = refusal(read, other.dump());
    for (const char* part : {"is not about human.sphc", "human.zae of sha256 aaaa"})
      CHECK_MESSAGE(what.find(part) != std::string::npos, what);
    other = whole;
    (other.contains("settings_sha256") ? other["settings_sha256"] : other["settings"]["rays"]) = sha256;
    const std::string settings = refusal(read, other.dump());
    for (const char* part : {"is not about human.sphc", "other settings"})
      CHECK_MESSAGE(settings.find(part) != std::string::npos, settings);
  }
  CHECK(refusal(read_validation, made().report.dump()) != "accepted");
  CHECK(refusal(read_bake_report, made().validation.dump()) != "accepted");
}

TEST_CASE("what is no JSON object, or nested without end, is refused") {
  for (const Reader read : {Reader(read_bake_report), Reader(read_validation)}) {
    for (const char* text : {"", "{", "[]", "3", "null", "\"text\"", "{\"source\": 1e999}"}) {
      CAPTURE(text);
      CHECK(refusal(read, text).find("is not a JSON object") == 0);
    }
    json deep = made().report;
    const std::string lists = std::string(300000, '[') + std::string(300000, ']');
    const std::string text = deep.dump();
    CHECK(refusal(read, text.substr(0, text.size() - 1) + ",\"deep\":" + lists + "}").find("nested") !=
          std::string::npos);
  }
}
