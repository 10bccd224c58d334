// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "baker/mesh/error.h"
#include "baker/os/write_all.h"
#include "baker/os/written_file.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Standard output goes on where it is: a file that is opened once more would begin anew.
int open_directly(const fs::path& path) {
  struct ::stat there {
  }, standard{};
  const bool is_standard = ::stat(path.c_str(), &there) == 0 && ::fstat(STDOUT_FILENO, &standard) == 0 &&
                           there.st_dev == standard.st_dev && there.st_ino == standard.st_ino;
  if (is_standard) return ::dup(STDOUT_FILENO);
  return ::open(path.c_str(), S_ISREG(there.st_mode) ? O_WRONLY | O_TRUNC : O_WRONLY);
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path) : path_(path) {
  if (is_written_directly(path)) {
    direct_ = open_directly(path);
    if (direct_ < 0) fail("created");
  } else {
    temporary_.emplace(written_file(path));
    if (!temporary_->is_open()) fail("created");
  }
}

AtomicFile::~AtomicFile() {
  if (direct_ >= 0) ::close(direct_);
}

void AtomicFile::write(std::string_view bytes) {
  if (!(temporary_ ? temporary_->write(bytes) : write_all(direct_, bytes))) fail("written");
}

void AtomicFile::finish() {
  if (temporary_) {
    if (!temporary_->flush_to_disk()) fail("written");
    if (!temporary_->rename_to_target()) fail("replaced");
    temporary_.reset();
  } else {
    const int file = direct_;
    direct_ = -1;
    if (::close(file) != 0) fail("written");
  }
}

void AtomicFile::fail(const char* doing) const {
  throw Error(ExitCode::kFile, path_.string() + ": cannot be " + doing + " (" + std::strerror(errno) + ")");
}

}  // namespace spherechain::baker
