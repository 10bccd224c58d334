// SPDX-License-Identifier: MIT
// The caller's buffer for a sentence that says what is wrong with an asset.
#pragma once

#include <cinttypes>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>

namespace spherechain {

// Its functions return false, so that a check can end with one; has_size() is a check itself.
class Message {
 public:
  Message(char* buffer, std::size_t size) noexcept : buffer_(buffer), size_(buffer == nullptr ? 0 : size) {
    if (size_ > 0) {
      buffer_[0] = '\0';
    }
  }

  // Writes the sentence, cut to the buffer.
#if defined(__MINGW_PRINTF_FORMAT)  // there "printf" means Microsoft's old one, without %zu
  __attribute__((format(__MINGW_PRINTF_FORMAT, 2, 3)))
#elif defined(__GNUC__)
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

  // About entry i of a table, or a field of it: ".radius".
  bool wrong_at(const char* table, std::uint64_t i, const char* field, const char* what) noexcept {
    return wrong("%s[%" PRIu64 "]%s: %s", table, i, field, what);
  }
  bool wrong_at(const char* table, std::uint64_t i, const char* what) noexcept { return wrong_at(table, i, "", what); }

  // Entry i of a table names a thing by its number, of which there are `count`.
  bool past_end(const char* table, std::uint64_t i, const char* field, std::uint32_t value, std::size_t count,
                const char* things) noexcept {
    return wrong("%s[%" PRIu64 "]%s: %" PRIu32 " is past the %zu %s", table, i, field, value, count, things);
  }

  // Checks how many entries a table has.
  bool has_size(const char* table, std::uint64_t size, std::uint64_t wanted, const char* things) noexcept {
    return size == wanted || wrong("%s: %" PRIu64 " of them, but %" PRIu64 " %s", table, size, wanted, things);
  }

 private:
  char* buffer_;
  std::size_t size_;
};

}  // namespace spherechain
