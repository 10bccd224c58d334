// SPDX-License-Identifier: GPL-3.0-or-later
// posed_colliders ASSET SOURCE SHAPE AT_MOST POSES [MOTION]: prints, for evenly spaced poses of the source's clips (or
// of the recording), where each body part stands and which overlap, as JSON on standard output: what a foreign engine
// is compared with. Positions in metres, rotations x y z w, in the axes of the rest pose.
#include <cstdlib>
#include <iostream>

#include "baker/play/play.h"
#include "baker/volumes/fit_volumes.h"
#include "posed_json.h"

using namespace spherechain::baker;
using namespace spherechain::test;
using nlohmann::ordered_json;

int main(int argc, char** argv) try {
  if (argc < 6) return 2;
  MotionChoice motion;
  if (argc > 6) motion.motion = argv[6];
  AnimatedAsset animated(argv[1], argv[2], motion, {std::atoi(argv[5]), 30});
  const Colliders colliders = fit_volumes(animated.asset(), volume_shape(argv[3]), std::atoi(argv[4]));
  ordered_json out = json_of(colliders);
  for (int i = 0; i < animated.frame_count(); ++i) {
    const std::vector<Eigen::Isometry3d> at = posed(colliders, animated.deformation(i).bones);
    add_pose(out, colliders, at, {{"clip", animated.clip_at(i)}, {"seconds", animated.frame_at(i).seconds}});
  }
  std::cout << out.dump() << '\n';
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
