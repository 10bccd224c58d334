// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <deque>
#include <functional>
#include <string>

namespace spherechain::baker {

// Work for a process of its own, so that nothing it meets can end this one.
struct Task {
  using Tell = std::function<void(const std::string& line)>;
  std::function<void(const Tell& tell)> work;             // in the child; what it throws ends it
  std::function<void(const std::string& line)> told;      // here: a line that the child told
  std::function<void(const std::string& failure)> ended;  // here: empty, or how the child failed; may add tasks
};

// Runs all tasks, `jobs` at a time. `tick` is called a few times a second. Children end where this process does.
void run_in_children(std::deque<Task>& tasks, int jobs, const std::function<void()>& tick);

}  // namespace spherechain::baker
