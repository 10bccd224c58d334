// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/work_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <vector>

#include "baker/mesh/error.h"
#include "baker/os/leftovers.h"

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
void delete_at_end(int pipe, const fs::path& folder, const std::vector<fs::path>& made) {
  char none = 0;
  while (::read(pipe, &none, 1) < 0 && errno == EINTR) continue;
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  for (const fs::path& one : made) ::rmdir(one.c_str());
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
  try {
    deleter_.emplace(ChildProcess::Kind::kWatchman, [&](int pipe) { delete_at_end(pipe, path_, made); });
  } catch (const std::system_error& error) {
    fail_to_create(path_, error.code().message());
  }
}

void WorkFolder::stop_deleter() {
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
  deleter_.reset();
}

WorkFolder::~WorkFolder() { stop_deleter(); }

}  // namespace spherechain::baker
