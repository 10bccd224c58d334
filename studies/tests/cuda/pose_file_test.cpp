// SPDX-License-Identifier: MIT
#include "pose_file.h"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "posed_asset.h"
#include "tiny_asset.h"

namespace spherechain::bench {
namespace {

namespace fs = std::filesystem;

struct Folder {
  Folder() : path(fs::temp_directory_path() / ("spherechain_pose_file_test_" + std::to_string(getpid()))) {
    fs::create_directories(path);
  }
  ~Folder() { fs::remove_all(path); }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return (path / name).string();
  }
  fs::path path;
};

std::string pose_bytes(std::uint32_t poses, std::uint32_t bones, std::uint32_t spheres, std::size_t floats) {
  std::string bytes(kPoseMagic, sizeof kPoseMagic);
  const std::uint32_t counts[4] = {poses, bones, spheres, 0};
  bytes.append(reinterpret_cast<const char*>(counts), sizeof counts);
  for (std::size_t i = 0; i < floats; ++i) {
    const auto value = static_cast<float>(i);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

std::string error_of(const std::string& path) {
  PoseFile file;
  std::string error;
  CHECK_FALSE(read_pose_file(path, file, error));
  return error;
}

}  // namespace

TEST_CASE("a file of poses is read as it was written") {
  const Folder folder;
  const std::string path = folder.write("a.poses", pose_bytes(3, 2, 5, 3 * (24 + 20)));
  PoseFile file;
  std::string error;
  REQUIRE_MESSAGE(read_pose_file(path, file, error), error);
  CHECK(file.pose_count == 3);
  CHECK(file.bone_count == 2);
  CHECK(file.sphere_count == 5);
  CHECK(file.matrices_of(2)[23] == 71);
  CHECK(file.spheres_of(0)[0].x == 72);
  CHECK(file.spheres_of(2)[4].radius == 131);
}

TEST_CASE("a file that is no file of poses, or has another size than it says, is named and refused") {
  const Folder folder;
  const std::string good = pose_bytes(3, 2, 0, 72);
  CHECK(error_of((folder.path / "none").string()) == (folder.path / "none").string() + ": cannot be read");
  for (const std::string& bytes : {std::string(), std::string("SCPOSES2"), std::string("SCPOSES1") + good.substr(8)}) {
    CHECK(error_of(folder.write("bad", bytes)) == (folder.path / "bad").string() + ": is no file of poses");
  }
  for (const std::string& bytes :
       {good + "abcd", good + "a", good.substr(0, good.size() - 4), good.substr(0, good.size() - 96),
        pose_bytes(0xffffffff, 0xffffffff, 0xffffffff, 72), pose_bytes(0, 0, 0, 0), pose_bytes(4, 2, 0, 72)}) {
    CHECK(error_of(folder.write("bad", bytes)) ==
          (folder.path / "bad").string() + ": has not the size its counts ask for");
  }
}

TEST_CASE("an asset is read with the poses beside it, and not with those of other bones") {
  const Folder folder;
  const std::vector<std::uint8_t> bytes = test::build(test::random_asset(5, 1).parts);  // without bones
  folder.write("a.sphc", {bytes.begin(), bytes.end()});
  PosedAsset read;
  std::string error;
  CHECK_FALSE(read_posed_asset(folder.path.string(), "a", read, error));
  CHECK(error == (folder.path / "a.poses").string() + ": cannot be read");
  folder.write("a.poses", pose_bytes(1, 2, 0, 24));
  CHECK_FALSE(read_posed_asset(folder.path.string(), "a", read, error));
  CHECK(error.find("other bones") != std::string::npos);
  CHECK(view_of(read.asset).spheres().size == 5);
  folder.write("a.sphc", "no asset");
  CHECK_FALSE(read_posed_asset(folder.path.string(), "a", read, error));
  CHECK(error.rfind((folder.path / "a.sphc").string() + ": ", 0) == 0);
}

}  // namespace spherechain::bench
