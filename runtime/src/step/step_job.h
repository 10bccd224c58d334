// SPDX-License-Identifier: MIT
// Finds the body parts that touch on the way from one pose to the next, and when.
#pragma once

#include "runtime/src/contacts/contact_jobs.h"

namespace spherechain {

// How a body goes from one pose to the next.
enum Blend : std::int32_t {
  SC_BLEND_LINEAR = 0,  // matrices, vertices and morph weights: each number on its own
  SC_BLEND_SLERP = 1,   // joints: rotations at constant speed; translations, scales and morph weights linearly
  SC_BLEND_NLERP = 2,   // joints: rotations as quaternions, linearly, brought back to unit length
};

// A body, and where it stands a step later. `ignored_parts` applies to two bodies only.
//
// SC_BLEND_LINEAR: from body.pose to `end`, both with bones, or both with vertices.
// SC_BLEND_SLERP, SC_BLEND_NLERP: from start_joints to end_joints, each in its parent's space, composed down the
// skeleton as engines do; poses have morph weights at most, no bones and no vertices. The bone b of the asset gets the
// world matrix of its joint times the asset's inverse bind matrix (sc_asset_bone()). Joints that move no bone are fine.
// A bone without a joint stays at rest. Rotations take the shorter way. A joint that turns by half a turn or more in
// one step is therefore misread: use smaller steps. At exactly half a turn the signs of the quaternions decide.
struct Motion {
  JobBody body;
  Pose end;
  Blend blend{};
  const Transform* start_joints = nullptr;
  const Transform* end_joints = nullptr;
  std::size_t joint_count = 0;             // at most 65536
  const std::uint32_t* parents = nullptr;  // of a joint an earlier one, or SC_NO_JOINT; null: of all SC_NO_JOINT
  const std::uint32_t* joint_of_bone =
      nullptr;  // of each bone of the asset: sc_bind_joints(); null: joint b moves bone b
};

// Finds the pairs of body parts that touch on the way from one pose to the next: of body a with itself if b.body.asset
// is null, else of a with b. Finds every contact deeper than `tolerance`, and reports none that does not exist.
// Contacts shallower than `tolerance` may be missed. Times are accurate to the same distance. Distances are changes of
// the distance between two corners of the skin. The tolerance grows when two corners move by more than 32768 tolerances
// (about three heights) relative to each other in one step. The pairs that a SkinContactJob or a BodyContactJob ignores
// are ignored here, too. Matrices and vertices that are not finite touch nothing.
struct StepJob {
  Motion a, b;
  Target target{};
  const Filter* filter = nullptr;    // of one body; null: the asset's ignored pairs
  float tolerance = 0;               // a share of the height of a's asset; 0: 0.0001
  std::uint64_t* scratch = nullptr;  // step_scratch_words() words
  std::size_t scratch_words = 0;
  // Out: sorted by (part_a, part_b), each once; null: count only. One body of n parts has at most n (n + 1) / 2
  // contacts; two bodies of n and m parts have at most n m.
  StepContact* contacts = nullptr;
  std::size_t contact_capacity = 0;
  std::size_t contact_count = 0;

  // As a BodyContactJob; and SC_BAD_VALUE: SC_FIELD_END (vertices at one end alone), SC_FIELD_BLEND, SC_FIELD_JOINTS
  // (not finite, a quaternion of length zero, a pose with bones or vertices beside them; or a step so wild that the
  // skin may be 256 heights off straight lines), SC_FIELD_MORPH_WEIGHTS (as wild, or not finite), SC_FIELD_PARENTS,
  // SC_FIELD_TOLERANCE (not finite, negative, above 1).
  Status run() noexcept;
};

// Words of scratch memory for those assets and numbers of joints; b null: one body. Each of two bodies needs more where
// it has vertices. 0 where an asset is not open or has no triangles, or there are too many joints.
std::size_t step_scratch_words(const Motion* a, const Motion* b) noexcept;

}  // namespace spherechain
