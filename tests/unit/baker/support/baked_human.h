// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/pipeline/pipeline.h"
#include "baker/play/asset_file.h"
#include "baker/play/play.h"

// The MakeHuman body baked once a run with each profile.
const spherechain::baker::Bake& baked_human();        // balanced: refit by moments, extremities
const spherechain::baker::Bake& paper_baked_human();  // paper: the paper's refit

// Its asset, opened.
spherechain::baker::OpenAsset open_asset_of(const spherechain::baker::Bake& bake);

// The deformed source vertices of the demo's two animations, 40 frames each, x y z after another.
struct AnimationFrame {
  std::string animation;
  int frame;
  std::vector<spherechain::baker::Vec3> positions;  // source order
};
const std::vector<AnimationFrame>& animation_frames();
// The last frame of one of samples/poses.
std::vector<spherechain::baker::Vec3> posed_human(const std::string& pose_file);
