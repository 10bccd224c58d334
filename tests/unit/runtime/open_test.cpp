// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

bool same(const Vec3& l, const Vec3& r) { return l.x == r.x && l.y == r.y && l.z == r.z; }
bool same(const FitError& l, const FitError& r) { return l.mean_abs_f == r.mean_abs_f && l.max_abs_f == r.max_abs_f; }

template <typename T>
std::vector<T> to_vector(Span<const T> span) {
  return {span.begin(), span.end()};
}

}  // namespace

TEST_CASE("a valid asset opens, with no message") {
  const OpenedAsset opened(random_asset(12, 1).parts);
  CHECK(opened.status == Status::kOk);
  CHECK(opened.asset.is_open());
  CHECK(opened.message.empty());
}

TEST_CASE("the views of an open asset hold what was written") {
  const AssetParts parts = random_asset(12, 2).parts;
  const OpenedAsset opened(parts);
  const Asset& asset = opened.asset;
  REQUIRE(opened.status == Status::kOk);

  CHECK(same_bits(to_vector(asset.spheres()), parts.spheres));
  CHECK(same_bits(to_vector(asset.pivots()), parts.pivots));
  CHECK(to_vector(asset.triangles()) == parts.triangles);
  CHECK(same_bits(to_vector(asset.source_parts()), parts.source_parts));
  CHECK(to_vector(asset.ignored()) == parts.ignored);
  CHECK(same_bits(to_vector(asset.near_pairs(RadiusKind::kFit)), parts.near_fit));
  CHECK(same_bits(to_vector(asset.near_pairs(RadiusKind::kDetect)), parts.near_detect));
  CHECK(asset.ignored_count() == random_asset(12, 2).ignored_pairs.size());

  REQUIRE(asset.region_count() == parts.regions.size());
  for (std::size_t i = 0; i < parts.regions.size(); ++i) {
    CHECK(asset.region(i).name == parts.regions[i].name);
    CHECK(asset.region(i).triangle_count == parts.regions[i].triangle_count);
  }
  REQUIRE(asset.chain_count() == parts.chains.size());
  for (std::size_t i = 0; i < parts.chains.size(); ++i) {
    CHECK(asset.chain(i).name == parts.chains[i].name);
    CHECK(to_vector(asset.chain(i).regions) == parts.chains[i].regions);
    CHECK(to_vector(asset.chain(i).spheres) == parts.chains[i].spheres);
  }
  REQUIRE(asset.joint_count() == parts.joints.size());
  for (std::size_t i = 0; i < parts.joints.size(); ++i) {
    CHECK(asset.joint(i).name == parts.joints[i].name);
    CHECK(asset.joint(i).parent == parts.joints[i].parent);
    CHECK(same(asset.joint(i).position, parts.joints[i].position));
    CHECK(same(asset.joint(i).tail, parts.joints[i].tail));
  }
}

TEST_CASE("each field of a sphere has a place of its own") {
  AssetParts parts = random_asset(1, 3).parts;
  parts.regions.resize(8);
  parts.spheres[0] = {{1.0F, 2.0F, 3.0F}, 4.0F, 5.0F, 6.0F, 1, 2, 1, 3, 7, Side::kRight, 9, 0};
  const OpenedAsset opened(parts);
  REQUIRE(opened.status == Status::kOk);
  const RestSphere& sphere = opened.asset.spheres()[0];
  CHECK(same(sphere.center, {1.0F, 2.0F, 3.0F}));
  CHECK(sphere.radius == 4.0F);
  CHECK(sphere.detect_radius == 5.0F);
  CHECK(sphere.pivot_spread == 6.0F);
  CHECK(sphere.first_pivot == 1);
  CHECK(sphere.first_triangle == 2);
  CHECK(sphere.triangle_count == 1);
  CHECK(sphere.pivot_count == 3);
  CHECK(sphere.region == 7);
  CHECK(sphere.side == Side::kRight);
  CHECK(sphere.level == 9);
}

TEST_CASE("info tells where the asset comes from") {
  const AssetParts parts = random_asset(5, 4).parts;
  const OpenedAsset opened(parts);
  REQUIRE(opened.status == Status::kOk);
  const AssetInfo info = opened.asset.info();
  CHECK(info.format_version == kFormatVersion);
  CHECK(info.writer == parts.writer);
  CHECK(info.settings == parts.settings);
  CHECK(info.settings_sha256 == parts.settings_sha256);
  CHECK(info.source_file == parts.source_file);
  CHECK(info.source_sha256 == parts.source_sha256);
  CHECK(info.source_vertex_count == parts.vertex_count);
  CHECK(info.source_triangle_count == parts.triangle_count);
  CHECK(info.source_rest_hash == parts.rest_hash);
  CHECK(info.metres_per_unit == parts.metres_per_unit);
  CHECK(same(info.origin, parts.origin));
  CHECK(same(info.left, parts.left));
  CHECK(same(info.up, parts.up));
  CHECK(same(info.forward, parts.forward));
  CHECK(info.height == parts.height);
  CHECK(same(info.phi1, parts.phi1));
  CHECK(same(info.phi1_adjusted, parts.phi1_adjusted));
  CHECK(same(info.phi2, parts.phi2));
  CHECK(info.refit == RefitRule::kCalibrated);
  CHECK(info.chain_entries_table1 == parts.chain_entries_table1);
}

TEST_CASE("an asset without joints, near pairs or source parts, of one sphere, opens") {
  AssetParts parts = random_asset(1, 5).parts;
  parts.source_parts.clear();
  parts.joints.clear();
  parts.near_fit.clear();
  parts.near_detect.clear();
  const OpenedAsset opened(parts);
  CHECK(opened.status == Status::kOk);
  CHECK(opened.asset.joint_count() == 0);
  CHECK(opened.asset.source_parts().size == 0);
  CHECK(opened.asset.ignored().size == 0);
  CHECK(opened.asset.near_pairs(RadiusKind::kFit).size == 0);
}

TEST_CASE("a copy is a view of the same bytes") {
  const OpenedAsset opened(random_asset(5, 6).parts);
  const Asset copy = opened.asset;
  CHECK(copy.spheres().data == opened.asset.spheres().data);
  CHECK(copy.info().writer == opened.asset.info().writer);
}

TEST_CASE("the message is cut to the buffer, final zero included") {
  std::vector<std::uint8_t> bytes = build(random_asset(5, 7).parts);
  bytes[4] = 'X';
  char message[8];
  std::memset(message, '#', sizeof message);
  CHECK(Asset().open(bytes.data(), bytes.size(), message, 6) == Status::kWrongIdentifier);
  CHECK(std::string(message) == "file ");
  CHECK(message[6] == '#');
  CHECK(Asset().open(bytes.data(), bytes.size(), message + 7, 0) == Status::kWrongIdentifier);
  CHECK(message[7] == '#');
  CHECK(Asset().open(bytes.data(), bytes.size()) == Status::kWrongIdentifier);
}

TEST_CASE("an asset that fails to open is closed, whatever it was before") {
  const OpenedAsset opened(random_asset(5, 8).parts);
  std::vector<std::uint8_t> bytes = opened.bytes;
  bytes[4] = 'X';
  Asset asset = opened.asset;
  CHECK(asset.open(bytes.data(), bytes.size()) == Status::kWrongIdentifier);
  CHECK(!asset.is_open());
  CHECK(asset.spheres().size == 0);
}

}  // namespace spherechain::test
