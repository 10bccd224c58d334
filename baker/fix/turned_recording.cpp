// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/turned_recording.h"

#include <cmath>

#include "baker/fix/bvh_text.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {

std::string turned_recording(const CarriedMotion& carried, const SourceRig& rig, const Clip& before, const Clip& after,
                             const std::vector<char>& in_window, double fps) {
  constexpr double kUnturnedJoint = 1e-6;  // radians
  const std::string& file = carried.capture().file;
  BvhText bvh(read_file(file), file);
  const std::vector<Node>& nodes = carried.capture().rig.nodes;
  const auto is_open = [&](std::size_t f) { return f < in_window.size() && in_window[f] != 0; };
  for (int frame = 0; frame < bvh.frames(); ++frame) {
    const double seconds = frame * bvh.frame_time();
    const auto here = static_cast<std::size_t>(std::floor(seconds * fps));
    if (!is_open(here) && !is_open(here + 1)) continue;
    const std::vector<Eigen::Quaterniond> from = carried.recorded_rotations(seconds, world_at(rig, before, seconds)),
                                          to = carried.recorded_rotations(seconds, world_at(rig, after, seconds));
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (from[n].angularDistance(to[n]) < kUnturnedJoint) continue;
      const BvhJoint& joint = bvh.joints()[n];
      if (!BvhText::turns_freely(joint)) {
        throw Error(ExitCode::kFile, file + ": the joint '" + nodes[n].name +
                                         "' has no rotations about three axes, it cannot be turned (write a .glb)");
      }
      bvh.turn(frame, joint, bvh.rotation(frame, joint) * (from[n].inverse() * to[n]));
    }
  }
  return bvh.text();
}

}  // namespace spherechain::baker
