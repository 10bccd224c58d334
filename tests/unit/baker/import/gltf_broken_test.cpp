// SPDX-License-Identifier: GPL-3.0-or-later
// Broken and hostile glTF files end in one sentence, in little memory, and under the sanitizers in nothing else.
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <functional>
#include <limits>

#include "baker/import/notes.h"
#include "gltf_reference.h"
#include "refusal.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

std::string refusal_of_glb(const std::string& bytes) {
  const TemporaryFolder folder;
  return refusal(folder.write("a.glb", bytes));
}

// Without a child process, in which a crash would be a refusal.
std::string refusal_here(const std::filesystem::path& file) {
  return refusal(file, [](const auto& path) { build_character(read_with_tinygltf(path, {}), path.string()); });
}

// Two skinned boxes, a morph, a clip.
Glb character() {
  Glb glb = two_boxes();
  glb.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  const int times = glb.accessor(std::vector<float>{0, 1}, "SCALAR"),
            values = glb.accessor(std::vector<float>{0, 0, 0, 1, 1, 0, 0, 0}, "VEC4");
  glb.json["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}}}},
                             {"samplers", {{{"input", times}, {"output", values}}}}}};
  return glb;
}
// Its accessors and nodes, by what they are.
constexpr int kPositions = 0, kJointsAccessor = 1, kWeights = 2, kIndices = 3, kMatrices = 4, kTimes = 5,
              kRotations = 6;

struct Break {
  const char* message;  // what it must contain
  std::function<void(Glb&)> apply;
};

void check_each(const std::vector<Break>& breaks) {
  REQUIRE(refusal_of_glb(character().bytes()) == "accepted");
  for (const Break& change : breaks) {
    Glb glb = character();
    change.apply(glb);
    const std::string message = refusal_of_glb(glb.bytes());
    INFO("expected: ", change.message);
    INFO("message:  ", message);
    CHECK(message.find(change.message) != std::string::npos);
  }
}

void patch(Glb& glb, int accessor, std::size_t offset, float value) {
  const json& view = glb.json["bufferViews"][static_cast<std::size_t>(accessor)];
  std::memcpy(glb.binary.data() + view["byteOffset"].get<std::size_t>() + offset, &value, 4);
}

json& accessor(Glb& glb, int index) { return glb.json["accessors"][static_cast<std::size_t>(index)]; }

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

}  // namespace

TEST_CASE("a GLB cut short anywhere is refused") {
  const TemporaryFolder folder;
  const std::string bytes = character().bytes();
  REQUIRE(refusal_of_glb(bytes) == "accepted");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::string message = refusal_here(folder.write("cut.glb", bytes.substr(0, size)));
    REQUIRE_MESSAGE(message != "accepted", size);
  }
}

TEST_CASE("a GLB with a byte of it changed, any byte, is refused or read") {
  const TemporaryFolder folder;
  std::string bytes = character().bytes();
  std::size_t accepted = 0, refused = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char original = bytes[i];
    bytes[i] = "\xFF\x00\x39-}"[i % 5];
    (refusal_here(folder.write("changed.glb", bytes)) == "accepted" ? accepted : refused) += 1;
    bytes[i] = original;
  }
  CHECK(accepted > 0);
  CHECK(refused > bytes.size() / 4);
}

TEST_CASE("the container's broken parts are named") {
  const std::string bytes = character().bytes(), rest = bytes.substr(12);
  const auto with_header = [&](std::size_t version, std::size_t length) {
    return "glTF" + Glb::word(version) + Glb::word(length) + rest;
  };
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(contains(refusal_of_glb(with_header(1, bytes.size())), "GLB version 1"));
  CHECK(contains(refusal_of_glb(with_header(2, bytes.size() + 1)), "cut short"));
  CHECK(contains(refusal_of_glb(with_header(2, 0xFFFFFFFF)), "cut short"));
  CHECK(contains(refusal_of_glb(with_header(2, 12)), "no JSON chunk"));
  CHECK(contains(
      refusal_of_glb("glTF" + Glb::word(2) + Glb::word(bytes.size()) + Glb::word(0xFFFFFFFF) + bytes.substr(16)),
      "past its end"));
  CHECK(contains(refusal_of_glb(Glb::container("{", "")), "JSON is broken at byte"));
  CHECK(contains(refusal_of_glb(Glb::container("[1e999]", "")), "not finite"));
  CHECK(contains(refusal_of_glb(Glb::container("{}", "")), "asset.version is missing"));
  CHECK(contains(refusal_of_glb(Glb::container(R"({"asset":{"version":"1.0"}})", "")), "is glTF 1.0"));
  CHECK(contains(refusal_of_glb(Glb::container(std::string(200000, '['), "")), "nested too deeply"));
  CHECK(contains(refusal_of_glb(Glb::container("{\"a\":" + std::string(200000, '['), "")), "nested too deeply"));
  CHECK(contains(refusal_of_glb(Glb::container(R"({"asset":{"version":"2.0"}})", "")), "no triangles"));
}

TEST_CASE("members of the wrong type and indices that lead nowhere are named") {
  check_each({
      {"meshes is not a list", [](Glb& g) { g.json["meshes"] = 5; }},
      {"nodes[1] is not an object", [](Glb& g) { g.json["nodes"][1] = "hips"; }},
      {"accessors[0].count is missing", [](Glb& g) { accessor(g, 0).erase("count"); }},
      {"accessors[0].count is -1", [](Glb& g) { accessor(g, 0)["count"] = -1; }},
      {"accessors[0].count is not a whole number", [](Glb& g) { accessor(g, 0)["count"] = "many"; }},
      {"accessors[0].count is 2.5", [](Glb& g) { accessor(g, 0)["count"] = 2.5; }},
      {"accessors[0].bufferView is 77", [](Glb& g) { accessor(g, 0)["bufferView"] = 77; }},
      {"bufferViews[0].buffer is 0, but there are 0 buffers", [](Glb& g) { g.json["buffers"] = json::array(); }},
      {"primitives[0].attributes.POSITION is 99",
       [](Glb& g) { g.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; }},
      {"primitives[0].targets[0].POSITION is 99",
       [](Glb& g) { g.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 99; }},
      {"primitives[0].indices is 4294967296",
       [](Glb& g) { g.json["meshes"][0]["primitives"][0]["indices"] = 4294967296; }},
      {"primitives[0].mode is 7", [](Glb& g) { g.json["meshes"][0]["primitives"][0]["mode"] = 7; }},
      {"nodes[0].mesh is 1, but there are 1 meshes", [](Glb& g) { g.json["nodes"][0]["mesh"] = 1; }},
      {"nodes[0].skin is 3", [](Glb& g) { g.json["nodes"][0]["skin"] = 3; }},
      {"nodes[1].children[0] is 50", [](Glb& g) { g.json["nodes"][1]["children"] = {50}; }},
      {"nodes[1].rotation is not a list of 4 numbers",
       [](Glb& g) {
         g.json["nodes"][1]["rotation"] = {1, 2, 3};
       }},
      {"nodes[1].matrix is not a list", [](Glb& g) { g.json["nodes"][1]["matrix"] = "identity"; }},
      {"nodes[1].matrix is not an affine", [](Glb& g) { g.json["nodes"][1]["matrix"] = std::vector<double>(16, 1.0); }},
      {"skins[0].joints[1] is 88",
       [](Glb& g) {
         g.json["skins"][0]["joints"] = {1, 88};
       }},
      {"skins[0].joints is empty", [](Glb& g) { g.json["skins"][0]["joints"] = json::array(); }},
      {"skins[0].joints names a node twice",
       [](Glb& g) {
         g.json["skins"][0]["joints"] = {1, 1};
       }},
      {"channels[0].sampler is 1, but there are 1 samplers",
       [](Glb& g) { g.json["animations"][0]["channels"][0]["sampler"] = 1; }},
      {"channels[0].target.node is 9", [](Glb& g) { g.json["animations"][0]["channels"][0]["target"]["node"] = 9; }},
      {"samplers[0].output is 99", [](Glb& g) { g.json["animations"][0]["samplers"][0]["output"] = 99; }},
      {"scenes[0].nodes[0] is 9", [](Glb& g) { g.json["scenes"][0]["nodes"] = {9}; }},
      {"scene is 4, but there are 1 scenes", [](Glb& g) { g.json["scene"] = 4; }},
      {"needs the glTF extension EXT_meshopt_compression",
       [](Glb& g) {
         g.json["extensionsRequired"] = {"KHR_materials_unlit", "EXT_meshopt_compression"};
       }},
      {"needs the glTF extension KHR_draco_mesh_compression",
       [](Glb& g) { g.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }},
      {"KHR_draco_mesh_compression is not read",
       [](Glb& g) {
         accessor(g, kPositions).erase("bufferView");
         g.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
       }},
      {"EXT_meshopt_compression is not read",
       [](Glb& g) {
         g.json["bufferViews"][0]["buffer"] = 1;
         g.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"count", 3}};
         g.json["buffers"] = {{{"byteLength", g.binary.size()}}, {{"byteLength", 4096}}};
       }},
  });
}

TEST_CASE("nodes in circles, with two parents, without a size are refused") {
  check_each({
      {"nodes[1] is its own ancestor",
       [](Glb& g) {
         g.json["nodes"][2]["children"] = {1};
         g.json["nodes"][3].erase("children");
       }},
      {"nodes[0] is its own ancestor", [](Glb& g) { g.json["nodes"][0]["children"] = {0}; }},
      {"nodes[2] has two parents",
       [](Glb& g) {
         g.json["nodes"][3]["children"] = {1, 2};
       }},
      {"nodes[2] has two parents",
       [](Glb& g) {
         g.json["nodes"][1]["children"] = {2, 2};
       }},
      {"skins[0] has no joint with a size",
       [](Glb& g) {
         g.json["nodes"][3]["scale"] = {0, 0, 0};
       }},
      {"no sensible size",
       [](Glb& g) {
         g.json["nodes"][3]["scale"] = {1e30, 1e30, 1e30};
       }},
      {"too large for numbers",
       [](Glb& g) {
         g.json["nodes"][3]["scale"] = {1e200, 1e200, 1e200};
         g.json["nodes"][1]["scale"] = {1e200, 1, 1};
       }},
  });
  // A hundred thousand nodes below one another are no circle.
  Glb deep = character();
  for (int n = 4; n < 100004; ++n) deep.json["nodes"].push_back({{"children", {n + 1}}});
  deep.json["nodes"].push_back({{"name", "last"}});
  CHECK(refusal_of_glb(deep.bytes()) == "accepted");
}

TEST_CASE("buffers, views and accessors that do not fit into one another are refused") {
  check_each({
      {"buffers[0] has 999999 bytes, but the binary chunk only",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 999999}}};
       }},
      {"buffers[0].byteLength is 4294967296",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4294967296}}};
       }},
      {"'nowhere.bin' is not there",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4}, {"uri", "nowhere.bin"}}};
       }},
      {"'/dev/zero' is an absolute path",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4}, {"uri", "/dev/zero"}}};
       }},
      {"'' is empty",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4}, {"uri", ""}}};
       }},
      {"is no file in the folder",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4}, {"uri", "ftp://a/b.bin"}}};
       }},
      {"not base64",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4}, {"uri", "data:application/octet-stream;base64,????"}}};
       }},
      {"buffers[0] has 4000 bytes, but its data URI only 3",
       [](Glb& g) {
         g.json["buffers"] = {{{"byteLength", 4000}, {"uri", "data:application/octet-stream;base64,AAAA"}}};
       }},
      {"bufferViews[0] reaches past its buffer", [](Glb& g) { g.json["bufferViews"][0]["byteOffset"] = 2147483647; }},
      {"accessors[0] reaches past its buffer view", [](Glb& g) { accessor(g, 0)["byteOffset"] = 2147483647; }},
      {"accessors[0] reaches past its buffer view", [](Glb& g) { accessor(g, 0)["count"] = 17; }},
      {"accessors[0].count is 4000000000", [](Glb& g) { accessor(g, 0)["count"] = 4000000000; }},
      {"accessors[0] reaches past its buffer view", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 252; }},
      {"byteStride is less than an element", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 4; }},
      {"byteStride", [](Glb& g) { g.json["bufferViews"][0]["byteStride"] = 13; }},
      {"sparse.count is more than count",
       [](Glb& g) {
         accessor(g, 0)["sparse"] = {
             {"count", 17}, {"indices", {{"bufferView", 3}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
       }},
      {"sparse.indices reaches past",
       [](Glb& g) {
         accessor(g, 0)["sparse"] = {
             {"count", 3},
             {"indices", {{"bufferView", 3}, {"byteOffset", 2147483647}, {"componentType", 5123}}},
             {"values", {{"bufferView", 0}}}};
       }},
      {"sparse.values reaches past",
       [](Glb& g) {
         accessor(g, 0)["sparse"] = {
             {"count", 16}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 5}}}};
       }},
      {"sparse.indices lead past its count",
       [](Glb& g) {
         accessor(g, 0)["sparse"] = {
             {"count", 2}, {"indices", {{"bufferView", 2}, {"componentType", 5125}}}, {"values", {{"bufferView", 0}}}};
       }},
      {"sparse.indices.componentType is 5126",
       [](Glb& g) {
         accessor(g, 0)["sparse"] = {
             {"count", 2}, {"indices", {{"bufferView", 2}, {"componentType", 5126}}}, {"values", {{"bufferView", 0}}}};
       }},
  });
}

TEST_CASE("accessors of the wrong type or length, and figures that are none, are refused") {
  check_each({
      {"accessors[0].type", [](Glb& g) { accessor(g, kPositions)["type"] = "VEC4"; }},
      {"Unsupported `type`", [](Glb& g) { accessor(g, kPositions)["type"] = "VEC5"; }},
      {"accessors[0].componentType is 5125", [](Glb& g) { accessor(g, kPositions)["componentType"] = 5125; }},
      {"accessors[1].componentType is 5126", [](Glb& g) { accessor(g, kJointsAccessor)["componentType"] = 5126; }},
      {"accessors[2].componentType is 5122", [](Glb& g) { accessor(g, kWeights)["componentType"] = 5122; }},
      {"accessors[3].componentType is 5122", [](Glb& g) { accessor(g, kIndices)["componentType"] = 5122; }},
      {"accessors[5].componentType is 5123", [](Glb& g) { accessor(g, kTimes)["componentType"] = 5123; }},
      {"WEIGHTS_0 is for 15 vertices of 16", [](Glb& g) { accessor(g, kWeights)["count"] = 15; }},
      {"targets[0].POSITION is for 1 vertices of 16",
       [](Glb& g) {
         g.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] =
             g.accessor(std::vector<float>{1, 2, 3}, "VEC3");
       }},
      {"inverseBindMatrices has 1 matrices for 2 joints", [](Glb& g) { accessor(g, kMatrices)["count"] = 1; }},
      {"primitives[0] uses vertex 15 of 15",
       [](Glb& g) {
         for (const int a : {kPositions, kJointsAccessor, kWeights}) accessor(g, a)["count"] = 15;
       }},
      {"vertex 2 follows joint 1 of 1",
       [](Glb& g) {
         g.json["skins"][0]["joints"] = {1};
         patch(g, kWeights, 0, 1);
       }},
      {"accessors[0] holds a number that is not finite, in its element 2",
       [](Glb& g) { patch(g, kPositions, 24, kNan); }},
      {"accessors[2] holds", [](Glb& g) { patch(g, kWeights, 0, std::numeric_limits<float>::infinity()); }},
      {"accessors[4] holds", [](Glb& g) { patch(g, kMatrices, 0, kNan); }},
      {"accessors[5] holds", [](Glb& g) { patch(g, kTimes, 4, kNan); }},
      {"accessors[6] holds", [](Glb& g) { patch(g, kRotations, 0, kNan); }},
      {"inverseBindMatrices[1] is not an affine", [](Glb& g) { patch(g, kMatrices, 64 + 60, 0.5F); }},
      {"do not ascend", [](Glb& g) { patch(g, kTimes, 0, 5); }},
      {"has a key at -1", [](Glb& g) { patch(g, kTimes, 0, -1); }},
      {"has 8 numbers in accessors[6] for 1 keys of 4", [](Glb& g) { accessor(g, kTimes)["count"] = 1; }},
      {"for 2 keys of 12", [](Glb& g) { g.json["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }},
      {"interpolation 'SMOOTH'", [](Glb& g) { g.json["animations"][0]["samplers"][0]["interpolation"] = "SMOOTH"; }},
      {"animations[0].samplers[0].interpolation is not a string",
       [](Glb& g) { g.json["animations"][0]["samplers"][0]["interpolation"] = 3; }},
      {"no triangles", [](Glb& g) { g.json["nodes"][0].erase("mesh"); }},
  });
}

TEST_CASE("a clip without a key is left out, and a note tells") {
  Glb glb = character();
  for (const int one : {kTimes, kRotations}) accessor(glb, one)["count"] = 0;
  const TemporaryFolder folder;
  take_notes();
  CHECK(read_source(folder.write("a.glb", glb.bytes()), {}).rig.clips.empty());
  const std::vector<std::string> notes = take_notes();
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("a.glb: the clip 'animation_0' has no keys that move a node") != std::string::npos);
}

TEST_CASE("small files that ask for much memory are refused before they get it" * doctest::test_suite("many bakes")) {
  // A megabyte each; what they ask for is gigabytes.
  const auto memory = [] {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024;
  };
  const long before = memory();
  check_each({
      {"too large for a character",
       [](Glb& g) {
         accessor(g, kPositions)["count"] = 2000000000;
         accessor(g, kPositions).erase("bufferView");
         accessor(g, kPositions)["sparse"] = {
             {"count", 1}, {"indices", {{"bufferView", 3}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
       }},
      {"too many for a character", [](Glb& g) { g.json["nodes"] = std::vector<json>(300000, json::object()); }},
      {"too large for a character",
       [](Glb& g) {
         const int big = g.accessor(std::vector<float>(300000, 1), "VEC3");
         g.json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", big}}}}}}}};
         g.json["nodes"] = std::vector<json>(1000, {{"mesh", 0}});
         g.json.erase("scenes");
       }},
      {"too many keys",
       [](Glb& g) {
         std::vector<float> ascending(100000);
         for (std::size_t k = 0; k < ascending.size(); ++k) ascending[k] = static_cast<float>(k);
         const int times = g.accessor(ascending, "SCALAR"), values = g.accessor(std::vector<float>(400000, 1), "VEC4");
         json& clip = g.json["animations"][0];
         clip["samplers"][0] = {{"input", times}, {"output", values}};
         clip["channels"] = std::vector<json>(1000, clip["channels"][0]);
       }},
  });
  CHECK(memory() - before < 3000);  // MB
}
