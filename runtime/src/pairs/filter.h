// SPDX-License-Identifier: MIT
// A caller's filter, checked.
#pragma once

#include "asset/asset_view.h"
#include "asset/memory.h"
#include "spherechain/detect.h"

namespace spherechain {

Status check_filter(const AssetView& asset, const Filter& filter);

struct FilterRanges {
  MemoryRange ignored, disabled, padding;
};
// Nothing of a null filter.
FilterRanges ranges_of(const Filter* filter);

}  // namespace spherechain
