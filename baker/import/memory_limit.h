// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace spherechain::baker {

// While it exists, the process may allocate only this many bytes more; then `new` throws std::bad_alloc. It guards
// importers that believe the counts in a file. It holds for the whole process: use one at a time. It does nothing where
// the system has no such limit or a sanitizer maps memory of its own.
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
