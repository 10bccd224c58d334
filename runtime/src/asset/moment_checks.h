// SPDX-License-Identifier: MIT
// The part of asset_checks.h that sees to refit by moments.
#pragma once

#include "asset/message.h"

namespace spherechain {

namespace schema {
struct Asset;
}

// `root`'s spheres and bones are valid already. As values_are_valid().
bool moment_values_are_valid(const schema::Asset& root, Message& message);

}  // namespace spherechain
