// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "spherechain/abi.h"
#include "spherechain/asset.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// Which vertices a buffer holds: all of the source's, or only Asset::pivot_vertices(), in that order, for who skins no
// more than those.
enum class VertexSet : std::uint8_t { kSource = 0, kPivots = 1 };

// Moves the spheres with the deformed skin: new centre and radius from the pivots' current positions (the paper's
// section 5.1). With p_k the centroid of pivot k's corners and w_k its weight:
//   centre = sum_k w_k p_k
//   radius = mean_k |p_k - centre|                             refit rule kPaper
//   radius = rest radius * mean_k |p_k - centre| / pivot_spread   refit rule kCalibrated: exact at rest
//   radius = rest radius * sqrt(mean_k |p_k - centre|^2) / pivot_spread   refit rule kMoments: exact at rest
// kDetect scales that radius by the sphere's rest ratio detect_radius / radius.
//
// The arithmetic is fixed, in single precision without contraction, so that every backend gives the same spheres, bit
// for bit: p_k = ((a + b) + c) * (1.0f / 3); the sums over k start at 0 and run in pivot order; |d| = sqrt((dx*dx +
// dy*dy) + dz*dz); mean = sum / float(K); radius = mean, or mean * (detect_radius / radius), under kPaper, and radius
// or detect_radius, times (mean / pivot_spread), under kCalibrated. Under kMoments the sum is of (dx*dx + dy*dy) +
// dz*dz itself, and sqrt(mean) stands where kCalibrated has the mean.
//
// A game that holds the character in several vertex buffers copies them into one, each from its
// Asset::source_parts() entry's first_vertex on; check_source_part() tells whether it is the right one.
//
// Fill in the fields and call run(). Allocates nothing, takes no lock; jobs on other buffers may run at the same time.
struct SPHERECHAIN_API RefitJob {
  const Asset* asset = nullptr;      // open
  const float* positions = nullptr;  // x, y, z of each vertex of the set, in any space with the asset's scale
  std::size_t vertex_count = 0;      // at least info().source_vertex_count, or pivot_vertices().size
  std::size_t stride = 12;           // bytes from one position to the next; a multiple of 4, at least 12
  VertexSet vertices = VertexSet::kSource;
  RadiusKind radius = RadiusKind::kDetect;
  Span<Sphere> spheres;  // out: at least asset->spheres().size; further entries are left alone

  // kOk, kNullArgument, kNotOpen, kTooFewVertices, kTooFewSpheres, kBadStride, kBadArgument or, for kPivots,
  // kNotInAsset, kMisaligned, kSharedMemory; nothing is written unless kOk. Positions that are not finite give spheres
  // that are not finite, and those touch nothing.
  Status run() const noexcept;
};

}  // namespace spherechain
