// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_axes.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/page/from_runtime.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {

BodyFrame page_axes(const AnimatedAsset& animated) {
  BodyFrame axes = animated.frame();
  const Character& character = animated.character();
  const double on_the_ground = axes.forward.dot(character.up_hint);
  if (std::abs(on_the_ground) < 0.7 || has_arms(animated.asset())) return axes;
  // The back is up, and what was up leads.
  const Vec3 head = axes.up;
  axes.up = on_the_ground > 0 ? axes.forward : -axes.forward;
  axes.forward = axes.left.cross(axes.up);
  if (axes.forward.dot(head) < 0) {
    axes.forward = -axes.forward;
    axes.left = -axes.left;
  }
  double lowest = HUGE_VAL, front = -HUGE_VAL, rear = HUGE_VAL;
  for (const Vec3& p : character.source_positions) {
    lowest = std::min(lowest, axes.up.dot(p - axes.origin));
    front = std::max(front, axes.forward.dot(p - axes.origin));
    rear = std::min(rear, axes.forward.dot(p - axes.origin));
  }
  axes.origin += lowest * axes.up + (front + rear) / 2 * axes.forward;
  return axes;
}

nlohmann::ordered_json axes_json(const BodyFrame& frame) {
  return {{"origin", to_json(frame.origin)},
          {"left", to_json(frame.left)},
          {"up", to_json(frame.up)},
          {"forward", to_json(frame.forward)},
          {"height", frame.height}};
}

}  // namespace spherechain::baker
