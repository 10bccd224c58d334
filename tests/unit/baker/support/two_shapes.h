// SPDX-License-Identifier: GPL-3.0-or-later
// Two closed meshes that follow a joint each, baked: what is known about their intersection can be computed by hand.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "baker/pipeline/pipeline.h"
#include "baker/play/asset_file.h"
#include "runtime/src/penetrations/penetration_jobs.h"

struct Shape {
  std::vector<spherechain::baker::Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Shape ball(double radius, int rings);
Shape box(double x, double y, double z);  // half of its edges
// Along y, with round or flat ends; `half` is half of its straight length.
Shape capsule(double radius, double half, int rings);
Shape cylinder(double radius, double half, int rings);

class TwoShapes {
 public:
  // At rest, b stands `apart` from where it is given, along x. The joints are siblings, unless b's is a's child. As one
  // piece, a triangle joins their last vertices.
  TwoShapes(const Shape& a, const Shape& b, double apart = 40, bool is_child = false, bool one_piece = false);

  using Place = std::function<spherechain::baker::Vec3(const spherechain::baker::Vec3&)>;
  // b goes through `place`; a stays; then both go through `both`. All that the runtime finds, by the job's other
  // settings.
  std::vector<spherechain::Penetration> measure(const Place& place,
                                                const std::function<void(spherechain::PenetrationJob&)>& change = {},
                                                const Place& both = {}) const;

  // The same as a body finds it, with the parts that are inside another: alike on every target.
  std::vector<spherechain::Penetration> ask(const Place& place, const Place& both = {},
                                            spherechain::Scope scope = SC_SCOPE_ALL) const;
  // Counts the parts of class inside between two bodies in the same pose. `ignored`: a bit for each part that is left
  // out.
  std::size_t count_inside(const Place& place, std::uint64_t ignored, std::uint64_t ignored_of_other) const;

  const spherechain::baker::OpenAsset& asset() const { return asset_; }

 private:
  std::vector<float> posed(const Place& place, const Place& both) const;

  std::vector<float> rest_;
  std::size_t first_of_b_;
  double apart_;
  bool are_joined_;
  spherechain::baker::OpenAsset asset_;
};

// A place of b, and the one entry of a list.
inline auto shifted(double x, double y, double z) {
  return [=](const spherechain::baker::Vec3& p) {
    return spherechain::baker::Vec3(p + spherechain::baker::Vec3(x, y, z));
  };
}
spherechain::Penetration only(const std::vector<spherechain::Penetration>& found);
