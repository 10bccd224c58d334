// SPDX-License-Identifier: MIT
// What the FlatBuffers verifier cannot know of an asset: that indices point at something and figures are figures.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asset/message.h"
#include "asset/skin_data.h"

namespace spherechain {

namespace schema {
struct Asset;
}

// `root` has passed the FlatBuffers verifier over `size` bytes and has a known version. False, with a message that
// names the field, where a value would make an accessor or a job read out of bounds or divide by zero, or is no
// sensible value at all. Linear in `size`, also for tables that point at each other's arrays.
// `sizes` becomes those of its skin.
bool values_are_valid(const schema::Asset& root, std::size_t size, SkinSizes& sizes, Message& message);

// Bits set in the table of ignored pairs.
std::size_t count_ignored(const schema::Asset& root);

}  // namespace spherechain
