// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/palette_file.h"

#include <fmt/format.h>

#include "baker/mesh/error.h"
#include "baker/play/skin_player.h"

namespace spherechain::baker {
namespace {

constexpr const char* kLayout =
    "palettes[frame, joint] is a matrix of 3 rows and 4 columns that is applied to a column (x, y, z, 1): the joint's "
    "world matrix times its inverse bind matrix, in the units and axes of the source's file";

constexpr std::size_t kMatrixFloats = 12;

}  // namespace

PaletteFile::PaletteFile(const std::filesystem::path& path, const AnimatedAsset& animated)
    : animated_(animated), file_(path) {
  if (!moved_by_bones(animated.asset(), animated.deformation(0))) {
    throw Error(ExitCode::kFile, path.string() + ": no bones move " + animated.file() +
                                     " in this motion, so there are no palettes (meshes as frames have none)");
  }
  const std::size_t frame = 4 * kMatrixFloats * animated.asset()->bone_count();
  const auto frames = static_cast<std::size_t>(animated.frame_count());
  if (frames * frame > NpzFile::kTableMax) {
    throw Error(ExitCode::kFile, fmt::format("{}: {} frames would have more than 1 GB ({} at most: --clip, --frames)",
                                             path.string(), frames, NpzFile::kTableMax / frame));
  }
}

void PaletteFile::add(int frame, const Deformation& deformation) {
  const std::vector<float> palette = bone_palette(animated_.asset(), deformation);
  palettes_.insert(palettes_.end(), palette.begin(), palette.end());
  for (std::size_t m = 0; m < animated_.asset()->morph_count(); ++m) {
    morphs_.push_back(m < deformation.morphs.size() ? static_cast<float>(deformation.morphs[m]) : 0);
  }
  clips_.push_back(static_cast<std::int32_t>(animated_.frame_at(frame).clip));
  numbers_.push_back(animated_.number(frame));
  times_.push_back(animated_.frame_at(frame).seconds);
}

void PaletteFile::finish() {
  const OpenAsset& asset = animated_.asset();
  const std::size_t frames = clips_.size(), bones = asset->bone_count(), morphs = asset->morph_count();
  std::vector<std::string> joints, names, morph_names;
  std::vector<float> inverse_bind;
  for (std::size_t b = 0; b < bones; ++b) {
    joints.emplace_back(asset->bone(b).name);
    inverse_bind.insert(inverse_bind.end(), asset->bone(b).inverse_bind, asset->bone(b).inverse_bind + kMatrixFloats);
  }
  for (std::size_t m = 0; m < morphs; ++m) morph_names.emplace_back(asset->morph_name(m));
  std::vector<double> rates;
  for (const ClipFrames& clip : animated_.clips()) {
    names.push_back(clip.name);
    rates.push_back(clip.fps);
  }
  file_.add("layout", std::string(kLayout));
  file_.add("joints", joints);
  file_.add("inverse_bind", inverse_bind, {bones, 3, 4});
  file_.add("palettes", palettes_, {frames, bones, 3, 4});
  file_.add("morphs", morph_names);
  file_.add("morph_weights", morphs_, {frames, morphs});
  file_.add("clips", names);
  file_.add("fps", rates);
  file_.add("clip", clips_);
  file_.add("frame", numbers_);
  file_.add("time", times_);
  file_.finish();
}

}  // namespace spherechain::baker
