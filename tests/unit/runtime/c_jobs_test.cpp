// SPDX-License-Identifier: MIT
// The C API's jobs against the C++ ones.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>

#include "both_apis.h"
#include "spherechain/crowd.h"

namespace spherechain::test {
namespace {

template <typename Job, typename Run>
void check_size(Job job, Run run) {
  CHECK(run(&job) == SC_NULL_ARGUMENT);  // no asset
  for (const std::size_t size : {std::size_t{0}, sizeof job - 8, sizeof job + 8}) {
    job.struct_size = size;
    CHECK(run(&job) == SC_WRONG_ABI);
  }
  CHECK(run(static_cast<Job*>(nullptr)) == SC_NULL_ARGUMENT);
}

}  // namespace

TEST_CASE("C: a struct of another size is refused, and so is none") {
  check_size<sc_refit_job>(SC_REFIT_JOB_INIT, sc_refit);
  check_size<sc_refit_bones_job>(SC_REFIT_BONES_JOB_INIT, sc_refit_bones);
  check_size<sc_cover_job>(SC_COVER_JOB_INIT, sc_cover);
  check_size<sc_skin_job>(SC_SKIN_JOB_INIT, sc_skin);
  check_size<sc_detect_job>(SC_DETECT_JOB_INIT, sc_detect);
  check_size<sc_contact_job>(SC_CONTACT_JOB_INIT, sc_contacts);
  check_size<sc_triangle_contact_job>(SC_TRIANGLE_CONTACT_JOB_INIT, sc_triangle_contacts);
  check_size<sc_detect_skin_job>(SC_DETECT_SKIN_JOB_INIT, sc_detect_skin);
  check_size<sc_confirm_job>(SC_CONFIRM_JOB_INIT, sc_confirm);
  check_size<sc_crowd_job>(SC_CROWD_JOB_INIT, sc_crowd);
}

TEST_CASE("C: numbers that no enum has are refused, also those that are a value when cut to a byte") {
  const BothApis both;
  std::vector<sc_sphere> spheres(BothApis::kSpheres);
  sc_refit_bones_job bones = SC_REFIT_BONES_JOB_INIT;
  bones.asset = both.asset;
  bones.bones.data = both.matrices[0].data();
  bones.bones.count = 8;
  bones.spheres = spheres.data();
  bones.sphere_count = spheres.size();
  REQUIRE(sc_refit_bones(&bones) == SC_OK);
  sc_detect_job detect = SC_DETECT_JOB_INIT;
  detect.asset = both.asset;
  detect.spheres = spheres.data();
  detect.sphere_count = spheres.size();
  REQUIRE(sc_detect(&detect) == SC_OK);
  for (const std::int32_t value : {-1, 4, 255, 256, 257, 258, 0x7fffffff}) {
    CAPTURE(value);
    sc_refit_bones_job bad = bones;
    bad.radius = value;
    CHECK(sc_refit_bones(&bad) == SC_BAD_ARGUMENT);
    bad = bones;
    bad.bones.layout = value;
    CHECK(sc_refit_bones(&bad) == SC_BAD_ARGUMENT);
    sc_detect_job bad_detect = detect;
    bad_detect.method = value;
    CHECK(sc_detect(&bad_detect) == SC_BAD_ARGUMENT);
  }
  bones.target = 256;
  CHECK(sc_refit_bones(&bones) == SC_UNSUPPORTED_TARGET);
}

TEST_CASE("C: both refits give the C++ API's spheres") {
  const BothApis both;
  for (const RadiusKind radius : {RadiusKind::kFit, RadiusKind::kDetect}) {
    std::vector<sc_sphere> spheres(BothApis::kSpheres);
    sc_refit_job job = SC_REFIT_JOB_INIT;
    job.asset = both.asset;
    job.positions = both.tiny.rest.data();
    job.vertex_count = both.tiny.parts.vertex_count;
    job.radius = static_cast<sc_radius>(radius);
    job.spheres = spheres.data();
    job.sphere_count = spheres.size();
    REQUIRE(sc_refit(&job) == SC_OK);
    CHECK(same_bytes(spheres, refit(both.opened.asset, both.tiny.rest, radius).spheres));
    CHECK(sc_check_source(both.asset, job.positions, job.vertex_count, 12) ==
          static_cast<sc_status>(check_source(both.opened.asset, job.positions, job.vertex_count)));

    const Palette palette(both.matrices, MatrixLayout::kColumnMajor4x4, 80);
    sc_refit_bones_job bones = SC_REFIT_BONES_JOB_INIT;
    both.give_bones(palette, bones);
    bones.radius = static_cast<sc_radius>(radius);
    bones.spheres = spheres.data();
    bones.sphere_count = spheres.size();
    REQUIRE(sc_refit_bones(&bones) == SC_OK);
    CHECK(same_bytes(spheres, refit_bones(both.opened.asset, both.rows(), both.morph_weights, radius).spheres));
    bones.target = SC_TARGET_SCALAR;
    CHECK(sc_refit_bones(&bones) == SC_OK);
    bones.bones.count = 7;
    CHECK(sc_refit_bones(&bones) == SC_TOO_FEW_BONES);
  }
}

TEST_CASE("C: cover and skin give what the C++ jobs give") {
  const BothApis both;
  const Palette palette(both.matrices, MatrixLayout::kRowMajor3x4, 60);
  std::vector<sc_sphere> leaves(both.tiny.parts.surface.leaves.size()), spheres(BothApis::kSpheres);
  sc_cover_job cover_job = SC_COVER_JOB_INIT;
  both.give_bones(palette, cover_job);
  cover_job.leaves = leaves.data();
  cover_job.leaf_count = leaves.size();
  REQUIRE(sc_cover(&cover_job) == SC_OK);
  CHECK(same_bytes(leaves, cover(both.opened.asset, both.rows(), both.morph_weights).leaves));
  cover_job.spheres = spheres.data();
  cover_job.sphere_count = spheres.size();
  cover_job.target = SC_TARGET_SCALAR;
  REQUIRE(sc_cover(&cover_job) == SC_OK);
  CHECK(same_bytes(spheres, cover(both.opened.asset, both.rows(), both.morph_weights).spheres));
  cover_job.leaf_count -= 1;
  CHECK(sc_cover(&cover_job) == SC_TOO_FEW_SPHERES);

  const SkinnedSurface expected = skin(both.opened.asset, both.rows(), both.morph_weights, Target::kBest, 16);
  std::vector<float> positions(expected.positions.size(), std::numeric_limits<float>::quiet_NaN());
  sc_skin_job skin_job = SC_SKIN_JOB_INIT;
  both.give_bones(palette, skin_job);
  skin_job.positions = positions.data();
  skin_job.vertex_count = both.opened.asset.info().source_vertex_count;
  skin_job.stride = 16;
  skin_job.target = SC_TARGET_SCALAR;
  REQUIRE(sc_skin(&skin_job) == SC_OK);
  CHECK(same_bits(positions, expected.positions));
  skin_job.vertex_count -= 1;
  CHECK(sc_skin(&skin_job) == SC_TOO_FEW_VERTICES);
}

TEST_CASE("C: detect gives the C++ API's pairs, bits, chain pairs and counts, and overflows as it does") {
  const BothApis both;
  for (const Method method : {Method::kM1, Method::kM2}) {
    const Detected expected = detect(both.opened.asset, both.spheres, method, RadiusKind::kDetect);
    REQUIRE(expected.pairs.size() > 1);
    std::vector<sc_pair> pairs(expected.pairs.size());
    std::vector<sc_chain_pair> chain_pairs(expected.chain_pairs.size());
    std::vector<std::uint64_t> bits(sc_detect_bit_words(both.asset)), scratch(sc_detect_scratch_words(both.asset));
    sc_detect_job job = SC_DETECT_JOB_INIT;
    both.give_spheres(job);
    job.method = static_cast<sc_method>(method);
    if (method == Method::kM1) {
      job.scratch = scratch.data();
      job.scratch_words = scratch.size();
      job.chain_pairs = chain_pairs.data();
      job.chain_pair_capacity = chain_pairs.size();
    }
    job.pairs = pairs.data();
    job.pair_capacity = pairs.size();
    job.bits = bits.data();
    job.bit_words = bits.size();
    REQUIRE(sc_detect(&job) == SC_OK);
    CHECK(job.pair_count == expected.pairs.size());
    CHECK(job.test_count == expected.test_count);
    CHECK(same_bytes(pairs, expected.pairs));
    CHECK(same_bytes(bits, expected.bits));
    CHECK(same_bytes(chain_pairs, expected.chain_pairs));

    job.pair_capacity = 1;
    CHECK(sc_detect(&job) == SC_OVERFLOW);
    CHECK(job.pair_count == expected.pairs.size());
    if (method == Method::kM2) {
      job.first_only = 1;
      job.bits = nullptr;
      job.bit_words = 0;
      CHECK(sc_detect(&job) == SC_OK);
      CHECK(job.pair_count == 1);
      CHECK(std::memcmp(pairs.data(), expected.pairs.data(), sizeof(Pair)) == 0);
    } else {
      job.scratch = nullptr;
      CHECK(sc_detect(&job) == SC_NULL_ARGUMENT);
      CHECK(job.pair_count == expected.pairs.size());
    }
  }
}

TEST_CASE("C: a crowd from bones gives each instance's own pairs, by the caller's scheduler") {
  const BothApis both;
  constexpr std::size_t kInstances = 5;
  std::vector<Matrix> matrices = random_matrices(8 * kInstances, 9);
  std::vector<std::uint64_t> scratch(sc_crowd_scratch_words(both.asset, 3));
  std::vector<std::uint32_t> counts(kInstances);
  std::vector<sc_crowd_pair> pairs(kInstances * BothApis::kSpheres * (BothApis::kSpheres - 1) / 2);
  std::size_t calls = 0;
  sc_crowd_job job = SC_CROWD_JOB_INIT;
  job.asset = both.asset;
  job.instance_count = kInstances;
  job.bones.data = matrices[0].data();
  job.bones.count = 8;
  job.instance_stride = 8 * sizeof(Matrix);
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.parallel_for = [](void* user, std::size_t count, void (*task)(void*, std::size_t), void* data) {
    ++*static_cast<std::size_t*>(user);
    for (std::size_t i = count; i-- > 0;) {
      task(data, i);
    }
  };
  job.user = &calls;
  job.task_count = 3;
  job.counts = counts.data();
  job.counts_capacity = counts.size();
  job.pairs = pairs.data();
  job.pair_capacity = pairs.size();
  REQUIRE(sc_crowd(&job) == SC_OK);
  CHECK(calls > 0);
  pairs.resize(job.pair_count);
  std::vector<CrowdPair> expected;
  for (std::uint32_t i = 0; i < kInstances; ++i) {
    const std::vector<Sphere> spheres =
        refit_bones(both.opened.asset, {matrices[8 * i].data(), 8}, {}, RadiusKind::kDetect).spheres;
    for (const Pair& pair : detect(both.opened.asset, spheres, Method::kM2, RadiusKind::kDetect).pairs) {
      expected.push_back({i, pair});
    }
  }
  REQUIRE(!expected.empty());
  CHECK(same_bytes(pairs, expected));
  job.scratch = nullptr;
  CHECK(sc_crowd(&job) == SC_NULL_ARGUMENT);
}

}  // namespace spherechain::test
