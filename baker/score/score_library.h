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
  std::string reference;                     // a clip by name, or a recording's file, that others are compared with
  std::set<std::string> metrics;             // empty: all
  double fps = 0;                            // 0: each clip's own
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

// Names of the clips that are below all these limits, and of the others: "character<TAB>clip" lines.
std::array<std::string, 2> keep_below(const std::vector<ScoreRow>& rows,
                                      const std::vector<std::pair<std::string, double>>& limits);

}  // namespace spherechain::baker
