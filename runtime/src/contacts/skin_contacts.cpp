// SPDX-License-Identifier: MIT
#include "runtime/src/contacts/contact_jobs.h"

#include "runtime/src/base/memory.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/contacts/collector.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

// Sorted, each once, of two spheres each.
Status check_candidates(const SkinContactJob& job, std::size_t sphere_count) {
  const Status status = check_list(job.candidates, job.candidate_count, SC_FIELD_CANDIDATES);
  if (status != SC_OK) {
    return status;
  }
  for (std::size_t i = 0; i < job.candidate_count; ++i) {
    const Pair& pair = job.candidates[i];
    if (pair.a > pair.b || pair.b >= sphere_count || (i > 0 && !(job.candidates[i - 1] < pair))) {
      return refuse(SC_BAD_VALUE, SC_FIELD_CANDIDATES);
    }
  }
  if (job.candidates == nullptr) {
    return done();
  }
  return job.scope != SC_SCOPE_APART ? refuse(SC_BAD_VALUE, SC_FIELD_SCOPE)
         : job.filter != nullptr     ? refuse(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS)
                                     : done();
}

bool is_aliased(const SkinContactJob& job, const AssetView& asset) {
  return any_shared(
      {range_of(Span<sc_part_contact>{job.parts, job.part_capacity}),
       range_of(Span<Pair>{job.spheres, job.sphere_capacity}),
       range_of(Span<TriangleContact>{job.triangles, job.triangle_capacity}),
       range_of(Span<std::uint64_t>{job.scratch, skin_scratch_words(asset)})},
      {range_of_vertices(asset, job.pose), range_of_bones(asset, job.pose), range_of_morph_weights(asset, job.pose),
       range_of(Span<const std::uint64_t>{job.skin_table, skin_table_words(asset)}), range_of(asset.ignored()),
       range_of(Span<const Pair>{job.candidates, job.candidate_count}), range_of(job.filter)});
}

Status check(const SkinContactJob& job, Target& resolved, Surface& surface) {
  const Status skin = check_skin(job.asset, job.pose, job.skin_table, surface);
  if (skin != SC_OK) {
    return skin;
  }
  const AssetView& asset = view_of(*job.asset);
  const Status statuses[] = {job.filter == nullptr ? done() : check_filter(asset, *job.filter),
                             check_list(job.scratch, 1, SC_FIELD_SCRATCH),
                             check_list(job.parts, job.part_capacity, SC_FIELD_PARTS),
                             check_list(job.spheres, job.sphere_capacity, SC_FIELD_SPHERES),
                             check_list(job.triangles, job.triangle_capacity, SC_FIELD_TRIANGLES),
                             check_candidates(job, asset.spheres().size)};
  for (const Status& status : statuses) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.scratch_words < skin_scratch_words(asset)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  if (!is_known(job.scope)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_SCOPE);
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  return is_aliased(job, asset) ? refuse(SC_ALIASED, SC_FIELD_OUTPUT) : done();
}

}  // namespace
std::size_t skin_scratch_words(const AssetView& asset) {
  if (!has_skin(asset)) {
    return 0;
  }
  WordMemory memory(nullptr);
  PosedClusters posed;
  lay_out(asset, memory, posed);
  PartTable().take(memory, asset.part_count(), asset.part_count(), true);
  return memory.used();
}

std::size_t skin_scratch_words(const Asset* asset) noexcept {
  return asset == nullptr ? 0 : skin_scratch_words(view_of(*asset));
}

Status SkinContactJob::run() noexcept {
  Target resolved{};
  Surface surface;
  const Status status = check(*this, resolved, surface);
  if (status != SC_OK) {
    return status;
  }
  const AssetView& view = view_of(*asset);
  WordMemory memory(scratch);
  PosedClusters posed = posed_clusters_of(view, surface, pose, filter, memory);
  posed.apart = scope != SC_SCOPE_NEIGHBOURS;
  posed.neighbours = has_neighbours(scope) || candidates != nullptr;
  posed.layers = scope != SC_SCOPE_APART;
  posed.candidates = {candidates, candidate_count};
  posed.first_only = spheres_only != 0;
  PartTable table;
  table.take(memory, view.part_count(), view.part_count(), true);
  table.clear();
  ContactCollector collector(surface, table, ContactLists::of(*this));
  find_candidates(resolved, {posed, posed, true}, collector);
  ContactCounts counts{};
  const Status found = collector.finish(counts);
  counts.copy_to(*this);
  return found;
}

}  // namespace spherechain
