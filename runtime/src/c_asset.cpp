// SPDX-License-Identifier: MIT
// The C API's asset, statuses and targets.
#include <cstdint>
#include <new>

#include "c_api.h"
#include "memory.h"
#include "message.h"
#include "spherechain/simd.h"
#include "stride.h"

using namespace spherechain;

namespace {

static_assert(SC_OK == static_cast<int>(Status::kOk) && SC_NULL_ARGUMENT == static_cast<int>(Status::kNullArgument) &&
              SC_MISALIGNED == static_cast<int>(Status::kMisaligned) &&
              SC_TRUNCATED == static_cast<int>(Status::kTruncated) &&
              SC_WRONG_IDENTIFIER == static_cast<int>(Status::kWrongIdentifier) &&
              SC_UNSUPPORTED_VERSION == static_cast<int>(Status::kUnsupportedVersion) &&
              SC_CORRUPT == static_cast<int>(Status::kCorrupt) && SC_NOT_OPEN == static_cast<int>(Status::kNotOpen) &&
              SC_TOO_FEW_VERTICES == static_cast<int>(Status::kTooFewVertices) &&
              SC_TOO_FEW_SPHERES == static_cast<int>(Status::kTooFewSpheres) &&
              SC_CONTEXT_TOO_SMALL == static_cast<int>(Status::kContextTooSmall) &&
              SC_OVERFLOW == static_cast<int>(Status::kOverflow) &&
              SC_BAD_STRIDE == static_cast<int>(Status::kBadStride) &&
              SC_WRONG_SOURCE == static_cast<int>(Status::kWrongSource) &&
              SC_BAD_ARGUMENT == static_cast<int>(Status::kBadArgument) &&
              SC_UNSUPPORTED_TARGET == static_cast<int>(Status::kUnsupportedTarget) &&
              SC_BAD_FILTER == static_cast<int>(Status::kBadFilter) &&
              SC_SHARED_MEMORY == static_cast<int>(Status::kSharedMemory) &&
              SC_NOT_IN_ASSET == static_cast<int>(Status::kNotInAsset) &&
              SC_TOO_FEW_BONES == static_cast<int>(Status::kTooFewBones) &&
              SC_TOO_FEW_MORPHS == static_cast<int>(Status::kTooFewMorphs) &&
              SC_WRONG_ABI == static_cast<int>(Status::kWrongAbi) &&
              SC_NO_DEVICE == static_cast<int>(Status::kNoDevice) &&
              SC_DEVICE_FAILED == static_cast<int>(Status::kDeviceFailed) &&
              SC_DEVICE_TOO_SMALL == static_cast<int>(Status::kDeviceTooSmall));
static_assert(SC_TARGET_BEST == static_cast<int>(Target::kBest) &&
              SC_TARGET_SCALAR == static_cast<int>(Target::kScalar) &&
              SC_TARGET_SSE2 == static_cast<int>(Target::kSse2) &&
              SC_TARGET_SSSE3 == static_cast<int>(Target::kSsse3) &&
              SC_TARGET_AVX2 == static_cast<int>(Target::kAvx2) &&
              SC_TARGET_AVX512 == static_cast<int>(Target::kAvx512) &&
              SC_TARGET_NEON == static_cast<int>(Target::kNeon));
static_assert(SC_RADIUS_FIT == static_cast<int>(RadiusKind::kFit) &&
              SC_RADIUS_DETECT == static_cast<int>(RadiusKind::kDetect));
static_assert(SC_SIDE_NONE == static_cast<int>(Side::kNone) && SC_SIDE_LEFT == static_cast<int>(Side::kLeft) &&
              SC_SIDE_RIGHT == static_cast<int>(Side::kRight));
static_assert(SC_REFIT_PAPER == static_cast<int>(RefitRule::kPaper) &&
              SC_REFIT_CALIBRATED == static_cast<int>(RefitRule::kCalibrated) &&
              SC_REFIT_MOMENTS == static_cast<int>(RefitRule::kMoments));
static_assert(offsetof(RestSphere, radius) == offsetof(sc_rest_sphere, radius) &&
              offsetof(RestSphere, detect_radius) == offsetof(sc_rest_sphere, detect_radius) &&
              offsetof(RestSphere, pivot_spread) == offsetof(sc_rest_sphere, pivot_spread) &&
              offsetof(RestSphere, first_pivot) == offsetof(sc_rest_sphere, first_pivot) &&
              offsetof(RestSphere, first_triangle) == offsetof(sc_rest_sphere, first_triangle) &&
              offsetof(RestSphere, triangle_count) == offsetof(sc_rest_sphere, triangle_count) &&
              offsetof(RestSphere, pivot_count) == offsetof(sc_rest_sphere, pivot_count) &&
              offsetof(RestSphere, region) == offsetof(sc_rest_sphere, region) &&
              offsetof(RestSphere, side) == offsetof(sc_rest_sphere, side) &&
              offsetof(RestSphere, level) == offsetof(sc_rest_sphere, level));
static_assert(offsetof(Leaf, first_triangle) == offsetof(sc_leaf, first_triangle) &&
              offsetof(Leaf, morph_count) == offsetof(sc_leaf, morph_count) &&
              offsetof(Leaf, triangle_count) == offsetof(sc_leaf, triangle_count) &&
              offsetof(Leaf, bone_count) == offsetof(sc_leaf, bone_count));
static_assert(offsetof(Pivot, weight) == offsetof(sc_pivot, weight) &&
              offsetof(NearPair, reach) == offsetof(sc_near_pair, reach) &&
              offsetof(SourcePart, first_vertex) == offsetof(sc_source_part, first_vertex) &&
              offsetof(SourcePart, hash) == offsetof(sc_source_part, hash));

constexpr std::size_t kHandleAlignment = 8;
static_assert(alignof(sc_asset) <= kHandleAlignment);

template <typename C, typename Cpp>
const C* give(const sc_asset* asset, Span<const Cpp> (*of)(const Asset&), std::size_t* count) {
  static_assert(std::is_same_v<C, Cpp> || kSameStruct<Cpp, C>);
  const Span<const Cpp> span = asset == nullptr ? Span<const Cpp>{} : of(asset->view);
  if (count != nullptr) {
    *count = span.size;
  }
  return span.size == 0 ? nullptr : reinterpret_cast<const C*>(span.data);
}

sc_vec3 to_c(const Vec3& v) { return {v.x, v.y, v.z}; }
sc_fit_error to_c(const FitError& e) { return {e.mean_abs_f, e.max_abs_f}; }

template <typename Out>
sc_status check_index(const sc_asset* asset, std::size_t (*count)(const Asset&), std::size_t index, const Out* out) {
  if (asset == nullptr || out == nullptr) {
    return SC_NULL_ARGUMENT;
  }
  if (!asset->view.is_open()) {
    return SC_NOT_OPEN;
  }
  return index < count(asset->view) ? SC_OK : SC_BAD_ARGUMENT;
}

}  // namespace

extern "C" {

const char* sc_status_string(sc_status status) { return to_string(static_cast<Status>(status)); }

uint32_t sc_abi_version(void) { return abi_version(); }

size_t sc_asset_size(void) { return sizeof(sc_asset); }

sc_status sc_asset_open(uint32_t abi, void* memory, size_t memory_size, const void* data, size_t size,
                        const sc_asset** asset, char* message, size_t message_size) {
  Message sentence(message, message_size);
  if (asset != nullptr) {
    *asset = nullptr;
  }
  if (abi != abi_version()) {
    sentence.wrong("compiled with spherechain's headers of ABI version %lu, linked with its library of %lu",
                   static_cast<unsigned long>(abi), static_cast<unsigned long>(abi_version()));
    return SC_WRONG_ABI;
  }
  if (asset == nullptr || memory == nullptr) {
    sentence.wrong("%s: null", asset == nullptr ? "asset" : "memory");
    return SC_NULL_ARGUMENT;
  }
  if (reinterpret_cast<std::uintptr_t>(memory) % kHandleAlignment != 0) {
    sentence.wrong("memory: not aligned to %zu bytes", kHandleAlignment);
    return SC_MISALIGNED;
  }
  if (memory_size < sizeof(sc_asset)) {
    sentence.wrong("memory: %zu bytes, but a handle takes %zu", memory_size, sizeof(sc_asset));
    return SC_CONTEXT_TOO_SMALL;
  }
  auto* handle = new (memory) sc_asset;
  const Status status = handle->view.open(data, size, message, message_size);
  if (status == Status::kOk) {
    *asset = handle;
  }
  return to_c(status);
}

sc_status sc_asset_get_info(const sc_asset* asset, sc_asset_info* info) {
  if (asset == nullptr || info == nullptr) {
    return SC_NULL_ARGUMENT;
  }
  if (info->struct_size != sizeof(sc_asset_info)) {
    return SC_WRONG_ABI;
  }
  if (!asset->view.is_open()) {
    return SC_NOT_OPEN;
  }
  const Asset& view = asset->view;
  const AssetInfo from = view.info();
  sc_asset_info to{};
  to.struct_size = sizeof(sc_asset_info);
  to.sphere_count = view.spheres().size;
  to.region_count = view.region_count();
  to.chain_count = view.chain_count();
  to.joint_count = view.joint_count();
  to.bone_count = view.bone_count();
  to.morph_count = view.morph_count();
  to.leaf_count = view.leaf_count();
  to.ignored_pair_count = view.ignored_count();
  to.writer = from.writer;
  to.settings = from.settings;
  to.settings_sha256 = from.settings_sha256;
  to.source_file = from.source_file;
  to.source_sha256 = from.source_sha256;
  to.source_rest_hash = from.source_rest_hash;
  to.format_version = from.format_version;
  to.source_vertex_count = from.source_vertex_count;
  to.source_triangle_count = from.source_triangle_count;
  to.chain_entries_table1 = from.chain_entries_table1;
  to.metres_per_unit = from.metres_per_unit;
  to.height = from.height;
  to.origin = to_c(from.origin);
  to.left = to_c(from.left);
  to.up = to_c(from.up);
  to.forward = to_c(from.forward);
  to.phi1 = to_c(from.phi1);
  to.phi1_adjusted = to_c(from.phi1_adjusted);
  to.phi2 = to_c(from.phi2);
  to.refit = static_cast<sc_refit_rule>(from.refit);
  *info = to;
  return SC_OK;
}

const sc_rest_sphere* sc_asset_spheres(const sc_asset* asset, size_t* count) {
  return give<sc_rest_sphere, RestSphere>(
      asset, [](const Asset& view) { return view.spheres(); }, count);
}

const sc_pivot* sc_asset_pivots(const sc_asset* asset, size_t* count) {
  return give<sc_pivot, Pivot>(
      asset, [](const Asset& view) { return view.pivots(); }, count);
}

const uint32_t* sc_asset_triangles(const sc_asset* asset, size_t* count) {
  return give<uint32_t, uint32_t>(
      asset, [](const Asset& view) { return view.triangles(); }, count);
}

const uint64_t* sc_asset_ignored(const sc_asset* asset, size_t* count) {
  return give<uint64_t, uint64_t>(
      asset, [](const Asset& view) { return view.ignored(); }, count);
}

const sc_near_pair* sc_asset_near_pairs(const sc_asset* asset, sc_radius radius, size_t* count) {
  const bool is_known = radius == SC_RADIUS_FIT || radius == SC_RADIUS_DETECT;
  return give<sc_near_pair, NearPair>(
      is_known ? asset : nullptr,
      radius == SC_RADIUS_FIT ? [](const Asset& view) { return view.near_pairs(RadiusKind::kFit); }
                              : [](const Asset& view) { return view.near_pairs(RadiusKind::kDetect); },
      count);
}

const sc_source_part* sc_asset_source_parts(const sc_asset* asset, size_t* count) {
  return give<sc_source_part, SourcePart>(
      asset, [](const Asset& view) { return view.source_parts(); }, count);
}

const uint32_t* sc_asset_pivot_vertices(const sc_asset* asset, size_t* count) {
  return give<uint32_t, uint32_t>(
      asset, [](const Asset& view) { return view.pivot_vertices(); }, count);
}

const sc_pivot* sc_asset_packed_pivots(const sc_asset* asset, size_t* count) {
  return give<sc_pivot, Pivot>(
      asset, [](const Asset& view) { return view.packed_pivots(); }, count);
}

const sc_leaf* sc_asset_leaves(const sc_asset* asset, size_t* count) {
  return give<sc_leaf, Leaf>(
      asset, [](const Asset& view) { return view.surface().leaves; }, count);
}

sc_status sc_asset_region(const sc_asset* asset, size_t index, sc_region* region) {
  const sc_status status = check_index(
      asset, [](const Asset& view) { return view.region_count(); }, index, region);
  if (status == SC_OK) {
    const RegionView from = asset->view.region(index);
    *region = {from.name, from.triangle_count};
  }
  return status;
}

sc_status sc_asset_chain(const sc_asset* asset, size_t index, sc_chain* chain) {
  const sc_status status = check_index(
      asset, [](const Asset& view) { return view.chain_count(); }, index, chain);
  if (status == SC_OK) {
    const ChainView from = asset->view.chain(index);
    *chain = {from.name, from.regions.data, from.regions.size, from.spheres.data, from.spheres.size};
  }
  return status;
}

sc_status sc_asset_joint(const sc_asset* asset, size_t index, sc_joint* joint) {
  const sc_status status = check_index(
      asset, [](const Asset& view) { return view.joint_count(); }, index, joint);
  if (status == SC_OK) {
    const JointView from = asset->view.joint(index);
    *joint = {from.name, from.parent, to_c(from.position), to_c(from.tail)};
  }
  return status;
}

sc_status sc_asset_bone(const sc_asset* asset, size_t index, sc_bone* bone) {
  const sc_status status = check_index(
      asset, [](const Asset& view) { return view.bone_count(); }, index, bone);
  if (status == SC_OK) {
    const BoneView from = asset->view.bone(index);
    *bone = {from.name, from.inverse_bind, from.is_rest ? 1 : 0};
  }
  return status;
}

const char* sc_asset_morph_name(const sc_asset* asset, size_t index) {
  const bool is_open = asset != nullptr && asset->view.is_open();
  return is_open && index < asset->view.morph_count() ? asset->view.morph_name(index) : nullptr;
}

sc_status sc_check_source(const sc_asset* asset, const float* positions, size_t count, size_t stride) {
  return asset == nullptr ? SC_NULL_ARGUMENT : to_c(check_source(asset->view, positions, count, stride));
}

sc_status sc_check_source_part(const sc_asset* asset, size_t part, const float* positions, size_t count,
                               size_t stride) {
  return asset == nullptr ? SC_NULL_ARGUMENT : to_c(check_source_part(asset->view, part, positions, count, stride));
}

uint64_t sc_hash_positions(const float* positions, size_t count, size_t stride) {
  const bool is_readable = positions != nullptr && !any_misaligned(positions) && is_valid_stride(stride);
  return is_readable ? hash_positions(positions, count, stride) : 0;
}

size_t sc_supported_targets(sc_target* targets, size_t capacity) {
  const Span<const Target> supported = supported_targets();
  for (std::size_t i = 0; targets != nullptr && i < supported.size && i < capacity; ++i) {
    targets[i] = static_cast<sc_target>(supported[i]);
  }
  return supported.size;
}

const char* sc_target_name(sc_target target) { return to_string(to_enum<Target>(target)); }

sc_status sc_find_target(const char* name, sc_target* target) {
  if (target == nullptr) {
    return SC_NULL_ARGUMENT;
  }
  Target found{};
  const Status status = find_target(name, found);
  if (status == Status::kOk) {
    *target = static_cast<sc_target>(found);
  }
  return to_c(status);
}

size_t sc_target_lanes(sc_target target) { return lanes_of(to_enum<Target>(target)); }

}  // extern "C"
