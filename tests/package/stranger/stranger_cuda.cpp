// SPDX-License-Identifier: MIT
// A crowd of one on the GPU, and every function of its API. Without a device it says why and that is all: the program
// links and runs everywhere.
#include <spherechain/asset.h>
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

// What a game does before its first frame, and a launch of nothing. Needs no device.
bool prepare(const Asset& asset) {
  std::vector<std::uint64_t> words(cuda::CrowdTables::words_needed(asset));
  cuda::CrowdTables tables;
  const bool is_built = tables.build(asset, RadiusKind::kDetect, nullptr, {words.data(), words.size()}) == Status::kOk;
  const cuda::CrowdJob job{};
  return is_built && tables.block_bytes(true, true, false) > 0 && job.run() == Status::kOk;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::uint64_t> bytes = read(argc > 1 ? argv[1] : "");
  Asset asset;
  char message[160];
  if (asset.open(bytes.data(), bytes.size() * sizeof bytes[0], message, sizeof message) != Status::kOk) {
    std::fprintf(stderr, "stranger_cuda: %s\n", message);
    return 3;
  }
  if (!prepare(asset)) {
    return 1;
  }
  cuda::HostCrowd crowd;
  const Status status = crowd.open(asset, RadiusKind::kDetect, nullptr, 1, 4096);
  if (status == Status::kNoDevice && cuda::check_device() == Status::kNoDevice) {
    std::printf("%zu spheres, no CUDA device: %s\n", asset.spheres().size, cuda::last_device_error());
    return 0;
  }
  const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::vector<float> matrices;
  for (std::size_t i = 0; i < asset.bone_count(); ++i) {
    matrices.insert(matrices.end(), identity, identity + 12);
  }
  crowd.bones = {matrices.data(), asset.bone_count()};
  crowd.instance_stride = matrices.size() * sizeof(float);
  crowd.instance_count = 1;
  if (status != Status::kOk || crowd.run() != Status::kOk) {
    std::fprintf(stderr, "stranger_cuda: %s\n", cuda::last_device_error());
    return 1;
  }
  std::printf("%zu spheres, %zu pairs\n", asset.spheres().size, crowd.pair_count);
  return 0;
}
