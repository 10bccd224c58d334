// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/write_all.h"

#include <unistd.h>

#include <cerrno>

namespace spherechain::baker {

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

}  // namespace spherechain::baker
