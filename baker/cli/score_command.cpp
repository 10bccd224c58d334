// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/installed.h"
#include "baker/cli/progress.h"
#include "baker/mesh/error.h"
#include "baker/os/own_folder.h"
#include "baker/page/fill_page.h"
#include "baker/score/score_library.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScoreKind = "score";

bool is_score_file(const std::string& name) {
  return name == "score.json" || name == "score.csv" || name == "index.html" || name == "keep.txt" ||
         name == "drop.txt";
}

bool is_metric(const std::string& name) {
  const std::vector<std::string>& names = metric_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

[[noreturn]] void fail_metric(const std::string& option, const std::string& name) {
  throw Error(ExitCode::kUsage,
              fmt::format("{}: there is no metric '{}' (there are {})", option, name, fmt::join(metric_names(), ", ")));
}

// "fault_frames=0.05"
std::vector<std::pair<std::string, double>> limits_of(const ScoreOptions& options) {
  std::vector<std::pair<std::string, double>> out;
  for (const std::string& limit : options.keep_below) {
    const std::size_t at = limit.find('=');
    const std::string name = limit.substr(0, at), number = at == std::string::npos ? "" : limit.substr(at + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || std::isnan(value)) {
      throw Error(ExitCode::kUsage, "--keep-below: '" + limit + "' is no METRIC=NUMBER (fault_frames=0.05)");
    }
    if (!is_metric(name)) fail_metric("--keep-below", name);
    out.emplace_back(name, value);
  }
  return out;
}

ScoreJob job_of(const ScoreOptions& options, const std::vector<std::pair<std::string, double>>& limits) {
  ScoreJob job;
  CheckConfig config = default_config();
  if (!options.character.empty()) config.bake.import.character = options.character;
  if (options.size.is_given()) config.bake.size = options.size;
  std::vector<std::string> paths = options.library;
  paths.insert(paths.end(), options.bodies.begin(), options.bodies.end());
  job.characters = read_library(paths, options.motion, config).characters;
  job.clip = options.clip;
  job.reference = options.reference;
  job.fps = options.fps;
  job.metrics = {options.metrics.begin(), options.metrics.end()};
  for (const std::string& metric : job.metrics) {
    if (!is_metric(metric)) fail_metric("--metrics", metric);
  }
  for (const auto& [name, value] : limits) {
    if (!job.metrics.empty()) job.metrics.insert(name);
  }
  return job;
}

}  // namespace

ExitCode run_score(const ScoreOptions& options) {
  const fs::path page = installed_page("report_score.html");  // now: a long run may outlive its program's file
  const std::vector<std::pair<std::string, double>> limits = limits_of(options);
  OwnFolder::check(options.output, kScoreKind, is_score_file);
  const ScoreJob job = job_of(options, limits);
  std::vector<ScoreRow> rows;
  {
    Progress progress("score");
    rows = score_library(job, [&](const std::string& doing) { progress.show(doing); });
  }
  const std::string json = score_json(rows, options.reference), csv = score_csv(rows);
  OwnFolder folder(options.output, kScoreKind);
  folder.write("score.json", json);
  folder.write("score.csv", csv);
  if (!limits.empty()) {
    const std::array<std::string, 2> lists = keep_below(rows, limits);
    folder.write("keep.txt", lists[0]);
    folder.write("drop.txt", lists[1]);
  }
  if (fs::is_regular_file(page)) {
    folder.write("index.html", PageTemplate(page.string()).fill(nlohmann::ordered_json::parse(json)));
  } else {
    say(stderr, "spherechain: warning: no page: {} is not there (it is built where Node and npm are)\n", page.string());
  }
  folder.finish();
  say("{}", options.json ? json : options.csv ? csv : score_text(rows));
  if (!options.json && !options.csv) say("wrote {}: score.json, score.csv and index.html\n", options.output);
  const bool has_failed = std::any_of(rows.begin(), rows.end(), [](const ScoreRow& row) { return !row.error.empty(); });
  return has_failed ? ExitCode::kFile : ExitCode::kDone;
}

}  // namespace spherechain::baker
