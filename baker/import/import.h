// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/source_rig.h"
#include "mesh/mesh.h"

namespace spherechain::baker {

// What cleaning found and did; all of it goes into the bake report.
struct ImportReport {
  std::string importer;                // "assimp"
  std::size_t meshes = 0;              // mesh instances in the source's scene
  std::size_t components = 0;          // connected pieces after welding
  std::size_t welded_vertices = 0;     // distinct positions over all pieces
  std::size_t degenerate_dropped = 0;  // triangles without area: two corners at one position, or all on a line
  std::size_t duplicates_dropped = 0;  // triangles with the same three positions as an earlier one
  std::size_t points_and_lines_dropped = 0;
};

// A character as read, before any decision about its shape.
//
// Source order: the vertices and triangles of the file's meshes, one after another, each as the importer hands it out
// with nothing joined or reordered (assimp: scene order, polygons triangulated, node transforms applied). It is the
// order of the vertex buffer the runtime refits from, and of every index in the asset.
struct Character {
  std::string file;    // name without its folder
  std::string sha256;  // of the file's bytes, lower-case hex

  std::vector<Vec3> source_positions;      // rest pose, exactly representable as float
  std::vector<Triangle> source_triangles;  // corners: source vertices
  SourceRig rig;

  // All pieces, welded and cleaned: what spheres are bound to.
  Mesh skin;
  std::vector<Index> skin_source_triangle;  // a triangle of skin -> its number in the source
  std::vector<Index> skin_of_source;        // source vertex -> vertex of skin, kNoIndex where no triangle uses it

  // The surface that is segmented and fitted: the skin's largest connected piece.
  Mesh body;
  std::vector<Index> body_source_triangle;  // a triangle of body -> its number in the source
  std::vector<Index> body_of_source;        // source vertex -> vertex of body, kNoIndex where it is on none

  double metres_per_unit = 1;
  Vec3 up_hint = Vec3::UnitY();  // the file's up axis; the character's own is found from its shape
  ImportReport report;
};

// Reads a character. Throws Error(kFile) where there is no such file, it is no mesh, it has no triangles, a position is
// not finite, an index is out of range, or all positions coincide.
Character import_character(const std::filesystem::path& path);

// x y z after another, as the runtime takes them.
std::vector<float> pack(const std::vector<Vec3>& positions);

// An importer's raw result: what assimp and (with the issue about real characters) tinygltf have in common.
struct SourceMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  SourceRig rig;
  std::string importer;
  std::size_t meshes = 0;
  std::size_t points_and_lines_dropped = 0;
  double metres_per_unit = 1;
  Vec3 up_hint = Vec3::UnitY();
};
SourceMesh read_with_assimp(const std::filesystem::path& path);

// Checks, welds, cleans and splits what an importer read; `name` is what errors call the file.
Character build_character(const SourceMesh& source, const std::string& name);

}  // namespace spherechain::baker
