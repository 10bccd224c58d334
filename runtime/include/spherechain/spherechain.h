/* SPDX-License-Identifier: MIT */
/*
 * The runtime for C, and for whatever calls C: open, refit, detect, contacts, crowds. The C++ headers beside this one
 * do the same and say more of the arithmetic behind it.
 *
 * Memory   All of it is the caller's; the library allocates nothing, keeps nothing between calls and starts no thread.
 *          Whatever must be sized can be asked first: sc_asset_size, sc_asset_get_info, the *_words functions, which
 *          give 0 for an asset that is null or not open.
 *          Pointers that an asset gives out point into its bytes and live as long as those. While it is open nothing
 *          may be written to its bytes or to the sc_asset; SC_SHARED_MEMORY does not tell.
 * Units    Lengths are in the source's units (info.metres_per_unit), in the space of the vertices or matrices given.
 * Threads  Every function may run on any number of threads at once, as long as none writes what another reads: share
 *          one asset and one filter, give each job outputs and scratch memory of its own.
 * Errors   An sc_status; nothing is written unless SC_OK, or SC_OVERFLOW where a count says how much there is. Null
 *          pointers, sizes, strides, indices and enum values are checked. What is not finite touches nothing. Any
 *          function may also give SC_MISALIGNED, and SC_NOT_OPEN for an asset whose sc_asset_open failed.
 * Structs  A job's first field is its size, which the SC_..._INIT macros fill in: a job of another size is refused with
 *          SC_WRONG_ABI. Start from the macro, or set every field. Fields named `reserved` are 0.
 */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "spherechain/abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Values of all enums are those of the C++ API. They are never reassigned; new ones are appended. */
typedef int32_t sc_status;
enum {
  SC_OK = 0,
  SC_NULL_ARGUMENT = 1,       /* a required pointer is null */
  SC_MISALIGNED = 2,          /* memory not aligned as its type; an asset's bytes and its handle's memory, to 8 */
  SC_TRUNCATED = 3,           /* fewer bytes than any asset has */
  SC_WRONG_IDENTIFIER = 4,    /* not a .sphc file */
  SC_UNSUPPORTED_VERSION = 5, /* written by a newer (or never released) format */
  SC_CORRUPT = 6,             /* a broken structure, or a value out of its range */
  SC_NOT_OPEN = 7,            /* an sc_asset that sc_asset_open did not make */
  SC_TOO_FEW_VERTICES = 8,    /* the vertex buffer is shorter than the asset's source */
  SC_TOO_FEW_SPHERES = 9,     /* a sphere buffer holds fewer spheres than the asset has */
  SC_CONTEXT_TOO_SMALL = 10,  /* scratch memory, or that of a handle, is smaller than it must be */
  SC_OVERFLOW = 11,           /* an output buffer was too small; a count says how many entries there are */
  SC_BAD_STRIDE = 12,         /* shorter than what it strides over, or no multiple of 4 */
  SC_WRONG_SOURCE = 13,       /* not the rest pose the asset was baked from */
  SC_BAD_ARGUMENT = 14,       /* an enum value or an index that does not exist */
  SC_UNSUPPORTED_TARGET = 15, /* an instruction set this build or this machine does not have */
  SC_BAD_FILTER = 16,         /* a filter's buffer has not the size the asset asks for */
  SC_SHARED_MEMORY = 17,      /* a buffer that is written shares memory with another of the call's */
  SC_NOT_IN_ASSET = 18,       /* of an older baker, or of a source without bones */
  SC_TOO_FEW_BONES = 19,      /* fewer bone matrices than the asset has bones */
  SC_TOO_FEW_MORPHS = 20,     /* morph weights, but fewer than the asset has morph targets */
  SC_WRONG_ABI = 21,          /* compiled with the headers of another version of the library */
  SC_NO_DEVICE = 22,          /* no CUDA device, or no driver for one */
  SC_DEVICE_FAILED = 23,      /* the CUDA device or its driver reported an error */
  SC_DEVICE_TOO_SMALL = 24    /* the asset does not fit into a block's memory on the CUDA device */
};

/* A short English sentence without a final stop; never null, also for values that do not exist. */
SPHERECHAIN_API const char* sc_status_string(sc_status status);

/* SC_ABI_VERSION of the library itself. */
SPHERECHAIN_API uint32_t sc_abi_version(void);

/* Which of a sphere's radii: the paper's, or the one pairs are reported at by default. */
typedef int32_t sc_radius;
enum { SC_RADIUS_FIT = 0, SC_RADIUS_DETECT = 1 };

/* M1: chain by chain, as the paper. M2: over all spheres, and faster. */
typedef int32_t sc_method;
enum { SC_METHOD_M1 = 1, SC_METHOD_M2 = 2 };

/* The instruction set of a job. All give the same results, bit for bit; naming one is for tests. */
typedef int32_t sc_target;
enum {
  SC_TARGET_BEST = 0,
  SC_TARGET_SCALAR = 1,
  SC_TARGET_SSE2 = 2,
  SC_TARGET_SSSE3 = 3,
  SC_TARGET_AVX2 = 4,
  SC_TARGET_AVX512 = 5,
  SC_TARGET_NEON = 6
};

typedef int32_t sc_side;
enum { SC_SIDE_NONE = 0, SC_SIDE_LEFT = 1, SC_SIDE_RIGHT = 2 };

typedef int32_t sc_refit_rule;
enum { SC_REFIT_PAPER = 0, SC_REFIT_CALIBRATED = 1, SC_REFIT_MOMENTS = 2 };

/* A buffer of all the source's vertices, or of sc_asset_pivot_vertices alone, in that order. */
typedef int32_t sc_vertex_set;
enum { SC_VERTICES_SOURCE = 0, SC_VERTICES_PIVOTS = 1 };

/* How a matrix that moves points p to M (p; 1) lies in memory; the translation is M's fourth column. */
typedef int32_t sc_matrix_layout;
enum {
  SC_ROW_MAJOR_3X4 = 0,    /* 12 floats: three rows of four */
  SC_ROW_MAJOR_4X4 = 1,    /* 16 floats: four rows of four, the last not read */
  SC_COLUMN_MAJOR_4X4 = 2, /* 16 floats, each column's last not read: glTF, OpenGL, glm, Unity; DirectXMath, Unreal */
  SC_COLUMN_MAJOR_3X4 = 3  /* 12 floats: four columns of three */
};

typedef struct sc_vec3 {
  float x, y, z;
} sc_vec3;

/* A refitted sphere. */
typedef struct sc_sphere {
  float x, y, z, radius;
} sc_sphere;

/* Two touching spheres, a < b. */
typedef struct sc_pair {
  uint32_t a, b;
} sc_pair;

/* ---- The asset ---- */

/* A verified view of a .sphc file's bytes, immutable. It lives in memory of the caller's and needs no closing. */
typedef struct sc_asset sc_asset;

/* Bytes of an sc_asset: the same for any asset, and another number with another version of the library. */
SPHERECHAIN_API size_t sc_asset_size(void);

/* Verifies `size` bytes at `data`, aligned to 8, which must outlive the asset unchanged, and makes an sc_asset of the
 * first sc_asset_size() bytes of `memory`, aligned to 8 as malloc's is; `*asset` is that, or null on failure.
 * `abi_version` is SC_ABI_VERSION as the caller was compiled with. `message` may be null, else gets a sentence that
 * names what is wrong, cut to `message_size` bytes with the final zero (160 are enough), or an empty one.
 * Hostile bytes give a status, or an asset that every function here can use without reading or writing out of bounds.
 * SC_OK, SC_NULL_ARGUMENT, SC_MISALIGNED, SC_CONTEXT_TOO_SMALL, SC_TRUNCATED, SC_WRONG_IDENTIFIER,
 * SC_UNSUPPORTED_VERSION, SC_CORRUPT, SC_WRONG_ABI. This function's parameters never change. */
SPHERECHAIN_API sc_status sc_asset_open(uint32_t abi_version, void* memory, size_t memory_size, const void* data,
                                        size_t size, const sc_asset** asset, char* message, size_t message_size);

typedef struct sc_fit_error {
  float mean_abs_f, max_abs_f; /* the paper's F, source units */
} sc_fit_error;

typedef struct sc_asset_info {
  size_t struct_size;
  size_t sphere_count; /* 1 to 65535 */
  size_t region_count, chain_count;
  size_t joint_count; /* of the automatic rig; 0 where the source brings its own */
  size_t bone_count;  /* matrices of a refit from bones; 0 where nothing moves the source */
  size_t morph_count;
  size_t leaf_count; /* of sc_asset_leaves; 0 in assets of older bakers */
  size_t ignored_pair_count;
  const char *writer, *settings, *settings_sha256, *source_file, *source_sha256;
  uint64_t source_rest_hash;
  uint32_t format_version, source_vertex_count, source_triangle_count, chain_entries_table1;
  float metres_per_unit;
  float height;                      /* source units */
  sc_vec3 origin, left, up, forward; /* the character's own axes: orthonormal */
  sc_fit_error phi1, phi1_adjusted, phi2;
  sc_refit_rule refit;
  uint32_t reserved;
} sc_asset_info;

/* `info->struct_size` is sizeof(sc_asset_info). SC_OK, SC_NULL_ARGUMENT, SC_WRONG_ABI. */
SPHERECHAIN_API sc_status sc_asset_get_info(const sc_asset* asset, sc_asset_info* info);

typedef struct sc_rest_sphere {
  sc_vec3 center;
  float radius, detect_radius, pivot_spread;
  uint32_t first_pivot, first_triangle, triangle_count;
  uint16_t pivot_count;
  uint8_t region;
  uint8_t side;  /* an sc_side */
  int16_t level; /* torso: disk position from the bottom, the head's numbered on; limbs: -1 */
  uint16_t reserved;
} sc_rest_sphere;

/* A triangle that carries a sphere: source vertices, and its share of the centre. */
typedef struct sc_pivot {
  uint32_t a, b, c;
  float weight;
} sc_pivot;

/* Reported only where closer than reach * (ra + rb). */
typedef struct sc_near_pair {
  uint32_t a, b;
  float reach;
} sc_near_pair;

/* A vertex buffer of the source file: a run of the source's vertices. */
typedef struct sc_source_part {
  uint32_t mesh, primitive, first_vertex, vertex_count;
  uint64_t hash;
} sc_source_part;

/* Arrays of the asset, `*count` entries; null and 0 for a null asset, or where it has none. */
SPHERECHAIN_API const sc_rest_sphere* sc_asset_spheres(const sc_asset* asset, size_t* count);
SPHERECHAIN_API const sc_pivot* sc_asset_pivots(const sc_asset* asset, size_t* count);
/* Source triangle numbers, grouped by sphere: what first_triangle and sc_triangle_range count. */
SPHERECHAIN_API const uint32_t* sc_asset_triangles(const sc_asset* asset, size_t* count);
/* Words of a bit table: bit b(b-1)/2 + a for a < b is 1 where the pair is never reported. */
SPHERECHAIN_API const uint64_t* sc_asset_ignored(const sc_asset* asset, size_t* count);
SPHERECHAIN_API const sc_near_pair* sc_asset_near_pairs(const sc_asset* asset, sc_radius radius, size_t* count);
SPHERECHAIN_API const sc_source_part* sc_asset_source_parts(const sc_asset* asset, size_t* count);
/* Source vertices that pivots have corners at, ascending; and the pivots with their corners numbered in that list. */
SPHERECHAIN_API const uint32_t* sc_asset_pivot_vertices(const sc_asset* asset, size_t* count);
SPHERECHAIN_API const sc_pivot* sc_asset_packed_pivots(const sc_asset* asset, size_t* count);

/* A cluster of triangles of one sphere: its own run of sc_asset_triangles. The other fields are places in tables that
 * the C++ API alone shows. */
typedef struct sc_leaf {
  uint32_t sphere;
  uint32_t first_triangle;
  uint32_t first_vertex, first_bone, first_slot, first_weight, first_morph, morph_count;
  uint16_t triangle_count; /* >= 1 */
  uint16_t vertex_count;   /* 1 to 255 */
  uint16_t bone_count, reserved;
} sc_leaf;
SPHERECHAIN_API const sc_leaf* sc_asset_leaves(const sc_asset* asset, size_t* count);

typedef struct sc_region {
  const char* name;
  uint32_t triangle_count;
} sc_region;

typedef struct sc_chain {
  const char* name;
  const uint8_t* regions;
  size_t region_count;
  const uint32_t* spheres;
  size_t sphere_count;
} sc_chain;

typedef struct sc_joint {
  const char* name;
  int32_t parent; /* -1 for the root, else less than the joint's own index */
  sc_vec3 position, tail;
} sc_joint;

typedef struct sc_bone {
  const char* name;
  const float* inverse_bind; /* 12: rows of the 3 by 4 matrix from the rest pose to the bone's own space */
  int32_t is_rest;           /* no bone: stands for the vertices that none moves; the last, where there is one */
} sc_bone;

/* SC_OK, SC_NULL_ARGUMENT; SC_BAD_ARGUMENT where there is no such one. */
SPHERECHAIN_API sc_status sc_asset_region(const sc_asset* asset, size_t index, sc_region* region);
SPHERECHAIN_API sc_status sc_asset_chain(const sc_asset* asset, size_t index, sc_chain* chain);
SPHERECHAIN_API sc_status sc_asset_joint(const sc_asset* asset, size_t index, sc_joint* joint);
SPHERECHAIN_API sc_status sc_asset_bone(const sc_asset* asset, size_t index, sc_bone* bone);
/* Null where there is no such morph target. */
SPHERECHAIN_API const char* sc_asset_morph_name(const sc_asset* asset, size_t index);

/* Are these the positions, x y z, `stride` bytes apart (a multiple of 4, at least 12), the asset was baked from: the
 * whole source's at rest, or those of one of its parts as the file has them? SC_OK or SC_WRONG_SOURCE;
 * SC_NULL_ARGUMENT, SC_BAD_STRIDE, SC_TOO_FEW_VERTICES, SC_BAD_ARGUMENT. */
SPHERECHAIN_API sc_status sc_check_source(const sc_asset* asset, const float* positions, size_t count, size_t stride);
SPHERECHAIN_API sc_status sc_check_source_part(const sc_asset* asset, size_t part, const float* positions, size_t count,
                                               size_t stride);

/* What source_rest_hash and a part's hash are made by; `positions` of `count` vertices. 0 where they are null or
 * misaligned, or the stride is none. */
SPHERECHAIN_API uint64_t sc_hash_positions(const float* positions, size_t count, size_t stride);

/* ---- Spheres that follow the character ---- */

/* From deformed vertices. */
typedef struct sc_refit_job {
  size_t struct_size;
  const sc_asset* asset;
  const float* positions; /* x y z of each vertex of the set, in any space with the asset's scale */
  size_t vertex_count;    /* at least info.source_vertex_count, or as many as sc_asset_pivot_vertices */
  size_t stride;          /* bytes from one position to the next; a multiple of 4, at least 12 */
  sc_vertex_set vertices;
  sc_radius radius;
  sc_sphere* spheres;  /* out */
  size_t sphere_count; /* entries there: at least info.sphere_count; more are left alone */
} sc_refit_job;
#define SC_REFIT_JOB_INIT \
  { sizeof(sc_refit_job), NULL, NULL, 0, 12, SC_VERTICES_SOURCE, SC_RADIUS_DETECT, NULL, 0 }

/* SC_OK, SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_TOO_FEW_VERTICES, SC_TOO_FEW_SPHERES, SC_BAD_STRIDE, SC_BAD_ARGUMENT,
 * SC_NOT_IN_ASSET, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_refit(const sc_refit_job* job);

typedef struct sc_bone_matrices {
  const float* data;
  size_t count;  /* at least info.bone_count */
  size_t stride; /* bytes from one matrix to the next; a multiple of 4, at least 48, or 64 for 4 by 4 */
  sc_matrix_layout layout;
  uint32_t reserved;
} sc_bone_matrices;

/* From bone matrices, without the mesh. For each sc_asset_bone, in that order, the matrix from the rest pose to the
 * deformed one: its joint's world matrix times inverse_bind, the palette of a skinning shader. "World" is any space,
 * and the spheres'. An automatic rig's joints rest unrotated at sc_joint's position. */
typedef struct sc_refit_bones_job {
  size_t struct_size;
  const sc_asset* asset;
  sc_bone_matrices bones;
  const float* morph_weights; /* null where nothing morphs */
  size_t morph_weight_count;  /* 0, or at least info.morph_count */
  sc_radius radius;
  sc_target target;
  sc_sphere* spheres;  /* out */
  size_t sphere_count; /* entries there: at least info.sphere_count; more are left alone */
} sc_refit_bones_job;
#define SC_REFIT_BONES_JOB_INIT                                                                                      \
  {                                                                                                                  \
    sizeof(sc_refit_bones_job), NULL, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, NULL, 0, SC_RADIUS_DETECT, SC_TARGET_BEST, \
        NULL, 0                                                                                                      \
  }

/* SC_OK, SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_BAD_ARGUMENT, SC_BAD_STRIDE, SC_NOT_IN_ASSET, SC_TOO_FEW_BONES,
 * SC_TOO_FEW_MORPHS, SC_TOO_FEW_SPHERES, SC_UNSUPPORTED_TARGET, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_refit_bones(const sc_refit_bones_job* job);

/* ---- The skin itself, from bones alone ---- */

/* Balls that contain the skin in the pose, whatever it is: one around the vertices of each leaf, a cluster of at most
 * 64 triangles. Proven for finite matrices and weights, turned, stretched, sheared or mirrored, roundings and all. */
typedef struct sc_cover_job {
  size_t struct_size;
  const sc_asset* asset;
  sc_bone_matrices bones;     /* as in sc_refit_bones_job */
  const float* morph_weights; /* null where nothing morphs */
  size_t morph_weight_count;  /* 0, or at least info.morph_count */
  sc_target target;
  uint32_t reserved;
  sc_sphere* leaves;   /* out */
  size_t leaf_count;   /* entries there: at least info.leaf_count; more are left alone */
  sc_sphere* spheres;  /* out: balls around the leaves of each sphere; null where they are not wanted */
  size_t sphere_count; /* 0, or at least info.sphere_count */
} sc_cover_job;
#define SC_COVER_JOB_INIT \
  { sizeof(sc_cover_job), NULL, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, NULL, 0, SC_TARGET_BEST, 0, NULL, 0, NULL, 0 }

/* SC_OK, SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_BAD_ARGUMENT, SC_BAD_STRIDE, SC_NOT_IN_ASSET, SC_TOO_FEW_BONES,
 * SC_TOO_FEW_MORPHS, SC_TOO_FEW_SPHERES, SC_UNSUPPORTED_TARGET, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_cover(const sc_cover_job* job);

/* Where the skin's vertices are: linear blend skinning of the asset's own copy of the mesh. Of source vertices at one
 * place that move alike only the lowest is written. */
typedef struct sc_skin_job {
  size_t struct_size;
  const sc_asset* asset;
  sc_bone_matrices bones;     /* as in sc_refit_bones_job */
  const float* morph_weights; /* null where nothing morphs */
  size_t morph_weight_count;  /* 0, or at least info.morph_count */
  sc_target target;
  uint32_t reserved;
  float* positions;    /* out: x y z of vertices of the source; others are left alone */
  size_t vertex_count; /* at least info.source_vertex_count */
  size_t stride;       /* bytes from one position to the next; a multiple of 4, at least 12 */
} sc_skin_job;
#define SC_SKIN_JOB_INIT \
  { sizeof(sc_skin_job), NULL, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, NULL, 0, SC_TARGET_BEST, 0, NULL, 0, 12 }

/* SC_OK, SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_BAD_ARGUMENT, SC_BAD_STRIDE, SC_NOT_IN_ASSET, SC_TOO_FEW_BONES,
 * SC_TOO_FEW_MORPHS, SC_TOO_FEW_VERTICES, SC_UNSUPPORTED_TARGET, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_skin(const sc_skin_job* job);

/* ---- What detection leaves out ---- */

/* Begun by sc_reset_filter as what the asset says, edited below, read by jobs. The buffers are the caller's. */
typedef struct sc_filter {
  uint64_t* ignored; /* as sc_asset_ignored; required */
  size_t ignored_words;
  uint64_t* disabled; /* bit i: sphere i touches nothing; null: all are enabled */
  size_t disabled_words;
  float* padding; /* added to each sphere's radius; below 0 after it: touches nothing; null: none */
  size_t padding_count;
} sc_filter;

/* What the three sizes must be. padding_count is info.sphere_count. */
SPHERECHAIN_API size_t sc_filter_ignored_words(const sc_asset* asset);
SPHERECHAIN_API size_t sc_filter_disabled_words(const sc_asset* asset);

/* All of these: SC_OK, SC_NULL_ARGUMENT, SC_BAD_FILTER (also where a buffer to write is missing), SC_BAD_ARGUMENT;
 * and but for sc_check_filter SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_check_filter(const sc_asset* asset, const sc_filter* filter);
SPHERECHAIN_API sc_status sc_reset_filter(const sc_asset* asset, sc_filter* filter);
/* `ignored` 0 reports the pairs again. */
SPHERECHAIN_API sc_status sc_ignore_pair(const sc_asset* asset, sc_filter* filter, uint32_t a, uint32_t b, int ignored);
/* Each pair of a sphere of one region with one of the other; the same twice: the pairs within it. */
SPHERECHAIN_API sc_status sc_ignore_regions(const sc_asset* asset, sc_filter* filter, size_t region, size_t other,
                                            int ignored);
/* Each pair that some chain holds at most `hops` places apart. */
SPHERECHAIN_API sc_status sc_ignore_hops(const sc_asset* asset, sc_filter* filter, size_t hops, int ignored);
SPHERECHAIN_API sc_status sc_disable_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere, int disabled);
/* Finite, may be negative; replaces what was added before. */
SPHERECHAIN_API sc_status sc_pad_sphere(const sc_asset* asset, sc_filter* filter, uint32_t sphere, float padding);

/* ---- Which spheres touch ---- */

/* A pair as M1 finds it, once for every chain that holds both spheres. */
typedef struct sc_chain_pair {
  uint32_t chain;
  sc_pair pair;
} sc_chain_pair;

/* Ask for what you need: pairs, bits, both, or neither to count. */
typedef struct sc_detect_job {
  size_t struct_size;
  const sc_asset* asset;
  const sc_sphere* spheres; /* refitted with the same `radius` */
  size_t sphere_count;      /* at least info.sphere_count */
  sc_radius radius;
  sc_method method;
  sc_target target;
  int32_t first_only;      /* M2: not 0 stops at the first pair of the sorted list */
  const sc_filter* filter; /* null: what the asset says */
  uint64_t* table;    /* from sc_prepare_detect with this asset and radius: faster, the same pairs; or null. Then */
  size_t table_words; /* it says which pairs and spheres are left out, and `filter` adds its padding */
  uint64_t* scratch;  /* M1: required, sc_detect_scratch_words(); M2: null */
  size_t scratch_words;
  sc_pair* pairs; /* out: sorted by (a, b), each once; may be null */
  size_t pair_capacity;
  uint64_t* bits;             /* out: bit b(b-1)/2 + a of each pair found, the rest 0; may be null */
  size_t bit_words;           /* sc_detect_bit_words() exactly, or 0 */
  sc_chain_pair* chain_pairs; /* out, M1: the raw list, chain by chain; may be null */
  size_t chain_pair_capacity;
  size_t pair_count;       /* out: pairs there are, also after SC_OVERFLOW; first_only: 0 or 1 */
  size_t chain_pair_count; /* out: M1: with repeats; M2: pair_count */
  size_t test_count;       /* out: distance tests */
} sc_detect_job;
#define SC_DETECT_JOB_INIT                                                                                           \
  {                                                                                                                  \
    sizeof(sc_detect_job), NULL, NULL, 0, SC_RADIUS_DETECT, SC_METHOD_M2, SC_TARGET_BEST, 0, NULL, NULL, 0, NULL, 0, \
        NULL, 0, NULL, 0, NULL, 0, 0, 0, 0                                                                           \
  }

SPHERECHAIN_API size_t sc_detect_scratch_words(const sc_asset* asset);
SPHERECHAIN_API size_t sc_detect_bit_words(const sc_asset* asset);
SPHERECHAIN_API size_t sc_detect_table_words(const sc_asset* asset);

/* Which pairs to look at, worked out once for any number of sc_detect with this asset, radius and filter (null: what
 * the asset says); again where the filter is edited. SC_OK, SC_NULL_ARGUMENT, SC_MISALIGNED, SC_BAD_ARGUMENT,
 * SC_CONTEXT_TOO_SMALL, SC_BAD_FILTER, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_prepare_detect(const sc_asset* asset, sc_radius radius, const sc_filter* filter,
                                            uint64_t* table, size_t table_words);

/* SC_OK, SC_OVERFLOW (the first entries are written), SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_TOO_FEW_SPHERES,
 * SC_CONTEXT_TOO_SMALL, SC_BAD_ARGUMENT, SC_UNSUPPORTED_TARGET, SC_BAD_FILTER, SC_SHARED_MEMORY. 25 KiB of stack. */
SPHERECHAIN_API sc_status sc_detect(sc_detect_job* job);

/* ---- What to do about it ---- */

/* sc_asset_triangles()[first] to [first + count - 1]. */
typedef struct sc_triangle_range {
  uint32_t first, count;
} sc_triangle_range;

typedef struct sc_contact {
  sc_pair pair;
  float depth;    /* how far one sphere must move along the normal to part them */
  float severity; /* volume that is in both, units cubed */
  sc_vec3 normal; /* from a's centre to b's, unit length; (1, 0, 0) where they coincide */
  sc_vec3 point;  /* on the line of centres, the middle of what is in both */
  sc_triangle_range triangles_a, triangles_b;
} sc_contact;

typedef struct sc_contact_job {
  size_t struct_size;
  const sc_asset* asset;
  const sc_sphere* spheres; /* those the pairs were found among */
  size_t sphere_count;
  const sc_pair* pairs; /* from sc_detect, or any a < b */
  size_t pair_count;
  const sc_filter* filter; /* null, or the one the pairs were found with */
  sc_contact* contacts;    /* out: one a pair, in their order; null: the deepest alone */
  size_t contact_capacity;
  size_t contact_count; /* out: as many as pairs, also after SC_OVERFLOW */
  size_t deepest;       /* out: the pair of the greatest depth above 0; contact_count: none */
} sc_contact_job;
#define SC_CONTACT_JOB_INIT \
  { sizeof(sc_contact_job), NULL, NULL, 0, NULL, 0, NULL, NULL, 0, 0, 0 }

/* SC_OK, SC_OVERFLOW (the first are written), SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_TOO_FEW_SPHERES, SC_BAD_FILTER,
 * SC_BAD_ARGUMENT (a pair that cannot be), SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_contacts(sc_contact_job* job);

/* ---- Which triangles of the skin intersect ---- */

/* Of two spheres that are not ignored; of one sphere, or of two that are ignored (folds of an elbow); all. */
typedef int32_t sc_contact_scope;
enum { SC_CONTACTS_APART = 0, SC_CONTACTS_OF_NEIGHBOURS = 1, SC_CONTACTS_ALL = 2 };

/* Source triangles, a < b. */
typedef struct sc_triangle_pair {
  uint32_t a, b;
} sc_triangle_pair;

/* What two triangles have in common. */
typedef struct sc_triangle_contact {
  sc_triangle_pair triangles;
  sc_vec3 from, to; /* the segment; of triangles in one plane the longest piece of an edge in the other triangle */
  sc_vec3 normal;   /* unit length, of one of the two planes */
  float depth;      /* how far one triangle must move along it to part them */
} sc_triangle_contact;

typedef struct sc_sphere_contact {
  sc_pair spheres; /* a < b; a = b within one region */
  uint32_t count;  /* pairs of triangles; at least 1 */
  sc_triangle_contact deepest;
} sc_sphere_contact;

/* All pairs of triangles that intersect, none else, decided exactly, but for those that share a position at rest or
 * intersect there. Spheres and radii play no part. From deformed vertices, or from bones where `positions` is null;
 * from both, bones that give those very positions but for rounding, for less than from vertices alone. */
typedef struct sc_triangle_contact_job {
  size_t struct_size;
  const sc_asset* asset;
  const float* positions;     /* deformed vertices in the source's order, x y z after another; or null */
  size_t vertex_count;        /* at least info.source_vertex_count */
  size_t stride;              /* bytes from one vertex to the next; a multiple of 4, at least 12 */
  sc_bone_matrices bones;     /* as in sc_refit_bones_job; beside positions they may be null */
  const float* morph_weights; /* null where nothing morphs */
  size_t morph_weight_count;  /* 0, or at least info.morph_count */
  sc_target target;
  sc_contact_scope scope;
  const sc_filter* filter; /* null: what the asset says; padding is of no effect */
  uint64_t* scratch;       /* required: sc_triangle_contact_scratch_words() */
  size_t scratch_words;
  sc_triangle_pair* pairs; /* out: sorted, each once; may be null */
  size_t pair_capacity;
  sc_triangle_contact* contacts; /* out: the same with where they intersect; may be null */
  size_t contact_capacity;
  sc_sphere_contact* sphere_contacts; /* out: sorted by their spheres; may be null */
  size_t sphere_contact_capacity;
  size_t pair_count; /* out: pairs of triangles there are, also after SC_OVERFLOW */
  size_t sphere_contact_count;
} sc_triangle_contact_job;
#define SC_TRIANGLE_CONTACT_JOB_INIT                                                                                 \
  {                                                                                                                  \
    sizeof(sc_triangle_contact_job), NULL, NULL, 0, 12, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, NULL, 0, SC_TARGET_BEST, \
        SC_CONTACTS_APART, NULL, NULL, 0, NULL, 0, NULL, 0, NULL, 0, 0, 0                                            \
  }

/* Words for each of the three jobs here; 0 for a null asset, and for one without a surface. */
SPHERECHAIN_API size_t sc_triangle_contact_scratch_words(const sc_asset* asset);

/* SC_OK, SC_OVERFLOW (the first entries are written), SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_NOT_IN_ASSET,
 * SC_TOO_FEW_VERTICES, SC_BAD_STRIDE, SC_TOO_FEW_BONES, SC_TOO_FEW_MORPHS, SC_CONTEXT_TOO_SMALL, SC_BAD_ARGUMENT,
 * SC_UNSUPPORTED_TARGET, SC_BAD_FILTER, SC_MISALIGNED, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_triangle_contacts(sc_triangle_contact_job* job);

/* Which spheres' skins intersect: the spheres of sc_triangle_contacts' contacts between spheres that are not ignored,
 * for less. Whether spheres touch plays no part. The pose as above. */
typedef struct sc_detect_skin_job {
  size_t struct_size;
  const sc_asset* asset;
  const float* positions;
  size_t vertex_count;
  size_t stride;
  sc_bone_matrices bones;
  const float* morph_weights;
  size_t morph_weight_count;
  sc_target target;
  uint32_t reserved;
  const sc_filter* filter; /* null: what the asset says; padding is of no effect */
  uint64_t* scratch;       /* required: sc_triangle_contact_scratch_words() */
  size_t scratch_words;
  sc_pair* pairs; /* out: sorted, each once; may be null */
  size_t pair_capacity;
  size_t pair_count; /* out: those there are, also after SC_OVERFLOW */
} sc_detect_skin_job;
#define SC_DETECT_SKIN_JOB_INIT                                                                                    \
  {                                                                                                                \
    sizeof(sc_detect_skin_job), NULL, NULL, 0, 12, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, NULL, 0, SC_TARGET_BEST, 0, \
        NULL, NULL, 0, NULL, 0, 0                                                                                  \
  }

/* As sc_triangle_contacts. */
SPHERECHAIN_API sc_status sc_detect_skin(sc_detect_skin_job* job);

/* Of some pairs of spheres, those whose skins intersect: what is true of sc_detect's alarm. The pose as above. */
typedef struct sc_confirm_job {
  size_t struct_size;
  const sc_asset* asset;
  const float* positions;
  size_t vertex_count;
  size_t stride;
  sc_bone_matrices bones;
  const float* morph_weights;
  size_t morph_weight_count;
  sc_target target;
  uint32_t reserved;
  const sc_pair* candidates; /* from sc_detect, or any two spheres; in any order, ignored ones are answered too */
  size_t candidate_count;
  uint64_t* scratch; /* required: sc_triangle_contact_scratch_words() */
  size_t scratch_words;
  sc_pair* pairs; /* out: those confirmed, in the candidates' order; may be null */
  size_t pair_capacity;
  size_t pair_count; /* out: those confirmed, also after SC_OVERFLOW */
} sc_confirm_job;
#define SC_CONFIRM_JOB_INIT                                                                                          \
  {                                                                                                                  \
    sizeof(sc_confirm_job), NULL, NULL, 0, 12, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, NULL, 0, SC_TARGET_BEST, 0, NULL, \
        0, NULL, 0, NULL, 0, 0                                                                                       \
  }

/* As sc_triangle_contacts, but without SC_BAD_FILTER; SC_BAD_ARGUMENT also for a candidate that is no two spheres. */
SPHERECHAIN_API sc_status sc_confirm(sc_confirm_job* job);

/* ---- Many instances of one asset ---- */

typedef struct sc_crowd_pair {
  uint32_t instance;
  sc_pair pair;
} sc_crowd_pair;

/* Calls task(data, i) once for each i below `count`, on any threads in any order, and returns when all have. */
typedef void (*sc_parallel_for)(void* user, size_t count, void (*task)(void* data, size_t i), void* data);

/* M2 for each instance, which comes as spheres or as bones: the same pairs as from sc_refit_bones and sc_detect. */
typedef struct sc_crowd_job {
  size_t struct_size;
  const sc_asset* asset;
  const sc_sphere* spheres; /* instance i's start at spheres[i * stride]; null: refitted from bones */
  size_t instance_count;    /* below 2^32 */
  size_t stride;            /* in spheres; at least info.sphere_count, or 0: as many */
  sc_bone_matrices bones;   /* instance 0's; data null: from spheres */
  size_t instance_stride;   /* bytes from one instance's first matrix to the next's; a multiple of 4 */
  const float* morph_weights;
  size_t morph_weight_count; /* info.morph_count an instance, or 0 */
  sc_radius radius;
  sc_target target;
  const sc_filter* filter;
  uint64_t* scratch; /* required: sc_crowd_scratch_words() */
  size_t scratch_words;
  sc_parallel_for parallel_for; /* null: one task after the other on the calling thread */
  void* user;                   /* parallel_for's first argument */
  size_t task_count;            /* at least 1: into how many tasks the instances are dealt */
  uint32_t* counts;             /* out: pairs of each instance; null only without `pairs` */
  size_t counts_capacity;       /* at least instance_count, or 0 */
  uint64_t* bits;               /* out: sc_detect_bit_words() words an instance; may be null */
  size_t bit_words;
  sc_crowd_pair* pairs; /* out: sorted by instance, then pair; may be null */
  size_t pair_capacity;
  size_t pair_count; /* out: pairs there are, also after SC_OVERFLOW */
} sc_crowd_job;
#define SC_CROWD_JOB_INIT                                                                                     \
  {                                                                                                           \
    sizeof(sc_crowd_job), NULL, NULL, 0, 0, {NULL, 0, 48, SC_ROW_MAJOR_3X4, 0}, 0, NULL, 0, SC_RADIUS_DETECT, \
        SC_TARGET_BEST, NULL, NULL, 0, NULL, NULL, 1, NULL, 0, NULL, 0, NULL, 0, 0                            \
  }

/* Words for a job of `task_count` tasks. */
SPHERECHAIN_API size_t sc_crowd_scratch_words(const sc_asset* asset, size_t task_count);

/* SC_OK, SC_OVERFLOW (the first are written), SC_NULL_ARGUMENT, SC_WRONG_ABI, SC_BAD_STRIDE, SC_NOT_IN_ASSET,
 * SC_TOO_FEW_BONES, SC_TOO_FEW_MORPHS, SC_TOO_FEW_SPHERES, SC_CONTEXT_TOO_SMALL, SC_BAD_ARGUMENT,
 * SC_UNSUPPORTED_TARGET, SC_BAD_FILTER, SC_SHARED_MEMORY. */
SPHERECHAIN_API sc_status sc_crowd(sc_crowd_job* job);

/* ---- Instruction sets ---- */

/* Those this build has and this machine runs, best first, the last SC_TARGET_SCALAR: writes at most `capacity`, returns
 * how many there are. `targets` may be null where `capacity` is 0. */
SPHERECHAIN_API size_t sc_supported_targets(sc_target* targets, size_t capacity);
/* "scalar", "avx2" ...; never null. */
SPHERECHAIN_API const char* sc_target_name(sc_target target);
/* The supported target of that name, or "best". SC_OK, SC_NULL_ARGUMENT, SC_UNSUPPORTED_TARGET. */
SPHERECHAIN_API sc_status sc_find_target(const char* name, sc_target* target);
/* Floats of a vector register: 1, 4, 8 or 16; 0 where it is not supported. */
SPHERECHAIN_API size_t sc_target_lanes(sc_target target);

#ifdef __cplusplus
}
#endif
