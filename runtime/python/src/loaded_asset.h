// SPDX-License-Identifier: MIT
// An asset that owns its bytes, and what its jobs share: tables, made when they are first asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <vector>

#include "asset/asset_view.h"
#include "skin/skin_table.h"
#include "spherechain/spherechain.h"

namespace spherechain::python {

// Throws std::invalid_argument, which Python sees as ValueError: "pose.bones: too small".
void require(const Status& status);

// Of 64-bit words from a cache line on, not set to anything.
class Words {
 public:
  Words() = default;
  explicit Words(std::size_t count)
      : words_(static_cast<std::uint64_t*>(::operator new[](count * 8, kLine))), size_(count) {}
  std::uint64_t* data() const { return words_.get(); }
  std::size_t size() const { return size_; }

 private:
  static constexpr std::align_val_t kLine{64};
  struct Free {
    void operator()(std::uint64_t* words) const { ::operator delete[](words, kLine); }
  };
  std::unique_ptr<std::uint64_t, Free> words_;
  std::size_t size_ = 0;
};

// Memory of one thread that looks for contacts. Kept from call to call.
struct ContactMemory {
  Words skin, depth;
  std::vector<TriangleContact> triangles;
  std::vector<Penetration> penetrations;
};

class LoadedAsset {
 public:
  // Copies the bytes. Throws std::invalid_argument with the sentence of sc_asset_open().
  explicit LoadedAsset(const std::string& bytes);
  LoadedAsset(const LoadedAsset&) = delete;
  LoadedAsset& operator=(const LoadedAsset&) = delete;

  const Asset& asset() const { return asset_; }
  const AssetView& view() const { return view_of(asset_); }
  const AssetInfo& info() const { return info_; }
  std::string bytes() const { return {reinterpret_cast<const char*>(bytes_.data()), size_}; }

  // The tables below may be asked for by several threads at once.
  const std::uint64_t* detect_table(Radius radius) const;
  const std::uint64_t* skin_table() const;
  Surface surface() const;  // of the skin table

  std::unique_ptr<ContactMemory> take_memory() const;
  void give_back(std::unique_ptr<ContactMemory> memory) const;

 private:
  Words bytes_;
  std::size_t size_;
  Asset asset_;
  AssetInfo info_{};
  mutable std::once_flag made_detect_[2], made_skin_;
  mutable Words detect_[2], skin_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<ContactMemory>> spare_;
};

}  // namespace spherechain::python
