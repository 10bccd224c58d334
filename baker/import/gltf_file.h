// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace spherechain::baker {

// The most vertices, triangles, keys or displacements that a character has. Files that claim more only cost memory.
inline constexpr std::size_t kGltfElementsMax = std::size_t{1} << 23;

// tinygltf's indices are int. -1 means none, which is past the end of every vector.
inline std::size_t at(int index) { return static_cast<std::size_t>(index); }

// A glTF file in memory: its structure, in which every index leads to something, and its buffers. No image is read.
struct GltfFile {
  std::string name;  // what errors call it
  tinygltf::Model model;
  std::vector<std::string> pictures;  // what its images name: files, or data

  [[noreturn]] void fail(const std::string& what) const;

  // The numbers of an accessor, one element after another: normalized integers as fractions, sparse elements put in.
  // `type` (TINYGLTF_TYPE_...) and `components` (TINYGLTF_COMPONENT_TYPE_...) are what the use allows. Throws
  // Error(kFile) for anything else, where the buffer is too short, or where a number is not finite.
  std::vector<double> numbers(int accessor, int type, const std::vector<int>& components) const;
};

// Notes which pictures do not lie beside the file.
void note_lost_pictures(const GltfFile& file, const std::filesystem::path& folder);

// Reads a .gltf or .glb, recognised by content, with the buffers beside it. Throws Error(kFile).
GltfFile open_gltf(const std::filesystem::path& path);

// The file's bytes, and the text of their JSON, of which nothing is checked. Both throw Error(kFile).
std::string bytes_of_gltf(const std::filesystem::path& path);
std::string_view json_of_gltf(std::string_view bytes, const GltfFile& file);

// The file's JSON, of which nothing is checked; discarded where it is none.
nlohmann::json raw_json_of_gltf(const std::filesystem::path& path);

// The bytes of one of its images; none where they are not there. `folder` is the file's.
std::string picture_of_gltf(const GltfFile& file, const nlohmann::json& image, const std::filesystem::path& folder);

// The files that its buffers and images may be read from (named_file.h), whether they exist or not; none where the file
// is no glTF.
std::vector<std::filesystem::path> files_of_gltf(const std::filesystem::path& path);

}  // namespace spherechain::baker
