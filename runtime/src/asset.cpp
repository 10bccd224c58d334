// SPDX-License-Identifier: MIT
#include "spherechain/asset.h"

#include <cinttypes>
#include <cstring>
#include <type_traits>

#include "asset_checks.h"
#include "message.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

// The views point straight into the bytes, so the public structs must be the schema's: little-endian, field by field.
static_assert(FLATBUFFERS_LITTLEENDIAN, "the asset is little-endian and used in place");
template <typename View, typename Stored>
constexpr bool kSameLayout = std::is_standard_layout_v<View>&& std::is_trivially_copyable_v<View> &&
                             sizeof(View) == sizeof(Stored) && alignof(View) == alignof(Stored);
static_assert(kSameLayout<Vec3, schema::Vec3> && offsetof(Vec3, y) == 4 && offsetof(Vec3, z) == 8);
static_assert(kSameLayout<Pivot, schema::Pivot> && offsetof(Pivot, b) == 4 && offsetof(Pivot, c) == 8 &&
              offsetof(Pivot, weight) == 12);
static_assert(kSameLayout<SourcePart, schema::SourcePart> && offsetof(SourcePart, primitive) == 4 &&
              offsetof(SourcePart, first_vertex) == 8 && offsetof(SourcePart, vertex_count) == 12 &&
              offsetof(SourcePart, hash) == 16);
static_assert(kSameLayout<NearPair, schema::NearPair> && offsetof(NearPair, b) == 4 && offsetof(NearPair, reach) == 8);
static_assert(kSameLayout<RestSphere, schema::Sphere> && offsetof(RestSphere, radius) == 12 &&
              offsetof(RestSphere, detect_radius) == 16 && offsetof(RestSphere, pivot_spread) == 20 &&
              offsetof(RestSphere, first_pivot) == 24 && offsetof(RestSphere, first_triangle) == 28 &&
              offsetof(RestSphere, triangle_count) == 32 && offsetof(RestSphere, pivot_count) == 36 &&
              offsetof(RestSphere, region) == 38 && offsetof(RestSphere, side) == 39 &&
              offsetof(RestSphere, level) == 40 && offsetof(RestSphere, reserved) == 42);

static_assert(kSameLayout<PivotLanes, schema::Lanes> && kSameLayout<BoneTerm, schema::BoneTerm> &&
              offsetof(BoneTerm, y) == 32 && offsetof(BoneTerm, z) == 64 && offsetof(BoneTerm, w) == 96);
static_assert(kSameLayout<MorphTerm, schema::MorphTerm> && offsetof(MorphTerm, y) == 32 &&
              offsetof(MorphTerm, z) == 64);

static_assert(kSameLayout<BonePair, schema::BonePair> && offsetof(BonePair, b) == 2);
static_assert(kSameLayout<Moment, schema::Moment>);
static_assert(kSameLayout<CenterTerm, schema::CenterTerm> && offsetof(CenterTerm, y) == 4 &&
              offsetof(CenterTerm, z) == 8 && offsetof(CenterTerm, w) == 12);
static_assert(kSameLayout<MomentBatch, schema::MomentBatch> && offsetof(MomentBatch, sphere_count) == 4);

static_assert(kSameLayout<BallLanes, schema::BallLanes> && offsetof(BallLanes, y) == 32 &&
              offsetof(BallLanes, z) == 64 && offsetof(BallLanes, radius) == 96);
static_assert(kSameLayout<CoverTerm, schema::CoverTerm> && offsetof(CoverTerm, deviations) == 32);
static_assert(kSameLayout<Leaf, schema::Leaf> && offsetof(Leaf, first_triangle) == 4 &&
              offsetof(Leaf, first_vertex) == 8 && offsetof(Leaf, first_bone) == 12 &&
              offsetof(Leaf, first_slot) == 16 && offsetof(Leaf, first_weight) == 20 &&
              offsetof(Leaf, first_morph) == 24 && offsetof(Leaf, morph_count) == 28 &&
              offsetof(Leaf, triangle_count) == 32 && offsetof(Leaf, vertex_count) == 34 &&
              offsetof(Leaf, bone_count) == 36 && offsetof(Leaf, reserved) == 38);
static_assert(kSameLayout<SlotMorph, schema::SlotMorph> && offsetof(SlotMorph, slot) == 4 &&
              offsetof(SlotMorph, delta) == 8);
static_assert(kSameLayout<TrianglePair, schema::TrianglePair> && offsetof(TrianglePair, b) == 4);

constexpr std::size_t kHeaderSize = 8;  // the root's offset and the identifier
constexpr std::size_t kMinSize = kHeaderSize + sizeof(schema::Sphere) + sizeof(schema::Pivot);
constexpr std::size_t kMaxSize = FLATBUFFERS_MAX_BUFFER_SIZE - 1;
constexpr flatbuffers::uoffset_t kMaxDepth = 8;        // the schema's tables nest two deep
constexpr flatbuffers::uoffset_t kMaxTables = 100000;  // regions, chains, joints: some dozens in a human

const schema::Asset& root_of(const void* root) { return *static_cast<const schema::Asset*>(root); }

template <typename View, typename Vector>
Span<const View> view(const Vector& vector) {
  return {reinterpret_cast<const View*>(vector.Data()), vector.size()};
}

Vec3 to_vec3(const schema::Vec3* v) { return {v->x(), v->y(), v->z()}; }
FitError to_error(const schema::FitError* e) { return {e->mean_abs_f(), e->max_abs_f()}; }

BoneTables tables_of(const schema::BoneRefit& refit) {
  BoneTables tables;
  tables.weights = view<PivotLanes>(*refit.weights());
  tables.term_counts = view<std::uint32_t>(*refit.term_counts());
  tables.term_bones = view<std::uint32_t>(*refit.term_bones());
  tables.terms = view<BoneTerm>(*refit.terms());
  tables.morph_term_counts = view<std::uint32_t>(*refit.morph_term_counts());
  tables.morph_targets = view<std::uint32_t>(*refit.morph_targets());
  tables.morph_terms = view<MorphTerm>(*refit.morph_terms());
  return tables;
}

bool is_upper(const Moment& moment) {
  const float* m = moment.values;
  return m[4] == 0 && m[8] == 0 && m[9] == 0 && m[12] == 0 && m[13] == 0 && m[14] == 0;
}

bool own_are_upper(const MomentTables& tables) {
  const Moment* own = tables.moments.data;
  bool out = true;
  for (const std::uint8_t bones : tables.bone_counts) {
    for (std::size_t left = bones; out && left > 0; own += left, --left) {
      out = is_upper(*own);
    }
  }
  return out;
}

MomentTables moments_of(const schema::Moments& stored) {
  MomentTables tables;
  tables.origin = to_vec3(stored.origin());
  tables.reference = stored.reference();
  tables.batches = view<MomentBatch>(*stored.batches());
  tables.pairs = view<BonePair>(*stored.pairs());
  tables.spheres = view<std::uint32_t>(*stored.spheres());
  tables.bone_counts = view<std::uint8_t>(*stored.bone_counts());
  tables.bones = view<std::uint16_t>(*stored.bones());
  tables.centers = view<CenterTerm>(*stored.centers());
  tables.pair_places = view<std::uint8_t>(*stored.pair_places());
  tables.moments = view<Moment>(*stored.moments());
  tables.own_are_upper = own_are_upper(tables);
  return tables;
}

Surface surface_of(const schema::Surface& stored) {
  Surface surface;
  surface.leaves = view<Leaf>(*stored.leaves());
  surface.leaf_balls = view<BallLanes>(*stored.leaf_balls());
  surface.leaf_vertices = view<std::uint32_t>(*stored.leaf_vertices());
  surface.leaf_bones = view<std::uint32_t>(*stored.leaf_bones());
  surface.corners = view<std::uint8_t>(*stored.corners());
  surface.source_vertices = view<std::uint32_t>(*stored.source_vertices());
  surface.welds = view<std::uint32_t>(*stored.welds());
  surface.slot_positions = view<float>(*stored.slot_positions());
  surface.slot_weights = view<float>(*stored.slot_weights());
  surface.slot_morphs = view<SlotMorph>(*stored.slot_morphs());
  surface.cover_term_counts = view<std::uint32_t>(*stored.cover_term_counts());
  surface.cover_term_bones = view<std::uint32_t>(*stored.cover_term_bones());
  surface.cover_terms = view<CoverTerm>(*stored.cover_terms());
  surface.cover_morph_counts = view<std::uint32_t>(*stored.cover_morph_counts());
  surface.cover_morph_targets = view<std::uint32_t>(*stored.cover_morph_targets());
  surface.cover_morphs = view<BallLanes>(*stored.cover_morphs());
  if (stored.rest_contacts() != nullptr) {
    surface.rest_contacts = view<TrianglePair>(*stored.rest_contacts());
  }
  if (stored.leaf_boxes() != nullptr) {
    surface.leaf_boxes = view<BoxLanes>(*stored.leaf_boxes());
  }
  if (stored.outlines() != nullptr) {  // then all four are there
    surface.outlines = view<Outline>(*stored.outlines());
    surface.outline_bones = view<OutlineBone>(*stored.outline_bones());
    surface.outline_points = view<float>(*stored.outline_points());
    surface.outline_weights = view<float>(*stored.outline_weights());
  }
  return surface;
}

Status verify(const void* data, std::size_t size, Message& message) {
  if (data == nullptr) {
    message.wrong("data: null");
    return Status::kNullArgument;
  }
  if (reinterpret_cast<std::uintptr_t>(data) % kAssetAlignment != 0) {
    message.wrong("data: not aligned to %zu bytes", kAssetAlignment);
    return Status::kMisaligned;
  }
  if (size >= kHeaderSize && !schema::AssetBufferHasIdentifier(data)) {
    message.wrong("file identifier: not \"%s\"", schema::AssetIdentifier());
    return Status::kWrongIdentifier;
  }
  if (size < kMinSize) {
    message.wrong("size: %zu bytes, but any asset has at least %zu", size, kMinSize);
    return Status::kTruncated;
  }
  if (size > kMaxSize) {
    message.wrong("size: %zu bytes, past the limit of %zu", size, kMaxSize);
    return Status::kCorrupt;
  }
  flatbuffers::Verifier verifier(static_cast<const std::uint8_t*>(data), size, kMaxDepth, kMaxTables);
  if (!schema::VerifyAssetBuffer(verifier)) {
    message.wrong("structure: an offset or an array of the %zu bytes leads outside them (cut short or overwritten?)",
                  size);
    return Status::kCorrupt;
  }
  const schema::Asset& root = *schema::GetAsset(data);
  if (root.format_version() == 0 || root.format_version() > kFormatVersion) {
    message.wrong("format_version: %" PRIu32 ", but this runtime reads 1 to %" PRIu32, root.format_version(),
                  kFormatVersion);
    return Status::kUnsupportedVersion;
  }
  return values_are_valid(root, size, message) ? Status::kOk : Status::kCorrupt;
}

}  // namespace

std::uint32_t abi_version() noexcept { return SC_ABI_VERSION; }

Status Asset::open_with_abi(std::uint32_t abi_version, void* asset, const void* data, std::size_t size, char* message,
                            std::size_t message_size) noexcept {
  Message sentence(message, message_size);
  if (abi_version != SC_ABI_VERSION) {
    sentence.wrong("compiled with spherechain's headers of ABI version %" PRIu32 ", linked with its library of %d",
                   abi_version, SC_ABI_VERSION);
    return Status::kWrongAbi;
  }
  return static_cast<Asset*>(asset)->open_verified(data, size, sentence);
}

Status Asset::open_verified(const void* data, std::size_t size, Message& message) noexcept {
  *this = Asset();
  const Status status = verify(data, size, message);
  if (status != Status::kOk) {
    return status;
  }
  const schema::Asset& root = *schema::GetAsset(data);
  root_ = &root;
  spheres_ = view<RestSphere>(*root.spheres());
  pivots_ = view<Pivot>(*root.pivots());
  triangles_ = view<std::uint32_t>(*root.triangles());
  ignored_ = view<std::uint64_t>(*root.ignored());
  ignored_count_ = count_ignored(root);
  near_fit_ = view<NearPair>(*root.near_fit());
  near_detect_ = view<NearPair>(*root.near_detect());
  if (const auto* parts = root.source()->parts()) {
    source_parts_ = view<SourcePart>(*parts);
  }
  if (root.pivot_vertices() != nullptr) {
    pivot_vertices_ = view<std::uint32_t>(*root.pivot_vertices());
    packed_pivots_ = view<Pivot>(*root.packed_pivots());
  }
  refit_rule_ = static_cast<RefitRule>(root.refit());
  if (root.bone_refit() != nullptr) {
    bone_count_ = root.bone_refit()->bones()->size();
    morph_count_ = root.bone_refit()->morphs()->size();
    bone_tables_ = tables_of(*root.bone_refit());
    if (root.bone_refit()->moments() != nullptr) {
      moment_tables_ = moments_of(*root.bone_refit()->moments());
    }
  }
  if (root.surface() != nullptr) {
    surface_ = surface_of(*root.surface());
  }
  return Status::kOk;
}

AssetInfo Asset::info() const noexcept {
  const schema::Asset& root = root_of(root_);
  const schema::Provenance& provenance = *root.provenance();
  const schema::Source& source = *root.source();
  const schema::Frame& frame = *root.frame();
  AssetInfo info{};
  info.format_version = root.format_version();
  info.writer = provenance.writer()->c_str();
  info.settings = provenance.settings()->c_str();
  info.settings_sha256 = provenance.settings_sha256()->c_str();
  info.source_file = source.file()->c_str();
  info.source_sha256 = source.sha256()->c_str();
  info.source_vertex_count = source.vertex_count();
  info.source_triangle_count = source.triangle_count();
  info.source_rest_hash = source.rest_hash();
  info.metres_per_unit = source.metres_per_unit();
  info.origin = to_vec3(frame.origin());
  info.left = to_vec3(frame.left());
  info.up = to_vec3(frame.up());
  info.forward = to_vec3(frame.forward());
  info.height = frame.height();
  info.phi1 = to_error(root.fit()->phi1());
  info.phi1_adjusted = to_error(root.fit()->phi1_adjusted());
  info.phi2 = to_error(root.fit()->phi2());
  info.refit = refit_rule();
  info.chain_entries_table1 = root.chain_entries_table1();
  return info;
}

std::size_t Asset::region_count() const noexcept { return root_of(root_).regions()->size(); }

RegionView Asset::region(std::size_t i) const noexcept {
  const schema::Region& region = *root_of(root_).regions()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return {region.name()->c_str(), region.triangle_count()};
}

std::size_t Asset::chain_count() const noexcept { return root_of(root_).chains()->size(); }

ChainView Asset::chain(std::size_t i) const noexcept {
  const schema::Chain& chain = *root_of(root_).chains()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return {chain.name()->c_str(), view<std::uint8_t>(*chain.regions()), view<std::uint32_t>(*chain.spheres())};
}

std::size_t Asset::joint_count() const noexcept {
  const auto* joints = root_of(root_).joints();
  return joints == nullptr ? 0 : joints->size();
}

JointView Asset::joint(std::size_t i) const noexcept {
  const schema::Joint& joint = *root_of(root_).joints()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return {joint.name()->c_str(), joint.parent(), to_vec3(joint.position()), to_vec3(joint.tail())};
}

BoneView Asset::bone(std::size_t i) const noexcept {
  const schema::Bone& bone = *root_of(root_).bone_refit()->bones()->Get(static_cast<flatbuffers::uoffset_t>(i));
  return {bone.name()->c_str(), bone.inverse_bind()->elements()->data(), bone.is_rest()};
}

const char* Asset::morph_name(std::size_t i) const noexcept {
  return root_of(root_).bone_refit()->morphs()->Get(static_cast<flatbuffers::uoffset_t>(i))->c_str();
}

}  // namespace spherechain
