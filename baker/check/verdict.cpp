// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/verdict.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "baker/check/tickets.h"

namespace spherechain::baker {
namespace {

bool is_counted_only(PenetrationClass kind) {
  return kind == SC_CLASS_REST || kind == SC_CLASS_SHELL || kind == SC_CLASS_FOLD;
}

using ClipName = std::pair<std::string, std::string>;  // character, clip

class Evaluator {
 public:
  Evaluator(const Baseline& baseline, bool folds, FailOn fail_on)
      : all_(baseline.events), folds_(folds), fail_on_(fail_on) {
    for (std::size_t i = 0; i < all_.size(); ++i) known_[{all_[i].character, all_[i].clip}].push_back(i);
  }

  void events(EvaluatedClip& out, const ClipResult& result, const Rules& rules) const {
    std::vector<std::size_t> known;
    if (const auto found = known_.find({out.character, out.clip.clip}); found != known_.end()) known = found->second;
    std::set<std::size_t> there;
    for (std::size_t i = 0; i < result.events.size(); ++i) {
      const Event& event = result.events[i];
      if (rules.leaves_out(event.parts)) continue;
      if (is_counted_only(event.kind)) ++out.besides[event.kind];
      if (is_counted_only(event.kind) && !folds_) continue;
      EvaluatedEvent evaluated{event, EventState::kKnown, rules.excuse(event), -1, Severity::kIgnore, false, i};
      if (is_fault(event.kind)) evaluate_fault(evaluated, known, there, result.fps, rules);
      out.events.push_back(std::move(evaluated));
    }
    for (const std::size_t i : known) {
      if (there.contains(i) || rules.leaves_out(all_[i].parts) || !is_looked_for(all_[i], result)) continue;
      out.events.push_back(resolved(i, result.fps));
    }
  }

 private:
  void evaluate_fault(EvaluatedEvent& out, const std::vector<std::size_t>& known, std::set<std::size_t>& there,
                      double fps, const Rules& rules) const {
    out.state = EventState::kNew;
    for (const std::size_t i : known) {
      const KnownEvent& one = all_[i];
      if (!is_same(one, out.event, fps)) continue;
      there.insert(i);
      // If several approved events match, the deepest one counts.
      if (is_worse(one, out.event)) {
        if (out.state != EventState::kNew) continue;
        if (one.depth_mm >= out.before_mm) out.known = i;
        out.before_mm = std::max(out.before_mm, one.depth_mm);
        continue;
      }
      out.before_mm = -1;
      if (out.state == EventState::kAccepted) continue;
      out.state = one.state;
      out.known = i;
    }
    out.severity = out.rule.empty() ? rules.severity(out.event.kind) : Severity::kIgnore;
    out.fails =
        out.severity == Severity::kError && (fail_on_ == FailOn::kNew           ? out.state == EventState::kNew
                                             : fail_on_ == FailOn::kPenetration ? out.state != EventState::kAccepted
                                                                                : false);
  }

  EvaluatedEvent resolved(std::size_t number, double fps) const {
    const KnownEvent& known = all_[number];
    EvaluatedEvent out;
    out.known = number;
    out.state = EventState::kResolved;
    Event& event = out.event;
    event.parts = known.parts;
    event.kind = known.kind;
    event.from = std::round(100 * known.from * fps) / 100;
    event.to = std::round(100 * known.to * fps) / 100;
    event.deepest = event.from;
    event.depth_mm = known.depth_mm;
    return out;
  }

  const std::vector<KnownEvent>& all_;
  bool folds_;
  FailOn fail_on_;
  std::map<ClipName, std::vector<std::size_t>> known_;  // numbers among all
};

void count(Summary& out, const EvaluatedClip& clip) {
  ++out.clips;
  out.pokes += static_cast<int>(clip.pokes.size());
  out.frames += clip.frames;
  out.seconds += clip.frames / clip.fps;
  for (const auto& [kind, number] : clip.besides) out.besides[kind] += number;
  for (const EvaluatedEvent& evaluated : clip.events) {
    if (evaluated.state == EventState::kResolved) {
      ++out.resolved;
      continue;
    }
    ++out.events;
    if (!evaluated.is_open()) continue;
    ++(evaluated.event.kind == SC_CLASS_DEEP_FOLD ? out.deep_folds : out.penetrations);
    out.fresh += evaluated.state == EventState::kNew ? 1 : 0;
    out.worse += evaluated.before_mm >= 0 ? 1 : 0;
    out.accepted += evaluated.state == EventState::kAccepted ? 1 : 0;
  }
}

}  // namespace

Verdict evaluate_clips(const std::vector<CheckedClip>& clips, const std::vector<CharacterRules>& characters,
                       const Store& store, const Baseline& baseline, bool folds, FailOn fail_on) {
  const Evaluator by(baseline, folds, fail_on);
  Verdict out;
  out.summary.characters = static_cast<int>(characters.size());
  std::map<std::string, CharacterResult> read;  // by key
  std::set<std::string> noted;                  // of recordings, which several characters play
  for (const CheckedClip& clip : clips) {
    const CharacterRules& of = characters[clip.character];
    EvaluatedClip evaluated{of.name, of.file, {}, {}, clip, 0, 0, 30, false, {}, {}};
    if (clip.error.empty() && !clip.clip.empty()) {
      const std::optional<ClipResult> result = read_clip_result(store.take(clip.key, kResultFile));
      if (!result) store.fail_lost();
      evaluated.frames = result->frames;
      evaluated.between = result->between;
      evaluated.fps = result->fps;
      evaluated.loops = result->loops;
      const bool is_reported = result->note.empty() || !noted.insert(clip.clip).second;
      if (!is_reported) out.notes.push_back(clip.clip + ": " + result->note);
      if (!result->unseen.empty()) out.notes.push_back(of.name + " " + clip.clip + ": " + result->unseen);
      by.events(evaluated, *result, of.rules);
      for (std::size_t i = 0; i < result->pokes.size(); ++i) {
        const PokeEvent& event = result->pokes[i];
        if (!of.rules.leaves_out({event.part, event.part})) evaluated.pokes.push_back({event, i});
      }
      count(out.summary, evaluated);
    }
    if (clip.error.empty() && !clip.character_key.empty()) {
      const auto [character, is_new] = read.try_emplace(clip.character_key);
      if (is_new) {
        const std::string bytes = store.take(clip.character_key, kResultFile);
        character->second = read_character_result(bytes).value_or(CharacterResult());
        for (const std::string& note : character->second.notes) out.notes.push_back(of.name + ": " + note);
      }
      evaluated.grade = character->second.grade;
      evaluated.fit = character->second.fit;
    }
    out.summary.errors += evaluated.clip.error.empty() ? 0 : 1;
    const bool is_broken = !evaluated.clip.error.empty() && fail_on != FailOn::kNone;
    out.fails = out.fails || is_broken ||
                std::any_of(evaluated.events.begin(), evaluated.events.end(), [](const auto& e) { return e.fails; });
    out.clips.push_back(std::move(evaluated));
  }
  out.tickets = find_tickets(out.clips, read);
  std::set<std::string> parts, unknown;
  for (const auto& [key, character] : read) parts.insert(character.parts.begin(), character.parts.end());
  for (const CharacterRules& of : characters) {
    for (const std::string& part : of.rules.named_parts()) {
      if (!parts.empty() && parts.count(part) == 0) unknown.insert(part);
    }
  }
  for (const std::string& part : unknown) {
    out.notes.push_back("a rule names '" + part + "', which no character has (inspect prints their body parts)");
  }
  return out;
}

Baseline accept(const Verdict& verdict, const Baseline& before) {
  Baseline out = before;
  std::vector<int> faults(before.events.size(), 0);  // of each entry: how many are the same as it
  std::vector<char> is_gone(before.events.size(), 0);
  for (const EvaluatedClip& clip : verdict.clips) {
    for (const EvaluatedEvent& evaluated : clip.events) {
      if (evaluated.known == EvaluatedEvent::kNoNumber) continue;
      ++faults[evaluated.known];
      if (evaluated.state == EventState::kResolved) is_gone[evaluated.known] = 1;
    }
  }
  for (const EvaluatedClip& clip : verdict.clips) {
    for (const EvaluatedEvent& evaluated : clip.events) {
      const Event& event = evaluated.event;
      if (!evaluated.is_open() || evaluated.state == EventState::kAccepted) continue;
      KnownEvent accepted{clip.character,        clip.clip.clip,      event.parts,    event.kind,
                          event.from / clip.fps, event.to / clip.fps, event.depth_mm, EventState::kAccepted};
      const bool is_one = evaluated.known != EvaluatedEvent::kNoNumber && faults[evaluated.known] == 1;
      if (is_one) {
        accepted.entry = before.events[evaluated.known].entry;
        out.events[evaluated.known] = std::move(accepted);
      } else {
        out.events.push_back(std::move(accepted));
      }
    }
  }
  std::vector<KnownEvent> left;
  for (std::size_t i = 0; i < out.events.size(); ++i) {
    if (i >= is_gone.size() || is_gone[i] == 0) left.push_back(std::move(out.events[i]));
  }
  out.events = std::move(left);
  return out;
}

}  // namespace spherechain::baker
