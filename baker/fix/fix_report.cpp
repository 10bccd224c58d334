// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/fix_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// The largest turn of a joint in each frame of an improved event; degrees, ascending.
std::vector<double> turns_of(const MendedClip& clip) {
  std::vector<double> out;
  const std::size_t frames = clip.mend.in_window.size(), joints = clip.mend.joints.size();
  std::vector<char> is_mended(frames, 0);
  for (const MendedEvent& event : clip.mend.events) {
    if (event.outcome != MendOutcome::kCleared && event.outcome != MendOutcome::kReduced) continue;
    const auto from = static_cast<std::size_t>(event.before.from), to = static_cast<std::size_t>(event.before.to);
    for (std::size_t f = from; f <= to; ++f) is_mended[f] = 1;
  }
  for (std::size_t f = 0; f < frames; ++f) {
    if (is_mended[f] == 0) continue;
    double most = 0;
    for (std::size_t j = 0; j < joints; ++j) most = std::max(most, clip.mend.turns[f * joints + j].norm());
    out.push_back(to_degrees(most));
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The largest turn over all frames and joints, in degrees.
double most_of(const MendedClip& clip) {
  double most = 0;
  for (const Vec3& turn : clip.mend.turns) most = std::max(most, turn.norm());
  return to_degrees(most);
}

double quantile(const std::vector<double>& ascending, double q) {
  if (ascending.empty()) return 0;
  return ascending[static_cast<std::size_t>(q * static_cast<double>(ascending.size() - 1))];
}

// Advice for each outcome that leaves a fault; empty where none is left.
std::string advice_on(const std::vector<MendedEvent>& events) {
  std::map<MendOutcome, double> left;  // the largest budget that is needed
  for (const MendedEvent& e : events) left[e.outcome] = std::max(left[e.outcome], e.needed_degrees);
  std::string out;
  if (left.contains(MendOutcome::kOverBudget)) {
    const double budget = std::min(180.0, 5 * std::ceil(1.1 * left[MendOutcome::kOverBudget] / 5));
    out += fmt::format("  over_budget: joints would turn farther than they may (try --budget {})\n", budget);
  }
  if (left.contains(MendOutcome::kJointLimits)) {
    out += "  joint_limits: an elbow or a knee would bend the wrong way; no budget helps (change the pose)\n";
  }
  if (left.contains(MendOutcome::kNoWayOut)) {
    out +=
        "  no_way_out: none was found that is steady over all its frames and pushes nothing else in (mend a "
        "shorter piece of the clip, or change the pose)\n";
  }
  return out;
}

std::string event_name(const Event& event) {
  return fmt::format("{}, {} {}-{}", event.parts[0], event.parts[1], static_cast<int>(event.from),
                     static_cast<int>(event.to));
}

// "visible: left hand 42 mm"
std::string acting_text(const Acting& acting) {
  if (acting.verdict == ActingVerdict::kUnchanged) return verdict_name(acting.verdict);
  std::string out = acting.verdict == ActingVerdict::kChangesPose ? "changes the pose" : verdict_name(acting.verdict);
  if (acting.moves_mm.empty()) return out;
  return out + fmt::format(": {} {:.0f} mm", acting.moves_mm.front().first, acting.move_mm());
}

std::string event_row(const MendedClip& clip, std::size_t number) {
  const MendedEvent& e = clip.mend.events[number];
  std::string out = fmt::format("  {:<34} {:>5}-{:<5} {:>6.1f} -> {:>5.1f} mm  {:>5.1f} degrees  {}",
                                e.before.parts[0] + ", " + e.before.parts[1], static_cast<int>(e.before.from),
                                static_cast<int>(e.before.to), e.before.depth_mm, e.depth_after_mm, e.turn_degrees,
                                outcome_name(e.outcome));
  const Acting& acting = clip.event_acting[number];
  if (acting.verdict != ActingVerdict::kUnchanged) out += ", " + acting_text(acting);
  const char* separator = "; stays turned where it meets ";
  for (const std::size_t holder :
       clip.refusals.held_by.empty() ? std::vector<std::size_t>() : clip.refusals.held_by[number]) {
    out += separator + event_name(clip.mend.events[holder].before);
    separator = "; ";
  }
  return out + "\n";
}

std::string clip_text(const MendedClip& clip) {
  std::map<MendOutcome, int> counts;
  std::string rows;
  for (std::size_t e = 0; e < clip.mend.events.size(); ++e) {
    ++counts[clip.mend.events[e].outcome];
    rows += event_row(clip, e);
  }
  for (const Event& fault : clip.refusals.new_faults) {
    rows += fmt::format("  {}: {:.1f} mm deep, which it was not before: what was refused moved out of its way\n",
                        event_name(fault), fault.depth_mm);
  }
  std::string out =
      fmt::format("{}: {} event{}", clip.name, clip.mend.events.size(), clip.mend.events.size() == 1 ? "" : "s");
  for (const auto& [outcome, count] : counts) out += fmt::format(", {} {}", count, outcome_name(outcome));
  if (clip.others > 0) out += fmt::format("; {} of other parts", clip.others);
  const Comparison& compared = clip.mend.compared;
  if (compared.feet_mm >= 0.005) out += fmt::format("; feet move {:.2f} mm", compared.feet_mm);
  const std::vector<double> turns = turns_of(clip);
  return out +
         fmt::format(
             "; turns {:.1f} degrees in the median, {:.1f} in p90, {:.1f} at most; acting {}; {} rounds, {:.1f} s\n{}",
             quantile(turns, 0.5), quantile(turns, 0.9), most_of(clip), acting_text(clip.acting), clip.mend.rounds,
             clip.seconds, rows) +
         advice_on(clip.mend.events);
}

ordered_json acting_json(const Acting& acting) {
  ordered_json moves = ordered_json::object(), turns = ordered_json::object();
  for (const auto& [end, mm] : acting.moves_mm) moves[end] = mm;
  for (const auto& [joint, degrees] : acting.turns) turns[joint] = degrees;
  return {{"from", acting.from},
          {"to", acting.to},
          {"verdict", verdict_name(acting.verdict)},
          {"moves_mm", std::move(moves)},
          {"turns_degrees", std::move(turns)},
          {"step_percent", acting.step_percent}};
}

ordered_json events_json(const MendedClip& clip) {
  ordered_json out = ordered_json::array();
  for (std::size_t i = 0; i < clip.mend.events.size(); ++i) {
    const MendedEvent& e = clip.mend.events[i];
    out.push_back({{"parts", e.before.parts},
                   {"from", static_cast<int>(e.before.from)},
                   {"to", static_cast<int>(e.before.to)},
                   {"deepest", static_cast<int>(e.before.deepest)},
                   {"depth_mm_before", e.before.depth_mm},
                   {"depth_mm_after", e.depth_after_mm},
                   {"turn_degrees", e.turn_degrees},
                   {"outcome", outcome_name(e.outcome)},
                   {"acting", acting_json(clip.event_acting[i])},
                   {"held_by", clip.refusals.held_by.empty() ? std::vector<std::size_t>() : clip.refusals.held_by[i]}});
  }
  return out;
}

ordered_json new_faults_json(const MendedClip& clip) {
  ordered_json out = ordered_json::array();
  for (const Event& fault : clip.refusals.new_faults) {
    out.push_back({{"parts", fault.parts},
                   {"from", static_cast<int>(fault.from)},
                   {"to", static_cast<int>(fault.to)},
                   {"depth_mm", fault.depth_mm}});
  }
  return out;
}

}  // namespace

std::string fix_json(const std::vector<MendedClip>& clips) {
  ordered_json out;
  out["writer"] = kWriter;
  out["clips"] = ordered_json::array();
  for (const MendedClip& clip : clips) {
    const std::vector<double> turns = turns_of(clip);
    out["clips"].push_back(
        {{"clip", clip.name},
         {"events", events_json(clip)},
         {"events_of_other_parts", clip.others},
         {"new_faults", new_faults_json(clip)},
         {"acting", acting_json(clip.acting)},
         {"turn_degrees", {{"median", quantile(turns, 0.5)}, {"p90", quantile(turns, 0.9)}, {"max", most_of(clip)}}},
         {"feet_mm", clip.mend.compared.feet_mm},
         {"feet_degrees", clip.mend.compared.feet_degrees},
         {"jerk_ratio", clip.mend.compared.jerk_ratio},
         {"volume_cm3_before", clip.mend.volume_before},
         {"volume_cm3_after", clip.mend.volume_after},
         {"shallow_contacts", clip.mend.shallow},
         {"shallow_contacts_still_near", clip.mend.still_near},
         {"seconds", clip.seconds}});
  }
  return json_text(out, 1) + "\n";
}

std::string page_events(const MendedClip& clip) { return json_text(events_json(clip), -1); }

// Clips without an event are counted.
std::string fix_text(const std::vector<MendedClip>& clips) {
  std::string out;
  int clean = 0;
  for (const MendedClip& clip : clips) {
    if (clip.mend.events.empty() && clip.others == 0) {
      ++clean;
    } else {
      out += clip_text(clip);
    }
  }
  if (clean == 0) return out;
  const bool is_one = clips.size() == 1;
  return out + fmt::format("{} of {} clip{} no event: left as {} is\n", clean, clips.size(), is_one ? " has" : "s have",
                           is_one ? "it" : "each");
}

std::string fix_line(const std::vector<MendedClip>& clips) {
  std::map<MendOutcome, int> counts;
  std::size_t events = 0;
  for (const MendedClip& clip : clips) {
    events += clip.mend.events.size();
    for (const MendedEvent& event : clip.mend.events) ++counts[event.outcome];
  }
  std::string out =
      fmt::format("{} clip{}, {} event{}", clips.size(), clips.size() == 1 ? "" : "s", events, events == 1 ? "" : "s");
  const char* separator = ": ";
  for (const auto& [outcome, count] : counts) {
    out += fmt::format("{}{} {}", separator, count, outcome_name(outcome));
    separator = ", ";
  }
  return out;
}

bool changes_any(const std::vector<MendedClip>& clips) {
  return !std::all_of(clips.begin(), clips.end(), [](const MendedClip& clip) { return clip.mend.is_still(); });
}

bool leaves_faults(const std::vector<MendedClip>& clips) {
  return std::any_of(clips.begin(), clips.end(), [](const MendedClip& clip) {
    return !clip.refusals.new_faults.empty() ||
           std::any_of(clip.mend.events.begin(), clip.mend.events.end(), [](const MendedEvent& e) {
             return e.outcome != MendOutcome::kCleared && e.outcome != MendOutcome::kFold &&
                    e.outcome != MendOutcome::kAccepted && e.outcome != MendOutcome::kRefused;
           });
  });
}

}  // namespace spherechain::baker
