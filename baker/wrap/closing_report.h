// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "baker/import/import.h"

namespace spherechain::baker {

// The source of the body.
enum class BodySource : std::uint8_t {
  kSkin,      // the skin's largest piece, or all of its pieces, as they are
  kRepaired,  // the largest piece, made closed: welded, split, turned, its holes closed
  kWrapped,   // an alpha wrap around the skin
};

// Findings and repairs for a closed body, for the bake report.
struct ClosingReport {
  BodySource body = BodySource::kSkin;
  // Repair: defects of the skin.
  std::size_t welded = 0;       // border vertices that nearly coincided
  std::size_t t_junctions = 0;  // vertices that an edge was split at
  std::size_t turned = 0;       // triangles that faced the other way than those around them
  std::size_t parted = 0;       // edges of more than two triangles
  std::size_t holes = 0;
  // The wrap that became the body. Lengths are fractions of the skin's diameter.
  double alpha = 0, offset = 0;
  double thin = 0;           // Wrap::thin
  bool holes_first = false;  // WrapSize::holes_first
  std::size_t triangles = 0;
  // Totals of all tries.
  int wraps = 0;
  double seconds = 0;  // repair and wraps
};

}  // namespace spherechain::baker
