// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <functional>
#include <string>

namespace spherechain::baker {

// How a child ended.
struct Ending {
  std::string failure;           // empty: it did its work
  bool is_error = false;         // the work threw an Error
  bool was_interrupted = false;  // the work threw Interrupted, or the child was killed from outside twice
};

// Work that runs in a child process, so that a crash does not end this process.
struct Task {
  using Tell = std::function<void(const std::string& line)>;
  std::function<void(const Tell& tell)> work;            // in the child; what it throws ends it
  std::function<void(const std::string& line)> on_line;  // here: a line that the child wrote; ends of lines are spaces
  std::function<void(const Ending& ending)> ended;       // here; may add tasks
  bool was_killed = false;
};

// Runs all tasks, `jobs` at a time. A child that is killed from outside is started once more. `tick` is called a few
// times a second. Children end where this process does, or where this throws what `on_line` or `ended` threw.
void run_in_children(std::deque<Task>& tasks, int jobs, const std::function<void()>& tick);

}  // namespace spherechain::baker
