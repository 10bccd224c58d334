// SPDX-License-Identifier: MIT
// hello ASSET.sphc MODEL.glb: which body parts are inside each other, frame by frame. One page to copy from.
#include <cstdio>
#include <stdexcept>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

[[noreturn]] static void fail(const char* message) { throw std::runtime_error(message); }

static void play(const std::vector<char>& file, const samples::GltfCharacter& rig) {
  // [hello]
  const std::vector<spherechain::Bone> joints = rig.joints();  // your skeleton: names and inverse bind matrices
  spherechain::Model model(file.data(), file.size(), joints.data(), joints.size(), SC_COLUMNS_4X4);
  if (!model || model.check_rest(samples::pose_of(rig.rest_palette())) != SC_OK) fail(model.message());
  spherechain::Body body(model);  // allocates here, never in a frame

  for (int frame = 0; frame < rig.frame_count(0, 30); ++frame) {
    const samples::Palette palette = rig.palette(0, frame / 30.0);  // what your skinning shader gets
    if (body.set_pose(samples::pose_of(palette)) != SC_OK) fail("the palette does not fit");
    for (const spherechain::Penetration& p : body.penetrations()) {  // faults alone: no folds at joints, no touches
      const char* const joint = p.joint == SC_NO_JOINT ? "nothing" : joints[p.joint].name;
      const spherechain::Vec3 way = p.direction;  // moved by `distance` along it, the part is free
      std::printf("frame %d: %s in %s, %.0f mm; move %s by (%.3f, %.3f, %.3f)\n", frame, model.part_name(p.part),
                  model.part_name(p.other), model.millimetres(p.measures.depth), joint, p.distance * way.x,
                  p.distance * way.y, p.distance * way.z);
    }
  }
  // [/hello]
}

int main(int argc, char** argv) {
  if (argc != 3) return std::fputs("usage: hello ASSET.sphc MODEL.glb\n", stderr), 2;
  try {
    play(samples::read_file(argv[1]), samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "hello: error: %s\n", error.what()), 3;
  }
}
