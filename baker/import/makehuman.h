// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "baker/import/import.h"

namespace spherechain::baker {

// A person by MakeHuman's sliders, each from 0 to 1.
struct MakeHumanBody {
  double gender = 0.5;  // 0 a woman, 1 a man
  double age = 0.5;     // 0 a baby, 0.19 a child, 0.5 young, 1 old
  double muscle = 0.5, weight = 0.5, height = 0.5;
  double african = 1.0 / 3, asian = 1.0 / 3, caucasian = 1.0 / 3;  // they add up to 1
};

// The person as a rigged character, in decimetres with y up. `data` is MakeHuman's folder of that name, which the user
// has: 3dobjs/base.obj, targets/macrodetails/*.target as text, rigs/default.mhskel and its weights. Targets that are
// not there move nothing. Reads in a child process. Throws Error(kFile) where the base, the rig or the weights are
// missing or damaged, or no target is there.
SourceMesh make_body(const std::filesystem::path& data, const MakeHumanBody& body);

// The same as a binary glTF, in metres.
std::string make_body_as_glb(const std::filesystem::path& data, const MakeHumanBody& body);

}  // namespace spherechain::baker
