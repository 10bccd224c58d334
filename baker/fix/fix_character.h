// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "baker/check/baseline.h"
#include "baker/check/rules.h"
#include "baker/fix/fix_report.h"
#include "baker/os/work_folder.h"

namespace spherechain::baker {

// Selects the clips and faults of a character that are fixed.
struct FixJob {
  std::string input;
  std::string clip;                                 // one of the character's clips: name or number; empty: all
  std::optional<std::vector<std::size_t>> numbers;  // only these of the character's clips
  std::vector<std::string> recordings;  // retargeted; they replace the character's clips unless `numbers` is set
  bool is_recording_written = false;    // write the one recording, a BVH file, not the character
  bool is_fbx_written = false;          // write the character as the FBX file that it is, not as a GLB; no recordings
  CheckConfig config;
  Baseline baseline;
  std::vector<std::string> parts;  // fix only faults of these body parts; empty: all
  std::vector<Decision> decisions;
  MendOptions mend;
};

// The file whose bones move the character. It is the input, or where that has none and a recording moves it, a copy of
// it with the automatic rig, which lies in `folder`.
struct RiggedSource {
  std::string file;
  std::shared_ptr<WorkFolder> folder;
};

struct FixedCharacter {
  RiggedSource source;
  std::string bytes;  // the fixed file: the character's, or the recording's
  std::vector<MendedClip> clips;
  std::vector<Clip> before, after;         // the same clips in full
  std::string asset;                       // the baked character's bytes
  std::vector<std::string> unused_parts;   // named by a rule, but missing in the character
  bool is_in_baseline = false;             // the baseline has events of these clips
  std::vector<Decision> unused_decisions;  // about no event of these clips
};

// Bakes the character and fixes its clips one after another. `report` receives the current step as text. Throws Error:
// kFile if a file has the wrong content or its format cannot hold the result; kUsage if the character lacks a body
// part; and the errors of a bake.
FixedCharacter fix_character(const FixJob& job, const std::function<void(const std::string&)>& report);

// Retargets the written recording again. Returns the largest distance of the skin from the fixed clip over the
// recording's frames, in mm.
double carried_over_again(const FixedCharacter& fixed, const std::string& input, const std::string& recording);

}  // namespace spherechain::baker
