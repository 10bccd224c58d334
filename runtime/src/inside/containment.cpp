// SPDX-License-Identifier: MIT
#include "runtime/src/inside/containment.h"

#include <algorithm>

namespace spherechain {

Containment::Containment(const AssetView& asset, const Surface& surface, const std::uint16_t* inside)
    : asset_(asset), surface_(surface), inside_(inside) {
  const std::size_t count = asset.spheres().size;
  if (inside != nullptr && std::all_of(inside, inside + count, [](std::uint16_t of) { return of == kOutside; })) {
    inside_ = nullptr;
  }
}

Containment::Holder Containment::holder_of(std::size_t part) const {
  Holder out;
  if (inside_ == nullptr) {
    return out;
  }
  std::size_t all = 0, held = 0, most = 0, counts[kMaxPartCount + 1] = {};
  for (std::size_t s = 0; s < surface_.sphere_parts.size; ++s) {
    if (surface_.sphere_parts[s] != part || !is_core(surface_, s)) {
      continue;
    }
    ++all;
    const std::uint16_t by = inside_[s];
    if (by == kOutside) {
      continue;
    }
    ++held;
    ++counts[by];
    if (counts[by] > most || (counts[by] == most && by < out.part)) {
      most = counts[by];
      out.part = by;
    }
  }
  out.share = held == 0 ? 0 : static_cast<double>(held) / static_cast<double>(all);
  return out;
}

double Containment::swallowed(std::size_t part, std::size_t other) const {
  const Holder holder = holder_of(part);
  if (holder.part == kOutside || holder.part == other) {
    return holder.share;
  }
  std::size_t all = 0, held = 0;
  for (std::size_t s = 0; s < surface_.sphere_parts.size; ++s) {
    if (surface_.sphere_parts[s] == part && is_core(surface_, s)) {
      ++all;
      held += inside_[s] == other ? 1 : 0;
    }
  }
  return static_cast<double>(held) / static_cast<double>(all);
}

bool Containment::passes_through(std::size_t part, std::size_t other) const {
  for (std::size_t c = 0; inside_ != nullptr && c < asset_.chain_count(); ++c) {
    std::size_t region = kOutside;
    enum { kBefore, kOut, kIn, kThrough } state = kBefore;
    for (const std::uint32_t s : asset_.chain(c).spheres) {
      if (!is_core(surface_, s)) {
        continue;
      }
      if (asset_.spheres()[s].region != region) {
        region = asset_.spheres()[s].region;
        state = kBefore;
      }
      const bool is_in = inside_[s] != kOutside;
      state = !is_in                                              ? (state == kIn        ? kThrough
                                                                     : state == kThrough ? kThrough
                                                                                         : kOut)
              : state == kOut && surface_.sphere_parts[s] == part && inside_[s] == other ? kIn
                                                                  : state;
      if (state == kThrough) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace spherechain
