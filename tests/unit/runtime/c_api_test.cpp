// SPDX-License-Identifier: MIT
// The C API against the C++ API: the same figures, and its own checks. That it is C at all, tests/package and
// samples/c_api show.
#include "spherechain/spherechain.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "jobs.h"
#include "spherechain/confirm.h"
#include "spherechain/contacts.h"
#include "spherechain/crowd.h"
#include "spherechain/triangle_contacts.h"
#include "tiny_surface.h"

namespace spherechain::test {
namespace {

// One asset, seen through both APIs.
struct BothApis {
  BothApis()
      : tiny(random_asset(70, 5)), skin(add_bones(tiny, 8, 6)), opened((add_surface(tiny, &skin, 4), tiny.parts)) {
    memory.resize(sc_asset_size() / 8 + 1);
    status = sc_asset_open(SC_ABI_VERSION, memory.data(), sc_asset_size(), opened.bytes.data(), opened.bytes.size(),
                           &asset, message, sizeof message);
    matrices = random_matrices(8, 7);
    spheres = refit_bones(opened.asset, {matrices[0].data(), matrices.size()}, {}, RadiusKind::kDetect).spheres;
    std::memcpy(c_spheres.data(), spheres.data(), sizeof c_spheres[0] * c_spheres.size());
  }

  TinyAsset tiny;
  TinySkin skin;
  OpenedAsset opened;
  std::vector<std::uint64_t> memory;
  const sc_asset* asset = nullptr;
  char message[160];
  sc_status status;
  std::vector<Matrix> matrices;
  std::vector<Sphere> spheres;
  std::vector<sc_sphere> c_spheres{70};
};

template <typename C, typename Cpp>
bool same_bytes(const std::vector<C>& c, const std::vector<Cpp>& cpp) {
  return c.size() == cpp.size() && (c.empty() || std::memcmp(c.data(), cpp.data(), c.size() * sizeof(C)) == 0);
}

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
  CHECK(std::string(both.message) ==
        "compiled with spherechain's headers of ABI version 5, linked with its library of 4");
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

TEST_CASE("C: a struct of another size is refused, and so is none") {
  const BothApis both;
  sc_asset_info info;
  info.struct_size = sizeof info - 8;
  CHECK(sc_asset_get_info(both.asset, &info) == SC_WRONG_ABI);
  CHECK(sc_asset_get_info(both.asset, nullptr) == SC_NULL_ARGUMENT);
  sc_refit_job refit = SC_REFIT_JOB_INIT;
  sc_refit_bones_job bones = SC_REFIT_BONES_JOB_INIT;
  sc_detect_job detect = SC_DETECT_JOB_INIT;
  sc_contact_job contacts = SC_CONTACT_JOB_INIT;
  sc_crowd_job crowd = SC_CROWD_JOB_INIT;
  CHECK(sc_refit(&refit) == SC_NULL_ARGUMENT);  // no asset
  CHECK(sc_refit_bones(&bones) == SC_NULL_ARGUMENT);
  CHECK(sc_detect(&detect) == SC_NULL_ARGUMENT);
  CHECK(sc_contacts(&contacts) == SC_NULL_ARGUMENT);
  CHECK(sc_crowd(&crowd) == SC_NULL_ARGUMENT);
  refit.struct_size += 8;
  bones.struct_size += 8;
  detect.struct_size += 8;
  contacts.struct_size = 0;
  crowd.struct_size -= 8;
  CHECK(sc_refit(&refit) == SC_WRONG_ABI);
  CHECK(sc_refit_bones(&bones) == SC_WRONG_ABI);
  CHECK(sc_detect(&detect) == SC_WRONG_ABI);
  CHECK(sc_contacts(&contacts) == SC_WRONG_ABI);
  CHECK(sc_crowd(&crowd) == SC_WRONG_ABI);
  CHECK(sc_refit(nullptr) == SC_NULL_ARGUMENT);
  CHECK(sc_refit_bones(nullptr) == SC_NULL_ARGUMENT);
  CHECK(sc_detect(nullptr) == SC_NULL_ARGUMENT);
  CHECK(sc_contacts(nullptr) == SC_NULL_ARGUMENT);
  CHECK(sc_crowd(nullptr) == SC_NULL_ARGUMENT);
}

TEST_CASE("C: both refits give the C++ API's spheres") {
  const BothApis both;
  for (const RadiusKind radius : {RadiusKind::kFit, RadiusKind::kDetect}) {
    std::vector<sc_sphere> spheres(70);
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

    // Wider strides, column-major and with morph weights, so that each field counts.
    std::vector<float> wide(8 * 20);
    for (std::size_t i = 0; i < 8; ++i) {
      for (std::size_t column = 0; column < 4; ++column) {
        for (std::size_t row = 0; row < 3; ++row) {
          wide[20 * i + 4 * column + row] = both.matrices[i][4 * row + column];
        }
      }
    }
    const std::vector<float> morph_weights{0.25F, -0.5F, 1.0F};
    sc_refit_bones_job bones = SC_REFIT_BONES_JOB_INIT;
    bones.asset = both.asset;
    bones.bones = {wide.data(), 8, 80, SC_COLUMN_MAJOR_4X4, 0};
    bones.morph_weights = morph_weights.data();
    bones.morph_weight_count = 3;
    bones.radius = static_cast<sc_radius>(radius);
    bones.spheres = spheres.data();
    bones.sphere_count = spheres.size();
    REQUIRE(sc_refit_bones(&bones) == SC_OK);
    const BoneMatrices rows{both.matrices[0].data(), both.matrices.size()};
    CHECK(same_bytes(spheres, refit_bones(both.opened.asset, rows, morph_weights, radius).spheres));
    bones.target = SC_TARGET_SCALAR;
    CHECK(sc_refit_bones(&bones) == SC_OK);
    bones.bones.count = 7;
    CHECK(sc_refit_bones(&bones) == SC_TOO_FEW_BONES);
  }
}

TEST_CASE("C: cover and skin give what the C++ jobs give") {
  const BothApis both;
  std::vector<float> wide;  // strides and morph weights of its own, so that each field counts
  for (const Matrix& matrix : both.matrices) {
    wide.insert(wide.end(), matrix.begin(), matrix.end());
    wide.insert(wide.end(), 3, 0.0F);
  }
  const std::vector<float> morph_weights{0.25F, -0.5F, 1.0F};
  const BoneMatrices rows{both.matrices[0].data(), both.matrices.size()};
  std::vector<sc_sphere> leaves(70), spheres(70);
  sc_cover_job cover_job = SC_COVER_JOB_INIT;
  cover_job.asset = both.asset;
  cover_job.bones = {wide.data(), 8, 60, SC_ROW_MAJOR_3X4, 0};
  cover_job.morph_weights = morph_weights.data();
  cover_job.morph_weight_count = 3;
  cover_job.leaves = leaves.data();
  cover_job.leaf_count = leaves.size();
  REQUIRE(sc_cover(&cover_job) == SC_OK);
  CHECK(same_bytes(leaves, cover(both.opened.asset, rows, morph_weights).leaves));
  cover_job.spheres = spheres.data();
  cover_job.sphere_count = spheres.size();
  cover_job.target = SC_TARGET_SCALAR;
  REQUIRE(sc_cover(&cover_job) == SC_OK);
  CHECK(same_bytes(spheres, cover(both.opened.asset, rows, morph_weights).spheres));
  cover_job.leaf_count = 69;
  CHECK(sc_cover(&cover_job) == SC_TOO_FEW_SPHERES);
  CHECK(sc_cover(nullptr) == SC_NULL_ARGUMENT);

  const SkinnedSurface expected = skin(both.opened.asset, rows, morph_weights, Target::kBest, 16);
  std::vector<float> positions(expected.positions.size(), std::numeric_limits<float>::quiet_NaN());
  sc_skin_job skin_job = SC_SKIN_JOB_INIT;
  skin_job.asset = both.asset;
  skin_job.bones = cover_job.bones;
  skin_job.morph_weights = morph_weights.data();
  skin_job.morph_weight_count = 3;
  skin_job.positions = positions.data();
  skin_job.vertex_count = both.opened.asset.info().source_vertex_count;
  skin_job.stride = 16;
  skin_job.target = SC_TARGET_SCALAR;
  REQUIRE(sc_skin(&skin_job) == SC_OK);
  CHECK(same_bits(positions, expected.positions));
  skin_job.vertex_count -= 1;
  CHECK(sc_skin(&skin_job) == SC_TOO_FEW_VERTICES);
  skin_job.struct_size += 1;
  CHECK(sc_skin(&skin_job) == SC_WRONG_ABI);
}

TEST_CASE("C: triangle contacts, pairs found and confirmed by them, are those of the C++ jobs") {
  const BothApis both;
  const Asset& asset = both.opened.asset;
  // All regions at the same place: much intersects.
  std::vector<float> positions(4 * asset.info().source_vertex_count);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i * i % 97) / 97;
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset)),
      c_words(sc_triangle_contact_scratch_words(both.asset));
  REQUIRE(words.size() == c_words.size());
  TriangleContactContext context{{words.data(), words.size()}};
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 4;
  job.stride = 16;
  job.context = &context;
  job.scope = ContactScope::kAll;
  REQUIRE(job.run() == Status::kOk);
  REQUIRE(job.pair_count > 10);
  REQUIRE(job.sphere_contact_count > 1);
  std::vector<TriangleContact> contacts(job.pair_count);
  std::vector<SphereContact> sphere_contacts(job.sphere_contact_count);
  job.contacts = {contacts.data(), contacts.size()};
  job.sphere_contacts = {sphere_contacts.data(), sphere_contacts.size()};
  REQUIRE(job.run() == Status::kOk);

  sc_triangle_contact_job c_job = SC_TRIANGLE_CONTACT_JOB_INIT;
  c_job.asset = both.asset;
  c_job.positions = positions.data();
  c_job.vertex_count = positions.size() / 4;
  c_job.stride = 16;
  c_job.scope = SC_CONTACTS_ALL;
  c_job.scratch = c_words.data();
  c_job.scratch_words = c_words.size();
  std::vector<sc_triangle_pair> c_pairs(job.pair_count);
  std::vector<sc_triangle_contact> c_contacts(job.pair_count);
  std::vector<sc_sphere_contact> c_sphere_contacts(job.sphere_contact_count);
  c_job.pairs = c_pairs.data();
  c_job.pair_capacity = c_pairs.size();
  c_job.contacts = c_contacts.data();
  c_job.contact_capacity = c_contacts.size();
  c_job.sphere_contacts = c_sphere_contacts.data();
  c_job.sphere_contact_capacity = c_sphere_contacts.size();
  REQUIRE(sc_triangle_contacts(&c_job) == SC_OK);
  CHECK(c_job.pair_count == job.pair_count);
  CHECK(c_job.sphere_contact_count == job.sphere_contact_count);
  CHECK(same_bytes(c_contacts, contacts));
  CHECK(same_bytes(c_sphere_contacts, sphere_contacts));
  for (std::size_t i = 0; i < c_pairs.size(); ++i) CHECK(c_pairs[i].b == contacts[i].triangles.b);
  c_job.pair_capacity = 1;
  CHECK(sc_triangle_contacts(&c_job) == SC_OVERFLOW);
  c_job.scope = 256;
  CHECK(sc_triangle_contacts(&c_job) == SC_BAD_ARGUMENT);
  c_job.scratch = nullptr;
  CHECK(sc_triangle_contacts(&c_job) == SC_NULL_ARGUMENT);
  CHECK(sc_triangle_contact_scratch_words(nullptr) == 0);

  std::vector<std::uint64_t> none(sc_filter_ignored_words(both.asset));
  const sc_filter filter{none.data(), none.size(), nullptr, 0, nullptr, 0};
  std::vector<sc_pair> of_skin(job.sphere_contact_count);
  sc_detect_skin_job detect = SC_DETECT_SKIN_JOB_INIT;
  detect.asset = both.asset;
  detect.positions = positions.data();
  detect.vertex_count = positions.size() / 4;
  detect.stride = 16;
  detect.filter = &filter;
  detect.scratch = c_words.data();
  detect.scratch_words = c_words.size();
  detect.pairs = of_skin.data();
  detect.pair_capacity = of_skin.size();
  REQUIRE(sc_detect_skin(&detect) == SC_OK);
  of_skin.resize(detect.pair_count);
  detect.struct_size -= 1;
  CHECK(sc_detect_skin(&detect) == SC_WRONG_ABI);

  std::vector<sc_pair> candidates, expected;
  for (std::uint32_t b = 1; b < asset.spheres().size; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      candidates.push_back({a, b});
      const auto is_it = [&](const SphereContact& contact) { return contact.spheres == Pair{a, b}; };
      if (std::any_of(sphere_contacts.begin(), sphere_contacts.end(), is_it)) expected.push_back({a, b});
    }
  }
  std::vector<sc_pair> confirmed(expected.size());
  sc_confirm_job confirm = SC_CONFIRM_JOB_INIT;
  confirm.asset = both.asset;
  confirm.positions = positions.data();
  confirm.vertex_count = positions.size() / 4;
  confirm.stride = 16;
  confirm.candidates = candidates.data();
  confirm.candidate_count = candidates.size();
  confirm.scratch = c_words.data();
  confirm.scratch_words = c_words.size();
  confirm.pairs = confirmed.data();
  confirm.pair_capacity = confirmed.size();
  REQUIRE(sc_confirm(&confirm) == SC_OK);
  CHECK(confirm.pair_count == expected.size());
  CHECK(same_bytes(confirmed, expected));
  const auto is_less = [](const sc_pair& l, const sc_pair& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; };
  std::sort(expected.begin(), expected.end(), is_less);
  CHECK(same_bytes(of_skin, expected));
  confirm.struct_size -= 1;
  CHECK(sc_confirm(&confirm) == SC_WRONG_ABI);
}

TEST_CASE("C: numbers that no enum has are refused, also those that are a value when cut to a byte") {
  const BothApis both;
  std::vector<sc_sphere> spheres(70);
  sc_refit_bones_job bones = SC_REFIT_BONES_JOB_INIT;
  bones.asset = both.asset;
  bones.bones.data = both.matrices[0].data();
  bones.bones.count = 8;
  bones.spheres = spheres.data();
  bones.sphere_count = 70;
  REQUIRE(sc_refit_bones(&bones) == SC_OK);
  sc_detect_job detect = SC_DETECT_JOB_INIT;
  detect.asset = both.asset;
  detect.spheres = spheres.data();
  detect.sphere_count = 70;
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

TEST_CASE("C: detect gives the C++ API's pairs, bits, chain pairs and counts, and overflows as it does") {
  const BothApis both;
  for (const Method method : {Method::kM1, Method::kM2}) {
    const Detected expected = detect(both.opened.asset, both.spheres, method, RadiusKind::kDetect);
    REQUIRE(expected.pairs.size() > 1);
    std::vector<sc_pair> pairs(expected.pairs.size());
    std::vector<sc_chain_pair> chain_pairs(expected.chain_pairs.size());
    std::vector<std::uint64_t> bits(sc_detect_bit_words(both.asset)), scratch(sc_detect_scratch_words(both.asset));
    sc_detect_job job = SC_DETECT_JOB_INIT;
    job.asset = both.asset;
    job.spheres = both.c_spheres.data();
    job.sphere_count = both.c_spheres.size();
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

TEST_CASE("C: filters are edited as in C++, and jobs heed them") {
  const BothApis both;
  const Asset& view = both.opened.asset;
  std::vector<std::uint64_t> ignored(sc_filter_ignored_words(both.asset)),
      disabled(sc_filter_disabled_words(both.asset));
  std::vector<float> padding(70);
  std::vector<std::uint64_t> expected_ignored(ignored.size()), expected_disabled(disabled.size());
  std::vector<float> expected_padding(70);
  sc_filter filter = {ignored.data(), ignored.size(), disabled.data(), disabled.size(), padding.data(), padding.size()};
  Filter expected{{expected_ignored.data(), ignored.size()},
                  {expected_disabled.data(), disabled.size()},
                  {expected_padding.data(), padding.size()}};
  const auto is_same = [&] {
    return ignored == expected_ignored && disabled == expected_disabled && padding == expected_padding;
  };
  REQUIRE(sc_check_filter(both.asset, &filter) == SC_OK);
  REQUIRE(sc_reset_filter(both.asset, &filter) == SC_OK);
  REQUIRE(reset_filter(view, expected) == Status::kOk);
  CHECK(is_same());
  const std::vector<std::uint64_t> before = ignored;
  CHECK(sc_ignore_hops(both.asset, &filter, 2, 1) == SC_OK);
  CHECK(ignore_hops(view, expected, 2) == Status::kOk);
  CHECK(is_same());
  CHECK(sc_ignore_regions(both.asset, &filter, 0, 1, 0) == SC_OK);
  CHECK(ignore_regions(view, expected, 0, 1, false) == Status::kOk);
  CHECK(is_same());
  CHECK(sc_ignore_pair(both.asset, &filter, 3, 9, 1) == SC_OK);
  CHECK(ignore_pair(view, expected, 3, 9) == Status::kOk);
  CHECK(sc_disable_sphere(both.asset, &filter, 4, 1) == SC_OK);
  CHECK(disable_sphere(view, expected, 4) == Status::kOk);
  CHECK(sc_pad_sphere(both.asset, &filter, 5, 0.25F) == SC_OK);
  CHECK(pad_sphere(view, expected, 5, 0.25F) == Status::kOk);
  CHECK(is_same());
  CHECK(ignored != before);
  CHECK(sc_pad_sphere(both.asset, &filter, 70, 0.25F) == SC_BAD_ARGUMENT);
  CHECK(sc_reset_filter(both.asset, nullptr) == SC_NULL_ARGUMENT);

  const std::vector<Pair> pairs =
      detect(view, both.spheres, Method::kM2, RadiusKind::kDetect, Target::kBest, &expected).pairs;
  REQUIRE(pairs != detect(view, both.spheres, Method::kM2, RadiusKind::kDetect).pairs);
  std::vector<sc_pair> c_pairs(pairs.size());
  sc_detect_job job = SC_DETECT_JOB_INIT;
  job.asset = both.asset;
  job.spheres = both.c_spheres.data();
  job.sphere_count = 70;
  job.filter = &filter;
  job.pairs = c_pairs.data();
  job.pair_capacity = c_pairs.size();
  CHECK(sc_detect(&job) == SC_OK);
  CHECK(same_bytes(c_pairs, pairs));
  filter.ignored_words -= 1;
  CHECK(sc_detect(&job) == SC_BAD_FILTER);

  filter.ignored_words += 1;
  std::vector<Contact> contacts(pairs.size());
  ContactJob expected_job;
  expected_job.asset = &view;
  expected_job.spheres = {both.spheres.data(), both.spheres.size()};
  expected_job.pairs = {pairs.data(), pairs.size()};
  expected_job.filter = &expected;
  expected_job.contacts = {contacts.data(), contacts.size()};
  REQUIRE(expected_job.run() == Status::kOk);
  std::vector<sc_contact> c_contacts(pairs.size());
  sc_contact_job contact = SC_CONTACT_JOB_INIT;
  contact.asset = both.asset;
  contact.spheres = both.c_spheres.data();
  contact.sphere_count = 70;
  contact.pairs = c_pairs.data();
  contact.pair_count = c_pairs.size();
  contact.filter = &filter;
  contact.contacts = c_contacts.data();
  contact.contact_capacity = c_contacts.size();
  CHECK(sc_contacts(&contact) == SC_OK);
  CHECK(same_bytes(c_contacts, contacts));
  CHECK(contact.contact_count == pairs.size());
  CHECK(contact.deepest == expected_job.deepest);
}

TEST_CASE("C: a crowd from bones gives each instance's own pairs, by the caller's scheduler") {
  const BothApis both;
  constexpr std::size_t kInstances = 5;
  std::vector<Matrix> matrices = random_matrices(8 * kInstances, 9);
  std::vector<std::uint64_t> scratch(sc_crowd_scratch_words(both.asset, 3));
  std::vector<std::uint32_t> counts(kInstances);
  std::vector<sc_crowd_pair> pairs(kInstances * 70 * 69 / 2);
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
