// SPDX-License-Identifier: MIT
// Crowds on a CUDA device: bones or spheres in, touching pairs out. The device gives the same spheres and pairs as
// RefitBonesJob and DetectJob on the CPU, bit for bit (docs/arithmetic.md).
//
// A program that links this library starts on machines without a GPU or a driver; only its jobs need a device. No job
// may run at the same time as another that writes to the same memory; apart from that all threads may call everything.
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

// Says whether the current device can run jobs: kOk, or kNoDevice where there is no device or driver, or one that is
// too old for this library.
Status check_device() noexcept;

// The CUDA runtime's text for the last kNoDevice or kDeviceFailed on this thread, in English; "no error" before the
// first. Never null.
const char* last_device_error() noexcept;

// An asset in the form that the kernels read, for one kind of radius and one filter. To change the filter, build and
// copy again.
struct CrowdTables {
  // Out. Copy these words to each device that runs the crowd. They lie in the `memory` of build(), which must stay as
  // long as the tables are used.
  Span<const std::uint64_t> words;

  // How many words build() needs for this asset, whatever the filter. 0 if the asset is not open.
  static std::size_t words_needed(const Asset& asset) noexcept;

  // Writes the tables to `memory` (its address a multiple of 16). Without a filter the asset's own ignored pairs count.
  // Returns kOk, kNotOpen, kBadArgument, kNullArgument, kMisaligned, kBadFilter or kContextTooSmall (`memory`); if it
  // fails, the tables are as before. Allocates nothing.
  Status build(const Asset& asset, RadiusKind radius, const Filter* filter, Span<std::uint64_t> memory) noexcept;

  // The bytes that one block of a kernel works in, for a group with these inputs and outputs; a multiple of 16. If the
  // device has less shared memory a block (227 KiB on Hopper, 163 on Ampere, 99 on Ada, 64 on Turing), the group needs
  // CrowdGroup::scratch.
  std::size_t block_bytes(bool from_bones, bool with_bits, bool with_pairs) const noexcept;
};

// Instances of one asset. All pointers but `tables` point to memory that the device can access; those to spheres,
// tables and scratch to a multiple of 16, the others to a multiple of their type's size, as cudaMalloc gives them all.
// Matrices are read fastest by rows and at multiples of 16.
struct CrowdGroup {
  const CrowdTables* tables = nullptr;           // on the host
  const std::uint64_t* device_tables = nullptr;  // the copy of tables->words
  std::size_t instance_count = 0;                // below 2^31

  // In, as in a CrowdJob on the CPU: either spheres or bones. Bones need an asset that is refitted by moments.
  const Sphere* spheres = nullptr;
  std::size_t stride = 0;  // spheres from one instance to the next; 0: as many as the asset has
  BoneMatrices bones;
  std::size_t instance_stride = 0;  // bytes from one instance's first matrix to the next's; a multiple of 4

  // Out. Each may be null.
  Sphere* refitted = nullptr;       // from bones: the asset's spheres for each instance, without the filter's padding
  std::uint32_t* counts = nullptr;  // the number of pairs of each instance
  std::uint64_t* bits = nullptr;    // DetectJob::bit_words() words for each instance, as DetectJob::bits

  // Out: a list of pairs; null for none. It needs counts, starts and pair_count too. The pairs of one instance are
  // sorted and follow one another; the instances come in any order, and `starts` says where each begins.
  CrowdPair* pairs = nullptr;
  std::size_t pair_capacity = 0;
  std::uint64_t* starts = nullptr;      // one for each instance
  std::uint64_t* pair_count = nullptr;  // all pairs found; those past pair_capacity are not in the list

  // Memory for assets too large for the device's shared memory (on Hopper from about 210 spheres with bones, 400
  // without). Give CrowdTables::block_bytes() for each block that is to run at once; two blocks a multiprocessor are
  // enough. Jobs that may run at the same time need scratch of their own.
  void* scratch = nullptr;
  std::size_t scratch_bytes = 0;
};

// Refits and tests whole crowds. A sphere that is not finite touches nothing.
//
// run() enqueues work on `stream` of the current device and returns: one kernel for the groups that come as spheres,
// one for those that come as bones, one for those that need scratch, and for each list the clearing of its count. It
// allocates nothing, waits for nothing and may be captured into a graph. Outputs must overlap neither inputs nor one
// another; read them when the stream has finished the work.
struct CrowdJob {
  static constexpr std::size_t kGroupsMax = 8;

  Span<const CrowdGroup> groups;  // at most kGroupsMax
  CUstream_st* stream = nullptr;  // null: the default stream

  // Returns kOk or, with nothing enqueued, one of
  //   kNullArgument     a pointer that the group's other fields ask for is null
  //   kBadArgument      both spheres and bones, a matrix layout that does not exist, too many groups or instances
  //   kNotOpen          the tables are not built
  //   kNotInAsset       bones, but the asset is not refitted from bones by moments
  //   kTooFewBones, kTooFewSpheres, kBadStride, kMisaligned
  //   kDeviceTooSmall   the group needs scratch and has none, or 4 GiB or more a block
  //   kContextTooSmall  the scratch is smaller than a block's
  //   kNoDevice
  // or kDeviceFailed if the device or its driver reported an error: see last_device_error().
  Status run() const noexcept;
};

// A crowd whose inputs and results lie in the CPU's memory: for tools, tests and a first try. Games keep both on the
// device and use CrowdJob. One thread at a time; it belongs to the device that was current in open().
class HostCrowd {
 public:
  HostCrowd() = default;
  HostCrowd(const HostCrowd&) = delete;
  HostCrowd& operator=(const HostCrowd&) = delete;
  ~HostCrowd() { close(); }

  // Allocates what that many instances and pairs (of all of them together) take; closes what was open. Returns what
  // CrowdTables::build returns; kNotInAsset if the asset is not refitted from bones by moments; kBadArgument for no
  // instances, 2^31 or more, or no pairs; kNoDevice; kDeviceFailed, also if memory runs out, on the device or here.
  Status open(const Asset& asset, RadiusKind radius, const Filter* filter, std::size_t instances,
              std::size_t pair_capacity) noexcept;
  void close() noexcept;
  bool is_open() const noexcept { return memory_ != nullptr; }

  // In, as in CrowdGroup.
  BoneMatrices bones;
  std::size_t instance_stride = 0;
  std::size_t instance_count = 0;  // at most those of open()

  // Out. The pointers may be null.
  Sphere* spheres = nullptr;        // the asset's spheres for each instance
  std::uint32_t* counts = nullptr;  // one for each instance
  CrowdPair* pairs = nullptr;       // room for open()'s capacity; sorted by instance, then pair
  std::size_t pair_count = 0;
  float device_milliseconds = 0;  // of the kernel alone

  // Copies the inputs to the device, runs the kernel, copies the results back and waits for them. Returns kOk,
  // kNotOpen, kBadArgument (too many instances), kOverflow (more pairs than the capacity: counts and spheres are right,
  // `pairs` is not written) or what CrowdJob::run returns.
  Status run() noexcept;

 private:
  struct Memory;
  Memory* memory_ = nullptr;
};

}  // namespace spherechain::cuda
