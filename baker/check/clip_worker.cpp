// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/clip_worker.h"

#include <fmt/format.h>

#include "baker/check/clip_check.h"
#include "baker/check/file_hash.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/os/child_process.h"
#include "baker/page/page.h"
#include "baker/play/steps.h"
#include "baker/play/target.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

class ClipWorker {
 public:
  ClipWorker(ClipQueue& queue, const RunOptions& options, const Store& store,
             const std::map<std::string, std::string>& motion_hashes, const Task::Tell& tell)
      : queue_(queue), options_(options), store_(store), motion_hashes_(motion_hashes), tell_(tell) {}

  void run(std::optional<std::size_t> at) {
    const ChosenCharacter& character = queue_.character;
    const FrameChoice frames{0, options_.fps};
    std::optional<AnimatedAsset> animated;
    std::optional<ClipChecker> checker;
    bool plays_own = true, has_page = store_.has(character.key, kPageFile);
    News news(tell_);
    const std::string asset = store_.take(character.key, kAssetFile);
    for (std::size_t i = at ? *at : queue_.take(); i < queue_.clips.size(); i = queue_.take()) {
      const QueuedClip& next = queue_.clips[i];
      if (!at) tell_(std::to_string(i));
      at.reset();
      ClipCheck found;
      std::string page;
      try {
        if (!checker) {
          news("reading");
          do_unchanged(character.of->file, character.hash, [&] {
            animated.emplace(OpenAsset(asset, character.of->name), character.of->name, character.of->file.string(),
                             MotionChoice{}, frames);
            animated->take_joints();  // the page blends the skin by their weights, whatever a recording plays later
            if (!has_page) page = character_page(*animated);
          });
          do_unchanged(character.of->file, character.hash,
                       [&] { checker.emplace(*animated, character.of->file, choose_target("auto")); });
        }
        take_notes();  // of the character, and of clips before this one
        if (next.unit != kOwnClips) {
          plays_own = false;
          const fs::path& motion = queue_.file_of(next);
          do_unchanged(motion, motion_hashes_.at(motion.string()), [&] {
            animated->play({{}, {}, motion.string()}, frames);
          });
        } else if (!plays_own) {
          animated->play({}, frames);
          plays_own = true;
        }
        if (options_.continuous) look_between_frames(*animated, choose_target("auto"), next.number, [](int) {});
        found = checker->check(next.number, [&](int done, int all) {
          news(fmt::format("{}, frame {} of {}", next.clip->clip, done, all));
        });
        found.result.continuous = options_.continuous;
        const fs::path recording = next.unit == kOwnClips ? fs::path() : queue_.file_of(next);
        for (const std::string& note : take_notes()) found.result.note = without_file(note, recording);
      } catch (const Interrupted& error) {
        tell_(kInterrupted + std::string(error.what()));
        continue;
      } catch (const Error& error) {
        tell_(kFailed + std::string(error.what()));
        continue;
      }
      if (!page.empty()) store_.write(character.key, kPageFile, "spherechain.character = " + page + ";\n");
      has_page = true;
      write(next.clip->key, found);
      tell_({kDone});
    }
  }

 private:
  // The result last: where it is, all is.
  void write(const std::string& key, const ClipCheck& found) const {
    store_.write(key, kPageFile, "spherechain.clip = " + found.page + ";\n");
    for (std::size_t i = 0; i < found.pictures.size(); ++i) store_.write(key, picture_file(i), found.pictures[i]);
    store_.write(key, kHeatFile,
                 {reinterpret_cast<const char*>(found.heat.data()), found.heat.size() * sizeof(HeatSpot)});
    store_.write(key, kResultFile, to_bytes(found.result));
  }

  ClipQueue& queue_;
  const RunOptions& options_;
  const Store& store_;
  const std::map<std::string, std::string>& motion_hashes_;
  const Task::Tell& tell_;
};

}  // namespace

void News::operator()(const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  tell_(kNow + text);
}

std::string without_file(const std::string& note, const fs::path& file) {
  const std::string begin = file.string() + ": ";
  return note.starts_with(begin) ? note.substr(begin.size()) : note;
}

void check_clips(ClipQueue& queue, std::optional<std::size_t> at, const RunOptions& options, const Store& store,
                 const std::map<std::string, std::string>& motion_hashes, const Task::Tell& tell) {
  ClipWorker(queue, options, store, motion_hashes, tell).run(at);
}

}  // namespace spherechain::baker
