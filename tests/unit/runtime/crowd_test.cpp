// SPDX-License-Identifier: MIT
// A crowd's pairs are those of a DetectJob an instance, however it is dealt out.
#include "spherechain/crowd.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "crowds.h"
#include "jobs.h"
#include "tiny_bones.h"

namespace spherechain::test {
namespace {

constexpr Sphere kGap{0, 0, 0, std::numeric_limits<float>::infinity()};  // between instances: never to be looked at

struct Expected {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint64_t> bits;
  std::vector<CrowdPair> pairs;
};

struct Crowd {
  Crowd(const Asset& asset, std::size_t instances, std::size_t gap, std::mt19937& random)
      : asset(asset), instances(instances), stride(asset.spheres().size + gap), spheres(instances * stride, kGap) {
    for (std::size_t i = 0; i < instances; ++i) {
      std::vector<Sphere> one = random_spheres(asset.spheres().size, random);
      for (Sphere& sphere : one) sphere.radius *= i % 3 == 0 ? 0.1F : 1.0F;  // some touch hardly at all
      if (i % 7 == 5) one[i % one.size()].x = std::numeric_limits<float>::quiet_NaN();
      if (i % 7 == 6) one[i % one.size()].radius = i % 2 == 0 ? 3e38F : -kGap.radius;
      std::copy(one.begin(), one.end(), spheres.begin() + static_cast<std::ptrdiff_t>(i * stride));
    }
  }

  Expected expected(RadiusKind radius, const Filter* filter) const {
    Expected result;
    for (std::size_t i = 0; i < instances; ++i) {
      const auto begin = spheres.begin() + static_cast<std::ptrdiff_t>(i * stride);
      const std::vector<Sphere> one(begin, begin + static_cast<std::ptrdiff_t>(asset.spheres().size));
      const Detected found = detect(asset, one, Method::kM2, radius, Target::kScalar, filter);
      result.counts.push_back(static_cast<std::uint32_t>(found.pairs.size()));
      result.bits.insert(result.bits.end(), found.bits.begin(), found.bits.end());
      for (const Pair& pair : found.pairs) result.pairs.push_back({static_cast<std::uint32_t>(i), pair});
    }
    return result;
  }

  const Asset& asset;
  std::size_t instances, stride;
  std::vector<Sphere> spheres;
};

struct Run : CrowdBuffers {
  Run(const Crowd& crowd, std::size_t task_count) : CrowdBuffers(crowd.asset, crowd.instances, task_count) {
    job.spheres = crowd.spheres.data();
    job.stride = crowd.stride;
  }
};

}  // namespace

TEST_CASE("a crowd's pairs are each instance's own, on every target, in any number of tasks and threads") {
  for (const unsigned n : {1U, 2U, 12U, 64U, 75U, 140U}) {
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    for (const std::size_t instances : {1U, 3U, 16U, 17U, 70U}) {
      CAPTURE(n);
      CAPTURE(instances);
      const Crowd crowd(opened.asset, instances, instances % 2, random);
      const RadiusKind radius = instances % 2 == 0 ? RadiusKind::kFit : RadiusKind::kDetect;
      const Expected wanted = crowd.expected(radius, nullptr);
      for (const Target target : supported_targets()) {
        for (std::size_t task_count : {1U, 2U, 4U, 9U}) {
          Run run(crowd, task_count);
          run.job.radius = radius;
          run.job.target = target;
          run.job.hook = {task_count == 9 ? nullptr : on_threads, &task_count};
          std::vector<CrowdPair> pairs;
          // Ample room, where each task's pairs fit its share; and little, where some do not.
          for (const std::size_t room : {9 * wanted.pairs.size() + 9, wanted.pairs.size() + 1}) {
            pairs.assign(room, {});
            run.counts.assign(instances, 7);
            run.job.pairs = {pairs.data(), pairs.size()};
            REQUIRE(run.job.run() == Status::kOk);
            CHECK(run.job.pair_count == wanted.pairs.size());
            CHECK(run.counts == wanted.counts);
            pairs.resize(wanted.pairs.size());
            CHECK(pairs == wanted.pairs);
          }

          std::vector<std::uint64_t> bits(wanted.bits.size(), 5);
          std::fill(pairs.begin(), pairs.end(), CrowdPair{});
          run.job.bits = {bits.data(), bits.size()};
          run.job.pairs.size = pairs.size();
          REQUIRE(run.job.run() == Status::kOk);
          CHECK(bits == wanted.bits);
          CHECK(pairs == wanted.pairs);

          run.job.pairs = {};
          for (const bool with_bits : {true, false}) {
            run.counts.assign(instances, 7);
            bits.assign(bits.size(), 5);
            run.job.bits.size = with_bits ? bits.size() : 0;
            REQUIRE(run.job.run() == Status::kOk);
            CHECK(run.counts == wanted.counts);
            CHECK((!with_bits || bits == wanted.bits));
          }

          run.job.bits = {};
          run.job.counts = {};
          run.job.pair_count = 0;
          REQUIRE(run.job.run() == Status::kOk);
          CHECK(run.job.pair_count == wanted.pairs.size());
        }
      }
    }
  }
}

TEST_CASE("a crowd takes a filter as a single job does") {
  std::mt19937 random(5);
  const OpenedAsset opened(random_asset(70, 5).parts);
  std::vector<std::uint64_t> ignored(Filter::ignored_words(opened.asset)), disabled(2);
  std::vector<float> padding(70);
  Filter filter{{ignored.data(), ignored.size()}, {disabled.data(), 2}, {padding.data(), 70}};
  REQUIRE(reset_filter(opened.asset, filter) == Status::kOk);
  for (std::uint32_t i = 0; i < 70; ++i) {
    if (random() % 4 == 0) REQUIRE(disable_sphere(opened.asset, filter, i) == Status::kOk);
    REQUIRE(pad_sphere(opened.asset, filter, i, uniform(random, -0.05F, 0.1F)) == Status::kOk);
    if (i > 0)
      REQUIRE(ignore_pair(opened.asset, filter, i, static_cast<std::uint32_t>(random() % i), random() % 2 == 0) ==
              Status::kOk);
  }
  const Crowd crowd(opened.asset, 40, 0, random);
  const Expected wanted = crowd.expected(RadiusKind::kDetect, &filter);
  CHECK(!wanted.pairs.empty());
  for (const Target target : supported_targets()) {
    Run run(crowd, 3);
    std::vector<CrowdPair> pairs(wanted.pairs.size());
    run.job.pairs = {pairs.data(), pairs.size()};
    run.job.target = target;
    run.job.filter = &filter;
    run.job.stride = 0;
    REQUIRE(run.job.run() == Status::kOk);
    CHECK(pairs == wanted.pairs);
    CHECK(run.counts == wanted.counts);
  }
}

TEST_CASE("bones in, pairs out: a crowd of skeletons gives the pairs of its refitted spheres, morphed or not") {
  TinyAsset tiny = random_asset(60, 8);
  give_pivots(tiny, 5, 19, 2);  // three groups of eight, the last with spare lanes
  give_pivots(tiny, 7, 1, 3);
  give_pivots(tiny, 8, 16, 4);
  add_bones(tiny, 9, 8);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  constexpr std::size_t kInstances = 37, kStride = 9 * sizeof(Matrix) + 8;  // bytes; some between instances
  const std::size_t morphs = opened.asset.morph_count();
  REQUIRE(morphs > 0);
  std::mt19937 random(8);
  std::vector<float> matrices(kInstances * kStride / 4, 1e30F), weights(kInstances * morphs);
  for (float& weight : weights) weight = uniform(random, -1, 1);
  std::vector<Sphere> spheres[2];
  for (std::size_t i = 0; i < kInstances; ++i) {
    const std::vector<Matrix> own = random_matrices(9, static_cast<unsigned>(i));
    std::memcpy(&matrices[i * kStride / 4], own.data(), 9 * sizeof(Matrix));
    const auto first = weights.begin() + static_cast<std::ptrdiff_t>(i * morphs);
    for (const bool morphed : {false, true}) {
      const std::vector<float> one =
          morphed ? std::vector<float>(first, first + static_cast<std::ptrdiff_t>(morphs)) : std::vector<float>();
      const Refitted refitted = refit_bones(opened.asset, {own[0].data(), 9, MatrixLayout::kRowMajor3x4, 48}, one,
                                            RadiusKind::kDetect, Target::kScalar);
      REQUIRE(refitted.status == Status::kOk);
      spheres[morphed].insert(spheres[morphed].end(), refitted.spheres.begin(), refitted.spheres.end());
    }
  }
  for (const bool morphed : {false, true}) {
    Crowd crowd(opened.asset, kInstances, 0, random);
    crowd.spheres = spheres[morphed];
    const Expected wanted = crowd.expected(RadiusKind::kDetect, nullptr);
    CHECK(wanted.pairs.size() > 100);
    for (const Target target : supported_targets()) {
      for (const std::size_t tasks : {1U, 3U}) {
        Run run(crowd, tasks);
        std::vector<CrowdPair> pairs(wanted.pairs.size());
        run.job.spheres = nullptr;
        run.job.bones = {matrices.data(), 9, MatrixLayout::kRowMajor3x4, 48};
        run.job.instance_stride = kStride;
        if (morphed) run.job.morph_weights = {weights.data(), weights.size()};
        run.job.target = target;
        run.job.pairs = {pairs.data(), pairs.size()};
        REQUIRE(run.job.run() == Status::kOk);
        CHECK(pairs == wanted.pairs);
        CHECK(run.counts == wanted.counts);
        if (tasks > 1) continue;
        const auto refused = [&](Status status, auto change) {
          CrowdJob job = run.job;
          change(job);
          CHECK(job.run() == status);
        };
        refused(Status::kBadArgument, [&](CrowdJob& j) { j.spheres = crowd.spheres.data(); });
        refused(Status::kTooFewBones, [](CrowdJob& j) { j.bones.count = 8; });
        refused(Status::kBadStride, [](CrowdJob& j) { j.bones.stride = 44; });
        refused(Status::kBadStride, [](CrowdJob& j) { j.instance_stride = 9 * 48 - 4; });
        refused(Status::kBadStride, [](CrowdJob& j) { j.instance_stride += 2; });
        refused(Status::kBadStride, [](CrowdJob& j) { j.instance_stride = ~std::size_t{3}; });
        refused(Status::kBadStride, [](CrowdJob& j) { j.bones.stride = ~std::size_t{3}; });
        refused(Status::kTooFewMorphs, [&](CrowdJob& j) { j.morph_weights = {weights.data(), weights.size() - 1}; });
        refused(Status::kNullArgument, [&](CrowdJob& j) { j.morph_weights = {nullptr, weights.size()}; });
        refused(Status::kSharedMemory,
                [&](CrowdJob& j) { j.counts.data = reinterpret_cast<std::uint32_t*>(&matrices.back() - 60); });
        refused(Status::kSharedMemory, [&](CrowdJob& j) {
          j.morph_weights = {weights.data(), weights.size()};
          j.counts.data = reinterpret_cast<std::uint32_t*>(weights.data());
        });
      }
    }
  }
  const OpenedAsset without(random_asset(60, 8).parts);
  std::mt19937 again(1);
  const Crowd crowd(without.asset, 2, 0, again);
  Run run(crowd, 1);
  run.job.spheres = nullptr;
  run.job.bones = {matrices.data(), 9, MatrixLayout::kRowMajor3x4, 48};
  run.job.instance_stride = kStride;
  CHECK(run.job.run() == Status::kNotInAsset);
}

TEST_CASE("a crowd takes matrices of every layout, and reads none but theirs") {
  TinyAsset tiny = random_asset(40, 9);
  add_bones(tiny, 5, 9);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  constexpr std::size_t kInstances = 21;
  std::vector<CrowdPair> wanted;
  for (const MatrixLayout layout : {MatrixLayout::kRowMajor3x4, MatrixLayout::kRowMajor4x4,
                                    MatrixLayout::kColumnMajor4x4, MatrixLayout::kColumnMajor3x4}) {
    const std::size_t floats = size_of(layout) / 4;
    std::vector<float> matrices(kInstances * 5 * floats, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < kInstances; ++i) {
      const std::vector<Matrix> own = random_matrices(5, static_cast<unsigned>(i));
      for (std::size_t at = 0; at < 5 * 12; ++at) {
        const std::size_t row = at % 12 / 4, column = at % 4;
        const std::size_t place = layout == MatrixLayout::kColumnMajor4x4   ? 4 * column + row
                                  : layout == MatrixLayout::kColumnMajor3x4 ? 3 * column + row
                                                                            : 4 * row + column;
        matrices[(i * 5 + at / 12) * floats + place] = own[at / 12][at % 12];
      }
    }
    for (const Target target : supported_targets()) {
      std::mt19937 random(1);
      const Crowd crowd(opened.asset, kInstances, 0, random);
      Run run(crowd, 1);
      std::vector<CrowdPair> pairs(kInstances * 40 * 40);
      run.job.spheres = nullptr;
      run.job.bones = {matrices.data(), 5, layout, size_of(layout)};
      run.job.instance_stride = 5 * size_of(layout);
      run.job.target = target;
      run.job.pairs = {pairs.data(), pairs.size()};
      REQUIRE(run.job.run() == Status::kOk);
      pairs.resize(run.job.pair_count);
      if (wanted.empty()) wanted = pairs;
      CHECK(pairs.size() > 20);
      CHECK(pairs == wanted);
    }
  }
}

TEST_CASE("a crowd's overflow writes the first pairs and says how many there are") {
  std::mt19937 random(6);
  const OpenedAsset opened(random_asset(30, 6).parts);
  const Crowd crowd(opened.asset, 33, 0, random);
  const Expected wanted = crowd.expected(RadiusKind::kDetect, nullptr);
  REQUIRE(wanted.pairs.size() > 200);
  for (const std::size_t tasks : {1U, 3U}) {
    Run run(crowd, tasks);
    const CrowdPair untouched{77, {77, 77}};
    std::vector<CrowdPair> pairs(201, untouched);
    run.job.pairs = {pairs.data(), 200};
    CHECK(run.job.run() == Status::kOverflow);
    CHECK(run.job.pair_count == wanted.pairs.size());
    CHECK(run.counts == wanted.counts);
    CHECK(std::equal(pairs.begin(), pairs.begin() + 200, wanted.pairs.begin()));
    CHECK(pairs[200] == untouched);
  }
}

TEST_CASE("a crowd of none is done; what cannot be used is refused and nothing is written") {
  std::mt19937 random(7);
  const OpenedAsset opened(random_asset(30, 7).parts);
  const Crowd crowd(opened.asset, 20, 0, random);
  Run run(crowd, 2);
  std::vector<CrowdPair> pairs(4000);
  std::vector<std::uint64_t> bits(20 * DetectJob::bit_words(opened.asset), 3);
  run.job.pairs = {pairs.data(), pairs.size()};
  run.job.bits = {bits.data(), bits.size()};
  const Asset closed;
  const auto refused = [&](Status wanted, auto change) {
    CrowdJob job = run.job;
    job.pair_count = 99;
    const auto before_words = run.words;
    change(job);
    CHECK(job.run() == wanted);
    CHECK(job.pair_count == 99);
    CHECK(run.words == before_words);
    CHECK(run.counts == std::vector<std::uint32_t>(20, 7));
    CHECK(bits[0] == 3);
  };
  CrowdContext small{{run.words.data(), run.words.size() - 1}}, null{{nullptr, run.words.size()}};
  const Filter empty{};
  refused(Status::kNullArgument, [](CrowdJob& j) { j.asset = nullptr; });
  refused(Status::kNullArgument, [](CrowdJob& j) { j.spheres = nullptr; });
  refused(Status::kNullArgument, [](CrowdJob& j) { j.context = nullptr; });
  refused(Status::kNullArgument, [&](CrowdJob& j) { j.context = &null; });
  refused(Status::kNullArgument, [](CrowdJob& j) { j.counts.data = nullptr; });
  refused(Status::kNullArgument, [](CrowdJob& j) { j.bits.data = nullptr; });
  refused(Status::kNullArgument, [](CrowdJob& j) { j.pairs.data = nullptr; });
  refused(Status::kNotOpen, [&](CrowdJob& j) { j.asset = &closed; });
  refused(Status::kTooFewSpheres, [](CrowdJob& j) { j.stride = 29; });
  refused(Status::kContextTooSmall, [&](CrowdJob& j) { j.context = &small; });
  refused(Status::kContextTooSmall, [&](CrowdJob& j) { j.task_count = 3; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.task_count = 0; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.task_count = ~std::size_t{0}; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.instance_count = ~std::size_t{0}; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.stride = ~std::size_t{0}; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.counts.size = 19; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.counts = {}; });
  refused(Status::kBadArgument, [](CrowdJob& j) { --j.bits.size; });
  refused(Status::kBadArgument, [](CrowdJob& j) { j.radius = static_cast<RadiusKind>(2); });
  refused(Status::kBadFilter, [&](CrowdJob& j) { j.filter = &empty; });
  refused(Status::kUnsupportedTarget, [](CrowdJob& j) { j.target = static_cast<Target>(9); });
  refused(Status::kSharedMemory,
          [&](CrowdJob& j) { j.pairs.data = reinterpret_cast<CrowdPair*>(run.words.data() + 5); });
  refused(Status::kSharedMemory, [&](CrowdJob& j) { j.spheres = reinterpret_cast<const Sphere*>(pairs.data()); });
  refused(Status::kSharedMemory, [&](CrowdJob& j) { j.counts.data = reinterpret_cast<std::uint32_t*>(bits.data()); });
  CHECK(run.job.run() == Status::kOk);

  run.job.instance_count = 0;
  run.job.spheres = nullptr;
  run.job.bits = {};
  CHECK(run.job.run() == Status::kOk);
  CHECK(run.job.pair_count == 0);
}

}  // namespace spherechain::test
