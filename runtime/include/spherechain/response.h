/* SPDX-License-Identifier: MIT */
/* Collision response: keeps hands and arms out of the body while the game runs. */
#pragma once

#include "spherechain/body.h"

/* Joint rotations in, corrected joint rotations out. A response asks a body, whose pose it sets; both serve one
 * character or many of their model in turn, each with a state of its own. Memory is allocated when it is made. One
 * thread at a time may use a response and its body. */
typedef struct sc_response sc_response;

/* Joints are those of sc_model_def.joints, or the asset's bones where it had none. */
typedef struct sc_response_def {
  uint32_t struct_size SC_SIZE_OF(sc_response_def);
  const uint32_t* parents SC_ZERO; /* of each joint, before or after it; SC_NO_JOINT: none. Required */
  size_t joint_count SC_ZERO;
  /* How easily each joint turns, from 0, never, to 1; at most 16 may turn. Null: the joints of upper arms and forearms
   * 1, of hands 0.3, others 0. */
  const float* mobility SC_ZERO;
  const float* budget SC_ZERO; /* the most that each joint is turned, in radians, up to 2; null: 1.05, 60 degrees */
  /* The axis about which each joint bends, in its parent's space, of any length: it hardly turns about others. Zeros:
   * about all axes alike. Null: elbows bend as they are bent at rest and in the pose. */
  const sc_vec3* hinges SC_ZERO;
  /* The pairs of body parts that are kept apart, as of sc_query. Null: those that a turn can move against each other,
   * unless one hangs on the other, or both are held by hands. */
  const uint64_t* part_pairs SC_ZERO;
  const sc_rule* rule SC_ZERO;           /* null: sc_default_rule() */
  const sc_allocator* allocator SC_ZERO; /* copied; null: the body's */
} sc_response_def;

/* A character's state, what its response remembers of the frames before, is so many 64-bit words of the caller's.
 * Zeros: nothing. Set it so at first, and where the animation cuts or the character is moved elsewhere. A copy replays
 * the same, on every machine. Any words are safe to pass; those that make no sense are forgotten. */
#define SC_RESPONSE_WORDS 480

/* Two spots that are to stay apart: of parts that meet, or met within half a second, and of parts that come within 8 mm
 * of each other on a human, unless these spots are within 14 mm at rest. The latter are listed where a joint is turned
 * or has to be, and where `weakness` is 1; never of the ground. Any solver can use it: if a joint at o turns by the
 * small vector w (the world's axes, radians), the gap grows by w . ((at - o) x normal) if the joint moves `part`, and
 * shrinks by w . ((at_other - o) x normal) if it moves `other`. */
typedef struct sc_contact_row {
  uint32_t part, other; /* the more mobile one first, where one is */
  uint32_t body;        /* 0: the character's own; k: other is a part of others[k - 1], or SC_FLOOR */
  sc_vec3 at, at_other; /* on the skin of each, in the world */
  sc_vec3 normal;       /* from `other` to `part`, of unit length */
  float gap;            /* their distance along `normal`; negative: so deep. The pose's units, as `allowed` is */
  float allowed;        /* how deep they may be before it is a fault; 0 of parts that have not met */
} sc_contact_row;

typedef struct sc_response_frame {
  uint32_t struct_size SC_SIZE_OF(sc_response_frame);
  /* Where each joint is in its parent's space. The rotations of those that turn are replaced; the rest stays as it is.
   */
  sc_transform* joints SC_ZERO;
  const sc_transform* place SC_ZERO;  /* of the roots in the world; null: the identity */
  const float* morph_weights SC_ZERO; /* as of sc_pose */
  size_t morph_weight_count SC_ZERO;
  float seconds SC_ZERO;  /* since the last frame; 0 is a pause, in which nothing turns on; more than 1 is 1 */
  float weakness SC_ZERO; /* from 0, the full response, to 1, none: to fade it, or for the rows alone */
  /* The most times that contacts are looked for; 0: 3; 16 at most. The first frame of a state takes twice as many. */
  uint32_t rounds SC_ZERO;
  /* Null, or where the joints will be `ahead_frames` later, from 1 to 3: the response then sets in before the contact.
   * Give it in every frame of a state, or in none. */
  const sc_transform* ahead SC_ZERO;
  uint32_t ahead_frames SC_ZERO;
  const sc_body* const* others SC_ZERO; /* other characters and props, as posed now; at most 8, always in this order */
  size_t other_count SC_ZERO;
  const sc_ground* ground SC_ZERO; /* null: none */
  /* Joints that stay where they are animated, a hand on a table: at most 4, and only as well as the joints above them
   * can hold them there. Joints that turn themselves keep their direction, too. */
  const uint32_t* planted SC_ZERO;
  size_t planted_count SC_ZERO;
  sc_target target SC_ZERO; /* the same answers on every one */
  /* out */
  uint32_t turned SC_ZERO;            /* how many joints were turned; 0: `joints` is as it was, bit for bit */
  uint32_t at_budget SC_ZERO;         /* how many were not turned as far as wanted */
  float remaining SC_ZERO;            /* the sum of sc_penetration.fault_depth that is left, as far as it is known */
  const sc_contact_row* rows SC_ZERO; /* in the corrected pose; valid until the next call */
  size_t row_count SC_ZERO;
} sc_response_frame;

#if defined(__cplusplus)
extern "C" {
#endif

/* The body must outlive the response. On failure *response is null: SC_NULL, SC_NO_MEMORY; SC_BAD_VALUE with
 * SC_FIELD_PARENTS: a parent does not exist, or is below its child; SC_BAD_VALUE with SC_FIELD_JOINTS: a mobility or
 * budget is out of range, a hinge is not finite, or more than 16 joints turn; SC_TOO_SMALL with SC_FIELD_JOINTS: fewer
 * joints than the model has. */
SPHERECHAIN_API sc_status sc_create_response(sc_body* body, const sc_response_def* def,
                                             sc_response** response) SC_NOEXCEPT;
SPHERECHAIN_API void sc_destroy_response(sc_response* response) SC_NOEXCEPT; /* null is fine */

/* One frame. Where nothing is near and the state is empty, all stays as it is, bit for bit. No joint turns beyond its
 * budget, or away from its animation by more than 8 radians a second; the first frame of a state knows its budget
 * alone. A bent elbow does not bend backward. The faults that are found are not deeper in sum than the animation's;
 * with `ahead` this is not checked. Faults can be left: the response does not turn trunk and legs, and tight places
 * have no way out.
 *
 * SC_OK; SC_NULL, SC_BAD_VALUE (with SC_FIELD_TRANSFORM: a transform is not finite; with SC_FIELD_JOINTS: a planted
 * joint does not exist, or they are too many), or a status of the questions: then joints and state are as they were.
 * After SC_OK the body is in the corrected pose. */
SPHERECHAIN_API sc_status sc_respond(sc_response* response, uint64_t* state, sc_response_frame* frame) SC_NOEXCEPT;

#if defined(__cplusplus)
}

namespace spherechain {

using ResponseDef = sc_response_def;
using ResponseFrame = sc_response_frame;
using ContactRow = sc_contact_row;

struct ResponseState {
  uint64_t words[SC_RESPONSE_WORDS] = {};
};

/* Owns an sc_response. It moves, and does not copy. One that was not made converts to false. */
class Response {
 public:
  Response() = default;
  Response(Body& body, const ResponseDef& def) noexcept { status_ = sc_create_response(body.handle(), &def, &handle_); }
  Response(Response&& other) noexcept { *this = static_cast<Response&&>(other); }
  Response& operator=(Response&& other) noexcept {
    sc_response* const own = handle_;
    handle_ = other.handle_;
    other.handle_ = own;
    status_ = other.status_;
    return *this;
  }
  ~Response() { sc_destroy_response(handle_); }

  explicit operator bool() const noexcept { return handle_ != nullptr; }
  Status status() const noexcept { return status_; } /* of the last call */
  Status respond(ResponseState& state, ResponseFrame& frame) noexcept {
    return status_ = sc_respond(handle_, state.words, &frame);
  }

 private:
  sc_response* handle_ = nullptr;
  Status status_{};
};

}  // namespace spherechain
#endif
