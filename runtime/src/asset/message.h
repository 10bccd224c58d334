// SPDX-License-Identifier: MIT
// The caller's buffer for a sentence that says what is wrong with an asset.
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace spherechain {

class Message {
 public:
  Message(char* buffer, std::size_t size) noexcept : buffer_(buffer), size_(buffer == nullptr ? 0 : size) {
    if (size_ > 0) {
      buffer_[0] = '\0';
    }
  }

  // Writes the sentence, cut to the buffer. Returns false so that a check can end with it.
#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  bool
  wrong(const char* format, ...) noexcept {
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(buffer_, size_, format, arguments);
    va_end(arguments);
    return false;
  }

 private:
  char* buffer_;
  std::size_t size_;
};

}  // namespace spherechain
