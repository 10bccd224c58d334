// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/score/scored_skin.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Skin that lies inside another body part, and the volume that it bounds. In the source's units.
struct Swallowed {
  double area = 0, volume = 0;
};

// The skin that lies behind the lines in which the contacts' triangles cross. A triangle that is crossed lies inside as
// far as it is behind the nearest triangle that crosses it; the skin between such triangles lies inside if three
// quarters of its corners on them do. The volume is that of the skin's flux from its middle, so that it exists for
// every skin, open or closed; where parts and lines are closed, it is that of their intersection.
class SwallowedSkin {
 public:
  // `skin` must outlive it.
  explicit SwallowedSkin(const ScoredSkin& skin);
  // `others` bound skin as `contacts` do, and are not measured.
  Swallowed measure(const std::vector<Vec3>& positions, const std::vector<TriangleContact>& contacts,
                    const std::vector<TriangleContact>& others) const;

 private:
  const ScoredSkin& skin_;
  std::vector<std::vector<Index>> triangles_at_;  // of each joined vertex
};

}  // namespace spherechain::baker
