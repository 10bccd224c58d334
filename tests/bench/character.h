// SPDX-License-Identifier: GPL-3.0-or-later
// The character that everything is timed on: a baked character in real poses.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "baker/motion/motion.h"
#include "baker/pipeline/pipeline.h"
#include "runtime/src/asset/asset_view.h"
#include "spherechain/pose.h"

namespace spherechain::bench {

inline constexpr const char* kHuman = "/usr/share/assimp/models/Collada/human.zae";

// Memory from a cache line on, as a game would place it.
struct alignas(64) CacheLine {
  std::uint64_t words[8];
};
using Memory = std::vector<CacheLine>;
inline Memory memory_for(std::size_t words) { return Memory((words + 7) / 8); }

struct PosedCharacter {
  std::string name;
  baker::Bake bake;
  Asset asset;  // a view of `bytes`
  Memory bytes;
  std::vector<baker::Deformation> poses;     // at least 1,024 by default
  std::vector<std::vector<float>> matrices;  // a pose each: a bone matrix each, SC_ROWS_3X4
  std::vector<std::vector<Sphere>> spheres;  // a pose each, refitted from those, with detect radii

  const AssetView& view() const { return view_of(asset); }
  std::size_t sphere_count() const { return view().spheres().size; }
  // The bones alone.
  Pose pose(std::size_t i) const;
  // The deformed vertices in the order of the source, x y z after another.
  std::vector<float> mesh(std::size_t i) const;
};

// The motions that load() takes its poses from, each named like its file.
struct NamedMotion {
  std::string name;
  std::unique_ptr<baker::Motion> motion;
};
std::vector<NamedMotion> motions_of(const baker::Bake& bake);

// assimp-testmodels' human.zae, baked with the profile "balanced" and `settings` (JSON) on top of it, in the poses of
// samples/poses and of assimp-testmodels' three motion captures, `pose_count` in all. Throws baker::Error.
void load(PosedCharacter& character, const std::string& name, const std::string& settings, std::size_t pose_count);

}  // namespace spherechain::bench
