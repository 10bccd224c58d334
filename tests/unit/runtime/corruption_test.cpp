// SPDX-License-Identifier: MIT
// Each way an asset can be wrong has its status, and a message that names the field.
#include <doctest/doctest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "sphere_chains_generated.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

struct Corruption {
  std::string message;  // what it must start with
  std::function<void(AssetParts&)> apply;
};

// Opens an asset after each change alone.
void check_each(const AssetParts& valid, const std::vector<Corruption>& corruptions) {
  REQUIRE(OpenedAsset(valid).status == SC_OK);
  for (const Corruption& corruption : corruptions) {
    AssetParts parts = valid;
    corruption.apply(parts);
    const OpenedAsset opened(parts);
    INFO("expected: ", std::string(corruption.message));
    INFO("message:  ", opened.message);
    CHECK(opened.status == SC_CORRUPT);
    CHECK(opened.message.find(corruption.message) == 0);
    CHECK(!is_open(&opened.asset));
  }
}

// A valid asset of 12 spheres, 48 pivots and triangles, 144 vertices, 5 regions.
void check_each(const std::vector<Corruption>& corruptions) { check_each(random_asset(12, 1).parts, corruptions); }

Status open_bytes(const std::vector<std::uint8_t>& bytes, std::size_t size, std::string& message) {
  char buffer[160];
  Asset asset;
  const Status status = sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), size, buffer, sizeof buffer);
  message = buffer;
  return status;
}

}  // namespace

TEST_CASE("no bytes, unaligned bytes and too few bytes are refused") {
  const std::vector<std::uint8_t> bytes = build(random_asset(12, 1).parts);
  std::string message;
  char buffer[160];
  Asset asset;
  const auto open = [&](const std::uint8_t* data, std::size_t size) {
    return sc_asset_open(&asset, SC_ABI_VERSION, data, size, buffer, sizeof buffer);
  };
  CHECK(open(nullptr, 100) == sc_status{SC_NULL, SC_FIELD_DATA});
  CHECK(std::string(buffer) == "data: null");
  for (std::size_t offset = 1; offset < SC_ASSET_ALIGNMENT; ++offset) {
    CHECK(open(bytes.data() + offset, bytes.size() - offset) == sc_status{SC_MISALIGNED, SC_FIELD_DATA});
    CHECK(std::string(buffer) == "data: not aligned to 8 bytes");
  }
  CHECK(sc_asset_open(nullptr, SC_ABI_VERSION, bytes.data(), bytes.size(), buffer, sizeof buffer) ==
        sc_status{SC_NULL, SC_FIELD_ASSET});
  CHECK(open_bytes(bytes, 0, message) == SC_NOT_AN_ASSET);
  CHECK(open_bytes(bytes, 7, message) == SC_NOT_AN_ASSET);
  CHECK(open_bytes(bytes, 63, message) == SC_CORRUPT);
  CHECK(message.find("size: 63 bytes, but an asset has 64 to ") == 0);
  CHECK(open_bytes(bytes, 64, message) == SC_CORRUPT);
  CHECK(message.find("structure: ") == 0);
}

TEST_CASE("another kind of file is refused, also a short one") {
  const std::string text = "solid cube\nfacet normal 0 0 1";
  std::string message;
  CHECK(open_bytes({text.begin(), text.end()}, text.size(), message) == SC_NOT_AN_ASSET);
  CHECK(message == "file identifier: not \"SPHC\", so this is no sphere chain asset");
}

TEST_CASE("an asset of another format version is refused: bake it again") {
  // 0 is not written: an asset without the field has that version.
  for (const std::uint32_t version : {0U, kFormatVersion - 1, kFormatVersion + 1, 0xFFFFFFFFU}) {
    AssetParts parts = random_asset(12, 1).parts;
    parts.format_version = version;
    const OpenedAsset other(parts);
    CHECK(other.status == sc_status{SC_OTHER_VERSION, SC_FIELD_DATA});
    CHECK(other.message ==
          "format_version: " + std::to_string(version) + ", but this runtime reads " + std::to_string(kFormatVersion) +
              " only: " +
              (version < kFormatVersion ? "bake it again" : "update spherechain, or bake it with this version"));
  }
}

TEST_CASE("a size no FlatBuffer can have is refused before anything is read") {
  std::vector<std::uint8_t> bytes = build(random_asset(12, 1).parts);
  std::string message;
  CHECK(open_bytes(bytes, std::numeric_limits<std::size_t>::max(), message) == SC_CORRUPT);
  CHECK(message.find("size: " + std::to_string(std::numeric_limits<std::size_t>::max()) + " bytes") == 0);
}

TEST_CASE("a wrong header, frame or fit is refused") {
  check_each({
      {"refit: 2 is no known rule", [](AssetParts& p) { p.refit = 2; }},
      {"source.metres_per_unit: 0", [](AssetParts& p) { p.metres_per_unit = 0; }},
      {"source.metres_per_unit: inf", [](AssetParts& p) { p.metres_per_unit = kInfinity; }},
      {"frame.height: nan", [](AssetParts& p) { p.height = kNan; }},
      {"frame.height: -1", [](AssetParts& p) { p.height = -1; }},
      {"frame.origin: missing", [](AssetParts& p) { p.without = "frame.origin"; }},
      {"frame.left: missing", [](AssetParts& p) { p.without = "frame.left"; }},
      {"frame.up: missing", [](AssetParts& p) { p.without = "frame.up"; }},
      {"frame.forward: missing", [](AssetParts& p) { p.without = "frame.forward"; }},
      {"frame.origin: not finite", [](AssetParts& p) { p.origin.y = kNan; }},
      {"frame.left: not finite", [](AssetParts& p) { p.left.z = kInfinity; }},
      {"frame: left, up and forward are not", [](AssetParts& p) { p.left.x = 1.01F; }},
      {"frame: left, up and forward are not", [](AssetParts& p) { p.left.x = -1.0F; }},
      {"frame: left, up and forward are not", [](AssetParts& p) { p.up = p.left; }},
      {"frame: left, up and forward are not", [](AssetParts& p) { p.forward.z = 3e38F; }},
      {"fit.phi1: missing", [](AssetParts& p) { p.without = "fit.phi1"; }},
      {"fit.phi1_adjusted: missing", [](AssetParts& p) { p.without = "fit.phi1_adjusted"; }},
      {"fit.phi2: missing", [](AssetParts& p) { p.without = "fit.phi2"; }},
      {"fit.phi2: not finite", [](AssetParts& p) { p.phi2.max_abs_f = kNan; }},
  });
}

TEST_CASE("an index past its array is refused") {
  check_each({
      {"pivots[7].a: 144 is past the 144 vertices", [](AssetParts& p) { p.pivots[7].a = 144; }},
      {"pivots[0].b: 4294967295 is past", [](AssetParts& p) { p.pivots[0].b = 0xFFFFFFFFU; }},
      {"pivots[47].c: 144 is past", [](AssetParts& p) { p.pivots[47].c = 144; }},
      {"spheres[11].first_pivot: 45 and 4 on is past the 48 pivots",
       [](AssetParts& p) { p.spheres[11].first_pivot = 45; }},
      {"spheres[2].first_pivot: 4294967295", [](AssetParts& p) { p.spheres[2].first_pivot = 0xFFFFFFFFU; }},
      {"spheres[11].first_pivot: 44 and 5 on", [](AssetParts& p) { p.spheres[11].pivot_count = 5; }},
      {"spheres[0].region: 5 is past the 5 regions", [](AssetParts& p) { p.spheres[0].region = 5; }},
      {"chains[1].regions[0]: 5 is past the 5 regions", [](AssetParts& p) { p.chains[1].regions[0] = 5; }},
      {"chains[3].spheres[2]: 12 is past the 12 spheres", [](AssetParts& p) { p.chains[3].spheres[2] = 12; }},
      {"chains[0].spheres[0]: 4294967295 is past", [](AssetParts& p) { p.chains[0].spheres[0] = 0xFFFFFFFFU; }},
      {"rest_pairs_fit[0].b: 12 is past the 12 spheres", [](AssetParts& p) { p.rest_fit[0].b = 12; }},
      {"rest_pairs_detect[0].b: 12 is past", [](AssetParts& p) { p.rest_detect[0].b = 12; }},
      {"source.buffers[1].first_vertex: 5 and 140 on is past the 144 vertices",
       [](AssetParts& p) { p.buffers[1].first_vertex = 5; }},
      {"source.buffers[0].first_vertex: 4294967295 and 4 on",
       [](AssetParts& p) { p.buffers[0].first_vertex = 0xFFFFFFFFU; }},
      {"joints[0].parent: 0 is not", [](AssetParts& p) { p.joints[0].parent = 0; }},
      {"joints[1].parent: 2 is not -1 or a joint before it", [](AssetParts& p) { p.joints[1].parent = 2; }},
      {"joints[2].parent: -2 is not", [](AssetParts& p) { p.joints[2].parent = -2; }},
  });
}

TEST_CASE("a figure that makes no sense is refused") {
  check_each({
      {"pivots[5].weight: not finite", [](AssetParts& p) { p.pivots[5].weight = kNan; }},
      {"spheres[3].center: not finite", [](AssetParts& p) { p.spheres[3].center.z = kInfinity; }},
      {"spheres[3].radius: not", [](AssetParts& p) { p.spheres[3].radius = 0; }},
      {"spheres[3].radius: not", [](AssetParts& p) { p.spheres[3].radius = kNan; }},
      {"spheres[3].detect_radius: not", [](AssetParts& p) { p.spheres[3].detect_radius = -0.5F; }},
      {"spheres[3].detect_radius: not", [](AssetParts& p) { p.spheres[3].detect_radius = kInfinity; }},
      {"spheres[3].pivot_spread: not", [](AssetParts& p) { p.spheres[3].pivot_spread = 0; }},
      {"spheres[3].pivot_spread: not", [](AssetParts& p) { p.spheres[3].pivot_spread = kNan; }},
      {"spheres[3].pivot_count: 0", [](AssetParts& p) { p.spheres[3].pivot_count = 0; }},
      {"spheres[3].side: no known side", [](AssetParts& p) { p.spheres[3].side = 3; }},
      {"spheres[3].level: below -1", [](AssetParts& p) { p.spheres[3].level = -2; }},
      {"spheres[3].reserved: not 0", [](AssetParts& p) { p.spheres[3].reserved = 1; }},
      {"spheres[3].part: past the body parts", [](AssetParts& p) { p.spheres[3].part = 5; }},
      {"rest_pairs_fit[0]: a is not below b", [](AssetParts& p) { p.rest_fit[0].a = p.rest_fit[0].b; }},
      {"rest_pairs_fit[1]: scale is not in [0, 1)", [](AssetParts& p) { p.rest_fit[1].rest_scale = 1; }},
      {"rest_pairs_fit[1]: scale is not in [0, 1)", [](AssetParts& p) { p.rest_fit[1].rest_scale = -0.25F; }},
      {"rest_pairs_detect[1]: scale is not in [0, 1)", [](AssetParts& p) { p.rest_detect[1].rest_scale = kNan; }},
      {"rest_pairs_detect[2]: not sorted, or there twice", [](AssetParts& p) { p.rest_detect[2] = p.rest_detect[1]; }},
      {"rest_pairs_fit[1]: not sorted", [](AssetParts& p) { std::swap(p.rest_fit[0], p.rest_fit[1]); }},
      {"joints[0].position: missing", [](AssetParts& p) { p.without = "joints.position"; }},
      {"joints[0].tail: missing", [](AssetParts& p) { p.without = "joints.tail"; }},
      {"joints[2].tail: not finite", [](AssetParts& p) { p.joints[2].tail.x = kNan; }},
  });
}

TEST_CASE("a figure out of all proportion to the body is refused, and one just within its limit is not") {
  TinyAsset tiny = random_asset(12, 1);
  const TinySkin skin = add_bones(tiny, 5, 2);
  add_skin(tiny, &skin, 4);
  tiny.parts.skin.positions[0] = -4;  // how far the skin reaches from the frame's origin
  for (RestSphere& sphere : tiny.parts.spheres) sphere.pivot_spread = 0.25F;
  for (Moment& moment : tiny.parts.moments.moments) moment = {};
  constexpr double kFar = 256 * 1.75;
  const double size = static_cast<double>(build(tiny.parts).size());
  struct Limit {
    const char* message;
    double most;
    void (*set)(AssetParts& parts, float value);
  };
  using P = AssetParts;
  const Limit limits[] = {
      {"source.metres_per_unit", 1e12, [](P& p, float v) { p.metres_per_unit = v; }},
      {"source.metres_per_unit", 1e12, [](P& p, float v) { p.metres_per_unit = 1 / v; }},
      {"source.triangle_count", 65536 + size, [](P& p, float v) { p.triangle_count = static_cast<std::uint32_t>(v); }},
      {"frame.height", 64 * 4, [](P& p, float v) { p.height = v; }},
      {"skin.positions[2]", kFar, [](P& p, float v) { p.skin.positions[6] = v; }},
      {"spheres[3].center", kFar, [](P& p, float v) { p.spheres[3].center.z = v; }},
      {"spheres[3].radius", kFar, [](P& p, float v) { p.spheres[3].pivot_spread = v; }},
      {"spheres[3].radius", kFar, [](P& p, float v) { p.spheres[3].radius = p.spheres[3].detect_radius = v; }},
      {"spheres[3].detect_radius", 4096, [](P& p, float v) { p.spheres[3].radius = p.spheres[3].detect_radius / v; }},
      {"spheres[3].pivot_spread", 4096,
       [](P& p, float v) { p.spheres[3].pivot_spread = p.spheres[3].detect_radius / v; }},
      {"pivots[5].weight", 16, [](P& p, float v) { p.pivots[5].weight = -v; }},
      {"joints[1].position", kFar, [](P& p, float v) { p.joints[1].position.x = v; }},
      {"joints[1].position", kFar, [](P& p, float v) { p.joints[1].tail.x = v; }},
      {"bones[1].inverse_bind", 1e6, [](P& p, float v) { p.bones[1].inverse_bind[10] = v; }},
      {"bones[1].inverse_bind", 1e6 * (kFar + 0.25), [](P& p, float v) { p.bones[1].inverse_bind[11] = v; }},
      {"moments.origin", kFar, [](P& p, float v) { p.moments.origin.x = v; }},
      {"moments.centers[2]", 16, [](P& p, float v) { p.moments.centers[2].w = v; }},
      {"moments.centers[2]", 16 * 8, [](P& p, float v) { p.moments.centers[2].y = v; }},
      {"moments.moments[4]", 16 * 32 * 32, [](P& p, float v) { p.moments.moments[4].values[0] = v; }},
      {"moments.moments[4]", 16 * 32 * 4, [](P& p, float v) { p.moments.moments[4].values[3] = v; }},
      {"moments.moments[4]", 16 * 4 * 4, [](P& p, float v) { p.moments.moments[4].values[15] = v; }},
      {"skin.morphs[1].delta", kFar, [](P& p, float v) { p.skin.morphs[1].delta.y = v; }},
      {"skin.boxes[1]", kFar, [](P& p, float v) { p.skin.boxes[1].x[3] = v; }},
      {"skin.boxes[1]", kFar, [](P& p, float v) { p.skin.boxes[1].radius[3] = v; }},
      {"skin.boxes[1]", kFar, [](P& p, float v) { p.skin.boxes[1].half_x[0] = v; }},
      {"skin.boxes[1]", kFar, [](P& p, float v) { p.skin.boxes[1].half_y[1] = v; }},
      {"skin.boxes[1]", kFar, [](P& p, float v) { p.skin.boxes[1].half_z[2] = v; }},
      {"skin.bounds_morphs[1]", kFar, [](P& p, float v) { p.skin.bounds_morphs[1].radius[2] = v; }},
      {"skin.bounds_terms[1]", 2, [](P& p, float v) { p.skin.bounds_terms[1].weights[2] = v; }},
      {"skin.bounds_terms[1]", 2, [](P& p, float v) { p.skin.bounds_terms[1].deviations[2] = v; }},
      {"skin.hulls[3]", kFar, [](P& p, float v) { p.skin.hulls[3].center.x = v; }},
      {"skin.hulls[3]", kFar, [](P& p, float v) { p.skin.hulls[3].radius = v; }},
      {"skin.hulls[3]", kFar, [](P& p, float v) { p.skin.hulls[3].slack = v; }},
      {"skin.hull_bones[4]", kFar, [](P& p, float v) { p.skin.hull_bones[4].x = v; }},
      {"skin.hull_bones[4]", 2, [](P& p, float v) { p.skin.hull_bones[4].w = v; }},
  };
  std::vector<Corruption> corruptions;
  for (const Limit& limit : limits) {
    AssetParts within = tiny.parts;
    limit.set(within, static_cast<float>(0.999 * limit.most));
    CHECK(OpenedAsset(within).message == "");
    corruptions.push_back({limit.message, [&](P& p) { limit.set(p, static_cast<float>(1.001 * limit.most)); }});
  }
  check_each(tiny.parts, corruptions);
}

TEST_CASE("an array of the wrong length is refused") {
  check_each({
      {"spheres: 0 of them, not 1 to 65535", [](AssetParts& p) { p.spheres.clear(); }},
      {"spheres: 65536 of them", [](AssetParts& p) { p.spheres.resize(65536, p.spheres[0]); }},
      {"parts: 0 of them, not 1 to 255", [](AssetParts& p) { p.parts.clear(); }},
      {"parts: 256 of them", [](AssetParts& p) { p.parts.resize(256, {"x"}); }},
      {"parts[1]: no known side", [](AssetParts& p) { p.parts[1].side = 3; }},
      {"parts[1]: no known side, or a bone past the 0", [](AssetParts& p) { p.parts[1].bone = 0; }},
      {"parts[1]: no known side, or a bone", [](AssetParts& p) { p.parts[1].bone = -2; }},
      {"ignored: 3 words, not the 2 that 12 spheres need", [](AssetParts& p) { p.ignored.push_back(0); }},
      {"ignored: 1 words", [](AssetParts& p) { p.ignored.pop_back(); }},
      {"ignored: a spare bit is not 0", [](AssetParts& p) { p.ignored[1] |= std::uint64_t{1} << 2; }},
      {"ignored: a spare bit is not 0", [](AssetParts& p) { p.ignored[1] |= std::uint64_t{1} << 63; }},
  });
}

TEST_CASE("arrays that overlap to make a small file ask for much work are refused") {
  check_each({
      {"spheres: their pivot_count add up to 49, past the 48 pivots",
       [](AssetParts& p) { p.spheres[0].pivot_count = 5; }},
      {"chains[1].spheres[1]: ", [](AssetParts& p) { p.chains[1].spheres[1] = p.chains[1].spheres[0]; }},
  });
  // Chains that all point at one list: at full size 2 MB would ask for 10^9 steps of open().
  AssetParts parts = random_asset(1, 1).parts;
  parts.spheres.resize(40, parts.spheres[0]);
  parts.ignored.assign((40 * 39 / 2 + 63) / 64, 0);
  for (std::uint32_t i = 1; i < 40; ++i) {
    parts.spheres[i].first_pivot = 4 * i;
    parts.spheres[i].triangle_count = 0;
    parts.pivots.insert(parts.pivots.end(), parts.pivots.begin(), parts.pivots.begin() + 4);
  }
  parts.chains.assign(200, {"z", {0}, {}});
  for (std::uint32_t i = 0; i < 40; ++i) {
    parts.chains[0].spheres.push_back(i);
  }
  REQUIRE(OpenedAsset(parts).status == SC_OK);
  parts.chains_share_array = true;
  const OpenedAsset opened(parts);
  CHECK(opened.status == SC_CORRUPT);
  CHECK(opened.message.find("list more than the file has bytes for") != std::string::npos);
}

TEST_CASE("bones that are not sound are refused") {
  TinyAsset tiny = random_asset(12, 1);
  add_bones(tiny, 5, 3);
  check_each(tiny.parts,
             {
                 {"bones[0].inverse_bind: missing", [](AssetParts& p) { p.without = "inverse_bind"; }},
                 {"bones[1].inverse_bind: not finite", [](AssetParts& p) { p.bones[1].inverse_bind[11] = kNan; }},
                 {"bones[1].is_rest: not the last", [](AssetParts& p) { p.bones[1].is_rest = true; }},
                 {"parts[2]: no known side, or a bone past the 5", [](AssetParts& p) { p.parts[2].bone = 5; }},
                 {"moments: refit is another, or no bones", [](AssetParts& p) { p.refit = 0; }},
                 {"moments: refit is another, or no bones",
                  [](AssetParts& p) {
                    p.bones.clear();
                    for (PartEntry& part : p.parts) part.bone = -1;
                  }},
             });
}

TEST_CASE("tables for refit by moments that are not sound are refused") {
  TinyAsset tiny = random_asset(12, 1);
  const TinySkin skin = add_bones(tiny, 5, 3);
  add_moments(tiny, skin, 14);
  using Moments = MomentParts;
  const Moments& m = tiny.parts.moments;
  // Several batches, several pairs in the first, several bones in the first sphere.
  REQUIRE(m.batches.size() >= 2);
  REQUIRE(m.batches[0].pair_count >= 3);
  REQUIRE(m.bone_counts[0] >= 2);
  const auto count = [](const auto& list) { return std::to_string(list.size()); };
  const std::string in_first = std::to_string(m.batches[0].pair_count);

  const auto change = [](auto apply) { return [apply](AssetParts& p) { apply(p.moments); }; };
  const std::vector<std::pair<std::string, std::function<void(AssetParts&)>>> changes{
      {": missing, but refit is moments", change([](Moments& t) { t = {}; })},
      {".origin: missing", [](AssetParts& p) { p.without = "moments.origin"; }},
      {".origin: not finite", change([](Moments& t) { t.origin.x = kNan; })},
      {".origin: not finite", change([](Moments& t) { t.origin.y = kInfinity; })},
      {".origin: not finite", change([](Moments& t) { t.origin.z = kNan; })},
      {".reference: 5 is past the 5 bones", change([](Moments& t) { t.reference = 5; })},
      {".reference: 4294967295 is", change([](Moments& t) { t.reference = 0xFFFFFFFFU; })},
      {".batches[1].pair_count: 0 is not 1 to 256", change([](Moments& t) { t.batches[1].pair_count = 0; })},
      {".batches[1].pair_count: 257 is not 1 to 256", change([](Moments& t) { t.batches[1].pair_count = 257; })},
      {".batches[1].sphere_count: 0", change([](Moments& t) { t.batches[1].sphere_count = 0; })},
      {".pairs: " + count(m.pairs) + " of them, but " + std::to_string(m.pairs.size() + 1) + " in the batches",
       change([](Moments& t) { t.batches[1].pair_count += 1; })},
      {".pairs: ", change([](Moments& t) { t.pairs.pop_back(); })},
      {".pairs: ", change([](Moments& t) { t.pairs.emplace_back(); })},
      {".spheres: 12 of them, but 13 in the batches", change([](Moments& t) { t.batches[1].sphere_count += 1; })},
      {".spheres: 12 of them, but ", change([](Moments& t) { t.batches[1].sphere_count = 0xFFFFFFFFU; })},
      {".spheres: 11 of them, but 12 in the asset", change([](Moments& t) { t.spheres.pop_back(); })},
      {".spheres: 13 of them, but 12 in the asset", change([](Moments& t) {
         t.spheres.push_back(0);
         t.batches[1].sphere_count += 1;
       })},
      {".pairs[1].b: 5 is past the 5 bones", change([](Moments& t) { t.pairs[1].b = 5; })},
      {".pairs[1]: a is above b", change([](Moments& t) {
         t.pairs[1] = {3, 2};
       })},
      {".pairs[1]: not sorted, or there twice", change([](Moments& t) { t.pairs[1] = t.pairs[0]; })},
      {".pairs[1]: not sorted, or there twice",
       change([](Moments& t) { std::swap(t.pairs[0], t.pairs[t.batches[0].pair_count - 1]); })},
      {".pairs[2]: not sorted, or there twice", change([](Moments& t) { std::swap(t.pairs[1], t.pairs[2]); })},
      {".spheres[3]: 12 is past the 12 spheres", change([](Moments& t) { t.spheres[3] = 12; })},
      {".spheres[3]: 4294967295 is past", change([](Moments& t) { t.spheres[3] = 0xFFFFFFFFU; })},
      {".spheres[3]: " + std::to_string(m.spheres[1]) + " is there already",
       change([](Moments& t) { t.spheres[3] = t.spheres[1]; })},
      {".bone_counts: 11 of them, but 12 spheres", change([](Moments& t) { t.bone_counts.pop_back(); })},
      {".bone_counts: 13 of them", change([](Moments& t) { t.bone_counts.push_back(1); })},
      {".bone_counts[2]: 0 is not 1 to 22", change([](Moments& t) { t.bone_counts[2] = 0; })},
      {".bone_counts[2]: 23 is not 1 to 22", change([](Moments& t) { t.bone_counts[2] = 23; })},
      {".bones: " + count(m.bones) + " of them, but ", change([](Moments& t) { t.bone_counts[2] += 1; })},
      {".bones: ", change([](Moments& t) { t.bones.pop_back(); })},
      {".centers: ", change([](Moments& t) { t.centers.pop_back(); })},
      {".centers: ", change([](Moments& t) { t.centers.push_back({}); })},
      {".pair_places: ", change([](Moments& t) { t.pair_places.pop_back(); })},
      {".pair_places: ", change([](Moments& t) { t.pair_places.push_back(0); })},
      {".moments: ", change([](Moments& t) { t.moments.pop_back(); })},
      {".moments: ", change([](Moments& t) { t.moments.push_back({}); })},
      {".bones[0]: 5 is past the 5 bones", change([](Moments& t) { t.bones[0] = 5; })},
      {".bones[1]: not above the one before it", change([](Moments& t) { t.bones[1] = t.bones[0]; })},
      {".bones[1]: not above the one before it", change([](Moments& t) { std::swap(t.bones[0], t.bones[1]); })},
      {".pair_places[1]: " + in_first + " is past the " + in_first + " pairs of its batch",
       change([](Moments& t) { t.pair_places[1] = static_cast<std::uint8_t>(t.batches[0].pair_count); })},
      {".pair_places[1]: not the place of bones ", change([](Moments& t) { t.pair_places[1] = t.pair_places[0]; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].x = kNan; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].y = kInfinity; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].z = kNan; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].w = kNan; })},
      {".moments[4]: not finite", change([](Moments& t) { t.moments[4].values[0] = kNan; })},
      {".moments[4]: not finite", change([](Moments& t) { t.moments[4].values[15] = kInfinity; })},
      {".moments[0]: a bone's own, but not 0 below", change([](Moments& t) { t.moments[0].values[4] = 1; })},
  };
  std::vector<Corruption> corruptions;
  for (const auto& [message, apply] : changes) {
    corruptions.push_back({"moments" + message, apply});
  }
  check_each(tiny.parts, corruptions);
}

TEST_CASE("an array of 64-bit words off its alignment is refused") {
  // FlatBuffers' verifier looks at the alignment of the array's length only. Move each array to the end of the file.
  const AssetParts parts = random_asset(12, 1).parts;
  const std::vector<std::uint8_t> bytes = build(parts);
  const auto check = [&](const void* table, flatbuffers::voffset_t field_of, std::size_t count, std::size_t word,
                         const char* expected) {
    const auto* address = static_cast<const flatbuffers::Table*>(table)->GetAddressOf(field_of);
    const auto field = static_cast<std::size_t>(address - bytes.data());
    std::uint32_t from = 0;
    std::memcpy(&from, &bytes[field], 4);
    for (const std::size_t misalignment : {0U, 4U}) {
      std::vector<std::uint8_t> moved = bytes;
      moved.resize((moved.size() + 7) / 8 * 8 + 4 + misalignment);  // the words start 4 bytes after the length
      const std::size_t array = moved.size();
      moved.resize(array + 4 + word * count + 8);
      const auto offset = static_cast<std::uint32_t>(array - field);
      std::memcpy(&moved[array], &bytes[field + from], 4 + word * count);
      std::memcpy(&moved[field], &offset, 4);
      std::string message;
      const Status status = open_bytes(moved, moved.size(), message);
      CHECK(status == (misalignment == 0 ? SC_OK : SC_CORRUPT));
      CHECK(message == (misalignment == 0 ? "" : expected));
    }
  };
  const schema::Asset* root = schema::GetAsset(bytes.data());
  check(root, schema::Asset::VT_IGNORED, parts.ignored.size(), 8, "ignored: not aligned to 8 bytes");
  check(root->source(), schema::Source::VT_BUFFERS, parts.buffers.size(), sizeof(sc_source_buffer),
        "source.buffers: not aligned to 8 bytes");
}

}  // namespace spherechain::test
