// SPDX-License-Identifier: MIT
// hello ASSET.sphc MODEL.glb: which body parts are inside each other, frame by frame. One page to copy from.
#include <cstdio>
#include <stdexcept>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

static void check(spherechain::Status status, const char* message) {
  if (status != SC_OK) throw std::runtime_error(message);
}

static void play(const std::vector<char>& file, const samples::GltfCharacter& model) {
  // [hello]
  const std::vector<spherechain::Bone> joints = model.joints();  // your skeleton: names and inverse bind matrices
  spherechain::Character character;                              // allocates here, never in a frame
  char message[256];
  const spherechain::Status made =
      character.create(file.data(), file.size(), joints.data(), joints.size(), SC_COLUMNS_4X4, message, sizeof message);
  check(made, message);
  const float metres = sc_asset_get_info(&character.asset()).metres_per_unit;
  check(character.check_rest(samples::pose_of(model.rest_palette()), message, sizeof message), message);

  for (int frame = 0; frame < model.frame_count(0, 30); ++frame) {
    const samples::Palette palette = model.palette(0, frame / 30.0);  // what your skinning shader gets
    const spherechain::Pose pose{palette[0].data(), palette.size(), SC_COLUMNS_4X4};

    const spherechain::Penetration* found = nullptr;
    std::size_t count = 0;
    check(character.penetrations(pose, found, count), "the palette does not fit");
    for (std::size_t i = 0; i < count; ++i) {
      if (found[i].kind != SC_CLASS_PENETRATION) continue;  // folds at joints, touches ...
      const spherechain::Vec3 out = found[i].direction;     // the way that the part must go
      std::printf("frame %d: %s in %s, %.0f mm; out along (%.2f, %.2f, %.2f)\n", frame,
                  character.part_name(found[i].part), character.part_name(found[i].other),
                  1000 * metres * found[i].measures.depth, out.x, out.y, out.z);
    }
  }
  // [/hello]
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: hello ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    play(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hello: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
