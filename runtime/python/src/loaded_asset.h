// SPDX-License-Identifier: MIT
// A model, its bytes, and bodies of it that are kept from call to call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "asset/asset_view.h"
#include "skin/skin_table.h"
#include "spherechain/spherechain.h"

namespace spherechain::python {

// Throws std::invalid_argument, which Python sees as ValueError: "pose.bones: too small".
void require(const Status& status);

// Threads may call everything at once.
class LoadedAsset {
 public:
  // Copies the bytes. Throws std::invalid_argument with the sentence of sc_create_model().
  explicit LoadedAsset(std::string bytes);
  LoadedAsset(const LoadedAsset&) = delete;
  LoadedAsset& operator=(const LoadedAsset&) = delete;

  const Model& model() const { return model_; }
  const Asset& asset() const { return model_.asset(); }
  const AssetView& view() const { return view_of(asset()); }
  const AssetInfo& info() const { return info_; }
  const std::string& bytes() const { return bytes_; }
  const std::uint64_t* detect_table(Radius radius) const;  // null: there is none
  Surface surface() const;

  // A body with room for all penetrations of this model, alone or with another. Bodies for steps, or for a larger
  // model, are made anew; the others are kept.
  std::unique_ptr<Body> take_body(const LoadedAsset* other, bool finds_steps, std::size_t max_triangles) const;
  void give_back(std::unique_ptr<Body> body) const;

 private:
  std::string bytes_;
  Model model_;
  AssetInfo info_{};
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Body>> spare_;
};

}  // namespace spherechain::python
