// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/workers.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr char kFailed = '\x01';  // begins a child's last line, which says why

void send(int pipe, std::string line) {
  line += '\n';
  std::string_view left = line;
  while (!left.empty()) {
    const ssize_t sent = ::write(pipe, left.data(), left.size());
    if (sent < 0 && errno != EINTR) ::_exit(1);
    left.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  }
}

[[noreturn]] void be_child(const Task& task, int pipe) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) ::signal(signal, SIG_DFL);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const int nowhere = ::open("/dev/null", O_WRONLY);  // for the last words of libraries
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
#endif
  try {
    task.work([&](const std::string& line) { send(pipe, line); });
  } catch (const std::exception& error) {
    send(pipe, kFailed + std::string(error.what()));
  }
  ::_exit(0);
}

class Child {
 public:
  explicit Child(Task task) : task_(std::move(task)) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail();
    pid_ = ::fork();
    if (pid_ == 0) {
      ::close(ends[0]);
      be_child(task_, ends[1]);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
    if (pid_ < 0) fail();
  }

  int pipe() const { return pipe_; }

  // False at the end.
  bool read() {
    char part[1 << 14];
    const ssize_t size = ::read(pipe_, part, sizeof part);
    if (size < 0 && errno == EINTR) return true;
    if (size <= 0) return false;
    text_.append(part, static_cast<std::size_t>(size));
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      const std::string line = text_.substr(0, end);
      text_.erase(0, end + 1);
      if (!line.empty() && line[0] == kFailed) {
        failure_ = line.substr(1);
      } else {
        task_.told(line);
      }
    }
    return true;
  }

  void end() {
    ::close(pipe_);
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
    if (WIFSIGNALED(status)) failure_ = std::string("crashes the check (") + ::strsignal(WTERMSIG(status)) + ")";
    if (WIFEXITED(status) && WEXITSTATUS(status) != 0 && failure_.empty()) failure_ = "ends the check early";
    task_.ended(failure_);
  }

 private:
  [[noreturn]] static void fail() {
    throw Error(ExitCode::kFile, std::string("--jobs: no process can be started (") + std::strerror(errno) + ")");
  }

  Task task_;
  pid_t pid_ = -1;
  int pipe_ = -1;
  std::string text_, failure_;
};

}  // namespace

void run_in_children(std::deque<Task>& tasks, int jobs, const std::function<void()>& tick) {
  std::vector<Child> children;
  while (!tasks.empty() || !children.empty()) {
    while (!tasks.empty() && children.size() < static_cast<std::size_t>(jobs)) {
      Task next = std::move(tasks.front());
      tasks.pop_front();
      children.emplace_back(std::move(next));
    }
    std::vector<pollfd> waits;
    for (const Child& child : children) waits.push_back({child.pipe(), POLLIN, 0});
    constexpr int kTickMs = 250;
    ::poll(waits.data(), waits.size(), kTickMs);
    for (std::size_t i = waits.size(); i-- > 0;) {
      if (waits[i].revents == 0 || children[i].read()) continue;
      Child ended = std::move(children[i]);
      children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
      ended.end();
    }
    tick();
  }
}

}  // namespace spherechain::baker
