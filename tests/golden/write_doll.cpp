// SPDX-License-Identifier: GPL-3.0-or-later
// write_doll FOLDER: writes the golden character. doll.obj is a doll of melted tubes in T pose, y up, facing z; its
// coordinates are whole numbers, 512 a metre, so that every reader of the file gets the same. doll.sphc and
// doll_paper.sphc are baked from it as `spherechain bake doll.obj --body biped` does it with either profile.
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "baker/pipeline/pipeline.h"
#include "creatures.h"

namespace {

using namespace spherechain;

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

void write_mesh(const std::filesystem::path& path) {
  const baker::SourceMesh mesh = melt(doll_tubes(), 0.05);
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
  for (const baker::Vec3& p : mesh.positions) {
    std::fprintf(file, "v %.0f %.0f %.0f\n", std::round(512 * p.x()), std::round(512 * p.y()), std::round(512 * p.z()));
  }
  for (const baker::Triangle& t : mesh.triangles) {
    std::fprintf(file, "f %u %u %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  if (std::fclose(file) != 0) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

void write_asset(const std::filesystem::path& mesh, const char* profile, const std::filesystem::path& path) {
  baker::BakeSettings settings = baker::make_settings(profile, "{}", "");
  settings.segment.body = baker::parse_body("biped");
  const std::vector<std::uint8_t> bytes = baker::bake(mesh, settings, {}).asset;
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_doll FOLDER\n", stderr);
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    write_mesh(folder / "doll.obj");
    write_asset(folder / "doll.obj", "balanced", folder / "doll.sphc");
    write_asset(folder / "doll.obj", "paper", folder / "doll_paper.sphc");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_doll: %s\n", error.what());
    return 3;
  }
}
