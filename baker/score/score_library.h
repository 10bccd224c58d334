// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "baker/check/library.h"
#include "baker/score/score_clip.h"

namespace spherechain::baker {

// Selects what of a library is scored.
struct ScoreJob {
  std::vector<LibraryCharacter> characters;  // their recordings, or where they have none their own clips
  std::string clip;                          // of their own only this one: name or number; empty: all
  // A clip by name, or a recording, that all are compared with; or a folder of recordings, or a character with clips,
  // of which each is compared with the one of its name.
  std::string reference;
  std::set<std::string> metrics;  // empty: all
  double fps = 0;                 // 0: each clip's own
};

struct ScoreRow {
  std::string character;
  ClipScore score;
  std::string error;  // why the clip, or with an empty name the character, has no score
};

// Bakes the characters one after another, and scores their clips, many at a time. `progress` receives the current step
// as text. The rows are in the library's order. Whatever a file does, the others are scored.
std::vector<ScoreRow> score_library(const ScoreJob& job, const std::function<void(const std::string&)>& progress);

// Rows as JSON, and as a table with one column for each metric; rows with an error are in the first alone.
std::string score_json(const std::vector<ScoreRow>& rows, const std::string& reference);
std::string score_csv(const std::vector<ScoreRow>& rows);
// A few columns for a console.
std::string score_text(const std::vector<ScoreRow>& rows);

// A limit of a metric: values on its good side are kept.
struct Limit {
  std::string metric;
  double number;
  bool is_above;  // larger is better
};

// Names of the clips that all limits keep, of those that one drops, and of those that lack a metric: lines of
// "character<TAB>clip".
std::array<std::string, 3> keep_lists(const std::vector<ScoreRow>& rows, const std::vector<Limit>& limits);

}  // namespace spherechain::baker
