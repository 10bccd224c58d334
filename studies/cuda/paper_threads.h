// SPDX-License-Identifier: MIT
// The overlap tests of the paper's section 5.2 as it ran them on a GPU, thread by thread: each sphere against every
// other, of the mesh or of a chain. Compiled for the device, and by any C++ compiler for the tests, which run one
// thread after the other. Spheres, pairs and arithmetic are those of PlainDetection.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cstdint>
#include <vector>

#include "studies/plain_detection.h"

#if defined(__CUDACC__)
#define SPHERECHAIN_PAPER_BODY __host__ __device__ inline
#else
#define SPHERECHAIN_PAPER_BODY inline
#endif

namespace spherechain::cuda_paper {

// One character, all of it in the memory of who runs the threads.
struct Scene {
  const Sphere* spheres;
  std::uint32_t sphere_count;
  const std::uint32_t* chain_begin;  // chain_count + 1 places in `members`
  std::uint32_t chain_count;
  const std::uint32_t* members;  // the chains' spheres, chain after chain
  const std::uint64_t* ignored;  // as AssetView::ignored()
  const RestPair* rest_pairs;    // sorted
  std::uint32_t rest_pair_count;
};

// The asset's tables that the threads read, in the host's memory. The open asset must outlive them.
struct Tables {
  Tables(const AssetView& asset_, Radius radius)
      : asset(&asset_), rest_pairs(asset_.rest_pairs(radius)), chain_begin{0} {
    for (std::size_t c = 0; c < asset->chain_count(); ++c) {
      const Span<const std::uint32_t> spheres = asset->chain(c).spheres;
      members.insert(members.end(), spheres.begin(), spheres.end());
      chain_begin.push_back(static_cast<std::uint32_t>(members.size()));
      longest_chain = std::max(longest_chain, static_cast<std::uint32_t>(spheres.size));
    }
  }

  // For threads on the host.
  Scene scene(const Sphere* spheres) const {
    const auto count = static_cast<std::uint32_t>(asset->spheres().size);
    const auto chain_count = static_cast<std::uint32_t>(asset->chain_count());
    const auto rest_pair_count = static_cast<std::uint32_t>(rest_pairs.size);
    return {spheres,         count,          chain_begin.data(), chain_count, members.data(), asset->ignored().data,
            rest_pairs.data, rest_pair_count};
  }

  const AssetView* asset;
  Span<const RestPair> rest_pairs;
  std::vector<std::uint32_t> chain_begin, members;
  std::uint32_t longest_chain = 0;
};

// The pairs found, in no order. M1 lists a pair once for each chain that holds it; M2's pairs belong to chain 0.
struct PairList {
  ChainPair* entries;
  std::uint32_t capacity;
  std::uint32_t* count;  // goes on past `capacity`
};

SPHERECHAIN_PAPER_BODY void add_pair(const PairList& list, std::uint32_t chain, std::uint32_t i, std::uint32_t j) {
#if defined(__CUDA_ARCH__)
  const std::uint32_t at = atomicAdd(list.count, 1U);
#else
  const std::uint32_t at = (*list.count)++;
#endif
  if (at < list.capacity) {
    list.entries[at] = ChainPair{chain, i < j ? Pair{i, j} : Pair{j, i}};
  }
}

// `scale`: a rest pair's, else 1.
SPHERECHAIN_PAPER_BODY bool overlap(const Sphere& p, const Sphere& q, float scale = 1) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
  const float s = p.radius + q.radius, square = s * s, t = scale * s;
  return (dx * dx + dy * dy) + dz * dz < t * t && square <= FLT_MAX;
}

// "Two spheres collide when they are not adjacent": spheres i and j, which overlap, unless their pair is ignored, or
// is a rest pair and not close enough.
SPHERECHAIN_PAPER_BODY bool is_reported(const Scene& scene, std::uint32_t i, std::uint32_t j) {
  const std::uint32_t a = i < j ? i : j, b = i < j ? j : i;
  const std::uint64_t bit = std::uint64_t{b} * (b - 1) / 2 + a;
  if (((scene.ignored[bit / 64] >> (bit % 64)) & 1U) != 0) {
    return false;
  }
  std::uint32_t low = 0, high = scene.rest_pair_count;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    const RestPair& pair = scene.rest_pairs[middle];
    if (pair.a < a || (pair.a == a && pair.b < b)) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const bool is_rest_pair = low < scene.rest_pair_count && scene.rest_pairs[low].a == a && scene.rest_pairs[low].b == b;
  return !is_rest_pair || overlap(scene.spheres[a], scene.spheres[b], scene.rest_pairs[low].rest_scale);
}

// M2, m threads (the paper's Figure 11): sphere i against all of the mesh, m^2 tests in all.
SPHERECHAIN_PAPER_BODY void test_sphere(const Scene& scene, std::uint32_t i, const PairList& list) {
  if (i >= scene.sphere_count) {
    return;
  }
  const Sphere p = scene.spheres[i];
  for (std::uint32_t j = 0; j < scene.sphere_count; ++j) {
    // Each pair is found from both sides, and listed from one.
    if (overlap(p, scene.spheres[j]) && i < j && is_reported(scene, i, j)) {
      add_pair(list, 0, i, j);
    }
  }
}

// M1, n_c times n threads: the sphere at a place of a chain against all of the chain. (The text says n^2 times as many
// threads as chains, and O(n) time; a thread a sphere takes that time.)
SPHERECHAIN_PAPER_BODY void test_place(const Scene& scene, std::uint32_t chain, std::uint32_t place,
                                       const PairList& list) {
  if (chain >= scene.chain_count) {
    return;
  }
  const std::uint32_t* const members = scene.members + scene.chain_begin[chain];
  const std::uint32_t n = scene.chain_begin[chain + 1] - scene.chain_begin[chain];
  if (place >= n) {
    return;
  }
  const std::uint32_t i = members[place];
  const Sphere p = scene.spheres[i];
  for (std::uint32_t other = 0; other < n; ++other) {
    const std::uint32_t j = members[other];
    if (overlap(p, scene.spheres[j]) && place < other && is_reported(scene, i, j)) {
      add_pair(list, chain, i, j);
    }
  }
}

// M1, n_c threads: all of a chain against all of it.
SPHERECHAIN_PAPER_BODY void test_chain(const Scene& scene, std::uint32_t chain, const PairList& list) {
  if (chain >= scene.chain_count) {
    return;
  }
  const std::uint32_t n = scene.chain_begin[chain + 1] - scene.chain_begin[chain];
  for (std::uint32_t place = 0; place < n; ++place) {
    test_place(scene, chain, place, list);
  }
}

}  // namespace spherechain::cuda_paper
