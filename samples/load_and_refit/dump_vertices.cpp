// SPDX-License-Identifier: GPL-3.0-or-later
// dump_vertices ASSET SOURCE POSES REST.f32 POSED.f32: stands for a game's skinned vertex buffer. Writes the source's
// vertices at rest and in the last frame of a pose file.
#include <cstdio>
#include <fstream>

#include "mesh/error.h"
#include "play/play.h"

using namespace spherechain::baker;

namespace {

void write(const char* path, const std::vector<Vec3>& positions) {
  const std::vector<float> packed = pack(positions);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(packed.data()),
             static_cast<std::streamsize>(packed.size() * sizeof packed[0]));
  if (!file.flush()) {
    throw Error(ExitCode::kFile, std::string(path) + ": cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fputs("usage: dump_vertices ASSET SOURCE POSES REST.f32 POSED.f32\n", stderr);
    return 2;
  }
  try {
    MotionChoice motion;
    motion.poses = argv[3];
    const AnimatedAsset animated(argv[1], argv[2], motion, {});
    write(argv[4], animated.character().source_positions);
    write(argv[5], animated.positions(animated.deformation(animated.frame_count() - 1)));
  } catch (const Error& error) {
    std::fprintf(stderr, "dump_vertices: error: %s\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}
