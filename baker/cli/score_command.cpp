// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/installed.h"
#include "baker/cli/progress.h"
#include "baker/mesh/error.h"
#include "baker/os/own_folder.h"
#include "baker/os/work_folder.h"
#include "baker/page/fill_page.h"
#include "baker/score/bodies.h"
#include "baker/score/score_library.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScoreKind = "score";

bool is_score_file(const std::string& name) {
  return name == "score.json" || name == "score.csv" || name == "index.html" || name == "keep.txt" ||
         name == "drop.txt" || name == "unmeasured.txt";
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
void add_limits(const char* option, const std::vector<std::string>& texts, bool is_above, std::vector<Limit>& to) {
  for (const std::string& text : texts) {
    const std::size_t at = text.find('=');
    const std::string name = text.substr(0, at), number = at == std::string::npos ? "" : text.substr(at + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || std::isnan(value)) {
      throw Error(ExitCode::kUsage, fmt::format("{}: '{}' is no METRIC=NUMBER (fault_frames=0.05)", option, text));
    }
    if (!is_metric(name)) fail_metric(option, name);
    if (is_share(name) && value > 1) {
      throw Error(ExitCode::kUsage, fmt::format("{}: {} is a share, from 0 to 1, not {}", option, name, number));
    }
    to.push_back({name, value, is_above});
  }
}

ScoreJob job_of(const ScoreOptions& options, const std::vector<std::string>& paths, const std::vector<Limit>& limits) {
  ScoreJob job;
  CheckConfig config = default_config();
  if (!options.character.empty()) config.bake.import.character = options.character;
  if (options.size.is_given()) config.bake.size = options.size;
  job.characters = read_library(paths, options.motion, config).characters;
  job.clip = options.clip;
  job.reference = options.reference;
  job.fps = options.fps;
  job.metrics = {options.metrics.begin(), options.metrics.end()};
  for (const std::string& metric : job.metrics) {
    if (!is_metric(metric)) fail_metric("--metrics", metric);
  }
  for (const Limit& limit : limits) {
    if (!job.metrics.empty()) job.metrics.insert(limit.metric);
  }
  return job;
}

}  // namespace

ExitCode run_score(const ScoreOptions& options) {
  const fs::path page = installed_page("report_score.html");  // now: a long run may outlive its program's file
  std::vector<Limit> limits;
  add_limits("--keep-below", options.keep_below, false, limits);
  add_limits("--keep-above", options.keep_above, true, limits);
  OwnFolder::check(options.output, kScoreKind, is_score_file);
  std::vector<std::string> paths = options.library;
  std::optional<WorkFolder> made;
  for (const std::string& body : options.bodies) {
    if (!is_makehuman(body)) {
      paths.push_back(body);
      continue;
    }
    if (!made) made.emplace(fs::temp_directory_path());
    const std::vector<std::string> people = write_bodies(body, made->path());
    paths.insert(paths.end(), people.begin(), people.end());
  }
  const ScoreJob job = job_of(options, paths, limits);
  std::vector<ScoreRow> rows;
  {
    Progress progress("score");
    rows = score_library(job, [&](const std::string& doing) { progress.show(doing); });
  }
  if (std::all_of(rows.begin(), rows.end(), [](const ScoreRow& row) { return !row.error.empty(); })) {
    throw Error(ExitCode::kFile, rows.empty() ? "nothing to score" : rows[0].error);
  }
  const std::string json = score_json(rows, options.reference), csv = score_csv(rows);
  OwnFolder folder(options.output, kScoreKind);
  folder.write("score.json", json);
  folder.write("score.csv", csv);
  if (!limits.empty()) {
    const std::array<std::string, 3> lists = keep_lists(rows, limits);
    folder.write("keep.txt", lists[0]);
    folder.write("drop.txt", lists[1]);
    folder.write("unmeasured.txt", lists[2]);
  }
  if (fs::is_regular_file(page)) {
    folder.write("index.html", PageTemplate(page.string()).fill(nlohmann::ordered_json::parse(json)));
  } else {
    say(stderr, "spherechain: warning: no page: {} is not there (it is built where Node and npm are)\n", page.string());
  }
  folder.finish();
  for (const ScoreRow& row : rows) {
    if (!row.error.empty()) say(stderr, "spherechain: warning: not scored: {}\n", one_line(row.error));
  }
  say("{}", options.json ? json : options.csv ? csv : score_text(rows));
  if (!options.json && !options.csv) say("wrote {}: score.json, score.csv and index.html\n", options.output);
  const bool has_failed = std::any_of(rows.begin(), rows.end(), [](const ScoreRow& row) { return !row.error.empty(); });
  return has_failed ? ExitCode::kFile : ExitCode::kDone;
}

}  // namespace spherechain::baker
