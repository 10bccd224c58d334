// SPDX-License-Identifier: MIT
// The views of an asset's bytes, and what an open asset tells.
#include <type_traits>

#include "runtime/src/asset/asset_view.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

template <typename Vector>
auto at(const Vector& vector, std::size_t i) {
  return vector.Get(static_cast<flatbuffers::uoffset_t>(i));
}

// The views point straight into the bytes, so their structs must be the schema's: little-endian, field by field.
static_assert(FLATBUFFERS_LITTLEENDIAN, "the asset is little-endian and used in place");
static_assert(offsetof(Pivot, weight) == 12 && offsetof(sc_source_buffer, hash) == 16 &&
              offsetof(RestPair, rest_scale) == 8 && offsetof(CenterTerm, w) == 12);
static_assert(offsetof(RestSphere, pivot_spread) == 20 && offsetof(RestSphere, triangle_count) == 28 &&
              offsetof(RestSphere, pivot_count) == 32 && offsetof(RestSphere, region) == 34 &&
              offsetof(RestSphere, side) == 35 && offsetof(RestSphere, level) == 36 &&
              offsetof(RestSphere, part) == 38);
static_assert(offsetof(BoxLanes, radius) == 192 && offsetof(PackedCluster, bone_count) == 2 &&
              offsetof(PackedCluster, is_buried) == 4 && offsetof(PackedHull, center) == 4 &&
              offsetof(PackedHull, slack) == 20);

// Empty where the asset lacks the array.
template <typename View, typename Entry>
Span<const View> entries_of(const flatbuffers::Vector<Entry>* entries) {
  using Stored = std::remove_pointer_t<Entry>;
  static_assert(std::is_standard_layout_v<View> && std::is_trivially_copyable_v<View>);
  static_assert(sizeof(View) == sizeof(Stored) && alignof(View) == alignof(Stored));
  return entries == nullptr ? Span<const View>{}
                            : Span<const View>{reinterpret_cast<const View*>(entries->Data()), entries->size()};
}

// 0 where the asset lacks it.
Vec3 to_vec3(const schema::Vec3* v) { return v == nullptr ? Vec3{} : Vec3{v->x(), v->y(), v->z()}; }
FitError to_error(const schema::FitError* e) { return {e->mean_abs_f(), e->max_abs_f()}; }

MomentTables moments_of(const schema::Moments& stored) {
  MomentTables tables;
  tables.origin = to_vec3(stored.origin());
  tables.reference = stored.reference();
  tables.batches = entries_of<MomentBatch>(stored.batches());
  tables.pairs = entries_of<BonePair>(stored.pairs());
  tables.spheres = entries_of<std::uint32_t>(stored.spheres());
  tables.bone_counts = entries_of<std::uint8_t>(stored.bone_counts());
  tables.bones = entries_of<std::uint16_t>(stored.bones());
  tables.centers = entries_of<CenterTerm>(stored.centers());
  tables.pair_places = entries_of<std::uint8_t>(stored.pair_places());
  tables.moments = entries_of<Moment>(stored.moments());
  return tables;
}

SkinData skin_of(const schema::Skin& stored) {
  SkinData skin;
  skin.sizes.vertices = stored.vertex_count();
  skin.triangles = entries_of<std::uint8_t>(stored.triangles());
  skin.cluster_vertices = entries_of<std::uint8_t>(stored.cluster_vertices());
  skin.cluster_bones = entries_of<std::uint8_t>(stored.cluster_bones());
  skin.sources = entries_of<std::uint8_t>(stored.sources());
  skin.welds = entries_of<std::uint8_t>(stored.welds());
  skin.influence_bones = entries_of<std::uint8_t>(stored.influence_bones());
  skin.morph_counts = entries_of<std::uint16_t>(stored.morph_counts());
  skin.rest_contacts = entries_of<std::uint8_t>(stored.rest_contacts());
  skin.layer_pairs = entries_of<std::uint8_t>(stored.layer_pairs());
  skin.layer_runs = entries_of<std::uint8_t>(stored.layer_runs());
  skin.layer_run_ends = entries_of<std::uint8_t>(stored.layer_run_ends());
  skin.windings = entries_of<std::int8_t>(stored.windings());
  skin.core_triangles = entries_of<std::uint8_t>(stored.core_triangles());
  skin.core_windings = entries_of<std::int8_t>(stored.core_windings());
  skin.covers = entries_of<std::uint8_t>(stored.covers());
  skin.cover_distances = entries_of<float>(stored.cover_distances());
  skin.hull_points = entries_of<std::uint8_t>(stored.hull_points());
  skin.part_runs = entries_of<std::uint8_t>(stored.part_runs());
  skin.part_run_ends = entries_of<std::uint8_t>(stored.part_run_ends());
  skin.corners = entries_of<std::uint8_t>(stored.corners());
  skin.influence_counts = entries_of<std::uint8_t>(stored.influence_counts());
  skin.clusters = entries_of<PackedCluster>(stored.clusters());
  skin.positions = entries_of<float>(stored.positions());
  skin.influence_weights = entries_of<float>(stored.influence_weights());
  skin.morphs = entries_of<MorphDelta>(stored.morphs());
  skin.boxes = entries_of<BoxLanes>(stored.boxes());
  skin.bounds_term_counts = entries_of<std::uint32_t>(stored.bounds_term_counts());
  skin.bounds_term_bones = entries_of<std::uint32_t>(stored.bounds_term_bones());
  skin.bounds_morph_counts = entries_of<std::uint32_t>(stored.bounds_morph_counts());
  skin.bounds_morph_targets = entries_of<std::uint32_t>(stored.bounds_morph_targets());
  skin.bounds_terms = entries_of<BoundsTerm>(stored.bounds_terms());
  skin.bounds_morphs = entries_of<BallLanes>(stored.bounds_morphs());
  skin.hulls = entries_of<PackedHull>(stored.hulls());
  skin.hull_bones = entries_of<HullBone>(stored.hull_bones());
  return skin;
}

}  // namespace

void AssetView::view(const schema::Asset& root) noexcept {
  root_ = &root;
  spheres_ = entries_of<RestSphere>(root.spheres());
  pivots_ = entries_of<Pivot>(root.pivots());
  ignored_ = entries_of<std::uint64_t>(root.ignored());
  vertex_count_ = root.source()->vertex_count();
  part_count_ = root.parts()->size();
  bone_count_ = root.bones()->size();
  morph_count_ = root.morphs()->size();
  refit_rule_ = static_cast<RefitRule>(root.refit());
  rest_fit_ = entries_of<RestPair>(root.rest_pairs_fit());
  rest_detect_ = entries_of<RestPair>(root.rest_pairs_detect());
  source_buffers_ = entries_of<sc_source_buffer>(root.source()->buffers());
  if (root.moments() != nullptr) {
    moment_tables_ = moments_of(*root.moments());
  }
  skin_ = skin_of(*root.skin());
}

AssetInfo AssetView::info() const noexcept {
  const schema::Provenance& provenance = *root_->provenance();
  const schema::Source& source = *root_->source();
  const schema::Frame& frame = *root_->frame();
  AssetInfo info{};
  info.sphere_count = spheres_.size;
  info.bone_count = bone_count_;
  info.part_count = part_count_;
  info.morph_count = morph_count_;
  info.region_count = region_count();
  info.source_buffer_count = source_buffers_.size;
  info.vertex_count = vertex_count_;
  info.triangle_count = source.triangle_count();
  info.ignored_pair_count = ignored_count_;
  info.writer = provenance.writer()->c_str();
  info.settings = provenance.settings()->c_str();
  info.settings_sha256 = provenance.settings_sha256()->c_str();
  info.source_file = source.file()->c_str();
  info.source_sha256 = source.sha256()->c_str();
  info.source_rest_hash = source.rest_hash();
  info.origin = to_vec3(frame.origin());
  info.left = to_vec3(frame.left());
  info.up = to_vec3(frame.up());
  info.forward = to_vec3(frame.forward());
  info.height = frame.height();
  info.metres_per_unit = source.metres_per_unit();
  info.ignored_pairs = ignored().data;
  return info;
}

FitErrors AssetView::fit() const noexcept {
  const schema::Fit& fit = *root_->fit();
  return {to_error(fit.phi1()), to_error(fit.phi1_adjusted()), to_error(fit.phi2())};
}

std::size_t AssetView::region_count() const noexcept { return root_->regions()->size(); }

RegionView AssetView::region(std::size_t i) const noexcept {
  const schema::Region& region = *at(*root_->regions(), i);
  return {region.name()->c_str(), region.triangle_count()};
}

BodyPart AssetView::part(std::size_t i) const noexcept {
  const schema::Part& part = *at(*root_->parts(), i);
  return {part.name()->c_str(), static_cast<std::int32_t>(part.side()), part.bone(), part.parent(), part.mobility()};
}

std::size_t AssetView::chain_count() const noexcept { return root_->chains()->size(); }

ChainView AssetView::chain(std::size_t i) const noexcept {
  const schema::Chain& chain = *at(*root_->chains(), i);
  return {chain.name()->c_str(), entries_of<std::uint8_t>(chain.regions()), entries_of<std::uint32_t>(chain.spheres())};
}

std::size_t AssetView::joint_count() const noexcept {
  const auto* joints = root_->joints();
  return joints == nullptr ? 0 : joints->size();
}

JointView AssetView::joint(std::size_t i) const noexcept {
  const schema::Joint& joint = *at(*root_->joints(), i);
  return {joint.name()->c_str(), joint.parent(), to_vec3(joint.position()), to_vec3(joint.tail())};
}

BoneView AssetView::bone(std::size_t i) const noexcept {
  const schema::Bone& bone = *at(*root_->bones(), i);
  return {bone.name()->c_str(), bone.inverse_bind()->elements()->data(), bone.is_rest()};
}

const char* AssetView::morph_name(std::size_t i) const noexcept { return at(*root_->morphs(), i)->c_str(); }

std::size_t AssetView::piece_count() const noexcept { return root_->skin()->pieces()->size(); }

PieceView AssetView::piece(std::size_t i) const noexcept {
  const schema::Piece& piece = *at(*root_->skin()->pieces(), i);
  return {piece.name()->c_str(), piece.border()};
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_asset_info sc_asset_get_info(const sc_asset* asset) noexcept { return view_of(*asset).info(); }

sc_rest_sphere sc_asset_sphere(const sc_asset* asset, size_t index) noexcept {
  const Span<const RestSphere> spheres = view_of(*asset).spheres();
  if (index >= spheres.size) {
    return {};
  }
  const RestSphere& s = spheres[index];
  return {s.center, s.radius, s.detect_radius, s.side, s.region, s.level, s.part};
}

sc_bone sc_asset_bone(const sc_asset* asset, size_t index) noexcept {
  if (index >= view_of(*asset).bone_count()) {
    return {};
  }
  const BoneView bone = view_of(*asset).bone(index);
  return {bone.is_rest ? "" : bone.name, bone.inverse_bind};
}

sc_part sc_asset_part(const sc_asset* asset, size_t index) noexcept {
  return index < view_of(*asset).part_count() ? view_of(*asset).part(index) : sc_part{};
}

const char* sc_asset_morph_name(const sc_asset* asset, size_t index) noexcept {
  return index < view_of(*asset).morph_count() ? view_of(*asset).morph_name(index) : nullptr;
}

const char* sc_asset_region_name(const sc_asset* asset, size_t index) noexcept {
  return index < view_of(*asset).region_count() ? view_of(*asset).region(index).name : nullptr;
}

sc_source_buffer sc_asset_source_buffer(const sc_asset* asset, size_t index) noexcept {
  const Span<const sc_source_buffer> buffers = view_of(*asset).source_buffers();
  return index < buffers.size ? buffers[index] : sc_source_buffer{};
}

}  // extern "C"
