// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "study.h"

namespace spherechain::paper {

// The timed methods. M1 and M2 are plain loops (studies/plain_detection.h) that leave ignored pairs out. The full ones
// are the paper's loops to the letter, n_c n^2 and m^2 comparisons of every sphere with every other. Refit and
// all_pairs are the product's jobs.
enum RunMethod : std::size_t { kRefit, kM1, kM2, kFullM1, kFullM2, kProduct };
inline constexpr std::array<const char*, 6> kMethods{"refit", "M1", "M2", "M1 full", "M2 full", "all_pairs"};

struct Cost {
  std::size_t tests = 0, overlaps = 0;
  double us = 0;  // median over the repetitions
};

struct FrameCost {
  std::size_t animation, frame;
  std::array<Cost, kMethods.size()> methods;  // in the order of kMethods
};

// The running stage on every frame of every animation, on one core, at the paper's radius: a list of frames an asset.
// In each repetition all assets, frames and methods take their turn, so that a disturbance of the machine meets all
// alike.
std::vector<std::vector<FrameCost>> run_frames(const std::vector<std::vector<std::uint8_t>>& assets,
                                               const std::vector<Animation>& animations, int repetitions);

}  // namespace spherechain::paper
