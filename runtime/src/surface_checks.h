// SPDX-License-Identifier: MIT
// The part of asset_checks.h that sees to the surface and its leaves.
#pragma once

#include "message.h"

namespace spherechain {

namespace schema {
struct Asset;
}

// `root` is valid already but for its surface. As values_are_valid().
bool surface_values_are_valid(const schema::Asset& root, Message& message);

}  // namespace spherechain
