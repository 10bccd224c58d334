// SPDX-License-Identifier: MIT
// crowd ASSET.sphc MODEL.glb [MAP.svg]: a thousand characters. Who is in himself? Spheres raise a cheap alarm, and only
// the alarmed ones are looked at triangle by triangle. Then they stand close together on uneven ground: who is in whom,
// and who is in the ground?
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "gltf_pose.h"
#include "map.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

constexpr std::size_t kCharacters = 1000;

void check(Status status) {
  if (status != SC_OK) {
    throw std::runtime_error(std::string(field_name(status)) + ": " + code_text(status));
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

// The alarmed characters whose skins really intersect, and in how many pairs of body parts. One body serves all.
std::size_t confirm(const Model& model, const std::vector<float>& bones, const std::vector<CrowdPair>& alarms,
                    std::size_t& characters) {
  const std::size_t bone_count = model.info().bone_count;
  Body body(model);
  std::size_t confirmed = 0;
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    if (i > 0 && alarms[i].instance == alarms[i - 1].instance) continue;
    check(body.set_pose({&bones[alarms[i].instance * 12 * bone_count], bone_count, SC_ROWS_3X4}));
    const std::size_t count = body.contacts().part_count;
    check(body.status());
    confirmed += count;
    characters += count > 0 ? 1 : 0;
  }
  return confirmed;
}

// Stands the characters on a floor in rows, three quarters of a metre from each other, each turned its own way.
void place(const AssetInfo& info, std::vector<float>& bones) {
  const Vec3 up = info.up, left = info.left, forward = info.forward, o = info.origin;
  const float step = 0.75F / info.metres_per_unit;
  const Transform to_origin{{-o.x, -o.y, -o.z}, {0, 0, 0, 1}, {1, 1, 1}};
  for (std::size_t i = 0; i < kCharacters; ++i) {
    const float x = step * static_cast<float>(i % 32), z = step * static_cast<float>(i / 32);
    const float half = static_cast<float>(i) / 2, s = std::sin(half);
    const Transform to_place{
        {o.x + x * left.x + z * forward.x, o.y + x * left.y + z * forward.y, o.z + x * left.z + z * forward.z},
        {s * up.x, s * up.y, s * up.z, std::cos(half)},
        {1, 1, 1}};
    float* const own = &bones[i * 12 * info.bone_count];
    check(sc_place_bones(&to_origin, own, info.bone_count));
    check(sc_place_bones(&to_place, own, info.bone_count));
  }
}

// Pairs of characters that are in each other: of those whose boxes touch. Two bodies serve them all in turn.
std::size_t find_meetings(const Model& model, const std::vector<Pose>& poses, std::vector<Standing>& characters,
                          std::size_t& boxes) {
  Body one(model), other(model);
  std::vector<SceneBody> scene(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    check(one.set_pose(poses[i]));
    check(one.bounds(scene[i].low, scene[i].high));
    characters[i].low = scene[i].low;
    characters[i].high = scene[i].high;
  }
  std::vector<Pair> pairs(64 * poses.size());
  std::vector<std::uint64_t> scratch(sc_scene_scratch_words(poses.size()));
  SceneJob meet;
  meet.bodies = scene.data();
  meet.body_count = scene.size();
  meet.scratch = scratch.data();
  meet.scratch_words = scratch.size();
  meet.pairs = pairs.data();
  meet.pair_capacity = pairs.size();
  check(meet.run());
  boxes = meet.pair_count;
  std::size_t count = 0;
  for (std::size_t i = 0; i < meet.pair_count; ++i) {
    check(one.set_pose(poses[pairs[i].a]));
    check(other.set_pose(poses[pairs[i].b]));
    const Contacts contacts = one.contacts(other);
    check(one.status());
    if (contacts.part_count == 0) continue;
    ++count;
    ++characters[pairs[i].a].met;
    ++characters[pairs[i].b].met;
  }
  return count;
}

// Waves of 4 cm, here in the plane of the floor.
float waves(const void* metres_per_unit, Vec3 p) {
  const float metre = 1 / *static_cast<const float*>(metres_per_unit);
  return 0.04F * metre * std::sin((p.x + p.y + p.z) / metre);
}

// How deep each is in the ground.
void find_grounded(const Model& model, const std::vector<Pose>& poses, std::vector<Standing>& characters) {
  const AssetInfo info = model.info();
  const Vec3 up = info.up, o = info.origin;
  Ground ground;
  ground.up = up;
  ground.height = up.x * o.x + up.y * o.y + up.z * o.z;
  ground.terrain = waves;
  ground.user = &info.metres_per_unit;
  Query all;  // touches, too
  all.classes = ~0U;
  Body body(model);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    check(body.set_pose(poses[i]));
    for (const Penetration& part : body.below(ground, all)) {
      characters[i].depth = std::max(characters[i].depth, part.measures.depth);
    }
    check(body.status());
  }
}

void stand(const Model& model, std::vector<float>& bones, const char* map) {
  const AssetInfo info = model.info();
  place(info, bones);
  std::vector<Pose> poses(kCharacters);
  for (std::size_t i = 0; i < kCharacters; ++i) {
    poses[i] = {&bones[i * 12 * info.bone_count], info.bone_count, SC_ROWS_3X4};
  }
  std::vector<Standing> characters(kCharacters);
  std::size_t boxes = 0, grounded = 0;
  const std::size_t meetings = find_meetings(model, poses, characters, boxes);
  find_grounded(model, poses, characters);
  float deepest = 0;
  for (const Standing& one : characters) {
    grounded += one.depth > 0 ? 1 : 0;
    deepest = std::max(deepest, one.depth);
  }
  std::printf("close together: %zu pairs of characters in each other, of %zu whose boxes touch\n", meetings, boxes);
  std::printf("uneven ground: %zu characters in it, %.0f mm deep at most\n", grounded,
              1000 * double{deepest * info.metres_per_unit});
  if (map != nullptr) draw_map(info, characters, map);
}

void run(const std::vector<char>& file, const samples::GltfCharacter& clips, const char* map) {
  const Model model(file.data(), file.size(), nullptr, 0, SC_LAYOUT_UNSET);  // poses come in the asset's order
  if (!model) throw std::runtime_error(model.message());
  const Asset& asset = model.asset();
  std::vector<float> bones = animate(asset, clips);

  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const std::vector<CrowdPair> alarms = find_alarms(asset, bones);
  const auto between = Clock::now();
  std::size_t characters = 0;
  const std::size_t confirmed = confirm(model, bones, alarms, characters);
  const std::chrono::duration<double, std::micro> by_spheres = between - start, by_skin = Clock::now() - between;

  std::size_t alarmed = 0;
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    alarmed += i == 0 || alarms[i].instance != alarms[i - 1].instance ? 1 : 0;
  }
  std::printf("spheres: %zu of %zu characters alarmed, %zu pairs, %.1f us a character\n", alarmed, kCharacters,
              alarms.size(), by_spheres.count() / kCharacters);
  std::printf("skin: %zu characters, %zu pairs of body parts, %.1f us an alarmed character\n", characters, confirmed,
              alarmed == 0 ? 0 : by_skin.count() / static_cast<double>(alarmed));
  stand(model, bones, map);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fputs("usage: crowd ASSET.sphc MODEL.glb [MAP.svg]\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    const std::string map = argc > 3 ? argv[3] : ".svg";
    if (map.size() < 4 || map.substr(map.size() - 4) != ".svg") throw std::runtime_error(map + ": name the map .svg");
    run(file, samples::GltfCharacter(argv[2]), argc > 3 ? argv[3] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "crowd: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
