// SPDX-License-Identifier: GPL-3.0-or-later
#include "plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace spherechain::paper {
namespace {

constexpr std::array<const char*, 6> kHex{"#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#6B6B6B"};
constexpr double kWidth = 1080, kLegendRow = 20;
constexpr double kLeft = 58, kRight = 14, kTop = 26, kBottom = 44;  // around a panel's axes

const char* hex(Colour colour) { return kHex[static_cast<std::size_t>(colour)]; }

// One direction of a panel: values to pixels.
struct Axis {
  double low, high, from, to;
  bool log;
  std::vector<double> ticks;

  double at(double value) const {
    const auto f = [&](double v) { return log ? std::log10(v) : v; };
    return from + (f(value) - f(low)) / (f(high) - f(low)) * (to - from);
  }
};

double nice_step(double range, int count) {
  const double raw = range / count, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double step : {1.0, 2.0, 2.5, 5.0}) {
    if (step * power >= raw * 0.999) return step * power;
  }
  return 10 * power;
}

Axis linear_axis(double low, double high, double from, double to, int count, double tick) {
  if (!(high > low)) {
    const double pad = std::max(0.5 * std::abs(high), 0.5);
    low = low == 0 ? 0 : low - pad;
    high += pad;
  }
  const double step = tick > 0 ? tick : nice_step(high - low, count);
  Axis axis{low, high, from, to, false, {}};
  for (double t = std::ceil(low / step - 1e-9) * step; t <= high + 1e-9 * step; t += step) {
    axis.ticks.push_back(std::abs(t) < 1e-9 * step ? 0 : t);
  }
  return axis;
}

Axis log_axis(double low, double high, double from, double to) {
  Axis axis{low / 1.15, high * 1.15, from, to, true, {}};
  for (double decade = std::pow(10, std::floor(std::log10(axis.low))); decade < axis.high; decade *= 10) {
    const bool narrow = axis.high<4 * axis.low, wide = axis.high> 150 * axis.low;
    for (int digit = 1; digit < 10; ++digit) {
      const bool labelled = narrow || digit == 1 || (!wide && (digit == 2 || digit == 5));
      if (labelled && digit * decade >= axis.low && digit * decade <= axis.high) axis.ticks.push_back(digit * decade);
    }
  }
  return axis;
}

std::string mark(Colour colour, double x, double y) {
  const char* fill = hex(colour);
  switch (colour) {
    case Colour::kBlue:
    case Colour::kGrey:
      return fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="3.2" fill="{}"/>)", x, y, fill);
    case Colour::kVermilion:
      return fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="6" height="6" fill="{}"/>)", x - 3, y - 3, fill);
    case Colour::kGreen:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}l3.8 6.6h-7.6z" fill="{}"/>)", x, y - 4.2, fill);
    case Colour::kOrange:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}l4.2 4.2l-4.2 4.2l-4.2 -4.2z" fill="{}"/>)", x, y - 4.2, fill);
    case Colour::kPurple:
      return fmt::format(R"(<path d="M{:.1f} {:.1f}l3.8 -6.6h-7.6z" fill="{}"/>)", x, y + 4.2, fill);
  }
  return {};
}

std::string text(double x, double y, const std::string& anchor, const std::string& what, const std::string& more = "") {
  return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}"{}>{}</text>)", x, y, anchor,
                     more.empty() ? "" : " " + more, escape(what)) +
         "\n";
}

bool has_marks(const Series& series) { return series.style == Style::kMarks || series.style == Style::kLineAndMarks; }

std::string line_of(const Series& series, const Axis& x, const Axis& y) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const bool drawn = std::isfinite(series.x[i]) && std::isfinite(series.y[i]);
    if (drawn) path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", x.at(series.x[i]), y.at(series.y[i]));
    pen_down = drawn;
  }
  return fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="1.8" stroke-linejoin="round"{}/>)", path,
                     hex(series.colour), series.style == Style::kDashed ? R"( stroke-dasharray="6 4")" : "") +
         "\n";
}

struct Axes {
  Axis x, y;
};

Axes axes_of(const Panel& panel, double left, double top, double width, double height) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double x0 = kInfinity, x1 = -kInfinity, y0 = panel.zero_based && !panel.log_axes ? 0 : kInfinity, y1 = -kInfinity;
  const auto extend = [](double value, double& low, double& high) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const Series& series : panel.series) {
    for (const double v : series.x) extend(v, x0, x1);
    for (const double v : series.y) extend(v, y0, y1);
  }
  for (const Reference& reference : panel.references) {
    reference.vertical ? extend(reference.at, x0, x1) : extend(reference.at, y0, y1);
  }
  const double a = left + kLeft, b = left + width - kRight, c = top + height - kBottom, d = top + kTop;
  if (panel.log_axes) return {log_axis(x0, x1, a, b), log_axis(y0, y1, c, d)};
  const double room = 0.06 * (y1 - y0);
  y1 += room;
  if (!panel.zero_based) y0 -= room;
  const auto x_ticks = static_cast<int>((b - a) / 55);
  if (!panel.rows.empty()) {
    const auto n = static_cast<double>(panel.rows.size());
    Axis y{n - 0.5, -0.5, c, d, false, {}};
    for (std::size_t i = 0; i < panel.rows.size(); ++i) y.ticks.push_back(static_cast<double>(i));
    return {linear_axis(std::min(0.0, x0), 1.04 * x1, a, b, x_ticks, panel.x_tick), y};
  }
  const double margin = 0.02 * (x1 - x0);
  return {linear_axis(x0 - margin, x1 + margin, a, b, x_ticks, panel.x_tick), linear_axis(y0, y1, c, d, 5, 0)};
}

std::string draw_axes(const Panel& panel, const Axes& axes, double left, double top, bool row_names) {
  const auto& [x, y] = axes;
  std::string out = text(0.5 * (x.from + x.to), top + 15, "middle", panel.title, R"(font-weight="600")");
  for (std::size_t i = 0; i < y.ticks.size(); ++i) {
    const double at = y.at(y.ticks[i]);
    out += fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\" stroke=\"#e3e3e3\"/>\n", x.from, at, x.to);
    if (!panel.rows.empty() && !row_names) continue;
    out += text(x.from - 6, at + 4, "end", panel.rows.empty() ? fmt::format("{:.6g}", y.ticks[i]) : panel.rows[i]);
  }
  for (const double t : x.ticks) {
    out += fmt::format("<path d=\"M{:.1f} {:.1f}v4\" stroke=\"#444\"/>\n", x.at(t), y.from);
    out += text(x.at(t), y.from + 17, "middle", fmt::format("{:.6g}", t));
  }
  out += fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\" fill=\"none\" stroke=\"#444\"/>\n", x.from, y.to, y.from,
                     x.to);
  out += text(0.5 * (x.from + x.to), y.from + 35, "middle", panel.x_label);
  if (panel.y_label.empty()) return out;
  const std::string turned =
      fmt::format(R"~(transform="translate({:.1f} {:.1f}) rotate(-90)")~", left + 14, 0.5 * (y.from + y.to));
  return out + text(0, 0, "middle", panel.y_label, turned);
}

std::string draw_reference(const Reference& reference, const Axes& axes) {
  const auto& [x, y] = axes;
  constexpr const char *kStroke = " stroke=\"#444\" stroke-dasharray=\"2 3\"/>\n", *kSmall = R"(class="small")";
  if (reference.vertical) {
    const double at = x.at(reference.at);
    return fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}\"{}", at, y.from, y.to, kStroke) +
           text(at + 4, y.to + 11, "start", reference.label, kSmall);
  }
  const double at = y.at(reference.at);
  return fmt::format("<path d=\"M{:.1f} {:.1f}H{:.1f}\"{}", x.from, at, x.to, kStroke) +
         text(x.to - 2, at - 5, "end", reference.label, kSmall);
}

std::string draw_series(const Series& series, const Axes& axes) {
  std::string out;
  if (series.style != Style::kMarks) out += line_of(series, axes.x, axes.y);
  if (!has_marks(series)) return out;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) continue;
    const double x = axes.x.at(series.x[i]), y = axes.y.at(series.y[i]);
    out += mark(series.colour, x, y) + "\n";
    if (i < series.names.size()) out += text(x - 7, y - 5, "end", series.names[i], R"(class="small")");
  }
  return out;
}

std::string draw(const Panel& panel, double left, double top, double width, double height, bool row_names) {
  const Axes axes = axes_of(panel, left, top, width, height);
  std::string out = draw_axes(panel, axes, left, top, row_names);
  for (const Reference& reference : panel.references) out += draw_reference(reference, axes);
  for (const Series& series : panel.series) out += draw_series(series, axes);
  return out;
}

// The entries in rows of the figure's width, each row centred.
using LegendRows = std::vector<std::vector<const Series*>>;

double legend_width(const std::string& label) {
  const auto letters = std::count_if(label.begin(), label.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return 46 + 6.2 * static_cast<double>(letters);
}

double legend_width(const std::vector<const Series*>& row) {
  double width = 0;
  for (const Series* series : row) width += legend_width(series->label);
  return width;
}

LegendRows legend_rows(const Figure& figure) {
  LegendRows rows(1);
  std::set<std::string> seen;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
      if (series.label.empty() || !seen.insert(series.label).second) continue;
      if (legend_width(rows.back()) + legend_width(series.label) > kWidth) rows.emplace_back();
      rows.back().push_back(&series);
    }
  }
  return rows;
}

std::string draw(const LegendRows& rows) {
  std::string out;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    double x = 0.5 * (kWidth - legend_width(rows[r]));
    const double y = 17 + kLegendRow * static_cast<double>(r);
    for (const Series* series : rows[r]) {
      const Series sample{"", series->colour, series->style, {x, x + 24}, {y, y}};
      const Axis pixels{0, 1, 0, 1, false, {}};
      if (series->style != Style::kMarks) out += line_of(sample, pixels, pixels);
      if (has_marks(*series)) out += mark(series->colour, x + 12, y) + "\n";
      out += text(x + 30, y + 4, "start", series->label);
      x += legend_width(series->label);
    }
  }
  return out;
}

}  // namespace

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string to_svg(const Figure& figure) {
  const std::size_t rows = (figure.panels.size() + figure.columns - 1) / figure.columns;
  const LegendRows legend = legend_rows(figure);
  const double legend_height = 14 + kLegendRow * static_cast<double>(legend.size());
  const double height = legend_height + static_cast<double>(rows) * figure.panel_height + 4;
  const double width = (kWidth - figure.names_width) / static_cast<double>(figure.columns);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"Helvetica, Arial, "
      "sans-serif\" font-size=\"12\" fill=\"#222\" role=\"img\" aria-label=\"{}\">\n"
      "<style>.small{{font-size:11px;fill:#444}}</style>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      kWidth, height, escape(figure.caption));
  out += draw(legend);
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const std::size_t row = i / figure.columns, column = i % figure.columns;
    out +=
        draw(figure.panels[i], figure.names_width + static_cast<double>(column) * width,
             legend_height + static_cast<double>(row) * figure.panel_height, width, figure.panel_height, column == 0);
  }
  return out + "</svg>\n";
}

}  // namespace spherechain::paper
