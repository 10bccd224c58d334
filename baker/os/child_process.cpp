// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace spherechain::baker {
namespace {

using Clock = std::chrono::steady_clock;

void print_nowhere(int mode) {
  const int nowhere = ::open("/dev/null", mode | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (stream != STDIN_FILENO || mode == O_RDWR) ::dup2(nowhere, stream);
  }
  if (nowhere > STDERR_FILENO) ::close(nowhere);
}

// Called first in a process that `parent` has just forked.
void become_child(ChildProcess::Kind kind, pid_t parent) {
  if (kind == ChildProcess::Kind::kWatchman) {
    ::setsid();  // Ctrl-C is for others
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_IGN);
    print_nowhere(O_RDWR);  // the reader of the tool's output does not wait for this process
    return;
  }
  struct sigaction known {};
  const bool is_term_ignored = ::sigaction(SIGTERM, nullptr, &known) == 0 && known.sa_handler == SIG_IGN;
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) {
    if (::sigaction(signal, nullptr, &known) == 0 && known.sa_handler != SIG_IGN) ::signal(signal, SIG_DFL);
  }
  // By SIGTERM a worker takes its temporary file along.
  ::prctl(PR_SET_PDEATHSIG, kind == ChildProcess::Kind::kWorker && !is_term_ignored ? SIGTERM : SIGKILL);
  if (::getppid() != parent) ::_exit(1);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  print_nowhere(O_WRONLY);  // for the last words of libraries
#endif
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
void limit_memory(rlim_t bytes) {
  rlim_t pages = 0;
  rlimit address_space{};
  if (!(std::ifstream("/proc/self/statm") >> pages) || ::getrlimit(RLIMIT_AS, &address_space) != 0) return;
  const rlim_t all = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + bytes;
  address_space.rlim_cur = std::min(address_space.rlim_cur, all);
  ::setrlimit(RLIMIT_AS, &address_space);
}
#endif

}  // namespace

int ProcessEnd::exit_code() const { return WEXITSTATUS(status_); }
bool ProcessEnd::is_by_signal() const { return WIFSIGNALED(status_); }
const char* ProcessEnd::signal_name() const { return ::strsignal(WTERMSIG(status_)); }
bool ProcessEnd::is_by_time_limit() const { return is_by_signal() && WTERMSIG(status_) == SIGXCPU; }

bool ProcessEnd::is_killed_from_outside() const {
  if (!is_by_signal()) return false;
  switch (WTERMSIG(status_)) {
    case SIGHUP:
    case SIGINT:
    case SIGQUIT:
    case SIGKILL:
    case SIGTERM:
    case SIGUSR1:
    case SIGUSR2:
    case SIGXCPU:
      return true;
    default:
      return false;
  }
}

ChildProcess::ChildProcess(Kind kind, const std::function<void(int pipe)>& work) : kind_(kind) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "no pipe");
  const bool child_reads = kind == Kind::kWatchman;
  const int own = ends[child_reads ? 1 : 0], other = ends[child_reads ? 0 : 1];
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ == 0) {
    ::close(own);
    become_child(kind, parent);
    [&]() noexcept { work(other); }();  // an exception must not unwind into the copy of this process
    ::_exit(0);
  }
  const int failure = errno;
  ::close(other);
  if (pid_ < 0) {
    ::close(own);
    throw std::system_error(failure, std::generic_category(), "no process");
  }
  pipe_ = own;
}

ChildProcess::~ChildProcess() {
  ::close(pipe_);
  if (pid_ == 0) return;
  if (kind_ == Kind::kWatchman) {
    wait();
    return;
  }
  constexpr int kPatience = 200;  // milliseconds that a child has to delete its temporary file
  ::kill(pid_, SIGTERM);
  for (int i = 0; i < kPatience; ++i) {
    if (::waitpid(pid_, nullptr, WNOHANG) != 0) return;
    ::usleep(1000);
  }
  ::kill(pid_, SIGKILL);
}

bool ChildProcess::read(std::string& bytes) {
  char part[1 << 16];
  const ssize_t size = ::read(pipe_, part, sizeof part);
  if (size < 0 && errno == EINTR) return true;
  if (size <= 0) return false;
  bytes.append(part, static_cast<std::size_t>(size));
  return true;
}

bool ChildProcess::read_until(Clock::time_point end, std::string& bytes) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return false;
    if (wait_for_any({this}, static_cast<int>(left))[0] != 0 && !read(bytes)) return true;
  }
}

void ChildProcess::kill() { ::kill(pid_, SIGKILL); }

ProcessEnd ChildProcess::wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
  pid_ = 0;
  return ProcessEnd(status);
}

std::vector<char> ChildProcess::wait_for_any(const std::vector<const ChildProcess*>& children, int milliseconds) {
  std::vector<pollfd> waits;
  for (const ChildProcess* child : children) waits.push_back({child->pipe_, POLLIN, 0});
  const bool is_any = ::poll(waits.data(), waits.size(), milliseconds) > 0;
  std::vector<char> out;
  for (const pollfd& wait : waits) out.push_back(is_any && wait.revents != 0 ? 1 : 0);
  return out;
}

void limit_process(int seconds, int megabytes) {
  const rlimit no_core{0, 0}, time{static_cast<rlim_t>(seconds) + 1, static_cast<rlim_t>(seconds) + 2};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  limit_memory(static_cast<rlim_t>(megabytes) << 20);
#else
  static_cast<void>(megabytes);
#endif
}

double peak_memory_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace spherechain::baker
