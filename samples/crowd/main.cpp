// SPDX-License-Identifier: MIT
// crowd ASSET: a thousand characters in one call, dealt out by the game's own scheduler (here: plain threads).
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "skeleton.h"
#include "spherechain/crowd.h"
#include "spherechain/detect.h"

using namespace spherechain;

namespace {

constexpr std::size_t kCharacters = 1000;

int fail(const char* file, const char* what) {
  std::fprintf(stderr, "crowd: error: %s: %s\n", file, what);
  return 3;
}

// Each character swings its arms a little further than the one before: from rest into its own flanks.
std::vector<float> animate(const Asset& asset) {
  std::vector<float> matrices;
  for (std::size_t i = 0; i < kCharacters; ++i) {
    samples::Palette palette = samples::rest_pose(asset);
    const float degrees = 50.0F * static_cast<float>(i) / static_cast<float>(kCharacters);
    samples::turn(asset, palette, "left_shoulder", {0, 0, -degrees});
    samples::turn(asset, palette, "right_shoulder", {0, 0, degrees});
    for (const std::array<float, 12>& matrix : palette) {
      matrices.insert(matrices.end(), matrix.begin(), matrix.end());
    }
  }
  return matrices;
}

// What the runtime asks of a scheduler: call task(data, i) for each i, and return when all have returned.
void parallel_for(void*, std::size_t count, void (*task)(void* data, std::size_t i), void* data) {
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < count; ++i) {
    threads.emplace_back(task, data, i);
  }
  task(data, 0);
  for (std::thread& thread : threads) {
    thread.join();
  }
}

// The same for one character alone, to show that it is the same.
std::size_t count_alone(const Asset& asset, const float* matrices, std::vector<Sphere>& spheres) {
  RefitBonesJob refit;
  refit.asset = &asset;
  refit.bones = {matrices, asset.bone_count()};
  refit.spheres = {spheres.data(), spheres.size()};
  DetectJob detect;
  detect.asset = &asset;
  detect.spheres = {spheres.data(), spheres.size()};
  return refit.run() == Status::kOk && detect.run() == Status::kOk ? detect.pair_count : ~std::size_t{0};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: crowd ASSET.sphc\n", stderr);
    return 2;
  }
  std::ifstream file(argv[1], std::ios::binary);
  if (!file) {
    return fail(argv[1], "cannot be read");
  }
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
  Asset asset;
  char message[160];
  if (asset.open(bytes.data(), bytes.size(), message, sizeof message) != Status::kOk) {
    return fail(argv[1], message);
  }
  if (!samples::has_automatic_rig(asset)) {
    return fail(argv[1], "has bones of its own, and this sample animates automatic rigs alone");
  }
  const std::vector<float> matrices = animate(asset);
  const std::size_t floats_each = 12 * asset.bone_count();

  const std::size_t task_count = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::uint64_t> words(CrowdContext::words_needed(asset, task_count));
  std::vector<std::uint32_t> counts(kCharacters);
  CrowdContext context{{words.data(), words.size()}};
  CrowdJob crowd;
  crowd.asset = &asset;
  crowd.instance_count = kCharacters;
  crowd.bones = {matrices.data(), asset.bone_count()};
  crowd.instance_stride = floats_each * sizeof(float);
  crowd.context = &context;
  crowd.hook.parallel_for = parallel_for;
  crowd.task_count = task_count;
  crowd.counts = {counts.data(), counts.size()};  // of each character; for the pairs themselves: crowd.pairs
  const auto start = std::chrono::steady_clock::now();
  const Status status = crowd.run();
  const std::chrono::duration<double, std::micro> us = std::chrono::steady_clock::now() - start;
  if (status != Status::kOk) {
    return fail(argv[1], to_string(status));
  }

  std::vector<Sphere> spheres(asset.spheres().size);
  for (std::size_t i = 0; i < kCharacters; ++i) {
    if (count_alone(asset, matrices.data() + i * floats_each, spheres) != counts[i]) {
      std::fprintf(stderr, "crowd: error: character %zu alone has other pairs\n", i);
      return 1;
    }
  }
  const auto touching = std::count_if(counts.begin(), counts.end(), [](std::uint32_t count) { return count > 0; });
  std::printf("%zu characters, %td touch themselves, %zu pairs: each as alone\n", kCharacters, touching,
              crowd.pair_count);
  std::printf("%.2f us a character, bones in and counts out, in %zu tasks on %s\n", us.count() / kCharacters,
              task_count, to_string(best_target()));
  return 0;
}
