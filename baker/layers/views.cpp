// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "baker/mesh/even_directions.h"

namespace spherechain::baker {
namespace {

constexpr int kDirections = 36;      // of which a quarter look from below
constexpr double kLowest = -0.5;     // sine of the elevation
constexpr float kEdge = 1e-3F;       // rounding leaves no gap between triangles with a common edge
constexpr double kSizeMax = 4096.0;  // pixels; what a clip throws farther is not seen

// Also of what is not finite.
int clamp_pixel(float at, int low, int high) {
  return !(at > static_cast<float>(low)) ? low : at < static_cast<float>(high) ? static_cast<int>(at) : high;
}

}  // namespace

std::vector<Vec3> view_directions(const Vec3& up, std::size_t turn) {
  const Vec3 side = up.unitOrthogonal(), front = side.cross(up);
  // The golden ratio spreads any number of turns evenly.
  const double angle = 2 * std::numbers::pi * std::fmod(static_cast<double>(turn) / std::numbers::phi, 1.0);
  std::vector<Vec3> out;
  for (const Vec3& d : even_directions(kDirections)) {
    if (d.y() <= kLowest) continue;
    const double x = std::cos(angle) * d.x() - std::sin(angle) * d.z(),
                 z = std::sin(angle) * d.x() + std::cos(angle) * d.z();
    out.push_back(x * side + d.y() * up + z * front);
  }
  return out;
}

void SeenPixels::clear() { seen_.assign(skin_.rest.triangles.size(), {}); }

void SeenPixels::look(const std::vector<Vec3>& positions, const Vec3& eye) {
  Vec3 right = skin_.up.cross(eye);
  right = right.norm() < 1e-6 ? eye.unitOrthogonal() : right.normalized();
  const Vec3 up = eye.cross(right);
  Eigen::AlignedBox2d box;
  for (const Vec3& p : positions) box.extend(Eigen::Vector2d(p.dot(right), p.dot(up)));
  const Eigen::Vector2d corner = box.min(), size = box.sizes() / pixel_;
  width_ = static_cast<int>(std::clamp(std::ceil(size.x()), 1.0, kSizeMax));
  height_ = static_cast<int>(std::clamp(std::ceil(size.y()), 1.0, kSizeMax));
  points_.clear();
  for (const Vec3& p : positions) {
    points_.push_back({static_cast<float>((p.dot(right) - corner.x()) / pixel_),
                       static_cast<float>((p.dot(up) - corner.y()) / pixel_), static_cast<float>(p.dot(eye) / pixel_)});
  }
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  depths_.assign(pixels, -HUGE_VALF);
  triangles_.assign(pixels, kNoIndex);
  for (Index t = 0; t < skin_.rest.triangles.size(); ++t) {
    if (skin_.is_opaque[t] != 0) draw(t);
  }
  for (const Index shown : triangles_) {
    if (shown != kNoIndex) ++seen_[shown / 2][shown % 2];
  }
}

void SeenPixels::draw(Index triangle) {
  const Triangle& corners = skin_.rest.triangles[triangle];
  const std::array<float, 3>&a = points_[corners[0]], &b = points_[corners[1]], &c = points_[corners[2]];
  const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  if (area == 0 || (area < 0 && skin_.is_two_sided[triangle] == 0)) return;
  const auto [left, right] = std::minmax({a[0], b[0], c[0]});
  const auto [bottom, top] = std::minmax({a[1], b[1], c[1]});
  // Pixels whose middle is inside.
  const int from_x = clamp_pixel(std::ceil(left - 0.5F), 0, width_),
            to_x = clamp_pixel(std::floor(right - 0.5F), -1, width_ - 1),
            from_y = clamp_pixel(std::ceil(bottom - 0.5F), 0, height_),
            to_y = clamp_pixel(std::floor(top - 0.5F), -1, height_ - 1);
  if (from_x > to_x || from_y > to_y) return;
  // The weights of b and c, and the depth, are linear in x and y.
  const float bx = (c[1] - a[1]) / area, by = (a[0] - c[0]) / area, cx = (a[1] - b[1]) / area,
              cy = (b[0] - a[0]) / area;
  const float zx = bx * (b[2] - a[2]) + cx * (c[2] - a[2]), zy = by * (b[2] - a[2]) + cy * (c[2] - a[2]);
  const Index shown = 2 * triangle + (area < 0 ? 1 : 0);
  for (int y = from_y; y <= to_y; ++y) {
    const float dx = static_cast<float>(from_x) + 0.5F - a[0], dy = static_cast<float>(y) + 0.5F - a[1];
    const float weight_b = dx * bx + dy * by, weight_c = dx * cx + dy * cy;
    // The steps to the right at which each of the three weights is not negative.
    float first = 0, last = static_cast<float>(to_x - from_x);
    const auto keep = [&](float weight, float slope) {
      if (slope > 0) first = std::max(first, (-kEdge - weight) / slope);
      if (slope < 0) last = std::min(last, (-kEdge - weight) / slope);
      if (slope == 0 && weight < -kEdge) last = -1;
    };
    keep(weight_b, bx);
    keep(weight_c, cx);
    keep(1 - weight_b - weight_c, -bx - cx);
    if (!(first <= last)) continue;
    const int from = static_cast<int>(std::ceil(first)), to = static_cast<int>(std::floor(last));
    float depth = a[2] + dx * zx + dy * zy + static_cast<float>(from) * zx;
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width_);
    for (int x = from_x + from; x <= from_x + to; ++x, depth += zx) {
      const std::size_t at = row + static_cast<std::size_t>(x);
      if (depth > depths_[at]) {
        depths_[at] = depth;
        triangles_[at] = shown;
      }
    }
  }
}

}  // namespace spherechain::baker
