// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/skin_player.h"

#include <algorithm>

#include "baker/play/play.h"

namespace spherechain::baker {

BonePose::BonePose(const OpenAsset& asset, const Deformation& deformation)
    : bones_(bone_palette(asset, deformation)), morphs_(deformation.morphs.begin(), deformation.morphs.end()) {
  morphs_.resize(asset->morph_count());
}

sc_pose BonePose::pose() const {
  sc_pose pose;
  pose.bones = bones_.data();
  pose.bone_count = bones_.size() / 12;
  pose.bone_layout = SC_ROWS_3X4;
  pose.morph_weights = morphs_.empty() ? nullptr : morphs_.data();
  pose.morph_weight_count = morphs_.size();
  return pose;
}

bool moved_by_bones(const OpenAsset& asset, const Deformation& deformation) {
  return asset->bone_count() > 0 && deformation.positions.empty();
}

sc_pose pose_of(const std::vector<float>& vertices) {
  sc_pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  return pose;
}

SkinPose::SkinPose(const AnimatedAsset& animated, const Deformation& deformation) {
  if (moved_by_bones(animated.asset(), deformation)) {
    bones_.emplace(animated.asset(), deformation);
  } else {
    vertices_ = pack(animated.positions(deformation));
  }
}

SkinPlayer::SkinPlayer(const OpenAsset& asset, Target target, const OpenAsset* other) : asset_(asset), target_(target) {
  const std::size_t parts = asset->part_count(), others = other == nullptr ? parts : (*other)->part_count();
  def_.max_penetrations = parts * std::max(parts + 1, others);  // all that there can be
  def_.largest_other = other == nullptr ? nullptr : other->model().handle();
  body_ = Body(asset.model(), def_);
  check_runtime(body_.status());
}

void SkinPlayer::set_pose(const sc_pose& pose) {
  pose_ = pose;
  check_runtime(body_.set_pose(pose));
}

Query SkinPlayer::query(bool is_full) const {
  Query out;
  out.full = is_full ? 1 : 0;
  out.target = target_;
  out.scope = SC_SCOPE_LAYERS;
  out.classes = ~0U;
  return out;
}

std::size_t SkinPlayer::count_contacts() {
  Query asked = query(false);
  asked.scope = SC_SCOPE_APART;
  const Contacts found = body_.contacts(asked);
  check_runtime(body_.status());
  return found.part_count;
}

Span<const TriangleContact> SkinPlayer::triangles(const SkinPlayer* other, Scope scope) {
  Query asked = query(true);
  asked.scope = scope;
  for (;;) {
    const Contacts found = other == nullptr ? body_.contacts(asked) : body_.contacts(other->body_, asked);
    check_runtime(body_.status());
    if (found.triangle_count == found.triangle_total) return {found.triangles, found.triangle_count};
    def_.max_triangles = 2 * found.triangle_total;
    body_ = Body(asset_.model(), def_);
    check_runtime(body_.status());
    set_pose(pose_);
  }
}

const std::vector<Penetration>& SkinPlayer::find(const SkinPlayer* other, Query query) {
  const Penetrations found = other == nullptr ? body_.penetrations(query) : body_.penetrations(other->body_, query);
  check_runtime(body_.status());
  found_.assign(found.begin(), found.end());
  std::sort(found_.begin(), found_.end(), [](const Penetration& l, const Penetration& r) {
    return std::pair(std::minmax(l.part, l.other), l.part) < std::pair(std::minmax(r.part, r.other), r.part);
  });
  return found_;
}

const std::vector<Penetration>& SkinPlayer::find_next(const SkinPlayer* other, Query query, bool is_next) {
  std::vector<Penetration>& before = other == nullptr ? before_ : before_with_;
  query.previous = is_next ? before.data() : nullptr;
  query.previous_count = is_next ? before.size() : 0;
  find(other, query);
  before = found_;
  return found_;
}

const std::vector<Penetration>& SkinPlayer::measure_quickly(const PartPairBits* pairs, bool is_next) {
  Query asked = query(false);
  asked.part_pairs = pairs == nullptr ? nullptr : pairs->data();
  return find_next(nullptr, asked, is_next);
}

const std::vector<Penetration>& SkinPlayer::measure_strictly(const PartPairBits& pairs) {
  if (faults_.empty()) {
    for (std::uint32_t a = 0; a < asset_->part_count(); ++a) {
      for (std::uint32_t b = 0; b <= a; ++b) {
        faults_.emplace_back();  // without a direction to keep
        faults_.back().part = a;
        faults_.back().other = b;
        faults_.back().kind = SC_CLASS_PENETRATION;
      }
    }
  }
  Query asked = query(false);
  asked.part_pairs = pairs.data();
  asked.previous = faults_.data();
  asked.previous_count = faults_.size();
  return find(nullptr, asked);
}

const std::vector<Penetration>& SkinPlayer::measure_as_games() {
  Query asked = query(true);
  asked.scope = SC_SCOPE_APART;
  return find(nullptr, asked);
}

std::optional<Penetration> SkinPlayer::measure_parts(std::uint32_t part_a, std::uint32_t part_b) {
  Query asked = query(true);
  const PartPairBits pairs = part_pairs(
      asset_, [&](std::uint32_t a, std::uint32_t b) { return std::minmax(a, b) == std::minmax(part_a, part_b); });
  asked.part_pairs = pairs.data();
  const std::vector<Penetration>& found = find(nullptr, asked);
  return found.empty() ? std::nullopt : std::optional(found[0]);
}

}  // namespace spherechain::baker
