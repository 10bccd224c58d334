// SPDX-License-Identifier: GPL-3.0-or-later
// The base colours of a source, for who looks at it: nothing that is wrong with them stops anything.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "baker/import/import.h"
#include "baker/page/page_look.h"
#include "baker/page/shrink_picture.h"
#include "glb_writer.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

// An uncompressed TGA of one colour: a picture that browsers do not know.
std::string tga(int width, int height, std::array<int, 3> rgb = {255, 0, 0}) {
  std::string out(18, '\0');
  out[2] = 2;
  out[12] = static_cast<char>(width & 255);
  out[13] = static_cast<char>(width >> 8);
  out[14] = static_cast<char>(height & 255);
  out[15] = static_cast<char>(height >> 8);
  out[16] = 24;
  for (int i = 0; i < width * height; ++i) {
    for (const std::size_t k : {2, 1, 0}) out.push_back(static_cast<char>(rgb[k]));
  }
  return out;
}

// Two triangles, each a primitive of its own: of material 0 and 1, the first with texture coordinates.
Glb two_materials(const json& materials) {
  Glb glb;
  const int positions = glb.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"),
            uvs = glb.accessor(std::vector<float>{0, 0, 2, 0, 0, 0.5}, "VEC2");
  glb.json["meshes"] = {{{"primitives",
                          {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}, {"material", 0}},
                           {{"attributes", {{"POSITION", positions}}}, {"material", 1}}}}}};
  glb.json["nodes"] = {{{"mesh", 0}}};
  glb.json["materials"] = materials;
  const std::string bytes = tga(4, 2);
  glb.json["images"] = {
      {{"bufferView", glb.view(std::vector<char>(bytes.begin(), bytes.end()))}, {"mimeType", "image/png"}},
      {{"uri", "beside%20it.tga"}}};
  glb.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 9}}, {{"source", "x"}}};
  return glb;
}

json material(const json& texture, const json& colour) {
  return {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}, {"baseColorFactor", colour}}}};
}

SourceLook look_of(const TemporaryFolder& folder, const Glb& glb) {
  ImportOptions options;
  options.look = true;
  return read_source(folder.write("a.glb", glb.bytes()), options).look;
}

}  // namespace

TEST_CASE("a glTF's base colours come with its vertices and triangles, from inside it and beside it") {
  const TemporaryFolder folder;
  folder.write("beside it.tga", tga(2, 2));
  Glb glb = two_materials({material(0, {1, 1, 1, 1}), material(1, {0, 1, 0.5, 1})});
  glb.json["materials"][0]["alphaMode"] = "MASK";
  const SourceLook look = look_of(folder, glb);
  CHECK(look.material_of == std::vector<std::uint16_t>{0, 1});
  CHECK(look.uvs == std::vector<std::array<float, 2>>{{0, 0}, {2, 0}, {0, 0.5}, {0, 0}, {0, 0}, {0, 0}});
  REQUIRE(look.materials.size() == 2);
  CHECK(look.materials[0].picture == 0);
  CHECK(look.materials[0].cut == 0.5F);
  CHECK(look.materials[1].picture == 1);
  CHECK(look.materials[1].colour == std::array{0.0F, 1.0F, look.materials[1].colour[2]});
  CHECK(look.pictures == std::vector<std::string>{tga(4, 2), tga(2, 2)});
  CHECK(read_source(folder.path / "a.glb").look.materials.empty());  // not asked for
}

TEST_CASE("whatever is wrong with a material, the mesh is read and its colour stays") {
  const TemporaryFolder folder;
  for (const json& texture : {json(1), json(2), json(3), json(99), json(-1), json("no"), json(json::array())}) {
    const SourceLook look = look_of(folder, two_materials({material(texture, {0, 0, 0, 1}), {{"name", 5}}}));
    REQUIRE(look.material_of.size() == 2);
    const nlohmann::ordered_json page = page_look(look);
    CHECK(page["pictures"].empty());
    CHECK(page["materials"][0]["colour"] == "#000000");
    CHECK(page["materials"][1]["colour"] == "#ffffff");
  }
  for (const json& materials : {json(5), json{5, "x"}, json::object(), json{material(0, "red"), nullptr}}) {
    CHECK(look_of(folder, two_materials(materials)).uvs.size() == 6);
  }
  Glb glb = two_materials({material(0, {1, 1, 1, 1}), json::object()});
  glb.json["images"][0]["bufferView"] = 3;
  CHECK(page_look(look_of(folder, glb))["pictures"].empty());
}

TEST_CASE("pictures are scaled down, and damaged ones are left out") {
  // A PNG's head of 512 x 256 pixels.
  CHECK(
      shrink_picture(tga(1024, 512), 512, true).starts_with("data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAgAAAAEA"));
  CHECK(shrink_picture(tga(64, 64), 512, false).starts_with("data:image/"));
  const std::string whole = tga(64, 64);
  CHECK(shrink_picture(whole, 512, false) == shrink_picture(whole, 512, false));
  for (const std::string& bytes : {std::string(), std::string("no picture"), std::string(5000, '\xff'),
                                   std::string("\x89PNG\r\n\x1a\n"), tga(30000, 1).substr(0, 18)}) {
    CHECK(shrink_picture(bytes, 512, false).size() < 3000);
  }
}
