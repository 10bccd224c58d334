// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "jobs.h"
#include "tiny_bones.h"

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
  CHECK(opened.status == SC_OK);
  CHECK(is_open(&opened.asset));
  CHECK(opened.message.empty());
}

TEST_CASE("the views of an open asset hold what was written") {
  const AssetParts parts = random_asset(12, 2).parts;
  const OpenedAsset opened(parts);
  const AssetView& asset = opened.view();
  REQUIRE(opened.status == SC_OK);

  CHECK(same_bits(to_vector(asset.spheres()), parts.spheres));
  CHECK(same_bits(to_vector(asset.pivots()), parts.pivots));
  CHECK(same_bits(to_vector(asset.source_buffers()), parts.buffers));
  CHECK(to_vector(asset.ignored()) == parts.ignored);
  CHECK(same_bits(to_vector(asset.rest_pairs(SC_RADIUS_FIT)), parts.rest_fit));
  CHECK(same_bits(to_vector(asset.rest_pairs(SC_RADIUS_DETECT)), parts.rest_detect));
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
  REQUIRE(asset.part_count() == parts.parts.size());
  for (std::size_t i = 0; i < parts.parts.size(); ++i) {
    CHECK(asset.part(i).name == parts.parts[i].name);
    CHECK(asset.part(i).side == parts.parts[i].side);
    CHECK(asset.part(i).bone == parts.parts[i].bone);
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
  parts.spheres[0] = {{1.0F, 2.0F, 3.0F}, 4.0F, 5.0F, 6.0F, 1, 0, 3, 7, SC_SIDE_RIGHT, 9, 2, 0};
  const OpenedAsset opened(parts);
  REQUIRE(opened.status == SC_OK);
  const RestSphere& sphere = opened.view().spheres()[0];
  CHECK(same(sphere.center, {1.0F, 2.0F, 3.0F}));
  CHECK(sphere.radius == 4.0F);
  CHECK(sphere.detect_radius == 5.0F);
  CHECK(sphere.pivot_spread == 6.0F);
  CHECK(sphere.first_pivot == 1);
  CHECK(sphere.pivot_count == 3);
  CHECK(sphere.region == 7);
  CHECK(sphere.side == SC_SIDE_RIGHT);
  CHECK(sphere.level == 9);
  const sc_rest_sphere shown = sc_asset_sphere(&opened.asset, 0);
  CHECK(same(shown.center, sphere.center));
  CHECK(shown.radius == 4.0F);
  CHECK(shown.detect_radius == 5.0F);
  CHECK(shown.side == SC_SIDE_RIGHT);
  CHECK(shown.region == 7);
  CHECK(shown.level == 9);
}

TEST_CASE("info tells where the asset comes from") {
  const AssetParts parts = random_asset(5, 4).parts;
  const OpenedAsset opened(parts);
  REQUIRE(opened.status == SC_OK);
  const AssetInfo info = sc_asset_get_info(&opened.asset);
  CHECK(info.writer == parts.writer);
  CHECK(info.settings == parts.settings);
  CHECK(info.settings_sha256 == parts.settings_sha256);
  CHECK(info.source_file == parts.source_file);
  CHECK(info.source_sha256 == parts.source_sha256);
  CHECK(info.vertex_count == parts.vertex_count);
  CHECK(info.triangle_count == parts.triangle_count);
  CHECK(info.source_rest_hash == parts.rest_hash);
  CHECK(info.metres_per_unit == parts.metres_per_unit);
  CHECK(same(info.origin, parts.origin));
  CHECK(same(info.left, parts.left));
  CHECK(same(info.up, parts.up));
  CHECK(same(info.forward, parts.forward));
  CHECK(info.height == parts.height);
  CHECK(info.sphere_count == 5);
  CHECK(info.bone_count == 0);
  CHECK(info.part_count == parts.parts.size());
  CHECK(info.region_count == parts.regions.size());
  CHECK(info.source_buffer_count == parts.buffers.size());
  CHECK(info.ignored_pair_count == random_asset(5, 4).ignored_pairs.size());
  const FitErrors fit = opened.view().fit();
  CHECK(same(fit.phi1, parts.phi1));
  CHECK(same(fit.phi1_adjusted, parts.phi1_adjusted));
  CHECK(same(fit.phi2, parts.phi2));
  CHECK(opened.view().refit_rule() == RefitRule::kMoments);
}

TEST_CASE("an asset without joints, rest pairs or source buffers, of one sphere, opens") {
  AssetParts parts = random_asset(1, 5).parts;
  parts.buffers.clear();
  parts.joints.clear();
  parts.rest_fit.clear();
  parts.rest_detect.clear();
  const OpenedAsset opened(parts);
  CHECK(opened.status == SC_OK);
  CHECK(opened.view().joint_count() == 0);
  CHECK(opened.view().source_buffers().size == 0);
  CHECK(opened.view().ignored().size == 0);
  CHECK(opened.view().rest_pairs(SC_RADIUS_FIT).size == 0);
}

TEST_CASE("a copy is a view of the same bytes") {
  const OpenedAsset opened(random_asset(5, 6).parts);
  const Asset copy = opened.asset;
  CHECK(view_of(copy).spheres().data == opened.view().spheres().data);
  CHECK(sc_asset_get_info(&copy).writer == sc_asset_get_info(&opened.asset).writer);
}

TEST_CASE("an asset tells its bones, parts and morph targets, and zeros of those that it has not") {
  TinyAsset tiny = random_asset(12, 1);
  add_bones(tiny, 5, 2);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const Asset* const asset = &opened.asset;
  CHECK(std::string(sc_asset_bone(asset, 2).name) == "bone2");
  CHECK(sc_asset_bone(asset, 2).inverse_bind[3] == -2.0F);
  CHECK(sc_asset_bone(asset, 2).inverse_bind[10] == 1.0F);
  CHECK(std::string(sc_asset_bone(asset, 4).name).empty());
  CHECK(std::string(sc_asset_part(asset, 1).name) == "right hand");
  CHECK(sc_asset_part(asset, 1).side == SC_SIDE_RIGHT);
  CHECK(sc_asset_part(asset, 1).bone == 1);
  CHECK(std::string(sc_asset_morph_name(asset, 2)) == "morph2");
  CHECK(std::string(sc_asset_region_name(asset, 4)) == "torso");
  CHECK(sc_asset_source_buffer(asset, 1).first_vertex == 4);
  CHECK(sc_asset_bone(asset, 5).name == nullptr);
  CHECK(sc_asset_part(asset, 5).name == nullptr);
  CHECK(sc_asset_morph_name(asset, 3) == nullptr);
  CHECK(sc_asset_region_name(asset, 5) == nullptr);
  CHECK(sc_asset_source_buffer(asset, 2).vertex_count == 0);
  CHECK(sc_asset_sphere(asset, 12).radius == 0);
}

TEST_CASE("of an asset that is not open all is zero, and what it takes is nothing") {
  const Asset closed{};
  for (const Asset* asset : {&closed, static_cast<const Asset*>(nullptr)}) {
    CHECK(!is_open(asset));
    CHECK(sc_pair_words(asset) == 0);
    CHECK(detect_table_words(asset) == 0);
    CHECK(skin_table_words(asset) == 0);
    CHECK(skin_scratch_words(asset) == 0);
    CHECK(sc_crowd_scratch_words(asset, 1) == 0);
  }
}

TEST_CASE("the message is cut to the buffer, final zero included") {
  std::vector<std::uint8_t> bytes = build(random_asset(5, 7).parts);
  bytes[4] = 'X';
  char message[8];
  std::memset(message, '#', sizeof message);
  Asset asset;
  const auto open = [&](char* to, std::size_t size) {
    return sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), bytes.size(), to, size);
  };
  CHECK(open(message, 6) == SC_NOT_AN_ASSET);
  CHECK(std::string(message) == "file ");
  CHECK(message[6] == '#');
  CHECK(open(message + 7, 0) == SC_NOT_AN_ASSET);
  CHECK(message[7] == '#');
  CHECK(open(nullptr, 0) == SC_NOT_AN_ASSET);
}

TEST_CASE("an asset that fails to open is closed, whatever it was before") {
  const OpenedAsset opened(random_asset(5, 8).parts);
  std::vector<std::uint8_t> bytes = opened.bytes;
  bytes[4] = 'X';
  Asset asset = opened.asset;
  CHECK(sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), bytes.size(), nullptr, 0) ==
        sc_status{SC_NOT_AN_ASSET, SC_FIELD_DATA});
  CHECK(!is_open(&asset));
}

TEST_CASE("a program compiled with other headers is refused, and gets both versions") {
  const OpenedAsset opened(random_asset(5, 8).parts);
  Asset asset;
  char message[160] = "";
  CHECK(sc_asset_open(&asset, SC_ABI_VERSION - 1, opened.bytes.data(), opened.bytes.size(), message, 160) ==
        SC_WRONG_ABI);
  CHECK(std::string(message).find("ABI version " + std::to_string(SC_ABI_VERSION - 1)) != std::string::npos);
}

}  // namespace spherechain::test
