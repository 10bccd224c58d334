// SPDX-License-Identifier: MIT
#include "runtime/src/penetrations/penetration_jobs.h"

#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/penetrations/measure.h"
#include "runtime/src/penetrations/rule.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

bool is_aliased(const PenetrationJob& job, const AssetView& asset) {
  return any_shared(
      {range_of(Span<Penetration>{job.penetrations, job.penetration_capacity}),
       range_of(Span<std::uint64_t>{job.scratch, measure_words(asset, asset, true, job.contact_count)})},
      {range_of_vertices(asset, job.pose), range_of_bones(asset, job.pose), range_of_morph_weights(asset, job.pose),
       range_of(Span<const std::uint64_t>{job.skin_table, skin_table_words(asset)}), range_of(asset.ignored()),
       range_of(Span<const TriangleContact>{job.contacts, job.contact_count}),
       range_of(Span<const Penetration>{job.previous, job.previous_count}), range_of(job.filter)});
}

bool is_aliased(const BodyPenetrationJob& job) {
  const BodyRanges a(job.a), b(job.b);
  return any_shared({range_of(Span<Penetration>{job.penetrations, job.penetration_capacity}),
                     range_of(Span<std::uint64_t>{
                         job.scratch, body_penetration_scratch_words(job.a.asset, job.b.asset, job.contact_count)})},
                    {a.vertices, a.bones, a.morph_weights, a.skin_table, b.vertices, b.bones, b.morph_weights,
                     b.skin_table, range_of(Span<const TriangleContact>{job.contacts, job.contact_count}),
                     range_of(Span<const Penetration>{job.previous, job.previous_count})});
}

// Checks the fields that all jobs share. `words` becomes the scratch memory that the job needs.
template <typename Job>
Status check_rest(const Job& job, std::size_t words, Target& resolved) {
  const Status statuses[] = {check_list(job.contacts, job.contact_count, SC_FIELD_CONTACTS),
                             check_list(job.previous, job.previous_count, SC_FIELD_PREVIOUS),
                             check_list(job.scratch, 1, SC_FIELD_SCRATCH),
                             check_list(job.penetrations, job.penetration_capacity, SC_FIELD_PENETRATIONS)};
  for (const Status& status : statuses) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.scratch_words < words) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  const Status rule = check_rule(job.rule);
  if (rule != SC_OK) {
    return rule;
  }
  return resolve_target(job.target, resolved) ? done() : refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
}

template <typename Job>
Meeting meeting_of(const Job& job, const Meeting::Side& a, const Meeting::Side& b, Target resolved) {
  const Rule limits = job.rule == nullptr ? sc_default_rule() : *job.rule;
  Meeting out{a, b, false, {}, resolved, {}, {}, job.quick != 0, job.along != 0, limits, job.scratch, {}};
  out.contacts = {job.contacts, job.contact_count};
  out.previous = {job.previous, job.previous_count};
  out.out = {job.penetrations, job.penetration_capacity};
  out.classes = job.classes == 0 ? out.classes : job.classes;
  out.kept = job.kept_count;
  out.inside_a = job.inside_a;
  out.inside_b = job.inside_b;
  out.adds_enclosed = job.adds_enclosed != 0;
  out.met = {job.met, job.met_count};
  out.part_pairs = job.part_pairs;
  return out;
}

Status measure(PenetrationJob& job) {
  Surface surface;
  const Status skin = check_skin(job.asset, job.pose, job.skin_table, surface);
  if (skin != SC_OK) {
    return skin;
  }
  const AssetView& asset = view_of(*job.asset);
  const Status filter = job.filter == nullptr ? done() : check_filter(asset, *job.filter);
  if (filter != SC_OK) {
    return filter;
  }
  Target resolved{};
  const Status rest = check_rest(job, measure_words(asset, asset, true, job.contact_count), resolved);
  if (rest != SC_OK) {
    return rest;
  }
  if (!is_known(job.scope)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_SCOPE);
  }
  if (is_aliased(job, asset)) {
    return refuse(SC_ALIASED, SC_FIELD_OUTPUT);
  }
  const Meeting::Side side{&asset, &surface, job.pose};
  Meeting meeting = meeting_of(job, side, side, resolved);
  meeting.are_one = true;
  meeting.rule = {&surface, asset.ignored(), job.scope != SC_SCOPE_NEIGHBOURS, has_neighbours(job.scope),
                  job.scope != SC_SCOPE_APART};
  if (job.filter != nullptr) {
    meeting.rule.ignored = {job.filter->ignored, job.filter->ignored_words};
  }
  const Status contacts = check_contacts(meeting);
  return contacts == SC_OK ? measure(meeting, job.penetration_count) : contacts;
}

Status measure(BodyPenetrationJob& job) {
  Surface surface_a, surface_b;
  const Status skins[] = {check_skin(job.a.asset, job.a.pose, job.a.skin_table, surface_a),
                          check_skin(job.b.asset, job.b.pose, job.b.skin_table, surface_b)};
  for (const Status& status : skins) {
    if (status != SC_OK) {
      return status;
    }
  }
  const AssetView &a = view_of(*job.a.asset), &b = view_of(*job.b.asset);
  Target resolved{};
  const Status rest = check_rest(job, measure_words(a, b, false, job.contact_count), resolved);
  if (rest != SC_OK) {
    return rest;
  }
  if (is_aliased(job)) {
    return refuse(SC_ALIASED, SC_FIELD_OUTPUT);
  }
  const Meeting meeting = meeting_of(job, {&a, &surface_a, job.a.pose}, {&b, &surface_b, job.b.pose}, resolved);
  const Status contacts = check_contacts(meeting);
  return contacts == SC_OK ? measure(meeting, job.penetration_count) : contacts;
}

}  // namespace
std::size_t penetration_scratch_words(const Asset* asset, std::size_t contact_count) noexcept {
  return asset == nullptr || !has_skin(view_of(*asset))
             ? 0
             : measure_words(view_of(*asset), view_of(*asset), true, contact_count);
}

std::size_t body_penetration_scratch_words(const Asset* a, const Asset* b, std::size_t contact_count) noexcept {
  return a == nullptr || b == nullptr || !has_skin(view_of(*a)) || !has_skin(view_of(*b))
             ? 0
             : measure_words(view_of(*a), view_of(*b), false, contact_count);
}

Status PenetrationJob::run() noexcept { return measure(*this); }

Status BodyPenetrationJob::run() noexcept { return measure(*this); }

}  // namespace spherechain
