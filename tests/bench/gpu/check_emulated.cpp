// SPDX-License-Identifier: MIT
// spherechain_check_crowds FOLDER: what the crowd's kernels make of every character and clip in a folder that
// spherechain_gpu_data wrote, emulated on this machine's CPU, against the runtime's, bit for bit. No GPU, no CUDA.
#include <cstdio>

#include "check_crowds.h"

int main(int argc, char** argv) {
  using namespace spherechain::bench;
  if (argc != 2) {
    std::fprintf(stderr, "usage: spherechain_check_crowds FOLDER (that spherechain_gpu_data wrote)\n");
    return 2;
  }
  const std::vector<std::string> names = characters_in(argv[1]);
  if (names.empty()) {
    std::fprintf(stderr, "spherechain_check_crowds: %s: no characters with poses in it\n", argv[1]);
    return 3;
  }
  return check_crowds(names, argv[1]) ? 0 : 1;
}
