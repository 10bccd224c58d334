// SPDX-License-Identifier: MIT
// Where does a skin intersect itself, or another skin? The answers are exact: all triangles that intersect, and no
// other.
//
// A job allocates nothing and takes no lock. Jobs on other outputs and scratch memory may run at the same time. Scratch
// memory keeps nothing between runs. Lists are sorted and have each entry once; a null list is counted only. Counts say
// how many there are, also where a list is too small.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/filter.h"
#include "runtime/src/skin/job_body.h"
#include "spherechain/contacts.h"

namespace spherechain {

constexpr bool is_known(Scope scope) { return scope >= SC_SCOPE_APART && scope <= SC_SCOPE_LAYERS; }
constexpr bool has_neighbours(Scope scope) { return scope == SC_SCOPE_NEIGHBOURS || scope == SC_SCOPE_ALL; }

// The part that both contact jobs have: how they are asked, and their lists.
struct ContactJob {
  Target target{};
  std::int32_t spheres_only = 0;  // 1: finds pairs of spheres alone, each until its first contact
  // A bit for each two parts that are asked about; null: all are. Parts a <= b of one body with n parts have bit
  // a n + b - a (a + 1) / 2. Parts a and b of two bodies have bit a n + b, where the second body has n parts.
  const std::uint64_t* part_pairs = nullptr;
  std::uint64_t* scratch = nullptr;  // skin_scratch_words() words, or body_scratch_words()
  std::size_t scratch_words = 0;
  // Out. With spheres_only there are no parts and no triangles. Triangles that are not listed cost less.
  PartContact* parts = nullptr;
  std::size_t part_capacity = 0;
  Pair* spheres = nullptr;  // a = b: within one sphere's triangles
  std::size_t sphere_capacity = 0;
  TriangleContact* triangles = nullptr;
  std::size_t triangle_capacity = 0;
  std::size_t part_count = 0, sphere_count = 0, triangle_count = 0;
};

// The skin is where the vertices put it; without vertices the job skins what it needs from the bones. With both, the
// bones bound the search, and each vertex must be where its bone weights put it, up to rounding; else give vertices
// alone (docs/arithmetic.md). A position that is not finite intersects nothing; matrices that are not finite may lose
// contacts.
//
// Left out are triangles that share a position at rest (neighbours), triangles that intersect in the rest pose, and
// ignored pairs.
struct SkinContactJob : ContactJob {
  const Asset* asset = nullptr;  // open, with triangles
  Pose pose;
  Scope scope{};
  const std::uint64_t* skin_table = nullptr;  // from prepare_skin(), of this asset
  const Filter* filter = nullptr;             // null: the asset's ignored pairs
  // Null, or: only these pairs of spheres, ignored or not, a <= b; a = b: within one sphere's triangles. Sorted, each
  // once. Then scope and filter must be zero.
  const Pair* candidates = nullptr;
  std::size_t candidate_count = 0;

  // SC_OK; SC_OVERFLOW: the first entries of the sorted lists are written; after another error nothing is.
  Status run() noexcept;
};

// In what it lists, `_a` and the first index are of body a, `_b` and the second of body b: nothing is swapped. Nothing
// is left out but the parts that the bodies ignore. Errors are those of a SkinContactJob.
struct BodyContactJob : ContactJob {
  JobBody a, b;

  Status run() noexcept;
};

// Words of scratch memory; 0 where an asset is not open or has no triangles.
std::size_t skin_scratch_words(const Asset* asset) noexcept;
std::size_t body_scratch_words(const Asset* a, const Asset* b) noexcept;
// The same for open assets.
std::size_t skin_scratch_words(const AssetView& asset);
std::size_t body_scratch_words(const AssetView& a, const AssetView& b);

// A box that holds all of the body's skin for certain: from bones somewhat too large, without reading a vertex; from
// vertices alone exact. Reads asset, pose and skin_table.
Status bound_body(const JobBody& body, Vec3& low, Vec3& high) noexcept;

}  // namespace spherechain
