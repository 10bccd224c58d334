/* SPDX-License-Identifier: MIT */
/* Small types that all headers share, and how the headers bind to the library. C99 and C++17. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* The version of the binary interface. It changes with every incompatible change of a struct, an enum or a function.
 * sc_asset_open() and sc_create_model() compare the program's number with the library's and refuse another
 * (SC_WRONG_ABI). docs/integration.md has the promise. */
#define SC_ABI_VERSION 18

/* Marks what a shared library exports. The CMake target and pkg-config define SPHERECHAIN_SHARED where the library is
 * shared; SPHERECHAIN_BUILDING is defined only while the library itself is built. */
#if !defined(SPHERECHAIN_SHARED)
#define SPHERECHAIN_API
#elif !defined(_WIN32)
#define SPHERECHAIN_API __attribute__((visibility("default")))
#elif defined(SPHERECHAIN_BUILDING)
#define SPHERECHAIN_API __declspec(dllexport)
#else
#define SPHERECHAIN_API __declspec(dllimport)
#endif

/* Every struct and enum is defined once, for C and C++ alike. All fields default to zero: C++ initialises them. Enums
 * are 32-bit integers on both sides. Their values are never reassigned; later versions may add some.
 *
 * A struct that begins with struct_size may get more fields at its end, where 0 means: as before. C++ sets the size; C
 * programs write `sc_query query = {.struct_size = sizeof query};`. With 0 the library reads the fields of release
 * 0.1.0 alone. SC_BAD_VALUE with SC_FIELD_STRUCT_SIZE: no version has such a size, or a field is set that the library
 * is too old to know.
 *
 * Every other struct keeps its size and its fields. Reserved fields are 0 until a version names them. */
#if defined(__cplusplus)
#define SC_ZERO \
  {}
#define SC_SIZE_OF(type) \
  { sizeof(type) }
#define SC_NOEXCEPT noexcept
#define SC_ENUM(name) enum name : int32_t
#else
#define SC_ZERO
#define SC_SIZE_OF(type)
#define SC_NOEXCEPT
#define SC_ENUM(name)   \
  typedef int32_t name; \
  enum
#endif

typedef struct sc_vec3 {
  float x, y, z;
} sc_vec3;

/* A sphere in some pose: four floats, in the units and space of the pose. */
typedef struct sc_sphere {
  float x, y, z, radius;
} sc_sphere;

/* Two indices, a < b unless the field that holds them says otherwise. Lists of pairs are sorted by (a, b). */
typedef struct sc_pair {
  uint32_t a, b;
} sc_pair;

/* Which of a sphere's two radii an operation uses. */
SC_ENUM(sc_radius){
    SC_RADIUS_DETECT = 0, /* the default: reaches most of the skin that the sphere stands for */
    SC_RADIUS_FIT = 1,    /* the paper's */
};

/* The instruction set of the inner loops. Every target gives the same results, bit for bit; name one only to test, or
 * to keep AVX-512 out of a game. */
SC_ENUM(sc_target){
    SC_TARGET_BEST = 0, /* the best that the build has and the machine runs */
    SC_TARGET_SCALAR = 1, SC_TARGET_SSE2 = 2, SC_TARGET_SSSE3 = 3, SC_TARGET_AVX2 = 4, /* with BMI2 and FMA */
    SC_TARGET_AVX512 = 5,                                                              /* F, VL, DQ, BW, CD */
    SC_TARGET_NEON = 6,   SC_TARGET_WASM = 7, /* WebAssembly's SIMD of 128 bits */
};

/* Error codes. */
SC_ENUM(sc_code){
    SC_OK = 0,
    SC_OVERFLOW = 1,            /* an output buffer is too small; the job's counts say how many entries there are */
    SC_NULL = 2,                /* the field is required and null */
    SC_MISALIGNED = 3,          /* the field's memory is not aligned as its type */
    SC_TOO_SMALL = 4,           /* the field has fewer entries than the call needs */
    SC_BAD_STRIDE = 5,          /* a stride below the size of an entry, or no multiple of 4 */
    SC_BAD_VALUE = 6,           /* the field has a value that does not exist */
    SC_ALIASED = 7,             /* the field is written and overlaps another buffer of the call */
    SC_NOT_OPEN = 8,            /* the asset was never opened */
    SC_NOT_IN_ASSET = 9,        /* the asset has no data for this: no bones, or no triangles */
    SC_UNSUPPORTED_TARGET = 10, /* this build or this machine lacks the instruction set */
    SC_NOT_AN_ASSET = 11,       /* the bytes are no .sphc file */
    SC_OTHER_VERSION = 12,      /* the asset needs a later library, or is older than release 0.1.0 */
    SC_CORRUPT = 13,            /* the asset is cut short or damaged */
    SC_WRONG_ABI = 14,          /* the program was compiled with other headers than the library */
    SC_WRONG_SOURCE = 15,       /* these are not the vertices that the asset was baked from */
    SC_NO_SUCH_BONE = 16,       /* the skeleton lacks a bone of the asset */
    SC_OTHER_BIND = 17,         /* a bone's inverse bind matrix, or its place at rest, differs from the asset's */
    SC_NO_MEMORY = 18,          /* an allocation failed (of a model, a body or a HostCrowd) */
    SC_NO_DEVICE = 19,          /* no CUDA device, or no driver for one */
    SC_DEVICE_FAILED = 20,      /* the CUDA device or its driver reported an error */
    SC_DEVICE_TOO_SMALL = 21,   /* the asset does not fit into a block's memory on the CUDA device */
};

/* The field or argument that a status is about. */
SC_ENUM(sc_field){
    SC_FIELD_NONE = 0,
    SC_FIELD_ASSET = 1,
    SC_FIELD_DATA = 2,
    SC_FIELD_BONES = 3,
    SC_FIELD_BONE_COUNT = 4,
    SC_FIELD_BONE_LAYOUT = 5,
    SC_FIELD_BONE_STRIDE = 6,
    SC_FIELD_VERTICES = 7,
    SC_FIELD_VERTEX_COUNT = 8,
    SC_FIELD_VERTEX_STRIDE = 9,
    SC_FIELD_MORPH_WEIGHTS = 10,
    SC_FIELD_RADIUS = 11,
    SC_FIELD_TARGET = 12,
    SC_FIELD_SPHERES = 13,
    SC_FIELD_TABLE = 14,
    SC_FIELD_IGNORED_PAIRS = 15,
    SC_FIELD_PAIRS = 16,
    SC_FIELD_BITS = 17,
    SC_FIELD_SCOPE = 18,
    SC_FIELD_CANDIDATES = 19,
    SC_FIELD_SCRATCH = 20,
    SC_FIELD_PARTS = 21,
    SC_FIELD_TRIANGLES = 22,
    SC_FIELD_INSTANCES = 23,
    SC_FIELD_INSTANCE_STRIDE = 24,
    SC_FIELD_TASKS = 25,
    SC_FIELD_COUNTS = 26,
    SC_FIELD_JOINTS = 27,
    SC_FIELD_INDEX = 28,
    SC_FIELD_OUTPUT = 29,
    SC_FIELD_STREAM = 30,
    SC_FIELD_SKIN_TABLE = 31,
    SC_FIELD_CONTACTS = 32,
    SC_FIELD_PREVIOUS = 33,
    SC_FIELD_PENETRATIONS = 34,
    SC_FIELD_RULE = 35,
    SC_FIELD_IGNORED_PARTS = 36,
    SC_FIELD_BODIES = 37,
    SC_FIELD_LAYERS = 38,
    SC_FIELD_IGNORED = 39,
    SC_FIELD_FLOOR = 40,
    SC_FIELD_END = 41,
    SC_FIELD_BLEND = 42,
    SC_FIELD_PARENTS = 43,
    SC_FIELD_TOLERANCE = 44,
    SC_FIELD_TRANSFORM = 45,
    SC_FIELD_ALLOCATOR = 46,
    SC_FIELD_QUERY = 47,
    SC_FIELD_PART_PAIRS = 48,
    SC_FIELD_STRUCT_SIZE = 49,
};

/* The result of every operation: an error code, and the field that caused it. */
typedef struct sc_status {
  sc_code code;
  sc_field field;
} sc_status;

#if defined(__cplusplus)
extern "C" {
#endif

/* "null", "too small" ...; the field's name as the headers spell it, "pose.bones". Never null. */
SPHERECHAIN_API const char* sc_code_text(sc_code code) SC_NOEXCEPT;
SPHERECHAIN_API const char* sc_field_name(sc_field field) SC_NOEXCEPT;

/* "scalar", "avx2" ...; never null. */
SPHERECHAIN_API const char* sc_target_name(sc_target target) SC_NOEXCEPT;
/* The targets that this build has and this machine runs, best first; the last is SC_TARGET_SCALAR. */
SPHERECHAIN_API const sc_target* sc_supported_targets(size_t* count) SC_NOEXCEPT;

#if defined(__cplusplus)
}

inline bool operator==(const sc_pair& l, const sc_pair& r) { return l.a == r.a && l.b == r.b; }
inline bool operator!=(const sc_pair& l, const sc_pair& r) { return !(l == r); }
inline bool operator<(const sc_pair& l, const sc_pair& r) {
  return (uint64_t{l.a} << 32 | l.b) < (uint64_t{r.a} << 32 | r.b);
}
inline bool operator==(const sc_status& l, const sc_status& r) { return l.code == r.code && l.field == r.field; }
inline bool operator!=(const sc_status& l, const sc_status& r) { return !(l == r); }
inline bool operator==(const sc_status& l, sc_code r) { return l.code == r; }
inline bool operator!=(const sc_status& l, sc_code r) { return l.code != r; }

namespace spherechain {
using Vec3 = sc_vec3;
using Sphere = sc_sphere;
using Pair = sc_pair;
using Radius = sc_radius;
using Target = sc_target;
using Status = sc_status;
inline const char* code_text(Status status) noexcept { return sc_code_text(status.code); }
inline const char* field_name(Status status) noexcept { return sc_field_name(status.field); }
}  // namespace spherechain
#endif
