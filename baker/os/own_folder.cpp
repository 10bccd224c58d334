// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/own_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "baker/mesh/error.h"
#include "baker/os/access.h"
#include "baker/os/leftovers.h"
#include "baker/os/sha256.h"
#include "baker/os/temporary.h"
#include "baker/os/write_all.h"
#include "baker/os/written_file.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr const char* kList = ".spherechain";
constexpr std::size_t kHashSize = 64;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ExitCode::kFile, path.string() + ": " + what);
}

[[noreturn]] void fail_to(const char* doing, const fs::path& path, const std::error_code& error) {
  fail(path, std::string("cannot be ") + doing + " (" + error.message() + ")");
}

std::error_code last_error() { return {errno, std::generic_category()}; }

std::string first_line(const std::string& kind) { return "spherechain " + kind; }

// A name in a list that somebody planted leads nowhere else.
bool is_below(const std::string& name) {
  const fs::path path = name;
  if (name.empty() || path.is_absolute() || path.lexically_normal() != path || !path.has_filename()) return false;
  return *path.begin() != ".." && *path.begin() != ".";
}

// Empty where there is no such file.
std::string hash_of(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) ? sha256_of_file(file) : std::string();
}

bool is_empty_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && fs::file_size(file, ignored) == 0;
}

[[noreturn]] void fail_as_foreign(const fs::path& file, const std::string& kind) {
  fail(file, "exists and is not what spherechain wrote into this " + kind + " (move it, or name another folder)");
}

// The folder, or the first above it that is there, must take new files.
void check_folder(const fs::path& folder) {
  std::error_code error;
  fs::path there = fs::absolute(folder, error).lexically_normal();
  while (!fs::exists(there, error) && there.has_relative_path()) {
    if (fs::is_symlink(fs::symlink_status(there, error))) fail(folder, "cannot be created (it is a link to nothing)");
    there = there.has_filename() ? there.parent_path() : there.parent_path().parent_path();
  }
  if (!fs::is_directory(there, error)) {
    fail(folder,
         fs::exists(folder, error) ? "is no folder" : "cannot be created (" + there.string() + " is no folder)");
  }
  if (check_takes_files(there)) {
    fail(folder, "cannot be written (the folder " + there.string() + " is not writable)");
  }
}

}  // namespace

OwnFolder::Hashes OwnFolder::read_list(const fs::path& folder, const std::string& kind) {
  Hashes out;
  std::error_code ignored;
  const fs::path file = folder / kList;
  if (!fs::is_regular_file(fs::symlink_status(file, ignored))) return out;
  std::ifstream in(file, std::ios::binary);
  std::string line;
  if (!std::getline(in, line) || line != first_line(kind)) return out;
  out.emplace(kList, "");
  while (std::getline(in, line)) {  // as sha256sum has it
    if (line.size() <= kHashSize + 2) continue;
    const std::string name = line.substr(kHashSize + 2);
    if (is_below(name)) out.emplace(name, line.substr(0, kHashSize));
  }
  return out;
}

bool OwnFolder::is_listed(const Hashes& list, const std::string& name, const std::string& hash) {
  const auto [first, last] = list.equal_range(name);
  for (auto one = first; one != last; ++one) {
    if (one->second == hash) return true;
  }
  return false;
}

void OwnFolder::check(const fs::path& folder, const std::string& kind, bool (*is_name)(const std::string& name)) {
  check_folder(folder);
  const Hashes list = read_list(folder, kind);
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (is_own_name(name)) continue;
    if (list.empty()) {
      fail(folder, "holds other files than a " + kind + " of spherechain (name a new or empty folder)");
    }
    if (!is_name(name) || is_empty_file(entry.path())) continue;
    if (!is_listed(list, name, hash_of(entry.path()))) fail_as_foreign(entry.path(), kind);
  }
  if (error) fail_to("read", folder, error);
}

OwnFolder::OwnFolder(fs::path folder, std::string kind) : folder_(std::move(folder)), kind_(std::move(kind)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) fail_to("created", folder_, error);
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  while (lock_ >= 0 && ::flock(lock_, LOCK_EX) != 0 && errno == EINTR) continue;
  const fs::path list = folder_ / kList;
  old_ = read_list(folder_, kind_);
  if (old_.empty()) write_atomically(list, first_line(kind_) + "\n");
  list_ = ::open(list.c_str(), O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC);
  if (list_ < 0) fail_to("written", list, last_error());
}

OwnFolder::~OwnFolder() {
  if (list_ >= 0) ::close(list_);
  if (lock_ >= 0) ::close(lock_);
}

void OwnFolder::add_to_list(const std::string& name, const std::string& hash) {
  if (!is_listed(old_, name, hash) && !write_all(list_, hash + "  " + name + "\n")) {
    fail_to("written", folder_ / kList, last_error());
  }
  new_[name] = hash;
}

bool OwnFolder::is_there(const std::string& name, const std::string& hash) const {
  const fs::path file = folder_ / name;
  std::error_code ignored;
  if (!fs::exists(file, ignored) || is_empty_file(file)) return false;
  const std::string there = hash_of(file);
  if (there == hash) return true;
  // Below the top names are hashes, which nobody else gives: such a file is damaged, and written again.
  const bool is_own = fs::path(name).has_parent_path() ? old_.count(name) > 0 : is_listed(old_, name, there);
  if (there.empty() || !is_own) fail_as_foreign(file, kind_);
  return false;
}

void OwnFolder::write(const std::string& name, std::string_view bytes) {
  const std::string hash = sha256_of_text(bytes);
  const bool is_known = is_there(name, hash);
  add_to_list(name, hash);
  if (is_known) return;
  std::error_code error;
  const fs::path file = folder_ / name;
  if (fs::create_directories(file.parent_path(), error); error) fail_to("created", file.parent_path(), error);
  write_atomically(file, bytes);
}

void OwnFolder::finish() {
  std::error_code ignored;
  for (const auto& [name, hash] : old_) {
    if (new_.count(name) > 0 || name == kList) continue;
    const fs::path file = folder_ / name;
    if (!fs::is_regular_file(fs::symlink_status(file, ignored)) || hash_of(file) != hash) continue;
    fs::remove(file, ignored);
    for (fs::path parent = file.parent_path(); parent != folder_; parent = parent.parent_path()) {
      if (!fs::remove(parent, ignored)) break;  // not empty
    }
  }
  std::string list = first_line(kind_) + "\n";
  for (const auto& [name, hash] : new_) list += hash + "  " + name + "\n";
  write_atomically(folder_ / kList, list);
}

}  // namespace spherechain::baker
