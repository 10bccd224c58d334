// SPDX-License-Identifier: MIT
#include "spherechain/triangle_contacts.h"

#include <cstring>

#include "arithmetic.h"
#include "bone_refit.h"
#include "contact_collector.h"
#include "memory.h"
#include "simd.h"
#include "spherechain/cover.h"
#include "stride.h"
#include "triangle_bits.h"

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
  scene.slots = scratch.take_aligned<float>(surface.slot_positions.size +
                                            3 * (kSlotLanes * surface.leaves.size + kContactPadding));
  if (asset.bone_count() == 0) {
    return;
  }
  scene.balls = scratch.take<Sphere>(surface.leaves.size);
  for (float*& column : scene.ball_columns) {
    column = scratch.take<float>(surface.leaves.size + kContactPadding);
  }
}

// The vertices, or the bones.
Status check_pose(const TriangleContactJob& job) {
  if (job.positions == nullptr) {
    return check_bone_inputs(job.asset, job.bones, job.morph_weights, RadiusKind::kFit);
  }
  if (any_misaligned(job.positions)) {
    return Status::kMisaligned;
  }
  if (!is_valid_stride(job.stride)) {
    return Status::kBadStride;
  }
  return job.vertex_count < job.asset->info().source_vertex_count ? Status::kTooFewVertices : Status::kOk;
}

MemoryRange range_of_positions(const TriangleContactJob& job) {
  const auto begin = reinterpret_cast<std::uintptr_t>(job.positions);
  const std::size_t count = job.asset->info().source_vertex_count;
  return count == 0 ? MemoryRange{} : MemoryRange{begin, begin + (count - 1) * job.stride + 3 * sizeof(float)};
}

bool shares_memory(const TriangleContactJob& job) {
  const Span<std::uint64_t> words{job.context->words.data, TriangleContactContext::words_needed(*job.asset)};
  const MemoryRange written[] = {range_of(job.pairs), range_of(job.contacts), range_of(job.sphere_contacts),
                                 range_of(words)};
  const bool from_bones = job.positions == nullptr;
  const MemoryRange read[] = {
      from_bones ? range_of_matrices(job.bones, job.asset->bone_count()) : range_of_positions(job),
      from_bones ? range_of(job.morph_weights) : MemoryRange{},
      range_of(job.asset->triangles()),
      range_of(job.asset->ignored()),
      job.filter == nullptr ? MemoryRange{} : range_of(job.filter->ignored),
      job.filter == nullptr ? MemoryRange{} : range_of(job.filter->disabled)};
  return any_shared(written, read);
}

Status check(const TriangleContactJob& job, Target& resolved) {
  if (job.asset == nullptr || job.context == nullptr || is_missing(job.context->words) || is_missing(job.pairs) ||
      is_missing(job.contacts) || is_missing(job.sphere_contacts)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(job.context->words.data, job.pairs.data, job.contacts.data, job.sphere_contacts.data)) {
    return Status::kMisaligned;
  }
  if (job.asset->leaf_count() == 0) {
    return Status::kNotInAsset;
  }
  const Status status = check_pose(job);
  if (status != Status::kOk) {
    return status;
  }
  if (job.filter != nullptr) {
    const Status filter_status = check_filter(*job.asset, *job.filter);
    if (filter_status != Status::kOk) {
      return filter_status;
    }
  }
  if (job.context->words.size < TriangleContactContext::words_needed(*job.asset)) {
    return Status::kContextTooSmall;
  }
  if (!resolve_target(job.target, resolved)) {
    return Status::kUnsupportedTarget;
  }
  return shares_memory(job) ? Status::kSharedMemory : Status::kOk;
}

// Bounds the leaves in the pose: what is left to do is told by the kernel.
void cover(const TriangleContactJob& job, Target resolved, ContactScene& scene) {
  CoverJob cover;
  cover.asset = job.asset;
  cover.bones = job.bones;
  cover.morph_weights = job.morph_weights;
  cover.target = resolved;
  cover.leaves = {scene.balls, job.asset->leaf_count()};
  (void)cover.run();  // checked already
  scene.skin = skin_inputs(*job.asset, job.bones, job.morph_weights);
}

ContactScene scene_of(const TriangleContactJob& job, Target resolved) {
  ContactScene scene;
  Scratch scratch(job.context->words.data);
  lay_out(*job.asset, scratch, scene);
  scene.ignored = job.asset->ignored();
  if (job.filter != nullptr) {
    scene.ignored = {job.filter->ignored.data, job.filter->ignored.size};
    scene.disabled = {job.filter->disabled.data, job.filter->disabled.size};
  }
  scene.positions = job.positions;
  scene.stride = job.stride / sizeof(float);
  const Span<const Leaf> leaves = job.asset->surface().leaves;
  std::memset(scene.is_loaded, 0, leaves.size);
  std::size_t leaf = 0;
  for (std::size_t sphere = 0; sphere <= scene.sphere_count; ++sphere) {
    while (leaf < leaves.size && leaves[leaf].sphere < sphere) {
      ++leaf;
    }
    scene.first_leaf[sphere] = static_cast<std::uint32_t>(leaf);
  }
  if (job.positions == nullptr) {
    cover(job, resolved, scene);
  }
  return scene;
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

Status TriangleContactJob::run() noexcept {
  Target resolved{};
  const Status status = check(*this, resolved);
  if (status != Status::kOk) {
    return status;
  }
  const ContactScene scene = scene_of(*this, resolved);
  ContactCollector collector(*asset, pairs, contacts, sphere_contacts);
  find_candidates(resolved, scene, collector);
  collector.finish();
  pair_count = collector.pair_count();
  sphere_contact_count = collector.sphere_contact_count();
  return collector.overflowed() ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain
