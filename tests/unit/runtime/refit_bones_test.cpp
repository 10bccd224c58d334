// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "exact_fma.h"
#include "jobs.h"
#include "palette.h"

namespace spherechain::test {
namespace {

// The error of coordinates of some units, and of a quadratic form in them.
constexpr double kMeshRounding = 2e-5;

struct PosedAsset {
  explicit PosedAsset(std::size_t bone_count, std::size_t spheres, std::size_t batch_pairs = 48,
                      bool has_large_spheres = true)
      : tiny(random_asset(spheres, 31)), matrices(random_matrices(bone_count, 33)) {
    for (std::size_t i = 0; i < spheres; ++i) {
      const std::uint16_t counts[] = {2, 8, 1, 19, 4, 3, 16, 2};
      give_pivots(tiny, i, has_large_spheres ? counts[i % 8] : std::uint16_t{2}, static_cast<unsigned>(i));
    }
    skin = add_bones(tiny, bone_count, 32);
    add_moments(tiny, skin, batch_pairs);
  }
  const MomentParts& tables() const { return tiny.parts.moments; }

  TinyAsset tiny;
  TinySkin skin;
  std::vector<Matrix> matrices;
};

Refitted refit_posed(const Asset& asset, const PosedAsset& s, Radius radius, Target target = SC_TARGET_BEST) {
  return refit(asset, pose_of(s.matrices), radius, target);
}

struct Rows {
  float at[3][4];
};

float image_of_origin(const float* row, const Vec3& origin) {
  return exact_fma(row[2], origin.z, exact_fma(row[1], origin.y, exact_fma(row[0], origin.x, row[3])));
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

// The fixed arithmetic of docs/arithmetic.md, to the last bit; sphere by sphere, with no batches.
std::vector<Sphere> exact_by_moments(const PosedAsset& s, Radius kind) {
  const MomentParts& tables = s.tiny.parts.moments;
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
          sums[j] = b == first ? value * share[j] : exact_fma(value, share[j], sums[j]);
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
          const float low = exact_fma(left.at[1][r], right.at[1][c], left.at[0][r] * right.at[0][c]);
          const float gram = exact_fma(left.at[2][r], right.at[2][c], low);
          const float own = tables.moments[moment].values[e];
          if (sums.size() < kMomentSize) {
            sums.push_back(own * gram);
          } else {
            sums[e] = exact_fma(own, gram, sums[e]);
          }
        }
      }
    }
    bone = end;
    const float squared = halving_tree(sums);
    const RestSphere& rest = s.tiny.parts.spheres[tables.spheres[i]];
    const float wanted = kind == SC_RADIUS_FIT ? rest.radius : rest.detect_radius;
    const float spread = std::isfinite(squared) ? std::sqrt(squared <= 0 ? 0 : squared) : std::nanf("");
    out[tables.spheres[i]] = {center[0], center[1], center[2], wanted * spread};
  }
  return out;
}

void check_opened(const OpenedAsset& opened) { REQUIRE_MESSAGE(opened.status == SC_OK, opened.message); }

// The spheres of both radii, on every target, bit for bit.
void check_exact(const PosedAsset& s) {
  const OpenedAsset opened(s.tiny.parts);
  check_opened(opened);
  for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const std::vector<Sphere> expected = exact_by_moments(s, radius);
    for (const Target target : supported_targets()) {
      INFO(std::string(sc_target_name(target)), ", ", expected.size(), " spheres");
      const Refitted result = refit_posed(opened.asset, s, radius, target);
      CHECK(result.status == SC_OK);
      CHECK(same_bits(result.spheres, expected));
    }
  }
}

double distance(const Sphere& a, const Sphere& b) {
  return std::max({std::abs(double{a.x} - double{b.x}), std::abs(double{a.y} - double{b.y}),
                   std::abs(double{a.z} - double{b.z}), std::abs(double{a.radius} - double{b.radius})});
}

}  // namespace

TEST_CASE("spheres from bones are those of the skinned mesh") {
  const PosedAsset s(9, 24);
  const OpenedAsset opened(s.tiny.parts);
  check_opened(opened);
  const std::vector<float> mesh = skinned(s.tiny, s.skin, s.matrices, {});
  for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const Refitted result = refit_posed(opened.asset, s, radius), expected = refit(opened.asset, mesh, radius);
    REQUIRE(result.status == SC_OK);
    REQUIRE(expected.status == SC_OK);
    for (std::size_t i = 0; i < expected.spheres.size(); ++i) {
      INFO("sphere ", i);
      CHECK(distance(result.spheres[i], expected.spheres[i]) < kMeshRounding);
    }
  }
}

TEST_CASE("on every target spheres from bones follow the fixed arithmetic bit for bit") {
  for (const std::size_t count : {1U, 2U, 3U, 15U, 16U, 17U, 33U, 50U}) {
    check_exact(PosedAsset(9, count));
  }
  std::set<std::uint8_t> seen;  // numbers of bones that move a sphere
  for (std::size_t bones = 2; bones < 9; ++bones) {
    const PosedAsset s(bones, 33);
    seen.insert(s.tables().bone_counts.begin(), s.tables().bone_counts.end());
    check_exact(s);
  }
  CHECK(seen == std::set<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8});
}

TEST_CASE("what is less than 2^-62 in a matrix counts for nothing, on every target") {
  for (const float scale : {0x1p-62F, 0x1.fffffep-63F, 0x1p-70F, 0x1p-140F}) {
    PosedAsset s(9, 20);
    std::uint32_t random = 5;
    for (Matrix& m : s.matrices) {
      for (std::size_t i = 0; i < m.size(); ++i) {
        random = random * 1664525U + 1013904223U;
        m[i] = random >> 30U == 0 ? (random >> 29U & 1U) == 0 ? scale : -scale : m[i] * scale * 0x1p+20F;
      }
    }
    check_exact(s);
  }
}

TEST_CASE("a squared spread that comes out below 0 counts for 0, on every target") {
  PosedAsset s(9, 20);
  for (Moment& moment : s.tiny.parts.moments.moments) {
    for (float& value : moment.values) {
      value = -value;
    }
  }
  CHECK(exact_by_moments(s, SC_RADIUS_FIT)[0].radius == 0);
  check_exact(s);
}

TEST_CASE("a squared spread past the largest float makes a radius that is no number, on every target") {
  PosedAsset s(9, 20);
  for (Matrix& m : s.matrices) {
    for (float& figure : m) figure *= 0x1p+70F;
  }
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const std::vector<Sphere> wanted = exact_by_moments(s, SC_RADIUS_FIT);
  for (const Target target : supported_targets()) {
    INFO(std::string(sc_target_name(target)));
    const Refitted got = refit_posed(opened.asset, s, SC_RADIUS_FIT, target);
    REQUIRE(got.spheres.size() == wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      CHECK(std::isfinite(got.spheres[i].x));
      CHECK(got.spheres[i].x == wanted[i].x);
      CHECK(std::isnan(wanted[i].radius));
      CHECK(std::isnan(got.spheres[i].radius));
    }
  }
}

TEST_CASE("spheres fall into batches of any size, up to the largest there may be") {
  const PosedAsset small(9, 40, 1);
  CHECK(small.tables().batches.size() > 20);
  check_exact(small);
  const PosedAsset large(kMaxMomentBones, 40, kMaxMomentPairs);
  const std::vector<MomentBatch>& batches = large.tables().batches;
  CHECK(std::any_of(batches.begin(), batches.end(), [](const MomentBatch& one) { return one.pair_count > 240; }));
  check_exact(large);
}

TEST_CASE("spheres of an asset with more bones than its stack has room for are the same") {
  for (const std::size_t bones : {255U, 256U, 257U, 1000U}) {
    check_exact(PosedAsset(bones, 40, 48, false));
  }
}

TEST_CASE("a pose's bones win over its vertices, and morph weights move no sphere") {
  const PosedAsset s(9, 12);
  const OpenedAsset opened(s.tiny.parts);
  check_opened(opened);
  const std::vector<Sphere> expected = refit_posed(opened.asset, s, SC_RADIUS_DETECT).spheres;
  const std::vector<float> weights{1, -2, 0.5F};
  Pose pose = pose_of(s.matrices, weights);
  pose.vertices = s.tiny.rest.data();
  pose.vertex_count = s.tiny.parts.vertex_count;
  CHECK(same_bits(refit(opened.asset, pose, SC_RADIUS_DETECT).spheres, expected));
}

TEST_CASE("every layout and stride of the matrices gives the same spheres, reading none but theirs") {
  for (const std::size_t bones : {9U, 300U}) {
    const PosedAsset s(bones, 20, 48, false);
    const OpenedAsset opened(s.tiny.parts);
    check_opened(opened);
    const std::vector<Sphere> expected = refit_posed(opened.asset, s, SC_RADIUS_DETECT).spheres;
    for (const MatrixLayout layout : kLayouts) {
      for (const std::size_t padding : {0U, 1U, 13U}) {
        const Palette palette(s.matrices, layout, padding);
        for (const Target target : supported_targets()) {
          INFO("layout ", layout, ", padding ", padding, ", ", std::string(sc_target_name(target)));
          const Refitted result = refit(opened.asset, palette.pose(), SC_RADIUS_DETECT, target);
          CHECK(result.status == SC_OK);
          CHECK(same_bits(result.spheres, expected));
        }
      }
    }
  }
}

TEST_CASE("matrices that are not finite give spheres that are not finite, and only those they move") {
  for (const float bad : {kNan, kInfinity}) {
    for (const bool is_reference : {false, true}) {
      PosedAsset s(12, 40, 48, false);
      const OpenedAsset opened(s.tiny.parts);
      const std::size_t broken_bone = is_reference ? s.tables().reference : 0;
      s.matrices[broken_bone][5] = bad;
      for (const Target target : supported_targets()) {
        const Refitted result = refit_posed(opened.asset, s, SC_RADIUS_FIT, target);
        CHECK(result.status == SC_OK);
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

TEST_CASE("refit leaves entries past the asset's spheres alone, and matrices past its bones unread") {
  PosedAsset s(9, 11);
  const OpenedAsset opened(s.tiny.parts);
  const std::vector<Sphere> expected = refit_posed(opened.asset, s, SC_RADIUS_DETECT).spheres;
  std::vector<Sphere> spheres(expected.size() + 2, {7, 7, 7, 7});
  s.matrices.emplace_back().fill(kNan);
  RefitJob job;
  job.asset = &opened.asset;
  job.pose = pose_of(s.matrices);
  job.spheres = spheres.data();
  job.sphere_capacity = spheres.size();
  CHECK(job.run() == SC_OK);
  CHECK(same_bits({spheres.end() - 2, spheres.end()}, std::vector<Sphere>(2, {7, 7, 7, 7})));
  spheres.resize(expected.size());
  CHECK(same_bits(spheres, expected));
}

}  // namespace spherechain::test
