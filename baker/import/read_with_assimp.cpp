// SPDX-License-Identifier: GPL-3.0-or-later
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <functional>

#include "import/import.h"
#include "mesh/error.h"

namespace spherechain::baker {
namespace {

Vec3 transform(const aiMatrix4x4t<double>& m, const aiVector3D& p) {
  const double x = p.x, y = p.y, z = p.z;
  return {m.a1 * x + m.a2 * y + m.a3 * z + m.a4, m.b1 * x + m.b2 * y + m.b3 * z + m.b4,
          m.c1 * x + m.c2 * y + m.c3 * z + m.c4};
}

aiMatrix4x4t<double> to_double(const aiMatrix4x4& m) {
  return {m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4};
}

void append(const aiMesh& mesh, const aiMatrix4x4t<double>& to_world, const std::string& name, SourceMesh& out) {
  const auto base = static_cast<Index>(out.positions.size());
  for (unsigned v = 0; v < mesh.mNumVertices; ++v) out.positions.push_back(transform(to_world, mesh.mVertices[v]));
  // A mirroring transform turns triangles inside out.
  const bool flip = to_world.Determinant() < 0;
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

}  // namespace

SourceMesh read_with_assimp(const std::filesystem::path& path) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
  const std::string name = path.string();
  if (scene == nullptr)
    throw Error(ExitCode::kFile, name + ": not a mesh that assimp reads (" + importer.GetErrorString() + ")");
  SourceMesh out;
  out.importer = "assimp";
  if (scene->mRootNode != nullptr) {
    const std::function<void(const aiNode&, const aiMatrix4x4t<double>&)> visit =
        [&](const aiNode& node, const aiMatrix4x4t<double>& parent) {
          const aiMatrix4x4t<double> to_world = parent * to_double(node.mTransformation);
          for (unsigned m = 0; m < node.mNumMeshes; ++m) append(*scene->mMeshes[node.mMeshes[m]], to_world, name, out);
          for (unsigned c = 0; c < node.mNumChildren; ++c) visit(*node.mChildren[c], to_world);
        };
    visit(*scene->mRootNode, aiMatrix4x4t<double>());
  }
  // Formats without units are taken as metres. FBX says its own, in centimetres.
  double centimetres = 0;
  float centimetres_f = 0;
  if (scene->mMetaData != nullptr) {
    if (scene->mMetaData->Get("UnitScaleFactor", centimetres) && centimetres > 0)
      out.metres_per_unit = centimetres / 100;
    else if (scene->mMetaData->Get("UnitScaleFactor", centimetres_f) && centimetres_f > 0)
      out.metres_per_unit = static_cast<double>(centimetres_f) / 100;
    int axis = 1, sign = 1;
    if (scene->mMetaData->Get("UpAxis", axis) && axis >= 0 && axis < 3) {
      scene->mMetaData->Get("UpAxisSign", sign);
      out.up_hint = Vec3::Unit(axis) * (sign < 0 ? -1.0 : 1.0);
    }
  }
  return out;
}

}  // namespace spherechain::baker
