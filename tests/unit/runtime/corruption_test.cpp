// SPDX-License-Identifier: MIT
// Each way an asset can be wrong has its status, and a message that names the field.
#include <doctest/doctest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <string>

#include "sphere_chains_generated.h"
#include "tiny_moments.h"

namespace spherechain::test {
namespace {

struct Corruption {
  std::string message;  // what it must start with
  std::function<void(AssetParts&)> apply;
};

// Opens an asset after each change alone.
void check_each(const AssetParts& valid, const std::vector<Corruption>& corruptions) {
  REQUIRE(OpenedAsset(valid).status == Status::kOk);
  for (const Corruption& corruption : corruptions) {
    AssetParts parts = valid;
    corruption.apply(parts);
    const OpenedAsset opened(parts);
    INFO("expected: ", corruption.message);
    INFO("message:  ", opened.message);
    CHECK(opened.status == Status::kCorrupt);
    CHECK(opened.message.find(corruption.message) == 0);
    CHECK(!opened.asset.is_open());
  }
}

// A valid asset of 12 spheres, 48 pivots and triangles, 144 vertices, 5 regions.
void check_each(const std::vector<Corruption>& corruptions) { check_each(random_asset(12, 1).parts, corruptions); }

Status open_bytes(const std::vector<std::uint8_t>& bytes, std::size_t size, std::string& message) {
  char buffer[160];
  const Status status = Asset().open(bytes.data(), size, buffer, sizeof buffer);
  message = buffer;
  return status;
}

}  // namespace

TEST_CASE("no bytes, unaligned bytes and too few bytes are refused") {
  const std::vector<std::uint8_t> bytes = build(random_asset(12, 1).parts);
  std::string message;
  char buffer[160];
  CHECK(Asset().open(nullptr, 100, buffer, sizeof buffer) == Status::kNullArgument);
  CHECK(std::string(buffer) == "data: null");
  for (std::size_t offset = 1; offset < kAssetAlignment; ++offset) {
    CHECK(Asset().open(bytes.data() + offset, bytes.size() - offset, buffer, sizeof buffer) == Status::kMisaligned);
    CHECK(std::string(buffer) == "data: not aligned to 8 bytes");
  }
  CHECK(open_bytes(bytes, 0, message) == Status::kTruncated);
  CHECK(open_bytes(bytes, 67, message) == Status::kTruncated);
  CHECK(message == "size: 67 bytes, but any asset has at least 68");
  CHECK(open_bytes(bytes, 68, message) == Status::kCorrupt);
  CHECK(message.find("structure: ") == 0);
}

TEST_CASE("another kind of file is refused, also a short one") {
  const std::string text = "solid cube\nfacet normal 0 0 1";
  std::string message;
  CHECK(open_bytes({text.begin(), text.end()}, text.size(), message) == Status::kWrongIdentifier);
  CHECK(message == "file identifier: not \"SPHC\"");
}

TEST_CASE("a format that is newer or was never released is refused") {
  AssetParts parts = random_asset(12, 1).parts;
  parts.format_version = kFormatVersion + 1;
  const OpenedAsset newer(parts);
  CHECK(newer.status == Status::kUnsupportedVersion);
  CHECK(newer.message == "format_version: 2, but this runtime reads 1 to 1");
  parts.format_version = 0;
  CHECK(OpenedAsset(parts).status == Status::kUnsupportedVersion);
}

TEST_CASE("a size no FlatBuffer can have is refused before anything is read") {
  std::vector<std::uint8_t> bytes = build(random_asset(12, 1).parts);
  std::string message;
  CHECK(open_bytes(bytes, std::numeric_limits<std::size_t>::max(), message) == Status::kCorrupt);
  CHECK(message.find("size: 18446744073709551615 bytes") == 0);
}

TEST_CASE("a wrong header, frame or fit is refused") {
  check_each({
      {"refit: 3 is no known rule", [](AssetParts& p) { p.refit = 3; }},
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
      {"frame: left, up and forward are not",
       [](AssetParts& p) {
         p.forward = {0, 0, 3e38F};
       }},
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
      {"triangles[3]: 48 is past the 48 triangles", [](AssetParts& p) { p.triangles[3] = 48; }},
      {"spheres[11].first_pivot: 45 and 4 on is past the 48 pivots",
       [](AssetParts& p) { p.spheres[11].first_pivot = 45; }},
      {"spheres[2].first_pivot: 4294967295", [](AssetParts& p) { p.spheres[2].first_pivot = 0xFFFFFFFFU; }},
      {"spheres[11].first_pivot: 44 and 5 on", [](AssetParts& p) { p.spheres[11].pivot_count = 5; }},
      {"spheres[11].first_triangle: 45 and 4 on", [](AssetParts& p) { p.spheres[11].first_triangle = 45; }},
      {"spheres[2].first_triangle: 4294967293 and 4 on is past the 48 triangles",
       [](AssetParts& p) { p.spheres[2].first_triangle = 0xFFFFFFFDU; }},
      {"spheres[1].first_triangle: 4 and 4294967295 on",
       [](AssetParts& p) { p.spheres[1].triangle_count = 0xFFFFFFFFU; }},
      {"spheres[0].region: 5 is past the 5 regions", [](AssetParts& p) { p.spheres[0].region = 5; }},
      {"chains[1].regions[0]: 5 is past the 5 regions", [](AssetParts& p) { p.chains[1].regions[0] = 5; }},
      {"chains[3].spheres[2]: 12 is past the 12 spheres", [](AssetParts& p) { p.chains[3].spheres[2] = 12; }},
      {"chains[0].spheres[0]: 4294967295 is past", [](AssetParts& p) { p.chains[0].spheres[0] = 0xFFFFFFFFU; }},
      {"near_fit[0].b: 12 is past the 12 spheres", [](AssetParts& p) { p.near_fit[0].b = 12; }},
      {"near_detect[0].b: 12 is past", [](AssetParts& p) { p.near_detect[0].b = 12; }},
      {"source.parts[1].first_vertex: 5 and 140 on is past the 144 vertices",
       [](AssetParts& p) { p.source_parts[1].first_vertex = 5; }},
      {"source.parts[0].first_vertex: 4294967295 and 4 on",
       [](AssetParts& p) { p.source_parts[0].first_vertex = 0xFFFFFFFFU; }},
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
      {"spheres[3].side: no known side", [](AssetParts& p) { p.spheres[3].side = static_cast<Side>(3); }},
      {"spheres[3].level: below -1", [](AssetParts& p) { p.spheres[3].level = -2; }},
      {"spheres[3].reserved: not 0", [](AssetParts& p) { p.spheres[3].reserved = 1; }},
      {"near_fit[0]: a is not below b", [](AssetParts& p) { p.near_fit[0].a = p.near_fit[0].b; }},
      {"near_fit[1]: reach is not in [0, 1)", [](AssetParts& p) { p.near_fit[1].reach = 1; }},
      {"near_fit[1]: reach is not in [0, 1)", [](AssetParts& p) { p.near_fit[1].reach = -0.25F; }},
      {"near_detect[1]: reach is not in [0, 1)", [](AssetParts& p) { p.near_detect[1].reach = kNan; }},
      {"near_detect[2]: not sorted, or there twice", [](AssetParts& p) { p.near_detect[2] = p.near_detect[1]; }},
      {"near_fit[1]: not sorted", [](AssetParts& p) { std::swap(p.near_fit[0], p.near_fit[1]); }},
      {"joints[0].position: missing", [](AssetParts& p) { p.without = "joints.position"; }},
      {"joints[0].tail: missing", [](AssetParts& p) { p.without = "joints.tail"; }},
      {"joints[2].tail: not finite", [](AssetParts& p) { p.joints[2].tail.x = kNan; }},
  });
}

TEST_CASE("an array of the wrong length is refused") {
  check_each({
      {"spheres: 0 of them, not 1 to 65535", [](AssetParts& p) { p.spheres.clear(); }},
      {"spheres: 65536 of them", [](AssetParts& p) { p.spheres.resize(65536, p.spheres[0]); }},
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
      {"spheres: their triangle_count add up to 52, past the 48 triangles",
       [](AssetParts& p) { p.spheres[0].triangle_count = 8; }},
      {"chains[1].spheres[1]: ", [](AssetParts& p) { p.chains[1].spheres[1] = p.chains[1].spheres[0]; }},
  });
  // Chains that all point at one list: at full size 2 MB would ask for 10^9 steps of open() and more of M1.
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
  REQUIRE(OpenedAsset(parts).status == Status::kOk);
  parts.chains_share_array = true;
  const OpenedAsset opened(parts);
  CHECK(opened.status == Status::kCorrupt);
  CHECK(opened.message.find("list more than the file has bytes for") != std::string::npos);
}

TEST_CASE("tables for refit from bones and from packed pivots that are not sound are refused") {
  TinyAsset tiny = random_asset(12, 1);
  give_pivots(tiny, 3, 11, 2);
  add_bones(tiny, 5, 3);  // 13 groups: sphere 3 has two, the second with three pivots
  using Parts = AssetParts;
  check_each(tiny.parts,
             {
                 {"pivot_vertices[0]: 144 is past the 144", [](Parts& p) { p.pivot_vertices[0] = 144; }},
                 {"pivot_vertices[5]: not above", [](Parts& p) { p.pivot_vertices[5] = p.pivot_vertices[4]; }},
                 {"pivot_vertices: missing", [](Parts& p) { p.without = "pivot_vertices"; }},
                 {"pivot_vertices: missing", [](Parts& p) { p.without = "packed_pivots"; }},
                 {"packed_pivots: 58 of them, but 59", [](Parts& p) { p.packed_pivots.pop_back(); }},
                 {"packed_pivots[7]: not the pivot", [](Parts& p) { p.packed_pivots[7].a += 1; }},
                 {"packed_pivots[7]: not the pivot", [](Parts& p) { p.packed_pivots[7].b = 0xFFFFFFFFU; }},
                 {"packed_pivots[7]: not the pivot", [](Parts& p) { p.packed_pivots[7].c = 144; }},
                 {"packed_pivots[7]: not the pivot", [](Parts& p) { p.packed_pivots[7].weight += 0.5F; }},
                 {"packed_pivots[7]: not the pivot", [](Parts& p) { p.packed_pivots[7].weight = kNan; }},
             });
  using Refit = BoneRefitParts;
  const auto refit = [](auto change) { return [change](Parts& p) { change(p.bone_refit); }; };
  check_each(
      tiny.parts,
      {
          {"bone_refit.bones: none", refit([](Refit& r) { r.bones.clear(); })},
          {"bone_refit.bones[0].inverse_bind: missing", [](Parts& p) { p.without = "inverse_bind"; }},
          {"bone_refit.bones[1].inverse_bind: not finite", refit([](Refit& r) { r.bones[1].inverse_bind[11] = kNan; })},
          {"bone_refit.bones[1].is_rest: not the last", refit([](Refit& r) { r.bones[1].is_rest = true; })},
          {"bone_refit.weights: 12 of them, but 13 groups", refit([](Refit& r) { r.weights.pop_back(); })},
          {"bone_refit.weights: 14 of them, but 13 groups", refit([](Refit& r) { r.weights.emplace_back(); })},
          {"bone_refit.term_counts: 12 of them", refit([](Refit& r) { r.term_counts.pop_back(); })},
          {"bone_refit.weights[2]: not those", refit([](Refit& r) { r.weights[2].values[3] += 0.5F; })},
          {"bone_refit.weights[2]: not those", refit([](Refit& r) { r.weights[2].values[4] = 0.5F; })},
          {"bone_refit.weights[2]: not those", refit([](Refit& r) { r.weights[2].values[0] = kNan; })},
          {"bone_refit.weights[4]: not those", refit([](Refit& r) { r.weights[4].values[3] = 0.5F; })},
          {"bone_refit.term_counts[2]: below 1", refit([](Refit& r) { r.term_counts[2] = 0; })},
          {"bone_refit.term_counts: they add up", refit([](Refit& r) { r.term_counts[2] += 1; })},
          {"bone_refit.term_counts: they add up", refit([](Refit& r) { r.term_counts[2] = 0xFFFFFFFFU; })},
          {"bone_refit.term_bones: ", refit([](Refit& r) { r.term_bones.pop_back(); })},
          {"bone_refit.term_bones: ", refit([](Refit& r) { r.terms.pop_back(); })},
          {"bone_refit.term_bones[0]: 5 is past the 5", refit([](Refit& r) { r.term_bones[0] = 5; })},
          {"bone_refit.term_bones[1]: not above", refit([](Refit& r) { r.term_bones[1] = r.term_bones[0]; })},
          {"bone_refit.terms[2]: not finite", refit([](Refit& r) { r.terms[2].x[0] = kNan; })},
          {"bone_refit.terms[2]: not finite", refit([](Refit& r) { r.terms[2].y[3] = kInfinity; })},
          {"bone_refit.terms[2]: not finite, or a spare", refit([](Refit& r) { r.terms[2].z[4] = 1; })},
          {"bone_refit.terms[2]: not finite, or a spare", refit([](Refit& r) { r.terms[2].w[7] = kNan; })},
          {"bone_refit.morph_term_counts: ", refit([](Refit& r) { r.morph_term_counts.pop_back(); })},
          {"bone_refit.morph_term_counts: they add up", refit([](Refit& r) { r.morph_term_counts[1] += 1; })},
          {"bone_refit.morph_targets: ", refit([](Refit& r) { r.morph_targets.pop_back(); })},
          {"bone_refit.morph_targets[0]: 3 is past the 3", refit([](Refit& r) { r.morph_targets[0] = 3; })},
          {"bone_refit.morph_targets[1]: not above", refit([](Refit& r) { r.morph_targets[1] = r.morph_targets[0]; })},
          {"bone_refit.morph_terms[1]: not finite", refit([](Refit& r) { r.morph_terms[1].x[1] = kNan; })},
          {"bone_refit.morph_terms[1]: not finite, or a spare", refit([](Refit& r) { r.morph_terms[1].y[5] = 1; })},
          {"bone_refit.morph_terms[1]: not finite", refit([](Refit& r) { r.morph_terms[1].z[2] = kInfinity; })},
      });
}

TEST_CASE("tables for refit by moments that are not sound are refused") {
  TinyAsset tiny = random_asset(12, 1);
  TinySkin skin = add_bones(tiny, 5, 3);
  add_moments(tiny, skin, 14);
  using Moments = MomentParts;
  const Moments& m = tiny.parts.bone_refit.moments;
  // Several batches, several pairs in the first, several bones in the first sphere.
  REQUIRE(m.batches.size() >= 2);
  REQUIRE(m.batches[0].pair_count >= 3);
  REQUIRE(m.bone_counts[0] >= 2);
  const auto count = [](const auto& list) { return std::to_string(list.size()); };
  const std::string in_first = std::to_string(m.batches[0].pair_count);

  const auto change = [](auto apply) { return [apply](AssetParts& p) { apply(p.bone_refit.moments); }; };
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
      {".pairs: ", change([](Moments& t) {
         t.pairs.push_back({4, 4});
       })},
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
      {".pair_places[1]: " + in_first + " is past its batch's " + in_first + " pairs",
       change([](Moments& t) { t.pair_places[1] = static_cast<std::uint8_t>(t.batches[0].pair_count); })},
      {".pair_places[1]: not the place of bones ", change([](Moments& t) { t.pair_places[1] = t.pair_places[0]; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].x = kNan; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].y = kInfinity; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].z = kNan; })},
      {".centers[2]: not finite", change([](Moments& t) { t.centers[2].w = kNan; })},
      {".moments[4]: not finite", change([](Moments& t) { t.moments[4].values[0] = kNan; })},
      {".moments[4]: not finite", change([](Moments& t) { t.moments[4].values[15] = kInfinity; })},
  };
  std::vector<Corruption> corruptions;
  for (const auto& [message, apply] : changes) {
    corruptions.push_back({"bone_refit.moments" + message, apply});
  }
  check_each(tiny.parts, corruptions);
}

TEST_CASE("beside moments the pivots' tables are all there and sound, or none is") {
  TinyAsset left_out = random_asset(12, 1);
  TinySkin skin = add_bones(left_out, 5, 3);
  TinyAsset kept = left_out;
  const BoneRefitParts morphing = left_out.parts.bone_refit;
  add_moments(left_out, skin, 14);
  add_moments(kept, skin, 14, PivotTables::kKept);
  using Refit = BoneRefitParts;
  const auto refit = [](auto change) { return [change](AssetParts& p) { change(p.bone_refit); }; };
  check_each(left_out.parts,
             {
                 {"bone_refit.weights: 0 of them, but 12 groups", [](AssetParts& p) { p.refit = 1; }},
                 {"bone_refit.term_counts: 1 of them, but 0 groups", refit([](Refit& r) { r.term_counts = {0}; })},
                 {"bone_refit.term_bones: 1 of them, but 0 terms", refit([](Refit& r) { r.term_bones = {0}; })},
                 {"bone_refit.term_counts: they add up to 0, not to 1", refit([](Refit& r) {
                    r.term_bones = {0};
                    r.terms.emplace_back();
                  })},
                 {"bone_refit.morph_term_counts: they add up to 0, not to 1", refit([](Refit& r) {
                    r.morph_targets = {0};
                    r.morph_terms.emplace_back();
                  })},
             });
  check_each(kept.parts, {
                             {"bone_refit.moments: refit is another", [](AssetParts& p) { p.refit = 1; }},
                             {"bone_refit.moments: refit is another", [](AssetParts& p) { p.refit = 0; }},
                             {"bone_refit.weights: 11 of them, but 12", refit([](Refit& r) { r.weights.pop_back(); })},
                             {"bone_refit.term_counts: 12 of them, but 0", refit([](Refit& r) { r.weights.clear(); })},
                             {"bone_refit.term_counts: 0 of them", refit([](Refit& r) { r.term_counts.clear(); })},
                             {"bone_refit.terms[2]: not finite", refit([](Refit& r) { r.terms[2].x[0] = kNan; })},
                             {"bone_refit.morph_terms: ", refit([&](Refit& r) {
                                r.morph_term_counts = morphing.morph_term_counts;
                                r.morph_targets = morphing.morph_targets;
                                r.morph_terms = morphing.morph_terms;
                              })},
                         });
}

TEST_CASE("an asset by moments without any tables of bones is refused") {
  AssetParts parts = random_asset(12, 1).parts;
  parts.refit = 2;
  const OpenedAsset opened(parts);
  CHECK(opened.status == Status::kCorrupt);
  CHECK(opened.message == "bone_refit.moments: missing, but refit is moments");
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
      CHECK(status == (misalignment == 0 ? Status::kOk : Status::kCorrupt));
      CHECK(message == (misalignment == 0 ? "" : expected));
    }
  };
  const schema::Asset* root = schema::GetAsset(bytes.data());
  check(root, schema::Asset::VT_IGNORED, parts.ignored.size(), 8, "ignored: not aligned to 8 bytes");
  check(root->source(), schema::Source::VT_PARTS, parts.source_parts.size(), sizeof(SourcePart),
        "source.parts: not aligned to 8 bytes");
}

}  // namespace spherechain::test
