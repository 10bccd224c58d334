// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/layers/skin.h"

namespace spherechain::baker {

// Directions towards the eyes that look at a character: evenly spread, none from more than 30 degrees below. `turn`
// turns all of them about the up axis, by another angle for each number.
std::vector<Vec3> view_directions(const Vec3& up, std::size_t turn);

// Draws a posed skin in parallel projection and counts the pixels that show each triangle. One thread at a time.
class SeenPixels {
 public:
  // `pixel`: the size of a pixel.
  SeenPixels(const LayeredSkin& skin, double pixel) : skin_(skin), pixel_(pixel) {}

  // Adds what an eye in the direction `eye` sees of `positions`, the source's vertices.
  void look(const std::vector<Vec3>& positions, const Vec3& eye);
  void clear();

  // Pixels that show a triangle from its front and from its back, since the last clear().
  const std::vector<std::array<std::uint32_t, 2>>& of_triangle() const { return seen_; }

 private:
  void draw(Index triangle);

  const LayeredSkin& skin_;
  double pixel_;
  std::vector<std::array<std::uint32_t, 2>> seen_;
  std::vector<std::array<float, 3>> points_;  // of the vertices: pixels from the left, from below, towards the eye
  int width_ = 0, height_ = 0;
  std::vector<float> depths_;
  std::vector<Index> triangles_;  // of the pixels, twice the number and 1 from behind; kNoIndex: none
};

}  // namespace spherechain::baker
