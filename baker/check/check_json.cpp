// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "baker/check/formats.h"
#include "baker/report/json_text.h"
#include "baker/report/number_json.h"
#include "baker/report/vec3_json.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

ordered_json event_json(const EvaluatedEvent& evaluated) {
  const Event& event = evaluated.event;
  ordered_json out{{"parts", event.parts},
                   {"class", sc_penetration_class_name(event.kind)},
                   {"from", number_json(event.from)},
                   {"to", number_json(event.to)},
                   {"deepest", number_json(event.deepest)},
                   {"depth_mm", event.depth_mm},
                   {"depth_percent", event.depth_percent},
                   {"volume_ml", event.volume_ml >= 0 ? ordered_json(event.volume_ml) : ordered_json()},
                   {"direction", to_json(event.direction)},
                   {"state", state_name(evaluated.state)},
                   {"rule", evaluated.rule.empty() ? ordered_json() : ordered_json(evaluated.rule)},
                   {"fails", evaluated.fails}};
  if (evaluated.before_mm >= 0) out["known_depth_mm"] = evaluated.before_mm;
  if (event.eye) out["camera"] = {{"target", to_json(event.point)}, {"back", to_json(*event.eye)}};
  return out;
}

ordered_json clip_json(const EvaluatedClip& clip) {
  ordered_json events = ordered_json::array();
  for (const EvaluatedEvent& event : clip.events) events.push_back(event_json(event));
  ordered_json besides = ordered_json::object();
  for (const auto& [kind, count] : clip.besides) besides[sc_penetration_class_name(kind)] = count;
  ordered_json out{{"character", clip.character},   {"clip", clip.clip.clip},
                   {"frames", clip.frames},         {"fps", clip.fps},
                   {"loops", clip.loops},           {"events", std::move(events)},
                   {"counted", std::move(besides)}, {"fit", clip.grade}};
  if (!clip.clip.error.empty()) out["error"] = clip.clip.error;
  return out;
}

}  // namespace

std::string check_json(const Verdict& verdict) {
  const Summary& s = verdict.summary;
  ordered_json clips = ordered_json::array();
  for (const EvaluatedClip& clip : verdict.clips) clips.push_back(clip_json(clip));
  return json_text({{"writer", kWriter},
                    {"summary",
                     {{"characters", s.characters},
                      {"clips", s.clips},
                      {"frames", s.frames},
                      {"events", s.events},
                      {"penetrations", s.penetrations},
                      {"deep_folds", s.deep_folds},
                      {"new", s.fresh},
                      {"worse", s.worse},
                      {"accepted", s.accepted},
                      {"resolved", s.resolved},
                      {"errors", s.errors},
                      {"fails", verdict.fails},
                      {"seconds", s.seconds}}},
                    {"clips", std::move(clips)},
                    {"notes", verdict.notes}},
                   1) +
         "\n";
}

}  // namespace spherechain::baker
