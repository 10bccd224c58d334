// SPDX-License-Identifier: GPL-3.0-or-later
#include "port_probe.h"

// The runtime's own choice of targets, so that the probe's vectors are those of its kernels.
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "port_probe.cpp"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

float multiply_adds(std::size_t steps) {
  const hn::ScalableTag<float> d;
  // Converges to 1: neither denormal nor infinite.
  const auto factor = hn::Set(d, 0.5F), summand = hn::Set(d, 0.5F);
  auto c0 = hn::Iota(d, 0.0F), c1 = hn::Iota(d, 1.0F), c2 = hn::Iota(d, 2.0F), c3 = hn::Iota(d, 3.0F);
  auto c4 = hn::Iota(d, 4.0F), c5 = hn::Iota(d, 5.0F), c6 = hn::Iota(d, 6.0F), c7 = hn::Iota(d, 7.0F);
  auto c8 = hn::Iota(d, 8.0F), c9 = hn::Iota(d, 9.0F), c10 = hn::Iota(d, 10.0F), c11 = hn::Iota(d, 11.0F);
  for (std::size_t i = 0; i < steps; ++i) {
    c0 = hn::MulAdd(c0, factor, summand);
    c1 = hn::MulAdd(c1, factor, summand);
    c2 = hn::MulAdd(c2, factor, summand);
    c3 = hn::MulAdd(c3, factor, summand);
    c4 = hn::MulAdd(c4, factor, summand);
    c5 = hn::MulAdd(c5, factor, summand);
    c6 = hn::MulAdd(c6, factor, summand);
    c7 = hn::MulAdd(c7, factor, summand);
    c8 = hn::MulAdd(c8, factor, summand);
    c9 = hn::MulAdd(c9, factor, summand);
    c10 = hn::MulAdd(c10, factor, summand);
    c11 = hn::MulAdd(c11, factor, summand);
  }
  const auto sum =
      hn::Add(hn::Add(hn::Add(c0, c1), hn::Add(c2, c3)),
              hn::Add(hn::Add(hn::Add(c4, c5), hn::Add(c6, c7)), hn::Add(hn::Add(c8, c9), hn::Add(c10, c11))));
  return hn::GetLane(sum);
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(multiply_adds);

}  // namespace

float bench::run_multiply_adds(Target resolved, std::size_t steps) {
  return multiply_adds_kernels[index_of(resolved)](steps);
}

}  // namespace spherechain
#endif
