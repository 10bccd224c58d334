// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "truth/truth.h"

namespace spherechain::baker {

// Reported pairs of spheres against the truth, over any number of frames. Shares are 1 where there is nothing to find,
// or nothing was reported.
struct Score {
  std::size_t frames = 0;
  std::size_t true_pairs = 0, found_pairs = 0;                  // triangle pairs
  std::size_t true_frames = 0, any_frames = 0, all_frames = 0;  // with a true pair, with one found, with all found
  std::size_t reported = 0, right = 0;                          // sphere pairs; right: with a true pair, or close
  double missed_overlap = 0;                                    // the worst; mesh units

  double pair_recall() const { return share(found_pairs, true_pairs); }
  double frame_any_recall() const { return share(any_frames, true_frames); }
  double frame_all_recall() const { return share(all_frames, true_frames); }
  double precision() const { return share(right, reported); }
  double reported_per_frame() const;

  void add(const Score& other);

 private:
  static double share(std::size_t part, std::size_t whole);
};

// One frame. `reported` is sorted; `is_close` is asked about those without a true pair, `depth_of` about missed
// contacts.
Score score_frame(const FrameTruth& truth, const std::vector<Pair>& reported,
                  const std::function<bool(const Pair&)>& is_close,
                  const std::function<double(const TrueContact&)>& depth_of);

}  // namespace spherechain::baker
