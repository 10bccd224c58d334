// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/workers.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include "baker/import/child_process.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

// The first letter of each line that a child sends: what the work tells, or why it failed.
constexpr char kTold = 't', kError = 'e', kStopped = 'i', kException = 'x';

// Names of files may hold ends of lines.
void send(int pipe, char kind, std::string line) {
  std::replace(line.begin(), line.end(), '\n', ' ');
  line = kind + line + '\n';
  std::string_view left = line;
  while (!left.empty()) {
    const ssize_t sent = ::write(pipe, left.data(), left.size());
    if (sent < 0 && errno != EINTR) ::_exit(1);
    left.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  }
}

[[noreturn]] void be_child(const Task& task, pid_t parent, int pipe) {
  // By SIGTERM it takes its temporary file along.
  struct sigaction known {};
  const bool is_ignored = ::sigaction(SIGTERM, nullptr, &known) == 0 && known.sa_handler == SIG_IGN;
  become_child(parent, is_ignored ? SIGKILL : SIGTERM);
  try {
    task.work([&](const std::string& line) { send(pipe, kTold, line); });
  } catch (const Interrupted& error) {
    send(pipe, kStopped, error.what());
  } catch (const Error& error) {
    send(pipe, kError, error.what());
  } catch (const std::exception& error) {
    send(pipe, kException, error.what());
  }
  ::_exit(0);
}

class Child {
 public:
  explicit Child(Task task) : task_(std::move(task)) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail();
    const pid_t parent = ::getpid();
    pid_ = ::fork();
    if (pid_ == 0) {
      ::close(ends[0]);
      be_child(task_, parent, ends[1]);
    }
    const int no_child = errno;
    ::close(ends[1]);
    pipe_ = ends[0];
    errno = no_child;
    if (pid_ < 0) fail();
  }
  ~Child() {
    ::close(pipe_);
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    for (int i = 0; i < kPatience; ++i) {
      if (::waitpid(pid_, nullptr, WNOHANG) != 0) return;
      ::usleep(1000);
    }
    ::kill(pid_, SIGKILL);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int pipe() const { return pipe_; }

  // False at the end.
  bool read() {
    char part[1 << 14];
    const ssize_t size = ::read(pipe_, part, sizeof part);
    if (size < 0 && errno == EINTR) return true;
    if (size <= 0) return false;
    text_.append(part, static_cast<std::size_t>(size));
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      const char kind = text_[0];
      const std::string line = text_.substr(1, end - 1);
      text_.erase(0, end + 1);
      if (kind == kTold) {
        task_.on_line(line);
      } else {
        ending_ = {line, kind != kException, kind == kStopped};
      }
    }
    return true;
  }

  // Returns true where the child was killed from outside for the first time: then `task` is to be done again.
  bool end(Task& task) {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
    pid_ = 0;
    const bool is_killed = is_killed_from_outside(status);
    if (is_killed && !task_.was_killed) {
      task = std::move(task_);
      task.was_killed = true;
      return true;
    }
    if (is_killed) {
      ending_ = {std::string("its process was killed twice (") + ::strsignal(WTERMSIG(status)) +
                     "; is memory short? run it again, with fewer --jobs)",
                 false, true};
    } else if (WIFSIGNALED(status)) {
      ending_ = {std::string("crashes the check (") + ::strsignal(WTERMSIG(status)) + ")", false, false};
    } else if (WEXITSTATUS(status) != 0 && ending_.failure.empty()) {
      ending_ = {"ends the check early", false, false};
    }
    task_.ended(ending_);
    return false;
  }

 private:
  static constexpr int kPatience = 200;  // milliseconds that a child has to delete its temporary file

  [[noreturn]] static void fail() {
    throw Interrupted(std::string("--jobs: no process can be started (") + std::strerror(errno) + ")");
  }

  Task task_;
  pid_t pid_ = -1;
  int pipe_ = -1;
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
      children.push_back(std::make_unique<Child>(std::move(next)));
    }
    std::vector<pollfd> waits;
    for (const auto& child : children) waits.push_back({child->pipe(), POLLIN, 0});
    constexpr int kTickMs = 250;
    ::poll(waits.data(), waits.size(), kTickMs);
    for (std::size_t i = waits.size(); i-- > 0;) {
      if (waits[i].revents == 0 || children[i]->read()) continue;
      const std::unique_ptr<Child> ended = std::move(children[i]);
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
      if (Task again; ended->end(again)) tasks.push_front(std::move(again));
    }
    tick();
  }
}

}  // namespace spherechain::baker
