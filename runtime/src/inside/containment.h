// SPDX-License-Identifier: MIT
// How much of a body part's core is inside others, once find_inside() has looked at each probe.
#pragma once

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/inside/inside.h"

namespace spherechain {

class Containment {
 public:
  // `inside`: of each probe the part that holds it, or kOutside; null: none is inside.
  Containment(const AssetView& asset, const Surface& surface, const std::uint16_t* inside);

  struct Holder {
    std::uint16_t part = kOutside;  // the one that holds most of it
    double share = 0;               // of the core that any part holds
  };
  Holder holder_of(std::size_t part) const;
  // Marks each part that holds some of a part's core.
  void mark_holders(std::size_t part, bool* holds) const;
  // The share of a part's core that `other` holds; where that is its holder, that any part holds.
  double swallowed(std::size_t part, std::size_t other) const;
  // Does the limb come out again behind `other`, which holds some of the part's core?
  bool passes_through(std::size_t part, std::size_t other) const;

 private:
  // Counts the pieces in which these spheres, ascending, hang together; `but_inside`: without those that are inside.
  std::size_t pieces_of(Span<const std::size_t> limb, bool but_inside) const;

  // Calls visit(holder) for each of the part's core points.
  template <typename Visit>
  void for_core(std::size_t part, const Visit& visit) const;

  const AssetView& asset_;
  const Surface& surface_;
  const std::uint16_t* inside_;
};

}  // namespace spherechain
