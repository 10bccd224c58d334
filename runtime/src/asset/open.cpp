// SPDX-License-Identifier: MIT
// Verifies an asset's bytes and takes the views of them.
#include <cinttypes>
#include <cstring>
#include <new>
#include <type_traits>

#include "asset/asset_checks.h"
#include "asset/asset_view.h"
#include "asset/message.h"
#include "asset/status.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

// The views point straight into the bytes, so their structs must be the schema's: little-endian, field by field.
static_assert(FLATBUFFERS_LITTLEENDIAN, "the asset is little-endian and used in place");
template <typename View, typename Stored>
constexpr bool kSameLayout = std::is_standard_layout_v<View>&& std::is_trivially_copyable_v<View> &&
                             sizeof(View) == sizeof(Stored) && alignof(View) == alignof(Stored);
static_assert(kSameLayout<Vec3, schema::Vec3> && kSameLayout<Pivot, schema::Pivot> && offsetof(Pivot, weight) == 12);
static_assert(kSameLayout<sc_source_buffer, schema::SourceBuffer> && offsetof(sc_source_buffer, hash) == 16);
static_assert(kSameLayout<RestPair, schema::RestPair> && offsetof(RestPair, rest_scale) == 8);
static_assert(kSameLayout<RestSphere, schema::Sphere> && offsetof(RestSphere, pivot_spread) == 20 &&
              offsetof(RestSphere, triangle_count) == 28 && offsetof(RestSphere, pivot_count) == 32 &&
              offsetof(RestSphere, region) == 34 && offsetof(RestSphere, side) == 35 &&
              offsetof(RestSphere, level) == 36);
static_assert(kSameLayout<BonePair, schema::BonePair> && kSameLayout<Moment, schema::Moment> &&
              kSameLayout<CenterTerm, schema::CenterTerm> && offsetof(CenterTerm, w) == 12 &&
              kSameLayout<MomentBatch, schema::MomentBatch>);
static_assert(kSameLayout<BallLanes, schema::BallLanes> && kSameLayout<BoxLanes, schema::BoxLanes> &&
              offsetof(BoxLanes, radius) == 192 && kSameLayout<BoundsTerm, schema::BoundsTerm>);
static_assert(kSameLayout<PackedCluster, schema::Cluster> && offsetof(PackedCluster, bone_count) == 2);
static_assert(kSameLayout<PackedHull, schema::Hull> && offsetof(PackedHull, center) == 4 &&
              offsetof(PackedHull, slack) == 20);
static_assert(kSameLayout<HullBone, schema::HullBone> && kSameLayout<MorphDelta, schema::MorphDelta>);

constexpr std::size_t kHeaderSize = 8;  // the root's offset and the identifier
constexpr std::size_t kMinSize = kHeaderSize + sizeof(schema::Sphere) + sizeof(schema::Pivot);
constexpr std::size_t kMaxSize = FLATBUFFERS_MAX_BUFFER_SIZE - 1;
constexpr flatbuffers::uoffset_t kMaxDepth = 8;        // the schema's tables nest two deep
constexpr flatbuffers::uoffset_t kMaxTables = 100000;  // regions, chains, bones: some dozens in a human

template <typename View, typename Vector>
Span<const View> view(const Vector& vector) {
  return {reinterpret_cast<const View*>(vector.Data()), vector.size()};
}

Vec3 to_vec3(const schema::Vec3* v) { return {v->x(), v->y(), v->z()}; }

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
  return tables;
}

SkinData skin_of(const schema::Skin& stored, const SkinSizes& sizes) {
  SkinData skin;
  skin.sizes = sizes;
  skin.triangles = view<std::uint8_t>(*stored.triangles());
  skin.cluster_vertices = view<std::uint8_t>(*stored.cluster_vertices());
  skin.cluster_bones = view<std::uint8_t>(*stored.cluster_bones());
  skin.sources = view<std::uint8_t>(*stored.sources());
  skin.welds = view<std::uint8_t>(*stored.welds());
  skin.influence_bones = view<std::uint8_t>(*stored.influence_bones());
  skin.morph_counts = view<std::uint16_t>(*stored.morph_counts());
  skin.rest_contacts = view<std::uint8_t>(*stored.rest_contacts());
  skin.hull_points = view<std::uint8_t>(*stored.hull_points());
  skin.part_runs = view<std::uint8_t>(*stored.part_runs());
  skin.part_run_ends = view<std::uint8_t>(*stored.part_run_ends());
  skin.corners = view<std::uint8_t>(*stored.corners());
  skin.influence_counts = view<std::uint8_t>(*stored.influence_counts());
  skin.clusters = view<PackedCluster>(*stored.clusters());
  skin.positions = view<float>(*stored.positions());
  skin.influence_weights = view<float>(*stored.influence_weights());
  skin.morphs = view<MorphDelta>(*stored.morphs());
  skin.boxes = view<BoxLanes>(*stored.boxes());
  skin.bounds_term_counts = view<std::uint32_t>(*stored.bounds_term_counts());
  skin.bounds_term_bones = view<std::uint32_t>(*stored.bounds_term_bones());
  skin.bounds_morph_counts = view<std::uint32_t>(*stored.bounds_morph_counts());
  skin.bounds_morph_targets = view<std::uint32_t>(*stored.bounds_morph_targets());
  skin.bounds_terms = view<BoundsTerm>(*stored.bounds_terms());
  skin.bounds_morphs = view<BallLanes>(*stored.bounds_morphs());
  skin.hulls = view<PackedHull>(*stored.hulls());
  skin.hull_bones = view<HullBone>(*stored.hull_bones());
  return skin;
}

// A number at any address: unverified offsets need not be aligned.
template <typename T>
T read(const std::uint8_t* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

// The version of bytes that have passed no verifier yet, read step by step within them. It is the root's first field.
bool read_version(const void* data, std::size_t size, std::uint32_t& version) {
  const auto* const bytes = static_cast<const std::uint8_t*>(data);
  const std::uint64_t root = read<flatbuffers::uoffset_t>(bytes);
  if (root + sizeof(flatbuffers::soffset_t) > size) {
    return false;
  }
  const std::int64_t table = static_cast<std::int64_t>(root) - read<flatbuffers::soffset_t>(bytes + root);
  constexpr std::int64_t kField = schema::Asset::VT_FORMAT_VERSION;
  if (table < 0 || static_cast<std::uint64_t>(table + kField) + sizeof(flatbuffers::voffset_t) > size) {
    return false;
  }
  const std::uint64_t at = root + read<flatbuffers::voffset_t>(bytes + table + kField);
  if (at == root || at + sizeof version > size) {
    return false;
  }
  version = read<std::uint32_t>(bytes + at);
  return true;
}

Status verify(const void* data, std::size_t size, SkinSizes& sizes, Message& message) {
  const auto refuse_data = [](sc_code code) { return refuse(code, SC_FIELD_DATA); };
  if (data == nullptr) {
    message.wrong("data: null");
    return refuse_data(SC_NULL);
  }
  if (reinterpret_cast<std::uintptr_t>(data) % SC_ASSET_ALIGNMENT != 0) {
    message.wrong("data: not aligned to %d bytes", SC_ASSET_ALIGNMENT);
    return refuse_data(SC_MISALIGNED);
  }
  if (size < kHeaderSize || !schema::AssetBufferHasIdentifier(data)) {
    message.wrong("file identifier: not \"%s\", so this is no sphere chain asset", schema::AssetIdentifier());
    return refuse_data(SC_NOT_AN_ASSET);
  }
  if (size < kMinSize) {
    message.wrong("size: %zu bytes, but any asset has at least %zu", size, kMinSize);
    return refuse_data(SC_CORRUPT);
  }
  if (size > kMaxSize) {
    message.wrong("size: %zu bytes, past the limit of %zu", size, kMaxSize);
    return refuse_data(SC_CORRUPT);
  }
  // The version first: another format's tables need not pass this one's verifier.
  flatbuffers::Verifier verifier(static_cast<const std::uint8_t*>(data), size, kMaxDepth, kMaxTables);
  std::uint32_t version = 0;
  if (read_version(data, size, version) && version != kFormatVersion) {
    message.wrong("format_version: %" PRIu32 ", but this runtime reads %" PRIu32 " only: bake it again", version,
                  kFormatVersion);
    return refuse_data(SC_OTHER_VERSION);
  }
  if (!schema::VerifyAssetBuffer(verifier)) {
    message.wrong("structure: an offset or an array of the %zu bytes leads outside them (cut short or overwritten?)",
                  size);
    return refuse_data(SC_CORRUPT);
  }
  return values_are_valid(*schema::GetAsset(data), size, sizes, message) ? done() : refuse_data(SC_CORRUPT);
}

}  // namespace

Status AssetView::open(const void* data, std::size_t size, Message& message) noexcept {
  *this = AssetView();
  SkinSizes sizes;
  const Status status = verify(data, size, sizes, message);
  if (status != SC_OK) {
    return status;
  }
  const schema::Asset& root = *schema::GetAsset(data);
  root_ = &root;
  spheres_ = view<RestSphere>(*root.spheres());
  pivots_ = view<Pivot>(*root.pivots());
  ignored_ = view<std::uint64_t>(*root.ignored());
  ignored_count_ = count_ignored(root);
  vertex_count_ = root.source()->vertex_count();
  part_count_ = root.parts()->size();
  bone_count_ = root.bones()->size();
  morph_count_ = root.morphs()->size();
  refit_rule_ = static_cast<RefitRule>(root.refit());
  rest_fit_ = view<RestPair>(*root.rest_pairs_fit());
  rest_detect_ = view<RestPair>(*root.rest_pairs_detect());
  if (const auto* buffers = root.source()->buffers()) {
    source_buffers_ = view<sc_source_buffer>(*buffers);
  }
  if (root.moments() != nullptr) {
    moment_tables_ = moments_of(*root.moments());
  }
  skin_ = skin_of(*root.skin(), sizes);
  return done();
}

}  // namespace spherechain

extern "C" {

uint32_t sc_abi_version(void) noexcept { return SC_ABI_VERSION; }

sc_status sc_asset_open(sc_asset* asset, uint32_t abi, const void* data, size_t size, char* message,
                        size_t message_size) noexcept {
  using namespace spherechain;
  Message sentence(message, message_size);
  if (abi != SC_ABI_VERSION) {
    sentence.wrong("compiled with spherechain's headers of ABI version %" PRIu32 ", linked with its library of %d", abi,
                   SC_ABI_VERSION);
    return refuse(SC_WRONG_ABI, SC_FIELD_NONE);
  }
  if (asset == nullptr) {
    sentence.wrong("asset: null");
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  return (new (asset) AssetView)->open(data, size, sentence);
}

}  // extern "C"
