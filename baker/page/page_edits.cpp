// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_edits.h"

#include <nlohmann/json.hpp>

#include "baker/edits/region_axes.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// Why a bake of this asset would refuse edits; null where it would not.
ordered_json refusal(const ordered_json& settings) {
  if (settings.value("prop", false)) return "A prop has no edits: its spheres hold all of it.";
  if (settings.value("refit", "") == "paper") return "The paper's refit has no edits. Bake with the profile balanced.";
  return nullptr;
}

std::vector<std::uint8_t> regions_of_skin(const AnimatedAsset& animated, const std::vector<PageSphere>& spheres) {
  constexpr std::uint8_t kNone = 255;
  const Character& character = animated.character();
  std::vector<std::uint8_t> of_source(character.source_triangles.size(), kNone), out;
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    for (const std::uint32_t t : spheres[s].triangles) of_source[t] = animated.asset()->spheres()[s].region;
  }
  for (const Index source : character.skin_source_triangle) out.push_back(of_source[source]);
  return out;
}

}  // namespace

ordered_json page_edits(const AnimatedAsset& animated, const std::vector<PageSphere>& spheres) {
  ordered_json regions = ordered_json::array();
  for (const RegionAxes& axes : region_axes(animated.frame(), animated.character().skin,
                                            regions_of_skin(animated, spheres), animated.asset()->region_count())) {
    regions.push_back({{"start", to_json(axes.start)},
                       {"axes", {to_json(axes.axis), to_json(axes.across[0]), to_json(axes.across[1])}},
                       {"length", axes.length}});
  }
  const ordered_json settings = ordered_json::parse(animated.asset()->info().settings);
  return {{"regions", std::move(regions)},
          {"baked", settings.contains("edits") ? settings["edits"] : ordered_json()},
          {"refusal", refusal(settings)}};
}

}  // namespace spherechain::baker
