// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of clusters to triangles. With bones, spheres' boxes are what hulls.h makes of them,
// and a plane parts most spheres whose boxes touch; clusters' boxes are what cluster_bounds.h makes of them, else
// exact. Pairs of clusters are listed, and decided together: loaded, skinned or copied, those that still seem to touch
// along the axes, their diagonals and the line between them, and paired triangle by triangle. Which candidates come out
// may differ between targets, but none that intersects is ever missing.
#include "pairs/pair_bits.h"
#include "simd/arithmetic.h"
#include "simd/simd.h"
#include "skin/scene.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "skin/contacts_kernel.cpp"
#include "simd/highway.h"
#include "skin/blocks.h"
#include "skin/hulls.h"
#include "skin/single_precision.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Places = hn::Rebind<std::int32_t, Floats>;

// Pairs of numbers: one with some of a register of others. May be written to until it has no room for a register.
template <std::size_t kRoom>
struct PairList {
  std::size_t count = 0;
  std::int32_t a[kRoom + kLanes], b[kRoom + kLanes];  // vectors are written past the end

  // Where `at` pairs are; gives how many are then. In a loop that is to stay in a register: what the vectors write
  // could be `count`, for all that the compiler knows.
  HWY_INLINE std::size_t put(std::size_t at, std::size_t one, std::size_t first, hn::Mask<Floats> others) {
    constexpr Places kPlaces;
    hn::StoreU(hn::Set(kPlaces, static_cast<std::int32_t>(one)), kPlaces, a + at);
    const auto numbers = hn::Add(hn::Iota(kPlaces, 0), hn::Set(kPlaces, static_cast<std::int32_t>(first)));
    const auto which = hn::RebindMask(kPlaces, others);
    hn::StoreU(hn::Compress(numbers, which), kPlaces, b + at);
    return at + hn::CountTrue(kPlaces, which);
  }
  static bool has_room(std::size_t at) { return at + kLanes <= kRoom; }
  HWY_INLINE void finish() {
    constexpr Places kPlaces;
    hn::StoreU(hn::Zero(kPlaces), kPlaces, a + count);
    hn::StoreU(hn::Zero(kPlaces), kPlaces, b + count);
  }
};

// Of triangles of a register of one block and a register of another, by their places there.
using PlacePairs = PairList<kLanes * kLanes>;

// Lane k: triangle j + k of `other` has a corner where one of `block` has one at rest.
HWY_INLINE hn::Mask<Floats> sharing(const Block& block, std::size_t one, const Block& other, std::size_t j) {
  constexpr Floats kFloats;
  constexpr hn::Rebind<std::uint32_t, Floats> kWelds;
  const auto first = hn::LoadU(kWelds, other.welds[0] + j), second = hn::LoadU(kWelds, other.welds[1] + j),
             third = hn::LoadU(kWelds, other.welds[2] + j);
  const auto holding = [&](std::size_t k) HWY_ATTR {
    const auto own = hn::Set(kWelds, block.welds[k][one]);
    return hn::Or(hn::Or(hn::Eq(first, own), hn::Eq(second, own)), hn::Eq(third, own));
  };
  return hn::RebindMask(kFloats, hn::Or(hn::Or(holding(0), holding(1)), holding(2)));
}

// The triangles of two registers of the blocks whose boxes touch; of one cluster each two once. Of neighbours most that
// lies side by side shares a corner, which the collector would tell too, one by one.
HWY_INLINE void find_places(const Block& block, std::size_t i, const Block& other, std::size_t j, bool neighbours,
                            PlacePairs& out) {
  constexpr Floats kFloats;
  constexpr hn::Rebind<std::uint32_t, Floats> kTriangles;
  const float* const lows[3] = {other.low[0], other.low[1], other.low[2]};
  const float* const highs[3] = {other.high[0], other.high[1], other.high[2]};
  const std::size_t end = block.count - i < kLanes ? block.count : i + kLanes;
  const auto used = hn::FirstN(kFloats, other.count - j);
  std::size_t count = 0;
  for (std::size_t one = i; one < end; ++one) {
    Box box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] = block.low[axis][one];
      box.high[axis] = block.high[axis][one];
    }
    auto apart = BoxProbe(box).misses(lows, highs, j);
    if (neighbours) {
      apart = hn::Or(apart, sharing(block, one, other, j));
    }
    if (block.cluster == other.cluster) {
      const auto triangles = hn::LoadU(kTriangles, other.triangles + j);
      const auto later = hn::Gt(triangles, hn::Set(kTriangles, block.triangles[one]));
      apart = hn::Or(apart, hn::Not(hn::RebindMask(kFloats, later)));
    }
    count = out.put(count, one - i, 0, hn::AndNot(apart, used));
  }
  out.count = count;
  out.finish();
}

// Like all that pairs, true where that is enough: at the first contact, where that is all that is asked for.
template <bool kFirst>
HWY_NOINLINE bool pair_registers(const Block& block, std::size_t i, const Block& other, std::size_t j, bool neighbours,
                                 ContactCollector& collector) {
  PlacePairs places;
  find_places(block, i, other, j, neighbours, places);
  for (std::size_t k = 0; k < places.count; k += kLanes) {
    const std::size_t left = places.count - k;
    std::uint64_t bits = ~std::uint64_t{0} >> (64 - (left < kLanes ? left : kLanes));
    const Verdicts verdicts = judge(Taken(block, i, places.a + k), Taken(other, j, places.b + k), bits);
    for (bits &= ~verdicts.apart; bits != 0; bits &= bits - 1) {
      const std::size_t lane = lowest_bit(bits);
      const std::size_t one = i + static_cast<std::size_t>(places.a[k + lane]);
      const std::size_t two = j + static_cast<std::size_t>(places.b[k + lane]);
      const Candidate candidate{block.cluster,
                                other.cluster,
                                block.triangles[one],
                                other.triangles[two],
                                block.corners_of(one),
                                other.corners_of(two),
                                ((verdicts.meeting >> lane) & 1U) != 0};
      if (decide(collector, candidate) && kFirst) {
        return true;
      }
    }
  }
  return false;
}

template <bool kFirst>
HWY_INLINE bool pair_triangles(const Block& block, const Block& other, bool neighbours, ContactCollector& collector) {
  for (std::size_t i = 0; i < block.count; i += kLanes) {
    for (std::size_t j = 0; j < other.count; j += kLanes) {
      const std::size_t last = (other.count - j < kLanes ? other.count : j + kLanes) - 1;
      if (block.cluster == other.cluster && other.triangles[last] <= block.triangles[i]) {
        continue;  // each two triangles of a cluster once
      }
      if (pair_registers<kFirst>(block, i, other, j, neighbours, collector)) {
        return true;
      }
    }
  }
  return false;
}

// Two clusters that are loaded; or one, with itself.
template <bool kFirst>
HWY_NOINLINE bool pair_clusters(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  const BoxProbe probe(box_of_span(scene, b));
  const std::size_t count_a = scene.surface->clusters.data[a].triangle_count;
  const std::size_t count_b = scene.surface->clusters.data[b].triangle_count;
  Block block, other;
  for (std::size_t first = 0; first < count_a; first += kBlock) {
    if (!load_block(scene, a, first, probe, block)) {
      continue;
    }
    const BoxProbe block_probe(block.box);
    for (std::size_t first_b = 0; first_b < count_b; first_b += kBlock) {
      if (!load_block(scene, b, first_b, block_probe, other)) {
        continue;
      }
      if (pair_triangles<kFirst>(block, other, scene.neighbours, collector)) {
        return true;
      }
    }
  }
  return false;
}

// Of clusters, waiting to be decided together.
struct ClusterPairs : PairList<512> {
  Pair spheres{~0U, ~0U};  // whose clusters were paired last
  bool touch = false;      // do they?
};

// Loads the clusters that are listed, and pairs those that then still seem to touch; of each two spheres only until a
// contact, where the first one is all that is asked for.
template <bool kFirst>
HWY_NOINLINE void decide_clusters(const ContactScene& scene, ClusterPairs& list, ContactCollector& collector) {
  const auto load_all = [&](const std::int32_t* side) HWY_ATTR {
    for (std::size_t k = 0; k < list.count; ++k) {
      const auto cluster = static_cast<std::size_t>(side[k]);
      if (scene.is_loaded[cluster] == 0) {
        load(scene, cluster);
      }
    }
  };
  const auto keep = [&](const auto& touch) HWY_ATTR {
    std::size_t left = 0;
    for (std::size_t k = 0; k < list.count; ++k) {
      const std::int32_t a = list.a[k], b = list.b[k];
      list.a[left] = a;
      list.b[left] = b;
      left += touch(static_cast<std::size_t>(a), static_cast<std::size_t>(b)) ? 1 : 0;
    }
    list.count = left;
  };
  load_all(list.a);
  keep([&](std::size_t a, std::size_t b) HWY_ATTR { return box_of_span(scene, a).touches(box_at(scene.clusters, b)); });
  load_all(list.b);
  keep([&](std::size_t a, std::size_t b) HWY_ATTR { return spans_touch(scene, a, b); });
  keep([&](std::size_t a, std::size_t b) HWY_ATTR { return a == b || !plane_parts(scene, a, b); });
  for (std::size_t k = 0; k < list.count; ++k) {
    const auto a = static_cast<std::size_t>(list.a[k]), b = static_cast<std::size_t>(list.b[k]);
    const Pair spheres{scene.surface->clusters.data[a].sphere, scene.surface->clusters.data[b].sphere};
    if (spheres.a != list.spheres.a || spheres.b != list.spheres.b) {
      begin_spheres(collector, spheres);
      list.spheres = spheres;
      list.touch = false;
    }
    if (!kFirst || !list.touch) {
      list.touch |= pair_clusters<kFirst>(scene, a, b, collector);
    }
  }
  list.count = 0;
}

// One cluster against the clusters [first, end).
template <bool kFirst>
HWY_INLINE void list_cluster(const ContactScene& scene, std::size_t cluster, std::size_t first, std::size_t end,
                             ClusterPairs& list, ContactCollector& collector) {
  constexpr Floats kFloats;
  const BoxProbe boxes(box_at(scene.clusters, cluster));
  for (std::size_t j = first; j < end; j += kLanes) {
    auto apart = boxes.misses(scene.clusters, j);
    if (scene.has_balls) {
      apart = hn::Or(apart, BallProbe(scene, cluster).misses(scene, j));
    }
    list.count = list.put(list.count, cluster, j, hn::AndNot(apart, hn::FirstN(kFloats, end - j)));
    if (!list.has_room(list.count)) {
      decide_clusters<kFirst>(scene, list, collector);
    }
  }
}

// The clusters of one sphere.
HWY_INLINE void list_within(const ContactScene& scene, std::size_t sphere, ClusterPairs& list,
                            ContactCollector& collector) {
  if (scene.has_hulls) {
    bound_sphere_by_bones(scene, sphere);
  }
  const std::size_t end = scene.first_cluster[sphere + 1];
  for (std::size_t cluster = scene.first_cluster[sphere]; cluster < end; ++cluster) {
    list_cluster<false>(scene, cluster, cluster, end, list, collector);
  }
}

template <bool kFirst>
HWY_INLINE void list_spheres(const ContactScene& scene, std::size_t a, std::size_t b, ClusterPairs& list,
                             ContactCollector& collector) {
  if (scene.has_hulls) {
    bound_sphere_by_bones(scene, a);
    bound_sphere_by_bones(scene, b);
  }
  const std::size_t end_a = scene.first_cluster[a + 1], first_b = scene.first_cluster[b],
                    end_b = scene.first_cluster[b + 1];
  const BoxProbe probe_a(box_at(scene.spheres, a));
  if (end_b - first_b <= kLanes && probe_a.touching(scene.clusters, first_b, end_b - first_b) == 0) {
    return;  // most spheres whose boxes touch
  }
  const BoxProbe probe_b(box_at(scene.spheres, b));
  for (std::size_t i = scene.first_cluster[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe_b.touching(scene.clusters, i, end_a - i); bits != 0; bits &= bits - 1) {
      list_cluster<kFirst>(scene, i + lowest_bit(bits), first_b, end_b, list, collector);
    }
  }
}

// Exact boxes of a sphere's clusters and of all of them, where it has none yet.
HWY_NOINLINE void bound_sphere(const ContactScene& scene, std::size_t sphere) {
  if (scene.is_bounded[sphere] != 0) {
    return;
  }
  scene.is_bounded[sphere] = 1;
  for (std::size_t i = scene.first_cluster[sphere]; i < scene.first_cluster[sphere + 1]; ++i) {
    put_box(scene.clusters, i, box_of_cluster(scene, scene.surface->clusters.data[i]));
  }
  unite_clusters(scene, sphere);
}

// Boxes of all clusters and spheres.
HWY_NOINLINE void bound_all(const ContactScene& scene) {
  if (scene.has_hulls) {
    bound_hulls(scene);
    return;
  }
  if (scene.has_balls) {
    bound_clusters_by_bones(scene);
  } else {
    bound_clusters(scene);
  }
  for (std::size_t s = 0; s < scene.sphere_count; ++s) {
    unite_clusters(scene, s);
  }
}

// Two spheres, whatever the scope. By bones all are bounded.
template <bool kFirst>
HWY_INLINE void pair_two(const ContactScene& scene, std::size_t a, std::size_t b, ClusterPairs& list,
                         ContactCollector& collector) {
  if (!scene.has_balls) {
    bound_sphere(scene, a);
    bound_sphere(scene, b);
  }
  if (box_at(scene.spheres, a).touches(box_at(scene.spheres, b)) && !(scene.has_hulls && hulls_apart(scene, a, b))) {
    list_spheres<kFirst>(scene, a, b, list, collector);
  }
}

template <bool kFirst>
HWY_INLINE void find_of(const ContactScene& scene, const Pair* pairs, std::size_t count, ContactCollector& collector) {
  if (scene.has_balls && count > 0) {
    bound_all(scene);
  }
  ClusterPairs list;
  for (std::size_t i = 0; i < count; ++i) {
    pair_two<kFirst>(scene, pairs[i].a, pairs[i].b, list, collector);
  }
  decide_clusters<kFirst>(scene, list, collector);
}

HWY_INLINE bool is_enabled(const ContactScene& scene, std::size_t sphere) {
  return scene.disabled.size == 0 || !test_bit(scene.disabled, sphere);
}

// Bit k: sphere first + k is before b, and the scope pairs the two.
HWY_INLINE std::uint64_t paired(const ContactScene& scene, std::size_t first, std::size_t b) {
  const std::uint64_t ignored = bits_at(scene.ignored.data, scene.ignored.size, ignored_bit(first, b));
  std::uint64_t bits = (scene.neighbours ? ignored : 0) | (scene.apart ? ~ignored : 0);
  if (scene.disabled.size > 0) {
    bits &= ~bits_at(scene.disabled.data, scene.disabled.size, first);
  }
  const std::size_t count = b - first;
  return bits & (~std::uint64_t{0} >> (64 - (count < 64 ? count : 64)));
}

// Spheres, waiting for their clusters to be paired.
using SpherePairs = PairList<512>;

template <bool kFirst>
HWY_NOINLINE void pair_spheres(const ContactScene& scene, SpherePairs& spheres, ClusterPairs& clusters,
                               ContactCollector& collector) {
  if (scene.has_hulls) {
    std::size_t left = 0;
    for (std::size_t k = 0; k < spheres.count; ++k) {
      const std::int32_t a = spheres.a[k], b = spheres.b[k];
      spheres.a[left] = a;
      spheres.b[left] = b;
      left += hulls_apart(scene, static_cast<std::size_t>(a), static_cast<std::size_t>(b)) ? 0 : 1;
    }
    spheres.count = left;
  }
  for (std::size_t k = 0; k < spheres.count; ++k) {
    list_spheres<kFirst>(scene, static_cast<std::size_t>(spheres.b[k]), static_cast<std::size_t>(spheres.a[k]),
                         clusters, collector);
  }
  spheres.count = 0;
}

template <bool kFirst>
HWY_INLINE void find(const ContactScene& scene, ContactCollector& collector) {
  bound_all(scene);
  SpherePairs spheres;
  ClusterPairs clusters;
  const BoxColumns boxes = scene.spheres;  // in registers, for all that vectors may be written over
  std::size_t count = 0;
  for (std::size_t b = 0; b < scene.sphere_count; ++b) {
    if (!is_enabled(scene, b)) {
      continue;
    }
    if (scene.neighbours) {
      list_within(scene, b, clusters, collector);
    }
    const BoxProbe probe(box_at(scene.spheres, b));
    std::uint64_t bits = 0;
    for (std::size_t first = 0; first < b; first += kLanes, bits >>= kLanes) {
      if (first % 64 == 0) {
        bits = paired(scene, first, b);
      }
      count = spheres.put(count, b, first, hn::AndNot(probe.misses(boxes, first), mask_of(bits)));
      if (!spheres.has_room(count)) {
        spheres.count = count;
        pair_spheres<kFirst>(scene, spheres, clusters, collector);
        count = 0;
      }
    }
  }
  spheres.count = count;
  pair_spheres<kFirst>(scene, spheres, clusters, collector);
  decide_clusters<kFirst>(scene, clusters, collector);
}

void find_all(const ContactScene& scene, bool first_only, ContactCollector& collector) {
  if (first_only) {
    find<true>(scene, collector);
  } else {
    find<false>(scene, collector);
  }
}

void find_pairs(const ContactScene& scene, const Pair* pairs, std::size_t count, bool first_only,
                ContactCollector& collector) {
  if (first_only) {
    find_of<true>(scene, pairs, count, collector);
  } else {
    find_of<false>(scene, pairs, count, collector);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find_all);
SPHERECHAIN_KERNELS(find_pairs);

}  // namespace

void find_candidates(Target resolved, const ContactScene& scene, bool first_only, ContactCollector& collector) {
  find_all_kernels[index_of(resolved)](scene, first_only, collector);
}

void find_candidates_of(Target resolved, const ContactScene& scene, Span<const Pair> pairs, bool first_only,
                        ContactCollector& collector) {
  find_pairs_kernels[index_of(resolved)](scene, pairs.data, pairs.size, first_only, collector);
}

}  // namespace spherechain
#endif
