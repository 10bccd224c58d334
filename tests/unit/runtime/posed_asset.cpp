// SPDX-License-Identifier: MIT
#include "posed_asset.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherechain::test {
namespace {

double distance(const Sphere& a, const Sphere& b) {
  return std::max({std::abs(double{a.x} - double{b.x}), std::abs(double{a.y} - double{b.y}),
                   std::abs(double{a.z} - double{b.z}), std::abs(double{a.radius} - double{b.radius})});
}

}  // namespace

Refitted refit_posed(const Asset& asset, const PosedAsset& s, RadiusKind radius, Target target) {
  return refit_bones(asset, {s.matrices[0].data(), s.matrices.size()}, s.morph_weights, radius, target);
}

void check_exact(const PosedAsset& s, Reference reference) {
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  for (const RadiusKind radius : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const std::vector<Sphere> expected = reference(s, radius);
    for (const Target target : supported_targets()) {
      INFO(to_string(target), ", ", expected.size(), " spheres");
      const Refitted result = refit_posed(opened.asset, s, radius, target);
      CHECK(result.status == Status::kOk);
      CHECK(same_bits(result.spheres, expected));
    }
  }
}

void check_close(const std::vector<Sphere>& spheres, const std::vector<Sphere>& expected, double tolerance) {
  REQUIRE(spheres.size() == expected.size());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    INFO("sphere ", i);
    CHECK(distance(spheres[i], expected[i]) < tolerance);
  }
}

void check_against_mesh(const PosedAsset& s, double tolerance) {
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const std::vector<float> mesh = skinned(s.tiny, s.skin, s.matrices, s.morph_weights);
  for (const RadiusKind radius : {RadiusKind::kFit, RadiusKind::kDetect}) {
    const Refitted result = refit_posed(opened.asset, s, radius), expected = refit(opened.asset, mesh, radius);
    REQUIRE(result.status == Status::kOk);
    REQUIRE(expected.status == Status::kOk);
    check_close(result.spheres, expected.spheres, tolerance);
  }
}

void check_layouts(const PosedAsset& s) {
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const Refitted expected = refit_posed(opened.asset, s, RadiusKind::kDetect);
  REQUIRE(expected.status == Status::kOk);
  for (const MatrixLayout layout : {MatrixLayout::kRowMajor3x4, MatrixLayout::kRowMajor4x4,
                                    MatrixLayout::kColumnMajor4x4, MatrixLayout::kColumnMajor3x4}) {
    for (const std::size_t padding : {0U, 4U, 52U}) {
      const Palette palette(s.matrices, layout, size_of(layout) + padding);
      for (const Target target : supported_targets()) {
        INFO("layout ", static_cast<int>(layout), ", padding ", padding, ", ", to_string(target));
        const Refitted result =
            refit_bones(opened.asset, palette.view(s.matrices.size()), s.morph_weights, RadiusKind::kDetect, target);
        CHECK(result.status == Status::kOk);
        CHECK(same_bits(result.spheres, expected.spheres));
      }
    }
  }
}

void check_longer_arrays(const PosedAsset& s) {
  const OpenedAsset opened(s.tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const std::vector<Sphere> expected = refit_posed(opened.asset, s, RadiusKind::kDetect).spheres;
  std::vector<Sphere> spheres(expected.size() + 2, {7, 7, 7, 7});
  std::vector<Matrix> matrices = s.matrices;
  matrices.emplace_back().fill(std::numeric_limits<float>::quiet_NaN());
  RefitBonesJob job;
  job.asset = &opened.asset;
  job.bones = {matrices[0].data(), matrices.size()};
  job.morph_weights = {s.morph_weights.data(), s.morph_weights.size()};
  job.spheres = {spheres.data(), spheres.size()};
  CHECK(job.run() == Status::kOk);
  CHECK(same_bits({spheres.end() - 2, spheres.end()}, std::vector<Sphere>(2, {7, 7, 7, 7})));
  spheres.resize(expected.size());
  CHECK(same_bits(spheres, expected));
}

}  // namespace spherechain::test
