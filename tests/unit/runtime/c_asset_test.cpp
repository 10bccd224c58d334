// SPDX-License-Identifier: MIT
// The C API's asset against the C++ one: the same figures, and its own checks. That it is C at all, tests/package and
// samples/c_api show.
#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "both_apis.h"

namespace spherechain::test {
namespace {

template <typename Cpp>
bool same_array(const void* data, std::size_t size, const Span<const Cpp>& span) {
  return size == span.size && data == (size == 0 ? nullptr : span.data);
}

}  // namespace

TEST_CASE("C: an asset opens in the caller's memory and says what the C++ one says") {
  const BothApis both;
  REQUIRE(both.status == SC_OK);
  CHECK(both.asset == static_cast<const void*>(both.memory.data()));
  CHECK(std::string(both.message).empty());
  const Asset& view = both.opened.asset;

  sc_asset_info info;
  info.struct_size = sizeof info;
  REQUIRE(sc_asset_get_info(both.asset, &info) == SC_OK);
  const AssetInfo expected = view.info();
  CHECK(info.sphere_count == 70);
  CHECK(info.region_count == view.region_count());
  CHECK(info.chain_count == view.chain_count());
  CHECK(info.joint_count == view.joint_count());
  CHECK(info.bone_count == 8);
  CHECK(info.morph_count == 3);
  CHECK(info.leaf_count == 70);
  CHECK(info.ignored_pair_count == view.ignored_count());
  CHECK(info.writer == expected.writer);
  CHECK(info.settings == expected.settings);
  CHECK(info.settings_sha256 == expected.settings_sha256);
  CHECK(info.source_file == expected.source_file);
  CHECK(info.source_sha256 == expected.source_sha256);
  CHECK(info.source_rest_hash == expected.source_rest_hash);
  CHECK(info.format_version == expected.format_version);
  CHECK(info.source_vertex_count == expected.source_vertex_count);
  CHECK(info.source_triangle_count == expected.source_triangle_count);
  CHECK(info.chain_entries_table1 == expected.chain_entries_table1);
  CHECK(info.metres_per_unit == expected.metres_per_unit);
  CHECK(info.height == expected.height);
  CHECK(std::memcmp(&info.origin, &expected.origin, 4 * sizeof(Vec3)) == 0);
  CHECK(std::memcmp(&info.phi1, &expected.phi1, 3 * sizeof(FitError)) == 0);
  CHECK(info.refit == static_cast<int>(expected.refit));

  std::size_t count = 0;
  const auto is_same = [&count](const void* data, const auto& span) { return same_array(data, count, span); };
  CHECK(is_same(sc_asset_spheres(both.asset, &count), view.spheres()));
  CHECK(count == 70);
  CHECK(is_same(sc_asset_pivots(both.asset, &count), view.pivots()));
  CHECK(is_same(sc_asset_triangles(both.asset, &count), view.triangles()));
  CHECK(is_same(sc_asset_ignored(both.asset, &count), view.ignored()));
  CHECK(is_same(sc_asset_near_pairs(both.asset, SC_RADIUS_FIT, &count), view.near_pairs(RadiusKind::kFit)));
  CHECK(is_same(sc_asset_near_pairs(both.asset, SC_RADIUS_DETECT, &count), view.near_pairs(RadiusKind::kDetect)));
  CHECK(is_same(sc_asset_source_parts(both.asset, &count), view.source_parts()));
  CHECK(is_same(sc_asset_pivot_vertices(both.asset, &count), view.pivot_vertices()));
  CHECK(is_same(sc_asset_packed_pivots(both.asset, &count), view.packed_pivots()));
  CHECK(is_same(sc_asset_leaves(both.asset, &count), view.surface().leaves));

  sc_region region;
  sc_chain chain;
  sc_joint joint;
  sc_bone bone;
  REQUIRE(sc_asset_region(both.asset, 1, &region) == SC_OK);
  CHECK(region.name == view.region(1).name);
  CHECK(region.triangle_count == view.region(1).triangle_count);
  REQUIRE(sc_asset_chain(both.asset, 1, &chain) == SC_OK);
  CHECK(chain.name == view.chain(1).name);
  CHECK(same_array(chain.spheres, chain.sphere_count, view.chain(1).spheres));
  CHECK(same_array(chain.regions, chain.region_count, view.chain(1).regions));
  REQUIRE(sc_asset_joint(both.asset, 2, &joint) == SC_OK);
  CHECK(joint.name == view.joint(2).name);
  CHECK(joint.parent == view.joint(2).parent);
  CHECK(joint.position.y == view.joint(2).position.y);
  CHECK(joint.tail.z == view.joint(2).tail.z);
  REQUIRE(sc_asset_bone(both.asset, 7, &bone) == SC_OK);
  CHECK(bone.name == view.bone(7).name);
  CHECK(bone.inverse_bind == view.bone(7).inverse_bind);
  CHECK(bone.is_rest == 1);
  CHECK(sc_asset_morph_name(both.asset, 1) == view.morph_name(1));
}

TEST_CASE("C: facts in a struct of another size are refused, and so is none") {
  const BothApis both;
  sc_asset_info info;
  info.struct_size = sizeof info - 8;
  CHECK(sc_asset_get_info(both.asset, &info) == SC_WRONG_ABI);
  CHECK(sc_asset_get_info(both.asset, nullptr) == SC_NULL_ARGUMENT);
}

TEST_CASE("C: no index leads out of the asset, and a null asset is named") {
  const BothApis both;
  sc_region region;
  sc_chain chain;
  sc_joint joint;
  sc_bone bone;
  CHECK(sc_asset_region(both.asset, both.opened.asset.region_count(), &region) == SC_BAD_ARGUMENT);
  CHECK(sc_asset_chain(both.asset, both.opened.asset.chain_count(), &chain) == SC_BAD_ARGUMENT);
  CHECK(sc_asset_joint(both.asset, both.opened.asset.joint_count(), &joint) == SC_BAD_ARGUMENT);
  CHECK(sc_asset_bone(both.asset, 8, &bone) == SC_BAD_ARGUMENT);
  CHECK(sc_asset_morph_name(both.asset, 3) == nullptr);
  CHECK(sc_asset_region(both.asset, 0, nullptr) == SC_NULL_ARGUMENT);
  CHECK(sc_asset_bone(nullptr, 0, &bone) == SC_NULL_ARGUMENT);
  CHECK(sc_asset_morph_name(nullptr, 0) == nullptr);
  std::size_t count = 1;
  CHECK(sc_asset_spheres(nullptr, &count) == nullptr);
  CHECK(count == 0);
  CHECK(sc_asset_spheres(both.asset, nullptr) != nullptr);
  CHECK(sc_asset_near_pairs(both.asset, 2, &count) == nullptr);
  CHECK(sc_detect_scratch_words(nullptr) == 0);
  CHECK(sc_detect_bit_words(nullptr) == 0);
  CHECK(sc_detect_table_words(nullptr) == 0);
  CHECK(sc_filter_ignored_words(nullptr) == 0);
  CHECK(sc_filter_disabled_words(nullptr) == 0);
  CHECK(sc_crowd_scratch_words(nullptr, 1) == 0);
  CHECK(sc_check_source(nullptr, nullptr, 0, 12) == SC_NULL_ARGUMENT);
}

TEST_CASE("C: open says what is wrong with the bytes, the memory or the version, and gives no asset then") {
  BothApis both;
  const auto open = [&](std::uint32_t abi, void* memory, std::size_t memory_size, std::size_t size) {
    both.asset = reinterpret_cast<const sc_asset*>(&both);
    return sc_asset_open(abi, memory, memory_size, both.opened.bytes.data(), size, &both.asset, both.message,
                         sizeof both.message);
  };
  char* memory = reinterpret_cast<char*>(both.memory.data());
  const std::size_t size = both.opened.bytes.size();
  CHECK(open(SC_ABI_VERSION, memory, sc_asset_size(), size - 100) == SC_CORRUPT);
  CHECK(both.asset == nullptr);
  CHECK(std::string(both.message).find("structure") == 0);
  CHECK(open(SC_ABI_VERSION + 1, memory, sc_asset_size(), size) == SC_WRONG_ABI);
  CHECK(both.asset == nullptr);
  CHECK(std::string(both.message) == "compiled with spherechain's headers of ABI version " +
                                         std::to_string(SC_ABI_VERSION + 1) + ", linked with its library of " +
                                         std::to_string(SC_ABI_VERSION));
  CHECK(open(SC_ABI_VERSION, nullptr, sc_asset_size(), size) == SC_NULL_ARGUMENT);
  CHECK(std::string(both.message) == "memory: null");
  CHECK(open(SC_ABI_VERSION, memory + 4, sc_asset_size(), size) == SC_MISALIGNED);
  CHECK(open(SC_ABI_VERSION, memory, sc_asset_size() - 1, size) == SC_CONTEXT_TOO_SMALL);
  CHECK(both.asset == nullptr);
  CHECK(sc_asset_open(SC_ABI_VERSION, memory, sc_asset_size(), both.opened.bytes.data(), size, nullptr, nullptr, 0) ==
        SC_NULL_ARGUMENT);
  CHECK(open(SC_ABI_VERSION, memory, sc_asset_size(), size) == SC_OK);
  CHECK(sc_abi_version() == SC_ABI_VERSION);
}

TEST_CASE("C: targets and sentences") {
  sc_target targets[8];
  const std::size_t count = sc_supported_targets(targets, 8);
  REQUIRE(count == supported_targets().size);
  CHECK(targets[count - 1] == SC_TARGET_SCALAR);
  CHECK(sc_supported_targets(nullptr, 0) == count);
  sc_target found = -1;
  CHECK(sc_find_target(sc_target_name(targets[0]), &found) == SC_OK);
  CHECK(found == targets[0]);
  CHECK(sc_find_target("quantum", &found) == SC_UNSUPPORTED_TARGET);
  CHECK(found == targets[0]);
  CHECK(sc_find_target("scalar", nullptr) == SC_NULL_ARGUMENT);
  CHECK(sc_target_lanes(SC_TARGET_SCALAR) == 1);
  CHECK(sc_target_lanes(257) == 0);
  CHECK(std::string(sc_target_name(257)) == "unknown target");
  CHECK(std::string(sc_status_string(SC_OK)) == "done");
  CHECK(std::string(sc_status_string(99)) == "unknown status");
  const float position[3] = {1.0F, -0.0F, 2.0F};
  CHECK(sc_hash_positions(position, 1, 12) == hash_positions(position, 1));
}

}  // namespace spherechain::test
