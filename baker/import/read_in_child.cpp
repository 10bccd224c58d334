// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/read_in_child.h"

#include <fcntl.h>
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

#include "mesh/error.h"

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

// What the child sends: the bytes that were read, or an error's words and exit code, and then one of these.
enum class Outcome : char { kRead, kError, kInternal, kMemory };

std::string message(std::string bytes, Outcome outcome) {
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

// The child owns nothing: no output, no temporary file, no core file. It ends even where its parent is gone.
void become_child(int seconds, int megabytes) {
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) ::signal(signal, SIG_DFL);
  const rlimit no_core{0, 0}, time{static_cast<rlim_t>(seconds) + 1, static_cast<rlim_t>(seconds) + 2};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
  limit_memory(static_cast<rlim_t>(megabytes) << 20);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const int nowhere = ::open("/dev/null", O_WRONLY);  // for the last words of importers
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
#endif
}

std::string outcome_of(const std::function<std::string()>& read) {
  try {
    return message(read(), Outcome::kRead);
  } catch (const Error& error) {
    return message(std::string(error.what()) + static_cast<char>(error.code()), Outcome::kError);
  } catch (const std::bad_alloc&) {
    return message({}, Outcome::kMemory);
  } catch (const std::exception& error) {
    return message(error.what(), Outcome::kInternal);
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

}  // namespace

std::string read_in_child(const std::string& file, const std::function<std::string()>& read) {
  const int seconds = limit(kSecondsName, kImportSeconds), megabytes = limit(kMemoryName, kImportMemory);
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, file + ": " + what); };
  int pipe[2];
  if (::pipe(pipe) != 0) fail(std::string("cannot be read (no pipe: ") + std::strerror(errno) + ")");
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(pipe[0]);
    become_child(seconds, megabytes);
    send(pipe[1], outcome_of(read));
    ::_exit(0);
  }
  const int no_child = errno;
  ::close(pipe[1]);
  std::string bytes;
  const bool in_time = child > 0 && receive(pipe[0], Clock::now() + std::chrono::seconds(seconds), bytes);
  ::close(pipe[0]);
  if (child < 0) fail(std::string("cannot be read (no process: ") + std::strerror(no_child) + ")");
  if (!in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;

  if (!in_time) {
    fail("takes more than " + std::to_string(seconds) + " s to read" + std::string(kDamaged) + kSecondsName +
         " allows more)");
  }
  if (WIFSIGNALED(status) || bytes.empty()) {
    const char* how = WIFSIGNALED(status) ? ::strsignal(WTERMSIG(status)) : "it ends early";
    fail(std::string("crashes its importer (") + how + "; the file is damaged: export it again)");
  }
  const auto outcome = static_cast<Outcome>(bytes.back());
  bytes.pop_back();
  switch (outcome) {
    case Outcome::kRead:
      return bytes;
    case Outcome::kError:
      throw Error(static_cast<ExitCode>(bytes.back()), bytes.substr(0, bytes.size() - 1));
    case Outcome::kMemory:
      fail("needs more than " + std::to_string(megabytes) + " MB of memory to read" + std::string(kDamaged) +
           kMemoryName + " allows more)");
    case Outcome::kInternal:
      break;
  }
  throw std::runtime_error(bytes);
}

}  // namespace spherechain::baker
