// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "baker/import/gltf_file.h"
#include "baker/import/look.h"

namespace spherechain::baker {

// Gathers the base colours of a glTF's primitives, in the order of the source's vertices and triangles. A colour that
// is wrong or not there stays white.
class GltfLook {
 public:
  GltfLook(const GltfFile& file, const std::filesystem::path& path);

  void add_vertices(const tinygltf::Primitive& primitive, std::size_t count);
  void add_triangles(const tinygltf::Primitive& primitive, std::size_t count);

  SourceLook look;

 private:
  // A texture of a material: its picture, and where on it a vertex is.
  struct Texture {
    std::int32_t picture = -1;
    int set = 0;  // of texture coordinates
    std::array<double, 2> offset{0, 0}, scale{1, 1};
    double turn = 0;
  };
  void read_material(const nlohmann::json& material);
  Texture read_texture(const nlohmann::json& info);
  std::int32_t picture_of(const nlohmann::json& image, std::size_t number);

  const GltfFile& file_;
  std::filesystem::path folder_;
  nlohmann::json json_;
  std::vector<Texture> textures_;                 // of the materials
  std::map<std::size_t, std::int32_t> pictures_;  // by the image's number
};

}  // namespace spherechain::baker
