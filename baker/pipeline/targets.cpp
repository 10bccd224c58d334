// SPDX-License-Identifier: GPL-3.0-or-later
// Which of its targets a bake misses.
#include <fmt/format.h>

#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

std::vector<std::string> missed_targets(const Bake& bake) {
  std::vector<std::string> missed;
  const std::optional<int>& limit = bake.settings.fit.spheres;
  if (limit && bake.spheres.spheres.size() > static_cast<std::size_t>(*limit)) {
    missed.push_back(fmt::format("spheres: {} asked, {} needed", *limit, bake.spheres.spheres.size()));
  }
  const std::optional<FitGrade>& fit = bake.settings.targets.fit;
  if (fit && bake.quality.grade() > *fit) {
    missed.push_back(
        fmt::format("fit: {} asked, {} reached", fit_grade_name(*fit), fit_grade_name(bake.quality.grade())));
  }
  return missed;
}

}  // namespace spherechain::baker
