// SPDX-License-Identifier: GPL-3.0-or-later
#include "curve.h"

namespace spherechain::baker {

Curve::Curve(const OpenAsset& asset, Radius radius) : chains_(asset) {
  for (int tenths = 8; tenths <= 20; ++tenths) changes_.push_back({tenths / 10.0, {}});
  for (int tenths = 5; tenths <= 10; ++tenths) changes_.push_back({1, tenths / 10.0});
  for (const RuleChange& change : changes_) rules_.emplace_back(asset, radius, change);
}

std::vector<CurvePoint> Curve::measure(const std::vector<Sphere>& spheres, const FrameTruth& truth,
                                       const std::function<bool(const Pair&)>& is_close,
                                       const std::function<bool(const Pair&)>& is_apart) const {
  const auto no_depth = [](const TrueContact&) { return 0.0; };
  std::vector<CurvePoint> points;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    const std::vector<Pair> pairs = rules_[i].pairs(spheres);
    points.push_back({changes_[i], score_frame(truth, chains_.sharing(pairs), is_close, is_apart, no_depth),
                      score_frame(truth, pairs, is_close, is_apart, no_depth)});
  }
  return points;
}

void add(std::vector<CurvePoint>& sum, const std::vector<CurvePoint>& frame) {
  if (sum.empty()) {
    sum = frame;
    return;
  }
  for (std::size_t i = 0; i < frame.size(); ++i) {
    sum[i].chains.add(frame[i].chains);
    sum[i].all_pairs.add(frame[i].all_pairs);
  }
}

}  // namespace spherechain::baker
