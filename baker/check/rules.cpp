// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>

#include "baker/check/json_input.h"
#include "baker/filter/part_filter.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using json = nlohmann::ordered_json;

bool is(const std::string& wanted, const std::string& part) { return wanted == "*" || wanted == part; }

bool concerns(const Rules::Allowed& allowed, const Event& event) {
  const auto& [a, b] = allowed.parts;
  const auto& [p, q] = event.parts;
  return (is(a, p) && is(b, q)) || (is(a, q) && is(b, p));
}

class ConfigReader {
 public:
  ConfigReader(std::string file, std::string place) : file_(std::move(file)), place_(std::move(place)) {}

  std::string here() const { return file_ + (place_.empty() ? "" : ": " + place_); }
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, here() + ": " + what); }

  json parse(const std::string& text) const {
    constexpr const char* kRefusal = "is not a JSON object (docs/checking-a-library.md has one)";
    json out = parse_input(text, here(), kRefusal);
    if (!out.is_object()) fail(kRefusal);
    return out;
  }

  // `key`: "'max_depth_mm'", or "'allow', entry 2: 'depth_mm'".
  double depth(const json& value, const std::string& key) const {
    if (!value.is_number() || value.get<double>() < 0) {
      const bool is_percent = key.find("percent") != std::string::npos;
      fail(key + " is not a depth in " + (is_percent ? "percent of the height" : "mm") + ", 0 or more");
    }
    return value.get<double>();
  }

  std::string text(const json& value, const std::string& key) const {
    if (!value.is_string()) fail(key + " is not the name of a body part");
    return value.get<std::string>();
  }

  void allow(const json& list, std::vector<Rules::Allowed>& out) const {
    if (!list.is_array()) fail("'allow' is not a list");
    for (std::size_t i = 0; i < list.size(); ++i) out.push_back(allowed(list[i], entry_text("allow", i)));
  }

  Rules::Allowed allowed(const json& entry, const std::string& place) const {
    if (!entry.is_object()) fail(place + R"( is not {"parts": [one, other], "depth_mm": depth})");
    for (const auto& [key, value] : entry.items()) {
      if (key != "parts" && key != "depth_mm" && key != "depth_percent")
        fail(place + ": '" + key + "' is unknown (parts, depth_mm and depth_percent are known)");
    }
    const json parts = entry.value("parts", json());
    if (!parts.is_array() || parts.size() != 2) fail(place + ": 'parts' is not a list of two body parts");
    const std::string key = place + ": 'parts'";
    Rules::Allowed out{{text(parts[0], key), text(parts[1], key)}, {}};
    const bool has_percent = entry.contains("depth_percent");
    if (has_percent) out.depth.percent = depth(entry["depth_percent"], place + ": 'depth_percent'");
    if (!has_percent || entry.contains("depth_mm"))
      out.depth.mm = depth(entry.value("depth_mm", json()), place + ": 'depth_mm'");
    return out;
  }

  // Pairs that intersect in every pose come from the character's design; no clip causes them.
  void filter(const json& path, std::vector<Rules::Allowed>& out) const {
    if (!path.is_string()) fail("'filter' is not the path of a file that filter wrote");
    const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
    const PartFilter filter = read_part_filter((folder / path.get<std::string>()).string());
    for (const FilteredPair& pair : filter.pairs) {
      if (pair.kind != PairKind::kAlways) continue;
      out.push_back({{filter.parts[pair.parts[0]], filter.parts[pair.parts[1]]}, {Rules::kAnyDepthMm, 0}});
    }
  }

  void leave_out(const json& list, std::vector<std::string>& out) const {
    if (!list.is_array()) fail("'leave_out' is not a list");
    for (std::size_t i = 0; i < list.size(); ++i) out.push_back(text(list[i], entry_text("leave_out", i)));
  }

  void severity(const json& object, Rules& rules) const {
    if (!object.is_object()) fail("'severity' is not an object");
    for (const auto& [key, value] : object.items()) {
      if (key != "penetration" && key != "deep_fold")
        fail("'severity': '" + key + "' is unknown (penetration and deep_fold are known)");
      Severity& out = key == "penetration" ? rules.penetration : rules.deep_fold;
      if (value == "error") {
        out = Severity::kError;
      } else if (value == "warning") {
        out = Severity::kWarning;
      } else if (value == "ignore") {
        out = Severity::kIgnore;
      } else {
        fail("'severity': '" + key + "' is not error, warning or ignore");
      }
    }
  }

 private:
  static std::string entry_text(const char* key, std::size_t index) {
    return fmt::format("'{}', entry {}", key, index + 1);
  }

  std::string file_, place_;
};

}  // namespace

bool Rules::leaves_out(const std::array<std::string, 2>& parts) const {
  return std::any_of(left_out.begin(), left_out.end(),
                     [&](const std::string& part) { return part == parts[0] || part == parts[1]; });
}

std::string Rules::Depth::text() const {
  if (mm >= kAnyDepthMm) return "any depth is allowed";
  if (percent <= 0) return fmt::format("{:g} mm are allowed", mm);
  const std::string also = mm > 0 ? fmt::format("{:g} mm or ", mm) : "";
  return fmt::format("{}{:g} % of the height are allowed", also, percent);
}

std::string Rules::excuse(const Event& event) const {
  if (!is_fault(event.kind)) return {};
  for (const Allowed& one : allowed) {
    if (concerns(one, event) && one.depth.covers(event))
      return fmt::format("{} and {}: {}", one.parts[0], one.parts[1], one.depth.text());
  }
  if (max_depth.covers(event)) return max_depth.text();
  if (severity(event.kind) == Severity::kIgnore)
    return fmt::format("{} is ignored", sc_penetration_class_name(event.kind));
  return {};
}

std::vector<std::string> Rules::named_parts() const {
  std::vector<std::string> out = left_out;
  for (const Allowed& one : allowed) {
    std::copy_if(one.parts.begin(), one.parts.end(), std::back_inserter(out),
                 [](const auto& part) { return part != "*"; });
  }
  return out;
}

Severity Rules::severity(PenetrationClass kind) const {
  return kind >= SC_CLASS_PENETRATION ? penetration : kind == SC_CLASS_DEEP_FOLD ? deep_fold : Severity::kIgnore;
}

CheckConfig read_config(const std::string& text, const std::string& file, const CheckConfig& start,
                        const std::string& place) {
  const ConfigReader reader(file, place);
  CheckConfig config = start;
  const json object = reader.parse(text);
  for (const auto& [key, value] : object.items()) {
    if (key == "allow") {
      reader.allow(value, config.rules.allowed);
    } else if (key == "filter") {
      reader.filter(value, config.rules.allowed);
    } else if (key == "leave_out") {
      reader.leave_out(value, config.rules.left_out);
    } else if (key == "max_depth_mm") {
      config.rules.max_depth.mm = reader.depth(value, "'max_depth_mm'");
    } else if (key == "max_depth_percent") {
      config.rules.max_depth.percent = reader.depth(value, "'max_depth_percent'");
    } else if (key == "severity") {
      reader.severity(value, config.rules);
    } else if (key == "bake") {
      config.bake = make_settings("balanced", value.dump(), reader.here() + ": 'bake'");
    } else {
      reader.fail(
          "'" + key +
          "' is unknown (allow, filter, leave_out, max_depth_mm, max_depth_percent, severity and bake are known)");
    }
  }
  return config;
}

CheckConfig default_config() { return {{}, make_settings("balanced", "{}", {})}; }

}  // namespace spherechain::baker
