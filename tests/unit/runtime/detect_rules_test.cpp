// SPDX-License-Identifier: MIT
// The rules for one pair, the buffers, and what a job refuses.
#include <doctest/doctest.h>

#include <cmath>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

// n spheres, nothing ignored, no near pairs, one chain of all.
AssetParts plain_asset(std::uint32_t n) {
  AssetParts parts = random_asset(n, 1).parts;
  parts.ignored.assign(parts.ignored.size(), 0);
  parts.near_fit.clear();
  parts.near_detect.clear();
  parts.chains.assign(1, {"all", {0}, {}});
  for (std::uint32_t i = 0; i < n; ++i) {
    parts.chains[0].spheres.push_back(i);
  }
  return parts;
}

// What both methods find; they must agree, for the one chain holds all.
std::vector<Pair> pairs_of(const AssetParts& parts, const std::vector<Sphere>& spheres,
                           RadiusKind kind = RadiusKind::kDetect) {
  const OpenedAsset opened(parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const Detected m1 = detect(opened.asset, spheres, Method::kM1, kind);
  const Detected m2 = detect(opened.asset, spheres, Method::kM2, kind);
  CHECK(m1.pairs == m2.pairs);
  CHECK(m1.test_count == m2.test_count);
  return m2.pairs;
}

struct Buffers {
  explicit Buffers(const Asset& asset) : words(DetectContext::words_needed(asset)), pairs(200), chain_pairs(200) {
    context.words = {words.data(), words.size()};
  }
  DetectJob job(const Asset& asset, const std::vector<Sphere>& spheres, Method method) {
    DetectJob job;
    job.asset = &asset;
    job.spheres = {spheres.data(), spheres.size()};
    job.method = method;
    job.context = &context;
    job.pairs = {pairs.data(), pairs.size()};
    job.chain_pairs = {chain_pairs.data(), chain_pairs.size()};
    return job;
  }
  std::vector<std::uint64_t> words;
  DetectContext context;
  std::vector<Pair> pairs;
  std::vector<ChainPair> chain_pairs;
};

}  // namespace

TEST_CASE("spheres overlap where they share a point inside both, not where they only touch") {
  const AssetParts parts = plain_asset(2);
  CHECK(pairs_of(parts, {{0, 0, 0, 1}, {0, 3, 0, 2}}).empty());
  CHECK(pairs_of(parts, {{0, 0, 0, 1}, {0, std::nextafter(3.0F, 0.0F), 0, 2}}).size() == 1);
  CHECK(pairs_of(parts, {{0, 0, 0, 0}, {0, 0, 0, 0}}).empty());
  CHECK(pairs_of(parts, {{1, 2, 3, 0.5F}, {1, 2, 3, 0}}).size() == 1);
}

TEST_CASE("the squared distance is summed in the order the header gives, where the last bit decides") {
  const OpenedAsset opened(plain_asset(2));
  std::mt19937 random(3);
  int other_order_differs = 0, fused_differs = 0;
  for (int i = 0; i < 5000; ++i) {
    const Sphere p{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1), 0.0F};
    Sphere q{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1), 0.0F};
    const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
    const float d2 = (dx * dx + dy * dy) + dz * dz;
    q.radius = std::sqrt(d2);  // they touch, as nearly as a float can say
    const float reach = q.radius * q.radius;
    const bool overlaps = !detect(opened.asset, {p, q}, Method::kM2, RadiusKind::kFit).pairs.empty();
    CHECK(overlaps == (d2 < reach));
    other_order_differs += overlaps != (dx * dx + (dy * dy + dz * dz) < reach);
    fused_differs += overlaps != (std::fma(dz, dz, std::fma(dy, dy, dx * dx)) < reach);
  }
  CHECK(other_order_differs > 100);
  CHECK(fused_differs > 100);
}

TEST_CASE("an ignored pair is neither tested nor reported") {
  AssetParts parts = plain_asset(3);
  parts.ignored[0] = 1U << 1;  // bit b(b-1)/2 + a: a = 0, b = 2
  const std::vector<Sphere> heap(3, {0, 0, 0, 1});
  CHECK(pairs_of(parts, heap) == std::vector<Pair>{{0, 1}, {1, 2}});
  const OpenedAsset opened(parts);
  CHECK(detect(opened.asset, heap, Method::kM1, RadiusKind::kFit).test_count == 2);
  CHECK(detect(opened.asset, heap, Method::kM2, RadiusKind::kFit).test_count == 2);
}

TEST_CASE("a near pair is reported only within its reach, which each radius has of its own") {
  AssetParts parts = plain_asset(2);
  parts.near_fit = {{0, 1, 0.75F}};
  parts.near_detect = {{0, 1, 0.5F}};
  const auto apart = [](float distance) { return std::vector<Sphere>{{0, 0, 0, 1}, {distance, 0, 0, 1}}; };
  CHECK(pairs_of(parts, apart(1.6F), RadiusKind::kFit).empty());
  CHECK(pairs_of(parts, apart(1.5F), RadiusKind::kFit).empty());
  CHECK(pairs_of(parts, apart(1.4F), RadiusKind::kFit).size() == 1);
  CHECK(pairs_of(parts, apart(1.4F), RadiusKind::kDetect).empty());
  CHECK(pairs_of(parts, apart(0.9F), RadiusKind::kDetect).size() == 1);
  parts.near_detect[0].reach = 0;
  CHECK(pairs_of(parts, apart(0.0F), RadiusKind::kDetect).empty());
  parts.near_detect[0].reach = 0.75F;
  parts.ignored[0] = 1;
  CHECK(pairs_of(parts, apart(0.0F), RadiusKind::kDetect).empty());
}

TEST_CASE("a reach just below 1 is judged by the formula alone, at the distances where the full reach flips") {
  AssetParts parts = plain_asset(2);
  const float reach = std::nextafter(1.0F, 0.0F);
  parts.near_detect = {{0, 1, reach}};
  const OpenedAsset opened(parts);
  std::mt19937 random(2);
  int reported = 0;
  for (int i = 0; i < 1000; ++i) {
    const float p = uniform(random, 0, 1), q = uniform(random, 0, 1);
    for (const float d :
         {p + q, std::nextafter(p + q, 0.0F), std::nextafter(p + q, 4.0F), std::nextafter(reach * (p + q), 0.0F)}) {
      const std::vector<Sphere> spheres{{0, 0, 0, p}, {0, d, 0, q}};
      const float s = reach * (p + q);
      const bool expected = d * d < s * s;  // the full reach is not asked
      CHECK(detect(opened.asset, spheres, Method::kM2, RadiusKind::kDetect).pairs.size() == (expected ? 1 : 0));
      reported += expected ? 1 : 0;
    }
  }
  CHECK(reported > 0);
}

TEST_CASE("a sphere that is not finite touches nothing") {
  const AssetParts parts = plain_asset(2);
  const std::vector<Sphere> odd = {{kNan, 0, 0, 1},       {0, kInfinity, 0, 1}, {0, 0, -kInfinity, 1},
                                   {0, 0, 0, kNan},       {0, 0, 0, kInfinity}, {kInfinity, 0, 0, kInfinity},
                                   {0, 0, 0, -kInfinity}, {0, 0, 0, 3e38F},     {3e38F, 0, 0, 1}};
  for (const Sphere& sphere : odd) {
    CAPTURE(sphere.x);
    CAPTURE(sphere.radius);
    CHECK(pairs_of(parts, {sphere, {0, 0, 0, 2}}).empty());
    for (const Sphere& other : odd) {
      // Two of the last kind are finite and in one place: the only ones to overlap.
      const bool overlaps = sphere.x == 3e38F && other.x == 3e38F;
      CHECK(pairs_of(parts, {sphere, other}).size() == (overlaps ? 1 : 0));
    }
  }
}

TEST_CASE("an overflow says how many entries were needed and writes the first ones") {
  const OpenedAsset opened(plain_asset(5));
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  for (const Method method : {Method::kM1, Method::kM2}) {
    Buffers buffers(opened.asset);
    const Pair untouched{77, 77};
    buffers.pairs.assign(4, untouched);
    DetectJob job = buffers.job(opened.asset, heap, method);
    job.pairs.size = 3;
    CHECK(job.run() == Status::kOverflow);
    CHECK(job.pair_count == 10);
    CHECK(job.chain_pair_count == 10);
    CHECK(job.test_count == 10);
    CHECK(buffers.pairs == std::vector<Pair>{{0, 1}, {0, 2}, {0, 3}, untouched});

    job.pairs.size = 0;  // to count only
    CHECK(job.run() == Status::kOk);
    CHECK(job.pair_count == 10);

    job.chain_pairs.size = 9;
    CHECK(job.run() == (method == Method::kM1 ? Status::kOverflow : Status::kOk));
    CHECK(job.chain_pair_count == 10);
  }
}

TEST_CASE("buffers of exactly the size needed do not overflow") {
  const OpenedAsset opened(plain_asset(5));
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  Buffers buffers(opened.asset);
  DetectJob job = buffers.job(opened.asset, heap, Method::kM1);
  job.pairs.size = 10;
  job.chain_pairs.size = 10;
  CHECK(job.run() == Status::kOk);
}

TEST_CASE("detect refuses what it cannot use and writes nothing") {
  const OpenedAsset opened(plain_asset(5));
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  const Asset closed;
  Buffers buffers(opened.asset);
  buffers.pairs.assign(200, {77, 77});
  const auto status_of = [&](Method method, auto change) {
    DetectJob job = buffers.job(opened.asset, heap, method);
    job.pair_count = job.chain_pair_count = job.test_count = 99;
    change(job);
    const Status status = job.run();
    CHECK(job.pair_count == 99);
    CHECK(job.chain_pair_count == 99);
    CHECK(job.test_count == 99);
    return status;
  };
  DetectContext small{{buffers.words.data(), 0}};
  DetectContext null{{nullptr, 1}};
  for (const Method method : {Method::kM1, Method::kM2}) {
    CHECK(status_of(method, [](DetectJob& j) { j.asset = nullptr; }) == Status::kNullArgument);
    CHECK(status_of(method, [](DetectJob& j) { j.spheres.data = nullptr; }) == Status::kNullArgument);
    CHECK(status_of(method, [](DetectJob& j) { j.pairs.data = nullptr; }) == Status::kNullArgument);
    CHECK(status_of(method, [&](DetectJob& j) { j.asset = &closed; }) == Status::kNotOpen);
    CHECK(status_of(method, [](DetectJob& j) { j.spheres.size = 4; }) == Status::kTooFewSpheres);
    CHECK(status_of(method, [](DetectJob& j) { j.radius = static_cast<RadiusKind>(2); }) == Status::kBadArgument);
    CHECK(status_of(method, [](DetectJob& j) { j.target = static_cast<Target>(7); }) == Status::kUnsupportedTarget);
  }
  CHECK(status_of(Method::kM1, [](DetectJob& j) { j.method = static_cast<Method>(0); }) == Status::kBadArgument);
  CHECK(status_of(Method::kM1, [](DetectJob& j) { j.method = static_cast<Method>(3); }) == Status::kBadArgument);
  CHECK(status_of(Method::kM1, [](DetectJob& j) { j.context = nullptr; }) == Status::kNullArgument);
  CHECK(status_of(Method::kM1, [&](DetectJob& j) { j.context = &null; }) == Status::kNullArgument);
  CHECK(status_of(Method::kM1, [](DetectJob& j) { j.chain_pairs.data = nullptr; }) == Status::kNullArgument);
  CHECK(status_of(Method::kM1, [&](DetectJob& j) { j.context = &small; }) == Status::kContextTooSmall);
  std::vector<std::uint64_t> bits(2);
  for (const Method method : {Method::kM1, Method::kM2}) {
    CHECK(status_of(method, [&](DetectJob& j) { j.bits = {bits.data(), 2}; }) == Status::kBadArgument);
    CHECK(status_of(method, [&](DetectJob& j) { j.bits = {nullptr, 1}; }) == Status::kNullArgument);
  }
  CHECK(status_of(Method::kM1, [](DetectJob& j) { j.first_only = true; }) == Status::kBadArgument);
  CHECK(buffers.pairs == std::vector<Pair>(200, {77, 77}));
}

TEST_CASE("detect refuses to write where it reads or writes something else") {
  const OpenedAsset opened(plain_asset(5));
  // One block of memory that every buffer is cut from; those that do not overlap are fine.
  std::vector<std::uint64_t> memory(64, 7);
  float* floats = reinterpret_cast<float*>(memory.data());
  for (std::size_t i = 0; i < 20; ++i) floats[i] = 1.0F;  // five spheres: words 0 to 9
  DetectContext context;
  DetectJob job;
  job.asset = &opened.asset;
  job.context = &context;
  job.spheres = {reinterpret_cast<const Sphere*>(memory.data()), 5};
  const auto at = [&](std::size_t pairs, std::size_t bits, std::size_t words, std::size_t chain_pairs, Method method) {
    job.method = method;
    job.pairs = {reinterpret_cast<Pair*>(memory.data() + pairs), 10};
    job.bits = {memory.data() + bits, 1};
    context.words = {memory.data() + words, 1};
    job.chain_pairs = {reinterpret_cast<ChainPair*>(memory.data() + chain_pairs), 10};
    const std::vector<std::uint64_t> before = memory;
    const Status status = job.run();
    if (status != Status::kOk) CHECK(memory == before);
    return status;
  };
  for (const Method method : {Method::kM1, Method::kM2}) {
    CHECK(at(10, 20, 21, 22, method) == Status::kOk);
    CHECK(at(9, 20, 21, 22, method) == Status::kSharedMemory);
    CHECK(at(10, 19, 21, 22, method) == Status::kSharedMemory);
    CHECK(at(10, 0, 21, 22, method) == Status::kSharedMemory);
  }
  CHECK(at(10, 20, 20, 22, Method::kM1) == Status::kSharedMemory);
  CHECK(at(10, 20, 20, 22, Method::kM2) == Status::kOk);  // M2 needs neither of them
  CHECK(at(10, 20, 21, 21, Method::kM1) == Status::kSharedMemory);
  CHECK(at(10, 20, 21, 21, Method::kM2) == Status::kOk);
  CHECK(at(10, 20, 9, 22, Method::kM1) == Status::kSharedMemory);
}

TEST_CASE("M2 needs no context") {
  const OpenedAsset opened(plain_asset(5));
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  DetectJob job;
  job.asset = &opened.asset;
  job.spheres = {heap.data(), heap.size()};
  CHECK(job.run() == Status::kOk);
  CHECK(job.pair_count == 10);
}

TEST_CASE("one sphere touches nothing and needs no scratch memory") {
  const OpenedAsset opened(plain_asset(1));
  CHECK(DetectContext::words_needed(opened.asset) == 0);
  CHECK(pairs_of(plain_asset(1), {{0, 0, 0, 1}}).empty());
}

}  // namespace spherechain::test
