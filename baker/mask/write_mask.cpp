// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mask/write_mask.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/mesh/error.h"
#include "baker/write/glb_mark.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr int kVertices = 34962, kCorners = 34963;  // targets of buffer views
constexpr int kByte = 5121, kShort = 5123, kInt = 5125;

using PrimitiveNumber = std::pair<std::size_t, std::size_t>;  // mesh, primitive

// The triangles of each primitive that are hidden wherever it is shown.
std::map<PrimitiveNumber, std::vector<char>> hidden_of_primitives(const std::vector<PrimitiveRun>& runs,
                                                                  const HiddenSkin& skin) {
  std::map<PrimitiveNumber, std::vector<char>> out;
  for (const PrimitiveRun& run : runs) {
    std::vector<char>& hidden = out.try_emplace({run.mesh, run.primitive}, run.count, 1).first->second;
    for (Index t = 0; t < run.count; ++t) hidden[t] = hidden[t] != 0 && skin.is_hidden[run.first + t] != 0;
  }
  return out;
}

bool any(const std::vector<char>& flags) { return std::find(flags.begin(), flags.end(), 1) != flags.end(); }

std::size_t size_of(const ordered_json& object, const char* key) { return object.value(key, std::size_t{0}); }

// The corners as the file lists them; of a primitive without indices its vertices in their order.
std::vector<std::uint32_t> read_corners(const GlbFile& glb, const std::string& file, const ordered_json& primitive) {
  const auto fail = [&](const char* what) { throw Error(ExitCode::kFile, file + ": " + what); };
  std::vector<std::uint32_t> out;
  if (!primitive.contains("indices")) {
    const ordered_json& positions = glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
    for (std::uint32_t v = 0; v < positions["count"]; ++v) out.push_back(v);
    return out;
  }
  const ordered_json& accessor = glb.json["accessors"][primitive["indices"].get<std::size_t>()];
  if (accessor.contains("sparse") || !accessor.contains("bufferView")) {
    fail("has sparse indices, which cannot be replaced (export it without, or take --as json)");
  }
  const ordered_json& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const int type = accessor["componentType"];
  const std::size_t width = type == kByte    ? 1
                            : type == kShort ? 2
                                             : 4,
                    count = accessor["count"], begin = size_of(view, "byteOffset") + size_of(accessor, "byteOffset");
  if (begin > glb.binary.size() || count > (glb.binary.size() - begin) / width) fail("has indices outside its buffer");
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t corner = 0;
    std::memcpy(&corner, glb.binary.data() + begin + i * width, width);
    out.push_back(corner);
  }
  return out;
}

// Corners by threes.
std::vector<std::uint32_t> read_triangles(const GlbFile& glb, const std::string& file, const ordered_json& primitive) {
  const std::vector<std::uint32_t> corners = read_corners(glb, file, primitive);
  const int mode = primitive.value("mode", 4);
  if (mode == 4) return {corners.begin(), corners.end() - static_cast<std::ptrdiff_t>(corners.size() % 3)};
  std::vector<std::uint32_t> out;
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    const std::array<std::size_t, 3> strip{i, i + 1 + i % 2, i + 2 - i % 2}, fan{i + 1, i + 2, 0};
    for (const std::size_t k : mode == 5 ? strip : fan) out.push_back(corners[k]);
  }
  return out;
}

std::size_t vertex_count(const GlbFile& glb, const ordered_json& primitive) {
  return glb.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"];
}

std::size_t add_corners(GlbFile& glb, const std::vector<std::uint32_t>& corners, std::size_t vertices) {
  if (vertices > std::numeric_limits<std::uint16_t>::max()) return glb.add_accessor(corners, "SCALAR", kCorners);
  return glb.add_accessor(std::vector<std::uint16_t>(corners.begin(), corners.end()), "SCALAR", kCorners);
}

void take_out(GlbFile& glb, const std::string& file, ordered_json& primitive, const std::vector<char>& hidden) {
  const std::vector<std::uint32_t> all = read_triangles(glb, file, primitive);
  std::vector<std::uint32_t> shown;
  for (std::size_t t = 0; t < hidden.size(); ++t) {
    if (hidden[t] == 0)
      shown.insert(shown.end(), all.begin() + static_cast<std::ptrdiff_t>(3 * t),
                   all.begin() + static_cast<std::ptrdiff_t>(3 * t + 3));
  }
  // A primitive is not empty in glTF, and without it others would have other numbers: it keeps a triangle without area.
  if (shown.empty()) shown.assign(3, all[0]);
  primitive["indices"] = add_corners(glb, shown, vertex_count(glb, primitive));
  primitive.erase("mode");
}

// 1 for a vertex that a shown triangle uses.
std::vector<float> shown_vertices(const GlbFile& glb, const std::string& file, const ordered_json& primitive,
                                  const std::vector<char>& hidden) {
  const std::vector<std::uint32_t> all = read_triangles(glb, file, primitive);
  std::vector<float> out(vertex_count(glb, primitive), 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (hidden[i / 3] == 0) out.at(all[i]) = 1;
  }
  return out;
}

void add_colours(GlbFile& glb, ordered_json& attributes, const std::vector<float>& shown) {
  std::vector<float> colours;
  for (const float s : shown) colours.insert(colours.end(), {s, s, s, 1});
  int set = 0;
  while (attributes.contains("COLOR_" + std::to_string(set))) ++set;
  attributes["COLOR_" + std::to_string(set)] = glb.add_accessor(colours, "VEC4", kVertices);
}

}  // namespace

std::vector<HiddenMesh> hidden_meshes(const ordered_json& gltf, const std::vector<PrimitiveRun>& runs,
                                      const HiddenSkin& skin) {
  std::map<std::size_t, HiddenMesh> meshes;
  for (const auto& [number, hidden] : hidden_of_primitives(runs, skin)) {
    HiddenMesh& mesh = meshes[number.first];
    mesh.name = gltf["meshes"][number.first].value("name", "meshes[" + std::to_string(number.first) + "]");
    for (const char is_hidden : hidden) {
      if (is_hidden != 0) mesh.hidden.push_back(mesh.triangles);
      ++mesh.triangles;
    }
  }
  std::vector<HiddenMesh> out;
  for (auto& [number, mesh] : meshes) out.push_back(std::move(mesh));
  return out;
}

void write_mask(GlbFile& glb, const std::string& file, const std::vector<PrimitiveRun>& runs, const HiddenSkin& skin,
                MaskForm form) {
  const std::map<PrimitiveNumber, std::vector<char>> primitives = hidden_of_primitives(runs, skin);
  std::set<std::size_t> masked;  // meshes
  for (const auto& [number, hidden] : primitives) {
    if (any(hidden)) masked.insert(number.first);
  }
  for (const auto& [number, hidden] : primitives) {
    const bool is_changed = form == MaskForm::kTriangles ? any(hidden) : masked.contains(number.first);
    if (!is_changed) continue;
    ordered_json primitive = glb.json["meshes"][number.first]["primitives"][number.second];
    if (form == MaskForm::kTriangles) {
      take_out(glb, file, primitive, hidden);
    } else {
      // All primitives of a mesh have the mask: programs that join them take a missing attribute for 0.
      const std::vector<float> shown = shown_vertices(glb, file, primitive, hidden);
      if (form == MaskForm::kAttribute) {
        primitive["attributes"]["_MASK"] = glb.add_accessor(shown, "SCALAR", kVertices);
      } else {
        add_colours(glb, primitive["attributes"], shown);
      }
    }
    glb.json["meshes"][number.first]["primitives"][number.second] = std::move(primitive);
  }
  mark_as_own(glb.json);
}

std::string mask_json(const std::vector<HiddenMesh>& meshes, const HiddenSkin& skin,
                      const std::vector<std::string>& clips) {
  const auto percent = [](double part, double whole) { return whole > 0 ? 100 * part / whole : 0; };
  std::string text = std::string("{\n \"writer\": \"") + kWriter + "\",\n \"meshes\": [";
  const auto dump = [](const ordered_json& json) {
    return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  };
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const ordered_json mesh{{"mesh", meshes[m].name}, {"triangles", meshes[m].triangles}, {"hidden", meshes[m].hidden}};
    text += (m > 0 ? ",\n  " : "\n  ") + dump(mesh);
  }
  text += "\n ],\n \"area_percent\": " + dump(percent(skin.hidden_area, skin.area)) + ",\n \"hidden_percent\": " +
          dump(percent(static_cast<double>(skin.hidden), static_cast<double>(skin.is_hidden.size()))) +
          ",\n \"clips\": " + dump(clips) + ",\n \"poke_removed_percent\": " +
          dump(skin.poke_area > 0 ? ordered_json(percent(skin.poke_hidden_area, skin.poke_area)) : ordered_json()) +
          "\n}\n";
  return text;
}

}  // namespace spherechain::baker
