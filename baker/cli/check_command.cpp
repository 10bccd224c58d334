// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>

#include "baker/check/formats.h"
#include "baker/check/report_folder.h"
#include "baker/check/shards.h"
#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/installed.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/fix/fix_library.h"
#include "baker/import/notes.h"
#include "baker/os/parallel.h"
#include "baker/os/work_folder.h"
#include "baker/os/written_file.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

Shard parse_shard(const std::string& text) {
  Shard shard;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d/%d%c", &shard.index, &shard.count, &rest) != 2 || shard.index < 1 ||
      shard.count > 100000 || shard.index > shard.count) {
    throw Error(ExitCode::kUsage, "--shard: '" + text + "' is not I/N, with I from 1 to N");
  }
  return shard;
}

FailOn parse_fail_on(const std::string& text) {
  return text == "new" ? FailOn::kNew : text == "none" ? FailOn::kNone : FailOn::kPenetration;
}

void check_usage(const CheckOptions& options) {
  if (options.accept && options.baseline.empty()) {
    throw Error(ExitCode::kUsage, "--accept: needs a baseline to write (--baseline FILE)");
  }
  const bool is_judged = options.accept || !options.baseline.empty() || !options.json.empty() ||
                         !options.junit.empty() || !options.sarif.empty();
  if (!options.shard.empty() && (options.merge || is_judged)) {
    throw Error(ExitCode::kUsage, "--shard: only computes; --merge, --baseline and reports come with the merge");
  }
  if (!options.fix.empty() && (options.merge || !options.shard.empty())) {
    throw Error(ExitCode::kUsage, "--fix: mends what it has checked itself, no shards (run fix for each character)");
  }
  if (options.merge && options.size.is_given()) {
    throw Error(ExitCode::kUsage, "--merge: takes sizes from the shards (give --scale and --height to these)");
  }
  if (options.merge && (!options.config.empty() || !options.motion.empty() || !options.cache.empty())) {
    throw Error(ExitCode::kUsage,
                "--merge: takes rules, motions and results from the shards (give --config, --motion "
                "and --cache to these)");
  }
}

// Its results have names that are hashes; nothing is deleted.
void check_shard_folder(const std::string& folder, const std::vector<CommandFile>& inputs) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ExitCode::kFile, folder + ": cannot be created (" + error.message() + ")");
  check_outputs(inputs, {{"-o", (fs::path(folder) / kShardFile).string(), FileKind::kJson}}, Force::kNone);
}

bool is_in(const fs::path& place, const fs::path& folder) {
  const fs::path inside = place.lexically_relative(folder);
  return !inside.empty() && *inside.begin() != "..";
}

// A folder that is written to is no other one, and none that is looked through for inputs. Mended characters do not go
// below one either: the next check would take them for characters of the library.
void check_folders(const CheckOptions& options, const std::vector<fs::path>& inputs) {
  const std::vector<std::pair<const char*, std::string>> folders{
      {"-o", options.output}, {"--fix", options.fix}, {"--cache", options.cache}};
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const auto& [name, folder] = folders[i];
    if (folder.empty()) continue;
    const fs::path place = fs::weakly_canonical(fs::absolute(folder));
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [other_name, other] = folders[j];
      if (other.empty() || place != fs::weakly_canonical(fs::absolute(other))) continue;
      throw Error(ExitCode::kUsage,
                  folder + ": " + other_name + " and " + name + " are the same folder (name another)");
    }
    for (const fs::path& input : inputs) {
      if (place == input) {
        throw Error(ExitCode::kUsage,
                    folder + ": " + name + " is a folder of the library or of recordings (name another)");
      }
      if (folder == options.fix && is_in(place, input)) {
        throw Error(ExitCode::kUsage, folder + ": --fix is inside " + input.string() +
                                          ", where the next check would read what it writes (name a folder outside)");
      }
    }
  }
}

// "check: 312 of 1000 clips checked, 8.1 a second, 1:25 left".
class RunProgress {
 public:
  void show(const RunState& state) {
    if (doing_ != state.doing) {
      doing_ = state.doing;
      start_ = Clock::now();
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const bool is_of_clips = doing_ == "checking";
    std::string text =
        fmt::format("{} {} of {} {}", doing_, state.done, state.all, is_of_clips ? "clips" : "characters");
    if (state.done > 0 && seconds > 1) {
      const double rate = static_cast<double>(state.done) / seconds;
      const int left = static_cast<int>(static_cast<double>(state.all - state.done) / rate);
      text += fmt::format(", {:.1f} a second, {}:{:02} left", rate, left / 60, left % 60);
    }
    if (!state.now.empty()) text += "; " + state.now;
    progress_.show(text);
  }

 private:
  Progress progress_{"check:"};
  std::string doing_;
  Clock::time_point start_;
};

std::vector<CharacterRules> rules_of(const std::vector<LibraryCharacter>& library) {
  std::vector<CharacterRules> out;
  for (const LibraryCharacter& c : library) out.push_back({c.name, c.file.string(), c.config.rules});
  return out;
}

Verdict report(const CheckOptions& options, const std::vector<CheckedClip>& clips,
               const std::vector<CharacterRules>& characters, Baseline baseline, const Store& store,
               const fs::path& pages) {
  const FailOn fail_on = parse_fail_on(options.fail_on);
  Verdict verdict = evaluate_clips(clips, characters, store, baseline, options.folds, fail_on);
  if (options.accept) {
    baseline = accept(verdict, baseline);
    verdict = evaluate_clips(clips, characters, store, baseline, options.folds, fail_on);
  }
  const bool has_pages = write_report(options.output, verdict, store, pages);
  if (!options.json.empty()) write_atomically(options.json, check_json(verdict));
  if (!options.junit.empty()) write_atomically(options.junit, check_junit(verdict));
  if (!options.sarif.empty()) write_atomically(options.sarif, check_sarif(verdict));
  if (options.accept) write_atomically(options.baseline, to_bytes(baseline));
  say("{}", check_text(verdict, fail_on == FailOn::kNew));
  if (has_pages) {
    say("wrote {}: open it in a browser\n", (fs::path(options.output) / "index.html").string());
  } else {
    say("wrote {}, without pages: they are built where Node and npm are\n", options.output);
  }
  return verdict;
}

// The library does not fail by what kept a clip from being checked and is none of its faults.
void check_complete(const std::vector<CheckedClip>& clips) {
  for (const CheckedClip& clip : clips) {
    if (clip.was_interrupted) throw Error(ExitCode::kFile, clip.error);
  }
}

ExitCode code_of(const Verdict& verdict) { return verdict.fails ? ExitCode::kCheckFailed : ExitCode::kDone; }

}  // namespace

ExitCode run_check(const CheckOptions& options) {
  check_usage(options);
  const fs::path pages = installed_page("");  // now: a long run may outlive its program's file
  CheckConfig config = default_config();
  if (!options.config.empty()) config = read_config(read_file(options.config), options.config, config);
  if (!options.character.empty()) config.bake.import.character = options.character;
  if (options.size.is_given()) config.bake.size = options.size;
  config.rules.max_depth.mm = std::max(config.rules.max_depth.mm, options.max_depth);
  Baseline baseline;
  if (!options.baseline.empty()) baseline = read_baseline(options.baseline, options.accept);
  std::vector<CommandFile> inputs{{"--config", options.config}, {"--motion", options.motion}};
  for (const std::string& path : options.library) inputs.push_back({"LIBRARY", path});
  const std::string accepted = options.accept ? options.baseline : "";
  check_outputs(inputs,
                {{"--baseline", accepted, FileKind::kJson, accepted},  // it was read: its keys stay
                 {"--json", options.json, FileKind::kJson},
                 {"--junit", options.junit, FileKind::kJunit},
                 {"--sarif", options.sarif, FileKind::kSarif}},
                Force::kNone);
  if (!options.shard.empty()) check_shard_folder(options.output, inputs);
  check_folders(options, {});
  if (options.merge) {
    check_report_folder(options.output);
    const WorkFolder work(options.output);
    const Store store(work.path());
    const ShardResult all = merge_shards(options.library, store);
    const Verdict verdict = report(options, all.clips, all.characters, baseline, store, pages);
    return code_of(verdict);
  }
  const Library read = read_library(options.library, options.motion, config);
  const std::vector<LibraryCharacter>& library = read.characters;
  check_folders(options, read.folders);
  if (!options.fix.empty()) {
    check_fix_folder(library, options.fix);
  }
  RunOptions run;
  run.fps = options.fps;
  run.continuous = options.continuous;
  run.jobs = options.jobs > 0 ? options.jobs : static_cast<int>(processor_count());
  const auto check = [&](const Store& store) {
    RunProgress progress;
    return check_library(library, run, store, [&](const RunState& state) { progress.show(state); });
  };
  if (!options.shard.empty()) {
    run.shard = parse_shard(options.shard);
    const Store store(options.cache.empty() ? fs::path(options.output) / kShardStore : fs::path(options.cache));
    const ShardResult result{run.shard, rules_of(library), check(store)};
    check_complete(result.clips);
    write_shard(options.output, result, store);
    say("wrote {}: {} clips, shard {} of {}\n", options.output, result.clips.size(), run.shard.index, run.shard.count);
    return ExitCode::kDone;
  }
  check_report_folder(options.output);
  std::optional<WorkFolder> work;
  if (options.cache.empty()) work.emplace(options.output);
  const Store store(work ? work->path() : fs::path(options.cache));
  const std::vector<CheckedClip> clips = check(store);
  const Verdict verdict = report(options, clips, rules_of(library), baseline, store, pages);
  take_notes();  // the report has them
  if (!options.fix.empty()) {
    RunProgress progress;
    if (options.accept) baseline = read_baseline(options.baseline, false);  // what the report wrote
    const std::vector<std::string> lines = fix_library(library, verdict, baseline, options.fix, run.jobs,
                                                       [&](const RunState& state) { progress.show(state); });
    for (const std::string& line : lines) say("{}\n", line);
    if (lines.empty()) say("nothing to mend\n");
  }
  check_complete(clips);
  return code_of(verdict);
}

}  // namespace spherechain::baker
