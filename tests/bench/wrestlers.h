// SPDX-License-Identifier: GPL-3.0-or-later
// Two of human.zae that wrestle, in frames of motion captures.
#pragma once

#include <random>
#include <vector>

#include "baker/truth/intersections.h"
#include "character.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::bench {

// Two bodies in a frame.
struct Frame {
  std::vector<float> bones[2];      // SC_ROWS_3X4
  std::vector<float> positions[2];  // as the runtime skins them
  std::vector<Pair> expected;       // CGAL's
};

class Wrestlers {
 public:
  // So many frames of each of three pairs of captures. b stands before a, an arm's length off, and looks at it.
  explicit Wrestlers(int frames);

  const PosedCharacter& human() const { return human_; }
  const std::vector<Frame>& frames() const { return frames_; }
  const std::uint64_t* table() const { return table_.data()->words; }
  const baker::TruthSurface& truth() const { return truth_; }

  // Two bodies of those frames, b turned at will and moved off by up to a quarter of the height along each axis.
  Frame random_placement(std::mt19937& random) const;

 private:
  void add(const baker::Deformation& a, const baker::Deformation& b);
  void skin(Frame& frame, int body) const;
  void make_truth();
  baker::Vec3 middle_of(const std::vector<float>& positions) const;

  PosedCharacter human_;
  Memory table_;
  Surface surface_;
  baker::TruthSurface truth_;
  std::vector<Frame> frames_;
};

// A bone's matrix, SC_ROWS_3X4.
baker::Affine affine_at(const float* bone);
void put(const baker::Affine& bone, float* out);

// Throws std::runtime_error that says what failed.
void require(Status status, const char* what);

}  // namespace spherechain::bench
