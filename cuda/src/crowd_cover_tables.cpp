// SPDX-License-Identifier: MIT
#include "crowd_access.h"
#include "crowd_table_parts.h"

namespace spherechain::cuda {
namespace {

// Leaves of a group share its bones and morph targets; a lane looks at one leaf at a time, so each gets its own
// entries.
struct LeafCounts {
  std::size_t terms = 0, morphs = 0;
};

template <typename Visit>
LeafCounts for_each_leaf(const Surface& surface, const Visit& visit) {
  const bool has_morphs = surface.cover_morph_counts.size > 0;
  LeafCounts all, group{};
  for (std::size_t l = 0; l < surface.leaves.size; ++l) {
    const std::size_t g = l / kLeafLanes;
    if (l > 0 && l % kLeafLanes == 0) {
      group.terms += surface.cover_term_counts[g - 1];
      group.morphs += has_morphs ? surface.cover_morph_counts[g - 1] : 0;
    }
    visit(l, group, all);
    all.terms += surface.cover_term_counts[g];
    all.morphs += has_morphs ? surface.cover_morph_counts[g] : 0;
  }
  return all;
}

bool has_covers(const Asset& asset) { return asset.leaf_count() > 0 && asset.bone_count() > 0; }

Float4 ball_of(const BallLanes& balls, std::size_t lane) {
  return {balls.x[lane], balls.y[lane], balls.z[lane], balls.radius[lane]};
}

void fill_leaves(const Surface& surface, LeafEntry* leaves, LeafTerm* terms, LeafMorph* morphs,
                 const std::uint32_t* bone_indices) {
  const bool has_morphs = surface.cover_morph_counts.size > 0;
  for_each_leaf(surface, [&](std::size_t l, const LeafCounts& group, const LeafCounts& before) {
    const std::size_t g = l / kLeafLanes, lane = l % kLeafLanes;
    LeafEntry& leaf = leaves[l];
    leaf.ball = ball_of(surface.leaf_balls[g], lane);
    leaf.first_term = static_cast<std::uint32_t>(before.terms);
    leaf.term_count = surface.cover_term_counts[g];
    leaf.first_morph = static_cast<std::uint32_t>(before.morphs);
    leaf.morph_count = has_morphs ? surface.cover_morph_counts[g] : 0;
    for (std::size_t t = 0; t < leaf.term_count; ++t) {
      const CoverTerm& term = surface.cover_terms[group.terms + t];
      terms[before.terms + t] = {term.weights[lane], term.deviations[lane],
                                 bone_indices[surface.cover_term_bones[group.terms + t]], 0};
    }
    for (std::size_t i = 0; i < leaf.morph_count; ++i) {
      morphs[before.morphs + i] = {
          ball_of(surface.cover_morphs[group.morphs + i], lane), surface.cover_morph_targets[group.morphs + i], {}};
    }
  });
}

void fill_covers(const Asset& asset, CoverEntry* out) {
  for (std::uint32_t s = 0; s < asset.spheres().size; ++s) {
    out[s].rest = asset.spheres()[s].center;
    out[s].sphere = s;
  }
  const Span<const Leaf> leaves = asset.surface().leaves;
  for (std::uint32_t l = 0; l < leaves.size; ++l) {
    CoverEntry& entry = out[leaves[l].sphere];
    entry.first_leaf = entry.leaf_count++ == 0 ? l : entry.first_leaf;
  }
}

}  // namespace

std::size_t CrowdTables::cover_words_needed(const Asset& asset) noexcept {
  if (!asset.is_open() || !has_covers(asset)) {
    return 0;
  }
  const std::size_t n = asset.spheres().size, bones = asset.bone_count();
  const LeafCounts counts = for_each_leaf(asset.surface(), [](auto...) {});
  return words_of(n * sizeof(CoverEntry)) + words_of(n * sizeof(float)) +
         words_of(asset.leaf_count() * sizeof(LeafEntry)) + words_of(counts.terms * sizeof(LeafTerm)) +
         words_of(counts.morphs * sizeof(LeafMorph)) + 2 * words_of(bones * sizeof(std::uint32_t)) +
         words_of(most_items(n) * sizeof(PairItem));
}

Status CrowdTables::build_covers(const Asset& asset, const Filter* filter, Span<std::uint64_t> memory) noexcept {
  const Status status = check_build(asset, filter, memory, cover_words_needed(asset));
  if (status != Status::kOk) {
    return status;
  }
  if (!has_covers(asset)) {
    return Status::kNotInAsset;
  }
  const Surface& surface = asset.surface();
  const auto n = static_cast<std::uint32_t>(asset.spheres().size);
  const LeafCounts counts = for_each_leaf(surface, [](auto...) {});
  CrowdTables out;
  TableMemory entries(memory);
  auto* covers = entries.take<CoverEntry>(n, out.covers_at_);
  fill_paddings(filter, entries.take<float>(n, out.paddings_at_));
  auto* leaves = entries.take<LeafEntry>(surface.leaves.size, out.leaves_at_);
  auto* terms = entries.take<LeafTerm>(counts.terms, out.leaf_terms_at_);
  auto* morphs = entries.take<LeafMorph>(counts.morphs, out.leaf_morphs_at_);
  auto* used_bones = entries.take<std::uint32_t>(asset.bone_count(), out.used_bones_at_);
  std::uint32_t unread = 0;
  auto* bone_indices = entries.take<std::uint32_t>(asset.bone_count(), unread);
  out.used_bone_count_ =
      fill_bones(surface.cover_term_bones, asset.bone_count(), used_bones,
                 [&](std::size_t t, std::uint32_t i) { bone_indices[surface.cover_term_bones[t]] = i; });
  fill_leaves(surface, leaves, terms, morphs, bone_indices);
  fill_covers(asset, covers);
  const WantedPairs wanted(asset, filter);
  out.item_count_ = fill_items(n, entries.take<PairItem>(most_items(n), out.items_at_), [&](auto a, auto b) {
    return covers[a].leaf_count > 0 && covers[b].leaf_count > 0 && wanted(a, b);
  });
  std::sort(covers, covers + n, [](const CoverEntry& l, const CoverEntry& r) {
    return l.leaf_count != r.leaf_count ? l.leaf_count > r.leaf_count : l.sphere < r.sphere;
  });
  out.words_ = entries.used();
  out.sphere_count_ = n;
  out.leaf_count_ = static_cast<std::uint32_t>(surface.leaves.size);
  out.bone_count_ = static_cast<std::uint32_t>(asset.bone_count());
  out.morph_count_ = static_cast<std::uint32_t>(asset.morph_count());
  out.bit_words_ = static_cast<std::uint32_t>(DetectJob::bit_words(asset));
  out.has_morphs_ = counts.morphs > 0;
  out.has_padding_ = filter != nullptr && filter->padding.size > 0;
  *this = out;
  return Status::kOk;
}

}  // namespace spherechain::cuda
