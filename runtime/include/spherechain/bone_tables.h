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
// terms and a term's morph terms one after another.
struct BoneTables {
  Span<const PivotLanes> weights;         // a group's: the pivots' shares of the centre
  Span<const std::uint32_t> term_counts;  // a group's; >= 1
  Span<const std::uint32_t> term_bones;   // a term's, ascending in a group
  Span<const BoneTerm> terms;
  Span<const std::uint32_t> morph_term_counts;  // a term's; empty where there are no morph terms
  Span<const std::uint32_t> morph_targets;      // a morph term's, ascending in a term
  Span<const MorphTerm> morph_terms;
};

}  // namespace spherechain
