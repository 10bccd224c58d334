// SPDX-License-Identifier: MIT
// How much of a body part's core is inside others, once find_inside() has looked at each sphere's centre.
#pragma once

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/inside/inside.h"

namespace spherechain {

class Containment {
 public:
  // `inside`: of each sphere the part that holds its centre, or kOutside; null: none is inside.
  Containment(const AssetView& asset, const Surface& surface, const std::uint16_t* inside);

  struct Holder {
    std::uint16_t part = kOutside;  // the one that holds most of it
    double share = 0;               // of the core that any part holds
  };
  Holder holder_of(std::size_t part) const;
  // The share of a part's core that `other` holds; where that is its holder, that any part holds.
  double swallowed(std::size_t part, std::size_t other) const;
  // Does the limb come out again behind `other`, which holds some of the part's core?
  bool passes_through(std::size_t part, std::size_t other) const;

 private:
  // Counts the pieces in which these spheres, ascending, hang together; `but_inside`: without those that are inside.
  std::size_t pieces_of(Span<const std::size_t> limb, bool but_inside) const;

  const AssetView& asset_;
  const Surface& surface_;
  const std::uint16_t* inside_;
};

}  // namespace spherechain
