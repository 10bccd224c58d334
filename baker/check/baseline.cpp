// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/baseline.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "check/class_names.h"
#include "mesh/error.h"
#include "play/asset_file.h"
#include "report/json_text.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// An event over a loop's seam is both at the start and at the end.
bool overlap(double from_a, double to_a, double from_b, double to_b) {
  if (from_a > to_a) return overlap(0, to_a, from_b, to_b) || overlap(from_a, 1e9, from_b, to_b);
  if (from_b > to_b) return overlap(from_a, to_a, 0, to_b) || overlap(from_a, to_a, from_b, 1e9);
  return from_a <= to_b && from_b <= to_a;
}

KnownEvent read_known_event(const ordered_json& json) {
  KnownEvent out{};
  json.at("character").get_to(out.character);
  json.at("clip").get_to(out.clip);
  json.at("parts").get_to(out.parts);
  out.kind = class_of_name(json.at("class").get<std::string>());
  json.at("from_seconds").get_to(out.from);
  json.at("to_seconds").get_to(out.to);
  json.at("depth_mm").get_to(out.depth_mm);
  out.state = json.at("state") == "accepted" ? EventState::kAccepted : EventState::kKnown;
  return out;
}

}  // namespace

const char* state_name(EventState state) {
  switch (state) {
    case EventState::kNew:
      return "new";
    case EventState::kKnown:
      return "known";
    case EventState::kAccepted:
      return "accepted";
    case EventState::kResolved:
      break;
  }
  return "resolved";
}

Baseline read_baseline(const std::string& file, bool may_be_missing) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    if (may_be_missing) return {};
    throw Error(ExitCode::kFile, file + ": no such file (--accept writes it)");
  }
  const ordered_json json = ordered_json::parse(read_file(file), nullptr, false);
  Baseline out;
  try {
    for (const ordered_json& event : json.at("spherechain_baseline")) out.events.push_back(read_known_event(event));
  } catch (const nlohmann::json::exception&) {
    throw Error(ExitCode::kFile, file + ": is no baseline (--accept writes one)");
  }
  return out;
}

std::string to_bytes(const Baseline& baseline) {
  ordered_json events = ordered_json::array();
  for (const KnownEvent& event : baseline.events) {
    events.push_back({{"character", event.character},
                      {"clip", event.clip},
                      {"parts", event.parts},
                      {"class", sc_penetration_class_name(event.kind)},
                      {"from_seconds", event.from},
                      {"to_seconds", event.to},
                      {"depth_mm", event.depth_mm},
                      {"state", state_name(event.state)}});
  }
  return json_text({{"spherechain_baseline", events}}, 1) + "\n";
}

bool is_same(const KnownEvent& known, const Event& event, double fps) {
  const bool same_parts =
      known.parts == event.parts || (known.parts[0] == event.parts[1] && known.parts[1] == event.parts[0]);
  const double half = 0.5 / fps;  // an event of one frame has a length, too
  return same_parts && overlap(known.from - half, known.to + half, event.from / fps - half, event.to / fps + half);
}

bool is_worse(const KnownEvent& known, const Event& event) {
  return event.kind > known.kind || event.depth_mm > 1.1 * known.depth_mm + 1;
}

}  // namespace spherechain::baker
