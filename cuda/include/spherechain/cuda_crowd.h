// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/asset.h"
#include "spherechain/crowd.h"
#include "spherechain/filter.h"
#include "spherechain/refit_bones.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

struct CUstream_st;  // a cudaStream_t points to one

namespace spherechain::cuda {

class TableMemory;

// What the kernels read of an asset, for one kind of radius and one filter. It is built on the CPU into the caller's
// memory and then copied, as it is, to the device by the caller; both copies stay while jobs use them. Position
// independent: any number of devices may hold a copy. To change the filter build and copy again.
class CrowdTables {
 public:
  // Words that build() needs for that asset, whatever the filter.
  static std::size_t words_needed(const Asset& asset) noexcept;

  // `memory`: aligned to 16 bytes. `filter` null: the asset's ignored pairs, all spheres as they are. kOk, kNotOpen,
  // kBadArgument, kNullArgument, kMisaligned, kBadFilter, kContextTooSmall (`memory`); on failure this is as it was.
  // Allocates nothing.
  Status build(const Asset& asset, RadiusKind radius, const Filter* filter, Span<std::uint64_t> memory) noexcept;

  // The same for covers: groups with these tables are bounded as by a CoverJob. What they have for spheres are its
  // balls around each surrounding region, and their pairs are candidates: all pairs of spheres, not ignored and not
  // disabled, whose skins could touch in the pose; near pairs too, at any distance. What has no candidate needs no
  // narrow phase, ConfirmJob decides about the others. kNotInAsset besides: no leaves or no bones.
  static std::size_t cover_words_needed(const Asset& asset) noexcept;  // 0 where there are none
  Status build_covers(const Asset& asset, const Filter* filter, Span<std::uint64_t> memory) noexcept;

  bool is_built() const noexcept { return words_ > 0; }
  // How many words of `memory` were written: what is to be copied to the device, to a multiple of 16 bytes there.
  std::size_t words() const noexcept { return words_; }
  std::size_t sphere_count() const noexcept { return sphere_count_; }
  std::size_t bone_count() const noexcept { return bone_count_; }  // the asset's; 0: crowds of spheres only
  std::size_t morph_count() const noexcept { return morph_count_; }
  std::size_t leaf_count() const noexcept { return leaf_count_; }  // the asset's, of tables of covers; else 0
  std::size_t bit_words() const noexcept { return bit_words_; }    // DetectJob::bit_words
  // Memory of a block (32 instances from bones, 8 of spheres), in bytes, a multiple of 16, of a job with those inputs
  // and outputs: shared memory where a block of the device has as much (227 KiB on Hopper, 163 on Ampere, 99 on Ada, 64
  // on Turing), else the group's scratch.
  std::size_t shared_bytes(bool from_bones, bool with_morphs, bool with_bits, bool with_pairs) const noexcept;

 private:
  friend struct Access;  // cuda/src
  static std::size_t pivot_words_needed(const Asset& asset) noexcept;
  static std::size_t moment_words_needed(const Asset& asset) noexcept;
  void add_pivots(const Asset& asset, RadiusKind radius, TableMemory& entries) noexcept;
  void add_moments(const Asset& asset, RadiusKind radius, TableMemory& entries) noexcept;

  std::size_t words_ = 0;
  std::uint32_t sphere_count_ = 0, bone_count_ = 0, morph_count_ = 0, bit_words_ = 0;
  std::uint32_t used_bone_count_ = 0, item_count_ = 0, near_count_ = 0, leaf_count_ = 0;
  std::uint32_t sphere_entries_at_ = 0, paddings_at_ = 0, groups_at_ = 0, terms_at_ = 0, term_matrices_at_ = 0,
                used_bones_at_ = 0, items_at_ = 0, near_at_ = 0, unit_places_at_ = 0, wanted_at_ = 0,
                origin_sphere_ = 0;
  std::uint32_t morph_counts_at_ = 0, morph_targets_at_ = 0, morph_terms_at_ = 0;
  std::uint32_t covers_at_ = 0, leaves_at_ = 0, leaf_terms_at_ = 0, leaf_morphs_at_ = 0;
  std::uint32_t run_count_ = 0, reference_ = 0, runs_at_ = 0, run_spheres_at_ = 0, moment_steps_at_ = 0,
                moments_at_ = 0, run_bones_at_ = 0,
                center_terms_at_ = 0;  // words from the start
  Vec3 origin_{};
  bool calibrated_ = false, has_padding_ = false, has_morphs_ = false;
};

// Instances of one asset. All pointers but `tables` are to memory the device can read or write; matrices, spheres and
// bounds aligned to 16 bytes are read and written fastest.
struct CrowdGroup {
  const CrowdTables* tables = nullptr;           // on the host
  const std::uint64_t* device_tables = nullptr;  // its words' copy on the device, aligned to 16 bytes
  std::size_t instance_count = 0;

  // Either: instance i's spheres are spheres[i * stride] and on, from refits with the tables' kind of radius.
  const Sphere* spheres = nullptr;
  std::size_t stride = 0;  // at least the asset's spheres, or 0: as many

  // Or: instance 0's matrices, and the bytes from one instance's first matrix to the next's, a multiple of 4, at least
  // what the asset's bones take. Morph weights: CrowdTables::morph_count() an instance, or null.
  BoneMatrices bones;
  std::size_t instance_stride = 0;
  const float* morph_weights = nullptr;

  // Out, each may be null.
  Sphere* refitted = nullptr;  // with bones: as many an instance as the asset has, without the filter's padding
  Sphere* leaves = nullptr;    // with tables of covers: CrowdTables::leaf_count() an instance, CoverJob's balls
  // One an instance, around its spheres with the filter's padding; no numbers are left out, and spheres padded to below
  // 0 need not be in it.
  Sphere* bounds = nullptr;
  std::uint32_t* counts = nullptr;  // pairs of each instance
  std::uint64_t* bits = nullptr;    // CrowdTables::bit_words() words an instance, as DetectJob::bits

  // Out: a list. Each instance's pairs follow one another, sorted; `starts` says where, for the instances come in any
  // order. Needs counts, starts and pair_count.
  CrowdPair* pairs = nullptr;
  std::size_t pair_capacity = 0;
  std::uint64_t* starts = nullptr;      // one an instance
  std::uint64_t* pair_count = nullptr;  // how many there are; more than pair_capacity: those past it were left out

  // For assets too large for the device's shared memory (from about 210 spheres on Hopper where they come from bones,
  // 400 where they do not): memory of the device, aligned to 16 bytes, CrowdTables::shared_bytes() for each block that
  // is to run at once, of which two a multiprocessor are enough. No other group and no other job that may run at the
  // same time may use it. Not touched where shared memory does.
  void* scratch = nullptr;
  std::size_t scratch_bytes = 0;
};

// Refit from bones and M2 of whole crowds in one launch: for each instance exactly the spheres of a RefitBonesJob and
// the pairs of a DetectJob, bit for bit. A sphere that is not finite touches nothing. With tables of covers exactly the
// balls of a CoverJob (where its are no number so are these) and all pairs of them but those surely apart: what is not
// finite is not. Groups with tables of both kinds may share a launch.
//
// run() enqueues on `stream` (null: the default stream) of the current device one kernel, one more where groups run
// from scratch, and, for each group with pairs, the clearing of its count, and returns; it allocates nothing, waits for
// nothing and may be captured into a graph. Outputs may be read when the stream has got there; they must not share
// memory with inputs or each other.
struct CrowdJob {
  static constexpr std::size_t kMostGroups = 8;

  Span<const CrowdGroup> groups;  // at most kMostGroups
  CUstream_st* stream = nullptr;

  // kOk, kNullArgument, kBadArgument (both spheres and bones, too many groups, a count that does not fit), kNotOpen
  // (tables not built), kNotInAsset, kTooFewBones, kBadStride, kTooFewSpheres (a stride), kMisaligned, kNoDevice,
  // kDeviceTooSmall (a group that needs scratch has none, or 4 GiB or more a block), kContextTooSmall (less than a
  // block's): nothing was enqueued. kDeviceFailed: the device or its driver reported an error; see last_device_error().
  Status run() const noexcept;
};

}  // namespace spherechain::cuda
