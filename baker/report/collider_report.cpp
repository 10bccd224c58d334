// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/collider_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace spherechain::baker {

ColliderAlarms collider_alarms_of(const AnimatedAsset& animated) {
  const SourceRig& rig = animated.character().rig;
  if (rig.robot.colliders.empty()) return {};
  return find_collider_alarms(animated.character(), animated.frame_count(), [&](int frame) {
    std::vector<Affine> bones = animated.deformation(frame).bones;
    bones.resize(rig.bones.size(), Affine::Identity());
    return bones;
  });
}

std::string collider_text(const ColliderAlarms& alarms, const AnimatedAsset& animated) {
  if (alarms.poses == 0) return {};
  const auto percent = [&](int count) { return 100.0 * count / alarms.poses; };
  std::string out = fmt::format(
      "the file's colliders intersect in {} of {} frames ({:.1f} %); no meshes do in {} of these ({:.1f} % are false "
      "alarms); they miss meshes in {}\n",
      alarms.any.alarms, alarms.poses, percent(alarms.any.alarms), alarms.any.wrong,
      alarms.any.alarms == 0 ? 0.0 : 100.0 * alarms.any.wrong / alarms.any.alarms, alarms.any.missed);
  std::vector<ColliderAlarms::BonePair> worst = alarms.pairs;
  std::stable_sort(worst.begin(), worst.end(), [](const auto& a, const auto& b) {
    return a.counts.wrong + a.counts.missed > b.counts.wrong + b.counts.missed;
  });
  constexpr std::size_t kNamed = 10;
  for (std::size_t p = 0; p < std::min(worst.size(), kNamed); ++p) {
    const auto& [bones, counts] = worst[p];
    out += fmt::format("  {:<20} {:<20} {} alarms, {} false; {} missed\n", animated.bone_names()[bones[0]],
                       animated.bone_names()[bones[1]], counts.alarms, counts.wrong, counts.missed);
  }
  if (worst.size() > kNamed) out += fmt::format("  and {} pairs more\n", worst.size() - kNamed);
  return out;
}

nlohmann::ordered_json collider_json(const ColliderAlarms& alarms, const AnimatedAsset& animated) {
  const auto counts_json = [](const ColliderAlarms::Counts& counts) {
    return nlohmann::ordered_json{
        {"alarm_frames", counts.alarms}, {"false_alarm_frames", counts.wrong}, {"missed_frames", counts.missed}};
  };
  nlohmann::ordered_json out = counts_json(alarms.any);
  out["pairs"] = nlohmann::ordered_json::array();
  for (const auto& [bones, counts] : alarms.pairs) {
    nlohmann::ordered_json pair{{"links", {animated.bone_names()[bones[0]], animated.bone_names()[bones[1]]}}};
    pair.update(counts_json(counts));
    out["pairs"].push_back(std::move(pair));
  }
  return out;
}

}  // namespace spherechain::baker
