// SPDX-License-Identifier: MIT
// A body: the pose, and every question about it as a job on memory that was laid out once.
#include "spherechain/body.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

#include "asset/status.h"
#include "body/model.h"
#include "depth/measure.h"
#include "pairs/pair_bits.h"
#include "skin/scene_setup.h"
#include "spherechain/bodies.h"
#include "spherechain/detect.h"
#include "spherechain/penetrations.h"
#include "spherechain/refit.h"
#include "spherechain/skin_contacts.h"
#include "spherechain/steps.h"

namespace spherechain {
namespace {

constexpr std::size_t kTrianglesMin = 4096;  // pairs that there is room for, at least
constexpr std::size_t kPenetrations = 128;
constexpr std::size_t kPairsOfSphere = 16;  // a sphere touches so many others at most, in the mean of all

// A pose that was given, in memory of the body.
struct GivenPose {
  float *bones = nullptr, *morph_weights = nullptr;
  sc_pose pose{};  // points there; to vertices of the caller's
  bool is_given = false;
};

}  // namespace
}  // namespace spherechain

struct sc_body {
  const sc_model* model;
  sc_allocator allocator;
  spherechain::Block block;  // this, and what the pointers below point into
  spherechain::GivenPose now, before;
  std::uint64_t* scratch;
  std::size_t scratch_words;
  spherechain::Span<sc_sphere> spheres;
  spherechain::Span<sc_pair> sphere_pairs;  // that overlap
  spherechain::Span<sc_part_contact> parts;
  spherechain::Span<sc_pair> contact_spheres;
  spherechain::Span<sc_triangle_contact> triangles;
  std::uint64_t* listed;                            // a bit for each two parts
  spherechain::Span<sc_penetration> penetrations[2];  // of the last question, and of the one before
  spherechain::Span<sc_step_contact> steps;
  bool has_spheres;  // of this pose, with that radius
  sc_radius spheres_radius;
  sc_contacts contacts;  // of the last question
  bool has_contacts;     // they are all of this body with itself, in this pose and that scope
  sc_scope contacts_scope;
};

namespace spherechain {
namespace {

const AssetView& asset_of(const sc_body& body) { return view_of(body.model->asset); }

// The most that any question about this model needs, alone or with the other.
std::size_t scratch_words_of(const sc_model& model, const sc_model& other, std::size_t max_triangles, bool finds_steps) {
  const AssetView &a = view_of(model.asset), &b = view_of(other.asset);
  std::size_t words = std::max({skin_scratch_words(a), body_scratch_words(a, b), body_scratch_words(b, a),
                                measure_words(a, a, true, max_triangles), measure_words(a, b, false, max_triangles),
                                measure_words(b, a, false, max_triangles), sc_floor_scratch_words(&model.asset)});
  if (finds_steps) {
    sc_motion of_a{}, of_b{};
    of_a.body.asset = &model.asset;
    of_b.body.asset = &other.asset;
    of_a.body.pose.vertices = of_b.body.pose.vertices = reinterpret_cast<const float*>(&words);  // with vertices or not
    words = std::max({words, sc_step_scratch_words(&of_a, nullptr), sc_step_scratch_words(&of_a, &of_b)});
  }
  return words;
}

// Of null words it only counts them.
std::size_t lay_out(sc_body& body, const sc_body_def& def, std::uint64_t* words) {
  WordMemory memory(words);
  const AssetView& asset = asset_of(body);
  const sc_model& other = def.largest_other == nullptr ? *body.model : *def.largest_other;
  const std::size_t spheres = asset.spheres().size, count = asset.part_count(),
                    parts = std::max(count * (count + 1) / 2, count * view_of(other.asset).part_count());
  const std::size_t max_triangles =
      def.max_triangles > 0 ? def.max_triangles : std::max(kTrianglesMin, asset.skin().sizes.triangles / 2);
  sc_body* self = nullptr;
  memory.take(self, 1);
  for (GivenPose* given : {&body.now, &body.before}) {
    memory.take(given->bones, 12 * asset.bone_count());
    memory.take(given->morph_weights, asset.morph_count());
  }
  memory.take(body.spheres, spheres);
  memory.take(body.sphere_pairs, std::min(spheres * (spheres - 1) / 2, kPairsOfSphere * spheres));
  memory.take(body.parts, parts);
  memory.take(body.contact_spheres, max_triangles);
  memory.take(body.triangles, max_triangles);
  memory.take(body.listed, words_for(parts));
  for (Span<sc_penetration>& list : body.penetrations) {
    memory.take(list, def.max_penetrations > 0 ? def.max_penetrations : kPenetrations);
  }
  memory.take(body.steps, def.finds_steps != 0 ? parts : 0);
  body.scratch_words = scratch_words_of(*body.model, other, max_triangles, def.finds_steps != 0);
  memory.take(body.scratch, body.scratch_words);
  return memory.used();
}

// A job's side.
JobBody side_of(const sc_body& body, const std::uint64_t* ignored_parts) {
  return {&body.model->asset, body.now.pose, body.model->skin_table, ignored_parts};
}

Status check(const sc_body* body, const sc_body* other, const void* found) {
  if (body == nullptr || found == nullptr) {
    return refuse(SC_NULL, body == nullptr ? SC_FIELD_BODIES : SC_FIELD_OUTPUT);
  }
  if (other == body) {
    return refuse(SC_ALIASED, SC_FIELD_BODIES);
  }
  return !body->now.is_given || (other != nullptr && !other->now.is_given) ? refuse(SC_NOT_OPEN, SC_FIELD_BODIES)
                                                                           : done();
}

// Of a body with itself, or of two. What would be left unread is refused.
Status check_query(const sc_query* query, const sc_body* other) {
  if (query == nullptr) {
    return done();
  }
  constexpr std::uint32_t kClasses = (1U << (SC_CLASS_PENETRATION + 1)) - 1;
  const bool has_parts = query->ignored_parts != nullptr || query->ignored_parts_of_other != nullptr;
  const bool is_known = (query->detail == SC_DETAIL_QUICK || query->detail == SC_DETAIL_FULL) &&
                        (query->classes == 0 || (query->classes & kClasses) != 0);
  return !is_known                                      ? refuse(SC_BAD_VALUE, SC_FIELD_QUERY)
         : other == nullptr && has_parts                ? refuse(SC_BAD_VALUE, SC_FIELD_IGNORED_PARTS)
         : other != nullptr && query->filter != nullptr ? refuse(SC_BAD_VALUE, SC_FIELD_FILTER)
                                                        : done();
}

sc_query query_of(const sc_query* query) { return query == nullptr ? sc_query{} : *query; }

// Whether there is room for a question about two bodies: for all pairs of their parts, and so many words.
Status check_room(const sc_body& body, const sc_body& other, std::size_t words) {
  const std::size_t parts = asset_of(body).part_count() * asset_of(other).part_count();
  return parts > body.parts.size || words > body.scratch_words ? refuse(SC_TOO_SMALL, SC_FIELD_BODIES) : done();
}

// What contact jobs have in common.
template <typename Job>
Status run_contacts(sc_body& body, const sc_query& query, bool lists_all, const std::uint64_t* listed, Job& job) {
  job.target = query.target;
  job.scratch = body.scratch;
  job.scratch_words = body.scratch_words;
  job.parts = body.parts.data;
  job.part_capacity = body.parts.size;
  if (lists_all) {
    job.spheres = body.contact_spheres.data;
    job.sphere_capacity = body.contact_spheres.size;
    job.triangles = body.triangles.data;
    job.triangle_capacity = body.triangles.size;
    job.listed_parts = listed;
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

// `listed`: of which parts triangles are listed; null: of all.
Status find_contacts(sc_body& body, const sc_body* other, const sc_query& query, bool lists_all,
                     const std::uint64_t* listed) {
  body.contacts = {};
  body.has_contacts = false;
  if (other == nullptr) {
    SkinContactJob job;
    job.asset = &body.model->asset;
    job.pose = body.now.pose;
    job.skin_table = body.model->skin_table;
    job.scope = query.scope;
    job.filter = query.filter;
    return run_contacts(body, query, lists_all, listed, job);
  }
  const Status room = check_room(body, *other, body_scratch_words(asset_of(body), asset_of(*other)));
  if (room != SC_OK) {
    return room;
  }
  BodyContactJob job;
  job.a = side_of(body, query.ignored_parts);
  job.b = side_of(*other, query.ignored_parts_of_other);
  return run_contacts(body, query, lists_all, listed, job);
}

// Of a body with itself they are kept from question to question. Another body may be gone, with a new one in its place.
Status know_contacts(sc_body& body, const sc_body* other, const sc_query& query) {
  const bool is_kept = other == nullptr && query.filter == nullptr;
  if (is_kept && body.has_contacts && body.contacts_scope == query.scope) {
    return done();
  }
  const Status status = find_contacts(body, other, query, true, nullptr);
  body.has_contacts = is_kept && status == SC_OK;
  body.contacts_scope = query.scope;
  return status;
}

std::uint32_t classes_of(const sc_query& query) {
  constexpr std::uint32_t kFaults = 1U << SC_CLASS_DEEP_FOLD | 1U << SC_CLASS_PENETRATION;
  return query.classes == 0 ? kFaults : query.classes;
}

// Measures the contacts that the body holds, beside what the list has already.
template <typename Job>
Status run_penetrations(sc_body& body, const sc_query& query, Span<Penetration> list, std::size_t& total, Job& job) {
  job.target = query.target;
  job.contacts = body.contacts.triangles;
  job.contact_count = body.contacts.triangle_count;
  job.previous = query.previous;
  job.previous_count = query.previous_count;
  job.quick = query.detail == SC_DETAIL_FULL ? 0 : 1;
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

Status measure_contacts(sc_body& body, const sc_body* other, const sc_query& query, Span<Penetration> list,
                        std::size_t& total) {
  if (other == nullptr) {
    PenetrationJob job;
    job.asset = &body.model->asset;
    job.pose = body.now.pose;
    job.skin_table = body.model->skin_table;
    job.scope = query.scope;
    job.filter = query.filter;
    return run_penetrations(body, query, list, total, job);
  }
  const std::size_t words = measure_words(asset_of(body), asset_of(*other), false, body.contacts.triangle_count);
  const Status room = check_room(body, *other, words);
  if (room != SC_OK) {
    return room;
  }
  BodyPenetrationJob job;
  job.a = side_of(body, nullptr);
  job.b = side_of(*other, nullptr);
  return run_penetrations(body, query, list, total, job);
}

// Where there is no room for all triangles: as many pairs of parts at a time as there is room for.
Status measure_in_rounds(sc_body& body, const sc_body* other, const sc_query& query, Span<Penetration> list,
                         std::size_t& total) {
  const std::size_t part_count = body.contacts.part_count;
  TableOfParts<PartContact> places;
  places.count_b = asset_of(other == nullptr ? body : *other).part_count();
  for (std::size_t next = 0; next < part_count;) {
    std::fill(body.listed, body.listed + words_for(body.parts.size), std::uint64_t{0});
    for (std::size_t triangles = 0; next < part_count; ++next) {
      const PartContact& parts = body.parts[next];
      if (triangles > 0 && triangles + parts.triangle_pairs > body.triangles.size) {
        break;
      }
      triangles += parts.triangle_pairs;
      const std::size_t place = places.place(parts.part_a, parts.part_b, other == nullptr);
      body.listed[place / 64] |= std::uint64_t{1} << place % 64;
    }
    Status status = find_contacts(body, other, query, true, body.listed);
    status = status == SC_OK ? measure_contacts(body, other, query, list, total) : status;
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

Status gather(sc_body& body, const sc_pose& pose, const sc_transform* place, GivenPose& given) {
  const AssetView& asset = asset_of(body);
  given.pose = pose;
  if (pose.bones != nullptr) {
    const Status status = body.model->joint_of_bone == nullptr
                              ? check_bones(asset, pose)
                              : sc_gather_bones(&body.model->asset, body.model->joint_of_bone, &pose, given.bones);
    if (status != SC_OK) {
      return status;
    }
    if (body.model->joint_of_bone == nullptr) {
      const BoneMatrices from = matrices_of(pose);
      for (std::size_t i = 0; i < 12 * asset.bone_count(); ++i) {
        given.bones[i] = from.data[i / 12 * from.stride + i % 12 / 4 * from.row + i % 4 * from.column];
      }
    }
    given.pose.bones = given.bones;
    given.pose.bone_count = asset.bone_count();
    given.pose.bone_layout = SC_ROWS_3X4;
    given.pose.bone_stride = 0;
  }
  const Status status = check_skin_pose(asset, given.pose);
  if (status != SC_OK) {
    return status;
  }
  if (given.pose.morph_weights != nullptr) {
    std::copy_n(pose.morph_weights, asset.morph_count(), given.morph_weights);
    given.pose.morph_weights = given.morph_weights;
    given.pose.morph_weight_count = asset.morph_count();
  }
  if (place == nullptr) {
    return done();
  }
  return pose.vertices != nullptr ? refuse(SC_BAD_VALUE, SC_FIELD_TRANSFORM)
                                  : sc_place_bones(place, given.bones, asset.bone_count());
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_create_body(const sc_model* model, const sc_body_def* def, sc_body** body) noexcept {
  if (body != nullptr) {
    *body = nullptr;
  }
  if (model == nullptr || body == nullptr) {
    return refuse(SC_NULL, model == nullptr ? SC_FIELD_ASSET : SC_FIELD_OUTPUT);
  }
  const sc_body_def wanted = def == nullptr ? sc_body_def{} : *def;
  constexpr std::size_t kMost = std::size_t{1} << 31;
  if (wanted.max_triangles > kMost || wanted.max_penetrations > kMost) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TRIANGLES);
  }
  sc_body made{};
  made.model = model;
  const Status complete = choose_allocator(wanted.allocator, model->allocator, made.allocator);
  if (complete != SC_OK) {
    return complete;
  }
  if (!made.block.allocate(made.allocator, lay_out(made, wanted, nullptr))) {
    return refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  }
  lay_out(made, wanted, made.block.words);
  *body = new (made.block.words) sc_body(made);
  return done();
}

void sc_destroy_body(sc_body* body) noexcept {
  if (body != nullptr) {
    Block block = body->block;
    const sc_allocator allocator = body->allocator;
    block.release(allocator);
  }
}

sc_status sc_set_pose(sc_body* body, const sc_pose* pose, const sc_transform* place) noexcept {
  if (body == nullptr || pose == nullptr) {
    return refuse(SC_NULL, body == nullptr ? SC_FIELD_BODIES : SC_FIELD_BONES);
  }
  std::swap(body->now, body->before);
  body->has_contacts = body->has_spheres = false;
  const Status status = gather(*body, *pose, place, body->now);
  body->now.is_given = status == SC_OK;
  return status;
}

sc_status sc_find_contacts(sc_body* body, const sc_body* other, const sc_query* query, sc_contacts* found) noexcept {
  Status status = check(body, other, found);
  if (found != nullptr) {
    *found = {};
  }
  status = status == SC_OK ? check_query(query, other) : status;
  if (status != SC_OK) {
    return status;
  }
  const sc_query of = query_of(query);
  status = of.detail == SC_DETAIL_FULL ? know_contacts(*body, other, of) : find_contacts(*body, other, of, false, nullptr);
  if (status == SC_OK) {
    *found = body->contacts;
  }
  return status;
}

sc_status sc_find_penetrations(sc_body* body, const sc_body* other, const sc_query* query,
                               sc_penetrations* found) noexcept {
  Status status = check(body, other, found);
  if (found != nullptr) {
    *found = {};
  }
  status = status == SC_OK ? check_query(query, other) : status;
  if (status != SC_OK) {
    return status;
  }
  const sc_query of = query_of(query);
  status = know_contacts(*body, other, of);
  if (status != SC_OK) {
    return status;
  }
  const Span<Penetration> list = next_list(*body, of);
  std::size_t total = 0;
  const bool fits = body->contacts.triangle_total <= body->triangles.size;
  status = fits ? measure_contacts(*body, other, of, list, total) : measure_in_rounds(*body, other, of, list, total);
  if (status == SC_OK) {
    finish(*body, list, total, *found);
  }
  return status;
}

sc_status sc_find_sphere_pairs(sc_body* body, const sc_query* query, sc_sphere_pairs* found) noexcept {
  Status status = check(body, nullptr, found);
  if (found != nullptr) {
    *found = {};
  }
  if (status != SC_OK) {
    return status;
  }
  const sc_query of = query_of(query);
  if (of.radius != SC_RADIUS_DETECT && of.radius != SC_RADIUS_FIT) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  if (!body->has_spheres || body->spheres_radius != of.radius) {
    RefitJob refit;
    refit.asset = &body->model->asset;
    refit.pose = body->now.pose;
    refit.radius = of.radius;
    refit.target = of.target;
    refit.spheres = body->spheres.data;
    refit.sphere_capacity = body->spheres.size;
    status = refit.run();
    body->has_spheres = status == SC_OK;
    body->spheres_radius = of.radius;
    if (status != SC_OK) {
      return status;
    }
  }
  DetectJob job;
  job.asset = &body->model->asset;
  job.spheres = body->spheres.data;
  job.sphere_count = body->spheres.size;
  job.radius = of.radius;
  job.target = of.target;
  job.filter = of.filter;
  job.table = of.filter == nullptr && of.radius == SC_RADIUS_DETECT ? body->model->detect_table : nullptr;
  job.pairs = body->sphere_pairs.data;
  job.pair_capacity = body->sphere_pairs.size;
  status = job.run();
  if (status != SC_OK && status != SC_OVERFLOW) {
    return status;
  }
  *found = {body->spheres.data, body->spheres.size, job.pairs, std::min(job.pair_count, job.pair_capacity),
            job.pair_count};
  return done();
}

sc_status sc_find_steps(sc_body* body, const sc_body* other, const sc_query* query, sc_steps* found) noexcept {
  Status status = check(body, other, found);
  if (found != nullptr) {
    *found = {};
  }
  status = status == SC_OK ? check_query(query, other) : status;
  if (status != SC_OK) {
    return status;
  }
  if (!body->before.is_given || (other != nullptr && !other->before.is_given)) {
    return refuse(SC_NOT_OPEN, SC_FIELD_BODIES);
  }
  const sc_query of = query_of(query);
  StepJob job;
  const auto motion_of = [](const sc_body& from, const std::uint64_t* ignored_parts) {
    sc_motion motion;
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
  status = other == nullptr ? done() : check_room(*body, *other, sc_step_scratch_words(&job.a, &job.b));
  if (status != SC_OK) {
    return status;
  }
  job.target = of.target;
  job.filter = other == nullptr ? of.filter : nullptr;
  job.tolerance = of.tolerance;
  job.scratch = body->scratch;
  job.scratch_words = body->scratch_words;
  job.contacts = body->steps.data;
  job.contact_capacity = body->steps.size;
  const Status ran = job.run();
  if (ran == SC_OK) {
    *found = {job.contacts, job.contact_count};
  }
  return ran;
}

sc_status sc_find_in_ground(sc_body* body, const sc_ground* ground, const sc_query* query,
                            sc_penetrations* found) noexcept {
  const Status status = ground == nullptr ? refuse(SC_NULL, SC_FIELD_FLOOR) : check(body, nullptr, found);
  if (found != nullptr) {
    *found = {};
  }
  if (status != SC_OK) {
    return status;
  }
  const sc_query of = query_of(query);
  const Span<Penetration> list = next_list(*body, of);
  FloorJob job;
  job.body = side_of(*body, of.ignored_parts);
  job.target = of.target;
  job.up = ground->up;
  job.height = ground->height;
  job.terrain = ground->terrain;
  job.user = ground->user;
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

sc_status sc_get_bounds(const sc_body* body, sc_vec3* low, sc_vec3* high) noexcept {
  const Status status = check(body, nullptr, low);
  if (status != SC_OK) {
    return status;
  }
  const JobBody side = side_of(*body, nullptr);
  return sc_bound_body(&side, low, high);
}

}  // extern "C"
