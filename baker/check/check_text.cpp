// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "baker/check/formats.h"
#include "baker/play/motion_frames.h"

namespace spherechain::baker {
namespace {

std::string clip_text(const EvaluatedClip& clip) {
  return clip.character + (clip.clip.clip.empty() ? "" : " " + clip.clip.clip);
}

std::string marks(const EvaluatedEvent& evaluated) {
  std::string out;
  const auto add = [&](const std::string& text) { out += (out.empty() ? "  [" : ", ") + text; };
  const PenetrationClass kind = evaluated.event.kind;
  if (kind == SC_CLASS_DEEP_FOLD) add("deep fold");
  if (kind == SC_CLASS_INSIDE) {
    add(fmt::format("{}{:.0f} % inside", evaluated.event.passes_through ? "goes through, " : "",
                    100 * evaluated.event.swallowed));
  }
  if (!is_fault(kind)) add(kind == SC_CLASS_REST ? "as at rest" : sc_penetration_class_name(kind));
  if (evaluated.before_mm >= 0) add(worse_text(evaluated));
  if (!evaluated.rule.empty()) add(evaluated.rule);
  if (is_fault(kind) && evaluated.state != EventState::kNew) add(state_name(evaluated.state));
  return out.empty() ? out : out + "]";
}

std::string counted(int count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

// A line for each two pieces, the largest spot first:
// "hero.glb walk  poke-through: 3 spots of body through shirt, worst 12 cm2 at abdomen, frames 40-65"
std::string pokes_text(const EvaluatedClip& clip) {
  std::vector<std::pair<const PokeEvent*, int>> pairs;  // the largest, and how many there are
  for (const EvaluatedPoke& poke : clip.pokes) {
    const auto same =
        std::ranges::find_if(pairs, [&](const auto& of) { return of.first->pieces == poke.event.pieces; });
    if (same == pairs.end()) {
      pairs.emplace_back(&poke.event, 1);
    } else {
      ++same->second;
    }
  }
  std::string out;
  for (const auto& [worst, count] : pairs) {
    const std::string frames = worst->from == worst->to
                                   ? "frame " + frame_text(worst->from)
                                   : "frames " + frame_text(worst->from) + "-" + frame_text(worst->to);
    out += fmt::format("{}  poke-through: {} of {} through {}, worst {:.0f} cm2{}, {}\n", clip_text(clip),
                       counted(count, "spot", "spots"), worst->pieces[0], worst->pieces[1], worst->area_cm2,
                       worst->part.empty() ? "" : " at " + worst->part, frames);
  }
  return out;
}

std::string summary_text(const Summary& s, std::size_t tickets) {
  std::string out =
      fmt::format("{}, {}, {} frames: {}", counted(s.characters, "character", "characters"),
                  counted(s.clips, "clip", "clips"), s.frames, counted(s.penetrations, "penetration", "penetrations"));
  if (s.deep_folds > 0) out += ", " + counted(s.deep_folds, "deep fold", "deep folds");
  if (tickets > 0) out += " in " + counted(static_cast<int>(tickets), "ticket", "tickets");
  out += fmt::format("; {} new", s.fresh);
  if (s.worse > 0) out += fmt::format(" ({} worse than before)", s.worse);
  if (s.accepted > 0) out += fmt::format(", {} accepted", s.accepted);
  if (s.resolved > 0) out += fmt::format(", {} resolved", s.resolved);
  if (s.clips == 0) out += "; no clip was played (--motion brings recordings)";
  if (s.errors > 0) out += "; " + counted(s.errors, "row", "rows") + " could not be checked";
  std::string besides;
  const auto beside = [&](PenetrationClass kind, const char* one, const char* many) {
    const auto found = s.besides.find(kind);
    if (found != s.besides.end()) besides += (besides.empty() ? "" : ", ") + counted(found->second, one, many);
  };
  beside(SC_CLASS_FOLD, "fold", "folds");
  beside(SC_CLASS_SHELL, "shell", "shells");
  beside(SC_CLASS_REST, "contact as at rest", "contacts as at rest");
  if (s.pokes > 0) besides += (besides.empty() ? "" : ", ") + counted(s.pokes, "spot", "spots") + " of poke-through";
  return out + (besides.empty() ? "" : "\nbesides: " + besides) + "\n";
}

}  // namespace

std::string parts_text(const Event& event) {
  return event.parts[0] == event.parts[1] ? event.parts[0] + " in itself" : event.parts[0] + " in " + event.parts[1];
}

std::string poke_text(const PokeEvent& event) {
  return event.pieces[0] + " through " + event.pieces[1] + (event.part.empty() ? "" : " at " + event.part);
}

std::string frames_text(const Event& event) {
  if (event.from == event.to) return "frame " + frame_text(event.from);
  const std::size_t faulty = faulty_frames(event);
  const bool is_all = faulty == 0 || faulty == event.depths_mm.size();
  return fmt::format("frames {}-{}{}{}", frame_text(event.from), frame_text(event.to),
                     event.from > event.to ? " (over the loop)" : "", is_all ? "" : fmt::format(", {} faulty", faulty));
}

std::string worse_text(const EvaluatedEvent& evaluated) {
  return evaluated.before_mm < 0 ? std::string() : fmt::format("worse than {:.0f} mm", evaluated.before_mm);
}

std::string check_text(const Verdict& verdict, bool only_new) {
  std::vector<std::array<std::string, 4>> rows;
  std::array<std::size_t, 4> widths{};
  const auto add = [&](const char* indent, const EvaluatedClip& clip, const EvaluatedEvent& evaluated) {
    const Event& event = evaluated.event;
    const std::string percent =
        evaluated.state == EventState::kResolved ? "" : fmt::format(", {:.1f} %", event.depth_percent);
    const std::string worst = event.from == event.to || evaluated.state == EventState::kResolved
                                  ? ""
                                  : fmt::format("  (worst at {})", frame_text(event.deepest));
    rows.push_back({indent + clip_text(clip), frames_text(event), parts_text(event),
                    fmt::format("{:.0f} mm{}{}{}", event.depth_mm, percent, worst, marks(evaluated))});
    for (std::size_t k = 0; k < 3; ++k) widths[k] = std::max(widths[k], rows.back()[k].size());
  };
  for (const Ticket& ticket : verdict.tickets) {
    bool is_first = true;
    for (const auto& [c, e] : ticket.events) {
      const EvaluatedEvent& evaluated = verdict.clips[c].events[e];
      if (only_new && evaluated.state != EventState::kNew) continue;
      add(is_first ? "" : "  ", verdict.clips[c], evaluated);
      is_first = false;
    }
  }
  std::string errors;
  for (const EvaluatedClip& clip : verdict.clips) {
    if (!clip.clip.error.empty()) {
      errors += clip.clip.error + (clip.clip.clip.empty() ? "" : "  (" + clip_text(clip) + ")") + "\n";
    }
    for (const EvaluatedEvent& evaluated : clip.events) {
      if (!only_new && !evaluated.is_open() && evaluated.event.kind != SC_CLASS_TOUCH) add("", clip, evaluated);
    }
  }
  std::string out;
  for (const auto& row : rows) {
    for (std::size_t k = 0; k < 3; ++k) out += fmt::format("{:{}}  ", row[k], widths[k]);
    out += row[3] + "\n";
  }
  for (const EvaluatedClip& clip : verdict.clips) {
    if (!only_new) out += pokes_text(clip);
  }
  for (const std::string& note : verdict.notes) errors += "note: " + note + "\n";
  return out + errors + (out.empty() && errors.empty() ? "" : "\n") +
         summary_text(verdict.summary, verdict.tickets.size());
}

}  // namespace spherechain::baker
