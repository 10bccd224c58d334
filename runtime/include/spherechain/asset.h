// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/bone_tables.h"
#include "spherechain/status.h"
#include "spherechain/surface.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kAssetAlignment = 8;   // bytes; malloc, new and mmap all give at least this
inline constexpr std::uint32_t kFormatVersion = 1;  // the newest format this runtime reads
inline constexpr std::uint32_t kMaxSphereCount = 65535;

class Message;

enum class Side : std::uint8_t { kNone = 0, kLeft = 1, kRight = 2 };
// How centre and radius follow the pivots; see RefitJob.
enum class RefitRule : std::uint8_t { kPaper = 0, kCalibrated = 1, kMoments = 2 };

// One triangle that carries a sphere: vertex indices in the source file's order, and its share of the centre.
struct Pivot {
  std::uint32_t a, b, c;
  float weight;
};

// A sphere at rest. Lengths in source units.
struct RestSphere {
  Vec3 center;
  float radius;         // fit radius; > 0
  float detect_radius;  // >= 0
  float pivot_spread;   // mean (kMoments: root mean square) distance of the pivots' centroids from the refitted centre;
                        // > 0
  std::uint32_t first_pivot;
  std::uint32_t first_triangle;
  std::uint32_t triangle_count;
  std::uint16_t pivot_count;  // >= 1
  std::uint8_t region;
  Side side;
  std::int16_t level;  // torso: disk position from the bottom, the head's numbered on; limbs: -1
  std::uint16_t reserved;
};

// Spheres a < b that touch at rest without being neighbours, or would when a little nearer: reported only when closer
// than reach * (ra + rb).
struct NearPair {
  std::uint32_t a, b;
  float reach;  // [0, 1)
};

// A vertex buffer of the source file: a run of the source's vertices. Parts with the same vertices share a run.
struct SourcePart {
  std::uint32_t mesh, primitive;  // glTF: indices in the file; other formats: the importer's mesh, and 0
  std::uint32_t first_vertex, vertex_count;
  std::uint64_t hash;  // hash_positions over its positions as the file has them, moved by no node or joint
};

struct ChainView {
  const char* name;
  Span<const std::uint8_t> regions;
  Span<const std::uint32_t> spheres;  // each sphere once
};

struct RegionView {
  const char* name;
  std::uint32_t triangle_count;
};

struct JointView {
  const char* name;
  std::int32_t parent;  // -1 for the root, else less than the joint's own index
  Vec3 position, tail;
};

// What a game moves the character by: a bone of the source's skeleton, or a joint of the automatic rig.
struct BoneView {
  const char* name;
  const float* inverse_bind;  // 12: rows of the 3 by 4 matrix from the rest pose to the bone's own space
  bool is_rest;               // no bone: stands for the vertices that none moves; the last, where there is one
};

struct FitError {
  float mean_abs_f, max_abs_f;  // the paper's F (section 3.2), source units
};

struct AssetInfo {
  std::uint32_t format_version;
  const char* writer;
  const char* settings;  // canonical JSON
  const char* settings_sha256;
  const char* source_file;
  const char* source_sha256;
  std::uint32_t source_vertex_count;
  std::uint32_t source_triangle_count;
  std::uint64_t source_rest_hash;
  float metres_per_unit;
  Vec3 origin, left, up, forward;  // the character's own axes: orthonormal, left x up = forward
  float height;                    // source units
  FitError phi1, phi1_adjusted, phi2;
  RefitRule refit;
  std::uint32_t chain_entries_table1;  // 3x + 2(|L| + |R|) + 3|T| + |D|, and 5 for each sphere of the head
};

// A verified view of an asset's bytes. It copies nothing: the bytes must outlive it, unchanged. Copying an Asset copies
// the view. All members are const; any number of threads may read one Asset at once.
//
// No job may write to the bytes while they are open, or to the Asset. None finds out: kSharedMemory is of the job's own
// buffers, and of those of the asset's tables at most that the job reads.
//
// What is promised for hostile bytes: open() reads only inside [data, data + size), returns a Status other than kOk, or
// leaves an Asset every accessor and every job of the runtime can use without reading or writing out of bounds, without
// a division by zero, an endless loop or an allocation. It promises nothing about the sense of the figures in it.
class SPHERECHAIN_API Asset {
 public:
  // Verifies `size` bytes at `data` and makes this a view of them. On failure the Asset is closed (is_open() is false)
  // and, where `message` is not null, a sentence that names what is wrong is written there, cut to `message_size` bytes
  // with the final zero; 160 are enough. On success the message is empty. Costs about one pass over the bytes, also for
  // hostile ones; allocates nothing, and needs some 10 KiB of stack.
  // kOk, kNullArgument, kMisaligned, kTruncated, kWrongIdentifier, kUnsupportedVersion, kCorrupt, or kWrongAbi where
  // this header is not of the library's version: then trust nothing else of it.
  Status open(const void* data, std::size_t size, char* message = nullptr, std::size_t message_size = 0) noexcept {
    return open_with_abi(SC_ABI_VERSION, this, data, size, message, message_size);
  }

  bool is_open() const noexcept { return root_ != nullptr; }

  // The accessors below need an open Asset.
  AssetInfo info() const noexcept;
  Span<const RestSphere> spheres() const noexcept { return spheres_; }
  Span<const Pivot> pivots() const noexcept { return pivots_; }
  // Source triangle numbers, grouped by sphere (RestSphere::first_triangle) and in it by leaf (Leaf::first_triangle).
  Span<const std::uint32_t> triangles() const noexcept { return triangles_; }
  // Triangular bit table, bit b(b-1)/2 + a for a < b: 1 where the pair is never reported.
  Span<const std::uint64_t> ignored() const noexcept { return ignored_; }
  std::size_t ignored_count() const noexcept { return ignored_count_; }
  // Sorted by (a, b).
  Span<const NearPair> near_pairs(RadiusKind kind) const noexcept {
    return kind == RadiusKind::kFit ? near_fit_ : near_detect_;
  }
  // In the order of their vertices.
  Span<const SourcePart> source_parts() const noexcept { return source_parts_; }
  std::size_t region_count() const noexcept;
  RegionView region(std::size_t i) const noexcept;
  std::size_t chain_count() const noexcept;
  ChainView chain(std::size_t i) const noexcept;
  // Joints of the automatic rig; 0 where the source brings its own.
  std::size_t joint_count() const noexcept;
  JointView joint(std::size_t i) const noexcept;
  // What RefitBonesJob takes matrices of, in this order: the source's bones in the source's order (one skin of a glTF:
  // its `joints`; a joint that several skins bind differently: a bone each), or the joints of the automatic rig. 0
  // where nothing moves the source, and in assets of older bakers.
  std::size_t bone_count() const noexcept { return bone_count_; }
  BoneView bone(std::size_t i) const noexcept;
  // The source's morph targets, in the source's order.
  std::size_t morph_count() const noexcept { return morph_count_; }
  const char* morph_name(std::size_t i) const noexcept;
  // Empty where bone_count() is 0. Where refit_rule() is kMoments nothing reads them: empty but in assets of older
  // bakers.
  const BoneTables& bone_tables() const noexcept { return bone_tables_; }
  // Of every sphere where refit_rule() is kMoments; else empty.
  const MomentTables& moment_tables() const noexcept { return moment_tables_; }
  // The source vertices that pivots have corners at: ascending, each once. Empty in assets of older bakers.
  Span<const std::uint32_t> pivot_vertices() const noexcept { return pivot_vertices_; }
  // pivots(), their corners numbered in pivot_vertices().
  Span<const Pivot> packed_pivots() const noexcept { return packed_pivots_; }
  // What exact contacts are found in. All empty in assets of older bakers.
  const Surface& surface() const noexcept { return surface_; }
  std::size_t leaf_count() const noexcept { return surface_.leaves.size; }
  // info().refit, for less.
  RefitRule refit_rule() const noexcept { return refit_rule_; }

 private:
  // The Asset is handed over as memory: with another version it may be of another size.
  static Status open_with_abi(std::uint32_t abi_version, void* asset, const void* data, std::size_t size, char* message,
                              std::size_t message_size) noexcept;
  Status open_verified(const void* data, std::size_t size, Message& message) noexcept;

  const void* root_ = nullptr;
  Span<const RestSphere> spheres_;
  Span<const Pivot> pivots_;
  Span<const std::uint32_t> triangles_;
  Span<const std::uint64_t> ignored_;
  std::size_t ignored_count_ = 0, bone_count_ = 0, morph_count_ = 0;
  RefitRule refit_rule_ = RefitRule::kPaper;
  Span<const NearPair> near_fit_, near_detect_;
  Span<const SourcePart> source_parts_;
  Span<const std::uint32_t> pivot_vertices_;
  Span<const Pivot> packed_pivots_;
  BoneTables bone_tables_;
  MomentTables moment_tables_;
  Surface surface_;
};

// SC_ABI_VERSION of the library itself.
SPHERECHAIN_API std::uint32_t abi_version() noexcept;

// A 64-bit FNV-1a over the bit patterns (low byte first) of x, y, z of each position, negative zero taken as zero: what
// AssetInfo::source_rest_hash holds for the rest pose. `stride` in bytes between positions; a multiple of 4, at
// least 12.
SPHERECHAIN_API std::uint64_t hash_positions(const float* positions, std::size_t count,
                                             std::size_t stride = 12) noexcept;

// kOk where `positions` (source order, rest pose) is the buffer the asset was baked from; positions past the source's
// vertex count are not looked at. Else kWrongSource, or kNullArgument, kNotOpen, kMisaligned, kBadStride,
// kTooFewVertices.
SPHERECHAIN_API Status check_source(const Asset& asset, const float* positions, std::size_t count,
                                    std::size_t stride = 12) noexcept;

// The same for one buffer of the source's file, `positions` as the file has them: kOk where source_parts()[part] is
// that buffer. kBadArgument where there is no such part.
SPHERECHAIN_API Status check_source_part(const Asset& asset, std::size_t part, const float* positions,
                                         std::size_t count, std::size_t stride = 12) noexcept;

}  // namespace spherechain
