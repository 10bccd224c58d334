// SPDX-License-Identifier: MIT
// What a block of the crowd's kernel sees: the tables' entries, a group's pointers, and its own shared memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/cuda_crowd.h"

#if defined(__CUDACC__)
#define SPHERECHAIN_HD __host__ __device__ __forceinline__
#define SPHERECHAIN_HD_RARE inline __host__ __device__ __noinline__  // so that its registers are not everyone's
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

inline constexpr std::uint32_t kLanes = 32;  // instances a block, one a lane
inline constexpr std::uint32_t kPitch =
    33;  // of shared arrays: neither a lane's nor an instance's figures share a bank
inline constexpr std::uint32_t kFewInstances = 8;  // a block, where they come as spheres: one a warp
inline constexpr std::uint32_t kRows = 8;          // spheres in registers
inline constexpr std::uint32_t kColumns = 8;       // that an item tests them against

struct alignas(16) Float4 {
  float x, y, z, w;
};

inline constexpr std::size_t kHalf = kPivotLanes / 2;

struct alignas(16) GroupEntry {
  Float4 weights[2];
  std::uint32_t first_term, term_count;
  std::uint32_t first_morph_term, unused;
};

// Those whose refit costs most come first.
struct alignas(16) SphereEntry {
  std::uint32_t sphere, pivot_count;
  std::uint32_t first_group, group_count;
  GroupEntry group;     // the first one
  float wanted, scale;  // calibrated: wanted * (mean / scale); paper: mean * wanted
  float scale_share;    // 1 / scale where usual_quotient may be used, or 0
  float unused;
};

// What a bone adds to four pivots: BoneTerm by halves.
struct alignas(16) HalfTerm {
  Float4 x, y, z, w;
};

// Bit kHalfItem - 1 - (kRows * c + r) of wanted[h]: sphere first_row + r is tested against first + c + h * 4, which is
// the larger one.
struct alignas(16) PairColumns {
  std::uint32_t first, wanted[2];
  std::uint32_t unused;
};

// Rows that a warp holds against some columns after others. Items of most columns come first.
inline constexpr std::uint32_t kItemColumns = 3;
struct alignas(16) PairItem {
  std::uint32_t first_row, count;
  std::uint32_t unused[2];
  PairColumns columns[kItemColumns];
};
inline constexpr std::uint32_t kUnit = 16;  // spheres that matrix units test against as many
// Unit c (c + 1) / 2 + r is that of rows 16 r and on and columns 16 c and on, r <= c; four units after each other are a
// word. Each lane of a warp takes eight pairs of every unit, see row_of and column_of (crowd_units.h), and of every
// word knows which of them are wanted.
inline constexpr std::uint32_t kWordUnits = 4, kLanePairs = 8;
SPHERECHAIN_HD std::uint32_t units_of(std::uint32_t spheres) { return (spheres + kUnit - 1) / kUnit; }
SPHERECHAIN_HD std::uint32_t words_of_units(std::uint32_t units) {
  return (units * (units + 1) / 2 + kWordUnits - 1) / kWordUnits;
}

inline constexpr float kLeastScale = 0x1p-60F;  // and its inverse: see usual_quotient
inline constexpr std::uint32_t kHalfItem = 32, kHalfColumns = kHalfItem / kRows;

// Tables have as many as lanes_of() says, the spare ones of reach 0.
struct alignas(16) NearEntry {
  std::uint32_t a, b;
  float reach;
  std::uint32_t unused;
};

// Covers: of a sphere's leaves those that come after each other; the spheres with most of them first.
struct alignas(16) CoverEntry {
  Vec3 rest;  // of a sphere without leaves
  std::uint32_t sphere;
  std::uint32_t first_leaf, leaf_count;
  std::uint32_t unused[2];
};

struct alignas(16) LeafEntry {
  Float4 ball;  // at rest
  std::uint32_t first_term, term_count;
  std::uint32_t first_morph, morph_count;
};

// CoverTerm, of one leaf.
struct alignas(16) LeafTerm {
  float weight, deviation;
  std::uint32_t bone;  // of those used
  std::uint32_t unused;
};

struct alignas(16) LeafMorph {
  Float4 ball;  // around the deltas
  std::uint32_t target;
  std::uint32_t unused[3];
};

// Spheres that a warp refits at once, by moments. The dearest runs come first.
struct alignas(16) MomentRun {
  std::uint32_t first_step, first_moment;  // of what follows in its own array
  std::uint32_t first_bone, first_center;
  std::uint32_t first_sphere, sphere_count;
  std::uint32_t bone_count, kind;
  std::uint32_t cost;
};
// Of a run: many spheres of the same two bones, or three; two spheres of the same bones; one or two of any.
inline constexpr std::uint32_t kTwoBones = 0, kThreeBones = 1, kEqualBones = 2, kAnyBones = 3;
inline constexpr std::uint32_t kRunSpheres = 2, kMostRunSpheres = 8;

struct alignas(8) RunSphere {
  std::uint32_t sphere;
  float wanted;
};

// A pair of bones: where shared memory has the second one's matrix, in bytes, which end in four bits of zero; bit s is
// set where the run's sphere s has both. Pairs go (0, 0), (0, 1) .., (1, 1) .., but for those that neither has.
inline constexpr std::uint32_t kLastOfBone = 4, kLastOfRun = 8, kMatrixMask = ~15U;

// A moment of a bone with itself, 0 below its diagonal: 00 01 02 03 11 12 13 22 23 33.
inline constexpr std::uint32_t kOwnFigures = 10;
inline constexpr std::uint32_t kOwnQuads = 3, kPairQuads = 4;  // of a moment, by fours

SPHERECHAIN_HD constexpr std::size_t pairs_of_bones(std::size_t bones) { return bones * (bones + 1) / 2; }

// Of a moment's column: all, or those not below the diagonal.
SPHERECHAIN_HD constexpr std::size_t rows_of_moment(bool is_own, std::size_t column) { return is_own ? column + 1 : 4; }

// Of a sphere of few bones: pair after pair, and in each column after column, `step` apart, what may not be 0.
SPHERECHAIN_HD constexpr std::size_t few_bone_quads(std::size_t bones, std::size_t first_column, std::size_t step) {
  std::size_t figures = 0;
  for (std::size_t column = first_column; column < 4; column += step) {
    figures += bones * rows_of_moment(true, column) + (pairs_of_bones(bones) - bones) * 4;
  }
  return (figures + 3) / 4;
}

// How large a bone's matrix is, as runtime/src/cover_kernel.h has it.
struct alignas(8) BoneSize {
  float norm, translation;
};

// How a matrix' float at row i and column k lies: data[row * i + column * k].
struct MatrixSteps {
  std::uint32_t row, column;
};

inline constexpr std::uint32_t kMostWarps = 8;
inline constexpr std::uint32_t kQueued = 256;  // pairs that a warp may find before it decides
inline constexpr std::uint32_t kBoxFigures = 6;

// Where instances come from bones: pairs that a block may find before it decides, and of how many spheres at most, for
// an entry has 32 bits.
inline constexpr std::uint32_t kBlockQueued = 1024, kMostQueuedSpheres = 8192;
SPHERECHAIN_HD bool has_queue(std::uint32_t sphere_count, bool covers) {
  return !covers && sphere_count <= kMostQueuedSpheres;
}

// In bytes from the start of a block's shared memory.
struct SharedLayout {
  // Where instances come from bones. Matrices and what else is of bones are no longer needed when pairs are tested:
  // what that needs lies in the same place.
  std::uint32_t matrices, morph_weights, bone_sizes, reference, powers, bits, ordered_bits, queue, spheres, counts,
      dealt, parts, boxes, radii;
  // Where they come as spheres, from the start of a warp's own.
  std::uint32_t own_size, own_seen, own_powers, own_bits, own_ordered_bits, own_boxes, own_parts, own_spheres;
  std::size_t size;
};

struct GroupView {
  const SphereEntry* sphere_entries;
  const float* paddings;
  const GroupEntry* groups;
  const HalfTerm* terms;  // two a term
  // Where shared memory has a term's matrix, in bytes; and one more for who looks ahead.
  const std::uint32_t* term_matrices;
  const std::uint32_t* used_bones;
  const std::uint32_t* morph_counts;  // null where nothing morphs
  const std::uint32_t* morph_targets;
  const MorphTerm* morph_terms;
  const PairItem* items;
  const std::uint32_t* unit_places;  // r and, in the upper half, c of each unit of each word
  const std::uint32_t* wanted;       // [word][lane]: bit 31 - i for the pair i
  const NearEntry* near;
  const CoverEntry* cover_entries;  // null but in tables of covers
  const LeafEntry* leaf_entries;
  const LeafTerm* leaf_terms;
  const LeafMorph* leaf_morphs;
  const MomentRun* runs;  // null but where spheres follow bones by moments
  const std::uint32_t* moment_steps;
  const Float4* moments;
  const std::uint32_t* run_bones;  // as steps, without marks of the last
  const RunSphere* run_spheres;
  const Float4* center_terms;
  Vec3 origin;
  std::uint32_t sphere_count, used_bone_count, item_count, near_count, morph_count, bit_words, leaf_count;
  std::uint32_t run_count, reference;  // reference: of the bones used
  std::uint32_t origin_sphere;         // from which an instance's spheres are seen
  bool calibrated, has_padding, has_morphs;

  const Sphere* spheres;
  const float* matrices;  // null where the instances come as spheres
  const float* morph_weights;
  std::size_t sphere_stride;
  std::uint32_t bone_stride, instance_stride;  // floats
  MatrixSteps steps;
  bool wide_matrices, wide_spheres, wide_refitted, wide_leaves;  // aligned for reads and writes of 16 bytes
  std::uint32_t instance_count;

  Sphere* refitted;
  Sphere* leaves;
  Sphere* bounds;
  std::uint32_t* counts;
  std::uint64_t* bits;
  CrowdPair* pairs;
  std::uint64_t pair_capacity;
  std::uint64_t* starts;
  std::uint64_t* pair_count;

  // Blocks with memory in scratch take turns: that many at once.
  unsigned char* scratch;
  std::size_t scratch_bytes;
  std::uint32_t scratch_blocks;

  std::uint32_t first_block;
  SharedLayout layout;
};

SPHERECHAIN_HD std::uint32_t block_instances(const GroupView& v) {
  return v.matrices != nullptr ? kLanes : kFewInstances;
}

SPHERECHAIN_HD std::uint32_t blocks_of(const GroupView& v) {
  return (v.instance_count + block_instances(v) - 1) / block_instances(v);
}

SPHERECHAIN_HD std::uint32_t half_words(const GroupView& v) { return 2 * v.bit_words; }

// An item has eight rows and columns, also where there are fewer spheres.
SPHERECHAIN_HD std::uint32_t sphere_places(const GroupView& v) {
  return v.sphere_count < kColumns ? kColumns : v.sphere_count;
}

// As many as all lanes take in turns.
SPHERECHAIN_HD std::uint32_t lanes_of(std::uint32_t spheres) { return (spheres + kLanes - 1) / kLanes * kLanes; }

// Of the rows in which a warp has the spheres as they are seen: no two lanes that read at once share a bank.
SPHERECHAIN_HD std::uint32_t seen_pitch(const GroupView& v) { return lanes_of(v.sphere_count) + kUnit / 2; }

// A block's thread. Where instances come from bones a lane is one of them, and its threads share the work; where they
// come as spheres a warp is.
struct Place {
  std::uint32_t thread, threads, block;  // block: of the group

  SPHERECHAIN_HD std::uint32_t lane() const { return thread % kLanes; }
  SPHERECHAIN_HD std::uint32_t warp() const { return thread / kLanes; }
  SPHERECHAIN_HD std::uint32_t warps() const { return threads / kLanes; }
};

struct Shared {
  Float4* matrices;  // [3 * bone + row][lane]
  float* morph_weights;
  BoneSize* bone_sizes;  // [bone][lane]
  float* reference;      // [axis][lane]: where the reference bone has the origin
  Float4* spheres;       // [sphere][lane], with the filter's padding
  float* powers;         // [sphere][lane]
  std::uint32_t* bits;
  std::uint32_t* ordered_bits;  // in the order of sorted pairs
  std::uint32_t* counts;
  std::uint32_t* queue;  // a pair of one instance each, see queue_entry
  std::uint32_t* dealt;  // spheres or runs to refit, then pairs to test; and how many are queued
  std::uint64_t* start;  // the block's place in the list
  std::uint32_t* parts;  // [warp][lane]: pairs in each warp's part of the ordered bits
  float* boxes;          // [axis, low or high][warp][lane] around centres
  std::uint32_t* radii;  // of bounds: floats of no sign, which are ordered as their bits are
  unsigned char* own;    // of each warp

  SPHERECHAIN_HD Shared(void* memory, const SharedLayout& layout) {
    auto* bytes = static_cast<unsigned char*>(memory);
    matrices = reinterpret_cast<Float4*>(bytes + layout.matrices);
    morph_weights = reinterpret_cast<float*>(bytes + layout.morph_weights);
    bone_sizes = reinterpret_cast<BoneSize*>(bytes + layout.bone_sizes);
    reference = reinterpret_cast<float*>(bytes + layout.reference);
    spheres = reinterpret_cast<Float4*>(bytes + layout.spheres);
    bits = reinterpret_cast<std::uint32_t*>(bytes + layout.bits);
    ordered_bits = reinterpret_cast<std::uint32_t*>(bytes + layout.ordered_bits);
    powers = reinterpret_cast<float*>(bytes + layout.powers);
    counts = reinterpret_cast<std::uint32_t*>(bytes + layout.counts);
    queue = reinterpret_cast<std::uint32_t*>(bytes + layout.queue);
    dealt = reinterpret_cast<std::uint32_t*>(bytes + layout.dealt);
    start = reinterpret_cast<std::uint64_t*>(bytes + layout.parts);
    parts = reinterpret_cast<std::uint32_t*>(bytes + layout.parts) + 4;
    boxes = reinterpret_cast<float*>(bytes + layout.boxes);
    radii = reinterpret_cast<std::uint32_t*>(bytes + layout.radii);
    own = bytes;
  }
};

}  // namespace spherechain::cuda
