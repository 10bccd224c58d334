// SPDX-License-Identifier: MIT
#pragma once

#include "asset/message.h"
#include "asset/skin_data.h"

namespace spherechain {

namespace schema {
struct Asset;
}

// values_are_valid(), of the skin: every stream has the numbers it should, every run ends in its table, every index
// points at something. `sizes` becomes those of the expanded tables.
bool skin_values_are_valid(const schema::Asset& root, SkinSizes& sizes, Message& message);

}  // namespace spherechain
