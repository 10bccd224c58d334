// SPDX-License-Identifier: MIT
#pragma once

#include "runtime/src/depth/contour.h"
#include "runtime/src/depth/shadow.h"
#include "runtime/src/penetrations/ray.h"

namespace spherechain {

// The share of a contour that can be seen from far away.
struct Seen {
  double share;   // of the contour's segments
  double length;  // of the contour; a segment counts less where one looks along one of its sides
};

// A half-line, and the plane across it.
struct Sight {
  Ray ray;
  View view;

  Sight(const Double3& from, const Double3& direction) : ray(from, direction), view(direction, from) {}
};

struct Gaze {
  double clearance;   // rays start so far away from the skin, between the two surfaces
  bool wants_length;  // false: Seen::length may come out too short
};

class Visibility {
 public:
  explicit Visibility(const Skins& skins) : skins_(skins) {}

  // Samples the contour's segments and finds those from which some ray leaves the bodies without meeting them. `axes`
  // are three directions at right angles. A segment is weighted by its best free ray: the cosine between the ray and
  // the normal of the side that it meets more flatly.
  Seen look(const Contour& contour, const Double3 (&axes)[3], const Gaze& gaze);

 private:
  bool is_free(const Sight& sight);
  bool meets_skin(const PosedSkin& skin, const Sight& sight);
  bool meets_cluster(const PosedSkin& skin, std::size_t c, const Sight& sight);
  // That cosine, at least 0; -1 where no ray is free. `free`: a direction to try first; then the best one, if any.
  double best_cosine(const Segment3& segment, const Double3 (&axes)[3], const Gaze& gaze, Double3& free);

  const Skins& skins_;
  // Triangles that rays met last: likely to stop the next.
  static constexpr std::size_t kBlockers = 8;
  struct Blocker {
    const PosedSkin* skin;  // null: none yet
    std::uint32_t triangle;
  };
  Blocker blockers_[kBlockers];
  std::size_t next_blocker_ = 0;
};

}  // namespace spherechain
