// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/write/work_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "baker/mesh/error.h"
#include "baker/write/leftovers.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_to_create(const fs::path& path, const std::string& why) {
  throw Error(ExitCode::kFile, path.string() + ": cannot be created (" + why + ")");
}

// The folders that are missing, the innermost first.
std::vector<fs::path> missing(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  fs::path path = fs::absolute(folder, error).lexically_normal();
  for (; !path.empty() && !fs::exists(path, error); path = path.parent_path()) out.push_back(path);
  return out;
}

// The pipe ends with the last process that has its other end: with the tool and its workers.
[[noreturn]] void delete_at_end(int pipe, const fs::path& folder, const std::vector<fs::path>& made) {
  ::setsid();  // Ctrl-C is for others
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE}) ::signal(signal, SIG_IGN);
  const int nowhere = ::open("/dev/null", O_RDWR);  // who reads the tool's output does not wait for this
  for (int file = 0; file < 3; ++file) ::dup2(nowhere, file);
  char none = 0;
  while (::read(pipe, &none, 1) < 0 && errno == EINTR) continue;
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  for (const fs::path& one : made) ::rmdir(one.c_str());
  ::_exit(0);
}

}  // namespace

WorkFolder::WorkFolder(const fs::path& in) {
  const std::vector<fs::path> made = missing(in);
  do {
    path_ = in / own_name(kWorkEnding);
    start_deleter(made);  // first: nothing is there that nobody would delete
    std::error_code error;
    fs::create_directories(in, error);
    if (error) fail_to_create(in, error.message());
    sweep(in);
    if (::mkdir(path_.c_str(), 0700) != 0) fail_to_create(path_, std::strerror(errno));
    lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock_ >= 0 && lock_own(lock_, path_)) return;
    stop_deleter();  // another process swept it in between
  } while (true);
}

void WorkFolder::start_deleter(const std::vector<fs::path>& made) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail_to_create(path_, std::strerror(errno));
  deleter_ = ::fork();
  if (deleter_ == 0) {
    ::close(ends[1]);
    delete_at_end(ends[0], path_, made);
  }
  ::close(ends[0]);
  alive_ = ends[1];
  if (deleter_ < 0) fail_to_create(path_, std::strerror(errno));
}

void WorkFolder::stop_deleter() {
  ::close(alive_);
  if (lock_ >= 0) ::close(lock_);
  while (::waitpid(deleter_, nullptr, 0) < 0 && errno == EINTR) continue;
}

WorkFolder::~WorkFolder() { stop_deleter(); }

}  // namespace spherechain::baker
