// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "baker/check/library.h"
#include "baker/check/run.h"
#include "baker/os/shared_counter.h"

namespace spherechain::baker {

// A character of a library in a run.
struct ChosenCharacter {
  const LibraryCharacter* of;
  std::size_t place;
  std::vector<std::size_t> units;  // that are asked for
  std::string hash, key, error;
  bool was_interrupted = false;
};

// A clip that waits to be checked.
struct QueuedClip {
  CheckedClip* clip;
  std::size_t unit, number;  // number among the file's own
};

// The clips of one character that are to be checked. Its processes take one after another: a quick one takes more.
class ClipQueue {
 public:
  ClipQueue(const ChosenCharacter& of, std::vector<QueuedClip> queued) : character(of), clips(std::move(queued)) {}

  bool is_empty() const { return next_.value() >= clips.size(); }
  // The index of the next clip. At least the number of clips if all are taken.
  std::size_t take() { return next_.take(); }

  // The file that a clip is read from.
  const std::filesystem::path& file_of(const QueuedClip& queued) const {
    return queued.unit == kOwnClips ? character.of->file : character.of->motions[queued.unit - 1].file;
  }

  const ChosenCharacter& character;
  const std::vector<QueuedClip> clips;

 private:
  SharedCounter next_;
};

}  // namespace spherechain::baker
