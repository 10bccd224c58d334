// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "mesh/error.h"
#include "write/write.h"

namespace spherechain::baker {

void write_atomically(const std::filesystem::path& path, std::string_view bytes) {
  // A pipe or a device (/dev/stdout) cannot be replaced by a rename: those are written to directly.
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  const bool direct = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
  const std::string temporary = direct ? path.string() : path.string() + ".tmp-" + std::to_string(::getpid());

  const auto fail = [&](const char* doing) {
    const std::string why = std::strerror(errno);
    if (!direct) ::unlink(temporary.c_str());
    throw Error(ExitCode::kFile, path.string() + ": cannot be " + doing + " (" + why + ")");
  };
  const int file = ::open(temporary.c_str(), direct ? O_WRONLY : O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
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
  if (!direct && std::rename(temporary.c_str(), path.c_str()) != 0) fail("replaced");
}

}  // namespace spherechain::baker
