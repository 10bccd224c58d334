// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/temporary.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <set>
#include <string>

#include "baker/os/leftovers.h"
#include "baker/os/write_all.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr int kDeadly[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM};

// The file that the signal handler deletes. The handler may only call unlink and read these two.
std::array<char, PATH_MAX> doomed;
std::atomic<bool> is_doomed = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void delete_and_end(int signal) {
  if (is_doomed) ::unlink(doomed.data());
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

// Signals that the program ignores (nohup) or handles keep their handlers.
void handle_signals() {
  for (const int signal : kDeadly) {
    struct sigaction known {};
    if (::sigaction(signal, nullptr, &known) != 0 || known.sa_handler != SIG_DFL) continue;
    struct sigaction own {};
    own.sa_handler = delete_and_end;
    ::sigaction(signal, &own, nullptr);
  }
}

// They wait until it goes.
class HeldSignals {
 public:
  HeldSignals() {
    sigset_t deadly;
    ::sigemptyset(&deadly);
    for (const int signal : kDeadly) ::sigaddset(&deadly, signal);
    ::pthread_sigmask(SIG_BLOCK, &deadly, &before_);
  }
  ~HeldSignals() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;

 private:
  sigset_t before_{};
};

std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

// Once for each folder that this process writes to.
void sweep_once(const fs::path& folder) {
  static std::set<fs::path> swept;
  if (swept.insert(folder).second) sweep(folder);
}

// Where the group cannot be kept, another one gets no more than everybody.
void take_mode_and_owner(int file, const struct ::stat& from) {
  ::mode_t mode = from.st_mode & 0777;
  if (::fchown(file, from.st_uid, from.st_gid) != 0 && ::fchown(file, static_cast<uid_t>(-1), from.st_gid) != 0) {
    mode &= 0707 | ((mode & 07) << 3);
  }
  ::fchmod(file, mode);
}

}  // namespace

Temporary::Temporary(const fs::path& target) : only_one_(one_at_a_time()), target_(target) {
  handle_signals();
  sweep_once(target.parent_path());
  open();
}

void Temporary::open() {
  struct ::stat replaced {};
  const bool replaces = ::stat(target_.c_str(), &replaced) == 0 && S_ISREG(replaced.st_mode);
  const HeldSignals held;
  for (int attempt = 0; attempt < 100 && file_ < 0; ++attempt) {
    const fs::path path = target_.parent_path() / own_name(kTemporaryEnding);
    const std::string& name = path.native();
    if (name.size() >= doomed.size()) {
      errno = ENAMETOOLONG;
      return;
    }
    file_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, replaces ? 0600 : 0666);
    if (file_ < 0 && errno != EEXIST) return;
    if (file_ < 0) continue;
    if (!lock_own(file_, path)) {  // another process swept it in between
      ::close(file_);
      file_ = -1;
      continue;
    }
    path_ = path;
    doomed.fill('\0');
    name.copy(doomed.data(), name.size());
    is_doomed = true;
  }
  if (file_ >= 0 && replaces) take_mode_and_owner(file_, replaced);
}

Temporary::~Temporary() {
  if (!path_.empty()) ::unlink(path_.c_str());
  is_doomed = false;
  if (file_ >= 0) ::close(file_);
}

bool Temporary::write(std::string_view bytes) { return write_all(file_, bytes); }

bool Temporary::flush_to_disk() { return ::fsync(file_) == 0; }

bool Temporary::rename_to_target() {
  if (std::rename(path_.c_str(), target_.c_str()) != 0) return false;
  path_.clear();
  is_doomed = false;
  const int file = file_;
  file_ = -1;
  return ::close(file) == 0;
}

}  // namespace spherechain::baker
