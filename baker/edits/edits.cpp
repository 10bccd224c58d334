// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/edits/edits.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;

constexpr int kVersion = 1;
constexpr std::size_t kEditsMax = 10'000;
constexpr double kFar = 3, kSmall = 1e-4, kLarge = 2;  // of a region's length

class Reader {
 public:
  explicit Reader(const std::string& file) : file_(file) {}

  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  json parse(const std::string& text) const {
    constexpr int kNestedMax = 8;
    const auto shallow = [&](int depth, json::parse_event_t, const json&) {
      if (depth > kNestedMax) fail("is nested more deeply than edits are");
      return true;
    };
    json out;
    try {
      out = json::parse(text, shallow);
    } catch (const json::exception& e) {
      fail(std::string("is not JSON (") + e.what() + ")");
    }
    if (!out.is_object() || !out.contains("spherechain_edits")) {
      fail("is not a file of edits ('spherechain_edits' is missing; the page of view saves one)");
    }
    return out;
  }

  void known(const json& object, const std::string& where, std::initializer_list<const char*> keys) const {
    if (!object.is_object()) fail(where + " is not an object");
    for (const auto& [key, value] : object.items()) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
        fail((where.empty() ? "" : where + ".") + key + " is unknown");
      }
    }
  }

  const json& list(const json& value, const std::string& where) const {
    if (!value.is_array()) fail(where + " is not a list");
    if (value.size() > kEditsMax) fail(fmt::format("{} has more than {} entries", where, kEditsMax));
    return value;
  }

  double number(const json& value, const std::string& where, double low, double high) const {
    if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high)) {
      fail(fmt::format("{} is not a number from {:g} to {:g}", where, low, high));
    }
    return value.get<double>();
  }

  std::string name(const json& value, const std::string& where) const {
    if (!value.is_string() || value.get_ref<const std::string&>().empty()) fail(where + " is not a name");
    return value.get<std::string>();
  }

  const json& field(const json& object, const char* key, const std::string& where) const {
    const auto found = object.find(key);
    if (found == object.end()) fail(where + "." + key + " is missing");
    return *found;
  }

  SpherePlace place(const json& value, const std::string& where) const {
    known(value, where, {"along", "across", "radius", "detect_radius"});
    SpherePlace out{};
    out.along = number(field(value, "along", where), where + ".along", -kFar, kFar);
    const json& across = field(value, "across", where);
    if (!across.is_array() || across.size() != 2) fail(where + ".across is not two numbers");
    for (std::size_t k = 0; k < 2; ++k) {
      out.across[k] = number(across[k], fmt::format("{}.across[{}]", where, k), -kFar, kFar);
    }
    out.radius = number(field(value, "radius", where), where + ".radius", kSmall, kLarge);
    if (value.contains("detect_radius")) {
      out.detect_radius = number(value["detect_radius"], where + ".detect_radius", out.radius, kLarge);
    }
    return out;
  }

  SphereEdit sphere(const json& value, const std::string& where) const {
    known(value, where, {"region", "from", "to"});
    SphereEdit out;
    out.region = name(field(value, "region", where), where + ".region");
    if (value.contains("from")) out.from = place(value["from"], where + ".from");
    if (value.contains("to")) out.to = place(value["to"], where + ".to");
    if (!out.from && !out.to) fail(where + " has neither 'from' nor 'to'");
    return out;
  }

  std::array<std::string, 2> parts(const json& value, const std::string& where) const {
    if (!value.is_array() || value.size() != 2) fail(where + " is not two body parts");
    std::array<std::string, 2> out{name(value[0], where + "[0]"), name(value[1], where + "[1]")};
    if (out[0] == out[1]) fail(where + " names one body part twice");
    return out;
  }

 private:
  const std::string& file_;
};

json to_json(const SpherePlace& place) {
  json out{{"along", place.along}, {"across", place.across}, {"radius", place.radius}};
  if (place.detect_radius) out["detect_radius"] = *place.detect_radius;
  return out;
}

}  // namespace

Edits parse_edits(const std::string& text, const std::string& file) {
  const Reader reader(file);
  const json object = reader.parse(text);
  reader.known(object, "", {"spherechain_edits", "spheres", "ignored_parts"});
  if (object["spherechain_edits"] != kVersion) {
    reader.fail(fmt::format("spherechain_edits is not {} (it is of another version)", kVersion));
  }
  Edits out;
  if (object.contains("spheres")) {
    for (const json& entry : reader.list(object["spheres"], "spheres")) {
      out.spheres.push_back(reader.sphere(entry, fmt::format("spheres[{}]", out.spheres.size())));
    }
  }
  if (object.contains("ignored_parts")) {
    for (const json& entry : reader.list(object["ignored_parts"], "ignored_parts")) {
      out.ignored_parts.push_back(reader.parts(entry, fmt::format("ignored_parts[{}]", out.ignored_parts.size())));
    }
  }
  return out;
}

std::string to_json(const Edits& edits) {
  json spheres = json::array();
  for (const SphereEdit& edit : edits.spheres) {
    json& entry = spheres.emplace_back(json{{"region", edit.region}});
    if (edit.from) entry["from"] = to_json(*edit.from);
    if (edit.to) entry["to"] = to_json(*edit.to);
  }
  return json{{"spherechain_edits", kVersion}, {"spheres", spheres}, {"ignored_parts", edits.ignored_parts}}.dump();
}

}  // namespace spherechain::baker
