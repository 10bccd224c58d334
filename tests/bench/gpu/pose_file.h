// SPDX-License-Identifier: MIT
// Poses of a character for machines without the baker: NAME.poses beside NAME.sphc, as spherechain_gpu_data writes
// them. Little-endian: "SCPOSES2", then four 32-bit numbers (poses, bones, spheres, 0), then for each pose a matrix for
// each bone (12 floats: three rows), then for each pose the refitted spheres with fit radii. Characters that are
// refitted by moments have bones; the paper's characters have spheres, for only its own experiments refit by its rule.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "spherechain/types.h"

namespace spherechain::bench {

inline constexpr char kPoseMagic[8] = {'S', 'C', 'P', 'O', 'S', 'E', 'S', '2'};
inline constexpr std::size_t kMatrixFloats = 12;

struct PoseFile {
  std::size_t pose_count = 0, bone_count = 0, sphere_count = 0;
  std::vector<float> matrices;  // pose after pose
  std::vector<Sphere> spheres;  // pose after pose

  const float* matrices_of(std::size_t pose) const { return matrices.data() + pose * bone_count * kMatrixFloats; }
  const Sphere* spheres_of(std::size_t pose) const { return spheres.data() + pose * sphere_count; }
};

// False where the file is not one; `error` then says why.
inline bool read_pose_file(const std::string& path, PoseFile& file, std::string& error) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) {
    error = path + ": cannot be read";
    return false;
  }
  const auto size = static_cast<std::uint64_t>(in.tellg());
  in.seekg(0);
  char magic[sizeof kPoseMagic] = {};
  std::uint32_t counts[4] = {};
  in.read(magic, sizeof magic);
  in.read(reinterpret_cast<char*>(counts), sizeof counts);
  if (!in || std::memcmp(magic, kPoseMagic, sizeof magic) != 0) {
    error = path + ": is no file of poses";
    return false;
  }
  // Divided, for hostile counts would overflow a product.
  const std::uint64_t pose_floats = std::uint64_t{counts[1]} * kMatrixFloats + std::uint64_t{counts[2]} * 4;
  const std::uint64_t floats = (size - sizeof magic - sizeof counts) / sizeof(float);
  if (pose_floats == 0 || size % sizeof(float) != 0 || floats % pose_floats != 0 || floats / pose_floats != counts[0]) {
    error = path + ": has not the size its counts ask for";
    return false;
  }
  file.pose_count = counts[0];
  file.bone_count = counts[1];
  file.sphere_count = counts[2];
  file.matrices.resize(file.pose_count * file.bone_count * kMatrixFloats);
  file.spheres.resize(file.pose_count * file.sphere_count);
  in.read(reinterpret_cast<char*>(file.matrices.data()),
          static_cast<std::streamsize>(file.matrices.size() * sizeof(float)));
  in.read(reinterpret_cast<char*>(file.spheres.data()),
          static_cast<std::streamsize>(file.spheres.size() * sizeof(Sphere)));
  if (!in) {
    error = path + ": cannot be read to its end";
    return false;
  }
  return true;
}

}  // namespace spherechain::bench
