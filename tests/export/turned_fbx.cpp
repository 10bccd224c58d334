// SPDX-License-Identifier: GPL-3.0-or-later
// turned_fbx SOURCE.fbx OUT.fbx OUT.glb: turns every joint of the skeleton in the middle third of each clip, by an
// angle of its own, and writes the same clips into a copy of the source and into a GLB. Prints the joints that turn.
#include <cmath>
#include <cstdio>
#include <set>

#include "baker/fix/turned_fbx.h"
#include "baker/fix/write_clip.h"
#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "baker/motion/frame_times.h"
#include "baker/os/written_file.h"
#include "baker/play/asset_file.h"

using namespace spherechain::baker;

namespace {

// A third of the clip, in which joint number j turns about an axis of its own, most in the middle.
Turns turns_of(std::size_t joints, int frames, std::vector<char>& in_window) {
  Turns out(joints * static_cast<std::size_t>(frames), Vec3::Zero());
  in_window.assign(static_cast<std::size_t>(frames), 0);
  const int first = frames / 3, last = frames - frames / 3;
  for (int f = first; f < last; ++f) {
    in_window[static_cast<std::size_t>(f)] = 1;
    const double share = std::sin(std::numbers::pi * (f - first + 1) / (last - first + 1));
    for (std::size_t j = 0; j < joints; ++j) {
      const double k = static_cast<double>(j);
      const Vec3 axis = Vec3(std::sin(1 + 2 * k), std::sin(2 + 3 * k), std::sin(3 + 5 * k)).normalized();
      out[static_cast<std::size_t>(f) * joints + j] = share * (0.1 + 0.07 * static_cast<double>(j % 10)) * axis;
    }
  }
  return out;
}

void run(const char* source, const char* fbx_out, const char* glb_out) {
  const SourceMesh mesh = read_source(source);
  const SourceRig& rig = mesh.rig;
  std::string fbx = read_file(source), glb = read_as_glb(source);
  std::set<Index> bones;
  for (const Bone& bone : rig.bones) bones.insert(bone.node);
  std::vector<TurningJoint> joints;
  for (const Index node : bones) {
    joints.push_back({node, Eigen::Matrix3d::Identity(), {}});
    std::printf("%s\n", rig.nodes[node].name.c_str());
  }
  constexpr double kFps = 30;
  for (const Clip& clip : rig.clips) {
    const TurnedClip turned(rig, clip, kFps, frames_in(clip.duration, kFps), joints);
    std::vector<char> in_window;
    const Turns turns = turns_of(joints.size(), turned.frames(), in_window);
    const std::vector<Channel> channels = turned_channels(turned, turns, in_window);
    fbx = with_turned_joints(fbx, source, rig, clip, channels, in_window, kFps);
    glb = with_channels(glb, source, rig, clip.in_file, {}, channels);
  }
  write_atomically(fbx_out, fbx);
  write_atomically(glb_out, glb);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    run(argv[1], argv[2], argv[3]);
  } catch (const Error& error) {
    std::fprintf(stderr, "turned_fbx: %s\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}
