// SPDX-License-Identifier: MIT
// The part of asset_checks.h that sees to refit from bones and from packed pivots.
#pragma once

#include "message.h"

namespace spherechain {

namespace schema {
struct Asset;
}

// `root`'s spheres and pivots are valid already. As values_are_valid().
bool bone_values_are_valid(const schema::Asset& root, Message& message);

}  // namespace spherechain
