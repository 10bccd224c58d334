// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "baker/import/size.h"
#include "runtime/src/asset/asset_view.h"
#include "runtime/src/bodies/model.h"
#include "runtime/src/skin/skin_table.h"
#include "spherechain/model.h"

namespace spherechain::baker {

// Whole contents, of a file or a pipe; throws Error(kFile).
std::string read_file(const std::string& path);

// A model and its skin expanded. Moves, does not copy.
class OpenAsset {
 public:
  // Throws Error(kFile) that says what is wrong with the bytes; `name` is for the message.
  OpenAsset(std::string_view bytes, const std::string& name);
  OpenAsset(OpenAsset&&) = default;
  OpenAsset& operator=(OpenAsset&&) = default;

  // The runtime's asset, and its contents.
  const Model& model() const { return model_; }
  const sc_asset* handle() const { return &model_.asset(); }
  operator const sc_asset&() const { return model_.asset(); }
  const AssetView* operator->() const { return &view(); }
  const AssetView& view() const { return view_of(model_.asset()); }

  // Metres in one of the source's units, as the asset says or by resize().
  double metres_per_unit() const { return metres_per_unit_; }
  // The runtime keeps the asset's own size.
  void resize(const GivenSize& size);

  const std::uint64_t* skin_table() const { return model_.handle()->skin_table; }
  const Surface& surface() const { return surface_; }
  // A sphere's source triangles.
  Span<const std::uint32_t> triangles_of(std::size_t sphere) const;

 private:
  Model model_;
  Surface surface_;
  double metres_per_unit_ = 1;
  std::vector<std::size_t> first_triangles_;
};
OpenAsset open_asset(const std::string& path);

// "field: what is wrong with it".
std::string to_string(const Status& status);

// Throws Error(kInternal) where a call of the runtime failed that cannot.
void check_runtime(const Status& status);

}  // namespace spherechain::baker
