/* SPDX-License-Identifier: MIT */
/* A model in a pose, and the questions that are asked about it. */
#pragma once

#include "spherechain/contacts.h"
#include "spherechain/model.h"

/* A body holds a pose, the pose before it, what was derived from them, and the results of its queries. All memory is
 * allocated when it is made. A body serves one character with its history, or many characters in turn.
 *
 * One thread at a time may use a body. As `other` it is only read: any number of threads may pass one body as `other`
 * while nobody gives it a new pose. */
typedef struct sc_body sc_body;

typedef struct sc_body_def {
  uint32_t struct_size SC_SIZE_OF(sc_body_def);
  int32_t finds_steps SC_ZERO; /* 1: sc_find_steps() works; it needs much memory */
  /* Capacity for pairs of triangles that intersect; 0: half of the model's triangles, and at least 4,096. Where more
   * intersect, penetrations are found in several rounds, with the same results. If two parts alone have more, the first
   * so many of theirs are measured. */
  size_t max_triangles SC_ZERO;
  size_t max_penetrations SC_ZERO;       /* 0: 128; the worst are kept */
  const sc_model* largest_other SC_ZERO; /* of all that it will meet; null: none is larger than its own model */
  const sc_allocator* allocator SC_ZERO; /* copied; null: the model's */
} sc_body_def;

/* The options of a question. Zeros, or a null pointer, give the faults that `play` and `check` report, but for those
 * between layers of one place: they ask for SC_SCOPE_LAYERS. */
typedef struct sc_query {
  uint32_t struct_size SC_SIZE_OF(sc_query);
  sc_scope scope SC_ZERO;
  /* 0: penetrations are measured quickly: faults in full but for their volume, others along one direction and without
   * visibility. Contacts are of body parts.
   * 1: all penetrations are measured in full. The faults are the same. Contacts are of spheres and triangles, too. */
  int32_t full SC_ZERO;
  sc_radius radius SC_ZERO; /* of spheres and their pairs */
  /* Pairs of spheres that do not meet, in questions about a body with itself: sc_pair_words() words, laid out as in
   * asset.h; null: the asset's ignored pairs. */
  const uint64_t* ignored_pairs SC_ZERO;
  /* Body parts that meet nothing, in questions about two bodies or the ground: bit p of sc_part_words() words is part
   * p's; null: all parts meet. */
  const uint64_t* ignored_parts SC_ZERO;
  const uint64_t* ignored_parts_of_other SC_ZERO;
  /* Pairs of body parts that are asked about, in questions about contacts and penetrations: bit a n + b is of part a
   * and part b of the other body, which has n parts, or of the same one. m parts of the body make (m n + 63) / 64
   * words. Null: all pairs. In questions about one body, either order of the two will do. */
  const uint64_t* part_pairs SC_ZERO;
  const sc_rule* rule SC_ZERO; /* null: sc_default_rule() */
  uint32_t classes SC_ZERO;    /* bit k: penetrations of class k are listed; 0: faults alone */
  size_t limit SC_ZERO;        /* the worst so many; 0: as many as there is room for */
  /* Pass the last result of the same question for steady faults and directions. A fault then stays one until it is
   * shallower than 70 % of what the rule allows. A fault's direction turns by less than 30 degrees, as long as that way
   * is at most half as long again as the shortest (sc_penetration.distance). The body's last list stays valid for this.
   * If you ask several questions in turn, keep a copy of each list. */
  const sc_penetration* previous SC_ZERO;
  size_t previous_count SC_ZERO;
  float tolerance SC_ZERO;  /* of steps, a share of the height; 0: 0.0001 */
  sc_target target SC_ZERO; /* the same answers on every one */
} sc_query;

/* Faults first, by class, then the deepest first. `total` is larger than `count` where there was no room, or the limit
 * is less: the worst are there. Valid until the body's second next question about penetrations. */
typedef struct sc_penetrations {
  const sc_penetration* items;
  size_t count, total;
} sc_penetrations;

/* Sorted, each once. Totals as above; of spheres and triangles the first of the sorted lists are there. Valid until the
 * body's next question about contacts or penetrations, or its next pose. */
typedef struct sc_contacts {
  const sc_part_contact* parts;
  size_t part_count;
  const sc_pair* spheres;
  size_t sphere_count, sphere_total;
  const sc_triangle_contact* triangles;
  size_t triangle_count, triangle_total;
} sc_contacts;

/* Valid until the body's next pose. */
typedef struct sc_sphere_pairs {
  const sc_sphere* spheres; /* the asset's, in the pose */
  size_t sphere_count;
  const sc_pair* pairs;
  size_t count, total;
} sc_sphere_pairs;

/* A plane, and how far the ground is above it. */
typedef struct sc_ground {
  uint32_t struct_size SC_SIZE_OF(sc_ground);
  /* The world's upward direction, of unit length. The character's own, sc_asset_info.up, may differ by degrees. */
  sc_vec3 up SC_ZERO;
  float height SC_ZERO; /* up . p = height on the plane */
  /* Null, or: how far the ground is above the plane at p; called for each vertex of the skin, in no certain order. */
  float (*terrain)(const void* user, sc_vec3 p) SC_ZERO;
  const void* user SC_ZERO;
} sc_ground;

#if defined(__cplusplus)
extern "C" {
#endif

/* `def` null: all zeros. On failure *body is null: SC_NULL, SC_BAD_VALUE or SC_NO_MEMORY. */
SPHERECHAIN_API sc_status sc_create_body(const sc_model* model, const sc_body_def* def, sc_body** body) SC_NOEXCEPT;
SPHERECHAIN_API void sc_destroy_body(sc_body* body) SC_NOEXCEPT; /* null is fine */

/* The new pose; the old one becomes the pose before. Bones come in the order of the model's joints, and are copied, as
 * morph weights are; vertices are not: they must stay as they are until the next pose, and for steps until the one
 * after it. `place` moves the bones into the world, where other bodies are; null: they are there already. Errors as of
 * a job's pose; SC_BAD_VALUE with SC_FIELD_TRANSFORM: `place` is not finite, or the pose has vertices, too. After an
 * error the body has no pose. */
SPHERECHAIN_API sc_status sc_set_pose(sc_body* body, const sc_pose* pose, const sc_transform* place) SC_NOEXCEPT;

/* The questions. `other` null: the body with itself; else another body, which may be of the same model. Parts of `body`
 * come first. `query` null: all zeros. SC_OK; SC_NULL, SC_BAD_VALUE (also: a field of the query that the question would
 * not read: ignored parts without `other`, ignored pairs with it, part_pairs of steps or the ground), SC_NOT_IN_ASSET,
 * SC_UNSUPPORTED_TARGET; with SC_FIELD_BODIES: SC_ALIASED
 * (`other` is the body), SC_TOO_SMALL (the other's model is larger than the body was made for; of steps: it was not
 * made for them), SC_NOT_OPEN (a body has no pose; of steps: no pose before). After an error the result is empty. */
SPHERECHAIN_API sc_status sc_find_penetrations(sc_body* body, const sc_body* other, const sc_query* query,
                                               sc_penetrations* found) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_find_contacts(sc_body* body, const sc_body* other, const sc_query* query,
                                           sc_contacts* found) SC_NOEXCEPT;
SPHERECHAIN_API sc_status sc_find_sphere_pairs(sc_body* body, const sc_query* query,
                                               sc_sphere_pairs* found) SC_NOEXCEPT;
/* Finds the body parts that touch on the way from the last pose to this one. Matrices and vertices are blended
 * linearly. Layers of one place are left out. Finds every contact deeper than `tolerance`, and reports none that does
 * not exist. Shallower contacts may be missed. Times are accurate to the same distance. *steps becomes a list by
 * (part_a, part_b), each once; it is valid until the body's next question about steps. */
SPHERECHAIN_API sc_status sc_find_steps(sc_body* body, const sc_body* other, const sc_query* query,
                                        const sc_step_contact** steps, size_t* count) SC_NOEXCEPT;
/* The body parts below the ground; `other` is SC_FLOOR. */
SPHERECHAIN_API sc_status sc_find_in_ground(sc_body* body, const sc_ground* ground, const sc_query* query,
                                            sc_penetrations* found) SC_NOEXCEPT;
/* A box that holds all of the skin for certain: from bones somewhat too large, from vertices exact. */
SPHERECHAIN_API sc_status sc_get_bounds(const sc_body* body, sc_vec3* low, sc_vec3* high) SC_NOEXCEPT;

#if defined(__cplusplus)
}

namespace spherechain {

using BodyDef = sc_body_def;
using Query = sc_query;
using SpherePairs = sc_sphere_pairs;
using Ground = sc_ground;

/* Loops go over the list; `total` also counts those that there was no room for. */
struct Penetrations : sc_penetrations {
  const Penetration* begin() const noexcept { return items; }
  const Penetration* end() const noexcept { return items + count; }
};

/* Loops go over the body parts. */
struct Contacts : sc_contacts {
  const PartContact* begin() const noexcept { return parts; }
  const PartContact* end() const noexcept { return parts + part_count; }
};

struct Steps {
  const StepContact* items;
  size_t count;
  const StepContact* begin() const noexcept { return items; }
  const StepContact* end() const noexcept { return items + count; }
};

/* Owns an sc_body. It moves, and does not copy. One that was not made converts to false. Where a question fails, its
 * result is empty, and status() says why. */
class Body {
 public:
  Body() = default;
  explicit Body(const Model& model, const BodyDef& def = {}) noexcept {
    status_ = sc_create_body(model.handle(), &def, &handle_);
  }
  Body(Body&& other) noexcept { *this = static_cast<Body&&>(other); }
  Body& operator=(Body&& other) noexcept {
    sc_body* const own = handle_;
    handle_ = other.handle_;
    other.handle_ = own;
    status_ = other.status_;
    return *this;
  }
  ~Body() { sc_destroy_body(handle_); }

  explicit operator bool() const noexcept { return handle_ != nullptr; }
  Status status() const noexcept { return status_; } /* of the last call */
  sc_body* handle() const noexcept { return handle_; }

  Status set_pose(const Pose& pose) noexcept { return status_ = sc_set_pose(handle_, &pose, nullptr); }
  Status set_pose(const Pose& pose, const Transform& place) noexcept {
    return status_ = sc_set_pose(handle_, &pose, &place);
  }
  Penetrations penetrations(const Query& query = {}) noexcept {
    return ask<Penetrations>(sc_find_penetrations, nullptr, query);
  }
  Penetrations penetrations(const Body& other, const Query& query = {}) noexcept {
    return ask<Penetrations>(sc_find_penetrations, &other, query);
  }
  Penetrations below(const Ground& ground, const Query& query = {}) noexcept {
    Penetrations out{};
    status_ = sc_find_in_ground(handle_, &ground, &query, &out);
    return out;
  }
  Contacts contacts(const Query& query = {}) noexcept { return ask<Contacts>(sc_find_contacts, nullptr, query); }
  Contacts contacts(const Body& other, const Query& query = {}) noexcept {
    return ask<Contacts>(sc_find_contacts, &other, query);
  }
  SpherePairs sphere_pairs(const Query& query = {}) noexcept {
    SpherePairs out{};
    status_ = sc_find_sphere_pairs(handle_, &query, &out);
    return out;
  }
  Steps steps(const Query& query = {}) noexcept { return ask<Steps>(find_steps, nullptr, query); }
  Steps steps(const Body& other, const Query& query = {}) noexcept { return ask<Steps>(find_steps, &other, query); }
  Status bounds(Vec3& low, Vec3& high) noexcept { return status_ = sc_get_bounds(handle_, &low, &high); }

 private:
  static Status find_steps(sc_body* body, const sc_body* other, const Query* query, Steps* found) noexcept {
    return sc_find_steps(body, other, query, &found->items, &found->count);
  }
  /* `other` null: the body with itself. A body that was not made is refused. */
  template <typename Found, typename Question>
  Found ask(Question question, const Body* other, const Query& query) noexcept {
    Found out{};
    status_ = other != nullptr && !*other
                  ? Status{SC_NULL, SC_FIELD_BODIES}
                  : question(handle_, other == nullptr ? nullptr : other->handle_, &query, &out);
    return out;
  }

  sc_body* handle_ = nullptr;
  Status status_{};
};

}  // namespace spherechain
#endif
