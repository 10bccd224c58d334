// SPDX-License-Identifier: MIT
// The contents of an open sc_asset: spans into the asset's bytes. Private to this repository: runtime, cuda, baker,
// tests.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/asset/moment_tables.h"
#include "runtime/src/asset/skin_data.h"
#include "runtime/src/base/span.h"
#include "spherechain/asset.h"

namespace spherechain {

class Message;
namespace schema {
struct Asset;
}

inline constexpr std::uint32_t kFormatVersion = 7;
inline constexpr std::uint32_t kMaxSphereCount = 65535, kMaxPartCount = 255;

enum class RefitRule : std::uint8_t { kPaper = 0, kMoments = 1 };

struct Pivot {
  std::uint32_t a, b, c;
  float weight;
};

struct RestSphere {
  Vec3 center;
  float radius;
  float detect_radius;
  float pivot_spread;
  std::uint32_t first_pivot;
  std::uint32_t triangle_count;
  std::uint16_t pivot_count;
  std::uint8_t region;
  std::uint8_t side;  // of Side
  std::int16_t level;
  std::uint8_t part;
  std::uint8_t reserved;
};

struct RestPair {
  std::uint32_t a, b;
  float rest_scale;
};

struct ChainView {
  const char* name;
  Span<const std::uint8_t> regions;
  Span<const std::uint32_t> spheres;
};

struct RegionView {
  const char* name;
  std::uint32_t triangle_count;
};

struct JointView {
  const char* name;
  std::int32_t parent;
  Vec3 position, tail;
};

struct BoneView {
  const char* name;
  const float* inverse_bind;
  bool is_rest;
};

struct PieceView {
  const char* name;
  float border;
};

struct FitError {
  float mean_abs_f, max_abs_f;
};

// The paper's figures.
struct FitErrors {
  FitError phi1, phi1_adjusted, phi2;
};

class AssetView {
 public:
  Status open(const void* data, std::size_t size, Message& message) noexcept;
  bool is_open() const noexcept { return root_ != nullptr; }

  // The accessors below need an open asset.
  AssetInfo info() const noexcept;
  FitErrors fit() const noexcept;
  Span<const RestSphere> spheres() const noexcept { return spheres_; }
  Span<const Pivot> pivots() const noexcept { return pivots_; }
  Span<const std::uint64_t> ignored() const noexcept { return ignored_; }
  std::size_t ignored_count() const noexcept { return ignored_count_; }
  Span<const RestPair> rest_pairs(Radius radius) const noexcept {
    return radius == SC_RADIUS_FIT ? rest_fit_ : rest_detect_;
  }
  Span<const sc_source_buffer> source_buffers() const noexcept { return source_buffers_; }
  std::size_t vertex_count() const noexcept { return vertex_count_; }  // of the source
  std::size_t region_count() const noexcept;
  RegionView region(std::size_t i) const noexcept;
  std::size_t part_count() const noexcept { return part_count_; }
  BodyPart part(std::size_t i) const noexcept;
  std::size_t chain_count() const noexcept;
  ChainView chain(std::size_t i) const noexcept;
  std::size_t joint_count() const noexcept;
  JointView joint(std::size_t i) const noexcept;
  std::size_t bone_count() const noexcept { return bone_count_; }
  BoneView bone(std::size_t i) const noexcept;
  std::size_t morph_count() const noexcept { return morph_count_; }
  const char* morph_name(std::size_t i) const noexcept;
  std::size_t piece_count() const noexcept;  // of the skin; 0 in a draft
  PieceView piece(std::size_t i) const noexcept;
  RefitRule refit_rule() const noexcept { return refit_rule_; }
  const MomentTables& moment_tables() const noexcept { return moment_tables_; }  // empty under kPaper
  const SkinData& skin() const noexcept { return skin_; }

 private:
  void view(const schema::Asset& root) noexcept;

  const schema::Asset* root_ = nullptr;
  Span<const RestSphere> spheres_;
  Span<const Pivot> pivots_;
  Span<const std::uint64_t> ignored_;
  std::size_t ignored_count_ = 0, vertex_count_ = 0, part_count_ = 0, bone_count_ = 0, morph_count_ = 0;
  RefitRule refit_rule_ = RefitRule::kPaper;
  Span<const RestPair> rest_fit_, rest_detect_;
  Span<const sc_source_buffer> source_buffers_;
  MomentTables moment_tables_;
  SkinData skin_;
};

static_assert(sizeof(AssetView) <= sizeof(sc_asset) && alignof(AssetView) <= alignof(sc_asset));

// Whether the program was compiled with headers that this library serves; else writes a sentence.
Status check_abi(std::uint32_t abi, Message& message);

inline const AssetView& view_of(const sc_asset& asset) { return *reinterpret_cast<const AssetView*>(&asset); }
inline bool is_open(const sc_asset* asset) { return asset != nullptr && view_of(*asset).is_open(); }

}  // namespace spherechain
