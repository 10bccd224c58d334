// SPDX-License-Identifier: GPL-3.0-or-later
// Files of other formats as binary glTFs: the same character, in the same poses.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "baker/import/import.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/motion/motion.h"
#include "glb_writer.h"
#include "human.h"
#include "temporary_folder.h"
#include "tool.h"
#include "two_shapes.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

std::pair<json, std::string> parts_of_glb(const std::string& glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, 4);
  const std::size_t end = 20 + size;
  return {json::parse(glb.substr(20, size)), end < glb.size() ? glb.substr(end + 8) : ""};
}

Character read_back(const std::string& glb) {
  const TemporaryFolder folder;
  return import_character(folder.write("out.glb", glb));
}

Affine first_bone_at_rest(const Character& c) {
  const Bone& bone = c.rig.bones.front();
  return c.rig.to_rest * world_of(c.rig.nodes)[bone.node] * bone.inverse_bind;
}

std::vector<Vec3> pose_of(const Character& c, std::size_t clip, double seconds) {
  const Deformation pose = sample(c.rig, c.rig.clips[clip], seconds);
  return deform(morph(c.source_positions, c.rig.morphs, pose.morphs), c.rig.weights, pose.bones);
}

// The farthest that a vertex of one is from where the other has it, in parts of the size, in frames of a clip. Where a
// reader puts the skeleton's rest pose is its own affair.
double apart(const Character& a, const Character& b, std::size_t clip) {
  const Affine to_a = first_bone_at_rest(a) * first_bone_at_rest(b).inverse();
  Eigen::AlignedBox3d box;
  for (const Vec3& p : a.source_positions) box.extend(p);
  double most = 0;
  for (const double t : {0.0, 0.3, 0.5, 0.77, 1.0}) {
    const double seconds = t * a.rig.clips[clip].duration;
    const std::vector<Vec3> there = pose_of(a, clip, seconds), here = pose_of(b, clip, seconds);
    for (std::size_t v = 0; v < there.size(); ++v) most = std::max(most, (there[v] - to_a * here[v]).norm());
  }
  return most / box.diagonal().norm();
}

void check_same(const Character& before, const Character& after) {
  CHECK(after.source_positions == before.source_positions);
  CHECK(after.source_triangles == before.source_triangles);
  CHECK(after.metres_per_unit == doctest::Approx(before.metres_per_unit).epsilon(1e-4));
  REQUIRE(after.rig.morphs.size() == before.rig.morphs.size());
  for (std::size_t m = 0; m < before.rig.morphs.size(); ++m)
    CHECK(after.rig.morphs[m].name == before.rig.morphs[m].name);
  REQUIRE(after.rig.bones.size() == before.rig.bones.size());
  for (std::size_t b = 0; b < before.rig.bones.size(); ++b) {
    const Node &was = before.rig.nodes[before.rig.bones[b].node], &is = after.rig.nodes[after.rig.bones[b].node];
    if (is.in_file != was.in_file) continue;  // bound twice
    CHECK(is.name == was.name);
  }
  REQUIRE(after.rig.clips.size() == before.rig.clips.size());
  for (std::size_t c = 0; c < before.rig.clips.size(); ++c) {
    const Clip &was = before.rig.clips[c], &is = after.rig.clips[c];
    CAPTURE(was.name);
    CHECK(is.name == was.name);
    CHECK(is.in_file == was.in_file);
    CHECK(rate_of(is) == rate_of(was));
    CHECK(is.duration == doctest::Approx(was.duration));
    CHECK(apart(before, after, c) < 1e-5);
  }
}

void check_converted(const std::filesystem::path& path) {
  CAPTURE(path);
  check_same(import_character(path), read_back(read_as_glb(path)));
}

// A box on two joints, with two morph targets and a picture, in centimetres; its buffer, or that and its picture, lie
// beside it.
Glb morphing_box() {
  Glb glb;
  const Shape shape = box(1, 2, 1);
  std::vector<float> positions, up, wide, weights, uvs;
  std::vector<std::uint8_t> joints;
  for (const auto& p : shape.positions) {
    for (const double x : p) positions.push_back(static_cast<float>(100 * x));
    const bool top = p[1] > 1;
    up.insert(up.end(), {0, top ? 30.0F : 0.0F, 0});
    wide.insert(wide.end(), {p[0] > 0 ? 20.0F : 0.0F, 0, 0});
    weights.insert(weights.end(), {top ? 0.75F : 1.0F, top ? 0.25F : 0.0F, 0, 0});
    joints.insert(joints.end(), {static_cast<std::uint8_t>(top ? 1 : 0), static_cast<std::uint8_t>(top ? 0 : 1), 0, 0});
    uvs.insert(uvs.end(), {static_cast<float>(p[0]), static_cast<float>(p[1])});
  }
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : shape.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  glb.json["meshes"] = {
      {{"name", "box"},
       {"primitives",
        {{{"attributes",
           {{"POSITION", glb.accessor(positions, "VEC3")},
            {"TEXCOORD_0", glb.accessor(uvs, "VEC2")},
            {"JOINTS_0", glb.accessor(joints, "VEC4")},
            {"WEIGHTS_0", glb.accessor(weights, "VEC4")}}},
          {"indices", glb.accessor(corners, "SCALAR")},
          {"material", 0},
          {"targets", {{{"POSITION", glb.accessor(up, "VEC3")}}, {{"POSITION", glb.accessor(wide, "VEC3")}}}}}}},
       {"extras", {{"targetNames", {"up", "wide"}}}}}};
  const std::vector<float> binds{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,    0, 1,
                                 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -100, 0, 1};
  glb.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", glb.accessor(binds, "MAT4")}}};
  glb.json["nodes"] = {{{"name", "all"}, {"children", {1, 3}}, {"scale", {0.01, 0.01, 0.01}}},
                       {{"name", "low"}, {"children", {2}}},
                       {{"name", "high"}, {"translation", {0, 100, 0}}},
                       {{"name", "skin"}, {"mesh", 0}, {"skin", 0}}};
  const int times = glb.accessor(std::vector<float>{0, 1, 2}, "SCALAR");
  const float s = std::sqrt(0.5F);
  const int turn = glb.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, s, s, 0, s, 0, s}, "VEC4"),
            move = glb.accessor(std::vector<float>{0, 0, 0, 50, 10, 0, 0, 0, 0}, "VEC3"),
            grow = glb.accessor(std::vector<float>{0, 0, 1, 0.5, 0, 1}, "SCALAR");
  glb.json["animations"] = {{{"name", "bend"},
                             {"samplers",
                              {{{"input", times}, {"output", turn}},
                               {{"input", times}, {"output", move}},
                               {{"input", times}, {"output", grow}}}},
                             {"channels",
                              {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                               {{"sampler", 1}, {"target", {{"node", 1}, {"path", "translation"}}}},
                               {{"sampler", 2}, {"target", {{"node", 3}, {"path", "weights"}}}}}}}};
  glb.json["materials"] = {{{"name", "paint"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  glb.json["textures"] = {{{"source", 0}}};
  glb.json["images"] = {{{"uri", "a%20b.png"}}};
  return glb;
}

const std::string kPng = "\x89PNG\r\n\x1A\nnot all of it";

}  // namespace

TEST_CASE("as glb: a character of another format has the same skin, and in each clip the same poses" *
          doctest::test_suite("many bakes")) {
  for (const char* file : {"FBX/huesitos.fbx", "FBX/animation_with_skeleton.fbx", "X/Testwuson.X", "X/BCN_Epileptic.X",
                           "MDL/MDL (HL1)/man.mdl", "Collada/box_nested_animation.dae", "ASE/anim.ASE"}) {
    check_converted(kModels / file);
  }
}

TEST_CASE("characters of SPHERECHAIN_TEST_DATA as glb stay who they are") {
  const char* folder = std::getenv("SPHERECHAIN_TEST_DATA");
  if (folder == nullptr) return;
  for (const char* file : {"quaternius_dragon.fbx", "ninja_ogre/ninja.mesh.xml", "cesium_man_khronos.gltf"}) {
    check_converted(std::filesystem::path(folder) / file);
  }
}

TEST_CASE("as glb: morph targets, their tracks, names, pictures and centimetres go through") {
  const TemporaryFolder folder;
  folder.write("ab.png", kPng);
  Glb box = morphing_box();
  box.json["images"][0]["uri"] = "ab.png";
  const auto path = folder.write("box.glb", box.bytes());
  const std::string glb = glb_with_assimp(path);
  const Character before = build_character(read_with_assimp(path), "box.glb"), after = read_back(glb);
  REQUIRE(before.rig.morphs.size() == 2);
  REQUIRE(before.rig.clips.size() == 1);
  check_same(before, after);
  CHECK((pose_of(after, 0, 1)[0] - pose_of(after, 0, 0)[0]).norm() > 0.1);
  const auto [json, binary] = parts_of_glb(glb);
  REQUIRE(json.contains("images"));
  CHECK(json["materials"][0]["name"] == "paint");
  CHECK(json["meshes"][0]["name"].get<std::string>().starts_with("box"));
  const auto view = json["bufferViews"][json["images"][0]["bufferView"].get<std::size_t>()];
  CHECK(binary.substr(view["byteOffset"], view["byteLength"]) == kPng);
}

TEST_CASE("as glb: a file in centimetres with Z up stands upright in metres") {
  const TemporaryFolder folder;
  std::string fbx = tool::contents(kModels / "FBX/cubes_with_names.fbx");
  const std::string y_up = "\"UpAxis\", \"int\", \"Integer\", \"\",1";
  REQUIRE(fbx.find(y_up) != std::string::npos);
  fbx[fbx.find(y_up) + y_up.size() - 1] = '2';
  const auto path = folder.write("z_up.fbx", fbx);
  const Character before = import_character(path), after = read_back(read_as_glb(path));
  REQUIRE(before.up_hint == Vec3::UnitZ());
  REQUIRE(after.source_positions.size() == before.source_positions.size());
  for (std::size_t v = 0; v < before.source_positions.size(); ++v) {
    const Vec3& p = before.source_positions[v];
    CHECK(after.source_positions[v].isApprox(before.metres_per_unit * Vec3(p.x(), p.z(), -p.y()), 1e-6));
  }
}

TEST_CASE("as glb: a glTF and the files beside it become one, and nothing else of it changes") {
  const TemporaryFolder folder;
  Glb box = morphing_box();
  folder.write("a b.png", kPng);
  // Two buffers.
  json gltf = json::parse(box.text());
  const std::size_t cut = gltf["bufferViews"][3]["byteOffset"];
  folder.write("box.bin", box.binary.substr(0, cut));
  folder.write("rest.bin", box.binary.substr(cut));
  for (json& view : gltf["bufferViews"]) {
    const std::size_t at = view["byteOffset"];
    view["buffer"] = at < cut ? 0 : 1;
    view["byteOffset"] = at < cut ? at : at - cut;
  }
  gltf["buffers"] = {{{"uri", "box.bin"}, {"byteLength", cut}},
                     {{"uri", "rest.bin"}, {"byteLength", box.binary.size() - cut}}};
  gltf["extras"] = {{"mine", {1, 2}}};
  const auto path = folder.write("box.gltf", gltf.dump());
  const std::string glb = read_as_glb(path);
  const auto [json, binary] = parts_of_glb(glb);
  CHECK(binary.starts_with(box.binary));
  CHECK(json["bufferViews"].size() == gltf["bufferViews"].size() + 1);
  CHECK(json["images"][0]["mimeType"] == "image/png");
  REQUIRE(json.contains("extras"));
  for (const char* same : {"nodes", "meshes", "skins", "animations", "materials", "accessors", "extras"})
    CHECK(json[same] == gltf[same]);
  check_same(import_character(path), read_back(glb));
  CHECK(read_back(glb).rig.clips[0].in_file == 0);

  // A file without others stays byte for byte, and a missing picture stays a name.
  box.json.erase("images");
  CHECK(read_as_glb(folder.write("one.glb", box.bytes())) == box.bytes());
  std::filesystem::remove(folder.path / "a b.png");
  CHECK(parts_of_glb(read_as_glb(path)).first["images"][0]["uri"] == "a%20b.png");
  std::filesystem::remove(folder.path / "rest.bin");
  CHECK_THROWS_WITH_AS(read_as_glb(path), doctest::Contains("rest.bin"), Error);
}

TEST_CASE("as glb: no file outside the folder is read, however a glTF names it") {
  const TemporaryFolder folder;
  namespace fs = std::filesystem;
  const Glb box = morphing_box();
  const std::string secret = "SECRET" + box.binary, picture = kPng + "SECRET";
  folder.write("out.bin", secret);
  folder.write("out.png", picture);
  const fs::path inside = folder.path / "in";
  fs::create_directories(inside / "sub");
  folder.write("in/sub/box.bin", box.binary);
  folder.write("in/a b.png", kPng);
  for (const char* ending : {"bin", "png"}) {
    const std::string name = std::string("out.") + ending;
    fs::create_symlink(folder.path / name, inside / (std::string("link.") + ending));
  }
  fs::create_directory_symlink(folder.path, inside / "up");
  fs::create_symlink("sub/box.bin", inside / "own.bin");
  const auto glb_with = [&](const std::string& buffer, const std::string& image) {
    Glb one = box;
    one.json["images"] = {{{"uri", image}}};
    return read_as_glb(folder.write("in/box.gltf", one.text(buffer)));
  };
  take_notes();
  for (const char* good : {"sub/box.bin", "sub%2Fbox.bin", "sub\\box.bin", "./sub/../sub/box.bin", "own.bin"}) {
    CAPTURE(good);
    CHECK(parts_of_glb(glb_with(good, "a%20b.png")).second.starts_with(box.binary));
    CHECK(take_notes().empty());
  }
  const std::string absolute = (folder.path / "out").string();
  for (const std::string& out :
       {std::string("../out"), std::string("%2e%2E/out"), std::string("..%2fout"), std::string("..\\out"),
        std::string("%2e.%5Cout"), std::string("sub/../../out"), absolute, "file://" + absolute, "file:" + absolute,
        std::string("link"), std::string("up/out"), std::string("sub/../up/out"), std::string("C:\\out"),
        std::string("\\\\host\\out"), std::string("https://host/out")}) {
    CAPTURE(out);
    CHECK_THROWS_WITH_AS(glb_with(out + ".bin", "a%20b.png"), doctest::Contains(out.c_str()), Error);
    // A picture is no reason to refuse a character.
    CHECK(glb_with("sub/box.bin", out + ".png").find("SECRET") == std::string::npos);
    read_source(inside / "box.gltf");
    const std::vector<std::string> notes = take_notes();
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find(out) != std::string::npos);
  }
  CHECK_THROWS_WITH_AS(glb_with("sub/box.bin%00", "a%20b.png"), doctest::Contains("zero byte"), Error);
}

TEST_CASE("as glb: other formats read materials and pictures from their folder alone, by the end of a foreign path") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path / "in/tex");
  folder.write("out.mtl", "newmtl skin\nKd 0 1 0\n");
  folder.write("out.png", kPng + "SECRET");
  folder.write("in/tex/skin.png", kPng + "in tex");
  const auto glb_with = [&](const std::string& library, const std::string& picture) {
    folder.write("in/a.mtl", "newmtl skin\nmap_Kd " + picture + "\n");
    return read_as_glb(folder.write("in/a.obj", "mtllib " + library +
                                                    "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nusemtl skin\n"
                                                    "f 1/1 2/1 3/1\nf 1/1 2/1 4/1\n"));
  };
  for (const char* named :
       {"tex/skin.png", "C:\\art\\hero\\tex\\skin.png", "/home/artist/tex/skin.png", "../tex/skin.png"})
    CHECK(glb_with("a.mtl", named).find("in tex") != std::string::npos);
  for (const std::string& named : {std::string("../out.png"), (folder.path / "out.png").string()}) {
    CHECK(glb_with("a.mtl", named).find("SECRET") == std::string::npos);
    take_notes();
    read_source(folder.path / "in/a.obj");
    const std::vector<std::string> notes = take_notes();
    REQUIRE(notes.size() == 1);
    CHECK(notes[0].find(named) != std::string::npos);
  }
  glb_with("../out.mtl", "tex/skin.png");
  read_source(folder.path / "in/a.obj");
  const std::vector<std::string> notes = take_notes();
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("../out.mtl") != std::string::npos);
}

TEST_CASE("as glb: a picture that glTF does not have becomes one that it has; a colour stays the colour") {
  const TemporaryFolder folder;
  folder.write("red.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0\0\0\xFF", 21));
  folder.write("a.mtl", "newmtl skin\nKd 1 1 1\nmap_Kd red.tga\nnewmtl coat\nKd 0.5 0.25 0\n");
  const std::string glb = read_as_glb(folder.write(
      "a.obj",
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nusemtl skin\nf 1/1 2/1 3/1\nusemtl coat\nf 1 2 4\n"));
  const auto [json, binary] = parts_of_glb(glb);
  REQUIRE(json["images"].size() == 1);
  CHECK(json["images"][0]["mimeType"] == "image/png");
  CHECK(binary.find("\x89PNG") != std::string::npos);
  for (const auto& material : json["materials"]) {
    if (material["name"] != "coat") continue;
    const std::vector<double> colour = material["pbrMetallicRoughness"]["baseColorFactor"];
    CHECK(colour[0] == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(colour[1] == doctest::Approx(0.25).epsilon(1e-3));
    CHECK(colour[2] == doctest::Approx(0));
  }
  CHECK(read_back(glb).source_triangles.size() == 2);
}
