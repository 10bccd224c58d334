// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

// A binary glTF while it is written: its JSON, members in their order, and its one buffer.
struct GlbFile {
  nlohmann::ordered_json json;
  std::string binary;

  // Appends to the buffer, aligned. Returns the number of the new buffer view.
  std::size_t add_view(const void* data, std::size_t size);
  // A new accessor's number. `type` is glTF's word, `target` what the view is for: 34962 vertices, 34963 corners, 0
  // none of them. With `bounds` it says the smallest and largest, as glTF wants of positions and times.
  template <typename T>
  std::size_t add_accessor(const std::vector<T>& numbers, const char* type, int target = 0, bool bounds = false);

  // The file: header, JSON, buffer.
  std::string bytes() const;
};

// The entry of an object, or null.
const nlohmann::ordered_json& entry_of(const nlohmann::ordered_json& object, std::string_view name);

// A binary glTF apart; read_as_glb() makes such bytes. Throws Error(kFile) that names `file` where it is none.
GlbFile glb_of_bytes(const std::string& bytes, const std::string& file);

// A .gltf, or a GLB that names other files, as one GLB: buffers and pictures beside it move inside, all else is as it
// was. A picture that is not there stays a name. A GLB that names no file is returned byte for byte. Throws
// Error(kFile).
std::string pack_gltf(const std::filesystem::path& path);

}  // namespace spherechain::baker
