// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/motion/motion.h"
#include "baker/pipeline/pipeline.h"
#include "baker/play/asset_file.h"
#include "baker/truth/surface.h"
#include "jobs.h"

namespace spherechain::test {

// assimp-testmodels' human.zae, baked, in frames of its motion capture of a boxer and of samples/poses.
struct MovingHuman {
  struct Frame {
    std::string name;
    std::vector<float> palette;   // SC_ROWS_3X4
    std::vector<float> vertices;  // x y z of each source vertex, rounded to float
  };

  baker::Bake bake;
  baker::OpenAsset asset;
  std::vector<float> rest;  // x y z of each source vertex
  std::vector<Frame> frames;
};

// Baked once for all tests of a run.
const MovingHuman& moving_human();

// Its skin table, prepared once.
const std::uint64_t* human_skin_table();

// Its triangles, for CGAL.
const baker::TruthSurface& truth_surface();

// The frame with the vertices of its triangles as the runtime skins them.
MovingHuman::Frame skinned(MovingHuman::Frame frame);

Pose vertices_of(const std::vector<float>& vertices);
Pose bones_of(const std::vector<float>& palette);
Pose both_of(const MovingHuman::Frame& frame);

// A job on moving_human() in that pose.
SkinContactJob job_of(const Pose& pose, Target target = SC_TARGET_BEST);

// REQUIREs that the job succeeds.
SkinContacts run(const SkinContactJob& job);
StepContacts run(const StepJob& job);

// Each number on its own.
std::vector<float> blended(const std::vector<float>& from, const std::vector<float>& to, double t);

// The contacts' triangles.
std::vector<Pair> triangle_pairs(const SkinContacts& found);

}  // namespace spherechain::test
