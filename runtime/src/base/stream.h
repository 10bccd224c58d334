// SPDX-License-Identifier: MIT
// Reads a stream of the asset: zigzag differences as LEB128 (schemas/sphere_chains.fbs).
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/span.h"

namespace spherechain {

class Stream {
 public:
  explicit Stream(Span<const std::uint8_t> bytes) : at_(bytes.data), end_(bytes.data + bytes.size) {}

  bool has_more() const { return at_ != end_; }

  // False at the end of the bytes, and where a number is not a 32-bit one; then nothing more is read.
  bool read(std::uint32_t& value) {
    std::uint64_t code = 0;
    unsigned shift = 0;
    for (; at_ != end_ && (*at_ & 0x80U) != 0 && shift < 28; ++at_, shift += 7) {
      code |= std::uint64_t{*at_ & 0x7FU} << shift;
    }
    if (at_ == end_ || (*at_ & 0x80U) != 0) {
      at_ = end_;
      return false;
    }
    code |= std::uint64_t{*at_++} << shift;
    const std::int64_t difference =
        (code & 1U) != 0 ? -static_cast<std::int64_t>(code / 2) - 1 : static_cast<std::int64_t>(code / 2);
    last_ += difference;
    value = static_cast<std::uint32_t>(last_);
    return last_ >= 0 && last_ <= 0xFFFFFFFF;
  }

  // Reads the next number. The stream must have been verified.
  std::uint32_t next() {
    std::uint32_t value = 0;
    read(value);
    return value;
  }

 private:
  const std::uint8_t *at_, *end_;
  std::int64_t last_ = 0;
};

}  // namespace spherechain
