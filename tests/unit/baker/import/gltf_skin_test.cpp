// SPDX-License-Identifier: GPL-3.0-or-later
// Skins, nodes and rest space of glTF files, against positions computed straight from the specification.
#include <doctest/doctest.h>

#include <algorithm>

#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "gltf_reference.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using Eigen::Vector3d;
using nlohmann::json;

namespace {

// Positions are floats in the file, some tens of units from the origin.
constexpr double kTolerance = 1e-5;

void check_same(const std::vector<Vector3d>& ours, const std::vector<Vector3d>& reference) {
  REQUIRE(ours.size() == reference.size());
  double worst = 0;
  for (std::size_t v = 0; v < ours.size(); ++v) worst = std::max(worst, (ours[v] - reference[v]).norm());
  CHECK(worst < kTolerance);
}

// The file's vertices are where the specification puts them, as its nodes stand and with a joint turned, moved and
// scaled.
void check_skinning(const Glb& glb, std::size_t moved_node) {
  const SourceMesh mesh = read(glb);
  check_same(world_positions(mesh, world_of(mesh.rig.nodes)), world_positions(glb));
  Glb posed = glb;
  json& node = posed.json["nodes"][moved_node];
  node.erase("matrix");
  node["rotation"] = {0.48, 0.6, 0, 0.64};
  node["translation"] = {0.5, 1.5, -2};
  node["scale"] = {1.25, 1.25, 1.25};
  check_same(world_positions(mesh, world_of(read(posed).rig.nodes)), world_positions(posed));
}

std::vector<Vector3d> raw_positions(const Glb& glb, int accessor) {
  const json& view =
      glb.json["bufferViews"]
              [glb.json["accessors"][static_cast<std::size_t>(accessor)]["bufferView"].get<std::size_t>()];
  std::vector<float> p(view["byteLength"].get<std::size_t>() / 4);
  std::memcpy(p.data(), glb.binary.data() + view["byteOffset"].get<std::size_t>(), 4 * p.size());
  std::vector<Vector3d> out;
  for (std::size_t i = 0; i < p.size(); i += 3) out.emplace_back(p[i], p[i + 1], p[i + 2]);
  return out;
}

// A second mesh: a box of its own, rigid unless given a skin.
int add_box(Glb& glb, float x, float y, float z) {
  glb.json["meshes"].push_back({{"primitives",
                                 {{{"attributes", {{"POSITION", glb.accessor(box_corners(x, y, z), "VEC3")}}},
                                   {"indices", glb.accessor(box_triangles(), "SCALAR")}}}}});
  return static_cast<int>(glb.json["meshes"].size()) - 1;
}

// The column, and beside it another one on joints of its own, both skins named.
Glb two_columns(double apart) {
  Glb glb = two_boxes();
  const json nodes = glb.json["nodes"];
  for (json node : nodes) {
    node["name"] = node["name"].get<std::string>() + ".001";
    if (node.contains("skin")) node["skin"] = 1;
    if (node.contains("children")) node["children"][0] = node["children"][0].get<int>() + 4;
    glb.json["nodes"].push_back(node);
  }
  glb.json["nodes"][7]["translation"] = {apart, 0, 0};
  glb.json["skins"].push_back(glb.json["skins"][0]);
  glb.json["skins"][1]["joints"] = {5, 6};
  glb.json["skins"][0]["name"] = "first";
  glb.json["skins"][1]["name"] = "second";
  glb.json["scenes"] = {{{"nodes", {0, 3, 4, 7}}}};
  return glb;
}

SourceMesh read_character(const Glb& glb, const std::string& character) {
  const TemporaryFolder folder;
  ImportOptions options;
  options.character = character;
  return read_source(folder.write("a.glb", glb.bytes()), options);
}

double signed_volume(const SourceMesh& mesh) {
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    volume += mesh.positions[t[0]].dot(mesh.positions[t[1]].cross(mesh.positions[t[2]])) / 6;
  }
  return volume;
}

}  // namespace

TEST_CASE("a skinned glTF: its vertices are the file's, its bones put them where the specification does") {
  const Glb glb = two_boxes();
  const SourceMesh mesh = read(glb);
  CHECK(mesh.importer == "tinygltf");
  CHECK(mesh.positions == raw_positions(glb, 0));  // the mesh node's own translation is not in them
  CHECK(mesh.triangles.size() == 24);
  CHECK(mesh.rig.bones.size() == 2);
  CHECK(mesh.metres_per_unit == doctest::Approx(1));
  for (const VertexWeights& w : mesh.rig.weights) {
    double sum = 0;
    for (const double weight : w.weight) sum += weight;
    CHECK(sum == doctest::Approx(1).epsilon(1e-15));
    CHECK(w.weight[0] >= w.weight[1]);
  }
  check_skinning(glb, 2);
  check_skinning(glb, 1);
}

TEST_CASE("a scaled, turned root above the skeleton changes units and axes, not the rest pose") {
  Glb glb = two_boxes();
  // The upper joint at rest as it was bound, then centimetres and z up.
  glb.json["nodes"][2].erase("rotation");
  const double s = 0.01;
  SUBCASE("as a matrix") { glb.json["nodes"][3]["matrix"] = {s, 0, 0, 0, 0, 0, -s, 0, 0, s, 0, 0, 3, 4, 5, 1}; }
  SUBCASE("as translation, rotation and scale") {
    const double half = std::sqrt(0.5);
    glb.json["nodes"][3]["rotation"] = {-half, 0, 0, half};
    glb.json["nodes"][3]["scale"] = {s, s, s};
    glb.json["nodes"][3]["translation"] = {3, 4, 5};
  }
  const SourceMesh mesh = read(glb);
  CHECK(mesh.positions == raw_positions(glb, 0));
  CHECK(mesh.metres_per_unit == doctest::Approx(0.01));
  CHECK((mesh.up_hint - Vec3::UnitZ()).norm() < 1e-6);
  check_skinning(glb, 2);
  // to_rest takes the world back to the rest pose: bones at rest move nothing.
  const std::vector<Vector3d> world = world_positions(glb);
  for (std::size_t v = 0; v < world.size(); ++v) {
    CHECK((mesh.rig.to_rest * world[v] - mesh.positions[v]).norm() < 1e-4);
  }
}

TEST_CASE("of two characters in a file a note tells; a node or a skin by name is one of them") {
  const Glb glb = two_columns(8);
  take_notes();
  CHECK(read_character(glb, "").positions.size() == 32);
  const std::vector<std::string> notes = take_notes();
  REQUIRE(notes.size() == 1);
  for (const char* part : {"2 characters", "'hips'", "'hips.001'", "--character"})
    CHECK_MESSAGE(notes[0].find(part) != std::string::npos, notes[0]);
  for (const char* name : {"first", "body", "hips", "armature", "second", "body.001", "hips.001", "armature.001"}) {
    const SourceMesh one = read_character(glb, name);
    CHECK(one.positions == raw_positions(glb, 0));
    REQUIRE(one.rig.bones.size() == 2);
    const bool is_second = name == std::string("second") || std::string(name).ends_with(".001");
    CHECK(one.rig.nodes[one.rig.bones[0].node].name == (is_second ? "hips.001" : "hips"));
    CHECK(take_notes().empty());
  }
  CHECK_THROWS_WITH_AS(read_character(glb, "third"),
                       doctest::Contains("'third' (--character takes 'hips', 'hips.001')"), Error);
  // Joints of one name: the names are those that take one character, here too.
  Glb same = glb;
  for (auto& node : same.json["nodes"]) {
    if (node["name"] == "hips.001") node["name"] = "hips";
  }
  read_character(same, "");
  const std::string note = take_notes().at(0);
  CHECK_MESSAGE(note.find("('armature', 'armature.001')") != std::string::npos, note);
  CHECK(read_character(same, "armature").positions.size() == 16);
  CHECK(read_character(same, "hips").positions.size() == 32);
  take_notes();
  // Clothes on a skeleton of their own are no second one.
  read_character(two_columns(0.25), "");
  CHECK(take_notes().empty());
}

TEST_CASE("of levels of detail the finest is read, and a note tells") {
  const auto read_as = [](const char* first, const char* second) {
    Glb glb = two_columns(0);
    glb.json["nodes"][0]["name"] = first;
    glb.json["nodes"][4]["name"] = second;
    return read_character(glb, "").positions.size();
  };
  for (const auto& [first, second] :
       std::vector<std::pair<const char*, const char*>>{{"body_LOD0", "body_LOD1"},
                                                        {"body_lod2", "body_lod1"},
                                                        {"LOD0", "LOD1"},
                                                        {"Body LOD 1", "Body LOD 0.001"}}) {
    CAPTURE(first);
    take_notes();
    CHECK(read_as(first, second) == 16);
    REQUIRE(take_notes().size() == 1);
  }
  for (const auto& [first, second] : std::vector<std::pair<const char*, const char*>>{
           {"body_LOD0", "hair_LOD1"}, {"explod0", "explod1"}, {"body_LOD0", "body_LOD0"}, {"body0", "body1"}}) {
    CAPTURE(first);
    CHECK(read_as(first, second) == 32);
    CHECK(take_notes().empty());
  }
  Glb glb = two_columns(0);
  glb.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"] = {4};
  CHECK(read_character(glb, "").positions.size() == 16);
}

TEST_CASE("an avatar keeps its humanoid where its meshes are rigid") {
  Glb glb = two_boxes();
  glb.json.erase("skins");
  glb.json["nodes"][0].erase("skin");
  glb.json["nodes"][0].erase("mesh");
  glb.json["nodes"][1]["mesh"] = 0;
  CHECK(read_character(glb, "").rig.nodes.empty());
  glb.json["extensions"]["VRM"]["humanoid"]["humanBones"] = {{{"bone", "hips"}, {"node", 1}}};
  const SourceMesh avatar = read_character(glb, "");
  REQUIRE(avatar.rig.bones.size() == 1);
  CHECK(avatar.rig.nodes[avatar.rig.bones[0].node].humanoid_bone == "hips");
}

TEST_CASE("control characters in names are shown as what is no character") {
  Glb glb = two_boxes();
  glb.json["nodes"][1]["name"] = std::string("a\0b\x1b\n", 5);
  CHECK(read_character(glb, "").rig.nodes[2].name == "a\uFFFDb\uFFFD\uFFFD");
}

TEST_CASE("without inverse bind matrices a skin is bound in its joints' own spaces") {
  Glb glb = two_boxes();
  glb.json["skins"][0].erase("inverseBindMatrices");
  check_skinning(glb, 2);
}

TEST_CASE("two skins come into one rest space") {
  Glb glb = two_boxes();
  // A second mesh in a space of its own: 10 times the size, moved; its skin undoes that.
  const int mesh = add_box(glb, 0, 40, 0);
  json& primitive = glb.json["meshes"][1]["primitives"][0];
  std::vector<std::uint16_t> joints;
  std::vector<float> weights;
  for (int v = 0; v < 8; ++v) {
    joints.insert(joints.end(), {1, 0, 0, 0});
    weights.insert(weights.end(), {0.75F, 0.25F, 0, 0});
  }
  primitive["attributes"]["JOINTS_0"] = glb.accessor(joints, "VEC4");
  primitive["attributes"]["WEIGHTS_0"] = glb.accessor(weights, "VEC4");
  SUBCASE("through a joint they share") {
    const std::vector<float> inverse_bind = {0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 0.1F, 0, 1, 0,  0, 1,
                                             0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 0.1F, 0, 1, -2, 0, 1};
    glb.json["skins"].push_back({{"joints", {1, 2}}, {"inverseBindMatrices", glb.accessor(inverse_bind, "MAT4")}});
    glb.json["nodes"].push_back({{"mesh", mesh}, {"skin", 1}});
    glb.json["scenes"][0]["nodes"].push_back(4);
    const SourceMesh read_mesh = read(glb);
    // Bound, the second's box of 38 to 42 units is at 3.9 to 4.1, 1 to the side.
    CHECK((read_mesh.positions[16] - Vec3(1 - 0.1, 3.9, -0.1)).norm() < 1e-6);
    CHECK(read_mesh.rig.bones.size() == 2);  // the same joints, bound alike
  }
  SUBCASE("through their nodes, where they share none") {
    const std::vector<float> inverse_bind = {0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 1,
                                             0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 0.1F, 0, 0, 0, 0, 1};
    glb.json["skins"].push_back({{"joints", {4, 5}}, {"inverseBindMatrices", glb.accessor(inverse_bind, "MAT4")}});
    glb.json["nodes"].push_back({{"name", "other"}, {"translation", {7, 0, 0}}, {"children", {5}}});
    glb.json["nodes"].push_back({{"name", "other's"}, {"translation", {0, 0, 1}}});
    glb.json["nodes"].push_back({{"mesh", mesh}, {"skin", 1}});
    glb.json["scenes"][0]["nodes"] = {0, 3, 4, 6};
    CHECK((read(glb).positions[16] - Vec3(7 - 0.1, 3.9, -0.1)).norm() < 1e-6);
  }
  SUBCASE("that they are in already, where one's joint hangs on the other's, whatever pose the file shows") {
    const std::vector<float> inverse_bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -4, 0, 1,
                                             1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -5, 0, 1};
    glb.json["skins"].push_back({{"joints", {4, 5}}, {"inverseBindMatrices", glb.accessor(inverse_bind, "MAT4")}});
    glb.json["nodes"][2]["children"] = {4};
    glb.json["nodes"].push_back({{"translation", {0, 2, 0}}, {"rotation", {0.6, 0, 0, 0.8}}, {"children", {5}}});
    glb.json["nodes"].push_back({{"translation", {0, 1, 0}}});
    glb.json["nodes"].push_back({{"mesh", mesh}, {"skin", 1}});
    glb.json["scenes"][0]["nodes"].push_back(6);
    const SourceMesh read_mesh = read(glb);
    CHECK((read_mesh.positions[16] - raw_positions(glb, primitive["attributes"]["POSITION"].get<int>())[0]).norm() <
          1e-6);
  }
  check_skinning(glb, 2);
}

TEST_CASE("skins that differ by rounding only leave the file's vertices as they are") {
  Glb glb = two_boxes();
  const float third = 1 / 3.0F;
  const auto bound_at = [&](float noise) {
    std::vector<float> m = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, third, 0,  0, 1,
                            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, third, -2, 0, 1};
    for (float& value : m) value *= 1 + noise;
    m[15] = m[31] = 1;
    return glb.accessor(m, "MAT4");
  };
  glb.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", bound_at(0)}},
                       {{"joints", {1, 2}}, {"inverseBindMatrices", bound_at(2e-7F)}}};
  glb.json["nodes"].push_back({{"mesh", 0}, {"skin", 1}});
  glb.json["scenes"][0]["nodes"].push_back(4);
  const SourceMesh mesh = read(glb);
  const std::vector<Vector3d> raw = raw_positions(glb, 0);
  REQUIRE(mesh.positions.size() == 32);
  for (std::size_t v = 0; v < 32; ++v) CHECK(mesh.positions[v] == raw[v % 16]);
  CHECK(mesh.rig.bones.size() == 2);
}

TEST_CASE("a rigid mesh below a joint is kept as an attachment, in the pose the skin is bound in") {
  Glb glb = two_boxes();
  const int sword = add_box(glb, 0, 0, 0);
  glb.json["nodes"].push_back({{"name", "grip"}, {"translation", {4, 1, 0}}, {"children", {5}}});
  glb.json["nodes"].push_back({{"name", "sword"}, {"mesh", sword}, {"scale", {0.5, 2, 0.5}}});
  glb.json["nodes"][2]["children"] = {4};
  const SourceMesh mesh = read(glb);
  CHECK(mesh.meshes == 2);
  REQUIRE(mesh.positions.size() == 24);
  for (const Node& node : mesh.rig.nodes) CHECK(node.is_attachment == (node.name == "sword"));
  CHECK((mesh.positions[16] - Vec3(4 - 0.5, 2 + 1 - 2, -0.5)).norm() < 1e-6);  // the joint is bound upright
  for (const std::size_t moved : {2U, 4U, 5U}) check_skinning(glb, moved);
}

TEST_CASE("a rigid mesh outside every skeleton is kept, and follows its node") {
  Glb glb = two_boxes();
  glb.json["nodes"][2].erase("rotation");
  const int hat = add_box(glb, 0, 0, 0);
  glb.json["nodes"].push_back({{"name", "hat"}, {"mesh", hat}, {"translation", {0, 5, 0}}});
  SUBCASE("in the scene") { glb.json["scenes"][0]["nodes"].push_back(4); }
  SUBCASE("beside the skeleton, under its turned and scaled parent") {
    glb.json["nodes"][3]["scale"] = {0.01, 0.01, 0.01};
    glb.json["nodes"][3]["rotation"] = {0.6, 0, 0, 0.8};
    glb.json["nodes"][3]["children"] = {1, 4};
    CHECK((read(glb).positions[16] - Vec3(-1, 4, -1)).norm() < 1e-5);
  }
  for (const Node& node : read(glb).rig.nodes) CHECK_FALSE(node.is_attachment);
  check_skinning(glb, 4);
}

TEST_CASE(
    "a file without skins is what its nodes show, each instance of a mesh, and has no rig unless something moves") {
  Glb glb;
  add_box(glb, 0, 0, 0);
  glb.json["nodes"] = {{{"mesh", 0}, {"children", {1}}, {"translation", {0, 3, 0}}},
                       {{"mesh", 0}, {"rotation", {0, 0, 0.6, 0.8}}, {"scale", {1, 2, 3}}, {"translation", {9, 0, 0}}},
                       {{"mesh", 0}, {"translation", {100, 0, 0}}}};
  SourceMesh mesh = read(glb);
  CHECK(mesh.meshes == 2);  // the third is in no scene
  CHECK(mesh.buffers.size() == 2);
  CHECK(mesh.rig.bones.empty());
  CHECK(mesh.rig.weights.empty());
  CHECK(mesh.metres_per_unit == 1);
  CHECK(mesh.up_hint == Vec3::UnitY());
  Glb shown = glb;
  shown.json["nodes"].erase(2);
  check_same(mesh.positions, world_positions(shown));
  // A clip that turns a node makes the pieces bones.
  shown.json["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}},
                               {"samplers",
                                {{{"input", shown.accessor(std::vector<float>{0, 1}, "SCALAR")},
                                  {"output", shown.accessor(std::vector<float>{0, 0, 0, 1, 1, 0, 0, 0}, "VEC4")}}}}}};
  CHECK(read(shown).rig.bones.size() == 2);
  check_skinning(shown, 0);
  check_skinning(shown, 1);
  glb.json.erase("scenes");
  glb.json.erase("scene");
  CHECK(read(glb).meshes == 3);  // without scenes, all roots
}

TEST_CASE("triangles turn with a mirror in what is applied to them, and only there") {
  Glb glb = two_boxes();
  glb.json["nodes"][0]["scale"] = {-1, 1, 1};  // a skinned mesh's own node does nothing
  CHECK(signed_volume(read(glb)) == doctest::Approx(16));
  glb.json["nodes"][3]["scale"] = {-1, 1, 1};  // nor what moves the skeleton
  CHECK(signed_volume(read(glb)) == doctest::Approx(16));
  Glb rigid;
  add_box(rigid, 3, 0, 0);
  rigid.json["nodes"] = {{{"mesh", 0}, {"scale", {-1, 2, 1}}, {"children", {1}}}, {{"mesh", 0}, {"scale", {1, 1, -1}}}};
  CHECK(signed_volume(read(rigid)) == doctest::Approx(32));
}

TEST_CASE("a mesh on a node of no size, and one bound by a matrix of zeros, come in and follow nothing or the joint") {
  Glb glb = two_boxes();
  const int flat = add_box(glb, 0, 0, 0);
  glb.json["nodes"].push_back({{"mesh", flat}, {"scale", {1, 0, 1}}});
  glb.json["scenes"][0]["nodes"].push_back(4);
  const SourceMesh mesh = read(glb);
  REQUIRE(mesh.positions.size() == 24);
  CHECK(mesh.rig.weights[20].weight[0] == 0);
  glb.json["skins"][0]["joints"] = {1, 2, 3};
  std::vector<float> matrices(48, 0);
  matrices[15] = matrices[31] = matrices[47] = 1;
  for (const std::size_t i : {16U, 21U, 26U}) matrices[i] = 1;
  glb.json["skins"][0]["inverseBindMatrices"] = glb.accessor(matrices, "MAT4");
  CHECK(read(glb).positions.size() == 24);
}
