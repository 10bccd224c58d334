// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/check/formats.h"
#include "baker/events/event_json.h"
#include "baker/report/json_text.h"
#include "baker/report/number_json.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

ordered_json evaluated_json(const EvaluatedEvent& evaluated) {
  ordered_json out = event_json(evaluated.event);
  out["state"] = state_name(evaluated.state);
  out["rule"] = evaluated.rule.empty() ? ordered_json() : ordered_json(evaluated.rule);
  out["fails"] = evaluated.fails;
  if (evaluated.before_mm >= 0) out["known_depth_mm"] = evaluated.before_mm;
  return out;
}

ordered_json clip_json(const EvaluatedClip& clip) {
  ordered_json events = ordered_json::array();
  for (const EvaluatedEvent& event : clip.events) events.push_back(evaluated_json(event));
  for (const EvaluatedPoke& poke : clip.pokes) {
    ordered_json& event = events.emplace_back(poke_json(poke.event));
    event["state"] = state_name(EventState::kKnown);
    event["rule"] = nullptr;
    event["fails"] = false;
  }
  ordered_json besides = ordered_json::object();
  for (const auto& [kind, count] : clip.besides) besides[sc_penetration_class_name(kind)] = count;
  ordered_json out{{"character", clip.character},   {"clip", clip.clip.clip},
                   {"frames", clip.frames},         {"fps", clip.fps},
                   {"loops", clip.loops},           {"events", std::move(events)},
                   {"counted", std::move(besides)}, {"fit", clip.grade}};
  if (!clip.clip.error.empty()) out["error"] = clip.clip.error;
  return out;
}

ordered_json ticket_json(const Ticket& ticket, const Verdict& verdict) {
  ordered_json events = ordered_json::array(), names = ordered_json::array();
  for (const auto& [c, e] : ticket.events) {
    const EvaluatedClip& clip = verdict.clips[c];
    if (std::find(names.begin(), names.end(), clip.clip.clip) == names.end()) names.push_back(clip.clip.clip);
    events.push_back({{"clip", clip.clip.clip}, {"event", e}});
  }
  const EvaluatedClip& worst = verdict.clips[ticket.events[0].clip];
  const Event& event = worst.events[ticket.events[0].event].event;
  return {{"id", ticket.id},
          {"title", ticket.title},
          {"severity", ticket.severity},
          {"character", worst.character},
          {"parts", event.parts},
          {"clips", std::move(names)},
          {"events", std::move(events)},
          {"worst",
           {{"clip", worst.clip.clip},
            {"frame", number_json(event.deepest)},
            {"class", sc_penetration_class_name(event.kind)},
            {"depth_mm", event.depth_mm},
            {"depth_percent", event.depth_percent}}},
          {"state", state_name(ticket.state)}};
}

}  // namespace

std::string check_json(const Verdict& verdict) {
  const Summary& s = verdict.summary;
  ordered_json clips = ordered_json::array();
  for (const EvaluatedClip& clip : verdict.clips) clips.push_back(clip_json(clip));
  ordered_json tickets = ordered_json::array();
  for (const Ticket& ticket : verdict.tickets) tickets.push_back(ticket_json(ticket, verdict));
  return json_text({{"writer", kWriter},
                    {"summary",
                     {{"characters", s.characters},
                      {"clips", s.clips},
                      {"frames", s.frames},
                      {"events", s.events},
                      {"tickets", verdict.tickets.size()},
                      {"penetrations", s.penetrations},
                      {"deep_folds", s.deep_folds},
                      {"pokes", s.pokes},
                      {"new", s.fresh},
                      {"worse", s.worse},
                      {"accepted", s.accepted},
                      {"resolved", s.resolved},
                      {"errors", s.errors},
                      {"fails", verdict.fails},
                      {"seconds", s.seconds}}},
                    {"tickets", std::move(tickets)},
                    {"clips", std::move(clips)},
                    {"notes", verdict.notes}},
                   1) +
         "\n";
}

}  // namespace spherechain::baker
