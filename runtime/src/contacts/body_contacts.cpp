// SPDX-License-Identifier: MIT
#include "runtime/src/base/memory.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/contacts/collector.h"
#include "runtime/src/contacts/contact_jobs.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

bool is_aliased(const BodyContactJob& job) {
  const BodyRanges a(job.a), b(job.b);
  return any_shared({range_of(Span<PartContact>{job.parts, job.part_capacity}),
                     range_of(Span<Pair>{job.spheres, job.sphere_capacity}),
                     range_of(Span<TriangleContact>{job.triangles, job.triangle_capacity}),
                     range_of(Span<std::uint64_t>{job.scratch, body_scratch_words(job.a.asset, job.b.asset)})},
                    {a.vertices, a.bones, a.morph_weights, a.skin_table, a.ignored_parts, b.vertices, b.bones,
                     b.morph_weights, b.skin_table, b.ignored_parts});
}

Status check(const BodyContactJob& job, Target& resolved, Surface& surface_a, Surface& surface_b) {
  const Status statuses[] = {check_skin(job.a.asset, job.a.pose, job.a.skin_table, surface_a),
                             check_skin(job.b.asset, job.b.pose, job.b.skin_table, surface_b),
                             check_list(job.a.ignored_parts, 0, SC_FIELD_IGNORED_PARTS),
                             check_list(job.b.ignored_parts, 0, SC_FIELD_IGNORED_PARTS),
                             check_list(job.scratch, 1, SC_FIELD_SCRATCH),
                             check_list(job.parts, job.part_capacity, SC_FIELD_PARTS),
                             check_list(job.spheres, job.sphere_capacity, SC_FIELD_SPHERES),
                             check_list(job.triangles, job.triangle_capacity, SC_FIELD_TRIANGLES)};
  for (const Status& status : statuses) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.scratch_words < body_scratch_words(job.a.asset, job.b.asset)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  return is_aliased(job) ? refuse(SC_ALIASED, SC_FIELD_OUTPUT) : done();
}

}  // namespace
std::size_t body_scratch_words(const AssetView& a, const AssetView& b) {
  if (!has_skin(a) || !has_skin(b)) {
    return 0;
  }
  WordMemory memory(nullptr);
  PosedClusters posed;
  lay_out(a, memory, posed);
  lay_out(b, memory, posed);
  bound_bones_of_two(a, posed, b, posed, {}, {}, memory);
  PartTable().take(memory, a.part_count(), b.part_count(), false);
  return memory.used();
}

std::size_t body_scratch_words(const Asset* a, const Asset* b) noexcept {
  return a == nullptr || b == nullptr ? 0 : body_scratch_words(view_of(*a), view_of(*b));
}

Status BodyContactJob::run() noexcept {
  Target resolved{};
  Surface surface_a, surface_b;
  const Status status = check(*this, resolved, surface_a, surface_b);
  if (status != SC_OK) {
    return status;
  }
  WordMemory memory(scratch);
  const AssetView &asset_a = view_of(*a.asset), &asset_b = view_of(*b.asset);
  PosedClusters posed_a = posed_clusters_of(asset_a, surface_a, a.pose, nullptr, memory);
  PosedClusters posed_b = posed_clusters_of(asset_b, surface_b, b.pose, nullptr, memory);
  posed_a.first_only = spheres_only != 0;
  bound_bones_of_two(asset_a, posed_a, asset_b, posed_b, a.pose, b.pose, memory);
  PartTable table;
  table.take(memory, asset_a.part_count(), asset_b.part_count(), false);
  table.clear();
  ContactCollector collector({&surface_a, a.ignored_parts}, {&surface_b, b.ignored_parts}, table,
                             ContactLists::of(*this));
  find_candidates(resolved, {posed_a, posed_b, false}, collector);
  ContactCounts counts{};
  const Status found = collector.finish(counts);
  counts.copy_to(*this);
  return found;
}

Status bound_body(const JobBody& body, Vec3& low, Vec3& high) noexcept {
  Surface surface;
  const Status status = check_skin(body.asset, body.pose, body.skin_table, surface);
  if (status == SC_OK) {
    const Bounds3 bounds = body.pose.bones != nullptr ? bound_bones(view_of(*body.asset), surface, body.pose, nullptr)
                                                      : bound_vertices(surface, body.pose);
    low = {bounds.low[0], bounds.low[1], bounds.low[2]};
    high = {bounds.high[0], bounds.high[1], bounds.high[2]};
  }
  return status;
}

}  // namespace spherechain
