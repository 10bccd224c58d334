// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mask/clips.h"

#include <filesystem>

#include "baker/mesh/error.h"
#include "baker/motion/carried_motion.h"
#include "baker/motion/sequence.h"
#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

std::vector<Clip> clips_for_mask(const Character& character, const std::string& file, const ImportOptions& options,
                                 const std::vector<std::string>& recordings,
                                 const std::function<void(const std::string&)>& progress) {
  std::vector<Clip> clips = character.rig.clips;
  if (clips.empty() && recordings.empty()) {
    throw Error(ExitCode::kFile, file + ": has no clips to look at (--motion brings one)");
  }
  if (recordings.empty()) return clips;
  if (character.rig.bones.empty()) {
    throw Error(ExitCode::kFile, file + ": no bones move it, so it cannot follow a recording");
  }
  for (const std::string& recording : recordings) {
    if (is_sequence(recording)) {
      throw Error(ExitCode::kUsage, "--motion: " + recording + " holds meshes, and no joints (name one recording)");
    }
  }
  BakeSettings settings = make_settings("balanced", "{}", file);
  settings.import = options;
  const BodyFrame frame = bake(file, settings, progress).regions.frame;
  for (const std::string& recording : recordings) {
    progress("carrying over");
    Clip clip = carried_motion(recording, character.rig, character.source_positions, frame, file)->clip();
    clip.name = std::filesystem::path(recording).stem().string();
    clips.push_back(std::move(clip));
  }
  return clips;
}

}  // namespace spherechain::baker
