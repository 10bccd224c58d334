// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "baker/truth/truth.h"

namespace spherechain::baker {

// Reported pairs of spheres against the truth, over any number of frames. A recall of what is not there is none, and a
// precision of no reports neither.
struct Score {
  std::size_t frames = 0;
  std::size_t true_pairs = 0, found_pairs = 0;                  // triangle pairs
  std::size_t true_frames = 0, any_frames = 0, all_frames = 0;  // with a true pair, with one found, with all found
  std::size_t far_pairs = 0, far_found = 0;                     // triangle pairs between parts that are far
  std::size_t reported = 0, right = 0;                          // sphere pairs; right: with a true pair, or close
  std::size_t apart_reported = 0, apart_right = 0;              // those whose skins are apart at rest
  double missed_depth = 0;                                      // the deepest fault; mesh units

  std::optional<double> pair_recall() const { return share(found_pairs, true_pairs); }
  std::optional<double> far_recall() const { return share(far_found, far_pairs); }
  std::optional<double> frame_any_recall() const { return share(any_frames, true_frames); }
  std::optional<double> frame_all_recall() const { return share(all_frames, true_frames); }
  std::optional<double> precision() const { return share(right, reported); }
  std::optional<double> apart_precision() const { return share(apart_right, apart_reported); }
  double reported_per_frame() const;

  void add(const Score& other);

 private:
  static std::optional<double> share(std::size_t part, std::size_t whole);
};

// One frame. `reported` is sorted. `is_close` is asked about those without a true pair, `is_apart` whether the skins of
// two spheres are apart at rest, `depth_of` about missed contacts.
Score score_frame(const FrameTruth& truth, const std::vector<Pair>& reported,
                  const std::function<bool(const Pair&)>& is_close, const std::function<bool(const Pair&)>& is_apart,
                  const std::function<double(const TrueContact&)>& depth_of);

}  // namespace spherechain::baker
