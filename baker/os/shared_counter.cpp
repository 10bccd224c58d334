// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/shared_counter.h"

#include <sys/mman.h>

#include <new>

namespace spherechain::baker {

SharedCounter::SharedCounter() {
  void* shared = ::mmap(nullptr, sizeof(Value), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  value_ = new (shared) Value(0);
}

SharedCounter::~SharedCounter() { ::munmap(value_, sizeof(Value)); }

}  // namespace spherechain::baker
