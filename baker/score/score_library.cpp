// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/score_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>

#include "baker/check/run.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/os/child_process.h"
#include "baker/os/parallel.h"
#include "baker/pipeline/pipeline.h"
#include "baker/report/report.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// A clip of a character: a recording, or with an empty file one of its own.
struct Unit {
  std::string name;
  fs::path recording;
  std::size_t number = 0;  // of the character's own clips
};

// A thread has one, to score clips of a character.
struct Worker {
  Worker(const std::string& asset, const LibraryCharacter& character, const ScoreJob& job)
      : animated(OpenAsset(asset, character.name), character.name, character.file.string(), {}, {0, job.fps}),
        scorer(with_joints(animated), job.metrics) {}

  // The automatic rig's, where the character has none.
  static AnimatedAsset& with_joints(AnimatedAsset& animated) {
    if (animated.weights().empty()) animated.take_joints();
    return animated;
  }

  AnimatedAsset animated;
  ClipScorer scorer;
  bool plays_own = false;
};

// A character, whose own clips count, has a mesh. Endings say which files hold motion alone; an .npz holds either.
bool is_character(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending == ".bvh" || ending == ".npy" || ending == ".pkl" || ending == ".csv") return false;
  return ending != ".npz" || !read_source(file).triangles.empty();
}

std::string bake_asset(const LibraryCharacter& character, const std::function<void(const std::string&)>& progress) {
  const Bake baked = bake(character.file, character.config.bake,
                          [&](const std::string& stage) { progress(character.name + ": " + stage); });
  if (const std::string note = unit_note(baked); !note.empty()) add_note(character.name + ": " + note);
  return {reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size()};
}

// A reference is compared with all clips, or is found by the name of each.
struct References {
  std::map<std::string, ClipPlaces> by_name;
  std::optional<ClipPlaces> of_all;

  const ClipPlaces* find(const std::string& clip) const {
    if (of_all) return &*of_all;
    const auto found = by_name.find(clip);
    return found == by_name.end() ? nullptr : &found->second;
  }
};

class CharacterRun {
 public:
  CharacterRun(const LibraryCharacter& character, const ScoreJob& job, std::string asset,
               const std::function<void(const std::string&)>& progress)
      : character_(character), job_(job), asset_(std::move(asset)), progress_(progress) {}

  std::vector<ScoreRow> run() {
    const std::vector<Unit> units = units_of();
    std::vector<ScoreRow> rows(units.size());
    std::vector<std::optional<Worker>> workers(std::min(thread_count(), std::max<std::size_t>(1, units.size())));
    const References references = find_references(workers[0], units);
    std::atomic<std::size_t> done{0};
    run_parallel(workers.size(), units.size(), [&](std::size_t thread, std::size_t u) {
      rows[u].character = character_.name;
      rows[u].score.clip = units[u].name;
      try {
        rows[u].score = score(workers[thread], units[u], references.find(units[u].name));
      } catch (const Interrupted&) {
        throw;
      } catch (const Error& error) {
        rows[u].error = error.what();
      }
      tell(fmt::format("{} of {} clips", ++done, units.size()));
    });
    return rows;
  }

 private:
  // All that reads files or tells the user is done by one thread at a time.
  void tell(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    progress_(character_.name + ": " + text);
  }

  std::vector<Unit> units_of() {
    std::vector<Unit> out;
    for (const LibraryCharacter::Motion& motion : character_.motions) out.push_back({motion.name, motion.file, 0});
    if (!out.empty()) return out;
    const AnimatedAsset animated(OpenAsset(asset_, character_.name), character_.name, character_.file.string(), {},
                                 {0, job_.fps});
    const std::vector<std::string> names = unique_clip_names(animated.character().rig);
    for (std::size_t c = 0; c < names.size(); ++c) {
      if (job_.clip.empty() || names[c] == job_.clip || std::to_string(c) == job_.clip)
        out.push_back({names[c], {}, c});
    }
    if (out.empty()) {
      throw Error(ExitCode::kFile,
                  character_.file.string() + (job_.clip.empty() ? ": has no clips (--motion brings one)"
                                                                : ": has no clip '" + job_.clip + "'"));
    }
    return out;
  }

  // Plays a clip, and returns it.
  const ClipFrames& play(std::optional<Worker>& worker, const Unit& unit) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!worker) worker.emplace(asset_, character_, job_);
    if (!unit.recording.empty()) {
      worker->animated.play({{}, {}, unit.recording.string()}, {0, job_.fps});
      worker->plays_own = false;
    } else if (!worker->plays_own) {
      worker->animated.play({}, {0, job_.fps});
      worker->plays_own = true;
    }
    return worker->animated.clips()[unit.recording.empty() ? unit.number : 0];
  }

  ClipScore score(std::optional<Worker>& worker, const Unit& unit, const ClipPlaces* reference) {
    const ClipFrames& clip = play(worker, unit);
    ClipScore out = worker->scorer.score(clip, reference, [&](int frame) {
      if (frame % 100 == 0) tell(fmt::format("{}, frame {} of {}", unit.name, frame, clip.count));
    });
    out.clip = unit.name;
    return out;
  }

  ClipPlaces places(std::optional<Worker>& worker, const Unit& unit) {
    const ClipFrames& clip = play(worker, unit);
    return worker->scorer.places(clip);
  }

  References find_references(std::optional<Worker>& worker, const std::vector<Unit>& units) {
    References out;
    if (job_.reference.empty()) return out;
    const fs::path file = job_.reference;
    tell("the reference");
    const auto named =
        std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == job_.reference; });
    if (named != units.end()) {
      out.of_all = places(worker, *named);
    } else if (fs::is_directory(file)) {
      for (const Unit& unit : units) {
        const fs::path recording = file / unit.recording.filename();
        if (fs::is_regular_file(recording)) out.by_name[unit.name] = places(worker, {unit.name, recording, 0});
      }
    } else if (!fs::exists(file)) {
      throw Error(ExitCode::kFile,
                  "--reference: " + job_.reference + ": is no clip of " + character_.name + ", and no file");
    } else if (is_character(file)) {
      out = clips_of(file);
    } else {
      out.of_all = places(worker, {file.stem().string(), file, 0});
    }
    return out;
  }

  // The clips of another character, such as this one before it was mended.
  References clips_of(const fs::path& file) {
    LibraryCharacter other = character_;
    other.file = file;
    other.motions.clear();
    Worker worker(bake_asset(other, progress_), other, job_);
    worker.animated.play({}, {0, job_.fps});
    References out;
    const std::vector<std::string> names = unique_clip_names(worker.animated.character().rig);
    for (std::size_t c = 0; c < names.size(); ++c)
      out.by_name[names[c]] = worker.scorer.places(worker.animated.clips()[c]);
    if (names.size() == 1) out.of_all = out.by_name.begin()->second;
    return out;
  }

  const LibraryCharacter& character_;
  const ScoreJob& job_;
  const std::string asset_;
  const std::function<void(const std::string&)>& progress_;
  std::mutex mutex_;
};

}  // namespace

std::vector<ScoreRow> score_library(const ScoreJob& job, const std::function<void(const std::string&)>& progress) {
  std::vector<ScoreRow> out;
  for (const LibraryCharacter& character : job.characters) {
    try {
      if (!character.error.empty()) throw Error(ExitCode::kFile, character.error);
      const std::vector<ScoreRow> rows = CharacterRun(character, job, bake_asset(character, progress), progress).run();
      out.insert(out.end(), rows.begin(), rows.end());
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      out.push_back({character.name, {}, error.what()});
    }
  }
  return out;
}

}  // namespace spherechain::baker
