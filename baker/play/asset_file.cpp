// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/asset_file.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "runtime/src/clusters/set_up.h"

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
    : model_(bytes.data(), bytes.size(), nullptr, 0, SC_LAYOUT_UNSET) {
  if (!model_) {
    throw Error(ExitCode::kFile,
                name + ": " + code_text(model_.status()) + ": " + model_.message() + " (bake it again)");
  }
  metres_per_unit_ = double{view().info().metres_per_unit};
  if (has_skin(view())) check_runtime(read_skin_table(view(), skin_table(), surface_));
  std::size_t first = 0;
  for (const RestSphere& sphere : view().spheres()) {
    first_triangles_.push_back(first);
    first += sphere.triangle_count;
  }
}

void OpenAsset::resize(const GivenSize& size) {
  metres_per_unit_ = size.metres_per_unit(metres_per_unit_, double{view().info().height});
}

Span<const std::uint32_t> OpenAsset::triangles_of(std::size_t sphere) const {
  return {surface_.triangles.data + first_triangles_[sphere], view().spheres()[sphere].triangle_count};
}

OpenAsset open_asset(const std::string& path) { return OpenAsset(read_file(path), path); }

}  // namespace spherechain::baker
