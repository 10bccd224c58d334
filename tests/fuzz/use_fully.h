// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/asset.h"

namespace spherechain::test {

enum class Use { kFull, kPartly, kBroken };

// Reads all that an open asset has and runs every job on it, in buffers sized exactly. kBroken, with a line on stderr,
// where a job fails or returns what it must not. kPartly where a hostile count asks for more memory than we spend.
Use use_fully(const Asset& asset);

}  // namespace spherechain::test
