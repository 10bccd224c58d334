// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/score/score_library.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

std::optional<double> value_of(const ClipScore& score, const std::string& metric) {
  for (const auto& [name, value] : score.metrics) {
    if (name == metric) return value;
  }
  return {};
}

// A name without what would end its line or column.
std::string one_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return name;
}

// A field of a comma-separated table, in quotes where it has to be.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace

std::string score_json(const std::vector<ScoreRow>& rows, const std::string& reference) {
  ordered_json out{{"writer", kWriter}, {"clips", ordered_json::array()}, {"failed", ordered_json::array()}};
  for (const ScoreRow& row : rows) {
    if (!row.error.empty()) {
      out["failed"].push_back({{"character", row.character}, {"clip", row.score.clip}, {"error", row.error}});
      continue;
    }
    ordered_json metrics;
    for (const auto& [name, value] : row.score.metrics) metrics[name] = value ? ordered_json(*value) : ordered_json();
    out["clips"].push_back({{"character", row.character},
                            {"clip", row.score.clip},
                            {"frames", row.score.frames},
                            {"fps", row.score.fps},
                            {"metrics", std::move(metrics)}});
  }
  out["reference"] = reference.empty() ? ordered_json() : ordered_json(reference);
  return json_text(out, 2) + "\n";
}

std::string score_csv(const std::vector<ScoreRow>& rows) {
  std::string out = "character,clip,frames,fps";
  const auto first = std::find_if(rows.begin(), rows.end(), [](const ScoreRow& row) { return row.error.empty(); });
  if (first != rows.end()) {
    for (const auto& [name, value] : first->score.metrics) out += "," + name;
  }
  out += "\n";
  for (const ScoreRow& row : rows) {
    if (!row.error.empty()) continue;
    out += fmt::format("{},{},{},{}", field(row.character), field(row.score.clip), row.score.frames, row.score.fps);
    for (const auto& [name, value] : row.score.metrics) out += value ? fmt::format(",{:.9g}", *value) : ",";
    out += "\n";
  }
  return out;
}

std::string score_text(const std::vector<ScoreRow>& rows) {
  struct Column {
    const char *head, *metric;
    double times;
  };
  constexpr std::array<Column, 6> kColumns{{{"faulty %", "fault_frames", 100},
                                            {"deepest %", "depth_percent_max", 1},
                                            {"volume %", "volume_percent", 1},
                                            {"STaR %", "star_penetration_rate", 100},
                                            {"far pairs", "far_pairs_50", 1},
                                            {"LIMMT", "limmt", 1}}};
  std::size_t wide = 4;
  const auto name_of = [](const ScoreRow& row) { return one_name(row.character + " " + row.score.clip); };
  for (const ScoreRow& row : rows) wide = std::max(wide, row.error.empty() ? name_of(row).size() : 0);
  std::string out = fmt::format("{:<{}}  frames", "clip", wide);
  for (const Column& column : kColumns) out += fmt::format("  {:>9}", column.head);
  out += "\n";
  for (const ScoreRow& row : rows) {
    if (!row.error.empty()) continue;
    out += fmt::format("{:<{}}  {:>6}", name_of(row), wide, row.score.frames);
    for (const Column& column : kColumns) {
      const std::optional<double> value = value_of(row.score, column.metric);
      out += value ? fmt::format("  {:>9.2f}", column.times * *value) : fmt::format("  {:>9}", "-");
    }
    out += "\n";
  }
  for (const ScoreRow& row : rows) {
    if (!row.error.empty()) out += "not scored: " + row.error + "\n";
  }
  return out;
}

std::array<std::string, 3> keep_lists(const std::vector<ScoreRow>& rows, const std::vector<Limit>& limits) {
  std::array<std::string, 3> out;
  for (const ScoreRow& row : rows) {
    if (!row.error.empty()) continue;
    std::size_t list = 0;
    for (const Limit& limit : limits) {
      const std::optional<double> value = value_of(row.score, limit.metric);
      if (!value) list = 2;
      if (value && list == 0 && !(limit.is_above ? *value > limit.number : *value < limit.number)) list = 1;
    }
    out[list] += one_name(row.character) + "\t" + one_name(row.score.clip) + "\n";
  }
  return out;
}

}  // namespace spherechain::baker
