/* SPDX-License-Identifier: MIT */
/* A baked character: opened once, read by any number of jobs and threads. */
#pragma once

#include "spherechain/types.h"

#define SC_ASSET_ALIGNMENT 8 /* bytes; malloc, new and mmap give at least this. 64 is fastest */

/* An opaque view of an asset's bytes. It owns nothing: the bytes must outlive it, unchanged. Copying it copies the
 * view. Any number of threads may read one asset. */
typedef struct sc_asset {
  uint64_t opaque[256] SC_ZERO;
} sc_asset;

#define SC_SIDE_LEFT 1
#define SC_SIDE_RIGHT 2

/* A bone of the source's skeleton, or a joint of the automatic rig: a game moves the character by these. */
typedef struct sc_bone {
  const char* name;
  const float* inverse_bind; /* from the rest pose to the bone's space; of the asset: SC_ROWS_3X4 */
} sc_bone;

/* A part of the body as people call it: "right hand", "head". Every triangle belongs to one. */
typedef struct sc_part {
  const char* name;
  int32_t side;     /* the character's own: SC_SIDE_LEFT, SC_SIDE_RIGHT, or 0: neither */
  int32_t bone;     /* the bone that it follows; -1 where no bone moves it */
  int32_t parent;   /* the part that it hangs on; -1: none */
  int32_t mobility; /* if two parts intersect, the one with the higher number goes into the other. From high to low:
                       hand, forearm, upper arm, foot, shin, thigh, head, and the trunk's 0. Any other part has one more
                       than its parent */
} sc_part;

/* A sphere at rest. Lengths in source units. */
typedef struct sc_rest_sphere {
  sc_vec3 center;
  float radius;        /* the fit radius; > 0 */
  float detect_radius; /* >= 0 */
  int32_t side;        /* of a torso sphere: the half that it stands for, as sc_part.side */
  uint32_t region;     /* below sc_asset_info.region_count */
  int32_t level;       /* of a torso sphere: its height, from the bottom up; else -1 */
  uint32_t part;       /* that most of its triangles are of */
} sc_rest_sphere;

/* A vertex buffer of the source's file: a run of the source's vertices. */
typedef struct sc_source_buffer {
  uint32_t mesh, primitive; /* glTF: indices in the file; other formats: the importer's mesh, and 0 */
  uint32_t first_vertex, vertex_count;
  uint64_t hash; /* sc_hash_positions() of its positions as the file has them */
} sc_source_buffer;

typedef struct sc_asset_info {
  size_t sphere_count, bone_count, part_count, morph_count, region_count, source_buffer_count;
  size_t vertex_count, triangle_count; /* of the source */
  size_t ignored_pair_count;           /* pairs of spheres that are neighbours on the body */
  const char* writer;                  /* "spherechain 0.1.0" */
  const char* settings;                /* canonical JSON */
  const char* settings_sha256;
  const char* source_file;
  const char* source_sha256;
  uint64_t source_rest_hash;         /* sc_hash_positions() of the whole rest pose */
  sc_vec3 origin, left, up, forward; /* the character's own axes, as its rest pose has them: estimates, no world's axes;
                                        orthonormal, left x up = forward */
  float height;                      /* source units */
  float metres_per_unit;
  const uint64_t* ignored_pairs; /* the pairs of ignored_pair_count; sc_pair_words() words of the asset */
} sc_asset_info;

#if defined(__cplusplus)
extern "C" {
#endif

/* Verifies `size` bytes at `data` and makes `asset` a view of them. On failure the asset is closed (with SC_WRONG_ABI
 * it is left alone), and where `message` is not null it receives a sentence that names what is wrong, cut to
 * `message_size` bytes (256 are enough).
 *
 * Hostile bytes: reads only inside [data, data + size); what opens can be used by every function and job without a read
 * or write out of bounds, a division by zero or an endless loop. Costs about one pass over the bytes; allocates
 * nothing. Pass SC_ABI_VERSION for `abi`.
 *
 * SC_OK, SC_NULL, SC_MISALIGNED, SC_NOT_AN_ASSET, SC_OTHER_VERSION, SC_CORRUPT, SC_WRONG_ABI. */
SPHERECHAIN_API sc_status sc_asset_open(sc_asset* asset, uint32_t abi, const void* data, size_t size, char* message,
                                        size_t message_size) SC_NOEXCEPT;

/* The functions below take an open asset. They return zeros for an index that does not exist. */
SPHERECHAIN_API sc_asset_info sc_asset_get_info(const sc_asset* asset) SC_NOEXCEPT;
SPHERECHAIN_API sc_rest_sphere sc_asset_sphere(const sc_asset* asset, size_t index) SC_NOEXCEPT;
/* The bones in the order in which a pose has their matrices. A glTF skin: its `joints`; a joint that several skins bind
 * differently is a bone for each. A bone without a name stands for vertices that no bone moves: the last, if there is
 * one; its matrix takes the rest pose to the pose's space. */
SPHERECHAIN_API sc_bone sc_asset_bone(const sc_asset* asset, size_t index) SC_NOEXCEPT;
SPHERECHAIN_API sc_part sc_asset_part(const sc_asset* asset, size_t index) SC_NOEXCEPT;
SPHERECHAIN_API const char* sc_asset_morph_name(const sc_asset* asset, size_t index) SC_NOEXCEPT;
SPHERECHAIN_API const char* sc_asset_region_name(const sc_asset* asset, size_t index) SC_NOEXCEPT;
SPHERECHAIN_API sc_source_buffer sc_asset_source_buffer(const sc_asset* asset, size_t index) SC_NOEXCEPT;

/* A 64-bit FNV-1a over x, y, z of each position, negative zero taken as zero. `stride` in bytes; 0: 12. */
SPHERECHAIN_API uint64_t sc_hash_positions(const float* positions, size_t count, size_t stride) SC_NOEXCEPT;

#define SC_WHOLE_SOURCE ((size_t)-1)
/* SC_OK where `positions` is the vertex buffer of that index, as the file has it, or the whole rest pose
 * (SC_WHOLE_SOURCE); else SC_WRONG_SOURCE, or what is wrong with an argument. */
SPHERECHAIN_API sc_status sc_check_source(const sc_asset* asset, size_t buffer, const float* positions, size_t count,
                                          size_t stride) SC_NOEXCEPT;

/* Ignored pairs: the pairs of spheres that a question leaves out. Bit b(b-1)/2 + a, a < b, is of the spheres a and b:
 * bit k is bit k % 64 of word k / 64. Copy sc_asset_info.ignored_pairs, set or clear bits, and pass your words in a
 * query or a crowd job. They are read while it runs: do not edit them then. */

/* Words of a bit for each pair of spheres. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_pair_words(const sc_asset* asset) SC_NOEXCEPT;
/* Words of a bit for each body part: bit p is part p's. 0 where the asset is not open. */
SPHERECHAIN_API size_t sc_part_words(const sc_asset* asset) SC_NOEXCEPT;

/* Sets the bit of each pair of a sphere of one body part with a sphere of the other (sc_rest_sphere.part); the same
 * part twice: of the pairs within it. `ignored` 0 clears the bits: the pairs are reported again, also where the asset
 * itself ignores them. SC_OK; SC_NULL, SC_MISALIGNED, SC_NOT_OPEN; SC_ALIASED: the words are the asset's own;
 * SC_BAD_VALUE: a part does not exist. After an error nothing is written. */
SPHERECHAIN_API sc_status sc_ignore_parts(const sc_asset* asset, uint64_t* ignored_pairs, size_t part, size_t other,
                                          int ignored) SC_NOEXCEPT;

#if defined(__cplusplus)
}
namespace spherechain {
using Asset = sc_asset;
using AssetInfo = sc_asset_info;
using Bone = sc_bone;
using BodyPart = sc_part;
}  // namespace spherechain
#endif
