// SPDX-License-Identifier: GPL-3.0-or-later
// Trees over the chains.
#include "figures.h"
#include "tree_time.h"

namespace spherechain::paper {

Figure tree_figure(const Results& results) {
  Figure figure{"trees",
                "Time of a frame over the number of spheres, a tree's refit included. Left: baked chains; right: the "
                "spheres of profile paper in parts. Dashed: the product's all_pairs.",
                2,
                300,
                {}};
  for (const auto& [name, title] : {std::pair(kBaked, "baked chains"), std::pair(kSplit, "spheres in parts")}) {
    const Table series = results.trees.where("series", name);
    Panel panel{title, "spheres (log)", "time (µs, log)", {}};
    panel.log_axes = true;
    for (const auto& [method, colour] : {std::pair(kLoopM1, Colour::kBlue), std::pair(kLoopM2, Colour::kVermilion),
                                         std::pair(kBinaryTree, Colour::kGreen), std::pair(kQuadtree, Colour::kOrange),
                                         std::pair(kOctree, Colour::kPurple), std::pair(kJob, Colour::kGrey)}) {
      const Table t = series.where("method", method);
      panel.series.push_back({method, colour, colour == Colour::kGrey ? Style::kDashed : Style::kLineAndMarks,
                              t.numbers("spheres"), t.numbers("us")});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace spherechain::paper
