// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/results.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/report/vec3_json.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

Vec3 read_vec3(const ordered_json& v) { return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()}; }

ordered_json result_event(const Event& event) {
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
          {"direction", to_json(event.direction)},
          {"point", to_json(event.point)},
          {"eye", event.eye ? ordered_json(to_json(*event.eye)) : ordered_json()},
          {"picture", event.picture},
          {"depths", std::move(depths)}};
}

Event read_result_event(const ordered_json& json) {
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
  event.direction = read_vec3(json.at("direction"));
  event.point = read_vec3(json.at("point"));
  if (!json.at("eye").is_null()) event.eye = read_vec3(json.at("eye"));
  json.at("picture").get_to(event.picture);
  for (const ordered_json& depth : json.at("depths")) event.depths_mm.push_back(depth.get<float>() / 10);
  return event;
}

// A file that a power cut or a full disk left behind is none.
template <typename Result, typename Read>
std::optional<Result> read_whole(const std::string& bytes, const Read& read) {
  const ordered_json json = ordered_json::parse(bytes, nullptr, false);
  if (json.is_discarded()) return {};
  try {
    return read(json);
  } catch (const nlohmann::json::exception&) {
    return {};
  }
}

}  // namespace

std::string to_bytes(const ClipResult& result) {
  ordered_json events = ordered_json::array();
  for (const Event& event : result.events) events.push_back(result_event(event));
  return json_text({{"frames", result.frames},
                    {"between", result.between},
                    {"fps", result.fps},
                    {"loops", result.loops},
                    {"events", events},
                    {"note", result.note},
                    {"unseen", result.unseen},
                    {"continuous", result.continuous}},
                   -1);
}

std::string to_bytes(const CharacterResult& result) {
  return json_text({{"clips", result.clips},
                    {"grade", result.grade},
                    {"fit", result.fit},
                    {"notes", result.notes},
                    {"parts", result.parts}},
                   -1);
}

std::optional<ClipResult> read_clip_result(const std::string& bytes) {
  return read_whole<ClipResult>(bytes, [](const ordered_json& json) {
    ClipResult out;
    json.at("frames").get_to(out.frames);
    json.at("between").get_to(out.between);
    json.at("fps").get_to(out.fps);
    json.at("loops").get_to(out.loops);
    for (const ordered_json& event : json.at("events")) out.events.push_back(read_result_event(event));
    json.at("note").get_to(out.note);
    json.at("unseen").get_to(out.unseen);
    json.at("continuous").get_to(out.continuous);
    return out;
  });
}

std::optional<CharacterResult> read_character_result(const std::string& bytes) {
  return read_whole<CharacterResult>(bytes, [](const ordered_json& json) {
    CharacterResult out;
    json.at("clips").get_to(out.clips);
    json.at("grade").get_to(out.grade);
    json.at("fit").get_to(out.fit);
    json.at("notes").get_to(out.notes);
    json.at("parts").get_to(out.parts);
    return out;
  });
}

}  // namespace spherechain::baker
