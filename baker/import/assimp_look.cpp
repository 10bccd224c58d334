// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/assimp_look.h"

#include <assimp/material.h>

#include <algorithm>
#include <map>

#include "baker/import/named_file.h"
#include "baker/import/srgb.h"

namespace spherechain::baker {
namespace {

// Embedded ones of texels have no file's bytes: they are left out.
std::string picture_bytes(const aiScene& scene, const std::string& name, const std::filesystem::path& folder) {
  if (const aiTexture* inside = scene.GetEmbeddedTexture(name.c_str()); inside != nullptr) {
    if (inside->mHeight != 0 || inside->pcData == nullptr || inside->mWidth > kPictureBytesMax) return {};
    return {reinterpret_cast<const char*>(inside->pcData), inside->mWidth};
  }
  return read_picture(named_picture(folder, name).path);
}

// A mesh's texture coordinates are those of its material.
struct Texture {
  SkinMaterial material;
  unsigned set = 0;
};

class Reader {
 public:
  Reader(const aiScene& scene, const std::filesystem::path& folder) : scene_(scene), folder_(folder) {}

  Texture read(const aiMaterial& material) {
    Texture out;
    aiColor3D colour(1, 1, 1);
    if (material.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) material.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    const std::array<float, 3> channels{colour.r, colour.g, colour.b};
    // Blender, which most such files come from, writes them linear. A picture takes the colour's place in these
    // formats.
    for (std::size_t k = 0; k < 3; ++k) out.material.colour[k] = to_srgb(channels[k]);
    for (const aiTextureType type : {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}) {
      aiString name;
      if (material.GetTexture(type, 0, &name, nullptr, &out.set) != aiReturn_SUCCESS) continue;
      const auto [known, is_new] = pictures_.try_emplace(name.C_Str());
      if (is_new) known->second = look.add_picture(picture_bytes(scene_, name.C_Str(), folder_));
      out.material.picture = known->second;
      break;
    }
    return out;
  }

  SourceLook look;

 private:
  const aiScene& scene_;
  const std::filesystem::path& folder_;
  std::map<std::string, std::int32_t> pictures_;  // by name
};

}  // namespace

SourceLook read_look(const aiScene& scene, const AssimpScene& flat, const std::filesystem::path& folder) {
  Reader reader(scene, folder);
  std::vector<Texture> textures;
  for (unsigned m = 0; m < scene.mNumMaterials && m < kNoMaterial; ++m) {
    textures.push_back(reader.read(*scene.mMaterials[m]));
    reader.look.materials.push_back(textures.back().material);
  }
  SourceLook& out = reader.look;
  for (const MeshInstance& instance : flat.instances) {
    const aiMesh& mesh = *instance.mesh;
    const bool has = mesh.mMaterialIndex < textures.size();
    const unsigned set = has ? textures[mesh.mMaterialIndex].set : 0;
    const aiVector3D* uvs = set < AI_MAX_NUMBER_OF_TEXTURECOORDS ? mesh.mTextureCoords[set] : nullptr;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      // Assimp's v goes up.
      out.uvs.push_back(uvs != nullptr ? std::array{uvs[v].x, 1 - uvs[v].y} : std::array{0.0F, 0.0F});
    }
    const auto triangles = std::count_if(mesh.mFaces, mesh.mFaces + mesh.mNumFaces,
                                         [](const aiFace& face) { return face.mNumIndices == 3; });
    out.material_of.insert(out.material_of.end(), static_cast<std::size_t>(triangles),
                           has ? static_cast<std::uint16_t>(mesh.mMaterialIndex) : kNoMaterial);
  }
  return std::move(out);
}

}  // namespace spherechain::baker
