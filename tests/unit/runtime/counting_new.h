// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace spherechain::test {

// How often this executable has called operator new so far.
std::size_t allocation_count();

}  // namespace spherechain::test
