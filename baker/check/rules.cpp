// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>

#include "filter/part_filter.h"
#include "mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;

bool is(const std::string& wanted, const std::string& part) { return wanted == "*" || wanted == part; }

bool concerns(const Rules::Allowed& allowed, const Event& event) {
  const auto& [a, b] = allowed.parts;
  const auto& [p, q] = event.parts;
  return (is(a, p) && is(b, q)) || (is(a, q) && is(b, p));
}

class ConfigReader {
 public:
  explicit ConfigReader(std::string file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  json parse(const std::string& text) const {
    json out = json::parse(text, nullptr, false);
    if (out.is_discarded() || !out.is_object()) fail("is not a JSON object (docs/checking-a-library.md has one)");
    return out;
  }

  double depth(const json& value, const std::string& key) const {
    if (!value.is_number() || value.get<double>() < 0) fail("'" + key + "' is not a depth in mm, 0 or more");
    return value.get<double>();
  }

  std::string text(const json& value, const std::string& key) const {
    if (!value.is_string()) fail("'" + key + "' is not the name of a body part");
    return value.get<std::string>();
  }

  void allow(const json& list, std::vector<Rules::Allowed>& out) const {
    if (!list.is_array()) fail("'allow' is not a list");
    for (const json& entry : list) {
      if (!entry.is_object() || !entry.contains("parts") || !entry.contains("depth_mm") || entry.size() != 2 ||
          !entry["parts"].is_array() || entry["parts"].size() != 2) {
        fail(R"('allow' has an entry that is not {"parts": [one, other], "depth_mm": depth})");
      }
      const json& parts = entry["parts"];
      out.push_back({{text(parts[0], "allow"), text(parts[1], "allow")}, depth(entry["depth_mm"], "allow")});
    }
  }

  // What intersects in every pose is how the character is made, and no clip's fault.
  void filter(const json& path, std::vector<Rules::Allowed>& out) const {
    if (!path.is_string()) fail("'filter' is not the path of a file that filter wrote");
    const std::filesystem::path folder = std::filesystem::path(file_).parent_path();
    const PartFilter filter = read_part_filter((folder / path.get<std::string>()).string());
    for (const FilteredPair& pair : filter.pairs) {
      if (pair.kind != PairKind::kAlways) continue;
      out.push_back({{filter.parts[pair.parts[0]], filter.parts[pair.parts[1]]}, Rules::kAnyDepthMm});
    }
  }

  void leave_out(const json& list, std::vector<std::string>& out) const {
    if (!list.is_array()) fail("'leave_out' is not a list");
    for (const json& entry : list) out.push_back(text(entry, "leave_out"));
  }

  void severity(const json& object, Rules& rules) const {
    if (!object.is_object()) fail("'severity' is not an object");
    for (const auto& [key, value] : object.items()) {
      if (key != "penetration" && key != "deep_fold") fail("'severity' knows penetration and deep_fold, not " + key);
      Severity& out = key == "penetration" ? rules.penetration : rules.deep_fold;
      if (value == "error") {
        out = Severity::kError;
      } else if (value == "warning") {
        out = Severity::kWarning;
      } else if (value == "ignore") {
        out = Severity::kIgnore;
      } else {
        fail("'severity' is error, warning or ignore");
      }
    }
  }

 private:
  std::string file_;
};

}  // namespace

bool Rules::leaves_out(const Event& event) const {
  return std::any_of(left_out.begin(), left_out.end(),
                     [&](const std::string& part) { return part == event.parts[0] || part == event.parts[1]; });
}

std::string Rules::excuse(const Event& event) const {
  if (!is_fault(event.kind)) return {};
  for (const Allowed& one : allowed) {
    if (concerns(one, event) && event.depth_mm <= one.depth_mm) {
      if (one.depth_mm >= kAnyDepthMm)
        return fmt::format("{} and {}: any depth is allowed", one.parts[0], one.parts[1]);
      return fmt::format("{} and {}: {:g} mm are allowed", one.parts[0], one.parts[1], one.depth_mm);
    }
  }
  if (event.depth_mm <= max_depth_mm) return fmt::format("{:g} mm are allowed", max_depth_mm);
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
  return kind == SC_CLASS_PENETRATION ? penetration : kind == SC_CLASS_DEEP_FOLD ? deep_fold : Severity::kIgnore;
}

CheckConfig read_config(const std::string& text, const std::string& file, const CheckConfig& start) {
  const ConfigReader reader(file);
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
      config.rules.max_depth_mm = reader.depth(value, key);
    } else if (key == "severity") {
      reader.severity(value, config.rules);
    } else if (key == "bake") {
      config.bake = make_settings("balanced", value.dump(), file);
    } else {
      reader.fail("'" + key + "' is unknown (allow, filter, leave_out, max_depth_mm, severity and bake are known)");
    }
  }
  return config;
}

CheckConfig default_config() { return {{}, make_settings("balanced", "{}", {})}; }

}  // namespace spherechain::baker
