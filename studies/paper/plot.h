// SPDX-License-Identifier: GPL-3.0-or-later
// Line and scatter plots as SVG: panels side by side under one legend.
#pragma once

#include <string>
#include <vector>

namespace spherechain::paper {

// Okabe and Ito's palette, which the colour-blind can tell apart; each colour has its own mark too.
enum class Colour { kBlue, kVermilion, kGreen, kOrange, kPurple, kGrey };

enum class Style { kLine, kDashed, kMarks, kLineAndMarks };

struct Series {
  std::string label;  // the legend shows each label once a figure
  Colour colour;
  Style style;
  std::vector<double> x, y;          // a NaN breaks the line
  std::vector<std::string> names{};  // next to the marks, or none
};

// A straight line across a panel that something is compared with.
struct Reference {
  std::string label;
  bool vertical;
  double at;
};

struct Panel {
  std::string title, x_label, y_label;
  std::vector<Series> series;
  std::vector<Reference> references{};
  bool log_axes = false;   // both
  bool zero_based = true;  // the y axis starts at 0
  double x_tick = 0;       // distance of the x axis' ticks; 0: chosen
  // Named rows instead of a y axis: a mark's y counts them from 0 at the top. The first column shows the names.
  std::vector<std::string> rows{};
};

struct Figure {
  std::string name;  // of the file, without .svg
  std::string caption;
  std::size_t columns;
  double panel_height;  // pixels, of a width of 1080
  std::vector<Panel> panels;
  double names_width = 0;  // pixels left of the first column, for the names of rows
};

std::string to_svg(const Figure& figure);

// & < > " as entities.
std::string escape(const std::string& text);

}  // namespace spherechain::paper
