// SPDX-License-Identifier: MIT
#include "loaded_asset.h"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "body/model.h"
#include "skin/scene_setup.h"

namespace spherechain::python {

void require(const Status& status) {
  if (status.code == SC_NO_MEMORY) {
    throw std::bad_alloc();
  }
  if (status != SC_OK) {
    throw std::invalid_argument(std::string(sc_field_name(status.field)) + ": " + sc_code_text(status.code));
  }
}

LoadedAsset::LoadedAsset(std::string bytes)
    : bytes_(std::move(bytes)), model_(bytes_.data(), bytes_.size(), nullptr, 0, SC_LAYOUT_UNSET) {
  if (!model_) {
    throw std::invalid_argument(model_.message());
  }
  info_ = model_.info();
}

const std::uint64_t* LoadedAsset::detect_table(Radius radius) const {
  return radius == SC_RADIUS_DETECT ? model_.handle()->detect_table : nullptr;
}

Surface LoadedAsset::surface() const {
  Surface surface;
  if (has_skin(view())) {
    require(read_skin_table(view(), model_.handle()->skin_table, surface));
  } else {
    require({SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  }
  return surface;
}

std::unique_ptr<Body> LoadedAsset::take_body(const LoadedAsset* other, bool finds_steps,
                                             std::size_t max_triangles) const {
  const bool is_kept = (other == nullptr || other == this) && !finds_steps && max_triangles == 0;
  if (is_kept) {
    const std::lock_guard lock(mutex_);
    if (!spare_.empty()) {
      std::unique_ptr<Body> body = std::move(spare_.back());
      spare_.pop_back();
      return body;
    }
  }
  const std::size_t others = other == nullptr ? 0 : other->info().part_count;
  BodyDef def;
  def.max_triangles = max_triangles;
  def.max_penetrations = std::max<std::size_t>(1, info_.part_count * std::max(info_.part_count + 1, others));
  def.largest_other = other == nullptr ? nullptr : other->model().handle();
  def.finds_steps = finds_steps ? 1 : 0;
  auto body = std::make_unique<Body>(model_, def);
  require(body->status());
  return body;
}

void LoadedAsset::give_back(std::unique_ptr<Body> body) const {
  const std::lock_guard lock(mutex_);
  spare_.push_back(std::move(body));
}

}  // namespace spherechain::python
