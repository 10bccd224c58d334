// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <optional>

#include "mesh/error.h"
#include "write/temporary.h"
#include "write/write.h"

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

bool is_written_directly(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && (!fs::is_regular_file(status) || names_descriptor(written_file(path)));
}

fs::path written_file(const fs::path& path) {
  const auto fail = [&] {
    throw Error(ExitCode::kFile, path.string() + ": cannot be created (" + std::strerror(errno) + ")");
  };
  // What the system would not follow (a ring of links, a stranger's in /tmp) is not followed here.
  struct ::stat there {};
  if (::stat(path.c_str(), &there) != 0 && errno != ENOENT) fail();
  constexpr int kMostLinks = 40;  // the system's own; those to nothing it has not counted
  fs::path file = path;
  for (int links = 0; !names_descriptor(file); ++links) {
    std::error_code error;
    const fs::path target = fs::read_symlink(file, error);
    if (error) break;  // the end: no link
    if (links == kMostLinks) {
      errno = ELOOP;
      fail();
    }
    file = file.parent_path() / target;
  }
  return file;
}

void write_atomically(const fs::path& path, std::string_view bytes) {
  const bool direct = is_written_directly(path);
  std::optional<Temporary> temporary;
  if (!direct) temporary.emplace(written_file(path));

  const auto fail = [&](const char* doing) {
    throw Error(ExitCode::kFile, path.string() + ": cannot be " + doing + " (" + std::strerror(errno) + ")");
  };
  const int file =
      direct ? open_directly(path) : ::open(temporary->path().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail("created");
  for (std::size_t done = 0; done < bytes.size();) {
    const ::ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int error = errno;
      ::close(file);
      errno = error;
      fail("written");
    }
    done += static_cast<std::size_t>(n);
  }
  if (!direct && ::fsync(file) != 0) {
    const int error = errno;
    ::close(file);
    errno = error;
    fail("written");
  }
  if (::close(file) != 0) fail("written");
  if (!direct && !temporary->rename_to_target()) fail("replaced");
}

}  // namespace spherechain::baker
