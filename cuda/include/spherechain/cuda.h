// SPDX-License-Identifier: MIT
// Crowds on a CUDA device: bones or spheres in, touching pairs out. The device gives the same spheres and pairs as
// sc_find_sphere_pairs() on the CPU, bit for bit (docs/arithmetic.md). C++17.
//
// A program that links this library starts on machines without a GPU or a driver; only what is enqueued needs a device.
// All threads may call everything at once, with other output memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/crowd.h"

struct CUstream_st;  // a cudaStream_t points to one

namespace spherechain::cuda {

// Whether the current device can run crowds: SC_OK, or SC_NO_DEVICE where there is no device or driver, or one that is
// too old for this library.
Status check_device() noexcept;

// The CUDA runtime's text for the last SC_NO_DEVICE or SC_DEVICE_FAILED on this thread, in English; "no error" before
// the first. Never null.
const char* last_device_error() noexcept;

// Fills a table for crowds of this asset and radius, with all that `ignored_pairs` (sc_pair_words() words; null: the
// asset's) says now. `words` is the caller's, crowd_table_words() of them, at a multiple of 16 bytes. Copy all of them
// to each device that runs the crowd. To change the pairs, prepare and copy again. SC_OK, SC_NULL, SC_MISALIGNED,
// SC_TOO_SMALL, SC_BAD_VALUE, SC_NOT_OPEN: nothing is written.
std::size_t crowd_table_words(const Asset& asset) noexcept;  // 0 where the asset is not open
Status prepare_crowd(const Asset& asset, Radius radius, const std::uint64_t* ignored_pairs, std::uint64_t* words,
                     std::size_t word_count) noexcept;

// The bytes that one block of a kernel works in, for a group with these inputs and outputs; a multiple of 16. If the
// device has less shared memory a block (227 KiB on Hopper, 163 on Ampere, 99 on Ada, 64 on Turing), the group needs
// CrowdGroup::scratch. `table` as in CrowdGroup; 0 where it is none.
std::size_t crowd_block_bytes(const std::uint64_t* table, bool from_bones, bool with_bits, bool with_pairs) noexcept;

// Instances of one asset. All pointers but `table` point to memory that the device can access: spheres, device_table
// and scratch at multiples of 16, the others at multiples of their type's size. cudaMalloc gives both. Matrices are
// read fastest by rows and at multiples of 16.
struct CrowdGroup {
  const std::uint64_t* table = nullptr;         // on the host, from prepare_crowd()
  const std::uint64_t* device_table = nullptr;  // its copy
  std::size_t instance_count = 0;               // below 2^31

  // In, as in sc_crowd_job: the bones of instance 0, or the spheres of instance 0. Bones need an asset that has bones
  // and is not of profile `paper`.
  Pose pose;
  const Sphere* spheres = nullptr;
  std::size_t instance_stride = 0;  // bytes between bones, a multiple of 4; or entries between spheres. 0: side by side

  // Out. Each may be null.
  Sphere* refitted = nullptr;       // from bones: the asset's spheres for each instance
  std::uint32_t* counts = nullptr;  // the number of pairs of each instance
  std::uint64_t* bits = nullptr;    // sc_pair_words() words for each instance: bit b(b-1)/2 + a of each pair

  // Out: a list of pairs; null for none. It needs counts, starts and pair_count too. The pairs of one instance are
  // sorted and follow one another; the instances come in any order, and `starts` says where each begins.
  CrowdPair* pairs = nullptr;
  std::size_t pair_capacity = 0;
  std::uint64_t* starts = nullptr;      // one for each instance
  std::uint64_t* pair_count = nullptr;  // all pairs found; those past pair_capacity are not in the list

  // Memory for assets too large for the device's shared memory (on Hopper from about 210 spheres with bones, 400
  // without). Give crowd_block_bytes() for each block that is to run at once; two blocks a multiprocessor are enough.
  // Groups that may run at the same time need scratch of their own.
  void* scratch = nullptr;
  std::size_t scratch_bytes = 0;
};

inline constexpr std::size_t kCrowdGroupsMax = 8;  // of a call

// Refits and tests whole crowds. A sphere that is not finite touches nothing.
//
// Enqueues work on `stream` of the current device (null: the default stream) and returns: one kernel for the groups
// that come as spheres, one for those that come as bones, one for those that need scratch, and for each list the
// clearing of its count. It allocates nothing, waits for nothing and may be captured into a graph. Outputs must overlap
// neither inputs nor one another; read them when the stream has finished the work.
//
// SC_OK or, with nothing enqueued:
//   SC_NULL, SC_MISALIGNED, SC_TOO_SMALL, SC_BAD_STRIDE and the field; of an incomplete list SC_FIELD_PAIRS or _COUNTS
//   SC_BAD_VALUE         vertices, both spheres and bones, no such layout, no table, too many groups or instances
//   SC_NOT_IN_ASSET      bones, but the asset cannot be refitted from them
//   SC_DEVICE_TOO_SMALL  the group needs scratch and has none, or 4 GiB or more a block
//   SC_NO_DEVICE
// or SC_DEVICE_FAILED if the device or its driver reported an error: see last_device_error().
Status enqueue_crowds(const CrowdGroup* groups, std::size_t group_count, CUstream_st* stream) noexcept;

// A crowd whose inputs and results lie in the CPU's memory: for tools, tests and a first try. Games keep both on the
// device and use enqueue_crowds(). One thread at a time; it belongs to the device that was current in open().
class HostCrowd {
 public:
  HostCrowd() = default;
  HostCrowd(const HostCrowd&) = delete;
  HostCrowd& operator=(const HostCrowd&) = delete;
  ~HostCrowd() { close(); }

  // Allocates what that many instances and pairs (of all of them together) take; closes what was open. A status of
  // prepare_crowd(); SC_NOT_IN_ASSET if the asset cannot be refitted from bones; SC_BAD_VALUE for no instances, 2^31 or
  // more, or no pairs; SC_NO_DEVICE; SC_NO_MEMORY; SC_DEVICE_FAILED, also if the device's memory runs out.
  Status open(const Asset& asset, Radius radius, const std::uint64_t* ignored_pairs, std::size_t instances,
              std::size_t pair_capacity) noexcept;
  void close() noexcept;
  bool is_open() const noexcept { return memory_ != nullptr; }

  // In, as in CrowdGroup.
  Pose pose;
  std::size_t instance_stride = 0;
  std::size_t instance_count = 0;  // at most those of open()

  // Out. The pointers may be null.
  Sphere* spheres = nullptr;        // the asset's spheres for each instance
  std::uint32_t* counts = nullptr;  // one for each instance
  CrowdPair* pairs = nullptr;       // room for open()'s capacity; sorted by instance, then pair
  std::size_t pair_count = 0;
  float device_milliseconds = 0;  // of the kernel alone

  // Copies the inputs to the device, runs the kernel, copies the results back and waits for them. SC_OK, SC_NOT_OPEN,
  // SC_BAD_VALUE (too many instances), SC_OVERFLOW (more pairs than the capacity: counts and spheres are right, `pairs`
  // is not written) or a status of enqueue_crowds().
  Status run() noexcept;

 private:
  struct Memory;
  Memory* memory_ = nullptr;
};

}  // namespace spherechain::cuda
