// SPDX-License-Identifier: MIT
// NAME.sphc and NAME.poses together, for programs that run where no baker is.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "pose_file.h"
#include "runtime/src/asset/asset_view.h"

namespace spherechain::bench {

struct PosedAsset {
  std::vector<std::uint64_t> bytes;
  Asset asset;  // a view of `bytes`
  PoseFile poses;

  const AssetView& view() const { return view_of(asset); }
};

// False where one of the two is missing or broken, or they do not go together; `error` then says why.
inline bool read_posed_asset(const std::string& folder, const std::string& name, PosedAsset& out, std::string& error) {
  const std::string path = folder + "/" + name + ".sphc";
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) {
    error = path + ": cannot be read";
    return false;
  }
  const auto size = static_cast<std::size_t>(in.tellg());
  out.bytes.assign(size / sizeof(std::uint64_t) + 1, 0);
  in.seekg(0);
  in.read(reinterpret_cast<char*>(out.bytes.data()), static_cast<std::streamsize>(size));
  if (!in) {
    error = path + ": cannot be read to its end";
    return false;
  }
  char message[160] = "";
  if (sc_asset_open(&out.asset, SC_ABI_VERSION, out.bytes.data(), size, message, sizeof message) != SC_OK) {
    error = path + ": " + message;
    return false;
  }
  if (!read_pose_file(folder + "/" + name + ".poses", out.poses, error)) {
    return false;
  }
  const std::size_t bones = out.poses.bone_count, spheres = out.poses.sphere_count;
  if ((bones != 0 && bones != out.view().bone_count()) || (spheres != 0 && spheres != out.view().spheres().size)) {
    error = path + ": has other bones or spheres than the poses beside it";
    return false;
  }
  return true;
}

}  // namespace spherechain::bench
