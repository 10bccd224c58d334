// SPDX-License-Identifier: MIT
// The memory of one call: buffers with guard zones between them, and a picture of all of it from before the call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "random.h"

namespace spherechain::test {

struct Bytes {
  const void* data = nullptr;
  std::size_t size = 0;
};

template <typename T>
Bytes bytes_of(const T* data, std::size_t count) {
  return {data, data == nullptr ? 0 : count * sizeof(T)};
}

class Arena {
 public:
  Arena();
  ~Arena();
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // Forgets all buffers.
  void begin(Random& random);
  // Aligned as T, and now and then no better; what it holds is dirt. Never null, also for none.
  template <typename T>
  T* add(std::size_t count) {
    return static_cast<T*>(add_bytes(count * sizeof(T), alignof(T)));
  }
  // Takes the picture. From here on AddressSanitizer, where there is one, knows the guard zones.
  void seal();
  // Is everything outside of `writable` as in the picture?
  bool kept_but(const std::vector<Bytes>& writable);
  void restore();
  // Every bit of what the picture has there: other dirt.
  void invert(const std::vector<Bytes>& ranges);

 private:
  void* add_bytes(std::size_t size, std::size_t alignment);
  void set_guards(bool poisoned);

  struct Block {
    std::size_t begin, end;
  };
  std::vector<std::uint8_t> memory_, picture_;
  std::vector<Block> blocks_;
  std::size_t used_ = 0;
  Random* random_ = nullptr;
};

}  // namespace spherechain::test
