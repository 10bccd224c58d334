// SPDX-License-Identifier: MIT
// Whatever the rule of refit, a crowd of skeletons has the spheres of RefitBonesJob, and so its pairs.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "tiny_moments.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kInstances = 37;  // two full registers of the widest target, and some

struct Shape {
  std::size_t spheres = 40, bones = 9, batch_pairs = 48;
  RefitRule rule = RefitRule::kMoments;
  bool has_large_spheres = true;
  bool has_whole_moments = false;  // a bone's own are symmetric, as older bakers gave them
};

void make_symmetric(MomentParts& moments) {
  std::size_t pair = 0;
  for (const std::size_t bones : moments.bone_counts) {
    for (std::size_t left = bones; left > 0; pair += left, --left) {  // a bone's pairs begin with its own
      float* const values = moments.moments[pair].values;
      for (std::size_t i = 0; i < kMomentSize; ++i) {
        if (i / 4 < i % 4) values[i] = values[4 * (i % 4) + i / 4] = values[i] / 2;
      }
    }
  }
}

TinyAsset make(const Shape& shape) {
  TinyAsset tiny = random_asset(shape.spheres, 21);
  for (std::size_t i = 0; i < shape.spheres; ++i) {
    const std::uint16_t counts[] = {2, 8, 1, 19, 4, 3, 16, 2};
    give_pivots(tiny, i, shape.has_large_spheres ? counts[i % 8] : std::uint16_t{2}, static_cast<unsigned>(i / 2));
  }
  TinySkin skin = add_bones(tiny, shape.bones, 22);
  if (shape.rule == RefitRule::kMoments) {
    add_moments(tiny, skin, shape.batch_pairs);
    if (shape.has_whole_moments) make_symmetric(tiny.parts.bone_refit.moments);
  }
  tiny.parts.refit = static_cast<std::uint8_t>(shape.rule);
  return tiny;
}

struct CrowdOfBones {
  explicit CrowdOfBones(const Shape& shape)
      : tiny(make(shape)), opened(tiny.parts), sphere_count(shape.spheres), bone_count(shape.bones) {
    REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
    REQUIRE(opened.asset.refit_rule() == shape.rule);
    const bool is_upper = shape.rule == RefitRule::kMoments && !shape.has_whole_moments;
    REQUIRE(opened.asset.moment_tables().own_are_upper == is_upper);
    for (std::size_t i = 0; i < kInstances; ++i) {
      const std::vector<Matrix> own = random_matrices(bone_count, static_cast<unsigned>(i));
      matrices.insert(matrices.end(), own.begin(), own.end());
    }
  }

  BoneMatrices bones_of(std::size_t instance) const { return {matrices[instance * bone_count].data(), bone_count}; }

  std::vector<Sphere> spheres_of(std::size_t instance) const {
    const Refitted refitted = refit_bones(opened.asset, bones_of(instance), {}, RadiusKind::kDetect, Target::kScalar);
    REQUIRE(refitted.status == Status::kOk);
    return refitted.spheres;
  }

  std::vector<CrowdPair> expected() const {
    std::vector<CrowdPair> out;
    for (std::size_t i = 0; i < kInstances; ++i) {
      for (const Pair& pair :
           detect(opened.asset, spheres_of(i), Method::kM2, RadiusKind::kDetect, Target::kScalar).pairs) {
        out.push_back({static_cast<std::uint32_t>(i), pair});
      }
    }
    return out;
  }

  std::vector<CrowdPair> run(Target target, std::size_t task_count = 1, const Filter* filter = nullptr) const {
    CrowdBuffers buffers(opened.asset, kInstances, task_count);
    std::vector<CrowdPair> pairs(kInstances * sphere_count * sphere_count);
    std::size_t threads = 3;
    buffers.job.bones = bones_of(0);
    buffers.job.instance_stride = bone_count * sizeof(Matrix);
    buffers.job.target = target;
    buffers.job.filter = filter;
    buffers.job.hook = {on_threads, &threads};
    buffers.job.pairs = {pairs.data(), pairs.size()};
    REQUIRE(buffers.job.run() == Status::kOk);
    pairs.resize(buffers.job.pair_count);
    return pairs;
  }

  void check() const {
    const std::vector<CrowdPair> wanted = expected();
    CHECK(wanted.size() > 200);
    for (const Target target : supported_targets()) {
      for (const std::size_t tasks : {1U, 2U, 5U}) {
        INFO(to_string(target), ", ", tasks, " tasks");
        CHECK(run(target, tasks) == wanted);
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
    REQUIRE(reset_filter(crowd.opened.asset, filter.filter) == Status::kOk);
    for (std::uint32_t i = 1; i < count; ++i) {
      for (std::uint32_t k = 0; k < i; ++k) {
        REQUIRE(ignore_pair(crowd.opened.asset, filter.filter, k, i, k != a || i != b) == Status::kOk);
      }
    }
    const CrowdPair own{instance, {a, b}};
    for (const float padding : {touching, apart}) {
      REQUIRE(pad_sphere(crowd.opened.asset, filter.filter, b, padding) == Status::kOk);
      const bool wanted =
          !detect(crowd.opened.asset, spheres, Method::kM2, RadiusKind::kDetect, Target::kScalar, &filter.filter)
               .pairs.empty();
      for (const Target target : supported_targets()) {
        INFO(to_string(target), ", ", a, " and ", b, " of ", instance);
        const std::vector<CrowdPair> found = crowd.run(target, 1, &filter.filter);
        CHECK(std::count(found.begin(), found.end(), own) == (wanted ? 1 : 0));
      }
    }
  }
}

}  // namespace

TEST_CASE("by moments, a crowd of skeletons gives the pairs of its refitted spheres") {
  CrowdOfBones(Shape{}).check();
  CrowdOfBones(Shape{60, 20}).check();
  CrowdOfBones(Shape{40, 9, 1}).check();
  CrowdOfBones(Shape{40, kMaxMomentBones, kMaxMomentPairs}).check();
  CrowdOfBones(Shape{40, 300, 48, RefitRule::kMoments, false}).check();
  CrowdOfBones(Shape{40, 9, 48, RefitRule::kMoments, true, true}).check();
}

TEST_CASE("by moments, a crowd's spheres are those of a single refit to the last bit") {
  check_last_bits(Shape{});
  check_last_bits(Shape{40, 9, 48, RefitRule::kMoments, true, true});
}

TEST_CASE("bits of a filter past its pairs count for nothing in a crowd") {
  const CrowdOfBones crowd(Shape{});
  OwnedFilter filter(crowd.opened.asset);
  const std::size_t spare = 64 - crowd.sphere_count * (crowd.sphere_count - 1) / 2 % 64;
  REQUIRE(spare < 64);
  filter.ignored.back() |= ~std::uint64_t{0} << (64 - spare);
  const std::vector<CrowdPair> wanted = crowd.expected();
  for (const Target target : supported_targets()) {
    CHECK(crowd.run(target, 1, &filter.filter) == wanted);
  }
}

TEST_CASE("matrices that are not finite cost no other instance a pair, whatever the rule") {
  for (const RefitRule rule : {RefitRule::kPaper, RefitRule::kCalibrated, RefitRule::kMoments}) {
    INFO("rule ", static_cast<int>(rule));
    Shape shape;
    shape.rule = rule;
    CrowdOfBones crowd(shape);
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
      INFO(to_string(target));
      const std::vector<CrowdPair> found = crowd.run(target);
      CHECK(found == wanted);
      const auto of_good = [&](const std::vector<CrowdPair>& pairs) {
        std::vector<CrowdPair> out;
        std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(out),
                     [&](const CrowdPair& pair) { return !is_bad[pair.instance]; });
        return out;
      };
      CHECK(of_good(found).size() > 100);
      CHECK(of_good(found) == of_good(before));
    }
  }
}

}  // namespace spherechain::test
