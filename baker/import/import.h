// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/import/look.h"
#include "baker/import/source_rig.h"
#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// Findings and repairs of the import, for the bake report.
struct ImportReport {
  std::string importer;                // "assimp", "tinygltf", "bvh", "numpy" or "robot"
  std::size_t meshes = 0;              // mesh instances in the source's scene
  std::size_t components = 0;          // connected pieces after welding
  std::size_t welded_vertices = 0;     // distinct positions over all pieces
  std::size_t degenerate_dropped = 0;  // triangles without area: two corners at one position, or all on a line
  std::size_t duplicates_dropped = 0;  // triangles with the same three positions as an earlier one
  std::size_t points_and_lines_dropped = 0;
  std::size_t bones_dropped = 0;  // of a prop: what would have moved its parts
};

struct ImportOptions {
  bool prop = false;       // all meshes as one rigid thing: its only bone is kPropBone
  bool look = false;       // read the base colours, too
  bool keep_axes = false;  // of Collada: do not turn the file's up axis to y
  std::string character;   // of several in a file: what a node of this name, or its skin, has; empty: all
};

// The bone of a prop. Its matrix takes the rest pose to the pose's space.
inline constexpr const char* kPropBone = "prop";

// A vertex buffer of the file, as a game loads it: a run of the source's vertices.
struct SourceBuffer {
  Index mesh = 0, primitive = 0;  // the file's numbers (assimp: the scene's mesh, and 0)
  Index first_vertex = 0, vertex_count = 0;
  std::uint64_t hash = 0;    // sc_hash_positions of its positions in the file, before any node moves them
  Index triangle_count = 0;  // triangles of the source, after those of the buffers before
  std::string name{};        // the names of its node, mesh and material
};

// A surface that is segmented and fitted: a piece of the skin, or a closed surface made of the skin or around it.
struct BodyMesh {
  Mesh mesh;
  std::vector<Index> source_triangle;  // a triangle -> its number in the source, kNoIndex where it is new
  std::vector<Index> of_source;        // source vertex -> vertex, kNoIndex where it is on none
};

// A character as read, before any decision about its shape. No stage changes it.
//
// Source order: the vertices and triangles of the file's meshes, one after another, each as the importer hands it out
// with nothing joined or reordered (assimp: scene order, polygons triangulated, node transforms applied; glTF: in the
// order of the nodes, primitive by primitive). It is the order of the vertex buffer the runtime refits from, and of
// every index in the asset.
struct Character {
  std::string file;    // name without its folder
  std::string sha256;  // of the file's bytes, lower-case hex

  std::vector<Vec3> source_positions;      // rest pose, exactly representable as float
  std::vector<Triangle> source_triangles;  // corners: source vertices
  std::vector<SourceBuffer> buffers;       // in the order of their vertices
  SourceRig rig;

  // All pieces, welded and cleaned: what spheres are bound to.
  Mesh skin;
  std::vector<Index> skin_source_triangle;  // a triangle of skin -> its number in the source
  std::vector<Index> skin_of_source;        // source vertex -> vertex of skin, kNoIndex where no triangle uses it

  BodyMesh largest_piece;  // of the skin: the connected piece with the greatest area

  double metres_per_unit = 1;
  Vec3 up_hint = Vec3::UnitY();  // the file's up axis; the character's own is found from its shape
  ImportReport report;
};

// Reads a character. Throws Error(kFile) where there is no such file, it is no mesh, it has no triangles, a position is
// not finite, an index is out of range, or it is less than 1e-6 or more than 1e12 units across.
Character import_character(const std::filesystem::path& path, const ImportOptions& options = {});

// A piece of the skin is the body where it has more than this share of the skin's area. Eyes, teeth and belts are
// others.
inline constexpr double kBodyShareMin = 0.6;

// True if the largest piece of the skin is closed, and most of the skin.
bool is_whole(const Character& character);

// True if a body's triangles are triangles of the skin, or parts of them. A wrap's are not.
bool is_part_of_skin(const BodyMesh& body);

// All of the skin, its pieces as they are.
BodyMesh all_pieces(const Character& character);

// The positions as single floats x, y, z, as the runtime takes them.
std::vector<float> pack(const std::vector<Vec3>& positions);

// An importer's raw result, the same type for assimp and tinygltf.
struct SourceMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<SourceBuffer> buffers;
  SourceRig rig;
  SourceLook look;  // where it was asked for
  std::string importer;
  std::size_t meshes = 0;
  std::size_t points_and_lines_dropped = 0;
  std::size_t bones_dropped = 0;
  double metres_per_unit = 1;
  Vec3 up_hint = Vec3::UnitY();
};
// Throws Error(kFile) where the path is not a regular file: what is read more than once must be on a disk.
void check_regular_file(const std::filesystem::path& path);

// The files that a source names, whether they exist or not: a glTF's buffers and images, an OBJ's materials. The list
// is empty where the source cannot be read; read_source tells why.
std::vector<std::filesystem::path> files_beside(const std::filesystem::path& source);

// All files that are read with a source of any format (skeletons, animations, materials, other meshes), and the
// pictures that its materials name. It takes as long as reading the source.
std::vector<std::filesystem::path> files_read_with(const std::filesystem::path& source);

// Reads a file with the importer of its format, which its content decides, in a child process (read_in_child.h). A file
// of motion has no mesh. Throws Error(kFile).
SourceMesh read_source(const std::filesystem::path& path, const ImportOptions& options = {});
SourceMesh read_with_assimp(const std::filesystem::path& path, const ImportOptions& options = {});
std::vector<std::string> files_read_with_assimp(const std::filesystem::path& path);
SourceMesh read_with_tinygltf(const std::filesystem::path& path, const ImportOptions& options);

// The file as a binary glTF, written in a child process: a GLB byte for byte, a .gltf with what lies beside it inside,
// and of other formats all that the importer reads. Numbers of nodes and clips are those that read_source gives
// (in_file). Throws Error(kFile).
std::string read_as_glb(const std::filesystem::path& path);
std::string glb_with_assimp(const std::filesystem::path& path);

// Checks, welds, cleans and splits what an importer read; `name` is what errors call the file.
Character build_character(const SourceMesh& source, const std::string& name);

}  // namespace spherechain::baker
