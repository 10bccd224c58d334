// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/fix_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "baker/check/workers.h"
#include "baker/fix/fix_character.h"
#include "baker/mesh/error.h"
#include "baker/os/written_file.h"
#include "baker/write/own_file.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

bool can_be_mended(const EvaluatedEvent& evaluated) {
  const Event& event = evaluated.event;
  return evaluated.is_open() && evaluated.state != EventState::kAccepted && event.kind >= SC_CLASS_PENETRATION &&
         event.parts[0] != event.parts[1];
}

// Jobs for all characters of a library. A job without `numbers` and `recordings` does nothing.
std::vector<FixJob> jobs_of(const std::vector<LibraryCharacter>& library, const Verdict& verdict,
                            const Baseline& baseline) {
  std::vector<FixJob> out(library.size());
  for (std::size_t c = 0; c < library.size(); ++c) {
    out[c].input = library[c].file.string();
    out[c].config = library[c].config;
    out[c].baseline = baseline;
  }
  for (const EvaluatedClip& clip : verdict.clips) {
    if (std::none_of(clip.events.begin(), clip.events.end(), can_be_mended)) continue;
    FixJob& job = out[clip.clip.character];
    const std::size_t unit = clip.clip.order / kClipsPerUnitMax;
    if (unit == kOwnClips) {
      if (!job.numbers) job.numbers.emplace();
      job.numbers->push_back(clip.clip.order % kClipsPerUnitMax);
    } else {
      job.recordings.push_back(library[clip.clip.character].motions[unit - 1].file.string());
    }
  }
  return out;
}

// "dragon.fbx.glb": a GLB, whatever was read.
fs::path mended_file(const fs::path& folder, const LibraryCharacter& character) {
  fs::path out = folder / character.relative;
  const fs::path ending = out.extension();
  if (ending != ".glb" && ending != ".vrm") out += ".glb";
  return out;
}

void make_folder_of(const fs::path& file) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (failed) {
    throw Error(ExitCode::kFile,
                file.parent_path().string() + ": no such folder can be made (" + failed.message() + ")");
  }
}

}  // namespace

void check_fix_folder(const std::vector<LibraryCharacter>& library, const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored)) {
    throw Error(ExitCode::kFile, folder.string() + ": is no folder");
  }
  std::set<fs::path> inputs, outputs;
  for (const LibraryCharacter& character : library) {
    inputs.insert(fs::weakly_canonical(character.file));
    for (const LibraryCharacter::Motion& motion : character.motions) inputs.insert(fs::weakly_canonical(motion.file));
  }
  for (const LibraryCharacter& character : library) {
    const fs::path file = mended_file(folder, character), place = fs::weakly_canonical(fs::absolute(file));
    const auto fail = [&](ExitCode code, const char* what) { throw Error(code, "--fix: " + file.string() + what); };
    if (inputs.count(place) > 0) fail(ExitCode::kUsage, ": is a file of the library (name another folder)");
    if (!outputs.insert(place).second) {
      fail(ExitCode::kUsage, ": two characters would be written to it (check them one after another)");
    }
    if (!is_own_file(file, FileKind::kGlb, character.file)) {
      fail(ExitCode::kFile, ": exists and is not a GLB file that spherechain wrote (name another folder)");
    }
  }
}

std::vector<std::string> fix_library(const std::vector<LibraryCharacter>& library, const Verdict& verdict,
                                     const Baseline& baseline, const fs::path& folder, int jobs,
                                     const std::function<void(const RunState&)>& progress) {
  const std::vector<FixJob> all = jobs_of(library, verdict, baseline);
  std::vector<std::string> lines;
  lines.reserve(all.size());  // tasks hold on to them
  std::deque<Task> tasks;
  std::size_t done = 0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const FixJob& job = all[c];
    if (!job.numbers && job.recordings.empty()) continue;
    const fs::path file = mended_file(folder, library[c]);
    std::string& line = lines.emplace_back();
    tasks.push_back({[&job, file](const Task::Tell& tell) {
                       const FixedCharacter fixed = fix_character(job, [](const std::string&) {});
                       make_folder_of(file);
                       write_atomically(file, fixed.bytes);
                       tell(fmt::format("{}mended {}: {}", changes_any(fixed.clips) ? "" : "not ", file.string(),
                                        fix_line(fixed.clips)));
                     },
                     [&line](const std::string& message) { line = message; },
                     [&line, &job, &done](const Ending& ending) {
                       if (!ending.failure.empty()) {
                         const bool is_named = ending.failure.starts_with(job.input + ":");
                         line = "not mended " + (is_named ? ending.failure : job.input + ": " + ending.failure);
                       }
                       ++done;
                     }});
  }
  const std::size_t count = tasks.size();
  run_in_children(tasks, jobs, [&] { progress({"mending", done, count}); });
  return lines;
}

}  // namespace spherechain::baker
