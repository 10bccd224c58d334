// SPDX-License-Identifier: MIT
// write_clip FOLDER OUT: the clip as palettes in a file, SC_ROWS_3X4, for programs in other languages.
#include <cstdio>
#include <fstream>

#include "clip.h"

int main(int argc, char** argv) {
  using namespace spherechain::test;
  if (argc != 3) {
    std::fputs("usage: write_clip FOLDER OUT\n", stderr);
    return 2;
  }
  const Doll doll(argv[1], "doll.sphc");
  std::ofstream out(argv[2], std::ios::binary);
  for (std::size_t frame = 0; doll.error.empty() && frame < kFrames; ++frame) {
    for (const auto& matrix : matrices_at(doll.asset, frame)) {
      out.write(reinterpret_cast<const char*>(matrix.data()), sizeof matrix);
    }
  }
  out.close();
  if (!doll.error.empty() || !out) {
    std::fprintf(stderr, "write_clip: error: %s\n",
                 doll.error.empty() ? "the file cannot be written" : doll.error.c_str());
    return 3;
  }
  return 0;
}
