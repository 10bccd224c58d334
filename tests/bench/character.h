// SPDX-License-Identifier: GPL-3.0-or-later
// What everything is timed on: a baked character in real poses.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "motion/motion.h"
#include "pipeline/pipeline.h"
#include "spherechain/asset.h"
#include "spherechain/refit_bones.h"

namespace spherechain::bench {

inline constexpr const char* kHuman = "/usr/share/assimp/models/Collada/human.zae";

struct PosedCharacter {
  std::string name;
  baker::Bake bake;
  Asset asset;                               // a view of `bytes`
  std::vector<std::uint64_t> bytes;          // aligned to 64 bytes from `asset_at` on
  std::vector<baker::Deformation> poses;     // at least 1,024 by default
  std::vector<std::vector<float>> matrices;  // a pose each: asset.bone_count() matrices of 3 by 4, by rows
  std::vector<std::vector<Sphere>> spheres;  // a pose each, refitted from those, with detect radii

  BoneMatrices bones(std::size_t pose) const {
    return {matrices[pose].data(), asset.bone_count(), MatrixLayout::kRowMajor3x4, 48};
  }
  // The deformed vertices in the order of the source, x y z after another.
  std::vector<float> mesh(std::size_t pose) const;
};

// The motions that load() takes its poses from, each named like its file.
struct NamedMotion {
  std::string name;
  std::unique_ptr<baker::Motion> motion;
};
std::vector<NamedMotion> motions_of(const baker::Bake& bake);

// assimp-testmodels' human.zae, baked with the profile "balanced" and `settings` (JSON) on top of it, in the poses of
// samples/poses and of assimp-testmodels' three motion captures, as many of each that the poses are `pose_count`.
// Throws baker::Error.
void load(PosedCharacter& character, const std::string& name, const std::string& settings, std::size_t pose_count);

}  // namespace spherechain::bench
