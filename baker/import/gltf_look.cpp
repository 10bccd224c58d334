// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/gltf_look.h"

#include <algorithm>
#include <cmath>

#include "baker/import/srgb.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::json;

// An empty object where there is none of that name: all that is asked of it has its default then.
const json& member(const json& of, const char* key) {
  static const json none = json::object();
  return of.is_object() && of.contains(key) && of[key].is_object() ? of[key] : none;
}

double number(const json& of, const char* key, double otherwise) {
  return of.contains(key) && of[key].is_number() ? of[key].get<double>() : otherwise;
}

double entry(const json& of, const char* key, std::size_t i, double otherwise) {
  if (!of.contains(key) || !of[key].is_array() || i >= of[key].size() || !of[key][i].is_number()) return otherwise;
  return of[key][i].get<double>();
}

// The root's list `of`'s entry; null where there is none.
const json* at_index(const json& root, const char* of, const json& index) {
  if (!index.is_number_unsigned() || !root.contains(of) || !root[of].is_array()) return nullptr;
  const auto i = index.get<std::size_t>();
  return i < root[of].size() && root[of][i].is_object() ? &root[of][i] : nullptr;
}

}  // namespace

GltfLook::GltfLook(const GltfFile& file, const std::filesystem::path& path)
    : file_(file), folder_(path.parent_path()), json_(raw_json_of_gltf(path)) {
  if (!json_.is_object() || !json_.contains("materials") || !json_["materials"].is_array()) return;
  for (const json& material : json_["materials"]) {
    if (look.materials.size() == kNoMaterial) break;
    read_material(material);
  }
}

void GltfLook::read_material(const json& material) {
  // The older of the two ways has other names for the same.
  const json& old = member(member(material, "extensions"), "KHR_materials_pbrSpecularGlossiness");
  const json& pbr = old.empty() ? member(material, "pbrMetallicRoughness") : old;
  SkinMaterial out;
  for (std::size_t k = 0; k < 3; ++k)
    out.colour[k] = to_srgb(entry(pbr, old.empty() ? "baseColorFactor" : "diffuseFactor", k, 1));
  out.tint = out.colour;
  textures_.push_back(read_texture(member(pbr, old.empty() ? "baseColorTexture" : "diffuseTexture")));
  out.picture = textures_.back().picture;
  const json mode = material.is_object() ? material.value("alphaMode", json()) : json();
  if (mode == "MASK") out.cut = static_cast<float>(std::clamp(number(material, "alphaCutoff", 0.5), 0.0, 1.0));
  if (mode == "BLEND") out.cut = 0.5F;
  look.materials.push_back(out);
}

GltfLook::Texture GltfLook::read_texture(const json& info) {
  Texture out;
  const json* texture = info.contains("index") ? at_index(json_, "textures", info["index"]) : nullptr;
  if (texture == nullptr || !texture->contains("source")) return out;
  const json& source = (*texture)["source"];
  const json* image = at_index(json_, "images", source);
  if (image == nullptr) return out;
  out.picture = picture_of(*image, source.get<std::size_t>());
  const json& moved = member(member(info, "extensions"), "KHR_texture_transform");
  out.set = static_cast<int>(std::clamp(number(moved, "texCoord", number(info, "texCoord", 0)), 0.0, 99.0));
  for (std::size_t k = 0; k < 2; ++k) {
    out.offset[k] = entry(moved, "offset", k, 0);
    out.scale[k] = entry(moved, "scale", k, 1);
  }
  out.turn = number(moved, "rotation", 0);
  return out;
}

std::int32_t GltfLook::picture_of(const json& image, std::size_t number) {
  const auto [known, is_new] = pictures_.try_emplace(number);
  if (is_new) known->second = look.add_picture(picture_of_gltf(file_, image, folder_));
  return known->second;
}

void GltfLook::add_vertices(const tinygltf::Primitive& primitive, std::size_t count) {
  const std::size_t first = look.uvs.size();
  look.uvs.resize(first + count, {0, 0});
  const Texture texture = at(primitive.material) < textures_.size() ? textures_[at(primitive.material)] : Texture();
  const auto found = primitive.attributes.find("TEXCOORD_" + std::to_string(texture.set));
  if (texture.picture < 0 || found == primitive.attributes.end()) return;
  std::vector<double> uvs;
  try {
    constexpr int kByte = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, kShort = TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    uvs = file_.numbers(found->second, TINYGLTF_TYPE_VEC2, {TINYGLTF_COMPONENT_TYPE_FLOAT, kByte, kShort});
  } catch (const Error&) {
    return;
  }
  const double c = std::cos(texture.turn), s = std::sin(texture.turn);
  for (std::size_t v = 0; v < std::min(count, uvs.size() / 2); ++v) {
    const double x = texture.scale[0] * uvs[2 * v], y = texture.scale[1] * uvs[2 * v + 1];
    look.uvs[first + v] = {static_cast<float>(c * x + s * y + texture.offset[0]),
                           static_cast<float>(c * y - s * x + texture.offset[1])};
  }
}

void GltfLook::add_triangles(const tinygltf::Primitive& primitive, std::size_t count) {
  const bool has = at(primitive.material) < look.materials.size();
  look.material_of.insert(look.material_of.end(), count,
                          has ? static_cast<std::uint16_t>(primitive.material) : kNoMaterial);
}

}  // namespace spherechain::baker
