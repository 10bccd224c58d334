// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/workers.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <system_error>
#include <vector>

#include "baker/mesh/error.h"
#include "baker/os/child_process.h"
#include "baker/os/write_all.h"

namespace spherechain::baker {
namespace {

// The first letter of each line that a child sends: what the work tells, or why it failed.
constexpr char kReported = 't', kError = 'e', kStopped = 'i', kException = 'x';

// Names of files may hold ends of lines.
void send(int pipe, char kind, std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (!write_all(pipe, kind + line + '\n')) std::_Exit(1);
}

void work_in_child(const Task& task, int pipe) {
  try {
    task.work([&](const std::string& line) { send(pipe, kReported, line); });
  } catch (const Interrupted& error) {
    send(pipe, kStopped, error.what());
  } catch (const Error& error) {
    send(pipe, kError, error.what());
  } catch (const std::exception& error) {
    send(pipe, kException, error.what());
  }
}

class Child {
 public:
  explicit Child(Task task)
      : task_(std::move(task)),
        process_(ChildProcess::Kind::kWorker, [this](int pipe) { work_in_child(task_, pipe); }) {}

  const ChildProcess& process() const { return process_; }

  // False at the end.
  bool read() {
    if (!process_.read(text_)) return false;
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      const char kind = text_[0];
      const std::string line = text_.substr(1, end - 1);
      text_.erase(0, end + 1);
      if (kind == kReported) {
        task_.on_line(line);
      } else {
        ending_ = {line, kind != kException, kind == kStopped};
      }
    }
    return true;
  }

  // Returns true where the child was killed from outside for the first time: then `task` is to be done again.
  bool end(Task& task) {
    const ProcessEnd how = process_.wait();
    const bool is_killed = how.is_killed_from_outside();
    if (is_killed && !task_.was_killed) {
      task = std::move(task_);
      task.was_killed = true;
      return true;
    }
    if (is_killed) {
      ending_ = {std::string("its process was killed twice (") + how.signal_name() +
                     "; is memory short? run it again, with fewer --jobs)",
                 false, true};
    } else if (how.is_by_signal()) {
      ending_ = {std::string("crashes the check (") + how.signal_name() + ")", false, false};
    } else if (how.exit_code() != 0 && ending_.failure.empty()) {
      ending_ = {"ends the check early", false, false};
    }
    task_.ended(ending_);
    return false;
  }

 private:
  Task task_;
  ChildProcess process_;
  std::string text_;
  Ending ending_;
};

}  // namespace

void run_in_children(std::deque<Task>& tasks, int jobs, const std::function<void()>& tick) {
  std::vector<std::unique_ptr<Child>> children;
  while (!tasks.empty() || !children.empty()) {
    while (!tasks.empty() && children.size() < static_cast<std::size_t>(jobs)) {
      Task next = std::move(tasks.front());
      tasks.pop_front();
      try {
        children.push_back(std::make_unique<Child>(std::move(next)));
      } catch (const std::system_error& error) {
        throw Interrupted(std::string("--jobs: no process can be started (") + error.what() + ")");
      }
    }
    constexpr int kTickMs = 250;
    std::vector<const ChildProcess*> processes;
    for (const auto& child : children) processes.push_back(&child->process());
    const std::vector<char> is_ready = ChildProcess::wait_for_any(processes, kTickMs);
    for (std::size_t i = is_ready.size(); i-- > 0;) {
      if (is_ready[i] == 0 || children[i]->read()) continue;
      const std::unique_ptr<Child> ended = std::move(children[i]);
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
      if (Task again; ended->end(again)) tasks.push_front(std::move(again));
    }
    tick();
  }
}

}  // namespace spherechain::baker
