// SPDX-License-Identifier: MIT
#include "skin/scene_setup.h"

#include <cstring>
#include <initializer_list>

#include "pairs/pair_bits.h"

namespace spherechain {
namespace {

// Hands out parts of the context; or, of none, counts how much they are.
class Scratch {
 public:
  explicit Scratch(std::uint64_t* words) : words_(words) {}

  template <typename T>
  T* take(std::size_t count) {
    T* out = words_ == nullptr ? nullptr : reinterpret_cast<T*>(words_ + used_);
    used_ += (count * sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
    return out;
  }
  // The same, from a multiple of 64 bytes on.
  template <typename T>
  T* take_aligned(std::size_t count) {
    constexpr std::size_t kLine = 64 / sizeof(std::uint64_t);
    const auto misplaced = reinterpret_cast<std::uintptr_t>(words_ + used_) / sizeof(std::uint64_t) % kLine;
    used_ += words_ == nullptr ? kLine - 1 : (kLine - misplaced) % kLine;
    return take<T>(count);
  }
  std::size_t used() const { return used_; }

 private:
  std::uint64_t* words_;
  std::size_t used_ = 0;
};

void lay_out(const AssetView& asset, Scratch& scratch, ContactScene& scene, PartTable& parts) {
  const SkinSizes& sizes = asset.skin().sizes;
  scene.sphere_count = asset.spheres().size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (float** column : {&scene.spheres.low[axis], &scene.spheres.high[axis]}) {
      *column = scratch.take_aligned<float>(scene.sphere_count + kContactPadding);
    }
    for (float** column : {&scene.clusters.low[axis], &scene.clusters.high[axis]}) {
      *column = scratch.take_aligned<float>(sizes.clusters + kContactPadding);
    }
  }
  scene.first_cluster = scratch.take<std::uint32_t>(scene.sphere_count + 1);
  scene.is_loaded = scratch.take<std::uint8_t>(sizes.clusters);
  scene.is_bounded = scratch.take<std::uint8_t>(scene.sphere_count);
  scene.spans = scratch.take_aligned<float>(2 * kSpanLanes * sizes.clusters);
  scene.slots = scratch.take_aligned<float>(3 * sizes.slots + 3 * (kSlotLanes * sizes.clusters + kContactPadding));
  parts.part_count = asset.part_count();
  parts.word_count = words_for(part_pairs(parts.part_count));
  parts.seen = scratch.take<std::uint64_t>(parts.word_count);
  parts.contacts = scratch.take<sc_part_contact>(part_pairs(parts.part_count));
  if (asset.bone_count() == 0) {
    return;
  }
  scene.bone_sizes = scratch.take<BoneSize>(asset.bone_count());
  for (float*& column : scene.ball_columns) {
    column = scratch.take_aligned<float>(sizes.clusters + kContactPadding);
  }
  const std::size_t groups = asset.skin().bounds_term_counts.size;
  scene.group_terms = scratch.take<std::uint32_t>(groups);
  scene.is_group_bounded = scratch.take<std::uint8_t>(groups);
  scene.columns = scratch.take_aligned<float>(kColumnFloats * asset.bone_count());
  scene.hulls = scratch.take_aligned<float>(3 * sizes.hull_points);
  scene.hull_margins = scratch.take<float>(scene.sphere_count);
}

bool are_zero(const float* weights, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (weights[i] != 0.0F) {  // so is what is not a number
      return false;
    }
  }
  return true;
}

void find_first_clusters(const Surface& surface, ContactScene& scene) {
  if (surface.hulls.size > 0) {
    for (std::size_t sphere = 0; sphere < scene.sphere_count; ++sphere) {
      scene.first_cluster[sphere] = surface.hulls[sphere].first_cluster;
    }
    scene.first_cluster[scene.sphere_count] = static_cast<std::uint32_t>(surface.clusters.size);
    return;
  }
  std::size_t cluster = 0;
  for (std::size_t sphere = 0; sphere <= scene.sphere_count; ++sphere) {
    while (cluster < surface.clusters.size && surface.clusters[cluster].sphere < sphere) {
      ++cluster;
    }
    scene.first_cluster[sphere] = static_cast<std::uint32_t>(cluster);
  }
}

void prepare_hulls(const AssetView& asset, const Surface& surface, ContactScene& scene) {
  scene.has_hulls = true;
  const Span<const std::uint32_t> term_counts = surface.bounds_term_counts;
  std::memset(scene.is_group_bounded, 0, term_counts.size);
  std::uint32_t term = 0;
  for (std::size_t group = 0; group < term_counts.size; ++group) {
    scene.group_terms[group] = term;
    term += term_counts[group];
  }
  const BoundsInputs& in = scene.bounds;
  for (std::size_t bone = 0; bone < asset.bone_count(); ++bone) {
    const float* const matrix = in.matrices + bone * in.stride;
    float* const columns = scene.columns + kColumnFloats * bone;
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t i = 0; i < 3; ++i) {
        columns[4 * j + i] = matrix[i * in.row + j * in.column];
      }
      columns[4 * j + 3] = 0;
    }
  }
}

}  // namespace

std::size_t skin_scratch_words(const AssetView& asset) {
  if (!asset.is_open() || asset.skin().sizes.clusters == 0) {
    return 0;
  }
  ContactScene scene;
  PartTable parts{};
  Scratch scratch(nullptr);
  lay_out(asset, scratch, scene, parts);
  return scratch.used();
}

ContactScene scene_of(const AssetView& asset, const Surface& surface, const Pose& pose, const Filter* filter,
                      std::uint64_t* words, PartTable& parts) {
  ContactScene scene;
  Scratch scratch(words);
  lay_out(asset, scratch, scene, parts);
  std::memset(parts.seen, 0, parts.word_count * sizeof(std::uint64_t));
  scene.surface = &surface;
  scene.positions = pose.vertices;
  scene.stride = vertex_stride(pose) / sizeof(float);
  std::memset(scene.is_loaded, 0, surface.clusters.size);
  std::memset(scene.is_bounded, 0, scene.sphere_count);
  find_first_clusters(surface, scene);
  scene.ignored = asset.ignored();
  if (filter != nullptr) {
    scene.ignored = {filter->ignored, filter->ignored_words};
    scene.disabled = {filter->disabled, filter->disabled_words};
  }
  if (pose.bones != nullptr) {
    scene.skin = skin_inputs(surface, pose);
    scene.has_balls = true;
    scene.bounds = bounds_inputs(asset, surface, pose, scene.bone_sizes);
    const bool morphs = scene.bounds.morph_counts != nullptr && !are_zero(pose.morph_weights, asset.morph_count());
    if (!morphs) {
      prepare_hulls(asset, surface, scene);
    }
  }
  return scene;
}

}  // namespace spherechain
