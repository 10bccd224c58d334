// SPDX-License-Identifier: MIT
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <vector>

namespace samples {

// The numbers of an accessor, normalized integers as fractions. `width` per element. Throws std::runtime_error where
// the accessor has another width, is sparse, or reaches past its buffer.
std::vector<float> read_accessor(const tinygltf::Model& model, int index, std::size_t width);

}  // namespace samples
