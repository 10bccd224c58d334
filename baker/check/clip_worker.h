// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "baker/check/clip_queue.h"
#include "baker/check/run.h"
#include "baker/check/store.h"
#include "baker/check/workers.h"

namespace spherechain::baker {

// The first letter of a line that a child tells.
constexpr char kDone = '+', kFailed = '-', kInterrupted = '!', kNow = '~';

// Tells how far a child is, a few times a second.
class News {
 public:
  explicit News(const Task::Tell& tell) : tell_(tell) {}
  void operator()(const std::string& text);

 private:
  const Task::Tell& tell_;
  std::chrono::steady_clock::time_point last_;
};

// A note without the name of its file: the verdict has names of its own.
std::string without_file(const std::string& note, const std::filesystem::path& file);

// Checks clips of the queue in a process of its own, and writes what it finds to the store. Tells two lines for each:
// its index before, and after it kDone, or what is wrong. `at`: the clip that this process was at when it was killed.
// `motion_hashes`: of the recordings, by path.
void check_clips(ClipQueue& queue, std::optional<std::size_t> at, const RunOptions& options, const Store& store,
                 const std::map<std::string, std::string>& motion_hashes, const Task::Tell& tell);

}  // namespace spherechain::baker
