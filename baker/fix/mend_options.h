// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spherechain::baker {

struct MendOptions {
  double budget_degrees = 25;   // largest turn of a joint for one event
  double margin_mm = 1.5;       // distance of separated parts
  bool is_soft_parted = false;  // push belly, chest and thighs apart, too
};

}  // namespace spherechain::baker
