// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/memory_limit.h"

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace spherechain::baker {

MemoryLimit::MemoryLimit(std::uint64_t bytes) {
  std::uint64_t pages = 0;
  rlimit limit{};
  if (!(std::ifstream("/proc/self/statm") >> pages) || getrlimit(RLIMIT_AS, &limit) != 0) return;
  before_ = limit.rlim_cur;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + bytes);
  set_ = setrlimit(RLIMIT_AS, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
  rlimit limit{};
  if (!set_ || getrlimit(RLIMIT_AS, &limit) != 0) return;
  limit.rlim_cur = before_;
  setrlimit(RLIMIT_AS, &limit);
}

}  // namespace spherechain::baker

#else

namespace spherechain::baker {

MemoryLimit::MemoryLimit(std::uint64_t) {}
MemoryLimit::~MemoryLimit() = default;

}  // namespace spherechain::baker

#endif
