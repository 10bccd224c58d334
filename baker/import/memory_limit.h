// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace spherechain::baker {

// While it lives, the process may take this much more memory than it has: past that, new throws std::bad_alloc. For
// importers that believe whatever counts a file claims. Process-wide, so one at a time; where the system has no such
// limit, or a sanitizer maps memory of its own, it does nothing.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  std::uint64_t before_ = 0;
  bool set_ = false;
};

}  // namespace spherechain::baker
