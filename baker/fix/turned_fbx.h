// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// Throws Error(kUsage) if the bytes of `file` are no FBX file, Error(kFile) if it is none that with_turned_joints
// takes: of another version than 7, or damaged.
void check_turnable_fbx(const std::string& fbx, const std::string& file);

// Throws Error(kFile) if a clip that was read from the file is not what the file shows: where several layers turn a
// joint.
void check_turnable_clips(const std::string& fbx, const std::string& file, const std::vector<const Clip*>& clips);

// Writes new rotations of joints into an FBX file, binary or text: `turned` is what turned_channels makes of the clip
// `before`, which was read from the file with `rig`. In the frames of a window (at `fps`), each turned joint gets keys
// in its three curves; curves that it lacks are added. Between these keys, and from them to the keys beside the window,
// curves become lines. A joint that turns about a pivot gets keys of its translation, too. All else of the file stays
// byte for byte. Throws Error(kFile) that names `file`, the joint and the stack if a joint cannot be turned in the
// file.
std::string with_turned_joints(const std::string& fbx, const std::string& file, const SourceRig& rig,
                               const Clip& before, const std::vector<Channel>& turned,
                               const std::vector<char>& in_window, double fps);

}  // namespace spherechain::baker
