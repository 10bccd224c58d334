// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// Two patches of a posed skin that intersect.
struct Patches {
  std::array<std::vector<std::uint32_t>, 2> triangles;  // of each part; source numbers
  Vec3 point = Vec3::Zero();                            // the middle of the patches
  Vec3 way = Vec3::Zero();                              // direction out of the contact
};

// Pictures of a character in one pose, and from where its patches are seen. Parallel light and projection, no memory of
// the pose before.
class Picture {
 public:
  Picture(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles, const BodyFrame& axes);

  // `positions` of the source vertices. Both hold until the next call.
  void pose(const std::vector<Vec3>& positions);

  const Vec3& forward() const { return axes_.forward; }
  const Vec3& position(Index vertex) const { return positions_[vertex]; }

  // The direction from the patches to an eye that sees most of both and the way out from the side; from the front where
  // others are no better.
  Vec3 find_eye(const Patches& patches);

  // A PNG of the character around the patches, which are coloured; without patches of all of it, from the front.
  std::string png(const Patches* patches, const Vec3& eye);

 private:
  struct View {
    Vec3 right, up, back, middle;
    double scale;  // pixels a unit
    int width, height;
    double least = -HUGE_VAL;  // along `back`: triangles that lie wholly behind it are left out
  };
  View view_from(const Vec3& back, const Vec3& middle, double extent, int width, int height) const;
  // Draws all triangles, or those of the patches, into ids_ and depths_.
  void draw(const View& view, const Patches* only = nullptr);

  const std::vector<Triangle>& triangles_;
  BodyFrame axes_;
  std::vector<Vec3> positions_;
  std::vector<Eigen::Vector3f> floats_;  // the same
  std::vector<std::uint32_t> order_;     // of triangles: kRun that follow one another lie together
  struct Ball {
    Eigen::Vector3f center;
    float radius;
  };
  std::vector<Ball> balls_;         // around kRun of them each: most are outside a picture
  std::vector<std::uint32_t> ids_;  // a pixel's triangle, kNoTriangle none
  std::vector<float> depths_;
};

}  // namespace spherechain::baker
