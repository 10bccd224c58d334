// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/pipeline/pipeline.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {

// The bake's steps and results as JSON: import counts, how left and right were decided, every torso sphere's three fits
// with F at every vertex, pivots, radii, both readings of the paper's numbers, time of each stage, peak memory,
// targets.
std::string bake_report_json(const Bake& bake);

// The same in a screenful of text, without the fit's grade.
std::string bake_report_text(const Bake& bake);

// The last line of a bake: the grade of the fit, the parts that it fits badly, and those by the generic fit.
std::string fit_line(const Bake& bake);

// A note with the remedy if hardly any such body has this length; else empty. A body with hands and thighs is a biped,
// from 0.5 to 3 m tall; others may be dragons, and toys are small. `parts` are the names of its body parts. A bake
// whose size the user gave has no note.
std::string unit_note(double metres, const std::vector<std::string>& parts);
std::string unit_note(const Bake& bake);

// The end of that line. `generic` are names of some of a character's `parts`.
std::string generic_fit_text(const std::vector<std::string>& generic, std::size_t parts);

// An asset's contents, as the command line contract has it; `text` for people.
std::string inspect_json(const OpenAsset& asset);
std::string inspect_text(const OpenAsset& asset);

// "paper", "calibrated" or "moments".
const char* refit_name(spherechain::RefitRule rule);

// The role of each node of a rig and the reason for it, as text and as JSON.
std::string roles_text(const SourceRig& rig, const Roles& roles);
std::string roles_json(const SourceRig& rig, const Roles& roles);

}  // namespace spherechain::baker
