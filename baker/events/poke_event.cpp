// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/events/poke_event.h"

#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "baker/report/number_json.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

std::vector<std::vector<std::size_t>> join_spots(const std::vector<FrameSpot>& spots, int gap) {
  std::vector<std::vector<std::size_t>> out;
  std::map<std::tuple<Index, Index, Index>, std::size_t> last;  // event of the pieces and the part
  for (std::size_t i = 0; i < spots.size(); ++i) {
    const std::tuple key(spots[i].spot.inner, spots[i].spot.outer, spots[i].part);
    const auto found = last.find(key);
    if (found == last.end() || spots[i].frame - spots[out[found->second].back()].frame > gap) {
      last[key] = out.size();
      out.emplace_back();
    }
    out[last[key]].push_back(i);
  }
  return out;
}

ordered_json poke_json(const PokeEvent& event) {
  return {{"parts", {event.part, event.part}},
          {"class", "poke"},
          {"pieces", event.pieces},
          {"from", number_json(event.from)},
          {"to", number_json(event.to)},
          {"deepest", number_json(event.worst)},
          {"area_cm2", event.area_cm2},
          {"height_mm", event.height_mm},
          {"camera", {{"target", to_json(event.point)}, {"back", to_json(event.eye)}}}};
}

ordered_json stored_poke(const PokeEvent& event) {
  ordered_json out = poke_json(event);
  out["place"] = event.place;
  return out;
}

PokeEvent read_stored_poke(const ordered_json& json) {
  PokeEvent event;
  event.part = json.at("parts").at(0).get<std::string>();
  json.at("pieces").get_to(event.pieces);
  json.at("from").get_to(event.from);
  json.at("to").get_to(event.to);
  json.at("deepest").get_to(event.worst);
  json.at("place").get_to(event.place);
  json.at("area_cm2").get_to(event.area_cm2);
  json.at("height_mm").get_to(event.height_mm);
  event.point = read_vec3(json.at("camera").at("target"));
  event.eye = read_vec3(json.at("camera").at("back"));
  return event;
}

}  // namespace spherechain::baker
