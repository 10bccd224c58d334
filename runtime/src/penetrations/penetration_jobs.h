// SPDX-License-Identifier: MIT
// How deep are contacts, which way out, and which class? How deep is a body in the ground?
#pragma once

#include "runtime/src/contacts/contact_jobs.h"
#include "spherechain/rule.h"

namespace spherechain {

// The part that both jobs have which measure contacts.
struct MeasureJob {
  Target target{};
  const TriangleContact* contacts = nullptr;  // null: none
  std::size_t contact_count = 0;
  const Penetration* previous = nullptr;  // null: none; may not overlap `penetrations`
  std::size_t previous_count = 0;
  // 1: along one direction, without volume and visibility, but for likely faults: these are measured in full, so that
  // both forms find the same faults.
  std::int32_t quick = 0;
  // 1, with `quick`: a likely fault with a direction in `previous` is measured along it, where that is no detour. Where
  // no depth is a fault, nothing is measured, and the class is SC_CLASS_REST.
  std::int32_t along = 0;
  const Rule* rule = nullptr;  // null: sc_default_rule()
  // The part that holds each probe, as find_inside() says it, for the body or for both; null: not known.
  const std::uint16_t* inside_a = nullptr;
  const std::uint16_t* inside_b = nullptr;
  // 1: also parts that are inside another which they have no contact with: not those in `met`, all pairs of parts that
  // have contacts, nor those that `part_pairs`, as of a contact job, leaves out.
  std::int32_t adds_enclosed = 0;
  const PartContact* met = nullptr;
  std::size_t met_count = 0;
  const std::uint64_t* part_pairs = nullptr;
  std::uint64_t* scratch = nullptr;  // penetration_scratch_words() words, or body_penetration_scratch_words()
  std::size_t scratch_words = 0;
  Penetration* penetrations = nullptr;  // out: sorted by the two parts, the lesser number first; null: count only
  std::size_t penetration_capacity = 0;
  // Bit k: penetrations of class k are listed and counted; 0: all. A job that only counts counts all.
  std::uint32_t classes = 0;
  std::size_t kept_count = 0;  // in: entries that the list has already, of other contacts; they are counted, too
  std::size_t penetration_count = 0;
};

// Measures the contacts of one pose. Fill asset, pose, scope, filter and skin_table as in the SkinContactJob that found
// `contacts`, and pass its whole list of triangles. Classes compare with the character's height: the asset's, times the
// scale of the root's bone (the first part that hangs on none), where the pose has bones. Deformed vertices alone must
// have the asset's scale.
//
// Depth is the shortest of the ways along several directions; a straight way may exist that is a little shorter. With
// the last frame's results as `previous`, a fault keeps its direction while that way is at most 1.5 times the shortest,
// so that arrows do not flicker. Depth and class do not depend on it.
struct PenetrationJob : MeasureJob {
  const Asset* asset = nullptr;  // open, with triangles
  Pose pose;
  Scope scope{};
  const std::uint64_t* skin_table = nullptr;
  const Filter* filter = nullptr;

  // SC_OK; SC_OVERFLOW: the worst entries are written; after another error nothing is. SC_BAD_VALUE also: a contact
  // names a triangle that is not in the asset's skin.
  Status run() noexcept;
};

// Measures two bodies' contacts, those of the BodyContactJob with the same a and b. `part` is of body a, `other` of
// body b. Classes are SC_CLASS_SHELL (most of it is hidden), SC_CLASS_TOUCH and SC_CLASS_PENETRATION. They compare with
// the unit and the height of body a's asset: of a character and a prop, a is the character. Errors are those of a
// PenetrationJob.
struct BodyPenetrationJob : MeasureJob {
  JobBody a, b;  // ignored_parts is not read

  Status run() noexcept;
};

// The body parts with a vertex below the ground, and how deep it is straight down. `other` is SC_FLOOR; the direction
// is `up`; `volume` is of the part below the ground, known where its skin does not end there; the box is around that
// part. Classes are SC_CLASS_TOUCH and SC_CLASS_PENETRATION. SC_BAD_VALUE with SC_FIELD_FLOOR: `up` or `height` is
// none.
struct FloorJob {
  JobBody body;
  Target target{};
  Vec3 up{};         // of unit length
  float height = 0;  // of the plane: up . p = height on it
  // Null, or: how far the ground is above the plane at p; called for each vertex of the skin, in no certain order.
  float (*terrain)(const void* user, Vec3 p) = nullptr;
  const void* user = nullptr;
  const Rule* rule = nullptr;
  std::uint64_t* scratch = nullptr;  // floor_scratch_words() words
  std::size_t scratch_words = 0;
  Penetration* penetrations = nullptr;  // out: sorted by `part`; null, with a capacity of 0: count only
  std::size_t penetration_capacity = 0;
  std::uint32_t classes = 0;
  std::size_t penetration_count = 0;

  Status run() noexcept;
};

// Words of scratch memory, for so many contacts; 0 where an asset is not open or has no triangles.
std::size_t penetration_scratch_words(const Asset* asset, std::size_t contact_count) noexcept;
std::size_t body_penetration_scratch_words(const Asset* a, const Asset* b, std::size_t contact_count) noexcept;
std::size_t floor_scratch_words(const Asset* asset) noexcept;

}  // namespace spherechain
