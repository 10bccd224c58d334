// SPDX-License-Identifier: GPL-3.0-or-later
#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <new>
#include <set>
#include <sstream>
#include <string_view>

#include "baker/import/assimp_glb.h"
#include "baker/import/assimp_look.h"
#include "baker/import/assimp_scene.h"
#include "baker/import/choose_meshes.h"
#include "baker/import/collada_names.h"
#include "baker/import/fbx_binds.h"
#include "baker/import/fbx_curves.h"
#include "baker/import/fbx_names.h"
#include "baker/import/import.h"
#include "baker/import/named_file.h"
#include "baker/import/notes.h"
#include "baker/import/ogre_weights.h"
#include "baker/mesh/error.h"
#include "spherechain/asset.h"

namespace spherechain::baker {
namespace {

using Files = std::vector<std::string>;

// `names` are those of the mesh's node, of itself and of its material.
void append(const MeshInstance& instance, const std::string& names, const std::string& name, SourceMesh& out) {
  const aiMesh& mesh = *instance.mesh;
  const Index base = instance.first_vertex;
  const std::size_t before = out.triangles.size();
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
  out.buffers.back().triangle_count = static_cast<Index>(out.triangles.size() - before);
  out.buffers.back().name = names;
  ++out.meshes;
}

// A mesh's own file, which may go by an alias with another ending, and the files that it names (materials, skeletons,
// other meshes) as far as named_file.h lets it. A pipe is no file: assimp would wait for ever for its other end.
class OwnFiles : public Assimp::DefaultIOSystem {
 public:
  explicit OwnFiles(const std::filesystem::path& file)
      : file_(file.string()), folder_(file.parent_path()), prefix_(file_.substr(0, file_.rfind('/') + 1)) {}
  const std::string& alias(const std::string& ending) { return alias_ = file_ + "." + ending; }
  // The file has these bytes in place of its own.
  void replace_content(std::string bytes) { content_ = std::move(bytes); }
  bool Exists(const char* path) const override { return !real(path).empty(); }
  Assimp::IOStream* Open(const char* path, const char* mode) override {
    const std::string file = real(path);
    if (file.empty()) return nullptr;
    opened_.push_back(file);
    if (file == file_ && !content_.empty())
      return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()), content_.size());
    return DefaultIOSystem::Open(file.c_str(), mode);
  }

  const Files& opened() const { return opened_; }
  // The first file outside the folder that an importer asked for, and what is wrong with its name; empty where there is
  // none. Without `looks` those that are only about materials do not count.
  std::string refused(bool looks) const {
    for (const auto& [name, refusal] : refused_) {
      if (looks || !is_look(name)) return in_quotes(name) + " " + refusal;
    }
    return {};
  }

 private:
  // Empty where it is no file, or none that may be read.
  std::string real(const std::string& path) const {
    if (path == file_ || path == alias_) return is_file(file_) ? file_ : "";
    const std::string name = path.starts_with(prefix_) ? path.substr(prefix_.size()) : path;
    // Some put folder, slash and name together where the folder ends in a slash.
    NamedFile named = named_file(folder_, name.substr(std::min(name.find_first_not_of('/'), name.size())));
    if (named.is_there) return named.path.string();
    named = named_file(folder_, name);
    // Importers try names of their own, too: only a file that is there is missed.
    if (named.refusal != nullptr && is_file(name.starts_with("/") ? name : path)) refused_.emplace(name, named.refusal);
    return {};
  }
  static bool is_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored);
  }
  static std::string ending_of(const std::string& name) {
    std::string ending = std::filesystem::path(name).extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
  }
  bool is_look(const std::string& name) const {
    if (ending_of(file_) == ".obj") return true;  // which names materials alone
    static const std::set<std::string> kLooks{".mtl",  ".material", ".shader", ".skin", ".png", ".jpg",
                                              ".jpeg", ".tga",      ".bmp",    ".dds",  ".tif", ".tiff"};
    return kLooks.contains(ending_of(name));
  }

  std::string file_, alias_;
  std::filesystem::path folder_;
  std::string prefix_;  // the folder as importers have it before a name
  Files opened_;
  std::string content_;
  mutable std::map<std::string, const char*> refused_;  // names and why
};

bool has_content(const aiScene* scene) {
  return scene != nullptr && (scene->mNumMeshes > 0 || scene->mNumAnimations > 0);
}

bool recognises(Assimp::BaseImporter& format, const std::string& name, OwnFiles& files) {
  try {
    return format.CanRead(name, &files, true);
  } catch (const std::exception&) {
    return false;
  }
}

// Assimp goes by a file's ending. Where that leads to nothing, each format that recognises the content has its turn;
// assimp 5.4 does not recognise FBX.
const aiScene* read_by_ending_or_content(Assimp::Importer& importer, OwnFiles& files, const std::string& name,
                                         bool is_fbx = false) {
  if (const aiScene* scene = importer.ReadFile(name, 0); has_content(scene)) return scene;
  if (is_fbx) {
    if (const aiScene* scene = importer.ReadFile(files.alias("fbx"), 0); has_content(scene)) return scene;
  }
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

// Empty where it is no FBX file.
std::string bytes_of_fbx(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return {};
  std::ifstream in(path, std::ios::binary);
  std::string bytes(4096, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (!is_fbx(bytes)) return {};
  in.clear();
  std::ostringstream rest;
  rest << in.rdbuf();
  return bytes + std::move(rest).str();
}

// A file, read; the scene is null where no importer reads it.
struct ReadFile {
  explicit ReadFile(const std::filesystem::path& path, bool keep_axes = false)
      : name(path.string()), files(new OwnFiles(path)) {
    importer.SetIOHandler(files);  // which the importer deletes
    // Sticks that importers put where a file has bones and no mesh are no character.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, keep_axes);
    if (std::string bytes = bytes_of_fbx(path); !bytes.empty()) {
      fbx = read_fbx(bytes);
      names = make_names_unique(bytes, fbx);
      files->replace_content(std::move(bytes));
    }
    scene = read_by_ending_or_content(importer, *files, name, fbx.tree.is_binary || !fbx.objects.empty());
    if (scene != nullptr) {
      auto& changed = const_cast<aiScene&>(*scene);  // the importer's own, which nobody else reads
      keep_space_and_binds(changed, fbx);
      complete_curves(changed, fbx);
      separate_shared_weights(changed);
    }
    if (scene != nullptr && is_collada(*scene) && !names_are_unique(*scene)) read_by_id();
    // Assimp catches it and goes on.
    if (scene == nullptr && std::string_view(importer.GetErrorString()).find("bad_alloc") != std::string_view::npos) {
      throw std::bad_alloc();
    }
    if (scene == nullptr) return;
    check_faces(*scene, name);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
  }

  // Throws Error(kFile) where there is none, or the file needs another that may not be read.
  const aiScene& scene_or_fail() const {
    const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, name + ": " + what); };
    if (const std::string refused = files->refused(false); !refused.empty()) {
      fail("needs the file " + refused + " (put the file beside it)");
    }
    if (scene == nullptr) {
      fail(std::string("not a mesh or motion that assimp reads: ") + importer.GetErrorString() +
           " (export it as glTF 2.0)");
    }
    return *scene;
  }

  std::string name;
  Assimp::Importer importer;
  OwnFiles* files;
  const aiScene* scene = nullptr;
  NamesOfNodes names;
  FbxFile fbx;  // of an FBX file

 private:
  // Bones and clips refer to nodes by one of the two: names that are not unique would lead to wrong nodes.
  void read_by_id() {
    const std::unique_ptr<aiScene> by_name(importer.GetOrphanedScene());
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, false);
    scene = read_by_ending_or_content(importer, *files, name);
    if (scene != nullptr) names = names_of_ids(*scene, *by_name);
  }
};

// Calls `each` with the name of each picture of the scene's materials that lies in a file of its own.
void for_each_picture(const aiScene& scene, const std::function<void(const std::string&)>& each) {
  for (unsigned m = 0; m < scene.mNumMaterials; ++m) {
    const aiMaterial& material = *scene.mMaterials[m];
    for (unsigned p = 0; p < material.mNumProperties; ++p) {
      const aiMaterialProperty& property = *material.mProperties[p];
      aiString name;
      if (std::string_view(property.mKey.C_Str()) == _AI_MATKEY_TEXTURE_BASE &&
          material.Get(_AI_MATKEY_TEXTURE_BASE, property.mSemantic, property.mIndex, name) == aiReturn_SUCCESS &&
          name.length > 0 && scene.GetEmbeddedTexture(name.C_Str()) == nullptr) {
        each(name.C_Str());
      }
    }
  }
}

void note_lost_files(const ReadFile& read, const std::filesystem::path& folder) {
  if (const std::string refused = read.files->refused(true); !refused.empty())
    add_note(read.name + ": not read: " + refused);
  LostFiles lost;
  std::set<std::string> seen;
  for_each_picture(*read.scene, [&](const std::string& name) {
    if (seen.insert(name).second) lost.add(name, named_picture(folder, name));
  });
  lost.note(read.name);
}

// Finds the objects of the file that nodes and clips were read from. Assimp has the file's stacks in order, but for
// those without keys.
void find_fbx_objects(const AssimpScene& flat, const FbxFile& fbx, SourceRig& rig) {
  std::map<std::string_view, std::int64_t> models;
  std::vector<const FbxObject*> stacks;
  for (const FbxObject& object : fbx.objects) {
    if (object.kind == FbxKind::kModel) models.emplace(object.name, object.id);
    if (object.kind == FbxKind::kStack) stacks.push_back(&object);
  }
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const auto model = models.find(flat.chains[n].back()->mName.C_Str());
    if (model != models.end()) rig.nodes[n].fbx_id = model->second;
  }
  auto from = stacks.begin();
  for (Clip& clip : rig.clips) {
    const auto stack = std::find_if(from, stacks.end(), [&](const FbxObject* one) { return one->name == clip.name; });
    if (stack == stacks.end()) continue;
    clip.fbx_id = (*stack)->id;
    from = stack + 1;
  }
}

SourceMesh source_of(const ReadFile& read, const AssimpScene& flat) {
  const aiScene& scene = *read.scene;
  const std::string& name = read.name;
  SourceMesh out;
  out.importer = "assimp";
  for (const MeshInstance& instance : flat.instances) {
    const aiString material = scene.mMaterials[instance.mesh->mMaterialIndex]->GetName();
    append(instance, flat.nodes[instance.node].name + " " + instance.mesh->mName.C_Str() + " " + material.C_Str(), name,
           out);
  }
  out.rig = read_rig(scene, flat, name);
  find_fbx_objects(flat, read.fbx, out.rig);
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

}  // namespace

Files files_read_with_assimp(const std::filesystem::path& path) {
  try {
    const ReadFile read(path);
    Files files = read.files->opened();
    if (read.scene == nullptr) return files;
    for_each_picture(*read.scene, [&](const std::string& name) {
      if (const NamedFile picture = named_picture(path.parent_path(), name); !picture.path.empty())
        files.push_back(picture.path.string());
    });
    return files;
  } catch (const Error&) {  // which read_source says
    return {};
  }
}

SourceMesh read_with_assimp(const std::filesystem::path& path, const ImportOptions& options) {
  const ReadFile read(path, options.keep_axes);
  const aiScene& scene = read.scene_or_fail();
  const AssimpScene flat = flatten(scene, read.names, read.name, options.character);
  SourceMesh out = source_of(read, flat);
  std::vector<SkinnedBox> skinned;
  for (const MeshInstance& instance : flat.instances) {
    const Index joint = top_joint(flat, *instance.mesh);
    if (joint == kNoIndex) continue;
    skinned.push_back({{instance.node, joint, {}, {}, false}, {}});
    for (Index v = 0; v < instance.mesh->mNumVertices; ++v)
      skinned.back().box.extend(out.positions[instance.first_vertex + v]);
  }
  note_characters(flat.nodes, skinned, out.up_hint, read.name);
  for (const std::string& mesh : flat.placed_by_rest_pose) {
    add_note(read.name + ": mesh '" + mesh +
             "' shares no joint with the others: where it is bound is guessed from the " +
             "rest pose (export the skeleton in its bind pose)");
  }
  note_lost_files(read, path.parent_path());
  if (options.look) out.look = read_look(scene, flat, path.parent_path());
  return out;
}

std::string glb_with_assimp(const std::filesystem::path& path) {
  const ReadFile read(path);
  const aiScene& scene = read.scene_or_fail();
  const AssimpScene flat = flatten(scene, read.names, read.name);
  SourceMesh source = source_of(read, flat);
  source.look = read_look(scene, flat, path.parent_path());
  return glb_of(scene, flat, source);
}

}  // namespace spherechain::baker
