// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "baker/check/baseline.h"
#include "baker/check/rules.h"
#include "baker/check/run.h"

namespace spherechain::baker {

// A library's results by its rules and its baseline.

struct EvaluatedEvent {
  Event event;
  EventState state = EventState::kNew;
  std::string rule;       // the rule that excuses it; empty: none
  double before_mm = -1;  // depth of the known event that it repeats, if it is worse; else -1
  Severity severity = Severity::kIgnore;
  bool fails = false;
  std::size_t number = kNoNumber;  // of the event in the clip; kNoNumber for resolved events
  std::size_t known = kNoNumber;   // the matching entry of the baseline

  static constexpr std::size_t kNoNumber = ~std::size_t{0};
  bool is_open() const { return state != EventState::kResolved && is_fault(event.kind) && rule.empty(); }
};

// Skin that shows through clothes: a warning, whatever rules and baseline say.
struct EvaluatedPoke {
  PokeEvent event;
  std::size_t number;  // among those of the clip
};

struct EvaluatedClip {
  std::string character, file, grade;  // name; path as given; grade of the fit
  std::string fit;                     // the grade as a sentence
  CheckedClip clip;
  int frames = 0, between = 0;  // as of a ClipResult
  double fps = 30;
  bool loops = false;
  std::vector<EvaluatedEvent> events;       // the checked events, then the resolved ones
  std::map<PenetrationClass, int> besides;  // counts of classes that are not listed
  std::vector<EvaluatedPoke> pokes{};       // the largest first
};

struct Summary {
  int characters = 0, clips = 0, events = 0, penetrations = 0, deep_folds = 0, fresh = 0, worse = 0, accepted = 0,
      resolved = 0, errors = 0, pokes = 0;
  long frames = 0;
  double seconds = 0;                       // of motion
  std::map<PenetrationClass, int> besides;  // events of classes that are counted only
};

// One cause to mend, and the open events that it shows in.
struct Ticket {
  struct Shown {
    std::size_t clip, event;  // clips[clip].events[event] of the verdict
  };
  std::string id;                            // the same in later runs, until other parts meet
  std::string title;                         // "hero walk: left hand in hips"
  double severity = 0;                       // of its worst event, see tickets.h
  EventState state = EventState::kAccepted;  // new where one of its events is, else known where one is
  std::vector<Shown> events;                 // the worst first
};

struct Verdict {
  std::vector<EvaluatedClip> clips;
  std::vector<Ticket> tickets;  // the worst first
  Summary summary;
  std::vector<std::string> notes;  // possible mistakes: units, rules for unknown parts
  bool fails = false;              // an event fails, or a file cannot be checked
};

enum class FailOn { kPenetration, kNew, kNone };

// A character's name, file and rules, by its place in the library.
struct CharacterRules {
  std::string name, file;
  Rules rules;
};

// `folds`: folds, shells and contacts as at rest are listed too. Results come from `store`.
Verdict evaluate_clips(const std::vector<CheckedClip>& clips, const std::vector<CharacterRules>& characters,
                       const Store& store, const Baseline& baseline, bool folds, FailOn fail_on);

// `before`, which the verdict is by, with all faults of these clips accepted that no rule excuses. An entry is left out
// if it was looked for and is resolved. One that is accepted already stays as it is, and so does one that a rule
// excuses, that the run did not look for, or that is of another clip.
Baseline accept(const Verdict& verdict, const Baseline& before);

}  // namespace spherechain::baker
