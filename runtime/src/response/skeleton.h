// SPDX-License-Identifier: MIT
// An engine's joints: where they are, and what turning them moves.
#pragma once

#include <cstdint>

#include "runtime/src/base/span.h"
#include "runtime/src/pose/transform.h"

namespace spherechain {

// A turn by the vector v: about v, by twice the arctangent of half its length. It needs no sine, so that it has the
// same bits everywhere; for small angles it is the angle.
Quaternion turn_of(const Double3& v);
Double3 vector_of(const Quaternion& q);
Quaternion product(const Quaternion& a, const Quaternion& b);

Double3 move(const Affine& by, const Double3& point);
Double3 turn(const Affine& by, const Double3& vector);  // without the translation
// False where the matrix has no inverse.
bool invert(const Affine& of, Affine& out);
// The axes of a matrix without its scale: orthonormal, mirrored where it mirrors.
Affine axes_of(const Affine& of);

// From the world's axes to these, which are orthonormal.
Double3 into(const Affine& axes, const Double3& v);

inline Double3 place_of(const Affine& joint) { return {joint.m[0][3], joint.m[1][3], joint.m[2][3]}; }
// Three rows of four.
Affine affine_of_rows(const float* rows);

// A vector as a character's state keeps it.
Double3 load(const float (&from)[3]);
void store(const Double3& from, float (&to)[3]);

inline constexpr Affine kUnmoved{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

struct Skeleton {
  Span<const std::uint32_t> parents;  // SC_NO_JOINT: none
  Span<const std::uint32_t> order;    // parents come first
};

// False where a joint is its own ancestor, or a parent does not exist.
bool sort_joints(Span<const std::uint32_t> parents, Span<std::uint32_t> order);
// The joints in the world.
void place_joints(const Skeleton& skeleton, const sc_transform* locals, const Affine& place, Span<Affine> world);

}  // namespace spherechain
