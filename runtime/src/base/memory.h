// SPDX-License-Identifier: MIT
// Are a caller's buffers there, aligned as their type, and do they lie on top of each other?
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/span.h"

namespace spherechain {

template <typename T>
bool is_missing(const Span<T>& span) {
  return span.data == nullptr && span.size > 0;
}

// Null is aligned.
template <typename... T>
bool any_misaligned(const T*... data) {
  return (... | (reinterpret_cast<std::uintptr_t>(data) % alignof(T) != 0));
}

struct MemoryRange {
  std::uintptr_t begin = 0, end = 0;
};

template <typename T>
MemoryRange range_of(const Span<T>& span) {
  const auto begin = reinterpret_cast<std::uintptr_t>(span.data);
  return {begin, begin + span.size * sizeof(T)};
}

// Asks for it to be brought into the first cache, while what does not need it goes on.
inline void fetch(const MemoryRange& range) {
#if defined(__GNUC__) || defined(__clang__)
  constexpr std::uintptr_t kLine = 64;
  for (std::uintptr_t at = range.begin; at < range.end; at += kLine) {
    __builtin_prefetch(reinterpret_cast<const void*>(at));
  }
#else
  (void)range;
#endif
}

// Empty ranges share nothing.
inline bool is_shared(const MemoryRange& p, const MemoryRange& q) {
  return p.begin < q.end && q.begin < p.end && p.begin < p.end && q.begin < q.end;
}

// Each of `written` against all others and all of `read`. Most jobs leave most of them empty.
template <std::size_t kWritten, std::size_t kRead>
bool any_shared(const MemoryRange (&written)[kWritten], const MemoryRange (&read)[kRead]) {
  bool shared = false;
  for (std::size_t i = 0; i < kWritten; ++i) {
    if (written[i].begin == written[i].end) {
      continue;
    }
    for (std::size_t j = i + 1; j < kWritten; ++j) {
      shared |= is_shared(written[i], written[j]);
    }
    for (const MemoryRange& range : read) {
      shared |= is_shared(written[i], range);
    }
  }
  return shared;
}

}  // namespace spherechain
