// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "baker/motion/motion.h"
#include "baker/play/asset_file.h"
#include "spherechain/body.h"

namespace spherechain::baker {

class AnimatedAsset;

// True if a penetration is of these two parts, whichever goes in.
inline bool are_of(const Penetration& found, std::uint32_t part_a, std::uint32_t part_b) {
  return std::minmax(found.part, found.other) == std::minmax(part_a, part_b);
}

// x, y, z of each of the source's vertices, which must outlive the pose.
sc_pose pose_of(const std::vector<float>& vertices);

// A deformation as the runtime takes it: by bones and morph weights, for an asset that these move.
class BonePose {
 public:
  BonePose(const OpenAsset& asset, const Deformation& deformation);
  sc_pose pose() const;

 private:
  std::vector<float> bones_, morphs_;
};

// Whole meshes as poses have no bones.
bool moved_by_bones(const OpenAsset& asset, const Deformation& deformation);

// The same if bones move the asset, else the deformed vertices. Every command does this, as games do: vertices that
// are skinned elsewhere differ in their last bits, and so may a contact that hardly is one.
class SkinPose {
 public:
  SkinPose(const AnimatedAsset& animated, const Deformation& deformation);
  sc_pose pose() const { return bones_ ? bones_->pose() : pose_of(vertices_); }

 private:
  std::optional<BonePose> bones_;
  std::vector<float> vertices_;
};

// Pairs of an asset's body parts, as sc_query.part_pairs has them.
using PartPairBits = std::vector<std::uint64_t>;
template <typename IsAsked>
PartPairBits part_pairs(const OpenAsset& asset, const IsAsked& is_asked) {  // is_asked(a, b), a <= b
  const auto parts = static_cast<std::uint32_t>(asset->part_count());
  PartPairBits out(std::size_t{parts} * parts / 64 + 1);
  for (std::uint32_t a = 0; a < parts; ++a) {
    for (std::uint32_t b = a; b < parts; ++b) {
      const std::size_t bit = std::size_t{a} * parts + b;
      if (is_asked(a, b)) out[bit / 64] |= std::uint64_t{1} << bit % 64;
    }
  }
  return out;
}

// A game's body with room for all that it finds. The asset must have clusters, and outlive it.
class SkinPlayer {
 public:
  // `other`: the largest asset that it will meet; null: none is larger than its own.
  SkinPlayer(const OpenAsset& asset, Target target, const OpenAsset* other = nullptr);

  // The pose that all questions below are about. Its memory must stay as it is until the next.
  void set_pose(const sc_pose& pose);

  // The number of pairs of body parts in contact, as a game queries it.
  std::size_t count_contacts();
  // The triangles that intersect, and those that intersect another body's. A list holds until the next question.
  Span<const TriangleContact> triangles(Scope scope = SC_SCOPE_LAYERS) { return triangles(nullptr, scope); }
  Span<const TriangleContact> triangles(const SkinPlayer& other) { return triangles(&other, SC_SCOPE_LAYERS); }

  // Penetrations of all classes in full, sorted by body parts. `is_next`: the pose follows the last one measured so,
  // and directions may follow that one's. A list holds until the next question.
  const std::vector<Penetration>& measure(bool is_next) { return find_next(nullptr, query(true), is_next); }
  const std::vector<Penetration>& measure(const SkinPlayer& other, bool is_next) {
    return find_next(&other, query(true), is_next);
  }
  // The same between parts that are no layers of one place, without history: all that a game sees by default.
  const std::vector<Penetration>& measure_as_games();
  // The same by the quick form, as games do; of some pairs of body parts alone, or of all. `is_next`: the pose follows
  // the one that measure() or this measured last.
  const std::vector<Penetration>& measure_quickly(const PartPairBits* pairs = nullptr, bool is_next = false);
  // Measures quickly what could be a fault in any clip: as if all parts had been in a fault a frame ago.
  const std::vector<Penetration>& measure_strictly(const PartPairBits& pairs);
  // Measures two body parts alone, in full, without history. Empty if they do not intersect.
  std::optional<Penetration> measure_parts(std::uint32_t part_a, std::uint32_t part_b);

 private:
  Query query(bool is_full) const;
  Span<const TriangleContact> triangles(const SkinPlayer* other, Scope scope);
  const std::vector<Penetration>& find_next(const SkinPlayer* other, Query query, bool is_next);
  const std::vector<Penetration>& find(const SkinPlayer* other, Query query);

  const OpenAsset& asset_;
  Target target_;
  BodyDef def_;
  Body body_;
  sc_pose pose_{};
  std::vector<Penetration> found_, faults_, before_,
      before_with_;  // before: of the last of these, alone and with another
};

}  // namespace spherechain::baker
