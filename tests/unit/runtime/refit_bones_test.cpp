// SPDX-License-Identifier: MIT
#include "spherechain/refit_bones.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "posed_asset.h"

namespace spherechain::test {
namespace {

// Of coordinates of some units and sums of a dozen floats.
constexpr double kBoneRounding = 1e-5;

struct ByPivots : PosedAsset {
  static constexpr std::size_t kBones = 7;

  explicit ByPivots(std::uint8_t rule = 1, std::size_t spheres = 11, bool has_large_spheres = true) {
    tiny = random_asset(spheres, 21);
    tiny.parts.refit = rule;
    if (has_large_spheres) {
      give_pivots(tiny, 2, 8, 1);
      give_pivots(tiny, 5, 19, 2);  // three groups, the last with spare lanes
      give_pivots(tiny, 7, 1, 3);
      give_pivots(tiny, 8, 16, 4);
    }
    skin = add_bones(tiny, kBones, 22);
    matrices = random_matrices(kBones, 23);
    morph_weights = {0.5F, 1.0F, -0.75F};
  }
};

float tree(const float (&v)[kPivotLanes]) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); }

// The header's fixed arithmetic, to the last bit.
std::vector<Sphere> exact_by_pivots(const PosedAsset& s, RadiusKind kind) {
  const BoneRefitParts& tables = s.tiny.parts.bone_refit;
  std::vector<Sphere> out;
  std::size_t group = 0, term = 0, morph = 0;
  for (const RestSphere& rest : s.tiny.parts.spheres) {
    std::vector<std::array<std::array<float, 3>, kPivotLanes>> p;
    float sums[3][kPivotLanes] = {}, distances[kPivotLanes] = {};
    for (std::size_t first = 0; first < rest.pivot_count; first += kPivotLanes, ++group) {
      p.emplace_back();
      float even[kPivotLanes][3] = {}, odd[kPivotLanes][3] = {};
      for (std::uint32_t t = 0; t < tables.term_counts[group]; ++t, ++term) {
        BoneTerm q = tables.terms[term];
        for (std::uint32_t m = 0; m < tables.morph_term_counts[term]; ++m, ++morph) {
          const float weight = s.morph_weights[tables.morph_targets[morph]];
          for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
            q.x[lane] = std::fma(weight, tables.morph_terms[morph].x[lane], q.x[lane]);
            q.y[lane] = std::fma(weight, tables.morph_terms[morph].y[lane], q.y[lane]);
            q.z[lane] = std::fma(weight, tables.morph_terms[morph].z[lane], q.z[lane]);
          }
        }
        const Matrix& m = s.matrices[tables.term_bones[term]];
        for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
          for (std::size_t r = 0; r < 3; ++r) {
            even[lane][r] = std::fma(m[4 * r + 2], q.z[lane], std::fma(m[4 * r], q.x[lane], even[lane][r]));
            odd[lane][r] = std::fma(m[4 * r + 3], q.w[lane], std::fma(m[4 * r + 1], q.y[lane], odd[lane][r]));
          }
        }
      }
      for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
        for (std::size_t r = 0; r < 3; ++r) {
          p.back()[lane][r] = even[lane][r] + odd[lane][r];
          const float weight = tables.weights[group].values[lane], pivot = p.back()[lane][r];
          sums[r][lane] = first == 0 ? weight * pivot : std::fma(weight, pivot, sums[r][lane]);
        }
      }
    }
    const float x = tree(sums[0]), y = tree(sums[1]), z = tree(sums[2]);
    for (std::size_t k = 0; k < rest.pivot_count; ++k) {
      const auto& pivot = p[k / kPivotLanes][k % kPivotLanes];
      const float dx = pivot[0] - x, dy = pivot[1] - y, dz = pivot[2] - z;
      distances[k % kPivotLanes] += std::sqrt(std::fma(dz, dz, std::fma(dy, dy, dx * dx)));
    }
    const float mean = tree(distances) / static_cast<float>(rest.pivot_count);
    const bool fit = kind == RadiusKind::kFit;
    const float paper = fit ? mean : mean * (rest.detect_radius / rest.radius);
    const float calibrated = (fit ? rest.radius : rest.detect_radius) * (mean / rest.pivot_spread);
    out.push_back({x, y, z, s.tiny.parts.refit == 0 ? paper : calibrated});
  }
  return out;
}

}  // namespace

TEST_CASE("spheres from bones and morph weights are those of the skinned mesh") {
  for (const std::uint8_t rule : {std::uint8_t{0}, std::uint8_t{1}}) {
    check_against_mesh(ByPivots(rule), kBoneRounding);
  }
}

TEST_CASE("without morph weights nothing morphs, as with weights of 0") {
  ByPivots s;
  const OpenedAsset opened(s.tiny.parts);
  s.morph_weights.clear();
  const Refitted without = refit_posed(opened.asset, s, RadiusKind::kFit);
  REQUIRE(without.status == Status::kOk);
  const std::vector<float> mesh = skinned(s.tiny, s.skin, s.matrices, {});
  check_close(without.spheres, refit(opened.asset, mesh, RadiusKind::kFit).spheres, kBoneRounding);
  s.morph_weights = {0, 0, 0};
  CHECK(same_bits(refit_posed(opened.asset, s, RadiusKind::kFit).spheres, without.spheres));
  s.morph_weights = {0, 1, 0};  // the target that moves nothing
  CHECK(same_bits(refit_posed(opened.asset, s, RadiusKind::kFit).spheres, without.spheres));
  s.morph_weights = {1, 0, 0};
  CHECK(!same_bits(refit_posed(opened.asset, s, RadiusKind::kFit).spheres, without.spheres));
}

TEST_CASE("on every target spheres from bones follow the fixed arithmetic of the header bit for bit") {
  for (const std::uint8_t rule : {std::uint8_t{0}, std::uint8_t{1}}) {
    for (const std::size_t count : {9U, 10U, 11U, 12U}) {  // whole and broken chunks of spheres
      check_exact(ByPivots(rule, count), exact_by_pivots);
    }
  }
}

TEST_CASE("spheres of at most eight pivots each follow that arithmetic too, however many they are") {
  for (const std::uint8_t rule : {std::uint8_t{0}, std::uint8_t{1}}) {
    for (const std::size_t count : {1U, 2U, 15U, 16U, 17U, 31U, 32U, 33U, 50U}) {
      check_exact(ByPivots(rule, count, false), exact_by_pivots);
    }
  }
}

TEST_CASE("sums half way between two floats, and sums that are hardly a float, are rounded once on every target") {
  // Of many sums of two such products a double cannot tell on which side of half way they lie.
  constexpr float kFactors[] = {1, -1, 0x1.000002p0F, 0x1.000006p0F, 0x1.fffffcp-1F, -0x1.000002p0F, 0.5F, 0};
  constexpr struct {
    float matrix, x, z;
  } kScales[] = {{1, 1, 0x1p-24F},
                 {1, 0x1p-24F, 1},
                 {0x1p-60F, 1, 0x1p-25F},
                 {0x1p+100F, 1, 0x1p-24F},
                 {0x1p-126F, 0x1p-15F, 0x1p-24F},  // the floats there lie 2^-149 apart
                 {0x1p-126F, 0x1p-14F, 0x1p-24F},
                 {0x1p-126F, 0x1p-23F, 0x1p-23F}};
  for (const bool has_large_spheres : {false, true}) {
    for (const auto& scale : kScales) {
      ByPivots s(1, 11, has_large_spheres);
      std::uint32_t random = 7;
      const auto pick = [&] {
        random = random * 1664525U + 1013904223U;
        return kFactors[(random >> 24U) % std::size(kFactors)];
      };
      for (BoneTerm& term : s.tiny.parts.bone_refit.terms) {
        for (std::size_t lane = 0; lane < kPivotLanes; ++lane) {
          for (float* column : {term.x, term.y, term.z, term.w}) {
            const float factor = column == term.x || column == term.y ? scale.x : scale.z;
            column[lane] = column[lane] == 0 ? 0 : factor * pick();  // spare lanes stay 0
          }
        }
      }
      s.morph_weights = {0, 0, 0};
      for (Matrix& m : s.matrices) {
        for (float& value : m) {
          value = scale.matrix * pick();
        }
      }
      check_exact(s, exact_by_pivots);
    }
  }
}

TEST_CASE("every layout and stride of the matrices gives the same spheres bit for bit, reading none but theirs") {
  for (const bool has_large_spheres : {false, true}) {
    check_layouts(ByPivots(1, 11, has_large_spheres));
  }
}

TEST_CASE("matrices and weights that are not finite give spheres that are not finite, and only those they move") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    ByPivots s;
    const OpenedAsset opened(s.tiny.parts);
    s.matrices[0][5] = bad;
    const Refitted result = refit_posed(opened.asset, s, RadiusKind::kFit);
    CHECK(result.status == Status::kOk);
    std::size_t group = 0, term = 0, broken = 0;
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      bool moves = false;
      for (std::size_t k = 0; k < s.tiny.parts.spheres[i].pivot_count; k += kPivotLanes, ++group) {
        for (std::uint32_t t = 0; t < s.tiny.parts.bone_refit.term_counts[group]; ++t, ++term) {
          moves = moves || s.tiny.parts.bone_refit.term_bones[term] == 0;
        }
      }
      CHECK(std::isfinite(result.spheres[i].y) == !moves);
      CHECK(std::isfinite(result.spheres[i].radius) == !moves);
      broken += moves ? 1 : 0;
    }
    CHECK(broken > 0);
    CHECK(broken < result.spheres.size());
  }
}

TEST_CASE("refit from bones leaves entries past the asset's spheres alone, and matrices past its bones unread") {
  check_longer_arrays(ByPivots());
}

TEST_CASE("refit from bones refuses what it cannot use and writes nothing") {
  const ByPivots s;
  const OpenedAsset opened(s.tiny.parts);
  const OpenedAsset old(random_asset(11, 21).parts);
  REQUIRE(old.status == Status::kOk);
  const std::vector<Sphere> untouched(11, {7, 7, 7, 7});
  std::vector<Sphere> spheres = untouched;
  const Palette palette(s.matrices, MatrixLayout::kRowMajor4x4, 64);
  RefitBonesJob good;
  good.asset = &opened.asset;
  good.bones = palette.view(ByPivots::kBones);
  good.morph_weights = {s.morph_weights.data(), s.morph_weights.size()};
  good.spheres = {spheres.data(), spheres.size()};
  const Asset closed;
  const auto status_of = [&](auto change) {
    RefitBonesJob job = good;
    change(job);
    return job.run();
  };
  using Job = RefitBonesJob;
  CHECK(status_of([](Job& j) { j.asset = nullptr; }) == Status::kNullArgument);
  CHECK(status_of([](Job& j) { j.bones.data = nullptr; }) == Status::kNullArgument);
  CHECK(status_of([](Job& j) { j.morph_weights.data = nullptr; }) == Status::kNullArgument);
  CHECK(status_of([](Job& j) { j.spheres.data = nullptr; }) == Status::kNullArgument);
  CHECK(status_of([&](Job& j) { j.asset = &closed; }) == Status::kNotOpen);
  CHECK(status_of([&](Job& j) { j.asset = &old.asset; }) == Status::kNotInAsset);
  CHECK(status_of([](Job& j) { j.radius = static_cast<RadiusKind>(2); }) == Status::kBadArgument);
  CHECK(status_of([](Job& j) { j.bones.layout = static_cast<MatrixLayout>(4); }) == Status::kBadArgument);
  CHECK(status_of([](Job& j) { j.bones.stride = 0; }) == Status::kBadStride);
  CHECK(status_of([](Job& j) { j.bones.stride = 48; }) == Status::kBadStride);  // too short for four by four
  CHECK(status_of([](Job& j) { j.bones.stride = 66; }) == Status::kBadStride);
  CHECK(status_of([](Job& j) { j.bones.count -= 1; }) == Status::kTooFewBones);
  CHECK(status_of([](Job& j) { j.bones.count = 0; }) == Status::kTooFewBones);
  CHECK(status_of([](Job& j) { j.morph_weights.size -= 1; }) == Status::kTooFewMorphs);
  CHECK(status_of([](Job& j) { j.spheres.size -= 1; }) == Status::kTooFewSpheres);
  CHECK(status_of([](Job& j) { j.target = static_cast<Target>(99); }) == Status::kUnsupportedTarget);
  CHECK(same_bits(spheres, untouched));
  CHECK(good.run() == Status::kOk);
}

TEST_CASE("refit from bones refuses to write over its own inputs") {
  const ByPivots s;
  const OpenedAsset opened(s.tiny.parts);
  constexpr std::size_t kOutput = 11 * 4, kInput = ByPivots::kBones * 12;  // floats
  std::vector<float> memory(2 * kOutput + kInput);
  float* const input = memory.data() + kOutput;
  std::memcpy(input, s.matrices.data(), kInput * sizeof(float));
  const std::vector<float> before = memory;
  RefitBonesJob job;
  job.asset = &opened.asset;
  job.bones = {input, ByPivots::kBones};
  for (const std::size_t start : {std::size_t{4}, kOutput, kOutput + kInput - 4}) {
    job.spheres = {reinterpret_cast<Sphere*>(memory.data() + start), 11};
    CHECK(job.run() == Status::kSharedMemory);
    job.bones.data = s.matrices[0].data();
    job.morph_weights = {input, kInput};
    CHECK(job.run() == Status::kSharedMemory);
    job.bones.data = input;
    job.morph_weights = {};
  }
  CHECK(same_bits(memory, before));
  for (const std::size_t start : {std::size_t{0}, kOutput + kInput}) {
    job.spheres = {reinterpret_cast<Sphere*>(memory.data() + start), 11};
    CHECK(job.run() == Status::kOk);
  }
}

TEST_CASE("an asset tells its bones and morph targets") {
  const ByPivots s;
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE(opened.asset.bone_count() == ByPivots::kBones);
  CHECK(std::string(opened.asset.bone(2).name) == "bone2");
  CHECK(opened.asset.bone(2).inverse_bind[3] == -2.0F);
  CHECK(opened.asset.bone(2).inverse_bind[10] == 1.0F);
  CHECK(!opened.asset.bone(ByPivots::kBones - 2).is_rest);
  CHECK(opened.asset.bone(ByPivots::kBones - 1).is_rest);
  REQUIRE(opened.asset.morph_count() == 3);
  CHECK(std::string(opened.asset.morph_name(2)) == "morph2");
  const OpenedAsset old(random_asset(3, 1).parts);
  CHECK(old.asset.bone_count() == 0);
  CHECK(old.asset.morph_count() == 0);
  CHECK(old.asset.bone_tables().terms.size == 0);
}

}  // namespace spherechain::test
