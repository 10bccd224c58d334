// SPDX-License-Identifier: GPL-3.0-or-later
#include "write/temporary.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <cstdio>
#include <functional>
#include <string>

namespace spherechain::baker {
namespace {

// What the handler deletes: it may call no more than unlink, and read no more than this.
std::array<char, PATH_MAX> doomed;
std::atomic<bool> is_doomed = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void delete_and_end(int signal) {
  if (is_doomed) ::unlink(doomed.data());
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

// What a program ignores (nohup) or handles stays as it is.
void handle_signals() {
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) {
    struct sigaction known {};
    if (::sigaction(signal, nullptr, &known) != 0 || known.sa_handler != SIG_DFL) continue;
    struct sigaction own {};
    own.sa_handler = delete_and_end;
    ::sigaction(signal, &own, nullptr);
  }
}

std::mutex& one_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

// No longer where the target's is as long as names may be; another than that of another target, for processes in two
// containers may share a folder and be one number.
std::string name_beside(const std::filesystem::path& target) {
  const std::size_t hash = std::hash<std::string>()(target.filename().string());
  return ".spherechain-" + std::to_string(hash) + "-" + std::to_string(::getpid()) + ".tmp";
}

}  // namespace

Temporary::Temporary(const std::filesystem::path& target)
    : only_one_(one_at_a_time()), target_(target), path_(target.parent_path() / name_beside(target)) {
  handle_signals();
  const std::string& name = path_.native();
  if (name.size() >= doomed.size()) return;  // no file can be opened by such a name
  doomed.fill('\0');
  name.copy(doomed.data(), name.size());
  is_doomed = true;
}

Temporary::~Temporary() {
  if (!path_.empty()) ::unlink(path_.c_str());
  is_doomed = false;
}

bool Temporary::rename_to_target() {
  if (std::rename(path_.c_str(), target_.c_str()) != 0) return false;
  path_.clear();
  return true;
}

}  // namespace spherechain::baker
