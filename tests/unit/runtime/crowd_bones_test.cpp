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

  std::vector<CrowdPair> run(Target target, std::size_t task_count = 1, const Filter* filter = nullptr) const {
    CrowdBuffers buffers(opened.asset, kInstances, task_count);
    std::vector<CrowdPair> pairs(kInstances * sphere_count * sphere_count);
    std::size_t threads = 3;
    buffers.job.pose = pose_at(0);
    buffers.job.target = target;
    buffers.job.filter = filter;
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

// By the rule of detect.h.
bool touch(const Sphere& a, const Sphere& b, float padding) {
  const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z, s = a.radius + (b.radius + padding);
  return (dx * dx + dy * dy) + dz * dz < s * s;
}

// The least padding of `b` with which the two touch, and the float before it.
std::pair<float, float> find_limit(const Sphere& a, const Sphere& b) {
  float apart = -a.radius - b.radius, touching = 1e3F;
  for (float middle = 0; std::nextafter(apart, touching) < touching;) {
    middle = apart + (touching - apart) / 2;
    middle = middle > apart && middle < touching ? middle : std::nextafter(apart, touching);
    (touch(a, b, middle) ? touching : apart) = middle;
  }
  return {touching, apart};
}

void check_last_bits(const Shape& shape) {
  CrowdOfBones crowd(shape);
  for (std::size_t i = 0; i < kInstances; i += 4) {  // some so small that figures of theirs count for 0
    for (std::size_t bone = 0; bone < crowd.bone_count; ++bone) {
      for (float& figure : crowd.matrices[i * crowd.bone_count + bone]) figure *= 0x1p-60F;
    }
  }
  OwnedFilter filter(crowd.opened.asset);
  const auto count = static_cast<std::uint32_t>(crowd.sphere_count);
  std::mt19937 random(5);
  for (std::size_t sample = 0; sample < 60; ++sample) {
    const auto instance = static_cast<std::uint32_t>(sample * 7 % kInstances);
    const auto b = static_cast<std::uint32_t>(1 + random() % (count - 1));
    const auto a = static_cast<std::uint32_t>(random() % b);
    const std::vector<Sphere> spheres = crowd.spheres_of(instance);
    const auto [touching, apart] = find_limit(spheres[a], spheres[b]);
    REQUIRE(touch(spheres[a], spheres[b], touching));
    REQUIRE(!touch(spheres[a], spheres[b], apart));
    REQUIRE(sc_reset_filter(&crowd.opened.asset, &filter.filter) == SC_OK);
    for (std::uint32_t i = 1; i < count; ++i) {
      for (std::uint32_t k = 0; k < i; ++k) {
        REQUIRE(sc_ignore_pair(&crowd.opened.asset, &filter.filter, k, i, k != a || i != b ? 1 : 0) == SC_OK);
      }
    }
    const auto is_own = [&](const CrowdPair& p) { return p.instance == instance && p.pair == Pair{a, b}; };
    for (const float padding : {touching, apart}) {
      REQUIRE(sc_pad_sphere(&crowd.opened.asset, &filter.filter, b, padding) == SC_OK);
      const bool wanted =
          !detect(crowd.opened.asset, spheres, SC_RADIUS_DETECT, SC_TARGET_SCALAR, &filter.filter).pairs.empty();
      for (const Target target : supported_targets()) {
        INFO(std::string(sc_target_name(target)), ", ", a, " and ", b, " of ", instance);
        const std::vector<CrowdPair> found = crowd.run(target, 1, &filter.filter);
        CHECK(std::count_if(found.begin(), found.end(), is_own) == (wanted ? 1 : 0));
      }
    }
  }
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
    CHECK(same_bits(crowd.run(target, 1, &filter.filter), wanted));
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
