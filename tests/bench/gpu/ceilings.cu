// SPDX-License-Identifier: MIT
#include "ceilings.h"

namespace spherechain::bench {
namespace {

constexpr int kChains = 16, kSteps = 4096, kThreads = 512, kBlocksEach = 4;

__global__ void multiply_add(float* sink, float factor) {
  float sums[kChains];
  for (int i = 0; i < kChains; ++i) {
    sums[i] = static_cast<float>(threadIdx.x + i);
  }
  for (int step = 0; step < kSteps; ++step) {
#pragma unroll
    for (int i = 0; i < kChains; ++i) {
      sums[i] = __fmaf_rn(sums[i], factor, 1.0F);
    }
  }
  float total = 0;
  for (int i = 0; i < kChains; ++i) {
    total += sums[i];
  }
  if (total == 0.125F) {
    *sink = total;
  }
}

constexpr int kBlockThreads = 512;

__global__ void __launch_bounds__(kBlockThreads)
    deepest_pair(const Sphere* spheres, int sphere_count, const IndexPair* pairs, int pair_count, Deepest* out) {
  extern __shared__ float4 own[];
  const auto* from = reinterpret_cast<const float4*>(spheres) + std::size_t{blockIdx.x} * sphere_count;
  for (int i = threadIdx.x; i < sphere_count; i += kBlockThreads) {
    own[i] = from[i];
  }
  __syncthreads();
  Deepest best{0, 0, 0};
  const int each = (pair_count + kBlockThreads - 1) / kBlockThreads;
  for (int k = 0; k < each; ++k) {
    const int i = each * threadIdx.x + k;
    if (i < pair_count) {
      const IndexPair pair = pairs[i];
      const float4 p = own[pair.a], q = own[pair.b];
      const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
      const float depth = p.w + q.w - sqrtf(dx * dx + dy * dy + dz * dz);
      if (depth > best.depth) {
        best = {depth, pair.a, pair.b};
      }
    }
  }
  const auto better_of = [&](int offset) {
    const float depth = __shfl_down_sync(0xFFFFFFFFU, best.depth, offset);
    const int both = __shfl_down_sync(0xFFFFFFFFU, static_cast<int>(best.a) << 16 | static_cast<int>(best.b), offset);
    if (depth > best.depth) {
      best = {depth, static_cast<std::int16_t>(both >> 16), static_cast<std::int16_t>(both & 0xFFFF)};
    }
  };
  for (int offset = 16; offset > 0; offset /= 2) {
    better_of(offset);
  }
  __shared__ Deepest warps[kBlockThreads / 32];
  if (threadIdx.x % 32 == 0) {
    warps[threadIdx.x / 32] = best;
  }
  __syncthreads();
  if (threadIdx.x < 32) {
    best = threadIdx.x < kBlockThreads / 32 ? warps[threadIdx.x] : Deepest{0, 0, 0};
    for (int offset = 8; offset > 0; offset /= 2) {
      better_of(offset);
    }
    if (threadIdx.x == 0) {
      out[blockIdx.x] = best;
    }
  }
}

}  // namespace

double enqueue_multiply_adds(int multiprocessors, float* sink) {
  const int blocks = multiprocessors * kBlocksEach;
  multiply_add<<<blocks, kThreads>>>(sink, 0.999F);
  return 1.0 * kChains * kSteps * kThreads * blocks;
}

void enqueue_block_a_character(const Sphere* spheres, std::size_t sphere_count, std::size_t instance_count,
                               const IndexPair* pairs, std::size_t pair_count, Deepest* out) {
  deepest_pair<<<static_cast<unsigned>(instance_count), kBlockThreads, sphere_count * sizeof(float4)>>>(
      spheres, static_cast<int>(sphere_count), pairs, static_cast<int>(pair_count), out);
}

}  // namespace spherechain::bench
