// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/play_frames.h"

#include <nlohmann/json.hpp>

namespace spherechain::baker {

nlohmann::ordered_json pairs_json(Span<const Pair> pairs) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const Pair& pair : pairs) out.push_back({pair.a, pair.b});
  return out;
}

nlohmann::ordered_json frame_json(const AnimatedAsset& animated, int index, const FrameResult& result,
                                  const Player& player) {
  nlohmann::ordered_json out{{"index", index}, {"time", animated.time(index)}, {"refit_us", result.refit_us}};
  if (const std::string clip = animated.clip_at(index); !clip.empty()) out["clip"] = clip;
  if (const auto& m1 = result.m1) {
    out["m1"] = {{"tests", m1->tests}, {"pairs", m1->raw_pairs}, {"unique_pairs", m1->pairs}, {"us", m1->us}};
  }
  if (const auto& m2 = result.m2) out["m2"] = {{"tests", m2->tests}, {"pairs", m2->pairs}, {"us", m2->us}};
  out["pairs"] = pairs_json(player.pairs());
  return out;
}

}  // namespace spherechain::baker
