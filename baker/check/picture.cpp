// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/picture.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "baker/mesh/even_directions.h"

// The library is C of another style: its warnings are not ours to mend.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace spherechain::baker {
namespace {

constexpr std::uint32_t kNoTriangle = 0xFFFFFFFF;
constexpr std::size_t kRun = 32;  // triangles that are left out of a picture together
constexpr int kProbeSize = 24;
constexpr int kWidth = 144, kHeight = 144, kSamples = 2;  // of a picture; samples a pixel in each direction
using Colour = std::array<double, 3>;
constexpr std::array<Colour, 3> kColours{{{0.79, 0.76, 0.71}, {0.83, 0.12, 0.17}, {0.95, 0.55, 0.1}}};  // skin, patches

// The pixel values of kTones + 1 strengths of light from 0 to 1.
constexpr double kTones = 1023;
std::vector<unsigned char> make_tones() {
  std::vector<unsigned char> out;
  for (int i = 0; i <= kTones; ++i) {
    out.push_back(static_cast<unsigned char>(std::lround(255 * std::pow(i / kTones, 1 / 1.25))));
  }
  return out;
}

// Few from below.
std::vector<Vec3> eye_directions(const BodyFrame& axes) {
  std::vector<Vec3> out;
  for (const Vec3& d : even_directions(16)) {
    if (d.y() < -0.5 || d.y() > 0.9) continue;
    out.push_back(d.x() * axes.left + d.y() * axes.up + d.z() * axes.forward);
  }
  return out;
}

// The least of what is not finite.
int pixel(float at, int least, int most) {
  return !(at > static_cast<float>(least)) ? least : at < static_cast<float>(most) ? static_cast<int>(at) : most;
}

// Sorts triangles so that each kRun in a row lie together: halves them along the longest axis, again and again.
void sort_by_place(const std::vector<Vec3>& centers, std::uint32_t* begin, std::uint32_t* end) {
  if (end - begin <= static_cast<std::ptrdiff_t>(kRun)) return;
  Eigen::AlignedBox3d box;
  std::for_each(begin, end, [&](std::uint32_t t) { box.extend(centers[t]); });
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::ptrdiff_t runs = (end - begin) / static_cast<std::ptrdiff_t>(kRun);
  std::uint32_t* const middle = begin + (runs + 1) / 2 * static_cast<std::ptrdiff_t>(kRun);
  std::nth_element(begin, middle, end, [&](std::uint32_t l, std::uint32_t r) {
    return std::pair(centers[l][axis], l) < std::pair(centers[r][axis], r);
  });
  sort_by_place(centers, begin, middle);
  sort_by_place(centers, middle, end);
}

}  // namespace

Picture::Picture(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles, const BodyFrame& axes)
    : triangles_(triangles), axes_(axes), order_(triangles.size()) {
  std::vector<Vec3> centers;
  for (const Triangle& t : triangles) centers.push_back((rest[t[0]] + rest[t[1]] + rest[t[2]]) / 3);
  std::iota(order_.begin(), order_.end(), 0);
  sort_by_place(centers, order_.data(), order_.data() + order_.size());
}

void Picture::pose(const std::vector<Vec3>& positions) {
  positions_ = positions;
  floats_.clear();
  for (const Vec3& p : positions) floats_.push_back(p.cast<float>());
  balls_.clear();
  for (std::size_t first = 0; first < order_.size(); first += kRun) {
    Eigen::AlignedBox3f box;
    const std::size_t end = std::min(first + kRun, order_.size());
    for (std::size_t i = first; i < end; ++i) {
      for (const Index v : triangles_[order_[i]]) box.extend(floats_[v]);
    }
    balls_.push_back({box.center(), 0.5f * box.diagonal().norm()});
  }
}

Picture::View Picture::view_from(const Vec3& back, const Vec3& middle, double extent, int width, int height) const {
  View view{{}, {}, back.normalized(), middle, std::min(width, height) / extent, width, height, -HUGE_VAL};
  Vec3 right = axes_.up.cross(view.back);
  if (right.norm() < 1e-3) right = axes_.left;
  view.right = right.normalized();
  view.up = view.back.cross(view.right);
  return view;
}

void Picture::draw(const View& view, const Patches* only) {
  const Eigen::Vector3f right = (view.scale * view.right).cast<float>(), up = (view.scale * view.up).cast<float>(),
                        back = view.back.cast<float>();
  const float x0 = static_cast<float>(view.width * 0.5 - view.scale * view.middle.dot(view.right)),
              y0 = static_cast<float>(view.height * 0.5 + view.scale * view.middle.dot(view.up));
  const float width = static_cast<float>(view.width), height = static_cast<float>(view.height);
  const auto least = static_cast<float>(view.least);
  const auto seen = [&](const Eigen::Vector3f& p) {
    return Eigen::Vector3f(x0 + p.dot(right), y0 - p.dot(up), p.dot(back));
  };
  const std::size_t size = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  ids_.assign(size, kNoTriangle);
  depths_.assign(size, -HUGE_VALF);
  const auto draw_triangle = [&](std::uint32_t t) {
    const Triangle& corners = triangles_[t];
    const Eigen::Vector3f a = seen(floats_[corners[0]]), b = seen(floats_[corners[1]]), c = seen(floats_[corners[2]]);
    if (std::max({a[2], b[2], c[2]}) < least) return;
    const auto [low_x, high_x] = std::minmax({a[0], b[0], c[0]});
    const auto [low_y, high_y] = std::minmax({a[1], b[1], c[1]});
    const int from_x = pixel(std::ceil(low_x - 0.5f), 0, view.width),
              to_x = pixel(std::floor(high_x - 0.5f), -1, view.width - 1),
              from_y = pixel(std::ceil(low_y - 0.5f), 0, view.height),
              to_y = pixel(std::floor(high_y - 0.5f), -1, view.height - 1);
    if (from_x > to_x || from_y > to_y) return;
    const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area == 0) return;
    // u, v and depth are linear in x and y.
    const float ux = (c[1] - a[1]) / area, uy = (a[0] - c[0]) / area, vx = (a[1] - b[1]) / area,
                vy = (b[0] - a[0]) / area;
    const float zx = ux * (b[2] - a[2]) + vx * (c[2] - a[2]), zy = uy * (b[2] - a[2]) + vy * (c[2] - a[2]);
    for (int y = from_y; y <= to_y; ++y) {
      const float px = static_cast<float>(from_x) + 0.5f - a[0], py = static_cast<float>(y) + 0.5f - a[1];
      float u = px * ux + py * uy, v = px * vx + py * vy, depth = a[2] + px * zx + py * zy;
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
      for (int x = from_x; x <= to_x; ++x) {
        const std::size_t at = row + static_cast<std::size_t>(x);
        if (u >= 0 && v >= 0 && u + v <= 1 && depth > depths_[at]) {
          depths_[at] = depth;
          ids_[at] = t;
        }
        u += ux;
        v += vx;
        depth += zx;
      }
    }
  };
  if (only != nullptr) {
    for (const auto& side : only->triangles) std::for_each(side.begin(), side.end(), draw_triangle);
    return;
  }
  for (std::size_t run = 0; run < balls_.size(); ++run) {
    const Eigen::Vector3f p = seen(balls_[run].center);
    const float reach = static_cast<float>(view.scale) * balls_[run].radius;
    const bool is_aside = p[0] + reach < 0 || p[1] + reach < 0 || p[0] - reach > width || p[1] - reach > height;
    if (is_aside || p[2] + balls_[run].radius < least) continue;
    const std::size_t end = std::min(kRun * (run + 1), order_.size());
    for (std::size_t i = kRun * run; i < end; ++i) draw_triangle(order_[i]);
  }
}

Vec3 Picture::find_eye(const Patches& patches) {
  std::vector<std::uint8_t> side(triangles_.size(), 0);
  double extent = 0;
  for (std::size_t k = 0; k < 2; ++k) {
    for (const std::uint32_t t : patches.triangles[k]) {
      side[t] = static_cast<std::uint8_t>(k + 1);
      for (const Index v : triangles_[t]) extent = std::max(extent, 2.4 * (positions_[v] - patches.point).norm());
    }
  }
  extent = std::max(extent, 0.05 * axes_.height);
  Vec3 best = axes_.forward;
  double most = 0;
  for (const Vec3& back : eye_directions(axes_)) {
    View view = view_from(back, patches.point, extent, kProbeSize, kProbeSize);
    view.least = HUGE_VAL;
    for (const auto& triangles : patches.triangles) {
      for (const std::uint32_t t : triangles) {
        for (const Index v : triangles_[t]) view.least = std::min(view.least, positions_[v].dot(back));
      }
    }
    view.least -= 1e-4 * axes_.height;
    draw(view);
    std::array<int, 3> seen{};
    for (const std::uint32_t id : ids_) ++seen[id == kNoTriangle ? 0 : side[id]];
    const int both = seen[1] > 0 && seen[2] > 0 ? std::min(seen[1], seen[2]) / 2 + 8 : 0;
    const double aside = back.cross(patches.way).norm();  // 0: the way out is seen end-on
    const double score = (seen[1] + seen[2] + both) * (0.75 + 0.25 * back.dot(axes_.forward)) * (0.4 + 0.6 * aside);
    if (score > most) {
      most = score;
      best = back;
    }
  }
  return best;
}

std::string Picture::png(const Patches* patches, const Vec3& eye) {
  std::vector<std::uint8_t> side(triangles_.size(), 0);
  Eigen::AlignedBox3d box;
  for (const Vec3& p : positions_) {
    box.extend(Vec3((p - axes_.origin).dot(axes_.left), (p - axes_.origin).dot(axes_.up),
                    (p - axes_.origin).dot(axes_.forward)));
  }
  const Vec3 center = box.center();
  Vec3 middle = axes_.origin + center.x() * axes_.left + center.y() * axes_.up + center.z() * axes_.forward;
  double extent = 1.08 * box.sizes().maxCoeff();
  if (patches != nullptr) {
    for (const std::uint32_t t : patches->triangles[0]) side[t] = 1;
    for (const std::uint32_t t : patches->triangles[1]) side[t] = 2;
    extent = 0.4 * axes_.height;
    middle = patches->point;
  }
  const int width = kWidth * kSamples, height = kHeight * kSamples;
  const View view = view_from(eye, middle, extent, width, height);
  const Patches none;
  draw(view, patches != nullptr ? patches : &none);
  const std::vector<std::uint32_t> patch_ids = ids_;
  draw(view);
  const Vec3 key = (-0.45 * view.right + 0.7 * view.up + 0.65 * view.back).normalized();
  static const std::vector<unsigned char> tones = make_tones();
  std::vector<unsigned char> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Colour sum{};
      int covered = 0;
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const std::size_t at = static_cast<std::size_t>(y * kSamples + s / kSamples) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x * kSamples + s % kSamples);
        if (ids_[at] == kNoTriangle) continue;
        ++covered;
        const Triangle& t = triangles_[ids_[at]];
        Vec3 normal = (positions_[t[1]] - positions_[t[0]]).cross(positions_[t[2]] - positions_[t[0]]).normalized();
        if (normal.dot(view.back) < 0) normal = -normal;
        const double light = 0.32 + 0.62 * std::max(0.0, normal.dot(key)) + 0.12 * normal.dot(view.up);
        // A patch shows through the skin before it, half as strong.
        const std::uint32_t patch = patch_ids[at];
        const double share = side[ids_[at]] != 0 ? 1 : patch != kNoTriangle ? 0.5 : 0;
        const Colour& colour = kColours[side[side[ids_[at]] != 0 || patch == kNoTriangle ? ids_[at] : patch]];
        for (std::size_t k = 0; k < 3; ++k) {
          sum[k] += std::clamp(light * (share * colour[k] + (1 - share) * kColours[0][k]), 0.0, 1.0);
        }
      }
      for (const double value : sum) {
        const double mean = covered > 0 ? value / covered : 0;
        pixels.push_back(tones[static_cast<std::size_t>(kTones * mean)]);
      }
      pixels.push_back(static_cast<unsigned char>(255 * covered / (kSamples * kSamples)));
    }
  }
  std::string out;
  stbi_write_png_to_func(
      [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
      },
      &out, kWidth, kHeight, 4, pixels.data(), 4 * kWidth);
  return out;
}

}  // namespace spherechain::baker
