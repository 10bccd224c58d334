// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>

#include "crowd_access.h"
#include "crowd_table_parts.h"

namespace spherechain::cuda {
namespace {

void fill_groups(const BoneTables& tables, GroupEntry* out) {
  std::uint32_t term = 0, morph_term = 0;
  for (std::size_t g = 0; g < tables.term_counts.size; ++g) {
    static_assert(sizeof out[g].weights == sizeof tables.weights[g].values, "copied as they are");
    std::memcpy(out[g].weights, tables.weights[g].values, sizeof out[g].weights);
    out[g].first_term = term;
    out[g].term_count = tables.term_counts[g];
    out[g].first_morph_term = morph_term;
    for (std::uint32_t i = 0; i < tables.term_counts[g]; ++i, ++term) {
      morph_term += tables.morph_term_counts.size > 0 ? tables.morph_term_counts[term] : 0;
    }
  }
}

void fill_terms(const BoneTables& tables, HalfTerm* out) {
  for (const BoneTerm& term : tables.terms) {
    for (std::size_t first = 0; first < kPivotLanes; first += kHalf, ++out) {
      std::memcpy(&out->x, term.x + first, sizeof out->x);
      std::memcpy(&out->y, term.y + first, sizeof out->y);
      std::memcpy(&out->z, term.z + first, sizeof out->z);
      std::memcpy(&out->w, term.w + first, sizeof out->w);
    }
  }
}

void fill_spheres(const Asset& asset, RadiusKind kind, const GroupEntry* groups, SphereEntry* out) {
  const bool calibrated = asset.refit_rule() == RefitRule::kCalibrated, has_groups = asset.bone_count() > 0;
  std::uint32_t group = 0;
  for (std::uint32_t i = 0; i < asset.spheres().size; ++i) {
    const RestSphere& rest = asset.spheres()[i];
    const float wanted = kind == RadiusKind::kFit ? rest.radius : rest.detect_radius;
    SphereEntry& entry = out[i];
    entry.sphere = i;
    entry.pivot_count = rest.pivot_count;
    entry.first_group = group;
    entry.group_count = static_cast<std::uint32_t>((rest.pivot_count + kPivotLanes - 1) / kPivotLanes);
    if (has_groups) {
      entry.group = groups[group];
    }
    entry.wanted = calibrated ? wanted : wanted / rest.radius;
    entry.scale = rest.pivot_spread;
    entry.scale_share = entry.scale >= kLeastScale && entry.scale <= 1 / kLeastScale ? 1 / entry.scale : 0;
    group += entry.group_count;
  }
  const auto cost = [](const SphereEntry& entry) { return entry.group_count * (2 + entry.group.term_count); };
  std::sort(out, out + asset.spheres().size, [&](const SphereEntry& l, const SphereEntry& r) {
    return cost(l) != cost(r) ? cost(l) > cost(r) : l.sphere < r.sphere;
  });
}

bool is_near(Span<const NearPair> near, std::uint32_t a, std::uint32_t b) {
  const auto before = [](const NearPair& pair, const Pair& at) { return Pair{pair.a, pair.b} < at; };
  const NearPair* found = std::lower_bound(near.begin(), near.end(), Pair{a, b}, before);
  return found != near.end() && found->a == a && found->b == b;
}

std::size_t near_places(std::size_t count) { return lanes_of(static_cast<std::uint32_t>(count)); }

std::uint32_t fill_near(const WantedPairs& wanted, Span<const NearPair> near, NearEntry* out) {
  std::uint32_t count = 0;
  for (const NearPair& pair : near) {
    if (wanted(pair.a, pair.b)) {
      out[count++] = {pair.a, pair.b, pair.reach, 0};
    }
  }
  return count;
}

}  // namespace

Status check_build(const Asset& asset, const Filter* filter, Span<std::uint64_t> memory, std::size_t words) {
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  if (memory.data == nullptr) {
    return Status::kNullArgument;
  }
  if (reinterpret_cast<std::uintptr_t>(memory.data) % alignof(SphereEntry) != 0) {
    return Status::kMisaligned;
  }
  if (filter != nullptr) {
    const Status status = check_filter(asset, *filter);
    if (status != Status::kOk) {
      return status;
    }
  }
  return memory.size < words ? Status::kContextTooSmall : Status::kOk;
}

std::size_t CrowdTables::pivot_words_needed(const Asset& asset) noexcept {
  const BoneTables& tables = asset.bone_tables();
  return words_of(asset.spheres().size * sizeof(SphereEntry)) + words_of(tables.term_counts.size * sizeof(GroupEntry)) +
         words_of(tables.terms.size * 2 * sizeof(HalfTerm)) +
         2 * words_of((tables.terms.size + 1) * sizeof(std::uint32_t)) +
         words_of(asset.bone_count() * sizeof(std::uint32_t)) +
         words_of(tables.morph_terms.size * sizeof(std::uint32_t)) +
         words_of(tables.morph_terms.size * sizeof(MorphTerm));
}

std::size_t CrowdTables::words_needed(const Asset& asset) noexcept {
  if (!asset.is_open()) {
    return 0;
  }
  const std::size_t n = asset.spheres().size;
  const std::size_t near =
      std::max(asset.near_pairs(RadiusKind::kFit).size, asset.near_pairs(RadiusKind::kDetect).size);
  return (has_moments(asset) ? moment_words_needed(asset) : pivot_words_needed(asset)) + words_of(n * sizeof(float)) +
         words_of(most_items(n) * sizeof(PairItem)) + words_of_pairs(n) +
         words_of(near_places(near) * sizeof(NearEntry));
}

void CrowdTables::add_pivots(const Asset& asset, RadiusKind radius, TableMemory& entries) noexcept {
  const BoneTables& tables = asset.bone_tables();
  auto* spheres = entries.take<SphereEntry>(asset.spheres().size, sphere_entries_at_);
  auto* groups = entries.take<GroupEntry>(tables.term_counts.size, groups_at_);
  fill_groups(tables, groups);
  fill_spheres(asset, radius, groups, spheres);
  fill_terms(tables, entries.take<HalfTerm>(2 * tables.terms.size, terms_at_));
  auto* term_matrices = entries.take<std::uint32_t>(tables.terms.size + 1, term_matrices_at_);
  auto* used_bones = entries.take<std::uint32_t>(asset.bone_count(), used_bones_at_);
  used_bone_count_ =
      fill_bones(tables.term_bones, asset.bone_count(), used_bones, [&](std::size_t t, std::uint32_t bone) {
        term_matrices[t] = static_cast<std::uint32_t>(3 * bone * kPitch * sizeof(Float4));
      });
  has_morphs_ = tables.morph_terms.size > 0;
  if (has_morphs_) {
    const auto copy = [&](const auto& from, auto* to) { std::copy(from.begin(), from.end(), to); };
    copy(tables.morph_term_counts, entries.take<std::uint32_t>(tables.terms.size, morph_counts_at_));
    copy(tables.morph_targets, entries.take<std::uint32_t>(tables.morph_targets.size, morph_targets_at_));
    copy(tables.morph_terms, entries.take<MorphTerm>(tables.morph_terms.size, morph_terms_at_));
  }
}

Status CrowdTables::build(const Asset& asset, RadiusKind radius, const Filter* filter,
                          Span<std::uint64_t> memory) noexcept {
  if (asset.is_open() && radius != RadiusKind::kFit && radius != RadiusKind::kDetect) {
    return Status::kBadArgument;
  }
  const Status status = check_build(asset, filter, memory, words_needed(asset));
  if (status != Status::kOk) {
    return status;
  }
  const auto n = static_cast<std::uint32_t>(asset.spheres().size);
  CrowdTables out;
  TableMemory entries(memory);
  if (has_moments(asset)) {
    out.add_moments(asset, radius, entries);
  } else {
    out.add_pivots(asset, radius, entries);
  }
  fill_paddings(filter, entries.take<float>(n, out.paddings_at_));
  const WantedPairs wanted(asset, filter);
  const Span<const NearPair> near = asset.near_pairs(radius);
  out.near_count_ = fill_near(wanted, near, entries.take<NearEntry>(near_places(near.size), out.near_at_));
  const auto is_tested = [&](auto a, auto b) { return wanted(a, b) && !is_near(near, a, b); };
  out.item_count_ = fill_items(n, entries.take<PairItem>(most_items(n), out.items_at_), is_tested);
  auto* unit_places = entries.take<std::uint32_t>(unit_words(n) * kWordUnits, out.unit_places_at_);
  fill_units(n, unit_places, entries.take<std::uint32_t>(unit_words(n) * kLanes, out.wanted_at_), is_tested);
  out.origin_sphere_ = middle_sphere(asset.spheres());
  out.words_ = entries.used();
  out.sphere_count_ = n;
  out.bone_count_ = static_cast<std::uint32_t>(asset.bone_count());
  out.morph_count_ = static_cast<std::uint32_t>(asset.morph_count());
  out.bit_words_ = static_cast<std::uint32_t>(DetectJob::bit_words(asset));
  out.calibrated_ = asset.refit_rule() == RefitRule::kCalibrated;
  out.has_padding_ = filter != nullptr && filter->padding.size > 0;
  *this = out;
  return Status::kOk;
}

GroupView Access::view(const CrowdTables& tables, const std::uint64_t* words) {
  GroupView v{};
  v.sphere_entries = reinterpret_cast<const SphereEntry*>(words + tables.sphere_entries_at_);
  v.paddings = reinterpret_cast<const float*>(words + tables.paddings_at_);
  v.groups = reinterpret_cast<const GroupEntry*>(words + tables.groups_at_);
  v.terms = reinterpret_cast<const HalfTerm*>(words + tables.terms_at_);
  v.term_matrices = reinterpret_cast<const std::uint32_t*>(words + tables.term_matrices_at_);
  v.used_bones = reinterpret_cast<const std::uint32_t*>(words + tables.used_bones_at_);
  if (tables.leaf_count_ > 0) {
    v.cover_entries = reinterpret_cast<const CoverEntry*>(words + tables.covers_at_);
    v.leaf_entries = reinterpret_cast<const LeafEntry*>(words + tables.leaves_at_);
    v.leaf_terms = reinterpret_cast<const LeafTerm*>(words + tables.leaf_terms_at_);
    v.leaf_morphs = reinterpret_cast<const LeafMorph*>(words + tables.leaf_morphs_at_);
    v.leaf_count = tables.leaf_count_;
  }
  if (tables.run_count_ > 0) {
    v.runs = reinterpret_cast<const MomentRun*>(words + tables.runs_at_);
    v.moment_steps = reinterpret_cast<const std::uint32_t*>(words + tables.moment_steps_at_);
    v.moments = reinterpret_cast<const Float4*>(words + tables.moments_at_);
    v.run_spheres = reinterpret_cast<const RunSphere*>(words + tables.run_spheres_at_);
    v.run_bones = reinterpret_cast<const std::uint32_t*>(words + tables.run_bones_at_);
    v.center_terms = reinterpret_cast<const Float4*>(words + tables.center_terms_at_);
    v.origin = tables.origin_;
    v.run_count = tables.run_count_;
    v.reference = tables.reference_;
  }
  v.near = reinterpret_cast<const NearEntry*>(words + tables.near_at_);
  v.items = reinterpret_cast<const PairItem*>(words + tables.items_at_);
  v.unit_places = reinterpret_cast<const std::uint32_t*>(words + tables.unit_places_at_);
  v.wanted = reinterpret_cast<const std::uint32_t*>(words + tables.wanted_at_);
  v.origin_sphere = tables.origin_sphere_;
  v.has_morphs = tables.has_morphs_;
  if (tables.has_morphs_ && tables.leaf_count_ == 0) {
    v.morph_counts = reinterpret_cast<const std::uint32_t*>(words + tables.morph_counts_at_);
    v.morph_targets = reinterpret_cast<const std::uint32_t*>(words + tables.morph_targets_at_);
    v.morph_terms = reinterpret_cast<const MorphTerm*>(words + tables.morph_terms_at_);
  }
  v.sphere_count = tables.sphere_count_;
  v.used_bone_count = tables.used_bone_count_;
  v.item_count = tables.item_count_;
  v.near_count = tables.near_count_;
  v.morph_count = tables.morph_count_;
  v.bit_words = tables.bit_words_;
  v.calibrated = tables.calibrated_;
  v.has_padding = tables.has_padding_;
  return v;
}

std::size_t CrowdTables::shared_bytes(bool from_bones, bool with_morphs, bool with_bits,
                                      bool with_pairs) const noexcept {
  alignas(16) static unsigned char something[16];  // for what is asked, of tables too, is null or not
  GroupView v = Access::view(*this, reinterpret_cast<const std::uint64_t*>(something));
  v.matrices = from_bones ? reinterpret_cast<const float*>(something) : nullptr;
  v.morph_weights = with_morphs && has_morphs_ ? v.matrices : nullptr;
  v.bits = with_bits ? reinterpret_cast<std::uint64_t*>(something) : nullptr;
  v.bounds = reinterpret_cast<Sphere*>(something);
  v.pairs = with_pairs ? reinterpret_cast<CrowdPair*>(something) : nullptr;
  return layout_of(v).size;
}

}  // namespace spherechain::cuda
