// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/import/arrays.h"
#include "baker/import/source_rig.h"

namespace spherechain::baker {

// The motion of a person in the tables of AMASS, SMPL, SMPL-H or SMPL-X, or in 6D rotations (Zhou et al. 2019) of their
// joints, as nodes with SMPL's names and a clip. The skeleton rests in SMPL's T-pose, y up, facing z; its proportions
// are those of an average person, because such files hold none. It moves in the file's own axes. Adds a note (notes.h)
// where the file names no frame rate. Nothing where the tables hold no such motion. Throws Error(kFile) that begins
// with `file` where they are incomplete, of an unknown size or not finite.
std::optional<SourceRig> smpl_motion(const Arrays& arrays, const std::string& file);

}  // namespace spherechain::baker
