// SPDX-License-Identifier: GPL-3.0-or-later
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "baker/mesh/error.h"
#include "baker/os/atomic_file.h"
#include "baker/os/written_file.h"

namespace spherechain::baker {

namespace {

namespace fs = std::filesystem;

// /dev/stdout, /dev/fd/3, /proc/self/fd/3: links to whatever that is.
bool names_descriptor(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(path, error))) return false;
  const std::string name = fs::absolute(path, error).lexically_normal().string();
  return name.rfind("/dev/", 0) == 0 || name.rfind("/proc/", 0) == 0;
}

}  // namespace

bool is_written_directly(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && (!fs::is_regular_file(status) || names_descriptor(written_file(path)));
}

fs::path written_file(const fs::path& path) {
  const auto fail = [&] {
    throw Error(ExitCode::kFile, path.string() + ": cannot be created (" + std::strerror(errno) + ")");
  };
  // Links that the system would not follow (a ring of links, a stranger's in /tmp) are not followed here.
  struct ::stat there {};
  if (::stat(path.c_str(), &there) != 0 && errno != ENOENT) fail();
  constexpr int kLinksMax = 40;  // the system's own; those to nothing it has not counted
  fs::path file = path;
  for (int links = 0; !names_descriptor(file); ++links) {
    std::error_code error;
    const fs::path target = fs::read_symlink(file, error);
    if (error) break;  // the end: no link
    if (links == kLinksMax) {
      errno = ELOOP;
      fail();
    }
    file = file.parent_path() / target;
  }
  return file;
}

void write_atomically(const fs::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.finish();
}

}  // namespace spherechain::baker
