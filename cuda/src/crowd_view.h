// SPDX-License-Identifier: MIT
// The data that a block of the crowd's kernels sees: the table's entries, a group's pointers, and the block's own
// memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/cuda.h"

#if defined(__CUDACC__)
#define SPHERECHAIN_HD __host__ __device__ __forceinline__
#define SPHERECHAIN_HD_RARE inline __host__ __device__ __noinline__  // keeps its registers out of the caller
#else
#define SPHERECHAIN_HD inline
#define SPHERECHAIN_HD_RARE inline
#endif

#if defined(__CUDA_ARCH__)
#define SPHERECHAIN_UNROLL _Pragma("unroll")
#define SPHERECHAIN_ONE_BY_ONE _Pragma("unroll 1")
#else
#define SPHERECHAIN_UNROLL
#define SPHERECHAIN_ONE_BY_ONE
#endif

namespace spherechain::cuda {

inline constexpr std::uint32_t kLanes = 32;
inline constexpr std::uint32_t kWarpsMax = 8;         // of a block
inline constexpr std::uint32_t kSphereInstances = 8;  // a block tests, if they come as spheres: one a warp
// The pitch of arrays with a column for each instance of a block: neither neighbours in a row nor in a column share a
// bank of shared memory.
inline constexpr std::uint32_t kPitch = 33;

struct alignas(16) Float4 {
  float x, y, z, w;
};

// ---- Pairs of instances that come from bones: eight rows of spheres, in registers, against eight columns ----

inline constexpr std::uint32_t kRows = 8, kColumns = 8;
inline constexpr std::uint32_t kHalfItem = 32, kHalfColumns = kHalfItem / kRows;

// Bit kHalfItem - 1 - (kRows * c + r) of wanted[h] is set if sphere first_row + r is tested against sphere
// first + h * kHalfColumns + c, which is the larger index.
struct alignas(16) PairColumns {
  std::uint32_t first, wanted[2];
  std::uint32_t unused;
};

// Rows that a warp tests against some columns after others. Items of most columns come first.
inline constexpr std::uint32_t kItemColumns = 3;
struct alignas(16) PairItem {
  std::uint32_t first_row, count;
  std::uint32_t unused[2];
  PairColumns columns[kItemColumns];
};

// ---- Pairs of instances that come as spheres: units of 16 by 16, for the matrix units ----

// Unit c (c + 1) / 2 + r has the rows from 16 r on and the columns from 16 c on, r <= c. Four units are a word, of
// which each lane of a warp takes 32 bits: eight pairs of each unit, see row_of() and column_of().
inline constexpr std::uint32_t kUnit = 16, kWordUnits = 4, kLanePairs = 8;
SPHERECHAIN_HD std::uint32_t units_of(std::uint32_t spheres) { return (spheres + kUnit - 1) / kUnit; }
SPHERECHAIN_HD std::uint32_t words_of_units(std::uint32_t units) {
  return (units * (units + 1) / 2 + kWordUnits - 1) / kWordUnits;
}

// A RestPair. There are as many as lanes_of() says; the spare ones have scale 0 and never touch.
struct alignas(16) RestPairItem {
  std::uint32_t a, b;
  float rest_scale;
  std::uint32_t unused;
};

// ---- Refit by moments ----

// Spheres that a warp refits at once. The runs that take longest come first.
struct alignas(16) MomentRun {
  std::uint32_t first_step, first_moment;  // the first of this run in each array
  std::uint32_t first_bone, first_center;
  std::uint32_t first_sphere, sphere_count;
  std::uint32_t bone_count, kind, cost;
  std::uint32_t unused[3] = {};
};
// The kinds of runs: many spheres of the same two bones, or of the same three; one or two spheres of any bones.
inline constexpr std::uint32_t kTwoBones = 0, kThreeBones = 1, kAnyBones = 2;
inline constexpr std::uint32_t kRunSpheres = 2, kRunSpheresMax = 8;

struct alignas(8) RunSphere {
  std::uint32_t sphere;
  float wanted;  // its radius at rest
};

// A step is a pair of bones, in the order (0, 0), (0, 1) .., (1, 1) .., without those that no sphere of the run has.
// Its word is the offset in bytes of the second bone's matrix in the block's memory, whose last four bits are 0, and in
// these: bit s is set if sphere s of the run has both bones.
inline constexpr std::uint32_t kLastOfBone = 4, kLastOfRun = 8, kMatrixMask = ~15U;

inline constexpr std::uint32_t kPairQuads = 4;  // a moment of two bones, by fours

SPHERECHAIN_HD constexpr std::size_t pairs_of_bones(std::size_t bones) { return bones * (bones + 1) / 2; }

// How many rows of a moment's column are kept: of a bone with itself, those not below the diagonal, which are 0.
SPHERECHAIN_HD constexpr std::size_t rows_of_moment(bool is_self, std::size_t column) {
  return is_self ? column + 1 : 4;
}

// The quads that a sphere of few bones has for the columns `first`, `first` + `step` ..: pair after pair.
SPHERECHAIN_HD constexpr std::size_t few_bone_quads(std::size_t bones, std::size_t first, std::size_t step) {
  std::size_t figures = 0;
  for (std::size_t column = first; column < 4; column += step) {
    figures += bones * rows_of_moment(true, column) + (pairs_of_bones(bones) - bones) * 4;
  }
  return (figures + 3) / 4;
}

// ---- Views ----

struct TableFigures {
  std::uint32_t sphere_count, bone_count;  // bone_count: the asset's, or 0 if it is not refitted by moments
  std::uint32_t used_bone_count, item_count, rest_pair_count, run_count, bit_words;
  std::uint32_t reference;      // bone of MomentTables, among those used
  std::uint32_t origin_sphere;  // see see_sphere()
  Vec3 origin;
};

// Stands at the start of a table's words. Places are in words from there.
inline constexpr std::uint32_t kTableMagic = 0x63756461;
struct TableHeader : TableFigures {
  std::uint32_t magic;
  std::uint32_t items, unit_places, wanted, rest_pairs;
  std::uint32_t used_bones, runs, run_spheres, moment_steps, moments, run_bones, center_terms;
};

// Pairs that a block (from bones) or a warp (from spheres) may queue before it decides about them. A block's entry has
// 32 bits for lane and pair: assets of more spheres have no queue.
inline constexpr std::uint32_t kBlockQueued = 1024, kWarpQueued = 256, kQueuedSpheresMax = 8192;
SPHERECHAIN_HD bool has_queue(std::uint32_t sphere_count) { return sphere_count <= kQueuedSpheresMax; }

// Where an array lies in a block's memory.
template <typename T>
struct Offset {
  std::uint32_t bytes;
  SPHERECHAIN_HD T* in(unsigned char* memory) const { return reinterpret_cast<T*>(memory + bytes); }
};

// From bones: the parts of the block's memory; from spheres: those of a warp's share of it, which has `warp_size`
// bytes. The matrices are no longer needed when pairs are tested: powers, bits and queue lie in the same place.
struct BlockLayout {
  Offset<Float4> matrices, spheres;
  Offset<float> reference, powers, seen;
  Offset<std::uint32_t> bits, ordered_bits, counts, queue, dealt, parts;
  Offset<std::uint64_t> start;
  std::uint32_t warp_size;
  std::size_t size;  // of a block
};

// A group as the kernels read it. Its instance_stride is never 0.
struct GroupView : TableFigures, CrowdGroup {
  // The arrays of the table's copy on the device.
  const PairItem* items;
  const std::uint32_t* unit_places;  // of each unit: r and, in the upper half, c
  const std::uint32_t* wanted;       // [word][lane]: bit 31 - i for the lane's pair i
  const RestPairItem* rest_pairs;
  const std::uint32_t* used_bones;
  const MomentRun* runs;
  const std::uint32_t* moment_steps;
  const Float4* moments;
  const std::uint32_t* run_bones;  // as steps, without kLastOfBone and kLastOfRun
  const RunSphere* run_spheres;
  const Float4* center_terms;

  std::uint32_t bone_floats, instance_floats;  // from one matrix, one instance to the next
  std::uint32_t row_step, column_step;         // a matrix has row i, column k at data[row_step * i + column_step * k]
  bool wide_matrices;                          // whose rows are read 16 bytes at a time
  bool in_scratch;                             // the block's memory is not shared memory

  std::uint32_t scratch_blocks;  // that run at once and take the group's blocks in turns
  std::uint32_t first_block;
  BlockLayout layout;
};

SPHERECHAIN_HD std::uint32_t block_instances(const GroupView& v) {
  return v.pose.bones != nullptr ? kLanes : kSphereInstances;
}

SPHERECHAIN_HD std::uint32_t blocks_of(const GroupView& v) {
  return (static_cast<std::uint32_t>(v.instance_count) + block_instances(v) - 1) / block_instances(v);
}

SPHERECHAIN_HD std::uint32_t half_words(const TableFigures& t) { return 2 * t.bit_words; }

// An item has eight rows and columns, also where there are fewer spheres.
SPHERECHAIN_HD std::uint32_t sphere_places(const TableFigures& t) {
  return t.sphere_count < kColumns ? kColumns : t.sphere_count;
}

// Rounded up, so that all lanes of a warp take as many.
SPHERECHAIN_HD std::uint32_t lanes_of(std::uint32_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

// The pitch of WarpInstance::seen: no two lanes that read at once share a bank.
SPHERECHAIN_HD std::uint32_t seen_pitch(const TableFigures& t) { return lanes_of(t.sphere_count) + kUnit / 2; }

// A thread of a block. If instances come from bones, a lane is one of them and the warps share the work; if they come
// as spheres, a warp is one of them and its lanes share the work.
struct Place {
  std::uint32_t thread, threads, block;  // block: of the group

  SPHERECHAIN_HD std::uint32_t lane() const { return thread % kLanes; }
  SPHERECHAIN_HD std::uint32_t warp() const { return thread / kLanes; }
  SPHERECHAIN_HD std::uint32_t warps() const { return threads / kLanes; }
};

// A block's memory: shared memory, or a part of the group's scratch. For instances that come as spheres: a warp's
// share, where arrays have a single column; see WarpInstance.
struct Shared {
  unsigned char* bytes;
  const BlockLayout& layout;
  Float4* matrices = layout.matrices.in(bytes);                 // [3 * bone + row][lane]
  float* reference = layout.reference.in(bytes);                // [axis][lane]: where the reference bone has the origin
  Float4* spheres = layout.spheres.in(bytes);                   // [sphere][lane]
  float* powers = layout.powers.in(bytes);                      // [sphere][lane], see power_of()
  std::uint32_t* bits = layout.bits.in(bytes);                  // [half word][lane]
  std::uint32_t* ordered_bits = layout.ordered_bits.in(bytes);  // the same in the order of sorted pairs
  std::uint32_t* counts = layout.counts.in(bytes);              // [lane]
  std::uint32_t* queue = layout.queue.in(bytes);                // see queue_candidates()
  std::uint32_t* dealt = layout.dealt.in(bytes);                // runs, then pair items; and the length of the queue
  std::uint64_t* start = layout.start.in(bytes);                // the block's place in the list
  std::uint32_t* parts = layout.parts.in(bytes);                // [warp][lane]: pairs in the warps' ordered bits

  SPHERECHAIN_HD Shared(void* memory, const BlockLayout& layout_)
      : bytes(static_cast<unsigned char*>(memory)), layout(layout_) {}
};

struct alignas(16) WarpState {
  std::uint32_t count, queued;       // touching pairs; pairs that are in the queue or found no room there
  std::uint64_t start;               // of the instance's list
  std::uint32_t queue[kWarpQueued];  // (unit * kLanePairs + pair) * kLanes + lane
};

// For instances that come as spheres: the one that a warp tests, and the lane. `powers` are [pair of spheres][first,
// second, first, second], `parts` [lane].
struct WarpInstance : Shared {
  WarpState* state = reinterpret_cast<WarpState*>(bytes);
  float* seen = layout.seen.in(bytes);  // [x, y, z, power][place_of(sphere)], see see_sphere()
  std::uint32_t lane, instance;

  // `place`: the instance's in its block.
  SPHERECHAIN_HD WarpInstance(const Shared& block, const Place& at, std::uint32_t place)
      : Shared(block.bytes + at.warp() * block.layout.warp_size, block.layout),
        lane(at.lane()),
        instance(at.block * kSphereInstances + place) {}
};

}  // namespace spherechain::cuda
