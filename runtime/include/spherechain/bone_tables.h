// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kPivotLanes = 8;

// One figure for each of eight pivots of a sphere. Spare lanes are 0.
struct PivotLanes {
  float values[kPivotLanes];
};

// What a bone adds to eight pivots: M (x, y, z, w), M the bone's skinning matrix.
struct BoneTerm {
  float x[kPivotLanes], y[kPivotLanes], z[kPivotLanes], w[kPivotLanes];
};

// What a morph target of weight 1 adds to x, y, z of a bone's term.
struct MorphTerm {
  float x[kPivotLanes], y[kPivotLanes], z[kPivotLanes];
};

// What refit from bones reads, for those who write it anew for another machine; see RefitBonesJob for the arithmetic.
// A sphere's pivots come in groups of eight, the last filled up with spare lanes; groups are in sphere order, a group's
// terms and a term's morph terms one after another. Asset::bone_tables() says where there are none.
struct BoneTables {
  Span<const PivotLanes> weights;         // a group's: the pivots' shares of the centre
  Span<const std::uint32_t> term_counts;  // a group's; >= 1
  Span<const std::uint32_t> term_bones;   // a term's, ascending in a group
  Span<const BoneTerm> terms;
  Span<const std::uint32_t> morph_term_counts;  // a term's; empty where there are no morph terms
  Span<const std::uint32_t> morph_targets;      // a morph term's, ascending in a term
  Span<const MorphTerm> morph_terms;
};

inline constexpr std::size_t kMomentSize = 16;
inline constexpr std::size_t kMaxMomentBones = 22;   // of a sphere
inline constexpr std::size_t kMaxMomentPairs = 256;  // of a batch

// Under RefitRule::kMoments a figure of a bone's matrix that is nearer to 0 than this counts for 0 (RefitBonesJob):
// matrices of bones that stand still have such rounding errors beside their ones, and a product of two can be too small
// for a normal float, which costs processors some 150 cycles.
inline constexpr float kLeastMatrixFigure = 0x1p-62F;

// Two bones that move pivots of one sphere, or one twice; a <= b < Asset::bone_count().
struct BonePair {
  std::uint16_t a, b;
};

// What a pair of bones adds to a sphere's mean squared distance of its pivots from the refitted centre, in units of
// that at rest: the sum of values[4 r + c] times row r, column c of the pair's Gram matrix (RefitBonesJob).
// A bone's own Gram matrix is symmetric: bakers since 2026-11-23 leave its moment 0 below the diagonal.
struct Moment {
  float values[kMomentSize];
};

// What a bone adds to a sphere's centre: its matrix times (x, y, z, w). The positions in it are relative to
// MomentTables::origin, in source units; the w of a sphere add up to 1.
struct CenterTerm {
  float x, y, z, w;
};

struct MomentBatch {
  std::uint32_t pair_count, sphere_count;  // pair_count <= kMaxMomentPairs
};

// What refit from bones reads under RefitRule::kMoments in place of BoneTables, for those who write it anew for another
// machine; see RefitBonesJob for the arithmetic. A sphere of n bones b0 < b1 < ... has the n (n + 1) / 2 pairs (b0,
// b0), (b0, b1) ..., (b1, b1), (b1, b2) ..., in that order.
struct MomentTables {
  Vec3 origin{};                         // rest pose, source units: what bones' matrices are taken relative to
  std::uint32_t reference = 0;           // the bone whose image of the origin distances and centres are taken from
  Span<const MomentBatch> batches;       // of pairs and spheres, one batch's after another's
  Span<const BonePair> pairs;            // sorted by (a, b) in a batch, each once in it
  Span<const std::uint32_t> spheres;     // each of Asset::spheres() once; those of equal bones side by side in a batch
  Span<const std::uint8_t> bone_counts;  // of spheres[i]; 1 to kMaxMomentBones
  Span<const std::uint16_t> bones;       // of each of those spheres; ascending in a sphere
  Span<const CenterTerm> centers;        // of each of those bones
  Span<const std::uint8_t> pair_places;  // of each of a sphere's pairs: its place among its batch's pairs
  Span<const Moment> moments;            // of each of those; 64-byte aligned where the asset's bytes are
  bool own_are_upper = false;            // whether each bone's own moments are 0 below the diagonal
};

}  // namespace spherechain
