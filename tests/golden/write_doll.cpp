// SPDX-License-Identifier: GPL-3.0-or-later
// write_doll OUT.obj: the source of the golden asset, a doll of melted tubes in T pose, y up, facing z. Its
// coordinates are whole numbers, 512 a metre, so that every reader of the file gets the same.
#include <cmath>
#include <cstdio>

#include "creatures.h"

namespace {

std::vector<Tube> doll_tubes() {
  std::vector<Tube> tubes{{{0, 0.92, 0}, {0, 1.3, 0}, 0.13, 0.15},  // trunk
                          {{0, 1.3, 0}, {0, 1.48, 0}, 0.08, 0.06},  // neck
                          {{0, 1.55, 0.01}, {0, 1.6, 0.02}, 0.1, 0.1}};
  for (const double side : {1.0, -1.0}) {
    tubes.push_back({{side * 0.1, 1.36, 0}, {side * 0.46, 1.36, 0}, 0.07, 0.05});    // upper arm
    tubes.push_back({{side * 0.46, 1.36, 0}, {side * 0.74, 1.36, 0}, 0.05, 0.035});  // forearm
    tubes.push_back({{side * 0.74, 1.36, 0}, {side * 0.86, 1.36, 0}, 0.04, 0.035});  // hand
    tubes.push_back({{side * 0.1, 0.9, 0}, {side * 0.12, 0.48, 0}, 0.095, 0.065});   // thigh
    tubes.push_back({{side * 0.12, 0.48, 0}, {side * 0.13, 0.09, -0.01}, 0.06, 0.045});
    tubes.push_back({{side * 0.13, 0.06, 0}, {side * 0.13, 0.04, 0.14}, 0.05, 0.04});  // foot
  }
  return tubes;
}

}  // namespace

int main(int argc, char** argv) {
  std::FILE* file = argc == 2 ? std::fopen(argv[1], "w") : nullptr;
  if (file == nullptr) {
    std::fputs("usage: write_doll OUT.obj\n", stderr);
    return 2;
  }
  const spherechain::baker::SourceMesh mesh = melt(doll_tubes(), 0.05);
  for (const spherechain::baker::Vec3& p : mesh.positions) {
    std::fprintf(file, "v %.0f %.0f %.0f\n", std::round(512 * p.x()), std::round(512 * p.y()), std::round(512 * p.z()));
  }
  for (const spherechain::baker::Triangle& t : mesh.triangles) {
    std::fprintf(file, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return std::fclose(file) == 0 ? 0 : 3;
}
