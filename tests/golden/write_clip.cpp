// SPDX-License-Identifier: MIT
// write_clip FOLDER OUT JOINTS: the clip for programs in other languages: as palettes in a file, SC_ROWS_3X4; as joints
// in another: how many there are, their parents, then an sc_transform for each joint of each frame.
#include <cstdio>
#include <fstream>

#include "clip.h"

int main(int argc, char** argv) {
  using namespace spherechain::test;
  if (argc != 4) {
    std::fputs("usage: write_clip FOLDER OUT JOINTS\n", stderr);
    return 2;
  }
  const Doll doll(argv[1], "doll.sphc");
  std::ofstream out(argv[2], std::ios::binary), joints(argv[3], std::ios::binary);
  const auto write = [&](const auto& list) {
    joints.write(reinterpret_cast<const char*>(list.data()),
                 static_cast<std::streamsize>(list.size() * sizeof list[0]));
  };
  if (doll.error.empty()) {
    const std::vector<std::uint32_t> parents = parents_of(doll.asset);
    write(std::vector{static_cast<std::uint32_t>(parents.size())});
    write(parents);
  }
  for (std::size_t frame = 0; doll.error.empty() && frame < kFrames; ++frame) {
    for (const auto& matrix : matrices_at(doll.asset, frame)) {
      out.write(reinterpret_cast<const char*>(matrix.data()), sizeof matrix);
    }
    write(joints_at(doll.asset, frame));
  }
  out.close();
  joints.close();
  if (!doll.error.empty() || !out || !joints) {
    std::fprintf(stderr, "write_clip: error: %s\n",
                 doll.error.empty() ? "the file cannot be written" : doll.error.c_str());
    return 3;
  }
  return 0;
}
