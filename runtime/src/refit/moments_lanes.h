// SPDX-License-Identifier: MIT
// What the kernels of refit by moments have in common. Compiled once a target.
#include "simd/highway.h"

#if defined(SPHERECHAIN_REFIT_MOMENTS_LANES_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_REFIT_MOMENTS_LANES_H
#undef SPHERECHAIN_REFIT_MOMENTS_LANES_H
#else
#define SPHERECHAIN_REFIT_MOMENTS_LANES_H
#endif

#include "refit/inputs.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace moments {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes16 = hn::CappedTag<float, kMomentSize>;
using Lanes4 = hn::CappedTag<float, 4>;
using Vector = hn::Vec<Lanes16>;
constexpr std::size_t kLanes = hn::MaxLanes(Lanes16());
constexpr std::size_t kParts = kMomentSize / kLanes;
constexpr std::size_t kChunk = 4;        // spheres finished together
constexpr std::size_t kSums = 32;        // spheres whose sums are kept: finished at once, none waits for its own sums
constexpr std::size_t kKeptBones = 256;  // an asset of more has its matrices moved wherever they are read

// A bone's matrix by rows of four, seen from the origin and the reference bone; and a fourth row, which no sum that is
// used reads.
struct Moved {
  HWY_ALIGN float rows[kMomentSize];
};

// Of spheres each: the centre's three rows of four columns, and the sixteen of its squared spread.
struct Sums {
  HWY_ALIGN float centers[kSums][kMomentSize];
  HWY_ALIGN float squares[kSums][kMomentSize];
  HWY_ALIGN float wanted[kSums];
};

// Where in the tables a sphere's figures start.
struct Place {
  const std::uint16_t* bones;
  const CenterTerm* centers;
  const std::uint8_t* pair_places;
  const Moment* moments;
};

}  // namespace moments
}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif
