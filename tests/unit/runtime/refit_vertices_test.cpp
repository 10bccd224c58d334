// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "jobs.h"
#include "tiny_bones.h"

namespace spherechain::test {
namespace {

// The error of coordinates around 1 and sums of a dozen floats: some units in the last place.
constexpr double kRounding = 2e-6;

struct Expected {
  double x, y, z, radius;
};

// The fixed arithmetic of docs/arithmetic.md, to the last bit, written apart from the runtime.
Sphere exact_sphere(const AssetParts& parts, const RestSphere& rest, const std::vector<float>& v, Radius kind) {
  std::vector<std::array<float, 3>> centroids;
  float c[3] = {0, 0, 0};
  for (std::size_t k = rest.first_pivot; k < rest.first_pivot + rest.pivot_count; ++k) {
    const Pivot& pivot = parts.pivots[k];
    std::array<float, 3> p{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float sum = v[3 * pivot.a + axis] + v[3 * pivot.b + axis];
      p[axis] = (sum + v[3 * pivot.c + axis]) * (1.0F / 3);
      c[axis] = c[axis] + pivot.weight * p[axis];
    }
    centroids.push_back(p);
  }
  float sum = 0;
  for (const auto& p : centroids) {
    const float dx = p[0] - c[0], dy = p[1] - c[1], dz = p[2] - c[2];
    const float squared = (dx * dx + dy * dy) + dz * dz;
    sum = sum + (parts.refit == 0 ? std::sqrt(squared) : squared);
  }
  const float quotient = sum / static_cast<float>(rest.pivot_count);
  const float mean = parts.refit == 0 ? quotient : std::sqrt(quotient);
  const bool fit = kind == SC_RADIUS_FIT;
  const float paper = fit ? mean : mean * (rest.detect_radius / rest.radius);
  const float moments = (fit ? rest.radius : rest.detect_radius) * (mean / rest.pivot_spread);
  return {c[0], c[1], c[2], parts.refit == 0 ? paper : moments};
}

void check_close(const Sphere& sphere, const Expected& expected, double tolerance) {
  CHECK(std::abs(double{sphere.x} - expected.x) < tolerance);
  CHECK(std::abs(double{sphere.y} - expected.y) < tolerance);
  CHECK(std::abs(double{sphere.z} - expected.z) < tolerance);
  CHECK(std::abs(double{sphere.radius} - expected.radius) < tolerance);
}

// Uneven weights, so that no centre is a plain mean.
TinyAsset weighted_asset(std::uint8_t rule) {
  TinyAsset tiny = random_asset(9, 11);
  tiny.parts.refit = rule;
  std::mt19937 random(5);
  for (Pivot& pivot : tiny.parts.pivots) {
    pivot.weight = uniform(random, -0.2F, 0.7F);
  }
  return tiny;
}

std::vector<float> deformed(std::vector<float> positions) {
  std::mt19937 random(6);
  for (float& value : positions) {
    value += uniform(random, -0.3F, 0.3F);
  }
  return positions;
}

}  // namespace

TEST_CASE("by moments spheres are the rest spheres at rest") {
  const TinyAsset tiny = random_asset(9, 10);
  const OpenedAsset opened(tiny.parts);
  for (const Radius kind : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const Refitted result = refit(opened.asset, tiny.rest, kind);
    REQUIRE(result.status == SC_OK);
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      const RestSphere& rest = tiny.parts.spheres[i];
      const float radius = kind == SC_RADIUS_FIT ? rest.radius : rest.detect_radius;
      check_close(result.spheres[i], {rest.center.x, rest.center.y, rest.center.z, radius}, kRounding);
    }
  }
}

TEST_CASE("the paper's radius is the mean distance of the pivots, whatever the rest radius") {
  TinyAsset tiny = random_asset(9, 10);
  tiny.parts.refit = 0;
  const OpenedAsset opened(tiny.parts);
  const Refitted fit = refit(opened.asset, tiny.rest, SC_RADIUS_FIT);
  const Refitted detect = refit(opened.asset, tiny.rest, SC_RADIUS_DETECT);
  for (std::size_t i = 0; i < fit.spheres.size(); ++i) {
    CHECK(fit.spheres[i].radius == doctest::Approx(tiny.parts.spheres[i].pivot_spread).epsilon(kRounding));
    CHECK(detect.spheres[i].radius == doctest::Approx(1.25 * double{fit.spheres[i].radius}).epsilon(kRounding));
  }
}

TEST_CASE("spheres follow the fixed arithmetic bit for bit") {
  for (const std::uint8_t rule : {std::uint8_t{0}, std::uint8_t{1}}) {
    TinyAsset tiny = weighted_asset(rule);
    give_pivots(tiny, 3, 16, 1);
    give_pivots(tiny, 5, 17, 2);
    const OpenedAsset opened(tiny.parts);
    const std::vector<float> positions = deformed(tiny.rest);
    for (const Radius kind : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
      std::vector<Sphere> expected;
      for (const RestSphere& rest : tiny.parts.spheres) {
        expected.push_back(exact_sphere(tiny.parts, rest, positions, kind));
      }
      CHECK(same_bits(refit(opened.asset, positions, kind).spheres, expected));
    }
  }
}

TEST_CASE("spheres move, turn and grow with the body") {
  for (const std::uint8_t rule : {std::uint8_t{0}, std::uint8_t{1}}) {
    TinyAsset tiny = random_asset(9, 12);
    tiny.parts.refit = rule;
    const OpenedAsset opened(tiny.parts);
    const Refitted rest = refit(opened.asset, tiny.rest, SC_RADIUS_FIT);
    constexpr float kScale = 2.5F;
    const auto move = [](float x, float y, float z) {  // a quarter turn about z, scaled, shifted
      return std::array<float, 3>{-kScale * y + 1.0F, kScale * x - 2.0F, kScale * z + 0.5F};
    };
    std::vector<float> positions = tiny.rest;
    for (std::size_t v = 0; v < positions.size(); v += 3) {
      const auto moved = move(positions[v], positions[v + 1], positions[v + 2]);
      std::copy(moved.begin(), moved.end(), positions.begin() + static_cast<std::ptrdiff_t>(v));
    }
    const Refitted result = refit(opened.asset, positions, SC_RADIUS_FIT);
    for (std::size_t i = 0; i < result.spheres.size(); ++i) {
      const auto center = move(rest.spheres[i].x, rest.spheres[i].y, rest.spheres[i].z);
      const Expected expected{center[0], center[1], center[2], double{kScale * rest.spheres[i].radius}};
      check_close(result.spheres[i], expected, 4 * kRounding);
    }
  }
}

TEST_CASE("a stride skips what lies between positions, bit for bit") {
  const TinyAsset tiny = weighted_asset(1);
  const OpenedAsset opened(tiny.parts);
  const Refitted packed = refit(opened.asset, tiny.rest, SC_RADIUS_DETECT);
  for (const std::size_t stride : {16U, 20U, 32U}) {
    std::vector<float> padded;
    for (std::size_t v = 0; v < tiny.rest.size(); v += 3) {
      padded.insert(padded.end(), {tiny.rest[v], tiny.rest[v + 1], tiny.rest[v + 2]});
      padded.resize(padded.size() + stride / 4 - 3, 1e9F);
    }
    const Refitted result = refit(opened.asset, padded, SC_RADIUS_DETECT, stride);
    CHECK(result.status == SC_OK);
    CHECK(same_bits(result.spheres, packed.spheres));
  }
}

TEST_CASE("positions that are not finite give spheres that are not finite") {
  const TinyAsset tiny = random_asset(3, 13);
  const OpenedAsset opened(tiny.parts);
  for (const float bad : {kNan, kInfinity}) {
    std::vector<float> positions = tiny.rest;
    positions[3 * tiny.parts.pivots[0].a] = bad;
    const Refitted result = refit(opened.asset, positions, SC_RADIUS_FIT);
    CHECK(result.status == SC_OK);
    CHECK(!std::isfinite(result.spheres[0].x));
    CHECK(std::isfinite(result.spheres[1].x));
    CHECK(std::isfinite(result.spheres[1].radius));
  }
}

}  // namespace spherechain::test
