// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace spherechain::baker {

// A stream of an asset (schemas/sphere_chains.fbs): zigzag-coded differences as LEB128.
class StreamWriter {
 public:
  void put(std::uint32_t value) {
    const std::int64_t difference = std::int64_t{value} - last_;
    last_ = value;
    auto code = static_cast<std::uint64_t>(difference < 0 ? -2 * difference - 1 : 2 * difference);
    for (; code >= 0x80; code >>= 7) bytes_.push_back(static_cast<std::uint8_t>(code | 0x80));
    bytes_.push_back(static_cast<std::uint8_t>(code));
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::int64_t last_ = 0;
};

}  // namespace spherechain::baker
