// SPDX-License-Identifier: MIT
// How far must one set of triangles move along a direction to be clear of another? Each pair of triangles blocks an
// interval of the way; the answer is the first place that none of them blocks.
#pragma once

#include "depth/contour.h"
#include "depth/shadow.h"

namespace spherechain {

// Which pairs of triangles count: those that the contact job would report.
struct PairRule {
  const Surface* surface = nullptr;
  Span<const std::uint64_t> ignored, disabled;
  bool apart = true, neighbours = false;

  bool counts(std::uint32_t a, std::uint32_t b) const;
};

// Where the way ends: the pair that blocks it last.
struct WayOut {
  double depth = 0;
  std::uint32_t a = kNoPlace, b = kNoPlace;
  Double3 point_a{}, point_b{};  // on the triangles, before the move: point_a - point_b = depth * direction
  Double3 normal{};              // of the surfaces where they part, along the direction; of unit length, or zero
};

struct Volume {
  double volume = 0;
  double area = 0;  // of what is inside, seen along the direction
};

class Sweep {
 public:
  // `gap`: free places shorter than that are none.
  Sweep(const PosedSkin& skin, const PairRule& rule, double gap) : skin_(skin), rule_(rule), gap_(gap) {}
  void take(WordMemory& memory, std::size_t triangle_count);

  // Sets the triangles. Those that are not finite are left out.
  void set_sides(Span<const std::uint32_t> a, Span<const std::uint32_t> b);
  void keep_all() { set_sides(side_a_, side_b_); }
  // Leaves those that may meet within a move of `depth` in any direction, seen in the last direction.
  void keep_near(double depth);

  // False where the way is not shorter than `bound`: then `out` is the pair that said so.
  bool find(const Double3& direction, const Contour& contour, double bound, WayOut& out);
  // After a find() along its direction: is b, moved so, inside a, or a inside b?
  bool is_enclosed(const WayOut& way, const Contour& contour, double handedness) const;
  // After a find(), along its direction: of b inside a.
  Volume volume(double depth) const;

 private:
  struct Boxes {
    float *low[3] = {}, *high[3] = {};
    std::uint32_t* triangle = nullptr;
    std::size_t count = 0;

    void take(WordMemory& memory, std::size_t capacity);
    void view(const PosedSkin& skin, const View& view);
    void keep(const Boxes& other, double reach);
    void bounds(float (&low_out)[3], float (&high_out)[3]) const;
  };
  void fill_grid();
  void pass(double& depth, WayOut& out, bool& is_longer) const;
  void block(std::uint32_t a, std::uint32_t b, double& depth, WayOut& out) const;
  template <typename Visit>
  void for_neighbours(std::size_t b, const Visit& visit) const;
  void vote(const Span<const std::uint32_t>& side, const Double3* points, std::size_t count, bool up, double handedness,
            int* inside) const;

  const PosedSkin& skin_;
  const PairRule& rule_;
  double gap_;
  View view_{{0, 0, 1}, {0, 0, 0}};
  Span<const std::uint32_t> side_a_, side_b_;
  Boxes a_, b_;
  // a's boxes by where their lower corners are; those larger than four cells apart.
  static constexpr int kCells = 64;
  std::uint32_t *first_in_cell_ = nullptr, *in_cell_ = nullptr, *large_ = nullptr;
  std::size_t large_count_ = 0;
  float top_ = 0;  // of a's boxes
  float cell_[2] = {1, 1}, corner_[2] = {0, 0}, reach_[2] = {0, 0};
  int cells_[2] = {1, 1};
};

}  // namespace spherechain
