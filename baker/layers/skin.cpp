// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/skin.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

struct Material {
  bool is_opaque = true, is_two_sided = false;
};

Material read_material(const ordered_json& gltf, const PrimitiveRun& run) {
  const ordered_json& primitive = gltf["meshes"][run.mesh]["primitives"][run.primitive];
  if (!primitive.contains("material")) return {};
  const ordered_json& material = gltf["materials"][primitive["material"].get<std::size_t>()];
  const ordered_json extensions = material.value("extensions", ordered_json::object());
  return {material.value("alphaMode", "OPAQUE") == "OPAQUE" && !extensions.contains("KHR_materials_transmission"),
          material.value("doubleSided", false)};
}

// The number of triangles that the importer made of a primitive.
Index count_triangles(const ordered_json& gltf, const ordered_json& primitive) {
  const int mode = primitive.value("mode", 4);
  if (mode < 4 || !primitive["attributes"].contains("POSITION")) return 0;
  const ordered_json& accessor =
      primitive.contains("indices") ? primitive["indices"] : primitive["attributes"]["POSITION"];
  const auto corners = gltf["accessors"][accessor.get<std::size_t>()]["count"].get<Index>();
  if (mode == 4) return corners / 3;
  return corners < 3 ? 0 : corners - 2;
}

// Vertices at one position become one.
Mesh weld(const Character& character) {
  Mesh out{character.skin.positions, character.source_triangles};
  std::vector<Index> welded = character.skin_of_source;
  for (Index v = 0; v < welded.size(); ++v) {
    if (welded[v] != kNoIndex) continue;
    welded[v] = static_cast<Index>(out.positions.size());  // only triangles that the import dropped use it
    out.positions.push_back(character.source_positions[v]);
  }
  for (Triangle& triangle : out.triangles) {
    for (Index& corner : triangle) corner = welded[corner];
  }
  return out;
}

}  // namespace

std::vector<PrimitiveRun> primitive_runs(const Character& character, const ordered_json& gltf) {
  std::vector<PrimitiveRun> runs;
  Index first = 0;
  const auto add = [&](std::size_t mesh, std::size_t primitive, Index count) {
    runs.push_back({mesh, primitive, first, count});
    first += count;
  };
  if (character.report.importer == "tinygltf") {
    for (const SourceBuffer& buffer : character.buffers) add(buffer.mesh, buffer.primitive, buffer.triangle_count);
  } else {
    for (std::size_t m = 0; m < gltf["meshes"].size(); ++m) {
      const ordered_json& primitives = gltf["meshes"][m]["primitives"];
      for (std::size_t p = 0; p < primitives.size(); ++p) add(m, p, count_triangles(gltf, primitives[p]));
    }
  }
  const bool is_same = std::all_of(runs.begin(), runs.end(), [&](const PrimitiveRun& run) {
    return run.count == count_triangles(gltf, gltf["meshes"][run.mesh]["primitives"][run.primitive]);
  });
  if (!is_same || first != character.source_triangles.size()) {
    throw Error(ExitCode::kFile, character.file + ": changed while it was read (run it again)");
  }
  return runs;
}

std::string run_name(const PrimitiveRun& run, const ordered_json& gltf) {
  const ordered_json& mesh = gltf["meshes"][run.mesh];
  const std::string own = mesh.value("name", "meshes[" + std::to_string(run.mesh) + "]");
  if (mesh["primitives"].size() < 2) return own;
  const ordered_json& primitive = mesh["primitives"][run.primitive];
  const std::string numbered = own + "[" + std::to_string(run.primitive) + "]";
  if (!primitive.contains("material")) return numbered;
  return gltf["materials"][primitive["material"].get<std::size_t>()].value("name", numbered);
}

LayeredSkin make_layered_skin(const Character& character, const std::vector<PrimitiveRun>& runs,
                              const ordered_json& gltf) {
  LayeredSkin skin;
  skin.rest = {character.source_positions, character.source_triangles};
  skin.welded = weld(character);
  Components pieces = connected_components(skin.welded);
  skin.piece = std::move(pieces.of_triangle);
  skin.piece_count = pieces.count;
  for (const PrimitiveRun& run : runs) {
    const Material material = read_material(gltf, run);
    skin.run.insert(skin.run.end(), run.count, static_cast<Index>(&run - runs.data()));
    skin.is_opaque.insert(skin.is_opaque.end(), run.count, material.is_opaque);
    skin.is_two_sided.insert(skin.is_two_sided.end(), run.count, material.is_two_sided);
  }
  skin.up = character.up_hint.normalized();
  const auto [lowest, highest] =
      std::minmax_element(skin.rest.positions.begin(), skin.rest.positions.end(),
                          [&](const Vec3& a, const Vec3& b) { return a.dot(skin.up) < b.dot(skin.up); });
  skin.height = (*highest - *lowest).dot(skin.up);
  return skin;
}

}  // namespace spherechain::baker
