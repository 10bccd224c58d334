// SPDX-License-Identifier: MIT
// A crowd's pairs are those of a detect job an instance, however it is dealt out.
#include <doctest/doctest.h>

#include <algorithm>

#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "palette.h"
#include "runtime/src/base/pair_bits.h"

namespace spherechain::test {
namespace {

constexpr Sphere kGap{0, 0, 0, kInfinity};  // between instances: never to be looked at

struct Expected {
  std::vector<std::uint32_t> counts;
  std::vector<std::uint64_t> bits, part_pairs;
  std::vector<CrowdPair> pairs;
};

struct Crowd {
  Crowd(const Asset& asset, std::size_t instances, std::size_t gap, std::mt19937& random)
      : asset(asset),
        instances(instances),
        stride(view_of(asset).spheres().size + gap),
        spheres(instances * stride, kGap) {
    for (std::size_t i = 0; i < instances; ++i) {
      std::vector<Sphere> one = random_spheres(view_of(asset).spheres().size, random);
      for (Sphere& sphere : one) sphere.radius *= i % 3 == 0 ? 0.1F : 1.0F;  // some touch hardly at all
      if (i % 7 == 5) one[i % one.size()].x = kNan;
      if (i % 7 == 6) one[i % one.size()].radius = i % 2 == 0 ? 3e38F : -kGap.radius;
      std::copy(one.begin(), one.end(), spheres.begin() + static_cast<std::ptrdiff_t>(i * stride));
    }
  }

  Expected expected(Radius radius, const Filter* filter) const {
    Expected result;
    for (std::size_t i = 0; i < instances; ++i) {
      const auto begin = spheres.begin() + static_cast<std::ptrdiff_t>(i * stride);
      const std::vector<Sphere> one(begin, begin + static_cast<std::ptrdiff_t>(view_of(asset).spheres().size));
      const Detected found = detect(asset, one, radius, SC_TARGET_SCALAR, filter);
      result.counts.push_back(static_cast<std::uint32_t>(found.pairs.size()));
      result.bits.insert(result.bits.end(), found.bits.begin(), found.bits.end());
      const std::size_t parts = view_of(asset).part_count(), first = result.part_pairs.size();
      result.part_pairs.resize(first + words_for(parts * parts));
      for (const Pair& pair : found.pairs) {
        result.pairs.push_back({static_cast<std::uint32_t>(i), pair});
        const auto [p, q] = std::minmax(view_of(asset).spheres()[pair.a].part, view_of(asset).spheres()[pair.b].part);
        result.part_pairs[first + (p * parts + q) / 64] |= std::uint64_t{1} << (p * parts + q) % 64;
      }
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
    job.instance_stride = crowd.stride;
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
      const Radius radius = instances % 2 == 0 ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
      const Expected wanted = crowd.expected(radius, nullptr);
      for (const Target target : supported_targets()) {
        for (std::size_t task_count : {1U, 2U, 4U, 9U}) {
          Run run(crowd, task_count);
          run.job.radius = radius;
          run.job.target = target;
          run.job.parallel_for = task_count == 9 ? nullptr : on_threads;
          run.job.user = &task_count;
          std::vector<CrowdPair> pairs;
          // Ample room, where each task's pairs fit its share; and little, where some do not.
          for (const std::size_t room : {9 * wanted.pairs.size() + 9, wanted.pairs.size() + 1}) {
            pairs.assign(room, {});
            run.counts.assign(instances, 7);
            run.job.pairs = pairs.data();
            run.job.pair_capacity = pairs.size();
            REQUIRE(run.job.run() == SC_OK);
            CHECK(run.job.pair_count == wanted.pairs.size());
            CHECK(run.counts == wanted.counts);
            pairs.resize(wanted.pairs.size());
            CHECK(same_bits(pairs, wanted.pairs));
          }

          std::vector<std::uint64_t> bits(wanted.bits.size(), 5), part_pairs(wanted.part_pairs.size(), 5);
          run.job.part_pairs = part_pairs.data();
          run.job.part_pair_words = part_pairs.size();
          std::fill(pairs.begin(), pairs.end(), CrowdPair{});
          run.job.bits = bits.data();
          run.job.bit_words = bits.size();
          run.job.pair_capacity = pairs.size();
          REQUIRE(run.job.run() == SC_OK);
          CHECK(bits == wanted.bits);
          CHECK(part_pairs == wanted.part_pairs);
          CHECK(same_bits(pairs, wanted.pairs));

          run.job.pairs = nullptr;
          run.job.pair_capacity = 0;
          for (const bool with_bits : {true, false}) {
            run.counts.assign(instances, 7);
            bits.assign(bits.size(), 5);
            part_pairs.assign(part_pairs.size(), 5);
            run.job.bit_words = with_bits ? bits.size() : 0;
            REQUIRE(run.job.run() == SC_OK);
            CHECK(run.counts == wanted.counts);
            CHECK((!with_bits || bits == wanted.bits));
            CHECK(part_pairs == wanted.part_pairs);
          }

          run.job.bits = nullptr;
          run.job.bit_words = 0;
          run.job.counts = nullptr;
          run.job.count_capacity = 0;
          run.job.pair_count = 0;
          REQUIRE(run.job.run() == SC_OK);
          CHECK(run.job.pair_count == wanted.pairs.size());
        }
      }
    }
  }
}

TEST_CASE("a crowd takes ignored pairs as a single job does") {
  std::mt19937 random(5);
  const OpenedAsset opened(random_asset(70, 5).parts);
  OwnedFilter owned(opened.asset);
  for (std::uint32_t b = 1; b < 70; ++b) {
    const auto a = static_cast<std::uint32_t>(random() % b);
    owned.ignore(a, b, random() % 2 != 0);
  }
  const Crowd crowd(opened.asset, 40, 0, random);
  const Expected wanted = crowd.expected(SC_RADIUS_DETECT, &owned.filter);
  CHECK(!wanted.pairs.empty());
  for (const Target target : supported_targets()) {
    Run run(crowd, 3);
    std::vector<CrowdPair> pairs(wanted.pairs.size());
    run.job.pairs = pairs.data();
    run.job.pair_capacity = pairs.size();
    run.job.target = target;
    run.job.ignored_pairs = owned.ignored.data();
    run.job.instance_stride = 0;
    REQUIRE(run.job.run() == SC_OK);
    CHECK(same_bits(pairs, wanted.pairs));
    CHECK(run.counts == wanted.counts);
  }
}

TEST_CASE("a crowd takes matrices of every layout, and reads none but theirs") {
  TinyAsset tiny = random_asset(40, 9);
  add_bones(tiny, 5, 9);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  constexpr std::size_t kInstances = 21;
  std::vector<CrowdPair> wanted;
  for (const MatrixLayout layout : kLayouts) {
    const std::size_t floats = floats_of(layout);
    std::vector<float> matrices(kInstances * 5 * floats, kNan);
    for (std::size_t i = 0; i < kInstances; ++i) {
      const std::vector<Matrix> own = random_matrices(5, static_cast<unsigned>(i));
      for (std::size_t bone = 0; bone < 5; ++bone) {
        put_matrix(own[bone], layout, &matrices[(i * 5 + bone) * floats]);
      }
    }
    for (const Target target : supported_targets()) {
      std::mt19937 random(1);
      const Crowd crowd(opened.asset, kInstances, 0, random);
      Run run(crowd, 1);
      std::vector<CrowdPair> pairs(kInstances * 40 * 40);
      run.job.spheres = nullptr;
      run.job.pose.bones = matrices.data();
      run.job.pose.bone_count = 5;
      run.job.pose.bone_layout = layout;
      run.job.instance_stride = 5 * floats * sizeof(float);
      run.job.target = target;
      run.job.pairs = pairs.data();
      run.job.pair_capacity = pairs.size();
      REQUIRE(run.job.run() == SC_OK);
      pairs.resize(run.job.pair_count);
      if (wanted.empty()) wanted = pairs;
      CHECK(pairs.size() > 20);
      CHECK(same_bits(pairs, wanted));
    }
  }
}

TEST_CASE("a crowd's overflow writes the first pairs and says how many there are") {
  std::mt19937 random(6);
  const OpenedAsset opened(random_asset(30, 6).parts);
  const Crowd crowd(opened.asset, 33, 0, random);
  const Expected wanted = crowd.expected(SC_RADIUS_DETECT, nullptr);
  REQUIRE(wanted.pairs.size() > 200);
  for (const std::size_t tasks : {1U, 3U}) {
    Run run(crowd, tasks);
    const CrowdPair untouched{77, {77, 77}};
    std::vector<CrowdPair> pairs(201, untouched);
    run.job.pairs = pairs.data();
    run.job.pair_capacity = 200;
    CHECK(run.job.run() == SC_OVERFLOW);
    CHECK(run.job.pair_count == wanted.pairs.size());
    CHECK(run.counts == wanted.counts);
    CHECK(std::memcmp(pairs.data(), wanted.pairs.data(), 200 * sizeof(CrowdPair)) == 0);
    CHECK(pairs[200].instance == 77);
  }
}

TEST_CASE("a crowd of none is done") {
  const OpenedAsset opened(random_asset(30, 7).parts);
  CrowdBuffers buffers(opened.asset, 0, 0);
  buffers.job.pair_count = 99;
  CHECK(buffers.job.run() == SC_OK);
  CHECK(buffers.job.pair_count == 0);
}

}  // namespace spherechain::test
