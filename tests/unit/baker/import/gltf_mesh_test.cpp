// SPDX-License-Identifier: GPL-3.0-or-later
// Accessors, primitives and buffers of glTF files: the many ways to store the same triangles.
#include <doctest/doctest.h>

#include <cmath>

#include "baker/play/asset_file.h"
#include "gltf_reference.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

// One node with one mesh of one primitive.
Glb one(const json& primitive, Glb glb) {
  glb.json["meshes"] = {{{"primitives", {primitive}}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  return glb;
}

const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};  // as a strip goes

}  // namespace

TEST_CASE("strips, fans and unindexed triangles all turn the same way; points and lines are counted and dropped") {
  Glb glb;
  const int square = glb.accessor(kSquare, "VEC3");
  const auto with = [&](int mode, const std::vector<std::uint8_t>& indices) {
    Glb file = glb;
    json primitive = {{"attributes", {{"POSITION", square}}}, {"mode", mode}};
    if (!indices.empty()) primitive["indices"] = file.accessor(indices, "SCALAR");
    return read(one(primitive, file));
  };
  using Triangles = std::vector<Triangle>;
  CHECK(with(4, {0, 1, 2, 2, 1, 3}).triangles == Triangles{{0, 1, 2}, {2, 1, 3}});
  CHECK(with(4, {}).triangles == Triangles{{0, 1, 2}});
  CHECK(with(5, {}).triangles == Triangles{{0, 1, 2}, {1, 3, 2}});
  CHECK(with(6, {0, 1, 3, 2}).triangles == Triangles{{1, 3, 0}, {3, 2, 0}});
  const std::size_t dropped[] = {4, 2, 4, 3};  // points, lines, a loop, a strip of lines
  for (int mode = 0; mode < 4; ++mode) {
    const SourceMesh mesh = with(mode, {});
    CHECK(mesh.positions.empty());
    CHECK(mesh.buffers.empty());
    CHECK(mesh.points_and_lines_dropped == dropped[mode]);
  }
}

TEST_CASE("sparse accessors change the elements they name, with or without anything below") {
  Glb glb;
  int positions = glb.accessor(kSquare, "VEC3");
  std::vector<Vec3> expected{{0, 0, 0}, {7, 8, 9}, {0, 1, 0}, {4, 5, 6}};
  json& accessor = glb.json["accessors"][0];
  SUBCASE("on a buffer view") {}
  SUBCASE("on zeros") {
    accessor.erase("bufferView");
    expected[2].setZero();
  }
  const int indices = glb.view(std::vector<std::uint16_t>{1, 3}),
            values = glb.view(std::vector<float>{7, 8, 9, 4, 5, 6});
  accessor["sparse"] = {{"count", 2},
                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                        {"values", {{"bufferView", values}}}};
  CHECK(read(one({{"attributes", {{"POSITION", positions}}}}, glb)).positions == expected);
}

TEST_CASE("indices of triangles may be sparse, too, on zeros") {
  Glb glb;
  const int positions = glb.accessor(kSquare, "VEC3");
  const int triangles = glb.accessor(std::vector<std::uint16_t>{0, 0, 0, 0, 0, 0}, "SCALAR");
  json& accessor = glb.json["accessors"][static_cast<std::size_t>(triangles)];
  accessor.erase("bufferView");
  const int places = glb.view(std::vector<std::uint8_t>{1, 2, 4, 5}),
            corners = glb.view(std::vector<std::uint16_t>{1, 2, 2, 3});
  accessor["sparse"] = {{"count", 4},
                        {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                        {"values", {{"bufferView", corners}}}};
  const SourceMesh mesh = read(one({{"attributes", {{"POSITION", positions}}}, {"indices", triangles}}, glb));
  CHECK(mesh.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("interleaved and offset elements are found by stride and offset") {
  Glb glb;
  const int view = glb.view(std::vector<float>{-1, 0, 0, 0, 9, 9, 1, 0, 0, 9, 9, 0, 1, 0, 9, 9});
  glb.json["bufferViews"][0]["byteStride"] = 20;
  glb.json["accessors"] = {
      {{"bufferView", view}, {"byteOffset", 4}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}};
  const SourceMesh mesh = read(one({{"attributes", {{"POSITION", 0}}}}, glb));
  CHECK(mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST_CASE("quantized positions are decoded, whole or as fractions") {
  Glb glb;
  glb.json["extensionsUsed"] = glb.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  SUBCASE("16-bit fractions") {
    const int p = glb.accessor(std::vector<std::int16_t>{32767, -32767, -32768, 0, 16384, 1, 0, 0, 0}, "VEC3", true);
    const std::vector<Vec3> read_positions = read(one({{"attributes", {{"POSITION", p}}}}, glb)).positions;
    CHECK(read_positions[0] == Vec3(1, -1, -1));
    CHECK(read_positions[1].y() == doctest::Approx(16384.0 / 32767).epsilon(1e-15));
  }
  SUBCASE("whole bytes") {
    const int p = glb.accessor(std::vector<std::uint8_t>{255, 0, 3, 0, 1, 0, 0, 0, 0}, "VEC3");
    CHECK(read(one({{"attributes", {{"POSITION", p}}}}, glb)).positions[0] == Vec3(255, 0, 3));
  }
}

TEST_CASE("weights as bytes and shorts, in several sets, come down to the largest that sum to 1") {
  Glb glb = two_boxes();
  json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
  glb.json["skins"][0].erase("inverseBindMatrices");
  glb.json["skins"][0]["joints"] = {3, 1, 2, 4, 5, 6, 7, 8, 9, 10};
  for (int n = 4; n <= 10; ++n) glb.json["nodes"].push_back({{"name", std::to_string(n)}});
  // Vertex 0 has ten weights on ten joints, 1 to 10 in no order; vertex 1 none, but names joint 4 first.
  std::vector<std::uint8_t> joints(3 * 64, 0);
  std::vector<std::uint16_t> weights(3 * 64, 0);
  for (std::size_t k = 0; k < 10; ++k) {
    const std::size_t entry = k / 4 * 64 + k % 4;
    joints[entry] = static_cast<std::uint8_t>(k);
    weights[entry] = static_cast<std::uint16_t>(1 + k * 7 % 10);
  }
  joints[4] = 4;
  for (std::size_t v = 2; v < 16; ++v) weights[4 * v] = 65535;
  for (std::size_t set = 0; set < 3; ++set) {
    const auto part = [&](const auto& all) {
      return std::decay_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(64 * set),
                                         all.begin() + static_cast<std::ptrdiff_t>(64 * set + 64));
    };
    attributes["JOINTS_" + std::to_string(set)] = glb.accessor(part(joints), "VEC4");
    attributes["WEIGHTS_" + std::to_string(set)] = glb.accessor(part(weights), "VEC4", true);
  }
  const SourceMesh mesh = read(glb);
  const VertexWeights& first = mesh.rig.weights[0];
  for (std::size_t k = 0; k < kMaxInfluences; ++k)
    CHECK(first.weight[k] == doctest::Approx((10.0 - static_cast<double>(k)) / 52));
  CHECK(mesh.rig.nodes[mesh.rig.bones[mesh.rig.weights[1].joint[0]].node].name == "5");  // the skin's joint 4
  CHECK(mesh.rig.weights[1].weight[0] == 1);
}

TEST_CASE("each primitive is a part with the hash of the file's own positions") {
  Glb glb = two_boxes();
  json& primitives = glb.json["meshes"][0]["primitives"];
  json more = primitives[0];
  more["indices"] = glb.accessor(std::vector<std::uint16_t>{0, 1, 2}, "SCALAR");
  primitives.push_back(more);  // the same vertices again
  glb.json["meshes"].push_back(
      {{"primitives", {{{"attributes", {{"POSITION", glb.accessor(kSquare, "VEC3")}}}, {"mode", 5}}}}});
  glb.json["nodes"].push_back({{"mesh", 1}, {"translation", {50, 0, 0}}});
  glb.json["scenes"][0]["nodes"].push_back(4);
  const SourceMesh mesh = read(glb);
  REQUIRE(mesh.buffers.size() == 3);
  CHECK(mesh.positions.size() == 20);
  CHECK(mesh.triangles[24] == Triangle{0, 1, 2});
  const auto check = [&](const SourceBuffer& part, Index mesh_index, Index primitive, Index first, Index count) {
    CHECK(part.mesh == mesh_index);
    CHECK(part.primitive == primitive);
    CHECK(part.first_vertex == first);
    CHECK(part.vertex_count == count);
  };
  check(mesh.buffers[0], 0, 0, 0, 16);
  check(mesh.buffers[1], 0, 1, 0, 16);
  check(mesh.buffers[2], 1, 0, 16, 4);
  CHECK(mesh.buffers[2].hash == sc_hash_positions(kSquare.data(), 4, 12));  // though its node moves it
  std::vector<float> raw(48);
  std::memcpy(raw.data(), glb.binary.data(), sizeof(float) * raw.size());
  CHECK(mesh.buffers[0].hash == sc_hash_positions(raw.data(), 16, 12));
}

TEST_CASE("morph targets displace in the rest space, named, sparse or absent, with the weights they rest at") {
  Glb glb;
  const int square = glb.accessor(kSquare, "VEC3");
  const int lift = glb.accessor(std::vector<float>{0, 0, 1, 0, 0, 0, 0, 0, 2, 0, 0, 0}, "VEC3");
  glb.json["accessors"].push_back(
      {{"componentType", 5126},
       {"count", 4},
       {"type", "VEC3"},
       {"sparse",
        {{"count", 1},
         {"indices", {{"bufferView", glb.view(std::vector<std::uint8_t>{3})}, {"componentType", 5121}}},
         {"values", {{"bufferView", glb.view(std::vector<float>{5, 0, 0})}}}}}});
  const json targets = {{{"POSITION", lift}}, {{"POSITION", lift + 1}}, {{"NORMAL", lift}}};
  glb = one({{"attributes", {{"POSITION", square}}}, {"mode", 5}, {"targets", targets}}, glb);
  glb.json["meshes"][0]["weights"] = {0.25, 0, 0};
  glb.json["meshes"][0]["extras"] = {{"targetNames", {"lift", "stretch"}}, {"else", {1, 2, 3}}};
  glb.json["nodes"] = {{{"mesh", 0}, {"scale", {10, 10, 10}}}, {{"mesh", 0}, {"weights", {0, 0.5, 0}}}};
  glb.json["scenes"][0]["nodes"] = {0, 1};
  const SourceMesh mesh = read(glb);
  const std::vector<Morph>& morphs = mesh.rig.morphs;
  REQUIRE(morphs.size() == 6);  // an instance has its own
  CHECK(morphs[0].name == "lift");
  CHECK(morphs[1].name == "stretch");
  CHECK(morphs[2].name == "target_2");
  CHECK(morphs[0].vertices == std::vector<Index>{0, 2});
  CHECK(morphs[0].deltas == std::vector<Vec3>{{0, 0, 10}, {0, 0, 20}});
  CHECK(morphs[2].vertices.empty());
  CHECK(morphs[4].vertices == std::vector<Index>{7});
  CHECK(morphs[4].deltas == std::vector<Vec3>{{5, 0, 0}});
  CHECK(morphs[0].rest_weight == 0.25);
  CHECK(morphs[3].rest_weight == 0);
  CHECK(morphs[4].rest_weight == 0.5);
  CHECK(mesh.positions[4] == Vec3::Zero());  // at rest without them: the file's own buffer
}

TEST_CASE(
    "buffers may be data URIs or files beside, with escaped names and more bytes than asked; images are not read") {
  Glb glb = one({{"attributes", {{"POSITION", 0}}}}, Glb());
  glb.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  glb.json["images"] = {{{"uri", "missing.png"}}, {{"bufferView", 99}, {"mimeType", "image/png"}}, {{"uri", 7}}};
  glb.json["materials"] = {{{"name", 5}}};
  const TemporaryFolder folder;
  const std::vector<Vec3> triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  SUBCASE("a data URI") {
    const std::string base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    for (const char* type : {"application/octet-stream", "application/gltf-buffer"}) {
      const auto path = folder.write("a.gltf", glb.text(std::string("data:") + type + ";base64," + base64));
      CHECK(read_with_tinygltf(path, {}).positions == triangle);
    }
  }
  SUBCASE("a file beside") {
    std::filesystem::create_directory(folder.path / "sub dir");
    folder.write("sub dir/b\xC3\xA4 1%.bin", glb.binary + "and more");
    const auto path = folder.write("a.gltf", "\xEF\xBB\xBF" + glb.text("sub%20dir/b%c3%A4%201%25.bin"));
    CHECK(read_with_tinygltf(path, {}).positions == triangle);
  }
  SUBCASE("the binary chunk and a file, in a GLB with an unknown third chunk") {
    folder.write("more.bin", glb.binary);
    glb.json["buffers"] = {{{"byteLength", 4}}, {{"byteLength", 36}, {"uri", "more.bin"}}};
    glb.json["bufferViews"][0]["buffer"] = 1;
    std::string bytes = glb.bytes() + Glb::word(4) + "ODDS1234";
    bytes.replace(8, 4, Glb::word(bytes.size()));
    CHECK(read_with_tinygltf(folder.write("a.glb", bytes), {}).positions == triangle);
  }
}

TEST_CASE("the clips of a glTF: paths, interpolations, a channel a morph, times given twice") {
  Glb glb = two_boxes();
  const int square = glb.accessor(kSquare, "VEC3");
  glb.json["meshes"].push_back({{"primitives",
                                 {{{"attributes", {{"POSITION", square}}},
                                   {"mode", 5},
                                   {"targets", {{{"POSITION", square}}, {{"POSITION", square}}}}}}}});
  glb.json["nodes"].push_back({{"mesh", 1}});
  glb.json["scenes"][0]["nodes"] = {3, 0, 4};
  const int two = glb.accessor(std::vector<float>{0.5F, 2}, "SCALAR"),
            three = glb.accessor(std::vector<float>{0, 1, 1}, "SCALAR"),
            none = glb.accessor(std::vector<float>{}, "SCALAR");
  const auto channel = [](int sampler, int node, const char* path) {
    return json{{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}};
  };
  const auto sampler = [](int input, int output, const char* interpolation) {
    return json{{"input", input}, {"output", output}, {"interpolation", interpolation}};
  };
  std::vector<float> spline(12);  // of weights: a key's in-tangents, values and out-tangents, 2 each
  for (std::size_t i = 0; i < 12; ++i) spline[i] = static_cast<float>(i);
  glb.json["animations"] = {
      {{"name", "wave"},
       {"channels",
        {channel(0, 2, "translation"),
         channel(1, 2, "rotation"),
         channel(2, 1, "scale"),
         channel(3, 4, "weights"),
         channel(0, 2, "pointer"),
         {{"sampler", 0}, {"target", {{"path", "translation"}}}},
         channel(4, 1, "scale")}},
       {"samplers",
        {sampler(two, glb.accessor(std::vector<float>{1, 2, 3, 4, 5, 6}, "VEC3"), "LINEAR"),
         sampler(three,
                 glb.accessor(std::vector<std::int16_t>{0, 0, 0, 32767, 32767, 0, 0, 0, 0, 32767, 0, 0}, "VEC4", true),
                 "STEP"),
         {{"input", two}, {"output", glb.accessor(std::vector<float>{1, 1, 1, 2, 2, 2}, "VEC3")}},
         sampler(two, glb.accessor(spline, "SCALAR"), "CUBICSPLINE"),
         sampler(none, none, "LINEAR")}}},
      {{"channels", json::array()}, {"samplers", json::array()}},
      {{"channels", {channel(0, 3, "translation")}},
       {"samplers", {sampler(two, glb.accessor(std::vector<float>(6, 0), "VEC3"), "LINEAR")}}}};
  // Empty accessors need a component type that suits.
  glb.json["animations"][0]["samplers"][4]["output"] = glb.accessor(std::vector<float>{}, "VEC3");
  const SourceRig rig = read(glb).rig;
  REQUIRE(rig.clips.size() == 2);  // one has no channels
  CHECK(rig.clips[1].name == "animation_2");
  const Clip& clip = rig.clips[0];
  CHECK(clip.name == "wave");
  CHECK(clip.duration == 2);
  REQUIRE(clip.channels.size() == 5);
  CHECK(rig.nodes[clip.channels[0].target].name == "chest");
  CHECK(clip.channels[0].path == ChannelPath::kTranslation);
  CHECK(clip.channels[0].times == std::vector<double>{0.5, 2});
  CHECK(clip.channels[0].values == std::vector<double>{1, 2, 3, 4, 5, 6});
  CHECK(clip.channels[1].interpolation == Interpolation::kStep);
  CHECK(clip.channels[1].times == std::vector<double>{0, 1});
  CHECK(clip.channels[1].values == std::vector<double>{0, 0, 0, 1, 0, 1, 0, 0});  // the later of two at one time
  CHECK(clip.channels[2].path == ChannelPath::kScale);
  CHECK(clip.channels[2].interpolation == Interpolation::kLinear);
  for (std::size_t m = 0; m < 2; ++m) {
    const Channel& weight = clip.channels[3 + m];
    CHECK(weight.path == ChannelPath::kMorphWeight);
    CHECK(weight.interpolation == Interpolation::kCubicSpline);
    CHECK(weight.target == m);
    const auto first = static_cast<double>(m);
    CHECK(weight.values == std::vector<double>{first, first + 2, first + 4, first + 6, first + 8, first + 10});
  }
}
