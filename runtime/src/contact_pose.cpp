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
      *column = scratch.take<float>(scene.sphere_count + kContactPadding);
    }
    for (float** column : {&scene.leaves.low[axis], &scene.leaves.high[axis]}) {
      *column = scratch.take<float>(surface.leaves.size + kContactPadding);
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
    column = scratch.take<float>(surface.leaves.size + kContactPadding);
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
  std::size_t leaf = 0;
  for (std::size_t sphere = 0; sphere <= scene.sphere_count; ++sphere) {
    while (leaf < leaves.size && leaves[leaf].sphere < sphere) {
      ++leaf;
    }
    scene.first_leaf[sphere] = static_cast<std::uint32_t>(leaf);
  }
  if (pose.bones.data != nullptr) {
    scene.skin = skin_inputs(*pose.asset, pose.bones, pose.morph_weights);
    scene.has_balls = true;
    scene.cover =
        cover_inputs(*pose.asset, pose.bones, pose.morph_weights, {scene.bone_sizes, pose.asset->bone_count()});
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
