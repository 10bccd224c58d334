// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/gltf_file.h"
#include "baker/import/source_rig.h"
#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A primitive's parts, each as the file has it. `where` is what errors call the primitive; all throw Error(kFile).

// True if it has triangles, or strips or fans of them. All else is points and lines, which the next function counts.
bool has_triangles(const tinygltf::Primitive& primitive);
std::size_t count_points_and_lines(const GltfFile& file, const tinygltf::Primitive& primitive);

std::vector<Vec3> read_positions(const GltfFile& file, const tinygltf::Primitive& primitive, const std::string& where);
std::vector<Triangle> read_triangles(const GltfFile& file, const tinygltf::Primitive& primitive,
                                     std::size_t vertex_count, const std::string& where);

// Has joints and weights.
bool is_skinned(const tinygltf::Primitive& primitive);
// `bones`: the bones of the skin's joints. Weights add up to 1; a vertex without weights follows the first joint it
// names.
std::vector<VertexWeights> read_weights(const GltfFile& file, const tinygltf::Primitive& primitive,
                                        const std::vector<Index>& bones, std::size_t vertex_count,
                                        const std::string& where);

// A morph target's displacements; empty where it does not move positions.
std::vector<Vec3> read_displacements(const GltfFile& file, const std::map<std::string, int>& target,
                                     std::size_t vertex_count, const std::string& where);

}  // namespace spherechain::baker
