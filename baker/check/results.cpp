// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/results.h"

#include <nlohmann/json.hpp>

#include "baker/events/event_json.h"
#include "baker/report/json_text.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

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
  for (const Event& event : result.events) events.push_back(stored_event(event));
  ordered_json pokes = ordered_json::array();
  for (const PokeEvent& event : result.pokes) pokes.push_back(stored_poke(event));
  return json_text({{"frames", result.frames},
                    {"between", result.between},
                    {"fps", result.fps},
                    {"loops", result.loops},
                    {"events", events},
                    {"pokes", pokes},
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
                    {"parts", result.parts},
                    {"limbs", result.limbs}},
                   -1);
}

std::optional<ClipResult> read_clip_result(const std::string& bytes) {
  return read_whole<ClipResult>(bytes, [](const ordered_json& json) {
    ClipResult out;
    json.at("frames").get_to(out.frames);
    json.at("between").get_to(out.between);
    json.at("fps").get_to(out.fps);
    json.at("loops").get_to(out.loops);
    for (const ordered_json& event : json.at("events")) out.events.push_back(read_stored_event(event));
    for (const ordered_json& event : json.at("pokes")) out.pokes.push_back(read_stored_poke(event));
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
    json.at("limbs").get_to(out.limbs);
    return out;
  });
}

}  // namespace spherechain::baker
