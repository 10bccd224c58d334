// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/score.h"

#include <algorithm>

namespace spherechain::baker {

std::optional<double> Score::share(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

double Score::reported_per_frame() const {
  return frames == 0 ? 0 : static_cast<double>(reported) / static_cast<double>(frames);
}

void Score::add(const Score& other) {
  frames += other.frames;
  true_pairs += other.true_pairs;
  found_pairs += other.found_pairs;
  true_frames += other.true_frames;
  any_frames += other.any_frames;
  all_frames += other.all_frames;
  far_pairs += other.far_pairs;
  far_found += other.far_found;
  apart_reported += other.apart_reported;
  apart_right += other.apart_right;
  reported += other.reported;
  right += other.right;
  missed_depth = std::max(missed_depth, other.missed_depth);
}

Score score_frame(const FrameTruth& truth, const std::vector<Pair>& reported,
                  const std::function<bool(const Pair&)>& is_close, const std::function<bool(const Pair&)>& is_apart,
                  const std::function<double(const TrueContact&)>& depth_of) {
  Score score;
  score.frames = 1;
  score.true_pairs = truth.pairs.size();
  score.far_pairs = truth.far.size();
  score.reported = reported.size();
  const auto is_far = [&](const Pair& pair) { return std::binary_search(truth.far.begin(), truth.far.end(), pair); };
  for (const TrueContact& contact : truth.contacts) {
    if (std::binary_search(reported.begin(), reported.end(), contact.spheres)) {
      score.found_pairs += contact.triangles.size();
      score.far_found +=
          static_cast<std::size_t>(std::count_if(contact.triangles.begin(), contact.triangles.end(), is_far));
    } else {
      score.missed_depth = std::max(score.missed_depth, depth_of(contact));
    }
  }
  const auto before = [](const TrueContact& contact, const Pair& pair) { return contact.spheres < pair; };
  for (const Pair& pair : reported) {
    const auto at = std::lower_bound(truth.contacts.begin(), truth.contacts.end(), pair, before);
    const bool is_true = at != truth.contacts.end() && at->spheres == pair;
    const bool is_right = is_true || is_close(pair);
    if (is_right) ++score.right;
    if (!is_apart(pair)) continue;
    ++score.apart_reported;
    if (is_right) ++score.apart_right;
  }
  score.true_frames = score.true_pairs > 0 ? 1 : 0;
  score.any_frames = score.found_pairs > 0 ? 1 : 0;
  score.all_frames = score.true_pairs > 0 && score.found_pairs == score.true_pairs ? 1 : 0;
  return score;
}

}  // namespace spherechain::baker
