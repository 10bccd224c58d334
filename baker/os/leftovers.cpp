// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/leftovers.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <vector>

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStart = ".spherechain-", kLetters = "abcdefghijklmnopqrstuvwxyz234567";
constexpr std::size_t kLetterCount = 16;
constexpr std::time_t kDay = 24 * 60 * 60;

bool is_same_file(int file, const fs::path& path) {
  struct ::stat opened {
  }, there{};
  return ::fstat(file, &opened) == 0 && ::lstat(path.c_str(), &there) == 0 && opened.st_dev == there.st_dev &&
         opened.st_ino == there.st_ino;
}

// NFS, SMB, FUSE, 9p, Ceph, AFS: their numbers are those of linux/magic.h.
bool is_on_network(int file) {
  struct ::statfs system {};
  if (::fstatfs(file, &system) != 0) return true;
  constexpr std::array<unsigned long, 8> kNetworks{0x6969,     0x517B,     0xFF534D42, 0xFE534D42,
                                                   0x65735546, 0x01021997, 0x00C36400, 0x5346414F};
  const auto type = static_cast<unsigned long>(system.f_type) & 0xFFFFFFFFUL;
  return std::find(kNetworks.begin(), kNetworks.end(), type) != kNetworks.end();
}

bool is_left(int file, const fs::path& path) {
  struct ::stat opened {};
  if (::fstat(file, &opened) != 0 || opened.st_uid != ::geteuid()) return false;
  const bool is_known = path.extension() == kWorkEnding ? S_ISDIR(opened.st_mode) : S_ISREG(opened.st_mode);
  if (!is_known || (is_on_network(file) && std::time(nullptr) - opened.st_mtime < kDay)) return false;
  return ::flock(file, LOCK_EX | LOCK_NB) == 0 && is_same_file(file, path);
}

}  // namespace

std::string own_name(const char* ending) {
  std::array<unsigned char, kLetterCount> bytes{};
  while (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) continue;
  std::string name(kStart);
  for (const unsigned char byte : bytes) name += kLetters[byte % kLetters.size()];
  return name + ending;
}

bool is_own_name(const std::string& name) {
  const std::size_t end = kStart.size() + kLetterCount;
  if (!name.starts_with(kStart) || name.size() <= end) return false;
  const std::string ending = name.substr(end);
  return name.substr(kStart.size(), kLetterCount).find_first_not_of(kLetters) == std::string::npos &&
         (ending == kTemporaryEnding || ending == kWorkEnding);
}

bool lock_own(int file, const fs::path& path) {
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK;
  return is_same_file(file, path);
}

void sweep(const fs::path& folder) {
  std::error_code ignored;
  std::vector<fs::path> own;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    if (is_own_name(entry.path().filename().string())) own.push_back(entry.path());
  }
  for (const fs::path& path : own) {
    // Neither a link nor a pipe that somebody put there: the first is not followed, the second not waited for.
    const int file = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file < 0) continue;
    if (is_left(file, path)) fs::remove_all(path, ignored);
    ::close(file);
  }
}

}  // namespace spherechain::baker
