// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/response_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace spherechain::baker {

using nlohmann::ordered_json;

ordered_json response_json(const ResponseMeasures& of) {
  return {{"frames", of.frames},
          {"faulty_before", of.faulty_before},
          {"faulty_after", of.faulty_after},
          {"new_faults", of.new_faults},
          {"wrist_acceleration", of.wrist_acceleration},
          {"elbow_acceleration", of.elbow_acceleration},
          {"largest_jump_percent", 100 * of.largest_jump},
          {"moved_without_fault", of.moved_without_fault},
          {"residual_p95_percent", 100 * of.residual_p95},
          {"us_mean", of.us_mean},
          {"us_p99", of.us_p99}};
}

std::string response_text(const ResponseMeasures& of, const AnimatedAsset& animated) {
  return fmt::format(
      "response: {} of {} frames had a fault of an arm, {} have one now ({} with a new one); acceleration of wrists x "
      "{:.2f}, elbows x {:.2f}; largest jump {:.0f} mm; {:.1f} % of frames without a fault moved; {:.0f} us a frame\n",
      of.faulty_before, of.frames, of.faulty_after, of.new_faults, of.wrist_acceleration, of.elbow_acceleration,
      of.largest_jump * animated.frame().height * mm_per_unit(animated.asset()), 100 * of.moved_without_fault,
      of.us_mean);
}

}  // namespace spherechain::baker
