// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/glb_file.h"

#include <algorithm>
#include <cstdint>

#include "baker/import/gltf_file.h"
#include "baker/import/look.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

std::size_t aligned(std::size_t size) { return (size + 3) / 4 * 4; }

void put_word(std::string& out, std::size_t word) {
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<char>(word >> (8 * k) & 0xFF));
}

template <typename T>
constexpr int component_type() {
  if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
  if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
  if constexpr (std::is_same_v<T, float>) return 5126;
}

// Where a view, or the copy of it that a compression extension has, is after the buffers before its own.
void move_view(ordered_json& view, const std::vector<std::size_t>& starts) {
  if (!view.is_object() || !view.contains("buffer") || !view["buffer"].is_number_unsigned()) return;
  const auto number = view["buffer"].get<std::size_t>();
  if (number >= starts.size()) return;
  view["buffer"] = 0;
  if (starts[number] == 0) return;
  const ordered_json& offset = view["byteOffset"];
  view["byteOffset"] = starts[number] + (offset.is_number_unsigned() ? offset.get<std::size_t>() : 0);
}

// The buffers one after another.
void join_buffers(const GltfFile& file, GlbFile& out) {
  std::vector<std::size_t> starts;
  for (const tinygltf::Buffer& buffer : file.model.buffers) {
    const std::string where = "buffers[" + std::to_string(starts.size()) + "]";
    if (buffer.data.empty() && out.json["buffers"][starts.size()]["byteLength"] > 0) {
      file.fail(where + " has no data (export it without compression)");
    }
    out.binary.resize(aligned(out.binary.size()), '\0');
    starts.push_back(out.binary.size());
    out.binary.append(reinterpret_cast<const char*>(buffer.data.data()), buffer.data.size());
  }
  if (starts.empty()) return;
  ordered_json first = out.json["buffers"][0];
  first.erase("uri");
  out.json["buffers"] = ordered_json::array({std::move(first)});
  if (!out.json.contains("bufferViews")) return;
  for (ordered_json& view : out.json["bufferViews"]) {
    move_view(view, starts);
    if (!view.contains("extensions") || !view["extensions"].is_object()) continue;
    for (ordered_json& extension : view["extensions"]) move_view(extension, starts);
  }
}

void take_in_pictures(const GltfFile& file, const std::filesystem::path& folder, GlbFile& out) {
  if (!out.json.contains("images") || !out.json["images"].is_array()) return;
  for (ordered_json& image : out.json["images"]) {
    if (!image.is_object() || !image.contains("uri")) continue;
    const std::string picture = picture_of_gltf(file, image, folder), type = type_of_picture(picture);
    if (type.empty()) continue;
    image.erase("uri");
    image["mimeType"] = type;
    image["bufferView"] = out.add_view(picture.data(), picture.size());
  }
}

bool is_one_file(const std::string& bytes, const std::filesystem::path& path, const ordered_json& json) {
  if (!bytes.starts_with("glTF") || !files_of_gltf(path).empty()) return false;
  if (!json.contains("buffers")) return true;
  return std::none_of(json["buffers"].begin(), json["buffers"].end(),
                      [](const ordered_json& buffer) { return buffer.contains("uri"); });
}

}  // namespace

std::size_t GlbFile::add_view(const void* data, std::size_t size) {
  binary.resize(aligned(binary.size()), '\0');
  json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}});
  binary.append(static_cast<const char*>(data), size);
  return json["bufferViews"].size() - 1;
}

template <typename T>
std::size_t GlbFile::add_accessor(const std::vector<T>& numbers, const char* type, int target, bool bounds) {
  const std::string_view word = type;
  const std::size_t width = word == "SCALAR" ? 1 : word == "MAT4" ? 16 : static_cast<std::size_t>(word.back() - '0');
  const std::size_t view = add_view(numbers.data(), numbers.size() * sizeof(T));
  if (target != 0) json["bufferViews"][view]["target"] = target;
  ordered_json accessor{
      {"bufferView", view}, {"componentType", component_type<T>()}, {"count", numbers.size() / width}, {"type", type}};
  if (bounds) {
    for (std::size_t k = 0; k < width; ++k) {
      T least = numbers[k], most = numbers[k];
      for (std::size_t i = k; i < numbers.size(); i += width) {
        least = std::min(least, numbers[i]);
        most = std::max(most, numbers[i]);
      }
      accessor["min"].push_back(least);
      accessor["max"].push_back(most);
    }
  }
  json["accessors"].push_back(std::move(accessor));
  return json["accessors"].size() - 1;
}
template std::size_t GlbFile::add_accessor(const std::vector<float>&, const char*, int, bool);
template std::size_t GlbFile::add_accessor(const std::vector<std::uint16_t>&, const char*, int, bool);
template std::size_t GlbFile::add_accessor(const std::vector<std::uint32_t>&, const char*, int, bool);

std::string GlbFile::bytes() const {
  constexpr std::size_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  ordered_json whole = json;
  std::string data = binary;
  data.resize(aligned(data.size()), '\0');
  if (!data.empty()) whole["buffers"][0]["byteLength"] = binary.size();
  std::string text = whole.dump();
  text.resize(aligned(text.size()), ' ');
  std::string out = "glTF";
  put_word(out, 2);
  put_word(out, 12 + 8 + text.size() + (data.empty() ? 0 : 8 + data.size()));
  put_word(out, text.size());
  put_word(out, kJson);
  out += text;
  if (data.empty()) return out;
  put_word(out, data.size());
  put_word(out, kBinary);
  return out + data;
}

const ordered_json& entry_of(const ordered_json& object, std::string_view name) {
  static const ordered_json kNull;
  const auto found = object.find(std::string(name));  // the end of what is no object
  return found == object.end() ? kNull : *found;
}

GlbFile glb_of_bytes(const std::string& bytes, const std::string& file) {
  const auto word_at = [&](std::size_t at) {
    std::size_t out = 0;
    for (std::size_t k = 4; k-- > 0;)
      out = out << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0);
    return out;
  };
  constexpr std::size_t kJsonStart = 20, kChunkHead = 8;
  const std::size_t size = word_at(12), begin = kJsonStart + size + kChunkHead;
  GlbFile out;
  if (bytes.starts_with("glTF") && bytes.size() >= kJsonStart) {
    out.json = ordered_json::parse(bytes.substr(kJsonStart, size), nullptr, /*allow_exceptions=*/false);
  }
  if (!out.json.is_object()) throw Error(ExitCode::kFile, file + ": is no binary glTF 2.0 file (export it as .glb)");
  if (begin <= bytes.size()) out.binary = bytes.substr(begin, word_at(kJsonStart + size));
  return out;
}

std::string pack_gltf(const std::filesystem::path& path) {
  const GltfFile file = open_gltf(path);  // which checks it
  GlbFile out;
  const std::string bytes = bytes_of_gltf(path);
  out.json = ordered_json::parse(json_of_gltf(bytes, file));
  if (is_one_file(bytes, path, out.json)) return bytes;
  join_buffers(file, out);
  take_in_pictures(file, path.parent_path(), out);
  return out.bytes();
}

}  // namespace spherechain::baker
