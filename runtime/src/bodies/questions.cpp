// SPDX-License-Identifier: MIT
// The questions about a body: each is a job on the body's memory.
#include "runtime/src/bodies/body.h"

#include <algorithm>
#include <utility>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/contacts/contact_jobs.h"
#include "runtime/src/contacts/part_table.h"
#include "runtime/src/inside/inside_job.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/penetrations/measure.h"
#include "runtime/src/penetrations/penetration_jobs.h"
#include "runtime/src/refit/refit_job.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/step/step_job.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_query, target);
SPHERECHAIN_LAST_FIELD(sc_ground, user);

namespace {

// Whether the bodies can be asked. Empties the result.
template <typename Found>
Status begin(const sc_body* body, const sc_body* other, Found* found) {
  if (found != nullptr) {
    *found = {};
  }
  if (body == nullptr || found == nullptr) {
    return refuse(SC_NULL, body == nullptr ? SC_FIELD_BODIES : SC_FIELD_OUTPUT);
  }
  if (other == body) {
    return refuse(SC_ALIASED, SC_FIELD_BODIES);
  }
  return !body->now.is_given || (other != nullptr && !other->now.is_given) ? refuse(SC_NOT_OPEN, SC_FIELD_BODIES)
                                                                           : done();
}

// A query of a body with itself, or of two. A field that would not be read is refused.
Status check_query(const sc_query& query, const sc_body* other) {
  constexpr std::uint32_t kClasses = (1U << (SC_CLASS_INSIDE + 1)) - 1;
  const bool has_parts = query.ignored_parts != nullptr || query.ignored_parts_of_other != nullptr;
  const bool is_known = (query.full == 0 || query.full == 1) && (query.classes == 0 || (query.classes & kClasses) != 0);
  return !is_known                                            ? refuse(SC_BAD_VALUE, SC_FIELD_QUERY)
         : other == nullptr && has_parts                      ? refuse(SC_BAD_VALUE, SC_FIELD_IGNORED_PARTS)
         : other != nullptr && query.ignored_pairs != nullptr ? refuse(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS)
                                                              : done();
}

// The caller's query; null: zeros.
Status read_query(const sc_query* query, sc_query& out) { return query == nullptr ? done() : read_struct(query, out); }

// The same, checked.
Status take_query(const sc_query* query, const sc_body* other, sc_query& out) {
  const Status status = read_query(query, out);
  return status == SC_OK ? check_query(out, other) : status;
}

// The pairs of spheres that a query leaves out, for its jobs; null: the asset's.
const Filter* filter_of(sc_body& body, const sc_query& query) {
  body.filter = filter_of(asset_of(body), query.ignored_pairs);
  return query.ignored_pairs == nullptr ? nullptr : &body.filter;
}

// Whether there is room for a question about two bodies: for all pairs of their parts, and so many words.
Status check_room(const sc_body& body, const sc_body& other, std::size_t words) {
  const std::size_t parts = asset_of(body).part_count() * asset_of(other).part_count();
  return parts > body.parts.size || words > body.scratch_words ? refuse(SC_TOO_SMALL, SC_FIELD_BODIES) : done();
}

// Brings the pairs of parts that a query asks about into the order of a contact job.
const std::uint64_t* pairs_asked(sc_body& body, const sc_body* other, const sc_query& query) {
  if (query.part_pairs == nullptr || other != nullptr) {
    return query.part_pairs;
  }
  TableOfParts<PartContact> places;
  places.count_b = asset_of(body).part_count();
  std::fill(body.part_pairs, body.part_pairs + words_for(body.parts.size), std::uint64_t{0});
  for (std::size_t a = 0; a < places.count_b; ++a) {
    for (std::size_t b = 0; b < places.count_b; ++b) {
      const std::size_t bit = a * places.count_b + b, place = places.place(std::min(a, b), std::max(a, b), true);
      body.part_pairs[place / 64] |= (query.part_pairs[bit / 64] >> bit % 64 & 1) << place % 64;
    }
  }
  return body.part_pairs;
}

// Runs a contact job of either kind into the body's lists. A round leaves the list of parts as it is:
// measure_in_rounds() goes through it.
template <typename Job>
Status run_contacts(sc_body& body, const sc_query& query, bool lists_all, bool is_round, Job& job) {
  job.target = query.target;
  job.scratch = body.scratch;
  job.scratch_words = body.scratch_words;
  job.parts = is_round ? nullptr : body.parts.data;
  job.part_capacity = is_round ? 0 : body.parts.size;
  if (lists_all) {
    job.spheres = body.contact_spheres.data;
    job.sphere_capacity = body.contact_spheres.size;
    job.triangles = body.triangles.data;
    job.triangle_capacity = body.triangles.size;
  }
  const Status status = job.run();
  if (status != SC_OK && status != SC_OVERFLOW) {
    return status;
  }
  body.contacts = {body.parts.data,
                   std::min(job.part_count, body.parts.size),
                   body.contact_spheres.data,
                   lists_all ? std::min(job.sphere_count, body.contact_spheres.size) : 0,
                   lists_all ? job.sphere_count : 0,
                   body.triangles.data,
                   lists_all ? std::min(job.triangle_count, body.triangles.size) : 0,
                   lists_all ? job.triangle_count : 0};
  return done();
}

// Finds the contacts that a query asks for, or in a round those of the parts in body.part_pairs.
Status find_contacts(sc_body& body, const sc_body* other, const sc_query& query, bool lists_all, bool is_round) {
  body.contacts = {};
  body.has_contacts = false;
  const std::uint64_t* const part_pairs = is_round ? body.part_pairs : pairs_asked(body, other, query);
  if (other == nullptr) {
    SkinContactJob job;
    job.asset = &body.model->asset;
    job.pose = body.now.pose;
    job.skin_table = body.model->skin_table;
    job.scope = query.scope;
    job.filter = filter_of(body, query);
    job.part_pairs = part_pairs;
    return run_contacts(body, query, lists_all, is_round, job);
  }
  const Status room = check_room(body, *other, body_scratch_words(asset_of(body), asset_of(*other)));
  if (room != SC_OK) {
    return room;
  }
  BodyContactJob job;
  job.a = side_of(body, query.ignored_parts);
  job.b = side_of(*other, query.ignored_parts_of_other);
  job.part_pairs = part_pairs;
  return run_contacts(body, query, lists_all, is_round, job);
}

// Keeps a body's contacts with itself between questions. Contacts with another body are not kept: it may have been
// replaced by a new body at the same address.
Status know_contacts(sc_body& body, const sc_body* other, const sc_query& query) {
  const bool is_kept = other == nullptr && query.ignored_pairs == nullptr && query.part_pairs == nullptr;
  if (is_kept && body.has_contacts && body.contacts_scope == query.scope) {
    return done();
  }
  const Status status = find_contacts(body, other, query, true, false);
  body.has_contacts = is_kept && status == SC_OK;
  body.contacts_scope = query.scope;
  return status;
}

// The spheres of the pose.
Status know_spheres(sc_body& body, sc_radius radius, sc_target target) {
  if (body.has_spheres && body.spheres_radius == radius) {
    return done();
  }
  RefitJob refit;
  refit.asset = &body.model->asset;
  refit.pose = body.now.pose;
  refit.radius = radius;
  refit.target = target;
  refit.spheres = body.spheres.data;
  refit.sphere_capacity = body.spheres.size;
  const Status status = refit.run();
  body.has_spheres = status == SC_OK;
  body.spheres_radius = radius;
  return status;
}

// SC_OVERFLOW: not all pairs are listed.
Status pair_spheres(sc_body& body, const sc_query& query, sc_radius radius, DetectJob& job) {
  const Status status = know_spheres(body, radius, query.target);
  if (status != SC_OK) {
    return status;
  }
  job.asset = &body.model->asset;
  job.spheres = body.spheres.data;
  job.sphere_count = body.spheres.size;
  job.radius = radius;
  job.target = query.target;
  job.filter = filter_of(body, query);
  job.table = query.ignored_pairs == nullptr && radius == SC_RADIUS_DETECT ? body.model->detect_table : nullptr;
  job.pairs = body.sphere_pairs.data;
  job.pair_capacity = body.sphere_pairs.size;
  return job.run();
}

// Finds the spheres that are inside another part, or inside the other body. Profile `paper` has no spheres of bones:
// nothing is known then.
Status find_insides(sc_body& body, const sc_body* other, const sc_query& query, MeasureJob& measure) {
  InsideJob job;
  DetectJob pairs;
  const Status status = other == nullptr ? pair_spheres(body, query, SC_RADIUS_DETECT, pairs)
                                         : know_spheres(body, SC_RADIUS_DETECT, query.target);
  if (status == SC_NOT_IN_ASSET || (other == nullptr && query.scope == SC_SCOPE_NEIGHBOURS)) {
    return done();
  }
  if (status != SC_OK && status != SC_OVERFLOW) {
    return status;
  }
  if (!resolve_target(query.target, job.target)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  job.body = side_of(body, query.ignored_parts);
  job.skin = other == nullptr ? job.body : side_of(*other, query.ignored_parts_of_other);
  job.filter = filter_of(body, query);
  job.are_one = other == nullptr;
  job.centers = {body.spheres.data, body.spheres.size};
  job.pairs = {pairs.pairs, std::min(pairs.pair_count, pairs.pair_capacity)};
  job.has_all_pairs = status == SC_OK;
  job.scratch = body.scratch;
  job.part = body.inside[0];
  job.run();
  measure.inside_a = job.part.data;
  if (other == nullptr) {
    return done();
  }
  RefitJob refit;
  refit.asset = &other->model->asset;
  refit.pose = other->now.pose;
  refit.target = query.target;
  refit.spheres = body.other_spheres.data;
  refit.sphere_capacity = body.other_spheres.size;
  const Status of_other = refit.run();
  if (of_other == SC_NOT_IN_ASSET) {
    return done();
  }
  if (of_other != SC_OK) {
    return of_other;
  }
  std::swap(job.body, job.skin);
  job.centers = {body.other_spheres.data, asset_of(*other).spheres().size};
  job.part = {body.inside[1].data, probe_count(asset_of(*other))};
  job.run();
  measure.inside_b = job.part.data;
  return done();
}

std::uint32_t classes_of(const sc_query& query) {
  constexpr std::uint32_t kFaults = 1U << SC_CLASS_DEEP_FOLD | 1U << SC_CLASS_PENETRATION | 1U << SC_CLASS_INSIDE;
  return query.classes == 0 ? kFaults : query.classes;
}

// Measures the contacts that the body holds, beside what the list has already.
template <typename Job>
Status run_penetrations(sc_body& body, const sc_query& query, const MeasureJob& insides, Span<Penetration> list,
                        std::size_t& total, Job& job) {
  static_cast<MeasureJob&>(job) = insides;
  job.target = query.target;
  job.contacts = body.contacts.triangles;
  job.contact_count = body.contacts.triangle_count;
  job.previous = query.previous;
  job.previous_count = query.previous_count;
  job.quick = 1 - query.full;
  job.rule = query.rule;
  job.classes = classes_of(query);
  job.scratch = body.scratch;
  job.scratch_words = body.scratch_words;
  job.penetrations = list.data;
  job.penetration_capacity = list.size;
  job.kept_count = total;
  const Status status = job.run();
  total = status == SC_OK || status == SC_OVERFLOW ? job.penetration_count : total;
  return status == SC_OVERFLOW ? done() : status;
}

Status measure_contacts(sc_body& body, const sc_body* other, const sc_query& query, const MeasureJob& insides,
                        Span<Penetration> list, std::size_t& total) {
  if (other == nullptr) {
    PenetrationJob job;
    job.asset = &body.model->asset;
    job.pose = body.now.pose;
    job.skin_table = body.model->skin_table;
    job.scope = query.scope;
    job.filter = filter_of(body, query);
    return run_penetrations(body, query, insides, list, total, job);
  }
  const std::size_t words = measure_words(asset_of(body), asset_of(*other), false, body.contacts.triangle_count);
  const Status room = check_room(body, *other, words);
  if (room != SC_OK) {
    return room;
  }
  BodyPenetrationJob job;
  job.a = side_of(body, nullptr);
  job.b = side_of(*other, nullptr);
  return run_penetrations(body, query, insides, list, total, job);
}

// Where there is no room for all triangles: as many pairs of parts at a time as there is room for.
Status measure_in_rounds(sc_body& body, const sc_body* other, const sc_query& query, MeasureJob& insides,
                         Span<Penetration> list, std::size_t& total) {
  const std::int32_t adds_enclosed = std::exchange(insides.adds_enclosed, 0);
  const std::size_t part_count = body.contacts.part_count;
  TableOfParts<PartContact> places;
  places.count_b = asset_of(other == nullptr ? body : *other).part_count();
  for (std::size_t next = 0; next < part_count;) {
    std::fill(body.part_pairs, body.part_pairs + words_for(body.parts.size), std::uint64_t{0});
    for (std::size_t triangles = 0; next < part_count; ++next) {
      const PartContact& parts = body.parts[next];
      if (triangles > 0 && triangles + parts.triangle_pairs > body.triangles.size) {
        break;
      }
      triangles += parts.triangle_pairs;
      const std::size_t place = places.place(parts.part_a, parts.part_b, other == nullptr);
      body.part_pairs[place / 64] |= std::uint64_t{1} << place % 64;
    }
    Status status = find_contacts(body, other, query, true, true);
    insides.adds_enclosed = next < part_count ? 0 : adds_enclosed;
    status = status == SC_OK ? measure_contacts(body, other, query, insides, list, total) : status;
    if (status != SC_OK) {
      return status;
    }
  }
  return done();
}

// The worst first, with the engine's joints.
void finish(const sc_body& body, Span<Penetration> list, std::size_t total, sc_penetrations& found) {
  const std::size_t count = std::min(total, list.size);
  std::sort(list.begin(), list.begin() + count, [](const Penetration& l, const Penetration& r) {
    return is_worse(l, r) || (!is_worse(r, l) && Pair{l.part, l.other} < Pair{r.part, r.other});
  });
  for (std::size_t i = 0; i < count; ++i) {
    list[i].joint = sc_get_part_joint(body.model, list[i].part);
  }
  found = {list.data, count, total};
}

// The list that does not hold the last question's answer.
Span<Penetration> next_list(sc_body& body, const sc_query& query) {
  std::swap(body.penetrations[0], body.penetrations[1]);
  Span<Penetration> list = body.penetrations[0];
  list.size = query.limit > 0 ? std::min(query.limit, list.size) : list.size;
  return list;
}

Status measure_bodies(sc_body& body, const sc_body* other, const sc_query& query, bool along, sc_penetrations& found) {
  Status status = know_contacts(body, other, query);
  if (status != SC_OK) {
    return status;
  }
  MeasureJob job;
  status = find_insides(body, other, query, job);
  if (status != SC_OK) {
    return status;
  }
  job.along = along ? 1 : 0;
  job.adds_enclosed = 1;
  job.met = body.contacts.parts;
  job.met_count = body.contacts.part_count;
  job.part_pairs = query.part_pairs == nullptr ? nullptr : pairs_asked(body, other, query);
  const Span<Penetration> list = next_list(body, query);
  std::size_t total = 0;
  const bool fits = body.contacts.triangle_total <= body.triangles.size;
  status = fits ? measure_contacts(body, other, query, job, list, total)
                : measure_in_rounds(body, other, query, job, list, total);
  if (status == SC_OK) {
    finish(body, list, total, found);
  }
  return status;
}

}  // namespace

Status find_along(sc_body& body, const sc_body* other, const sc_query& query, sc_penetrations& found) {
  Status status = begin(&body, other, &found);
  sc_query checked = query;
  checked.ignored_parts = other == nullptr ? nullptr : query.ignored_parts;
  status = status == SC_OK ? check_query(checked, other) : status;
  return status == SC_OK ? measure_bodies(body, other, query, true, found) : status;
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_find_contacts(sc_body* body, const sc_body* other, const sc_query* query, sc_contacts* found) noexcept {
  sc_query of{};
  Status status = begin(body, other, found);
  status = status == SC_OK ? take_query(query, other, of) : status;
  if (status != SC_OK) {
    return status;
  }
  status = of.full != 0 ? know_contacts(*body, other, of) : find_contacts(*body, other, of, false, false);
  if (status == SC_OK) {
    *found = body->contacts;
  }
  return status;
}

sc_status sc_find_penetrations(sc_body* body, const sc_body* other, const sc_query* query,
                               sc_penetrations* found) noexcept {
  sc_query of{};
  Status status = begin(body, other, found);
  status = status == SC_OK ? take_query(query, other, of) : status;
  return status == SC_OK ? measure_bodies(*body, other, of, false, *found) : status;
}

sc_status sc_find_sphere_pairs(sc_body* body, const sc_query* query, sc_sphere_pairs* found) noexcept {
  sc_query of{};
  Status status = begin(body, nullptr, found);
  status = status == SC_OK ? read_query(query, of) : status;
  if (status != SC_OK) {
    return status;
  }
  if (of.radius != SC_RADIUS_DETECT && of.radius != SC_RADIUS_FIT) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  DetectJob job;
  status = pair_spheres(*body, of, of.radius, job);
  if (status != SC_OK && status != SC_OVERFLOW) {
    return status;
  }
  *found = {body->spheres.data, body->spheres.size, job.pairs, std::min(job.pair_count, job.pair_capacity),
            job.pair_count};
  return done();
}

sc_status sc_find_steps(sc_body* body, const sc_body* other, const sc_query* query, const sc_step_contact** steps,
                        size_t* count) noexcept {
  sc_query of{};
  const Status no_count = begin(body, other, count);
  Status status = begin(body, other, steps);
  status = status == SC_OK ? no_count : status;
  status = status == SC_OK ? take_query(query, other, of) : status;
  if (status != SC_OK) {
    return status;
  }
  if (of.part_pairs != nullptr) {
    return refuse(SC_BAD_VALUE, SC_FIELD_PART_PAIRS);
  }
  if (!body->before.is_given || (other != nullptr && !other->before.is_given)) {
    return refuse(SC_NOT_OPEN, SC_FIELD_BODIES);
  }
  StepJob job;
  const auto motion_of = [](const sc_body& from, const std::uint64_t* ignored_parts) {
    Motion motion;
    motion.body = side_of(from, ignored_parts);
    motion.body.pose = from.before.pose;
    motion.end = from.now.pose;
    return motion;
  };
  job.a = motion_of(*body, of.ignored_parts);
  if (other != nullptr) {
    job.b = motion_of(*other, of.ignored_parts_of_other);
  }
  if (body->steps.size == 0) {
    return refuse(SC_TOO_SMALL, SC_FIELD_BODIES);
  }
  status = other == nullptr ? done() : check_room(*body, *other, step_scratch_words(&job.a, &job.b));
  if (status != SC_OK) {
    return status;
  }
  job.target = of.target;
  job.filter = other == nullptr ? filter_of(*body, of) : nullptr;
  job.tolerance = of.tolerance;
  job.scratch = body->scratch;
  job.scratch_words = body->scratch_words;
  job.contacts = body->steps.data;
  job.contact_capacity = body->steps.size;
  const Status ran = job.run();
  if (ran == SC_OK) {
    *steps = job.contacts;
    *count = job.contact_count;
  }
  return ran;
}

sc_status sc_find_in_ground(sc_body* body, const sc_ground* ground, const sc_query* query,
                            sc_penetrations* found) noexcept {
  sc_query of{};
  sc_ground plane{};
  Status status = begin(body, nullptr, found);
  if (status != SC_OK || ground == nullptr) {
    return status != SC_OK ? status : refuse(SC_NULL, SC_FIELD_FLOOR);
  }
  status = read_query(query, of);
  status = status == SC_OK ? read_struct(ground, plane) : status;
  if (status != SC_OK) {
    return status;
  }
  if (of.part_pairs != nullptr) {
    return refuse(SC_BAD_VALUE, SC_FIELD_PART_PAIRS);
  }
  const Span<Penetration> list = next_list(*body, of);
  FloorJob job;
  job.body = side_of(*body, of.ignored_parts);
  job.target = of.target;
  job.up = plane.up;
  job.height = plane.height;
  job.terrain = plane.terrain;
  job.user = plane.user;
  job.rule = of.rule;
  job.classes = classes_of(of);
  job.scratch = body->scratch;
  job.scratch_words = body->scratch_words;
  job.penetrations = list.data;
  job.penetration_capacity = list.size;
  const Status ran = job.run();
  if (ran != SC_OK && ran != SC_OVERFLOW) {
    return ran;
  }
  finish(*body, list, job.penetration_count, *found);
  return done();
}

}  // extern "C"
