// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/asset_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "import/import.h"
#include "mesh/error.h"
#include "spherechain/skin_contacts.h"

namespace spherechain::baker {

std::string read_file(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_fifo(path, ignored)) check_regular_file(path);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  if (in.peek() != std::ifstream::traits_type::eof()) bytes << in.rdbuf();
  if (!in.is_open() || in.bad()) throw Error(ExitCode::kFile, path + ": cannot be read");
  return std::move(bytes).str();
}

std::string to_string(const Status& status) {
  const std::string field = sc_field_name(status.field);
  return field + (field.empty() ? "" : ": ") + sc_code_text(status.code);
}

void check_runtime(const Status& status) {
  if (status != SC_OK) throw Error(ExitCode::kInternal, "the runtime refuses " + to_string(status));
}

OpenAsset::OpenAsset(std::string_view bytes, const std::string& name)
    : bytes_(bytes.size() / sizeof(std::uint64_t) + 1) {
  std::memcpy(bytes_.data(), bytes.data(), bytes.size());
  char message[256] = "";
  const Status status = sc_asset_open(&asset_, SC_ABI_VERSION, bytes_.data(), bytes.size(), message, sizeof(message));
  if (status != SC_OK) {
    throw Error(ExitCode::kFile, name + ": " + sc_code_text(status.code) + ": " + message + " (bake it again)");
  }
  table_.resize(sc_skin_table_words(&asset_));
  if (!table_.empty()) {
    check_runtime(sc_prepare_skin(&asset_, table_.data(), table_.size()));
    check_runtime(read_skin_table(view(), table_.data(), surface_));
  }
  std::size_t first = 0;
  for (const RestSphere& sphere : view().spheres()) {
    first_triangles_.push_back(first);
    first += sphere.triangle_count;
  }
}

Span<const std::uint32_t> OpenAsset::triangles_of(std::size_t sphere) const {
  return {surface_.triangles.data + first_triangles_[sphere], view().spheres()[sphere].triangle_count};
}

OpenAsset open_asset(const std::string& path) { return OpenAsset(read_file(path), path); }

}  // namespace spherechain::baker
