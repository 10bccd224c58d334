// SPDX-License-Identifier: GPL-3.0-or-later
#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <new>
#include <sstream>
#include <string_view>

#include "import/assimp_glb.h"
#include "import/assimp_look.h"
#include "import/assimp_scene.h"
#include "import/check_bvh.h"
#include "import/import.h"
#include "mesh/error.h"
#include "spherechain/asset.h"

namespace spherechain::baker {
namespace {

using Files = std::vector<std::string>;

void append(const MeshInstance& instance, const std::string& name, SourceMesh& out) {
  const aiMesh& mesh = *instance.mesh;
  const Index base = instance.first_vertex;
  out.buffers.push_back(
      {instance.number, 0, base, mesh.mNumVertices,
       sc_hash_positions(reinterpret_cast<const float*>(mesh.mVertices), mesh.mNumVertices, sizeof(aiVector3D))});
  for (unsigned v = 0; v < mesh.mNumVertices; ++v)
    out.positions.push_back(instance.placement * to_vec3(mesh.mVertices[v]));
  // A mirroring transform turns triangles inside out.
  const bool flip = instance.placement.linear().determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3) {
      ++out.points_and_lines_dropped;
      continue;
    }
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices) {
        throw Error(ExitCode::kFile, name + ": triangle " + std::to_string(f) + " of mesh '" + mesh.mName.C_Str() +
                                         "' uses vertex " + std::to_string(face.mIndices[k]) + " of " +
                                         std::to_string(mesh.mNumVertices));
      }
      t[k] = base + face.mIndices[k];
    }
    if (flip) std::swap(t[1], t[2]);
    out.triangles.push_back(t);
  }
  ++out.meshes;
}

// What a mesh's file names (its materials) is read where it is a file: assimp would wait for ever for a pipe's other
// end. The mesh's own file may go by an alias with another ending.
class FilesAlone : public Assimp::DefaultIOSystem {
 public:
  FilesAlone(std::string file, Files* opened) : file_(std::move(file)), opened_(opened) {}
  const std::string& alias(const std::string& ending) { return alias_ = file_ + "." + ending; }
  bool Exists(const char* path) const override {
    std::error_code ignored;
    return std::filesystem::is_regular_file(real(path), ignored);
  }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    if (!Exists(path)) return nullptr;
    if (opened_ != nullptr) opened_->push_back(real(path));
    return DefaultIOSystem::Open(real(path), mode);
  }

 private:
  const char* real(const char* path) const { return path == alias_ ? file_.c_str() : path; }

  std::string file_, alias_;
  Files* opened_;
};

bool has_content(const aiScene* scene) {
  return scene != nullptr && (scene->mNumMeshes > 0 || scene->mNumAnimations > 0);
}

bool recognises(Assimp::BaseImporter& format, const std::string& name, FilesAlone& files) {
  try {
    return format.CanRead(name, &files, true);
  } catch (const std::exception&) {
    return false;
  }
}

// Assimp goes by a file's ending. Where that leads to nothing, each format that recognises the content has its turn.
const aiScene* read_by_ending_or_content(Assimp::Importer& importer, FilesAlone& files, const std::string& name) {
  if (const aiScene* scene = importer.ReadFile(name, 0); has_content(scene)) return scene;
  for (std::size_t f = 0; f < importer.GetImporterCount(); ++f) {
    if (!recognises(*importer.GetImporter(f), files.alias(""), files)) continue;
    std::istringstream endings(importer.GetImporterInfo(f)->mFileExtensions);
    for (std::string ending; endings >> ending;) {
      if (const aiScene* scene = importer.ReadFile(files.alias(ending), 0); has_content(scene)) return scene;
    }
  }
  return importer.ReadFile(name, 0);  // for what it says of the ending's format
}

// Assimp's triangulation ends the program over a face without corners.
void check_faces(const aiScene& scene, const std::string& file) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      if (mesh.mFaces[f].mNumIndices > 0) continue;
      throw Error(ExitCode::kFile, file + ": face " + std::to_string(f) + " of mesh '" + mesh.mName.C_Str() +
                                       "' has no corners (the file is cut off, or its counts are wrong)");
    }
  }
}

// `opened` gets the names of the files that it takes, however it ends.
const aiScene* read_scene(Assimp::Importer& importer, const std::filesystem::path& path, Files* opened = nullptr) {
  check_bvh(path);
  const std::string name = path.string();
  auto* files = new FilesAlone(name, opened);
  importer.SetIOHandler(files);  // which the importer deletes
  // Sticks that importers put where a file has bones and no mesh are no character.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  const aiScene* scene = read_by_ending_or_content(importer, *files, name);
  // Assimp catches it and goes on.
  if (scene == nullptr && std::string_view(importer.GetErrorString()).find("bad_alloc") != std::string_view::npos) {
    throw std::bad_alloc();
  }
  if (scene == nullptr) return nullptr;
  check_faces(*scene, name);
  return importer.ApplyPostProcessing(aiProcess_Triangulate);
}

void add_pictures(const aiMaterial& material, const std::filesystem::path& folder, Files& files) {
  for (unsigned p = 0; p < material.mNumProperties; ++p) {
    const aiMaterialProperty& property = *material.mProperties[p];
    aiString name;
    if (std::string_view(property.mKey.C_Str()) != _AI_MATKEY_TEXTURE_BASE ||
        material.Get(_AI_MATKEY_TEXTURE_BASE, property.mSemantic, property.mIndex, name) != aiReturn_SUCCESS) {
      continue;
    }
    for (const std::filesystem::path& place : places_of_picture(name.C_Str(), folder)) files.push_back(place.string());
  }
}

SourceMesh source_of(const aiScene& scene, const AssimpScene& flat, const std::string& name) {
  SourceMesh out;
  out.importer = "assimp";
  for (const MeshInstance& instance : flat.instances) append(instance, name, out);
  out.rig = read_rig(scene, flat, name);
  // Formats without units are taken as metres. FBX says its own, in centimetres.
  double centimetres = 0;
  float centimetres_f = 0;
  if (scene.mMetaData != nullptr) {
    if (scene.mMetaData->Get("UnitScaleFactor", centimetres) && centimetres > 0)
      out.metres_per_unit = centimetres / 100;
    else if (scene.mMetaData->Get("UnitScaleFactor", centimetres_f) && centimetres_f > 0)
      out.metres_per_unit = static_cast<double>(centimetres_f) / 100;
    int axis = 1, sign = 1;
    if (scene.mMetaData->Get("UpAxis", axis) && axis >= 0 && axis < 3) {
      scene.mMetaData->Get("UpAxisSign", sign);
      out.up_hint = Vec3::Unit(axis) * (sign < 0 ? -1.0 : 1.0);
    }
  }
  return out;
}

const aiScene& read_or_fail(Assimp::Importer& importer, const std::filesystem::path& path) {
  const aiScene* scene = read_scene(importer, path);
  if (scene != nullptr) return *scene;
  throw Error(ExitCode::kFile, path.string() + ": not a mesh or motion that assimp reads: " +
                                   importer.GetErrorString() + " (export it as glTF 2.0)");
}

}  // namespace

Files files_read_with_assimp(const std::filesystem::path& path) {
  Files files;
  try {
    Assimp::Importer importer;
    const aiScene* scene = read_scene(importer, path, &files);
    for (unsigned m = 0; scene != nullptr && m < scene->mNumMaterials; ++m) {
      add_pictures(*scene->mMaterials[m], path.parent_path(), files);
    }
  } catch (const Error&) {  // which read_source says
  }
  return files;
}

SourceMesh read_with_assimp(const std::filesystem::path& path, const ImportOptions& options) {
  Assimp::Importer importer;
  const aiScene& scene = read_or_fail(importer, path);
  const AssimpScene flat = flatten(scene, path.string());
  SourceMesh out = source_of(scene, flat, path.string());
  if (options.look) out.look = read_look(scene, flat, path.parent_path());
  return out;
}

std::string glb_with_assimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  const aiScene& scene = read_or_fail(importer, path);
  const AssimpScene flat = flatten(scene, path.string());
  SourceMesh source = source_of(scene, flat, path.string());
  source.look = read_look(scene, flat, path.parent_path());
  return glb_of(scene, flat, source);
}

}  // namespace spherechain::baker
