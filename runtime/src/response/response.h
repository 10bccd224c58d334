// SPDX-License-Identifier: MIT
// A response: what it knows of the character before the first frame, what a state keeps, and the memory of one frame.
#pragma once

#include <cmath>

#include "runtime/src/bodies/body.h"
#include "runtime/src/gaps/gaps.h"
#include "runtime/src/response/skeleton.h"
#include "spherechain/response.h"

namespace spherechain {

inline constexpr std::size_t kTurningMost = 16, kRowsMost = 32, kOthersMost = 8, kAheadMost = 3;
inline constexpr std::size_t kPlantedMost = 4;
inline constexpr std::size_t kGapsMost = 4;  // of the character with itself, and with each other body

// A joint that turns.
struct TurningJoint {
  std::uint32_t joint;
  double mobility, budget;  // the budget as turn_of() takes it
  // An arm has a joint at its end, an elbow one above and one below it; else SC_NO_JOINT.
  std::uint32_t wrist = SC_NO_JOINT, above = SC_NO_JOINT, below = SC_NO_JOINT;
  Double3 hinge{0, 0, 0};  // given, or of an elbow at rest, in the axes of the joint's parent; zero: not known
  bool is_given = false;   // the hinge
};

// Two spots, each in the space of what moves it: the part's joint, the other's joint or bone, or the world.
struct KeptRow {
  std::uint16_t part, other, body;
  std::uint16_t is_clear;               // 1: the two do not meet, they are near each other
  float at[3], at_other[3], normal[3];  // the normal is in the other's space
  float allowed;
  float unseen;  // seconds
};

inline bool is_finite(const float (&v)[3]) { return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]); }

// A character's state, as its words keep it.
struct State {
  std::uint32_t has_begun, row_count;
  float turns[kTurningMost][3];                 // of the last frame, or of the one that is ahead
  float past[2 * kAheadMost][kTurningMost][3];  // of the frames before, the last first
  std::uint32_t past_count;
  KeptRow rows[kRowsMost];
};

// A row in the pose of this round.
struct Row {
  KeptRow kept;
  Double3 at, at_other, normal;
  double gap, slide;            // along the normal, and across it
  double wanted;                // the gap that it is to have
  double pull;                  // the solver's, >= 0
  Double3 opens[kTurningMost];  // how a turn of each joint opens it
  Double3 turns[kTurningMost];  // how a pull turns each joint
};

}  // namespace spherechain

struct sc_response {
  sc_body* body;
  sc_allocator allocator;
  spherechain::Block block;  // this, and what the pointers below point into
  sc_rule rule;
  double height;  // in the pose
  spherechain::Span<std::uint32_t> parents, order;
  spherechain::Span<std::uint32_t> joint_of_part;              // SC_NO_JOINT where none moves it
  spherechain::Span<std::uint32_t> turning_of_part;            // a bit for each turning joint that moves it
  spherechain::Span<std::uint64_t> part_pairs, resting_parts;  // that are kept apart; that no joint turns
  spherechain::Span<std::uint64_t> apart_pairs;                // of this round: those that do not meet, as of a GapJob
  spherechain::TurningJoint turning[spherechain::kTurningMost];
  std::uint32_t turning_count;
  // This is of the frame:
  spherechain::Affine place;
  std::uint32_t planted[spherechain::kPlantedMost], planted_count;
  spherechain::Span<sc_transform> joints;                  // with the turns of this round
  spherechain::Span<spherechain::Affine> animated, world;  // of joints: without turns, and with those of this round
  spherechain::Span<float> bones;                          // in the asset's order
  spherechain::Row rows[spherechain::kRowsMost];
  std::uint32_t row_count;
  double fault_depth;  // of all that was found in this round
  sc_penetration previous[spherechain::kRowsMost];
  sc_contact_row listed[spherechain::kRowsMost];
};

namespace spherechain {
static_assert(sizeof(State) <= SC_RESPONSE_WORDS * sizeof(std::uint64_t));
}  // namespace spherechain
