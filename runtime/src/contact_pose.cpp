// SPDX-License-Identifier: MIT
#include "contact_pose.h"

#include <cstring>
#include <initializer_list>

#include "bone_refit.h"
#include "stride.h"

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

void lay_out(const Asset& asset, Scratch& scratch, ContactScene& scene) {
  const Surface& surface = asset.surface();
  scene.surface = &surface;
  scene.sphere_count = asset.spheres().size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (float** column : {&scene.spheres.low[axis], &scene.spheres.high[axis]}) {
      *column = scratch.take_aligned<float>(scene.sphere_count + kContactPadding);
    }
    for (float** column : {&scene.leaves.low[axis], &scene.leaves.high[axis]}) {
      *column = scratch.take_aligned<float>(surface.leaves.size + kContactPadding);
    }
  }
  scene.first_leaf = scratch.take<std::uint32_t>(scene.sphere_count + 1);
  scene.is_loaded = scratch.take<std::uint8_t>(surface.leaves.size);
  scene.is_bounded = scratch.take<std::uint8_t>(scene.sphere_count);
  scene.spans = scratch.take_aligned<float>(2 * kSpanLanes * surface.leaves.size);
  scene.slots = scratch.take_aligned<float>(surface.slot_positions.size +
                                            3 * (kSlotLanes * surface.leaves.size + kContactPadding));
  if (asset.bone_count() == 0) {
    return;
  }
  scene.bone_sizes = scratch.take<BoneSize>(asset.bone_count());
  for (float*& column : scene.ball_columns) {
    column = scratch.take_aligned<float>(surface.leaves.size + kContactPadding);
  }
  if (surface.outlines.size == 0) {
    return;
  }
  scene.group_terms = scratch.take<std::uint32_t>(surface.cover_term_counts.size);
  scene.is_group_bounded = scratch.take<std::uint8_t>(surface.cover_term_counts.size);
  scene.columns = scratch.take_aligned<float>(kColumnFloats * asset.bone_count());
  scene.outlines = scratch.take_aligned<float>(surface.outline_points.size);
  scene.outline_margins = scratch.take<float>(scene.sphere_count);
}

bool are_zero(Span<const float> weights) {
  for (const float weight : weights) {
    if (weight != 0.0F) {  // so is what is not a number
      return false;
    }
  }
  return true;
}

void find_first_leaves(const Surface& surface, ContactScene& scene) {
  if (surface.outlines.size > 0) {
    for (std::size_t sphere = 0; sphere < scene.sphere_count; ++sphere) {
      scene.first_leaf[sphere] = surface.outlines[sphere].first_leaf;
    }
    scene.first_leaf[scene.sphere_count] = static_cast<std::uint32_t>(surface.leaves.size);
    return;
  }
  std::size_t leaf = 0;
  for (std::size_t sphere = 0; sphere <= scene.sphere_count; ++sphere) {
    while (leaf < surface.leaves.size && surface.leaves[leaf].sphere < sphere) {
      ++leaf;
    }
    scene.first_leaf[sphere] = static_cast<std::uint32_t>(leaf);
  }
}

void prepare_outlines(const ContactPose& pose, ContactScene& scene) {
  scene.has_outlines = true;
  const Span<const std::uint32_t> term_counts = pose.asset->surface().cover_term_counts;
  std::memset(scene.is_group_bounded, 0, term_counts.size);
  std::uint32_t term = 0;
  for (std::size_t group = 0; group < term_counts.size; ++group) {
    scene.group_terms[group] = term;
    term += term_counts[group];
  }
  const CoverInputs& in = scene.cover;
  for (std::size_t bone = 0; bone < pose.asset->bone_count(); ++bone) {
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

std::size_t TriangleContactContext::words_needed(const Asset& asset) noexcept {
  if (asset.leaf_count() == 0) {
    return 0;
  }
  ContactScene scene;
  Scratch scratch(nullptr);
  lay_out(asset, scratch, scene);
  return scratch.used();
}

Status check_pose(const ContactPose& pose) {
  if (pose.positions == nullptr) {
    return check_bone_inputs(pose.asset, pose.bones, pose.morph_weights, RadiusKind::kFit);
  }
  if (any_misaligned(pose.positions)) {
    return Status::kMisaligned;
  }
  if (!is_valid_stride(pose.stride)) {
    return Status::kBadStride;
  }
  if (pose.vertex_count < pose.asset->info().source_vertex_count) {
    return Status::kTooFewVertices;
  }
  return pose.bones.data == nullptr ? Status::kOk
                                    : check_bone_inputs(pose.asset, pose.bones, pose.morph_weights, RadiusKind::kFit);
}

PoseRanges ranges_of(const ContactPose& pose) {
  PoseRanges out{};
  const std::size_t count = pose.asset->info().source_vertex_count;
  if (pose.positions != nullptr && count > 0) {
    const auto begin = reinterpret_cast<std::uintptr_t>(pose.positions);
    out.positions = {begin, begin + (count - 1) * pose.stride + 3 * sizeof(float)};
  }
  if (pose.bones.data != nullptr) {
    out.matrices = range_of_matrices(pose.bones, pose.asset->bone_count());
    out.morph_weights = range_of(pose.morph_weights);
  }
  return out;
}

ContactScene scene_of(const ContactPose& pose, Span<std::uint64_t> words) {
  ContactScene scene;
  Scratch scratch(words.data);
  lay_out(*pose.asset, scratch, scene);
  scene.positions = pose.positions;
  scene.stride = pose.stride / sizeof(float);
  const Span<const Leaf> leaves = pose.asset->surface().leaves;
  std::memset(scene.is_loaded, 0, leaves.size);
  std::memset(scene.is_bounded, 0, scene.sphere_count);
  find_first_leaves(pose.asset->surface(), scene);
  if (pose.bones.data != nullptr) {
    scene.skin = skin_inputs(*pose.asset, pose.bones, pose.morph_weights);
    scene.has_balls = true;
    scene.cover =
        cover_inputs(*pose.asset, pose.bones, pose.morph_weights, {scene.bone_sizes, pose.asset->bone_count()});
    if (scene.outlines != nullptr && (scene.cover.morph_counts == nullptr || are_zero(pose.morph_weights))) {
      prepare_outlines(pose, scene);
    }
  }
  return scene;
}

ContactScene scene_of_all(const ContactPose& pose, const Filter* filter, Span<std::uint64_t> words) {
  ContactScene scene = scene_of(pose, words);
  scene.ignored = pose.asset->ignored();
  if (filter != nullptr) {
    scene.ignored = {filter->ignored.data, filter->ignored.size};
    scene.disabled = {filter->disabled.data, filter->disabled.size};
  }
  return scene;
}

}  // namespace spherechain
