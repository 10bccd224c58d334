// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/gltf_file.h"

#include <cstring>
#include <fstream>
#include <sstream>

#include "baker/import/gltf_json.h"
#include "baker/import/look.h"
#include "baker/import/named_file.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

struct Container {
  std::string_view json, binary;
};

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

// Section 4.4 of the specification: a header of 12 bytes, then chunks, JSON first.
Container split_glb(std::string_view bytes, const GltfFile& file) {
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (bytes.size() < 12) file.fail("is cut short inside its header");
  if (word(bytes, 4) != 2) file.fail("is GLB version " + std::to_string(word(bytes, 4)) + ", but only 2 is read");
  const std::size_t length = word(bytes, 8);
  if (length > bytes.size()) {
    file.fail("is cut short: " + std::to_string(bytes.size()) + " bytes of " + std::to_string(length));
  }
  Container parts;
  std::size_t at = 12;
  for (int chunk = 0; chunk < 2 && at + 8 <= length; ++chunk) {
    const std::size_t size = word(bytes, at);
    const std::uint32_t type = word(bytes, at + 4);
    at += 8;
    if (size > length - at) file.fail("has a chunk that reaches past its end");
    if (chunk == 0 && type == kJson) parts.json = bytes.substr(at, size);
    if (chunk == 1 && type == kBinary) parts.binary = bytes.substr(at, size);
    at += size;
  }
  if (parts.json.empty()) file.fail("has no JSON chunk");
  return parts;
}

Container split(std::string_view bytes, const GltfFile& file) {
  return bytes.rfind("glTF", 0) == 0 ? split_glb(bytes, file) : Container{bytes, {}};
}

bool is_data(const std::string& uri) { return uri.starts_with("data:"); }

// The buffer's bytes; none where it has no source (the fallback of a compression extension).
std::vector<unsigned char> buffer_bytes(const nlohmann::json& buffer, const std::string& where, std::string_view binary,
                                        const fs::path& folder, const GltfFile& file) {
  const auto length = buffer["byteLength"].get<std::size_t>();
  const auto check = [&](std::size_t there, const std::string& source) {
    if (there < length) {
      file.fail(where + " has " + std::to_string(length) + " bytes, but " + source + " only " + std::to_string(there));
    }
  };
  if (!buffer.contains("uri")) {
    if (binary.data() == nullptr) return {};
    check(binary.size(), "the binary chunk");
    return {binary.begin(), binary.begin() + static_cast<std::ptrdiff_t>(length)};
  }
  const auto uri = buffer["uri"].get<std::string>();
  if (is_data(uri)) {
    std::vector<unsigned char> bytes;
    std::string type;
    if (!tinygltf::DecodeDataURI(&bytes, type, uri, 0, false) && length > 0) {
      file.fail(where + ".uri is not base64 data of a buffer");
    }
    check(bytes.size(), "its data URI");
    bytes.resize(length);
    return bytes;
  }
  const NamedFile named = named_by_uri(folder, uri);
  if (!named.is_there) {
    file.fail(where + ".uri " + in_quotes(uri) + " " + named.what_is_wrong() + " (put the buffer beside the file)");
  }
  std::error_code error;
  check(fs::file_size(named.path, error), in_quotes(uri));  // no more of it is read
  std::vector<unsigned char> bytes(length);
  std::ifstream in(named.path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(length))) {
    file.fail(where + ".uri " + in_quotes(uri) + " cannot be read");
  }
  return bytes;
}

// tinygltf refuses indices of a sparse accessor without a buffer view, which the specification allows: they are taken
// out before it reads the file.
std::vector<int> take_indices(nlohmann::json& json) {
  std::vector<int> taken;
  if (!json.contains("meshes")) return taken;
  for (nlohmann::json& mesh : json["meshes"]) {
    for (nlohmann::json& primitive : mesh["primitives"]) {
      taken.push_back(primitive.value("indices", -1));
      primitive.erase("indices");
    }
  }
  return taken;
}

void put_back(const std::vector<int>& indices, tinygltf::Model& model) {
  std::size_t next = 0;
  for (tinygltf::Mesh& mesh : model.meshes) {
    for (tinygltf::Primitive& primitive : mesh.primitives) primitive.indices = indices.at(next++);
  }
}

bool no_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

}  // namespace

void GltfFile::fail(const std::string& what) const { throw Error(ExitCode::kFile, name + ": " + what); }

std::string bytes_of_gltf(const fs::path& path) {
  constexpr std::uintmax_t kMax = std::uintmax_t{1} << 32;  // a GLB says its length in 32 bits
  std::error_code ignored;
  if (const std::uintmax_t size = fs::file_size(path, ignored); !ignored && size > kMax)
    throw Error(ExitCode::kFile, path.string() + ": is larger than any glTF file (4 GB)");
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!in || in.bad()) throw Error(ExitCode::kFile, path.string() + ": cannot be read");
  return std::move(bytes).str();
}

std::string_view json_of_gltf(std::string_view bytes, const GltfFile& file) { return split(bytes, file).json; }

nlohmann::json raw_json_of_gltf(const fs::path& path) {
  try {
    GltfFile file;
    file.name = path.string();
    const std::string bytes = bytes_of_gltf(path);
    return nlohmann::json::parse(json_of_gltf(bytes, file), nullptr, false);
  } catch (const Error&) {
    return nlohmann::json(nlohmann::json::value_t::discarded);
  }
}

std::string picture_of_gltf(const GltfFile& file, const nlohmann::json& image, const fs::path& folder) {
  if (image.contains("uri") && image["uri"].is_string()) {
    const auto uri = image["uri"].get<std::string>();
    if (!is_data(uri)) return read_picture(named_by_uri(folder, uri).path);
    std::vector<unsigned char> bytes;
    std::string type;
    if (!tinygltf::DecodeDataURI(&bytes, type, uri, 0, false)) return {};
    return {bytes.begin(), bytes.end()};
  }
  if (!image.contains("bufferView") || !image["bufferView"].is_number_unsigned()) return {};
  const auto index = image["bufferView"].get<std::size_t>();
  if (index >= file.model.bufferViews.size()) return {};
  const tinygltf::BufferView& view = file.model.bufferViews[index];
  const std::vector<unsigned char>& data = file.model.buffers[at(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) return {};
  return {reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength};
}

std::vector<fs::path> files_of_gltf(const fs::path& path) {
  const nlohmann::json json = raw_json_of_gltf(path);
  std::vector<fs::path> files;
  for (const char* list : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(list)) continue;
    for (const nlohmann::json& entry : json[list]) {
      if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
      const auto uri = entry["uri"].get<std::string>();
      if (is_data(uri)) continue;
      if (NamedFile named = named_by_uri(path.parent_path(), uri); !named.path.empty()) files.push_back(named.path);
    }
  }
  return files;
}

void note_lost_pictures(const GltfFile& file, const fs::path& folder) {
  LostFiles lost;
  for (const std::string& uri : file.pictures) {
    if (!is_data(uri)) lost.add(uri, named_by_uri(folder, uri));
  }
  lost.note(file.name);
}

GltfFile open_gltf(const fs::path& path) {
  GltfFile file;
  file.name = path.string();
  const std::string bytes = bytes_of_gltf(path);
  const Container parts = split(bytes, file);

  nlohmann::json json = check_gltf_json(parts.json, file.name);
  // tinygltf would look for buffers in other places, too, and copy the binary chunk for whoever asks.
  std::vector<std::vector<unsigned char>> buffers;
  for (const nlohmann::json& buffer : json["buffers"]) {
    const std::string where = "buffers[" + std::to_string(buffers.size()) + "]";
    buffers.push_back(
        buffer_bytes(buffer, where, buffers.empty() ? parts.binary : std::string_view(), path.parent_path(), file));
  }
  json.erase("buffers");
  for (const nlohmann::json& image : json["images"]) file.pictures.push_back(image);
  json.erase("images");
  const std::vector<int> indices = take_indices(json);

  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(no_image, nullptr);
  const std::string text = json.dump();
  if (text.size() > std::numeric_limits<int>::max()) file.fail("has too large a JSON");
  std::string error, warning;
  bool loaded = false;
  try {
    loaded =
        loader.LoadASCIIFromString(&file.model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), "");
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  if (!loaded) file.fail("is not a glTF that can be read (" + error.substr(0, error.find('\n')) + ")");
  put_back(indices, file.model);
  for (std::vector<unsigned char>& data : buffers) file.model.buffers.emplace_back().data = std::move(data);
  return file;
}

}  // namespace spherechain::baker
