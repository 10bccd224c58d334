// SPDX-License-Identifier: MIT
#include "runtime/src/inside/containment.h"

#include <algorithm>

#include "runtime/src/base/pair_bits.h"

namespace spherechain {
namespace {

constexpr std::size_t kLimbMost = 128;  // spheres; a body of more has no limbs

}  // namespace

Containment::Containment(const AssetView& asset, const Surface& surface, const std::uint16_t* inside)
    : asset_(asset), surface_(surface), inside_(inside) {
  const std::size_t count = asset.spheres().size;  // a core point is inside only where a sphere is
  if (inside != nullptr && std::all_of(inside, inside + count, [](std::uint16_t of) { return of == kOutside; })) {
    inside_ = nullptr;
  }
}

template <typename Visit>
void Containment::for_core(std::size_t part, const Visit& visit) const {
  for (std::size_t place = kCorePoints * part; place < kCorePoints * (part + 1); ++place) {
    if (surface_.core_triangles[place] != kNoPlace) {
      visit(inside_[asset_.spheres().size + place]);
    }
  }
}

Containment::Holder Containment::holder_of(std::size_t part) const {
  Holder out;
  if (inside_ == nullptr) {
    return out;
  }
  std::size_t all = 0, held = 0, most = 0, counts[kMaxPartCount + 1] = {};
  for_core(part, [&](std::uint16_t by) {
    ++all;
    if (by == kOutside) {
      return;
    }
    ++held;
    ++counts[by];
    if (counts[by] > most || (counts[by] == most && by < out.part)) {
      most = counts[by];
      out.part = by;
    }
  });
  out.share = held == 0 ? 0 : static_cast<double>(held) / static_cast<double>(all);
  return out;
}

void Containment::mark_holders(std::size_t part, bool* holds) const {
  if (inside_ != nullptr) {
    for_core(part, [&](std::uint16_t by) {
      if (by != kOutside) {
        holds[by] = true;
      }
    });
  }
}

double Containment::swallowed(std::size_t part, std::size_t other) const {
  const Holder holder = holder_of(part);
  if (holder.part == kOutside || holder.part == other) {
    return holder.share;
  }
  std::size_t all = 0, held = 0;
  for_core(part, [&](std::uint16_t by) {
    ++all;
    held += by == other ? 1 : 0;
  });
  return static_cast<double>(held) / static_cast<double>(all);
}

// Without the spheres that are inside, does the limb fall into more pieces? Neighbours on the body hang together.
bool Containment::passes_through(std::size_t part, std::size_t other) const {
  std::size_t limb[kLimbMost], count = 0, region = kOutside;
  bool is_held = false;
  for (std::size_t s = 0; inside_ != nullptr && s < asset_.spheres().size; ++s) {
    if (asset_.spheres()[s].part == part && inside_[s] == other && is_core(surface_, s)) {
      region = asset_.spheres()[s].region;
      is_held = true;
    }
  }
  for (std::size_t s = 0; is_held && s < asset_.spheres().size; ++s) {
    if (asset_.spheres()[s].region == region && is_core(surface_, s)) {
      if (count == kLimbMost) {
        return false;
      }
      limb[count++] = s;
    }
  }
  const Span<const std::size_t> all{limb, count};
  return is_held && pieces_of(all, true) > pieces_of(all, false);
}

std::size_t Containment::pieces_of(Span<const std::size_t> limb, bool but_inside) const {
  std::size_t piece[kLimbMost], count = 0;
  const auto is_left = [&](std::size_t i) { return !but_inside || inside_[limb[i]] == kOutside; };
  for (std::size_t i = 0; i < limb.size; ++i) {
    piece[i] = i;
  }
  const auto root = [&](std::size_t i) {
    while (piece[i] != i) {
      i = piece[i];
    }
    return i;
  };
  for (std::size_t i = 0; i < limb.size; ++i) {
    count += is_left(i) ? 1 : 0;
    for (std::size_t j = 0; is_left(i) && j < i; ++j) {
      const std::size_t bit = ignored_bit(limb[j], limb[i]);  // ascending
      if (is_left(j) && (asset_.ignored()[bit / 64] >> bit % 64 & 1) != 0 && root(i) != root(j)) {
        piece[std::max(root(i), root(j))] = std::min(root(i), root(j));
        --count;
      }
    }
  }
  return count;
}

}  // namespace spherechain
