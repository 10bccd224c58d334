// SPDX-License-Identifier: MIT
#include "map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

using namespace spherechain;

void draw_map(const AssetInfo& info, const std::vector<Standing>& characters, const char* svg_file) {
  const Vec3 left = info.left, forward = info.forward;
  const float scale = 100 * info.metres_per_unit;
  const auto along = [&](const Vec3& axis, const Vec3& p) {
    return scale * (axis.x * p.x + axis.y * p.y + axis.z * p.z);
  };
  std::string text;
  char line[256];
  float end_x = 0, end_y = 0;
  for (const Standing& one : characters) {
    const float x = std::min(along(left, one.low), along(left, one.high));
    const float y = std::min(along(forward, one.low), along(forward, one.high));
    const float width = std::abs(along(left, one.high) - along(left, one.low));
    const float height = std::abs(along(forward, one.high) - along(forward, one.low));
    std::snprintf(line, sizeof line, "<rect x='%.0f' y='%.0f' width='%.0f' height='%.0f' class='%s'/>\n", double{x},
                  double{y}, double{width}, double{height}, one.met > 0 ? "met" : "free");
    text += line;
    std::snprintf(line, sizeof line, "<circle cx='%.0f' cy='%.0f' r='%.1f'/>\n", double{x + width / 2},
                  double{y + height / 2}, double{3 * scale * one.depth});
    text += one.depth > 0 ? line : "";
    end_x = std::max(end_x, x + width);
    end_y = std::max(end_y, y + height);
  }
  std::ofstream out(svg_file);
  out << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='-100 -100 " << end_x + 150 << ' ' << end_y + 150 << "'>\n"
      << "<style>svg{background:#fff} rect{fill:none;stroke:#bbb;stroke-width:2} .met{fill:#d41f2c66;stroke:#d41f2c} "
         "circle{fill:#0072b2}</style>\n"
      << text << "</svg>\n";
  if (!out.flush()) throw std::runtime_error(std::string(svg_file) + ": cannot be written");
}
