// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;

class Reader {
 public:
  Reader(const json& object, std::string file) : object_(object), file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw Error(ExitCode::kFile, file_ + ": setting '" + key + "' " + what);
  }

  void number(const char* key, double& value, double low, double high) {
    if (!take(key)) return;
    const json& v = object_[key];
    if (!v.is_number() || !(v.get<double>() >= low && v.get<double>() <= high)) {
      fail(key, "is not a number from " + json(low).dump() + " to " + json(high).dump());
    }
    value = v.get<double>();
  }

  void number(const char* key, std::optional<double>& value, double low, double high) {
    if (!object_.contains(key)) return;
    number(key, value.emplace(), low, high);
  }

  void integer(const char* key, int& value, int low, int high) {
    if (!take(key)) return;
    const json& v = object_[key];
    if (!v.is_number_integer() || v.get<std::int64_t>() < low || v.get<std::int64_t>() > high) {
      fail(key, "is not a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    }
    value = v.get<int>();
  }

  void boolean(const char* key, bool& value) {
    if (!take(key)) return;
    if (!object_[key].is_boolean()) fail(key, "is neither true nor false");
    value = object_[key].get<bool>();
  }

  void vector(const char* key, std::optional<Vec3>& value) {
    if (!take(key) || object_[key].is_null()) return;
    const json& v = object_[key];
    Vec3 read = Vec3::Zero();
    if (v.is_array() && v.size() == 3 && v[0].is_number() && v[1].is_number() && v[2].is_number()) {
      read = Vec3(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
    }
    if (!(read.norm() > 0) || !read.allFinite()) fail(key, "is not a direction [x, y, z]");
    value = read;
  }

  void text(const char* key, const std::vector<std::string>& choices,
            const std::function<void(const std::string&)>& set) {
    if (!take(key)) return;
    std::string list;
    for (const std::string& choice : choices) {
      if (object_[key] == choice) return set(choice);
      list += (list.empty() ? "" : ", ") + choice;
    }
    fail(key, "is not one of: " + list);
  }

  void word(const char* key, std::string& value) {
    if (!take(key)) return;
    if (!object_[key].is_string()) fail(key, "is not a text");
    value = object_[key].get<std::string>();
  }

  const json* object(const char* key) { return take(key) ? &object_[key] : nullptr; }

  void done() const {
    for (const auto& [key, value] : object_.items()) {
      if (!known_.contains(key)) fail(key, "is unknown");
    }
  }

 private:
  bool take(const char* key) {
    known_[key] = true;
    return object_.contains(key);
  }
  const json& object_;
  std::string file_;
  json known_ = json::object();
};

json parse(const std::string& text, const std::string& file) {
  // The deepest of settings is in 'clusters' or 'targets'. JSON that is nested more deeply would be copied and printed
  // on the stack.
  constexpr int kNestedMax = 8;
  const auto shallow = [&](int depth, json::parse_event_t, const json&) {
    if (depth > kNestedMax) throw Error(ExitCode::kFile, file + ": is nested more deeply than settings are");
    return true;
  };
  try {
    json parsed = json::parse(text, shallow);
    if (parsed.is_object()) return parsed;
  } catch (const json::exception& e) {
    throw Error(ExitCode::kFile, file + ": is not JSON (" + e.what() + ")");
  }
  throw Error(ExitCode::kFile, file + ": is not a JSON object");
}

}  // namespace

BodyKind parse_body(const std::string& name) {
  if (name == "auto") return BodyKind::kUnknown;
  return name == "biped" ? BodyKind::kBiped : BodyKind::kQuadruped;
}

void check_edits(const BakeSettings& settings, const std::string& what) {
  if (settings.edits.empty()) return;
  const char* wrong = settings.import.prop                      ? "a prop"
                      : settings.bind.rule == RefitRule::kPaper ? "the paper's refit"
                                                                : nullptr;
  if (wrong != nullptr) throw Error(ExitCode::kFile, fmt::format("{} does not go with {}", what, wrong));
}

BakeSettings make_settings(const std::string& profile, const std::string& text, const std::string& file) {
  BakeSettings settings;
  if (profile == "paper") {
    settings.bind.rule = RefitRule::kPaper;
    settings.fit.extremities = false;
  } else if (profile != "balanced" && profile != "prop") {
    throw Error(ExitCode::kUsage, "profile '" + profile + "' is neither 'paper' nor 'balanced'");
  }
  const json object = parse(text, file);
  Reader reader(object, file);
  reader.boolean("prop", settings.import.prop);
  reader.word("character", settings.import.character);
  reader.number("scale", settings.size.scale, kSizeFactorMin, kSizeFactorMax);
  reader.number("height", settings.size.height, kSizeFactorMin, kSizeFactorMax);
  if (settings.size.scale && settings.size.height) reader.fail("scale", "does not go with 'height'");
  if (profile == "prop") settings.import.prop = true;
  if (settings.import.prop) {
    settings.fit.few = true;
    settings.fit.spheres = kPropSpheres;
  }
  if (const json* roles = reader.object("roles")) settings.roles = parse_role_file(roles->dump(), file + ": roles");
  if (const json* limit = reader.object("spheres"); limit != nullptr && !limit->is_null()) {
    int spheres = kSpheresMin;
    reader.integer("spheres", spheres, kSpheresMin, kSpheresMax);
    settings.fit.spheres = spheres;
  }
  reader.integer("rays", settings.fit.rays, 8, 4096);
  settings.segment.rays = settings.fit.rays;
  reader.number("penetration_depth", settings.fit.penetration_depth, 0, 0.9);
  reader.number("delta", settings.fit.delta, 1e-4, 0.2);
  reader.number("limb_step", settings.fit.limb_step, 1e-4, 0.05);
  reader.integer("spheres_per_level", settings.fit.spheres_per_level, 1, 3);
  reader.boolean("extremities", settings.fit.extremities);
  reader.vector("facing", settings.segment.facing);
  reader.text("body", {"auto", "biped", "quadruped"},
              [&](const std::string& body) { settings.segment.body = parse_body(body); });
  reader.text("refit", {"paper", "moments"}, [&](const std::string& rule) {
    settings.bind.rule = rule == "paper" ? RefitRule::kPaper : RefitRule::kMoments;
  });
  // One pivot is a centre without a radius; fewer than four cannot put a centre where they like.
  const bool paper = settings.bind.rule == RefitRule::kPaper;
  settings.bind.pivots = paper ? 4 : 8;
  reader.integer("pivots", settings.bind.pivots, paper ? 2 : 4, 16);
  reader.number("detect_quantile", settings.bind.detect_quantile, 0, 1);
  reader.number("neighbour_gap", settings.bind.neighbour_gap, 0, 1);
  if (const json* edits = reader.object("edits")) settings.edits = parse_edits(edits->dump(), file + ": edits");
  if (const json* clusters = reader.object("clusters")) {
    if (!clusters->is_object()) reader.fail("clusters", "is not an object");
    Reader inner(*clusters, file + ": clusters");
    inner.integer("triangles", settings.clusters.triangles, 4, 64);
    inner.integer("branching", settings.clusters.branching, 0, 8);
    if (const int b = settings.clusters.branching; b != 0 && b != 2 && b != 4 && b != 8) {
      inner.fail("branching", "is not 0, 2, 4 or 8");
    }
    inner.done();
  }
  if (const json* targets = reader.object("targets")) {
    if (!targets->is_object()) reader.fail("targets", "is not an object");
    Reader inner(*targets, file + ": targets");
    inner.text("fit", {"good", "fair"}, [&](const std::string& grade) {
      settings.targets.fit = grade == "good" ? FitGrade::kGood : FitGrade::kFair;
    });
    inner.done();
  }
  reader.done();
  check_edits(settings, file + ": setting 'edits'");
  if (settings.import.prop) {
    const auto refuse = [&](const char* key) { reader.fail(key, "is for characters, not for a prop"); };
    if (!settings.roles.role_of.empty()) refuse("roles");
    if (settings.segment.body != BodyKind::kUnknown) refuse("body");
    if (settings.bind.rule == RefitRule::kPaper) refuse("refit");
  }
  return settings;
}

std::string to_json(const BakeSettings& settings) {
  json out;
  if (settings.import.prop) out["prop"] = true;
  if (!settings.import.character.empty()) out["character"] = settings.import.character;
  if (settings.size.scale) out["scale"] = *settings.size.scale;
  if (settings.size.height) out["height"] = *settings.size.height;
  if (!settings.edits.empty()) out["edits"] = json::parse(to_json(settings.edits));
  out["roles"] = settings.roles.role_of;
  out["rays"] = settings.fit.rays;
  out["penetration_depth"] = settings.fit.penetration_depth;
  out["delta"] = settings.fit.delta;
  out["limb_step"] = settings.fit.limb_step;
  out["spheres_per_level"] = settings.fit.spheres_per_level;
  out["extremities"] = settings.fit.extremities;
  out["spheres"] = nullptr;
  if (settings.fit.spheres) out["spheres"] = *settings.fit.spheres;
  out["facing"] = nullptr;
  if (const auto& facing = settings.segment.facing) out["facing"] = {facing->x(), facing->y(), facing->z()};
  out["body"] = settings.segment.body == BodyKind::kUnknown ? "auto" : body_kind_name(settings.segment.body);
  out["refit"] = settings.bind.rule == RefitRule::kPaper ? "paper" : "moments";
  out["pivots"] = settings.bind.pivots;
  out["detect_quantile"] = settings.bind.detect_quantile;
  out["neighbour_gap"] = settings.bind.neighbour_gap;
  out["clusters"] = {{"triangles", settings.clusters.triangles}, {"branching", settings.clusters.branching}};
  json targets = json::object();
  if (settings.targets.fit) targets["fit"] = fit_grade_name(*settings.targets.fit);
  out["targets"] = std::move(targets);
  return out.dump();
}

}  // namespace spherechain::baker
