// SPDX-License-Identifier: MIT
// What an open asset tells.
#include <cstring>

#include "asset/asset_view.h"
#include "sphere_chains_generated.h"

namespace spherechain {
namespace {

const schema::Asset& root_of(const void* root) { return *static_cast<const schema::Asset*>(root); }

template <typename Vector>
auto at(const Vector& vector, std::size_t i) {
  return vector.Get(static_cast<flatbuffers::uoffset_t>(i));
}

template <typename View, typename Vector>
Span<const View> view(const Vector& vector) {
  return {reinterpret_cast<const View*>(vector.Data()), vector.size()};
}

Vec3 to_vec3(const schema::Vec3* v) { return {v->x(), v->y(), v->z()}; }
FitError to_error(const schema::FitError* e) { return {e->mean_abs_f(), e->max_abs_f()}; }

}  // namespace

AssetInfo AssetView::info() const noexcept {
  const schema::Asset& root = root_of(root_);
  const schema::Provenance& provenance = *root.provenance();
  const schema::Source& source = *root.source();
  const schema::Frame& frame = *root.frame();
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
  return info;
}

FitErrors AssetView::fit() const noexcept {
  const schema::Asset& root = root_of(root_);
  return {to_error(root.fit()->phi1()), to_error(root.fit()->phi1_adjusted()), to_error(root.fit()->phi2()),
          root.chain_entries_table1()};
}

std::size_t AssetView::region_count() const noexcept { return root_of(root_).regions()->size(); }

RegionView AssetView::region(std::size_t i) const noexcept {
  const schema::Region& region = *at(*root_of(root_).regions(), i);
  return {region.name()->c_str(), region.triangle_count()};
}

BodyPart AssetView::part(std::size_t i) const noexcept {
  const schema::Part& part = *at(*root_of(root_).parts(), i);
  return {part.name()->c_str(), static_cast<Side>(part.side()), part.bone()};
}

std::size_t AssetView::chain_count() const noexcept { return root_of(root_).chains()->size(); }

ChainView AssetView::chain(std::size_t i) const noexcept {
  const schema::Chain& chain = *at(*root_of(root_).chains(), i);
  return {chain.name()->c_str(), view<std::uint8_t>(*chain.regions()), view<std::uint32_t>(*chain.spheres())};
}

std::size_t AssetView::joint_count() const noexcept {
  const auto* joints = root_of(root_).joints();
  return joints == nullptr ? 0 : joints->size();
}

JointView AssetView::joint(std::size_t i) const noexcept {
  const schema::Joint& joint = *at(*root_of(root_).joints(), i);
  return {joint.name()->c_str(), joint.parent(), to_vec3(joint.position()), to_vec3(joint.tail())};
}

BoneView AssetView::bone(std::size_t i) const noexcept {
  const schema::Bone& bone = *at(*root_of(root_).bones(), i);
  return {bone.name()->c_str(), bone.inverse_bind()->elements()->data(), bone.is_rest()};
}

const char* AssetView::morph_name(std::size_t i) const noexcept { return at(*root_of(root_).morphs(), i)->c_str(); }

}  // namespace spherechain

using namespace spherechain;

extern "C" {

int sc_asset_is_open(const sc_asset* asset) noexcept { return asset != nullptr && view_of(*asset).is_open() ? 1 : 0; }

sc_asset_info sc_asset_get_info(const sc_asset* asset) noexcept { return view_of(*asset).info(); }

sc_rest_sphere sc_asset_sphere(const sc_asset* asset, size_t index) noexcept {
  const Span<const RestSphere> spheres = view_of(*asset).spheres();
  if (index >= spheres.size) {
    return {};
  }
  const RestSphere& s = spheres[index];
  return {s.center, s.radius, s.detect_radius, static_cast<sc_side>(s.side), s.region, s.level};
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
