// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "posed_asset.h"
#include "tiny_moments.h"

namespace spherechain::test {
namespace {

// Of coordinates of some units, and of a quadratic form in them.
constexpr double kMeshRounding = 2e-5;

struct ByMoments : PosedAsset {
  ByMoments(std::size_t bone_count, std::size_t spheres, std::size_t batch_pairs = 48, bool has_large_spheres = true,
            PivotTables pivots = PivotTables::kLeftOut) {
    tiny = random_asset(spheres, 31);
    matrices = random_matrices(bone_count, 33);
    for (std::size_t i = 0; i < spheres; ++i) {
      const std::uint16_t counts[] = {2, 8, 1, 19, 4, 3, 16, 2};
      give_pivots(tiny, i, has_large_spheres ? counts[i % 8] : std::uint16_t{2}, static_cast<unsigned>(i));
    }
    skin = add_bones(tiny, bone_count, 32);
    add_moments(tiny, skin, batch_pairs, pivots);
  }
  const MomentParts& tables() const { return tiny.parts.bone_refit.moments; }
};

struct Rows {
  float at[3][4];
};

float image_of_origin(const float* row, const Vec3& origin) {
  return std::fma(row[2], origin.z, std::fma(row[1], origin.y, std::fma(row[0], origin.x, row[3])));
}

float halving_tree(std::vector<float> values) {
  while (values.size() > 1) {
    const std::size_t half = values.size() / 2;
    for (std::size_t i = 0; i < half; ++i) {
      values[i] = values[i] + values[i + half];
    }
    values.resize(half);
  }
  return values[0];
}

// The header's fixed arithmetic, to the last bit; sphere by sphere, with no batches.
std::vector<Sphere> exact_by_moments(const PosedAsset& s, RadiusKind kind) {
  const MomentParts& tables = s.tiny.parts.bone_refit.moments;
  const Matrix& reference = s.matrices[tables.reference];
  float shift[3];
  for (std::size_t m = 0; m < 3; ++m) {
    shift[m] = image_of_origin(reference.data() + 4 * m, tables.origin);
  }
  std::vector<Rows> moved;
  for (const Matrix& matrix : s.matrices) {
    Rows rows{};
    for (std::size_t m = 0; m < 3; ++m) {
      std::copy_n(matrix.data() + 4 * m, 3, rows.at[m]);
      rows.at[m][3] = image_of_origin(matrix.data() + 4 * m, tables.origin) - shift[m];
      for (float& value : rows.at[m]) {
        value = std::abs(value) < 0x1p-62F ? 0.0F : value;
      }
    }
    moved.push_back(rows);
  }
  std::vector<Sphere> out(s.tiny.parts.spheres.size(), Sphere{-1, -1, -1, -1});
  std::size_t bone = 0, moment = 0;
  for (std::size_t i = 0; i < tables.spheres.size(); ++i) {
    const std::size_t first = bone, end = bone + tables.bone_counts[i];
    float center[3];
    for (std::size_t m = 0; m < 3; ++m) {
      float sums[4];
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t b = first; b < end; ++b) {
          const CenterTerm& u = tables.centers[b];
          const float share[] = {u.x, u.y, u.z, u.w};
          const float value = moved[tables.bones[b]].at[m][j];
          sums[j] = b == first ? value * share[j] : std::fma(value, share[j], sums[j]);
        }
      }
      center[m] = ((sums[0] + sums[2]) + (sums[1] + sums[3])) + shift[m];
    }
    std::vector<float> sums;
    for (std::size_t k = first; k < end; ++k) {
      for (std::size_t l = k; l < end; ++l, ++moment) {
        const Rows &left = moved[tables.bones[k]], &right = moved[tables.bones[l]];
        for (std::size_t e = 0; e < kMomentSize; ++e) {
          const std::size_t r = e / 4, c = e % 4;
          const float low = std::fma(left.at[1][r], right.at[1][c], left.at[0][r] * right.at[0][c]);
          const float gram = std::fma(left.at[2][r], right.at[2][c], low);
          const float own = tables.moments[moment].values[e];
          if (sums.size() < kMomentSize) {
            sums.push_back(own * gram);
          } else {
            sums[e] = std::fma(own, gram, sums[e]);
          }
        }
      }
    }
    bone = end;
    const float squared = halving_tree(sums);
    const RestSphere& rest = s.tiny.parts.spheres[tables.spheres[i]];
    const float wanted = kind == RadiusKind::kFit ? rest.radius : rest.detect_radius;
    const float spread = std::isfinite(squared) ? std::sqrt(squared <= 0 ? 0 : squared) : std::nanf("");
    out[tables.spheres[i]] = {center[0], center[1], center[2], wanted * spread};
  }
  return out;
}

// RefitJob's fixed arithmetic, to the last bit.
std::vector<Sphere> exact_from_vertices(const AssetParts& parts, const std::vector<float>& v, RadiusKind kind) {
  std::vector<Sphere> out;
  for (const RestSphere& rest : parts.spheres) {
    std::vector<std::array<float, 3>> centroids;
    float c[3] = {0, 0, 0};
    for (std::size_t k = rest.first_pivot; k < rest.first_pivot + rest.pivot_count; ++k) {
      const Pivot& pivot = parts.pivots[k];
      std::array<float, 3>& p = centroids.emplace_back();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float sum = v[3 * pivot.a + axis] + v[3 * pivot.b + axis];
        p[axis] = (sum + v[3 * pivot.c + axis]) * (1.0F / 3);
        c[axis] = c[axis] + pivot.weight * p[axis];
      }
    }
    float sum = 0;
    for (const auto& p : centroids) {
      const float dx = p[0] - c[0], dy = p[1] - c[1], dz = p[2] - c[2];
      sum = sum + ((dx * dx + dy * dy) + dz * dz);
    }
    const float now = std::sqrt(sum / static_cast<float>(rest.pivot_count));
    const float wanted = kind == RadiusKind::kFit ? rest.radius : rest.detect_radius;
    out.push_back({c[0], c[1], c[2], wanted * (now / rest.pivot_spread)});
  }
  return out;
}

}  // namespace

TEST_CASE("by moments, spheres from bones are those of the skinned mesh") {
  check_against_mesh(ByMoments(9, 24), kMeshRounding);
}

TEST_CASE("by moments, on every target spheres from bones follow the fixed arithmetic of the header bit for bit") {
  for (const std::size_t count : {1U, 2U, 3U, 15U, 16U, 17U, 33U, 50U}) {
    check_exact(ByMoments(9, count), exact_by_moments);
  }
}

TEST_CASE("by moments, what is less than 2^-62 in a matrix counts for nothing, on every target") {
  for (const float scale : {0x1p-62F, 0x1.fffffep-63F, 0x1p-70F, 0x1p-140F}) {
    ByMoments s(9, 20);
    std::uint32_t random = 5;
    for (Matrix& m : s.matrices) {
      for (std::size_t i = 0; i < m.size(); ++i) {
        random = random * 1664525U + 1013904223U;
        m[i] = random >> 30U == 0 ? (random >> 29U & 1U) == 0 ? scale : -scale : m[i] * scale * 0x1p+20F;
      }
    }
    // Tables in units in which such matrices matter.
    for (Moment& moment : s.tiny.parts.bone_refit.moments.moments) {
      for (float& value : moment.values) {
        value *= 0x1p+80F;
      }
    }
    check_exact(s, exact_by_moments);
  }
}

TEST_CASE("by moments, a squared spread that comes out below 0 counts for 0, on every target") {
  ByMoments s(9, 20);
  for (Moment& moment : s.tiny.parts.bone_refit.moments.moments) {
    for (float& value : moment.values) {
      value = -value;
    }
  }
  CHECK(exact_by_moments(s, RadiusKind::kFit)[0].radius == 0);
  check_exact(s, exact_by_moments);
}

TEST_CASE("by moments, a squared spread past the largest float makes a radius that is no number, on every target") {
  ByMoments s(9, 20);
  for (Matrix& m : s.matrices) {
    for (float& figure : m) figure *= 0x1p+70F;
  }
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const std::vector<Sphere> wanted = exact_by_moments(s, RadiusKind::kFit);
  for (const Target target : supported_targets()) {
    INFO(to_string(target));
    const Refitted got = refit_posed(opened.asset, s, RadiusKind::kFit, target);
    REQUIRE(got.spheres.size() == wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      CHECK(std::isfinite(got.spheres[i].x));
      CHECK(got.spheres[i].x == wanted[i].x);
      CHECK(std::isnan(wanted[i].radius));
      CHECK(std::isnan(got.spheres[i].radius));
    }
  }
}

TEST_CASE("by moments, spheres fall into batches of any size, up to the largest there may be") {
  const ByMoments small(9, 40, 1);
  CHECK(small.tables().batches.size() > 20);
  check_exact(small, exact_by_moments);
  const ByMoments large(kMaxMomentBones, 40, kMaxMomentPairs);
  const auto count_of = [](const MomentBatch& batch) { return batch.pair_count; };
  std::vector<std::uint32_t> counts;
  std::transform(large.tables().batches.begin(), large.tables().batches.end(), std::back_inserter(counts), count_of);
  CHECK(*std::max_element(counts.begin(), counts.end()) > 240);
  check_exact(large, exact_by_moments);
}

TEST_CASE("by moments, spheres of an asset with more bones than its stack has room for are the same") {
  for (const std::size_t bones : {255U, 256U, 257U, 1000U}) {
    check_exact(ByMoments(bones, 40, 48, false), exact_by_moments);
  }
}

TEST_CASE("by moments, an asset that has its pivots' tables too, as those of older bakers, gives the same spheres") {
  const ByMoments s(9, 24), older(9, 24, 48, true, PivotTables::kKept);
  CHECK(OpenedAsset(s.tiny.parts).asset.bone_tables().terms.size == 0);
  CHECK(OpenedAsset(older.tiny.parts).asset.bone_tables().terms.size > 0);
  check_exact(older, exact_by_moments);
}

TEST_CASE("by moments, spheres from vertices follow the fixed arithmetic of the header bit for bit") {
  const ByMoments s(9, 24);
  const OpenedAsset opened(s.tiny.parts);
  const std::vector<float> mesh = skinned(s.tiny, s.skin, s.matrices, {});
  for (const RadiusKind kind : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const Refitted result = refit(opened.asset, mesh, kind);
    CHECK(result.status == Status::kOk);
    CHECK(same_bits(result.spheres, exact_from_vertices(s.tiny.parts, mesh, kind)));
  }
}

TEST_CASE("by moments, every layout and stride of the matrices gives the same spheres, reading none but theirs") {
  for (const std::size_t bones : {9U, 300U}) {
    check_layouts(ByMoments(bones, 20, 48, false));
  }
}

TEST_CASE("by moments, matrices that are not finite give spheres that are not finite, and only those they move") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const bool is_reference : {false, true}) {
      ByMoments s(12, 40, 48, false);
      const OpenedAsset opened(s.tiny.parts);
      const std::size_t broken_bone = is_reference ? s.tables().reference : 0;
      s.matrices[broken_bone][5] = bad;
      for (const Target target : supported_targets()) {
        const Refitted result = refit_posed(opened.asset, s, RadiusKind::kFit, target);
        CHECK(result.status == Status::kOk);
        std::size_t bone = 0, broken = 0;
        for (std::size_t i = 0; i < s.tables().spheres.size(); ++i) {
          const auto first = s.tables().bones.begin() + static_cast<std::ptrdiff_t>(bone);
          bone += s.tables().bone_counts[i];
          const auto last = s.tables().bones.begin() + static_cast<std::ptrdiff_t>(bone);
          const bool moves = is_reference || std::find(first, last, broken_bone) != last;
          const Sphere& sphere = result.spheres[s.tables().spheres[i]];
          CHECK(std::isfinite(sphere.y) == !moves);
          CHECK(std::isfinite(sphere.radius) == !moves);
          broken += moves ? 1 : 0;
        }
        CHECK(broken > 0);
        CHECK((broken < result.spheres.size()) == !is_reference);
      }
    }
  }
}

TEST_CASE("by moments, refit leaves entries past the asset's spheres alone, and matrices past its bones unread") {
  check_longer_arrays(ByMoments(9, 11));
}

}  // namespace spherechain::test
