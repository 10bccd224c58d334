// SPDX-License-Identifier: MIT
// In a file of its own: seen by its callers, GCC takes the pair of new and free for a mismatch.
#include "counting_new.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> allocations{0};

}  // namespace

// Arrays come through here too.
void* operator new(std::size_t size) {
  ++allocations;
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) {
    std::abort();
  }
  return memory;
}
// A sanitizer has one of its own, which does not.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace spherechain::test {

std::size_t allocation_count() { return allocations; }

}  // namespace spherechain::test
