// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/play_frames.h"

#include <nlohmann/json.hpp>

#include "report/json_text.h"

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

PlayFile::PlayFile(const std::filesystem::path& path, const nlohmann::ordered_json& head, int frames)
    : file_(path), left_(frames) {
  std::string text = json_text(head, 1);
  text.resize(text.size() - 2);  // the end, "\n}"
  file_.write(text + ",\n \"frames\": [\n");
}

// Whole lines: a terminal that both the frames and the progress go to shows each on its own.
void PlayFile::add(const nlohmann::ordered_json& frame) {
  const std::string text = json_text(frame, 1);
  std::string inner = "  ";
  for (const char c : text) {
    inner += c;
    if (c == '\n') inner += "  ";
  }
  file_.write(inner + (--left_ > 0 ? ",\n" : "\n ]\n}\n"));
  if (left_ == 0) file_.finish();
}

}  // namespace spherechain::baker
