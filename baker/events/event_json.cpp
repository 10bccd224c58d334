// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/events/event_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/report/number_json.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {

using nlohmann::ordered_json;

ordered_json event_json(const Event& event) {
  ordered_json out{{"parts", event.parts},
                   {"class", sc_penetration_class_name(event.kind)},
                   {"from", number_json(event.from)},
                   {"to", number_json(event.to)},
                   {"deepest", number_json(event.deepest)},
                   {"depth_mm", event.depth_mm},
                   {"depth_percent", event.depth_percent},
                   {"swallowed", event.swallowed},
                   {"volume_ml", event.volume_ml >= 0 ? ordered_json(event.volume_ml) : ordered_json()},
                   {"direction", to_json(event.direction)}};
  if (event.passes_through) out["through"] = true;
  if (event.eye) out["camera"] = {{"target", to_json(event.point)}, {"back", to_json(*event.eye)}};
  return out;
}

ordered_json stored_event(const Event& event) {
  ordered_json depths = ordered_json::array();  // in tenths of a millimetre
  for (const float depth : event.depths_mm) depths.push_back(std::lround(10 * depth));
  return {{"parts", event.parts},
          {"class", static_cast<int>(event.kind)},
          {"from", event.from},
          {"to", event.to},
          {"deepest", event.deepest},
          {"first_place", event.first_place},
          {"place", event.place},
          {"depth_mm", event.depth_mm},
          {"depth_percent", event.depth_percent},
          {"volume_ml", event.volume_ml},
          {"swallowed", event.swallowed},
          {"through", event.passes_through},
          {"direction", to_json(event.direction)},
          {"point", to_json(event.point)},
          {"eye", event.eye ? ordered_json(to_json(*event.eye)) : ordered_json()},
          {"picture", event.picture},
          {"depths", std::move(depths)}};
}

Event read_stored_event(const ordered_json& json) {
  Event event;
  json.at("parts").get_to(event.parts);
  event.kind = static_cast<PenetrationClass>(json.at("class").get<int>());
  json.at("from").get_to(event.from);
  json.at("to").get_to(event.to);
  json.at("deepest").get_to(event.deepest);
  json.at("first_place").get_to(event.first_place);
  json.at("place").get_to(event.place);
  json.at("depth_mm").get_to(event.depth_mm);
  json.at("depth_percent").get_to(event.depth_percent);
  json.at("volume_ml").get_to(event.volume_ml);
  json.at("swallowed").get_to(event.swallowed);
  json.at("through").get_to(event.passes_through);
  event.direction = read_vec3(json.at("direction"));
  event.point = read_vec3(json.at("point"));
  if (!json.at("eye").is_null()) event.eye = read_vec3(json.at("eye"));
  json.at("picture").get_to(event.picture);
  for (const ordered_json& depth : json.at("depths")) event.depths_mm.push_back(depth.get<float>() / 10);
  return event;
}

}  // namespace spherechain::baker
