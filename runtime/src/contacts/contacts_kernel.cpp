// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of clusters to triangles. With bones, spheres' boxes are what hulls.h makes of them,
// and a plane parts most spheres whose boxes touch; clusters' boxes are what cluster_bounds.h makes of them, else
// exact. Pairs of clusters are listed, and decided together: loaded, skinned or copied, those that still seem to touch
// along the axes, their diagonals and the line between them, and paired triangle by triangle. Which candidates come out
// may differ between targets, but none that intersects is ever missing.
#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/clusters/posed_clusters.h"
#include "runtime/src/contacts/collector.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/contacts/contacts_kernel.cpp"
#include "runtime/src/clusters/blocks.h"
#include "runtime/src/clusters/bounds_of_two.h"
#include "runtime/src/clusters/bounds_on_demand.h"
#include "runtime/src/contacts/pair_list.h"
#include "runtime/src/contacts/single_precision.h"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Pairs of triangles, one from a register of each block. Each entry is the triangle's place in its register.
using PlacePairs = PairList<kLanes * kLanes>;

// Sets lane k if triangle j + k of `other` shares a corner's rest position with triangle `one` of `block`. Corners at
// the same rest position have the same weld number, so nine comparisons of numbers decide it.
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

// The loaded triangles of two clusters.
struct BlockPair {
  const Block &a, &b;
  bool share_corners;  // may triangles of the two have a corner at the same position at rest?
  bool are_one;        // the same cluster of the same body
};

// Lists the pairs of triangles, kLanes of each block from i and j on, whose boxes touch. Triangles whose boxes do not
// touch cannot intersect, so no contact is lost. Triangles that share a corner at rest are neighbours and never count:
// they are dropped here, because the collector would reject them one by one. Within one cluster a pair is listed only
// if the second triangle's number is larger, so each pair comes once.
HWY_INLINE void find_places(const BlockPair& blocks, std::size_t i, std::size_t j, PlacePairs& out) {
  constexpr Floats kFloats;
  constexpr hn::Rebind<std::uint32_t, Floats> kTriangles;
  const Block &block = blocks.a, &other = blocks.b;
  const std::size_t end = block.count - i < kLanes ? block.count : i + kLanes;
  const auto used = hn::FirstN(kFloats, other.count - j);
  std::size_t count = 0;
  for (std::size_t one = i; one < end; ++one) {
    auto apart = BoxProbe(box_at(block, one)).misses(other, j);
    if (blocks.share_corners) {
      apart = hn::Or(apart, sharing(block, one, other, j));
    }
    if (blocks.are_one) {
      const auto triangles = hn::LoadU(kTriangles, other.triangles + j);
      const auto later = hn::Gt(triangles, hn::Set(kTriangles, block.triangles[one]));
      apart = hn::Or(apart, hn::Not(hn::RebindMask(kFloats, later)));
    }
    count = out.put(count, one - i, 0, hn::AndNot(apart, used));
  }
  out.count = count;
  out.finish();
}

// Tests the listed pairs of two registers, kLanes at a time. Single precision drops the pairs that are certainly apart
// and marks those that certainly intersect; the collector decides the rest exactly, so the result does not depend on
// the width of the registers. With first_only, this function and its callers return true at the first contact.
HWY_NOINLINE bool pair_registers(const BlockPair& blocks, std::size_t i, std::size_t j, bool first_only,
                                 ContactCollector& collector) {
  const Block &block = blocks.a, &other = blocks.b;
  PlacePairs places;
  find_places(blocks, i, j, places);
  for (std::size_t k = 0; k < places.count; k += kLanes) {
    const std::size_t left = places.count - k;
    std::uint64_t bits = ~std::uint64_t{0} >> (64 - (left < kLanes ? left : kLanes));
    const Verdicts verdicts =
        classify(GatheredTriangles(block, i, places.a + k), GatheredTriangles(other, j, places.b + k), bits);
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
      if (collector.decide(candidate) && first_only) {
        return true;
      }
    }
  }
  return false;
}

// Tests all registers of one block against all of the other. Numbers ascend within a block: in one cluster, a register
// whose last number is not above the first of the other holds no later triangle and is skipped.
HWY_INLINE bool pair_triangles(const BlockPair& blocks, bool first_only, ContactCollector& collector) {
  const Block &block = blocks.a, &other = blocks.b;
  for (std::size_t i = 0; i < block.count; i += kLanes) {
    for (std::size_t j = 0; j < other.count; j += kLanes) {
      const std::size_t last = (other.count - j < kLanes ? other.count : j + kLanes) - 1;
      if (blocks.are_one && other.triangles[last] <= block.triangles[i]) {
        continue;  // each two triangles of a cluster once
      }
      if (pair_registers(blocks, i, j, first_only, collector)) {
        return true;
      }
    }
  }
  return false;
}

// Loads and tests two clusters, or one with itself. Only triangles of a that reach into b's box are loaded, then only
// those of b that reach into the box around them; triangles outside these boxes cannot intersect.
HWY_NOINLINE bool pair_clusters(const Bodies& bodies, std::size_t a, std::size_t b, ContactCollector& collector) {
  Block block, other;
  return load_block(bodies.a, a, BoxProbe(box_of_span(bodies.b, b)), block) &&
         load_block(bodies.b, b, BoxProbe(block.box), other) &&
         pair_triangles({block, other, bodies.a.neighbours, bodies.are_one && a == b}, bodies.a.first_only, collector);
}

// Pairs of clusters that wait to be tested together.
struct ClusterPairs : PairList<512> {
  Pair spheres{~0U, ~0U};  // whose clusters were paired last
  bool touch = false;      // do they?
};

// Loads the clusters that are listed, and pairs those that then still seem to touch; of each two spheres only until a
// contact, where the first one is all that is asked for.
HWY_NOINLINE void decide_clusters(const Bodies& bodies, ClusterPairs& list, ContactCollector& collector) {
  const auto load_all = [&](const PosedClusters& posed, const std::int32_t* side) HWY_ATTR {
    for (std::size_t k = 0; k < list.count; ++k) {
      const auto cluster = static_cast<std::size_t>(side[k]);
      if (posed.is_loaded[cluster] == 0) {
        load(posed, cluster);
      }
    }
  };
  load_all(bodies.a, list.a);
  list.filter([&](std::size_t a, std::size_t b)
                  HWY_ATTR { return box_of_span(bodies.a, a).touches(box_at(bodies.b.clusters, b)); });
  load_all(bodies.b, list.b);
  list.filter([&](std::size_t a, std::size_t b) HWY_ATTR { return spans_touch(bodies.a, a, bodies.b, b); });
  list.filter([&](std::size_t a, std::size_t b)
                  HWY_ATTR { return (bodies.are_one && a == b) || !plane_parts(bodies.a, a, bodies.b, b); });
  for (std::size_t k = 0; k < list.count; ++k) {
    const auto a = static_cast<std::size_t>(list.a[k]), b = static_cast<std::size_t>(list.b[k]);
    const Pair spheres{bodies.a.surface->clusters.data[a].sphere, bodies.b.surface->clusters.data[b].sphere};
    if (spheres.a != list.spheres.a || spheres.b != list.spheres.b) {
      collector.begin_spheres(spheres);
      list.spheres = spheres;
      list.touch = false;
    }
    if (!bodies.a.first_only || !list.touch) {
      list.touch |= pair_clusters(bodies, a, b, collector);
    }
  }
  list.count = 0;
}

// One cluster of a against the clusters [first, end) of b.
HWY_INLINE void list_cluster(const Bodies& bodies, std::size_t cluster, std::size_t first, std::size_t end,
                             ClusterPairs& list, ContactCollector& collector) {
  constexpr Floats kFloats;
  const BoxProbe boxes(box_at(bodies.a.clusters, cluster));
  for (std::size_t j = first; j < end; j += kLanes) {
    auto apart = boxes.misses(bodies.b.clusters, j);
    if (bodies.a.has_balls && bodies.b.has_balls) {
      apart = hn::Or(apart, BallProbe(bodies.a, cluster).misses(bodies.b, j));
    }
    if (!bodies.a.layers) {
      apart = hn::Or(apart, mask_of(layers_of(*bodies.a.surface, cluster, j)));
    }
    list.count = list.put(list.count, cluster, j, hn::AndNot(apart, hn::FirstN(kFloats, end - j)));
    if (!list.has_room(list.count)) {
      decide_clusters(bodies, list, collector);
    }
  }
}

// The clusters of one sphere.
HWY_INLINE void list_within(const PosedClusters& posed, std::size_t sphere, ClusterPairs& list,
                            ContactCollector& collector) {
  bound_once(posed, sphere);
  const std::size_t end = posed.first_cluster[sphere + 1];
  for (std::size_t cluster = posed.first_cluster[sphere]; cluster < end; ++cluster) {
    list_cluster({posed, posed, true}, cluster, cluster, end, list, collector);
  }
}

HWY_INLINE void list_spheres(const Bodies& bodies, std::size_t a, std::size_t b, ClusterPairs& list,
                             ContactCollector& collector) {
  bound_once(bodies.a, a);
  bound_once(bodies.b, b);
  const std::size_t end_a = bodies.a.first_cluster[a + 1], first_b = bodies.b.first_cluster[b],
                    end_b = bodies.b.first_cluster[b + 1];
  const BoxProbe probe_a(box_at(bodies.a.spheres, a));
  if (end_b - first_b <= kLanes && probe_a.touching(bodies.b.clusters, first_b, end_b - first_b) == 0) {
    return;  // most spheres whose boxes touch
  }
  const BoxProbe probe_b(box_at(bodies.b.spheres, b));
  for (std::size_t i = bodies.a.first_cluster[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe_b.touching(bodies.a.clusters, i, end_a - i); bits != 0; bits &= bits - 1) {
      list_cluster(bodies, i + lowest_bit(bits), first_b, end_b, list, collector);
    }
  }
}

// The pairs of spheres that the caller lists, whatever the scope; of a sphere with itself, what is within it.
HWY_NOINLINE void find_listed(const PosedClusters& posed, ContactCollector& collector) {
  const Span<const Pair> pairs = posed.candidates;
  for (std::size_t i = 0; i < pairs.size && !posed.has_hulls; ++i) {
    bound_once(posed, pairs.data[i].a);
    bound_once(posed, pairs.data[i].b);
  }
  if (pairs.size > 0) {
    bound_spheres(posed);
  }
  ClusterPairs clusters;
  for (std::size_t i = 0; i < pairs.size; ++i) {
    const std::size_t a = pairs.data[i].a, b = pairs.data[i].b;
    if (a == b) {
      list_within(posed, a, clusters, collector);
    } else if (box_at(posed.spheres, a).touches(box_at(posed.spheres, b)) &&
               !(posed.has_hulls && hulls_apart(posed, a, posed, b))) {
      list_spheres({posed, posed, true}, a, b, clusters, collector);
    }
  }
  decide_clusters({posed, posed, true}, clusters, collector);
}

// Bit k: a's sphere first + k is to be paired with b's sphere b. Within one body, only spheres before b are paired.
HWY_INLINE std::uint64_t paired(const Bodies& bodies, std::size_t first, std::size_t b) {
  const PosedClusters& posed = bodies.a;
  std::uint64_t bits = ~std::uint64_t{0};
  if (bodies.are_one) {
    const std::uint64_t ignored = bits_at(posed.ignored.data, posed.ignored.size, ignored_bit(first, b));
    bits = (posed.neighbours ? ignored : 0) | (posed.apart ? ~ignored : 0);
  }
  const std::size_t count = (bodies.are_one ? b : posed.sphere_count) - first;
  return bits & (~std::uint64_t{0} >> (64 - (count < 64 ? count : 64)));
}

// Pairs of spheres (b and a) that wait for their clusters to be paired.
using SpherePairs = PairList<512>;

HWY_NOINLINE void pair_spheres(const Bodies& bodies, SpherePairs& spheres, ClusterPairs& clusters,
                               ContactCollector& collector) {
  if (bodies.a.has_hulls && bodies.b.has_hulls) {
    spheres.filter([&](std::size_t b, std::size_t a) HWY_ATTR { return !hulls_apart(bodies.a, a, bodies.b, b); });
  }
  for (std::size_t k = 0; k < spheres.count; ++k) {
    list_spheres(bodies, static_cast<std::size_t>(spheres.b[k]), static_cast<std::size_t>(spheres.a[k]), clusters,
                 collector);
  }
  spheres.count = 0;
}

// All pairs of the scope; or of each sphere of one body with each of the other.
HWY_NOINLINE void find_all(const Bodies& bodies, ContactCollector& collector) {
  if (bodies.a.bone_boxes != nullptr && bodies.b.bone_boxes != nullptr) {
    bound_two(bodies);
  } else {
    bound(bodies.a);
    if (!bodies.are_one) {
      bound(bodies.b);
    }
  }
  SpherePairs spheres;
  ClusterPairs clusters;
  const BoxColumns boxes = bodies.a.spheres;  // in registers, for all that vectors may be written over
  std::size_t count = 0;
  for (std::size_t b = 0; b < bodies.b.sphere_count; ++b) {
    if (bodies.b.neighbours) {
      list_within(bodies.b, b, clusters, collector);
    }
    if (!bodies.are_one && bodies.b.spheres.low[0][b] > bodies.b.spheres.high[0][b]) {
      continue;
    }
    const BoxProbe probe(box_at(bodies.b.spheres, b));
    const std::size_t end = bodies.are_one ? b : bodies.a.sphere_count;
    std::uint64_t bits = 0;
    for (std::size_t first = 0; first < end; first += kLanes, bits >>= kLanes) {
      if (first % 64 == 0) {
        bits = paired(bodies, first, b);
      }
      count = spheres.put(count, b, first, hn::AndNot(probe.misses(boxes, first), mask_of(bits)));
      if (!spheres.has_room(count)) {
        spheres.count = count;
        pair_spheres(bodies, spheres, clusters, collector);
        count = 0;
      }
    }
  }
  spheres.count = count;
  pair_spheres(bodies, spheres, clusters, collector);
  decide_clusters(bodies, clusters, collector);
}

HWY_NOINLINE void find_in_clusters(const Bodies& bodies, ContactCollector& collector) {
  const Span<const Pair> pairs = bodies.a.candidate_clusters;
  ClusterPairs clusters;
  for (std::size_t i = 0; i < pairs.size; ++i) {
    if (!clusters.has_room(clusters.count)) {
      decide_clusters(bodies, clusters, collector);
    }
    clusters.a[clusters.count] = static_cast<std::int32_t>(pairs.data[i].a);
    clusters.b[clusters.count] = static_cast<std::int32_t>(pairs.data[i].b);
    ++clusters.count;
  }
  decide_clusters(bodies, clusters, collector);
}

void find(const Bodies& bodies, ContactCollector& collector) {
  if (bodies.a.candidate_clusters.data != nullptr) {
    find_in_clusters(bodies, collector);
  } else if (bodies.a.candidates.data != nullptr) {
    find_listed(bodies.a, collector);
  } else {
    find_all(bodies, collector);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find);

}  // namespace

void find_candidates(Target resolved, const Bodies& bodies, ContactCollector& collector) {
  find_kernels[index_of(resolved)](bodies, collector);
}

}  // namespace spherechain
#endif
