// SPDX-License-Identifier: MIT
// Checks that the FlatBuffers verifier cannot make of an asset: that indices point at something and figures are
// figures.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/message.h"

namespace spherechain {

// `asset` views `root`, which has passed the FlatBuffers verifier over `size` bytes and has a known version. False,
// with a message that names the field, where a value would make an accessor or a job read out of bounds or divide by
// zero, or is no sensible value at all. Linear in `size`, also for tables that point at each other's arrays. `sizes`
// becomes those of the skin's expanded tables.
bool values_are_valid(const schema::Asset& root, const AssetView& asset, std::size_t size, SkinSizes& sizes,
                      Message& message);

// The same for the tables of refit by moments, and for the skin. Spheres, bones and parts must be valid already.
bool moment_values_are_valid(const AssetView& asset, Message& message);
bool skin_values_are_valid(const AssetView& asset, SkinSizes& sizes, Message& message);

// Figures are no more than a body of that height could have, so that answers are of its size, and work of the file's:
// of an asset that is valid otherwise.
bool figures_are_in_range(const AssetView& asset, std::size_t size, Message& message);

// Takes a float, or a struct that holds only floats.
template <typename Floats>
bool is_finite(const Floats& value) {
  static_assert(sizeof(Floats) % sizeof(float) == 0 && alignof(Floats) == alignof(float));
  const auto* const first = reinterpret_cast<const float*>(&value);
  return std::all_of(first, reinterpret_cast<const float*>(&value + 1), [](float v) { return std::isfinite(v); });
}

inline bool is_above_0(float value) { return std::isfinite(value) && value > 0.0F; }
inline bool is_at_least_0(float value) { return std::isfinite(value) && value >= 0.0F; }

}  // namespace spherechain
