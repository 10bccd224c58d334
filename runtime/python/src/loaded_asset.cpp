// SPDX-License-Identifier: MIT
#include "loaded_asset.h"

#include <cstring>
#include <stdexcept>

namespace spherechain::python {

void require(const Status& status) {
  if (status.code == SC_NO_MEMORY) {
    throw std::bad_alloc();
  }
  if (status != SC_OK) {
    throw std::invalid_argument(std::string(sc_field_name(status.field)) + ": " + sc_code_text(status.code));
  }
}

LoadedAsset::LoadedAsset(const std::string& bytes) : bytes_((bytes.size() + 7) / 8), size_(bytes.size()) {
  std::memcpy(bytes_.data(), bytes.data(), bytes.size());
  char message[256] = "";
  if (sc_asset_open(&asset_, SC_ABI_VERSION, bytes_.data(), size_, message, sizeof message) != SC_OK) {
    throw std::invalid_argument(message);
  }
  info_ = sc_asset_get_info(&asset_);
}

const std::uint64_t* LoadedAsset::detect_table(Radius radius) const {
  Words& words = detect_[radius];
  std::call_once(made_detect_[radius], [&] {
    words = Words(sc_detect_table_words(&asset_));
    require(sc_prepare_detect(&asset_, radius, nullptr, words.data(), words.size()));
  });
  return words.data();
}

const std::uint64_t* LoadedAsset::skin_table() const {
  std::call_once(made_skin_, [&] {
    Words words(sc_skin_table_words(&asset_));
    require(sc_prepare_skin(&asset_, words.data(), words.size()));
    skin_ = std::move(words);
  });
  return skin_.data();
}

Surface LoadedAsset::surface() const {
  Surface surface;
  require(read_skin_table(view(), skin_table(), surface));
  return surface;
}

std::unique_ptr<ContactMemory> LoadedAsset::take_memory() const {
  const std::lock_guard lock(mutex_);
  if (spare_.empty()) {
    return std::make_unique<ContactMemory>();
  }
  std::unique_ptr<ContactMemory> memory = std::move(spare_.back());
  spare_.pop_back();
  return memory;
}

void LoadedAsset::give_back(std::unique_ptr<ContactMemory> memory) const {
  const std::lock_guard lock(mutex_);
  spare_.push_back(std::move(memory));
}

}  // namespace spherechain::python
