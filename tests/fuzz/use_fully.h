// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/asset.h"

namespace spherechain::test {

enum class Use { kFull, kWithoutRefit, kBroken };

// Reads all an open asset has and runs every job on it, in buffers sized exactly. kBroken, with a line on stderr, where
// a job fails or returns what it must not. kWithoutRefit where a hostile vertex count asks for more memory than we
// spend.
Use use_fully(const Asset& asset);

}  // namespace spherechain::test
