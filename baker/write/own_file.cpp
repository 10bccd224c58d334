// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/write/own_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "baker/os/written_file.h"
#include "baker/write/npz.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

std::string read_start(std::ifstream& in, std::size_t size) {
  std::string out(size, '\0');
  in.read(out.data(), static_cast<std::streamsize>(size));
  out.resize(static_cast<std::size_t>(in.gcount()));
  return out;
}

bool has_same_bytes(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (b.empty() || fs::file_size(a, error) != fs::file_size(b, error) || error) return false;
  std::ifstream left(a, std::ios::binary), right(b, std::ios::binary);
  return std::equal(std::istreambuf_iterator<char>(left), {}, std::istreambuf_iterator<char>(right));
}

bool is_own_glb(std::ifstream& in) {
  const std::string head = read_start(in, 20);
  if (head.size() < 20 || !head.starts_with("glTF") || head.substr(16) != "JSON") return false;
  std::uint32_t size = 0;
  std::memcpy(&size, head.data() + 12, 4);
  constexpr std::uint32_t kSizeMax = 256U << 20;
  if (size > kSizeMax) return false;
  const nlohmann::json json = nlohmann::json::parse(read_start(in, size), nullptr, false);
  if (!json.is_object() || !json.contains("asset") || !json["asset"].is_object()) return false;
  const nlohmann::json& asset = json["asset"];
  if (asset.contains("extras") && asset["extras"].is_object() && asset["extras"].contains(kGltfMark)) return true;
  return asset.contains("generator") && asset["generator"].is_string() &&
         asset["generator"].get_ref<const std::string&>().starts_with("spherechain");
}

bool is_own_text(const std::string& text, FileKind kind) {
  const auto has = [&](std::string_view mark) { return text.find(mark) != std::string::npos; };
  const bool is_json = text.starts_with("{\n \"writer\": \"spherechain") || text.starts_with("{\n \"spherechain");
  switch (kind) {
    case FileKind::kAsset:
      return text.size() >= 8 && text.compare(4, 4, "SPHC") == 0;
    case FileKind::kJson:
      return is_json;
    case FileKind::kSarif:
      return text.starts_with("{\n \"$schema\":") && has("\"driver\": {\n     \"name\": \"spherechain\",");
    case FileKind::kJunit:
      return text.starts_with("<?xml ") && has("<testsuite name=\"spherechain check\" ");
    case FileKind::kPage:
      return text.starts_with("<!doctype html>") && has("<meta name=\"generator\" content=\"spherechain\">");
    case FileKind::kColliders:
      return is_json || has("Written by spherechain") || has("doc = \"spherechain: colliders of ");
    case FileKind::kPalettes:
      return is_own_npz(text);
    case FileKind::kGlb:
    case FileKind::kBvh:
    case FileKind::kFbx:
    case FileKind::kTable:
      break;
  }
  return false;
}

}  // namespace

const char* kind_text(FileKind kind) {
  switch (kind) {
    case FileKind::kAsset:
      return "an asset";
    case FileKind::kJson:
      return "JSON";
    case FileKind::kSarif:
      return "SARIF";
    case FileKind::kJunit:
      return "JUnit XML";
    case FileKind::kPage:
      return "a page";
    case FileKind::kGlb:
      return "a GLB file";
    case FileKind::kBvh:
      return "a BVH file";
    case FileKind::kFbx:
      return "an FBX file";
    case FileKind::kPalettes:
      return "a file of palettes";
    case FileKind::kTable:
      return "a table";
    case FileKind::kColliders:
      break;
  }
  return "a file of colliders";
}

bool is_own_file(const fs::path& file, FileKind kind, const fs::path& copy_of) {
  std::error_code ignored;
  if (!fs::exists(file, ignored) || is_written_directly(file) || fs::file_size(file, ignored) == 0) return true;
  if (has_same_bytes(file, copy_of)) return true;
  std::ifstream in(file, std::ios::binary);
  if (kind == FileKind::kGlb) return is_own_glb(in);
  constexpr std::size_t kStart = 4096;
  return is_own_text(read_start(in, kStart), kind);
}

}  // namespace spherechain::baker
