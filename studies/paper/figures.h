// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "claims.h"
#include "plot.h"

namespace spherechain::paper {

Figure accuracy_figure(const Results& results);      // Figure 13
Figure shape_figure(const Results& results);         // its claim
Figure running_time_figure(const Results& results);  // Figure 15
std::string gpu_label(const std::string& method);    // a method of Figure 16 for readers
Figure gpu_time_figure(const Results& results);      // Figure 16
Figure gpu_count_figure(const Results& results);     // the same over the number of spheres
Figure tree_figure(const Results& results);          // trees over the chains
Figure sphere_count_figure(const Results& results);  // 46 or 80
// The effect of a setting, one line a series; the last one names the colours.
struct SweepLine {
  std::string series, label;
  Style style;
};
Figure sweep_figure(const Results& results, const std::string& setting, const std::string& axis,
                    const std::vector<SweepLine>& lines);
Figure quality_figure(const Results& results);

}  // namespace spherechain::paper
