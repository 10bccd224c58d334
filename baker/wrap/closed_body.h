// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "import/import.h"
#include "segment/segment.h"

namespace spherechain::baker {

// How the closed surface came about that is segmented by its shape.
enum class BodySource : std::uint8_t {
  kSkin,      // the skin's largest piece as it is
  kRepaired,  // the same made closed: welded, split, turned, its holes closed
  kWrapped,   // an alpha wrap around the skin
};

// What was found and done; all of it goes into the bake report.
struct ClosingReport {
  BodySource body = BodySource::kSkin;
  // Of the repair, which is tried first: what was wrong with the skin.
  std::size_t welded = 0;       // border vertices that all but coincided
  std::size_t t_junctions = 0;  // vertices that an edge was split at
  std::size_t turned = 0;       // triangles that faced the other way than those around them
  std::size_t parted = 0;       // edges of more than two triangles
  std::size_t holes = 0;
  // Of the wrap. Fractions of the skin's diameter.
  double alpha = 0, offset = 0;
  double thin = 0;           // share of the wrap's area with nothing but offset behind it: cloth, or it got inside
  bool holes_first = false;  // wrapped after the holes were closed
  std::size_t triangles = 0;
  int wraps = 0;       // tried
  double seconds = 0;  // repair and wraps
};

// Makes the body the largest piece of the repaired skin, its triangles those of the source but for the fans in former
// holes. Where that is not closed or not most of the skin it returns false, and the body stays as it was.
bool repair_body(Character& character, ClosingReport& report);

// Makes the body a wrap of the skin, where a rig says what its regions are. Where the holes are so wide that every wrap
// lines the skin from inside it returns false, and the body stays as it was.
bool wrap_body(Character& character, ClosingReport& report);

// Segments by shape a character in any state: as it is where its body is whole, else its repaired body, else wraps of
// its skin, the first whose gaps are closed and in which limbs and torso are apart. Where the settings do not say what
// body it is, a biped is preferred. The body becomes what was segmented. Throws Error(kSegmentation) where none can be.
Regions segment_closed(Character& character, const SegmentSettings& settings, ClosingReport& report);

// Makes the body what segment_closed makes of it, for what depends on nothing else (bone heat). Throws as it does.
void close_body(Character& character, const SegmentSettings& settings);

}  // namespace spherechain::baker
