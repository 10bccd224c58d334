// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "baker/check/clip_queue.h"
#include "baker/check/clip_worker.h"
#include "baker/check/file_hash.h"
#include "baker/check/tickets.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/mesh/utf8.h"
#include "baker/os/child_process.h"
#include "baker/os/sha256.h"
#include "baker/report/report.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kWorkerClips = 8;  // a process is worth it for so many: it reads the character

std::string key_of(const std::string& what, const std::vector<std::string>& of) {
  std::string text = what + "\n" + tool_identity();
  for (const std::string& part : of) text += "\n" + part;
  return sha256_of_text(text);
}

// Units weigh what their files weigh: a guess at their frames that every machine makes alike.
std::vector<ChosenCharacter> choose(const std::vector<LibraryCharacter>& library, const Shard& shard) {
  const auto weight = [](const fs::path& file) {
    std::error_code error;
    const auto size = fs::file_size(file, error);
    return 1.0 + (error ? 0.0 : static_cast<double>(size));
  };
  double all = 0;
  for (const LibraryCharacter& c : library) {
    all += weight(c.file);
    for (const auto& motion : c.motions) all += weight(motion.file);
  }
  std::vector<ChosenCharacter> out;
  double before = 0;
  for (std::size_t c = 0; c < library.size(); ++c) {
    ChosenCharacter chosen{&library[c], c, {}, {}, {}, {}};
    for (std::size_t unit = 0; unit <= library[c].motions.size(); ++unit) {
      const double own = weight(unit == kOwnClips ? library[c].file : library[c].motions[unit - 1].file);
      const int part = std::min(shard.count, 1 + static_cast<int>((before + own / 2) / all * shard.count));
      before += own;
      if (part == shard.index) chosen.units.push_back(unit);
    }
    if (!chosen.units.empty()) out.push_back(std::move(chosen));
  }
  return out;
}

// `file` is the character's.
void write_bake(const Store& store, const std::string& key, const fs::path& file, const Bake& baked) {
  CharacterResult result;
  result.clips = unique_clip_names(baked.character.rig);
  result.grade = fit_grade_name(baked.quality.grade());
  result.fit = fit_line(baked);
  for (const std::string& note : take_notes()) result.notes.push_back(without_file(note, file));
  if (const std::string note = unit_note(baked); !note.empty()) result.notes.push_back(note);
  for (const BodyPart& part : baked.body_parts.parts) result.parts.push_back(part.name);
  result.limbs = limbs_of(baked.body_parts.parts);
  store.write(key, kAssetFile, {reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size()});
  store.write(key, kResultFile, to_bytes(result));
}

std::optional<CharacterResult> read_character(const Store& store, const std::string& key) {
  const std::optional<std::string> bytes = store.read(key, kResultFile);
  if (!bytes || !store.has(key, kAssetFile)) return {};
  return read_character_result(*bytes);
}

bool is_checked(const Store& store, const CheckedClip& clip) {
  const std::optional<std::string> bytes = store.read(clip.key, kResultFile);
  const std::optional<ClipResult> result = bytes ? read_clip_result(*bytes) : std::nullopt;
  if (!result || !store.has(clip.character_key, kPageFile)) return false;
  const std::vector<std::string> kinds = files_of(*result);
  return std::all_of(kinds.begin(), kinds.end(), [&](const std::string& kind) { return store.has(clip.key, kind); });
}

class Run {
 public:
  Run(const RunOptions& options, const Store& store, const std::function<void(const RunState&)>& progress)
      : options_(options), store_(store), progress_(progress) {}

  void bake_all(std::vector<ChosenCharacter>& characters) {
    std::deque<Task> tasks;
    std::set<std::string> asked;
    for (ChosenCharacter& character : characters) {
      character.error = character.of->error;
      if (!character.error.empty()) continue;
      try {
        character.hash = hash_of_input(character.of->file);
        character.key = key_of(
            "character", {character.hash, to_json(character.of->config.bake), character.of->file.extension().string()});
      } catch (const Error& error) {
        character.error = error.what();
        continue;
      }
      if (read_character(store_, character.key) || !asked.insert(character.key).second) continue;
      tasks.push_back({[&](const Task::Tell& tell) { bake_in_child(character, tell); },
                       [&](const std::string& line) {
                         if (line[0] == kNow) return tell_now(character, line.substr(1));
                         character.error = line.substr(1);
                       },
                       [&](const Ending& ending) {
                         check_store(ending);
                         if (!ending.failure.empty()) {
                           character.error = failure_text(character.of->file, ending.failure);
                           character.was_interrupted = ending.was_interrupted;
                         }
                         ++done_;
                       }});
    }
    run("baking", tasks, tasks.size());
    std::set<std::string> failed;  // contents
    for (ChosenCharacter& character : characters) {
      if (!character.error.empty()) {
        failed.insert(character.key);
      } else if (failed.contains(character.key)) {
        character.error = character.of->file.string() + ": cannot be baked, see the same file above";
      }
    }
  }

  std::vector<CheckedClip> check_all(const std::vector<ChosenCharacter>& characters) {
    std::vector<CheckedClip> clips;
    std::vector<std::vector<QueuedClip>> queued(characters.size());  // by the clip's index first
    for (const ChosenCharacter& character : characters) list(character, clips);
    for (std::size_t c = 0, i = 0; c < characters.size(); ++c) {
      for (; i < clips.size() && clips[i].character == characters[c].place; ++i) {
        CheckedClip& clip = clips[i];
        if (!clip.error.empty() || clip.clip.empty() || is_checked(store_, clip)) continue;
        queued[c].push_back({&clip, clip.order / kClipsPerUnitMax, clip.order % kClipsPerUnitMax});
      }
    }
    std::size_t all = 0;
    std::deque<Task> tasks;
    for (std::size_t c = 0; c < characters.size(); ++c) {
      if (queued[c].empty()) continue;
      all += queued[c].size();
      const std::size_t workers = std::min<std::size_t>(static_cast<std::size_t>(options_.jobs),
                                                        (queued[c].size() + kWorkerClips - 1) / kWorkerClips);
      const auto queue = std::make_shared<ClipQueue>(characters[c], std::move(queued[c]));
      for (std::size_t i = 0; i < workers; ++i) add(tasks, queue);
    }
    run("checking", tasks, all);
    return clips;
  }

 private:
  static std::string failure_text(const fs::path& file, const std::string& failure) {
    return failure.starts_with(file.string() + ":") ? failure : file.string() + ": " + failure;
  }

  void run(const char* doing, std::deque<Task>& tasks, std::size_t all) {
    done_ = 0;
    now_.clear();
    run_in_children(tasks, options_.jobs, [&] { progress_({doing, done_, all, now_}); });
  }

  void tell_now(const ChosenCharacter& character, const std::string& what) { now_ = character.of->name + ": " + what; }

  // Children tell what is wrong with a file; an Error that ends one is the store's, and no other child gets on.
  static void check_store(const Ending& ending) {
    if (ending.is_error && !ending.was_interrupted) throw Error(ExitCode::kFile, ending.failure);
  }

  void bake_in_child(const ChosenCharacter& character, const Task::Tell& tell) const {
    News news(tell);
    std::optional<Bake> baked;
    take_notes();  // of characters before it
    try {
      do_unchanged(character.of->file, character.hash, [&] {
        baked = bake(character.of->file, character.of->config.bake, [&](const std::string& stage) { news(stage); });
      });
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      return tell(kFailed + std::string(error.what()));
    }
    write_bake(store_, character.key, character.of->file, *baked);
  }

  // The clips of a character, checked or not.
  void list(const ChosenCharacter& character, std::vector<CheckedClip>& out) {
    const auto add_row = [&](std::size_t unit, std::size_t number, const std::string& name, const std::string& error) {
      out.push_back({character.place,
                     unit * kClipsPerUnitMax + number,
                     name,
                     error,
                     {},
                     character.key,
                     character.was_interrupted});
    };
    if (!character.error.empty()) return add_row(0, 0, {}, character.error);
    const std::optional<CharacterResult> result = read_character(store_, character.key);
    if (!result) store_.fail_lost();
    const std::string fps = fmt::format("{}{}", options_.fps, options_.continuous ? ", between frames" : "");
    for (const std::size_t unit : character.units) {
      if (unit == kOwnClips) {
        for (std::size_t i = 0; i < result->clips.size(); ++i) {
          add_row(unit, i, result->clips[i], {});
          out.back().key = key_of("clip", {character.key, fmt::format("{}", i), fps});
        }
        continue;
      }
      const LibraryCharacter::Motion& motion = character.of->motions[unit - 1];
      add_row(unit, 0, motion.name, motion.error);
      if (!motion.error.empty()) continue;
      try {
        out.back().key = key_of("recording", {character.key, motion_hash(motion.file), fps});
      } catch (const Error& error) {
        out.back().error = error.what();
      }
    }
    if (result->clips.empty() && character.of->motions.empty()) {
      add_row(0, 0, {}, {});
    }
  }

  const std::string& motion_hash(const fs::path& file) {
    const auto [entry, is_new] = motion_hashes_.try_emplace(file.string());
    if (is_new) {
      try {
        entry->second = hash_of_input(file);
      } catch (...) {
        motion_hashes_.erase(entry);
        throw;
      }
    }
    return entry->second;
  }

  // A process that checks clips of a character.
  void add(std::deque<Task>& tasks, const std::shared_ptr<ClipQueue>& queue) {
    if (queue->is_empty()) return;
    const auto at = std::make_shared<std::optional<std::size_t>>();  // the clip that it is at
    Task task;
    task.work = [this, queue, at](const Task::Tell& tell) {
      check_clips(*queue, *at, options_, store_, motion_hashes_, tell);
    };
    task.on_line = [this, queue, at](const std::string& line) {
      if (line[0] == kNow) {
        tell_now(queue->character, line.substr(1));
      } else if (!*at) {
        *at = std::stoul(line);
      } else {
        end(queue->clips[**at], line.substr(1), line[0] == kInterrupted);
        at->reset();
      }
    };
    task.ended = [this, &tasks, queue, at](const Ending& ending) {
      check_store(ending);
      // A clip that makes the process fail does not keep the other clips from being checked.
      if (*at) {
        const QueuedClip& queued = queue->clips[**at];
        const std::string& failure = ending.failure;
        end(queued, failure_text(queue->file_of(queued), failure.empty() ? "ends the check early" : failure),
            ending.was_interrupted);
      }
      if (*at || !ending.failure.empty()) add(tasks, queue);
    };
    tasks.push_back(std::move(task));
  }

  void end(const QueuedClip& queued, const std::string& error, bool was_interrupted) {
    queued.clip->error = error;
    queued.clip->was_interrupted = was_interrupted;
    ++done_;
  }

  const RunOptions& options_;
  const Store& store_;
  const std::function<void(const RunState&)>& progress_;
  std::size_t done_ = 0;
  std::string now_;
  std::map<std::string, std::string> motion_hashes_;
};

}  // namespace

std::vector<std::string> unique_clip_names(const SourceRig& rig) {
  std::vector<std::string> out;
  std::set<std::string> names;
  for (std::size_t i = 0; i < rig.clips.size(); ++i) {
    const std::string& own = rig.clips[i].name;
    const std::string name = own.empty() ? fmt::format("clip {}", i) : as_utf8(own);
    std::string unique = name;
    for (int n = 2; !names.insert(unique).second; ++n) unique = fmt::format("{} ({})", name, n);
    out.push_back(unique);
  }
  return out;
}

std::string picture_file(std::size_t number) {
  return number == 0 ? kPictureFile : fmt::format("_{}{}", number, kPictureFile);
}

std::vector<std::string> files_of(const ClipResult& result) {
  std::vector<std::string> out{kResultFile, kPageFile, kHeatFile, picture_file(0)};
  for (const Event& event : result.events) {
    if (event.picture > 0) out.push_back(picture_file(static_cast<std::size_t>(event.picture)));
  }
  return out;
}

std::vector<CheckedClip> check_library(const std::vector<LibraryCharacter>& library, const RunOptions& options,
                                       const Store& store, const std::function<void(const RunState&)>& progress) {
  std::vector<ChosenCharacter> characters = choose(library, options.shard);
  Run run(options, store, progress);
  run.bake_all(characters);
  return run.check_all(characters);
}

}  // namespace spherechain::baker
