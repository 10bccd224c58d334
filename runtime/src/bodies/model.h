// SPDX-License-Identifier: MIT
#pragma once

#include "runtime/src/bodies/blocks.h"
#include "spherechain/asset.h"

struct sc_model {
  sc_allocator allocator;
  sc_asset asset;
  spherechain::Block bytes, tables;  // the asset's bytes; what the pointers below point into
  std::uint32_t* joint_of_bone;      // null: palettes come in the asset's order
  std::uint64_t* skin_table;
  std::uint64_t* detect_table;  // of the product's radius and the asset's ignored pairs
};
