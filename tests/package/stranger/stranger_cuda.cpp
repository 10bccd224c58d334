// SPDX-License-Identifier: MIT
// A crowd of one on the GPU, and every function of its API. Without a device it says why and that is all: the program
// links and runs everywhere.
#include <spherechain/cuda.h>

#include <cstdint>
#include <cstdio>
#include <vector>

using namespace spherechain;

namespace {

std::vector<std::uint64_t> read(const char* path) {
  std::vector<std::uint64_t> bytes;
  if (std::FILE* file = std::fopen(path, "rb")) {
    std::uint64_t word = 0;
    while (std::fread(&word, 1, sizeof word, file) > 0) {
      bytes.push_back(word);
      word = 0;
    }
    std::fclose(file);
  }
  return bytes;
}

// The calls of a game before its first frame, and a launch of nothing. Needs no device.
bool prepare(const Asset& asset) {
  std::vector<std::uint64_t> table(cuda::crowd_table_words(asset));
  return cuda::prepare_crowd(asset, SC_RADIUS_DETECT, nullptr, table.data(), table.size()) == SC_OK &&
         cuda::crowd_block_bytes(table.data(), true, true, false) > 0 &&
         cuda::enqueue_crowds(nullptr, 0, nullptr) == SC_OK;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::uint64_t> bytes = read(argc > 1 ? argv[1] : "");
  Asset asset;
  char message[160];
  if (sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), bytes.size() * sizeof bytes[0], message, sizeof message) !=
      SC_OK) {
    std::fprintf(stderr, "stranger_cuda: %s\n", message);
    return 3;
  }
  if (!prepare(asset)) {
    return 1;
  }
  const AssetInfo info = sc_asset_get_info(&asset);
  cuda::HostCrowd crowd;
  const Status status = crowd.open(asset, SC_RADIUS_DETECT, nullptr, 1, 4096);
  if (status == SC_NO_DEVICE && cuda::check_device() == SC_NO_DEVICE) {
    std::printf("%zu spheres, no CUDA device: %s\n", info.sphere_count, cuda::last_device_error());
    return 0;
  }
  const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::vector<float> matrices;
  for (std::size_t i = 0; i < info.bone_count; ++i) {
    matrices.insert(matrices.end(), identity, identity + 12);
  }
  crowd.pose.bones = matrices.data();
  crowd.pose.bone_count = info.bone_count;
  crowd.pose.bone_layout = SC_ROWS_3X4;
  crowd.instance_count = 1;
  if (status != SC_OK || crowd.run() != SC_OK) {
    std::fprintf(stderr, "stranger_cuda: %s\n", cuda::last_device_error());
    return 1;
  }
  std::printf("%zu spheres, %zu pairs\n", info.sphere_count, crowd.pair_count);
  return 0;
}
