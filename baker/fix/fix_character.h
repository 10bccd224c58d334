// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "check/baseline.h"
#include "check/rules.h"
#include "fix/fix_report.h"

namespace spherechain::baker {

// Selects the clips and faults of a character that are fixed.
struct FixJob {
  std::string input;
  std::string clip;                                 // of its own: name or number; empty: all
  std::optional<std::vector<std::size_t>> numbers;  // of all of its own only these
  std::vector<std::string> recordings;              // carried over; without `numbers` in place of its own
  bool is_recording_written = false;                // the one recording, a BVH file, in place of the character
  CheckConfig config;
  Baseline baseline;
  std::vector<std::string> parts;  // only faults of these body parts; empty: of all
  MendOptions mend;
};

struct FixedCharacter {
  std::string bytes;  // of the file with its clips mended: the character's, or the recording's
  std::vector<MendedClip> clips;
  std::vector<Clip> before, after;  // the same, whole
  std::vector<BodyPart> parts;
  std::string asset;                      // bytes of the character's
  std::vector<std::string> unused_parts;  // that a rule names, and the character has not
  bool is_in_baseline = false;            // events of these clips are
};

// Bakes the character and mends its clips one after another. `told` is called with what is being done. Throws Error:
// kFile where a file has the wrong content or cannot be written so; kUsage where the character has no such body part;
// what a bake throws.
FixedCharacter fix_character(const FixJob& job, const std::function<void(const std::string&)>& told);

// Carries the recording that was written over again. Returns how far the skin is at most from the mended clip, in the
// recording's frames; mm.
double carried_over_again(const FixedCharacter& fixed, const std::string& input, const std::string& recording);

}  // namespace spherechain::baker
