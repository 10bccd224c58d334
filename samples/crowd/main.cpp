// SPDX-License-Identifier: MIT
// crowd ASSET.sphc MODEL.glb: a thousand characters. Who is in himself? Spheres raise a cheap alarm, and only the
// alarmed ones are looked at triangle by triangle. Then they stand close together on uneven ground: who is in whom, and
// who is in the ground?
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

// Stands the characters on a floor in rows, three quarters of a metre from each other, each turned its own way.
void place(const AssetInfo& info, std::vector<float>& bones) {
  const Vec3 up = info.up, left = info.left, forward = info.forward, o = info.origin;
  const float axes[3][3] = {{left.x, left.y, left.z}, {up.x, up.y, up.z}, {forward.x, forward.y, forward.z}};
  for (std::size_t i = 0; i < kCharacters; ++i) {
    const auto column = static_cast<float>(i % 32), row = static_cast<float>(i / 32), angle = static_cast<float>(i);
    const float c = std::cos(angle), s = std::sin(angle), turn[3][3] = {{c, 0, s}, {0, 1, 0}, {-s, 0, c}};
    const float to[3] = {0.75F * column / info.metres_per_unit, 0, 0.75F * row / info.metres_per_unit};
    float m[3][4];  // turned about the origin, in the character's own axes, and moved
    for (std::size_t x = 0; x < 3; ++x) {
      m[x][3] = 0;
      for (std::size_t y = 0; y < 3; ++y) {
        m[x][y] = 0;
        for (std::size_t j = 0; j < 3; ++j) {
          for (std::size_t k = 0; k < 3; ++k) m[x][y] += axes[j][x] * turn[j][k] * axes[k][y];
        }
        m[x][3] += axes[y][x] * to[y];
      }
      m[x][3] += (&o.x)[x] - (m[x][0] * o.x + m[x][1] * o.y + m[x][2] * o.z);
    }
    const std::size_t size = 12 * info.bone_count;
    for (float* bone = &bones[i * size]; bone < bones.data() + (i + 1) * size; bone += 12) {
      float out[12];
      for (std::size_t x = 0; x < 3; ++x) {
        for (std::size_t y = 0; y < 4; ++y) {
          out[4 * x + y] = m[x][0] * bone[y] + m[x][1] * bone[4 + y] + m[x][2] * bone[8 + y] + (y == 3 ? m[x][3] : 0);
        }
      }
      std::copy(out, out + 12, bone);
    }
  }
}

// Pairs of characters that are in each other: of those whose boxes touch.
std::size_t find_meetings(const std::vector<Body>& bodies, std::size_t& boxes) {
  std::vector<SceneBody> scene(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) check(sc_bound_body(&bodies[i], &scene[i].low, &scene[i].high));
  const Asset* const asset = bodies[0].asset;
  std::vector<Pair> pairs(64 * bodies.size());
  std::vector<std::uint64_t> scratch(
      std::max(sc_scene_scratch_words(bodies.size()), sc_body_scratch_words(asset, asset)));
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
    BodyContactJob job;
    job.a = bodies[pairs[i].a];
    job.b = bodies[pairs[i].b];
    job.scratch = scratch.data();
    job.scratch_words = scratch.size();
    check(job.run());
    count += job.part_count > 0 ? 1 : 0;
  }
  return count;
}

// Waves of 4 cm, here in the plane of the floor.
float waves(const void* metres_per_unit, Vec3 p) {
  const float metre = 1 / *static_cast<const float*>(metres_per_unit);
  return 0.04F * metre * std::sin((p.x + p.y + p.z) / metre);
}

// How many characters are in the ground, and how deep at most.
std::size_t find_grounded(const std::vector<Body>& bodies, const AssetInfo& info, float& deepest) {
  std::vector<std::uint64_t> scratch(sc_floor_scratch_words(bodies[0].asset));
  std::vector<Penetration> parts(info.part_count);
  std::size_t count = 0;
  for (const Body& body : bodies) {
    FloorJob job;
    job.body = body;
    job.up = info.up;
    job.height = info.up.x * info.origin.x + info.up.y * info.origin.y + info.up.z * info.origin.z;
    job.terrain = waves;
    job.user = &info.metres_per_unit;
    job.scratch = scratch.data();
    job.scratch_words = scratch.size();
    job.penetrations = parts.data();
    job.penetration_capacity = parts.size();
    check(job.run());
    count += job.penetration_count > 0 ? 1 : 0;
    for (std::size_t i = 0; i < job.penetration_count; ++i) deepest = std::max(deepest, parts[i].depth);
  }
  return count;
}

void stand(const Asset& asset, std::vector<float>& bones) {
  const AssetInfo info = sc_asset_get_info(&asset);
  place(info, bones);
  std::vector<std::uint64_t> table(sc_skin_table_words(&asset));
  check(sc_prepare_skin(&asset, table.data(), table.size()));
  std::vector<Body> bodies(kCharacters);
  for (std::size_t i = 0; i < kCharacters; ++i) {
    bodies[i].asset = &asset;
    bodies[i].skin_table = table.data();
    bodies[i].pose = {&bones[i * 12 * info.bone_count], info.bone_count, SC_ROWS_3X4};
  }
  std::size_t boxes = 0;
  const std::size_t meetings = find_meetings(bodies, boxes);
  float deepest = 0;
  const std::size_t grounded = find_grounded(bodies, info, deepest);
  std::printf("close together: %zu pairs of characters in each other, of %zu whose boxes touch\n", meetings, boxes);
  std::printf("uneven ground: %zu characters in it, %.0f mm deep at most\n", grounded,
              1000 * double{deepest * info.metres_per_unit});
}

void run(const std::vector<char>& file, const samples::GltfCharacter& model) {
  Asset asset;
  char message[256];
  check(sc_asset_open(&asset, SC_ABI_VERSION, file.data(), file.size(), message, sizeof message), message);
  std::vector<float> bones = animate(asset, model);

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
  stand(asset, bones);
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
