// SPDX-License-Identifier: MIT
// crowd ASSET.sphc MODEL.glb: a thousand characters. Their spheres raise a cheap alarm; only the alarmed ones are
// looked at triangle by triangle.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

constexpr std::size_t kCharacters = 1000;

void check(Status status) {
  if (status != SC_OK) {
    throw std::runtime_error(std::string(sc_field_name(status.field)) + ": " + sc_code_text(status.code));
  }
}

void check(Status status, const char* message) {
  if (status != SC_OK) throw std::runtime_error(message);
}

// The game's own scheduler; here plain threads. It calls task(data, i) for each i and returns when all have returned.
void parallel_for(void*, std::size_t count, void (*task)(void* data, std::size_t i), void* data) {
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < count; ++i) threads.emplace_back(task, data, i);
  task(data, 0);
  for (std::thread& thread : threads) thread.join();
}

// Bones of all characters in the asset's order, 12 floats a bone. Each plays the clip from a moment of its own.
std::vector<float> animate(const Asset& asset, const samples::GltfCharacter& model) {
  const std::size_t bone_count = sc_asset_get_info(&asset).bone_count;
  const std::vector<Bone> joints = model.joints();
  std::vector<std::uint32_t> joint_of_bone(bone_count);
  char message[256];
  check(sc_bind_joints(&asset, joints.data(), joints.size(), SC_COLUMNS_4X4, joint_of_bone.data(), bone_count, message,
                       sizeof message),
        message);
  std::vector<float> bones(kCharacters * 12 * bone_count);
  for (std::size_t i = 0; i < kCharacters; ++i) {
    const samples::Palette palette = model.palette(0, model.duration(0) * static_cast<double>(i) / kCharacters);
    const Pose pose = samples::pose_of(palette);
    check(sc_gather_bones(&asset, joint_of_bone.data(), &pose, &bones[i * 12 * bone_count]));
  }
  return bones;
}

// The pairs of spheres that touch, of all characters at once.
std::vector<CrowdPair> find_alarms(const Asset& asset, const std::vector<float>& bones) {
  const std::size_t bone_count = sc_asset_get_info(&asset).bone_count;
  CrowdJob job;
  job.asset = &asset;
  job.instance_count = kCharacters;
  job.pose = {bones.data(), bone_count, SC_ROWS_3X4};
  job.task_count = std::max(1U, std::thread::hardware_concurrency());
  job.parallel_for = parallel_for;
  std::vector<std::uint64_t> scratch(sc_crowd_scratch_words(&asset, job.task_count));
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  std::vector<std::uint32_t> counts(kCharacters);
  job.counts = counts.data();
  job.count_capacity = counts.size();
  std::vector<CrowdPair> pairs(64 * kCharacters);  // 32 a character, and as much again for several tasks
  job.pairs = pairs.data();
  job.pair_capacity = pairs.size();
  check(job.run());
  pairs.resize(job.pair_count);
  return pairs;
}

// Of the alarmed pairs of spheres, those whose skins really intersect: character by character.
std::size_t confirm(const Asset& asset, const std::vector<float>& bones, const std::vector<CrowdPair>& alarms,
                    std::size_t& characters) {
  const std::size_t bone_count = sc_asset_get_info(&asset).bone_count;
  std::vector<std::uint64_t> table(sc_skin_table_words(&asset)), scratch(sc_skin_scratch_words(&asset));
  check(sc_prepare_skin(&asset, table.data(), table.size()));
  SkinContactJob job;
  job.asset = &asset;
  job.skin_table = table.data();
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.spheres_only = 1;
  std::size_t confirmed = 0;
  std::vector<Pair> candidates;
  for (auto first = alarms.begin(); first != alarms.end();) {
    const std::uint32_t instance = first->instance;
    candidates.clear();
    for (; first != alarms.end() && first->instance == instance; ++first) candidates.push_back(first->pair);
    job.pose = {&bones[instance * 12 * bone_count], bone_count, SC_ROWS_3X4};
    job.candidates = candidates.data();
    job.candidate_count = candidates.size();
    check(job.run());
    confirmed += job.sphere_count;
    characters += job.sphere_count > 0 ? 1 : 0;
  }
  return confirmed;
}

void run(const std::vector<char>& file, const samples::GltfCharacter& model) {
  Asset asset;
  char message[256];
  check(sc_asset_open(&asset, SC_ABI_VERSION, file.data(), file.size(), message, sizeof message), message);
  const std::vector<float> bones = animate(asset, model);

  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const std::vector<CrowdPair> alarms = find_alarms(asset, bones);
  const auto between = Clock::now();
  std::size_t characters = 0;
  const std::size_t confirmed = confirm(asset, bones, alarms, characters);
  const std::chrono::duration<double, std::micro> by_spheres = between - start, by_skin = Clock::now() - between;

  std::size_t alarmed = 0;
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    alarmed += i == 0 || alarms[i].instance != alarms[i - 1].instance ? 1 : 0;
  }
  std::printf("spheres: %zu of %zu characters alarmed, %zu pairs, %.1f us a character\n", alarmed, kCharacters,
              alarms.size(), by_spheres.count() / kCharacters);
  std::printf("skin: %zu characters, %zu of the pairs, %.1f us an alarmed character\n", characters, confirmed,
              alarmed == 0 ? 0 : by_skin.count() / static_cast<double>(alarmed));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: crowd ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    run(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "crowd: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
