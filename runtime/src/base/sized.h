// SPDX-License-Identifier: MIT
// Structs that a program fills, and that may get more fields: the program and the library may know different sizes.
#pragma once

#include <cstddef>
#include <cstring>

#include "runtime/src/base/status.h"

namespace spherechain {

// Bytes of a struct in release 0.1.0. A specialization for each struct, beside its reader, names the last field of that
// release. There is no padding after it: a program that has an old struct may leave garbage in its padding.
template <typename T>
inline constexpr std::size_t kFirstSize = 0;

#define SPHERECHAIN_LAST_FIELD(type, field)                                                    \
  template <>                                                                                  \
  inline constexpr std::size_t kFirstSize<type> = offsetof(type, field) + sizeof(type::field); \
  static_assert(offsetof(type, struct_size) == 0 && kFirstSize<type> % alignof(type) == 0)

inline constexpr std::size_t kStructBytesMax = 4096;  // a size above is garbage: an old program's, or not initialised

// Copies the program's struct; fields that it does not have are 0. Refuses sizes that no version has, and fields that
// this library does not know unless they are 0. After an error `own` is not to be used.
template <typename T>
Status read_struct(const T* given, T& own) {
  static_assert(kFirstSize<T> > 0);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(given);
  decltype(own.struct_size) stated = 0;
  std::memcpy(&stated, bytes, sizeof stated);
  if (stated == sizeof(T)) {  // the usual case, and the fastest
    own = *given;
    return done();
  }
  const std::size_t size = stated == 0 ? kFirstSize<T> : stated;
  bool is_known = size >= kFirstSize<T> && size <= kStructBytesMax;
  for (std::size_t i = sizeof(T); is_known && i < size; ++i) {
    is_known = bytes[i] == 0;
  }
  if (!is_known) {
    return refuse(SC_BAD_VALUE, SC_FIELD_STRUCT_SIZE);
  }
  own = T{};
  std::memcpy(&own, bytes, size < sizeof(T) ? size : sizeof(T));
  own.struct_size = sizeof(T);
  return done();
}

}  // namespace spherechain
