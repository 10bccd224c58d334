// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/read_in_child.h"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <string_view>

#include "baker/import/child_process.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char *kSecondsName = "SPHERECHAIN_IMPORT_SECONDS", *kMemoryName = "SPHERECHAIN_IMPORT_MEMORY";
constexpr std::string_view kDamaged = " (the file is damaged, or its counts are wrong; ";

int limit(const char* name, int otherwise) {
  constexpr int kMax = 1000000;
  const char* text = std::getenv(name);
  if (text == nullptr || *text == '\0') return otherwise;
  int value = 0;
  const char* end = text + std::strlen(text);
  const auto [last, failed] = std::from_chars(text, end, value);
  if (failed != std::errc() || last != end || value < 1 || value > kMax) {
    throw Error(ExitCode::kUsage, std::string(name) + ": '" + text + "' is no whole number from 1 to 1000000");
  }
  return value;
}

// Status byte of the child. It follows the bytes read, or an error's words and exit code.
enum class ChildStatus : char { kRead, kError, kInternal, kMemory };

std::string message(std::string bytes, ChildStatus outcome) {
  bytes.push_back(static_cast<char>(outcome));
  return bytes;
}

void limit_memory(rlim_t bytes) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  rlim_t pages = 0;
  rlimit address_space{};
  if (!(std::ifstream("/proc/self/statm") >> pages) || ::getrlimit(RLIMIT_AS, &address_space) != 0) return;
  const rlim_t all = pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + bytes;
  address_space.rlim_cur = std::min(address_space.rlim_cur, all);
  ::setrlimit(RLIMIT_AS, &address_space);
#else
  static_cast<void>(bytes);
#endif
}

// The child owns nothing: no output, no temporary file, no core file.
void set_limits(int seconds, int megabytes) {
  const rlimit no_core{0, 0}, time{static_cast<rlim_t>(seconds) + 1, static_cast<rlim_t>(seconds) + 2};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
  limit_memory(static_cast<rlim_t>(megabytes) << 20);
}

std::string outcome_of(const std::function<std::string()>& read) {
  try {
    return message(read(), ChildStatus::kRead);
  } catch (const Error& error) {
    return message(std::string(error.what()) + static_cast<char>(error.code()), ChildStatus::kError);
  } catch (const std::bad_alloc&) {
    return message({}, ChildStatus::kMemory);
  } catch (const std::exception& error) {
    return message(error.what(), ChildStatus::kInternal);
  }
}

void send(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::write(pipe, bytes.data(), bytes.size());
    if (sent < 0 && errno != EINTR) return;
    bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(sent, 0)));
  }
}

// Returns false where the child takes too long.
bool receive(int pipe, Clock::time_point end, std::string& bytes) {
  std::string part(std::size_t{1} << 16, '\0');
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return false;
    pollfd wait{pipe, POLLIN, 0};
    if (::poll(&wait, 1, static_cast<int>(left)) <= 0) continue;
    const ssize_t size = ::read(pipe, part.data(), part.size());
    if (size == 0) return true;
    if (size > 0) bytes.append(part, 0, static_cast<std::size_t>(size));
  }
}

// Result of a child process: its output, its wait status (as waitpid returns it), and if it ended in time.
struct Ended {
  std::string bytes;
  bool is_in_time;
  int status;
};

Ended run_child(const std::string& file, const std::function<std::string()>& read, int seconds, int megabytes) {
  const auto fail = [&](const char* what) {
    throw Interrupted(file + ": cannot be read (" + what + ": " + std::strerror(errno) + ")");
  };
  int pipe[2];
  if (::pipe(pipe) != 0) fail("no pipe");
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) {
    ::close(pipe[0]);
    become_child(parent, SIGKILL);
    set_limits(seconds, megabytes);
    send(pipe[1], outcome_of(read));
    ::_exit(0);
  }
  const int no_child = errno;
  ::close(pipe[1]);
  Ended out{{}, false, 0};
  out.is_in_time = child > 0 && receive(pipe[0], Clock::now() + std::chrono::seconds(seconds), out.bytes);
  ::close(pipe[0]);
  errno = no_child;
  if (child < 0) fail("no process");
  if (!out.is_in_time) ::kill(child, SIGKILL);
  while (::waitpid(child, &out.status, 0) < 0 && errno == EINTR) continue;
  if (WIFSIGNALED(out.status) && WTERMSIG(out.status) == SIGXCPU) out.is_in_time = false;
  return out;
}

}  // namespace

std::string read_in_child(const std::string& file, const std::function<std::string()>& read) {
  const int seconds = limit(kSecondsName, kImportSeconds), megabytes = limit(kMemoryName, kImportMemory);
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, file + ": " + what); };
  const auto is_killed = [](const Ended& child) { return child.is_in_time && is_killed_from_outside(child.status); };
  Ended child = run_child(file, read, seconds, megabytes);
  if (is_killed(child)) child = run_child(file, read, seconds, megabytes);
  if (!child.is_in_time) {
    fail("takes more than " + std::to_string(seconds) + " s to read" + std::string(kDamaged) + kSecondsName +
         " allows more)");
  }
  if (is_killed(child)) {
    throw Interrupted(file + ": its importer was killed twice (" + ::strsignal(WTERMSIG(child.status)) +
                      "; is memory short? run it again)");
  }
  std::string bytes = std::move(child.bytes);
  if (WIFSIGNALED(child.status) || bytes.empty()) {
    const char* how = WIFSIGNALED(child.status) ? ::strsignal(WTERMSIG(child.status)) : "it ends early";
    fail(std::string("crashes its importer (") + how + "; the file is damaged: export it again)");
  }
  const auto outcome = static_cast<ChildStatus>(bytes.back());
  bytes.pop_back();
  switch (outcome) {
    case ChildStatus::kRead:
      return bytes;
    case ChildStatus::kError:
      throw Error(static_cast<ExitCode>(bytes.back()), bytes.substr(0, bytes.size() - 1));
    case ChildStatus::kMemory:
      fail("needs more than " + std::to_string(megabytes) + " MB of memory to read" + std::string(kDamaged) +
           kMemoryName + " allows more)");
    case ChildStatus::kInternal:
      break;
  }
  throw std::runtime_error(bytes);
}

}  // namespace spherechain::baker
