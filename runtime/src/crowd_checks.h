// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/crowd.h"

namespace spherechain {

// What CrowdJob::run() says of its arguments, of an asset that is open, with `stride` as it is resolved; but for the
// target, and lists that are too short.
Status check_crowd(const CrowdJob& job, std::size_t stride);

}  // namespace spherechain
