// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/play_frames.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/report/number_json.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

ordered_json pairs_json(Span<const Pair> pairs) {
  ordered_json out = ordered_json::array();
  for (const Pair& pair : pairs) out.push_back({pair.a, pair.b});
  return out;
}

ordered_json frame_json(const AnimatedAsset& animated, int index, const FrameResult& result, const Player& player) {
  ordered_json out{{"index", index}, {"time", animated.time(index)}};
  if (const std::string& clip = animated.clip_at(index); !clip.empty()) out["clip"] = clip;
  out["clip_frame"] = number_json(animated.number(index));
  out["refit_us"] = result.refit_us;
  const Detection& all = result.all_pairs;
  out["all_pairs"] = {{"tests", all.tests}, {"pairs", all.pairs}, {"us", all.us}};
  out["pairs"] = pairs_json(player.pairs());
  return out;
}

ordered_json skin_json(const Player& player, const Player::TriangleDetection& skin, const PartContacts& contacts,
                       const PartCounts& counts, bool list_triangles) {
  ordered_json parts = ordered_json::array();
  for (const auto& [pair, count] : counts) {
    parts.push_back({{"a", contacts.name(pair.first)}, {"b", contacts.name(pair.second)}, {"triangle_pairs", count}});
  }
  const std::vector<Pair> spheres = player.spheres_of(skin.pairs);
  ordered_json out{
      {"us", skin.us}, {"parts", std::move(parts)}, {"sphere_pairs", pairs_json({spheres.data(), spheres.size()})}};
  if (list_triangles) {
    ordered_json& triangles = out["triangles"] = ordered_json::array();
    for (const Pair& pair : skin.pairs) triangles.push_back({pair.a, pair.b});
  }
  return out;
}

ordered_json penetrations_json(const AnimatedAsset& animated, const std::vector<Penetration>& penetrations,
                               const PartContacts& contacts) {
  const double mm = mm_per_unit(animated.asset());
  const auto point = [](const SkinPoint& at) {
    return ordered_json{{"position", {at.position.x, at.position.y, at.position.z}},
                        {"triangle", at.triangle},
                        {"weights", at.weights}};
  };
  const auto known = [](double value) { return value >= 0 ? ordered_json(value) : ordered_json(); };
  std::vector<Penetration> worst_first = penetrations;
  std::stable_sort(worst_first.begin(), worst_first.end(), [](const Penetration& l, const Penetration& r) {
    return l.kind != r.kind ? l.kind > r.kind : l.measures.depth > r.measures.depth;
  });
  ordered_json out = ordered_json::array();
  for (const Penetration& found : worst_first) {
    const double ml = std::pow(mm / 10, 3) * double{found.measures.volume};
    out.push_back({{"parts", {contacts.name(found.part), contacts.name(found.other)}},
                   {"class", sc_penetration_class_name(found.kind)},
                   {"depth_mm", mm * double{found.measures.depth}},
                   {"depth_percent", 100 * double{found.measures.depth} / double{found.measures.height}},
                   {"fault_depth_mm", mm * double{found.fault_depth}},
                   {"swallowed", found.measures.swallowed},
                   {"direction", {found.direction.x, found.direction.y, found.direction.z}},
                   {"volume_ml", known(ml)},
                   {"visible", found.measures.visible},
                   {"contour_mm", mm * double{found.measures.contour_length}},
                   {"thickness_mm", known(mm * double{found.measures.thickness})},
                   {"extent", known(double{found.measures.extent})},
                   {"touching", found.measures.touching},
                   {"facing", found.measures.facing},
                   {"rest_distance", found.measures.rest_distance},
                   {"deepest", {point(found.deepest), point(found.deepest_other)}}});
    if (found.measures.through != 0) out.back()["through"] = true;
  }
  return out;
}

PlayFile::PlayFile(const std::filesystem::path& path, const ordered_json& head, int frames)
    : file_(path), left_(frames) {
  std::string text = json_text(head, 1);
  text.resize(text.size() - 2);  // the end, "\n}"
  file_.write(text + ",\n \"frames\": [\n");
}

// Whole lines: a terminal that both the frames and the progress go to shows each on its own.
void PlayFile::add(const ordered_json& frame) {
  const std::string text = json_text(frame, 1);
  std::string inner = "  ";
  for (const char c : text) {
    inner += c;
    if (c == '\n') inner += "  ";
  }
  file_.write(inner + (--left_ > 0 ? ",\n" : "\n ]"));
}

void PlayFile::finish(const ordered_json& tail) {
  std::string text = json_text(tail, 1) + "\n";
  text[0] = ',';  // in place of its brace
  file_.write(text);
  file_.finish();
}

}  // namespace spherechain::baker
