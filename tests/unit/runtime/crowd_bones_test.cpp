// SPDX-License-Identifier: MIT
// A crowd of skeletons has the spheres of a refit job an instance, and so its pairs.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "palette.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kInstances = 37;  // two full registers of the widest target, and some

struct Shape {
  std::size_t spheres = 40, bones = 9, batch_pairs = 48;
  bool has_large_spheres = true;
};

TinyAsset make(const Shape& shape) {
  TinyAsset tiny = random_asset(shape.spheres, 21);
  for (std::size_t i = 0; i < shape.spheres; ++i) {
    const std::uint16_t counts[] = {2, 8, 1, 19, 4, 3, 16, 2};
    give_pivots(tiny, i, shape.has_large_spheres ? counts[i % 8] : std::uint16_t{2}, static_cast<unsigned>(i / 2));
  }
  const TinySkin skin = add_bones(tiny, shape.bones, 22);
  add_moments(tiny, skin, shape.batch_pairs);
  return tiny;
}

struct CrowdOfBones {
  explicit CrowdOfBones(const Shape& shape)
      : tiny(make(shape)), opened(tiny.parts), sphere_count(shape.spheres), bone_count(shape.bones) {
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    for (std::size_t i = 0; i < kInstances; ++i) {
      const std::vector<Matrix> own = random_matrices(bone_count, static_cast<unsigned>(i));
      matrices.insert(matrices.end(), own.begin(), own.end());
    }
  }

  Pose pose_at(std::size_t instance) const {
    Pose pose = pose_of(matrices);
    pose.bones = matrices[instance * bone_count].data();
    pose.bone_count = bone_count;
    return pose;
  }

  std::vector<Sphere> spheres_of(std::size_t instance) const {
    const Refitted refitted = refit(opened.asset, pose_at(instance), SC_RADIUS_DETECT, SC_TARGET_SCALAR);
    REQUIRE(refitted.status == SC_OK);
    return refitted.spheres;
  }

  std::vector<CrowdPair> expected() const {
    std::vector<CrowdPair> out;
    for (std::size_t i = 0; i < kInstances; ++i) {
      for (const Pair& pair : detect(opened.asset, spheres_of(i), SC_RADIUS_DETECT, SC_TARGET_SCALAR).pairs) {
        out.push_back({static_cast<std::uint32_t>(i), pair});
      }
    }
    return out;
  }

  std::vector<CrowdPair> run(Target target, std::size_t task_count = 1,
                             const std::uint64_t* ignored_pairs = nullptr) const {
    CrowdBuffers buffers(opened.asset, kInstances, task_count);
    std::vector<CrowdPair> pairs(kInstances * sphere_count * sphere_count);
    std::size_t threads = 3;
    buffers.job.pose = pose_at(0);
    buffers.job.target = target;
    buffers.job.ignored_pairs = ignored_pairs;
    buffers.job.parallel_for = on_threads;
    buffers.job.user = &threads;
    buffers.job.pairs = pairs.data();
    buffers.job.pair_capacity = pairs.size();
    REQUIRE(buffers.job.run() == SC_OK);
    pairs.resize(buffers.job.pair_count);
    return pairs;
  }

  void check() const {
    const std::vector<CrowdPair> wanted = expected();
    CHECK(wanted.size() > 200);
    for (const Target target : supported_targets()) {
      for (const std::size_t tasks : {1U, 2U, 5U}) {
        INFO(std::string(sc_target_name(target)), ", ", tasks, " tasks");
        CHECK(same_bits(run(target, tasks), wanted));
      }
    }
  }

  TinyAsset tiny;
  OpenedAsset opened;
  std::size_t sphere_count, bone_count;
  std::vector<Matrix> matrices;
};

// Two neighbouring floats: with one as the bone's translation along x the two spheres touch, with the other they do
// not. False where no such move changes whether they do.
bool find_limit(CrowdOfBones& crowd, std::size_t instance, std::size_t bone, Pair pair, float (&limits)[2]) {
  float& figure = crowd.matrices[instance * crowd.bone_count + bone][3];
  const auto touch = [&](float value) {
    figure = value;
    const auto found = detect(crowd.opened.asset, crowd.spheres_of(instance), SC_RADIUS_DETECT, SC_TARGET_SCALAR);
    return std::binary_search(found.pairs.begin(), found.pairs.end(), pair);
  };
  const float start = figure;
  const bool touches = touch(start);
  float other = start;
  for (float step = 1e-20F; step < 1e4F && other == start; step *= -4) {
    if (touch(start + step) != touches) other = start + step;
  }
  limits[0] = start;
  limits[1] = other;
  while (std::nextafter(limits[0], limits[1]) != limits[1]) {
    const float middle = limits[0] + (limits[1] - limits[0]) / 2;
    const bool is_between = middle != limits[0] && middle != limits[1];
    const float next = is_between ? middle : std::nextafter(limits[0], limits[1]);
    limits[touch(next) == touches ? 0 : 1] = next;
  }
  figure = start;
  return other != start;
}

void check_last_bits(const Shape& shape) {
  CrowdOfBones crowd(shape);
  for (std::size_t i = 0; i < kInstances; i += 4) {  // some so small that figures of theirs count for 0
    for (std::size_t bone = 0; bone < crowd.bone_count; ++bone) {
      for (float& figure : crowd.matrices[i * crowd.bone_count + bone]) figure *= 0x1p-60F;
    }
  }
  const auto count = static_cast<std::uint32_t>(crowd.sphere_count);
  std::mt19937 random(5);
  std::size_t limit_count = 0;
  for (std::size_t sample = 0; sample < 120; ++sample) {
    const auto instance = static_cast<std::uint32_t>(sample * 7 % kInstances);
    const auto b = static_cast<std::uint32_t>(1 + random() % (count - 1));
    const Pair pair{static_cast<std::uint32_t>(random() % b), b};
    const std::size_t bone = random() % crowd.bone_count;
    float limits[2];
    if (!find_limit(crowd, instance, bone, pair, limits)) continue;
    ++limit_count;
    const CrowdPair own{instance, pair};
    float& figure = crowd.matrices[instance * crowd.bone_count + bone][3];
    const float start = figure;
    std::vector<std::size_t> found_at[2];
    for (std::size_t side = 0; side < 2; ++side) {
      figure = limits[side];
      for (const Target target : supported_targets()) {
        const std::vector<CrowdPair> found = crowd.run(target);
        found_at[side].push_back(
            static_cast<std::size_t>(std::count_if(found.begin(), found.end(), [&](const CrowdPair& p) {
              return p.instance == own.instance && p.pair == own.pair;
            })));
      }
    }
    figure = start;
    INFO(pair.a, " and ", pair.b, " of ", instance);
    for (std::size_t i = 0; i < found_at[0].size(); ++i) {
      CHECK(found_at[0][i] == found_at[0][0]);
      CHECK(found_at[0][i] + found_at[1][i] == 1);
    }
  }
  CHECK(limit_count > 20);
}

}  // namespace

TEST_CASE("a crowd of skeletons gives the pairs of its refitted spheres") {
  CrowdOfBones(Shape{}).check();
  CrowdOfBones(Shape{60, 20}).check();
  CrowdOfBones(Shape{40, 9, 1}).check();
  CrowdOfBones(Shape{40, kMaxMomentBones, kMaxMomentPairs}).check();
  CrowdOfBones(Shape{40, 300, 48, false}).check();
}

TEST_CASE("a crowd's spheres are those of a single refit to the last bit") { check_last_bits(Shape{}); }

TEST_CASE("bits of a filter past its pairs count for nothing in a crowd") {
  const CrowdOfBones crowd(Shape{});
  OwnedFilter filter(crowd.opened.asset);
  const std::size_t spare = 64 - crowd.sphere_count * (crowd.sphere_count - 1) / 2 % 64;
  REQUIRE(spare < 64);
  filter.ignored.back() |= ~std::uint64_t{0} << (64 - spare);
  const std::vector<CrowdPair> wanted = crowd.expected();
  for (const Target target : supported_targets()) {
    CHECK(same_bits(crowd.run(target, 1, filter.ignored.data()), wanted));
  }
}

TEST_CASE("matrices that are not finite cost no other instance a pair") {
  CrowdOfBones crowd(Shape{});
  const std::vector<CrowdPair> before = crowd.expected();
  const float bad[] = {kNan, kInfinity, -kInfinity, 3e38F, -1e30F, 1e-40F};
  std::vector<bool> is_bad(kInstances);
  for (std::size_t i = 1; i < kInstances; i += 3) {
    is_bad[i] = true;
    for (std::size_t k = 0; k < 1 + i % 3; ++k) {
      const std::size_t bone = (i + 5 * k) % crowd.bone_count;
      crowd.matrices[i * crowd.bone_count + bone][(i + 7 * k) % 12] = bad[(i / 3 + k) % 6];
    }
  }
  std::vector<CrowdPair> wanted = crowd.expected();
  for (const Target target : supported_targets()) {
    INFO(std::string(sc_target_name(target)));
    const std::vector<CrowdPair> found = crowd.run(target);
    CHECK(same_bits(found, wanted));
    const auto of_good = [&](const std::vector<CrowdPair>& pairs) {
      std::vector<CrowdPair> out;
      std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(out),
                   [&](const CrowdPair& pair) { return !is_bad[pair.instance]; });
      return out;
    };
    CHECK(of_good(found).size() > 100);
    CHECK(same_bits(of_good(found), of_good(before)));
  }
}

}  // namespace spherechain::test
