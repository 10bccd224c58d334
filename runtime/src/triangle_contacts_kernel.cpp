// SPDX-License-Identifier: MIT
// From boxes of spheres to boxes of leaves to triangles. From bones, leaves' boxes are around their balls until they
// are skinned; all other boxes are exact. Which candidates come out may differ between targets, but none that
// intersects is ever missing.
#include "arithmetic.h"
#include "contact_scene.h"
#include "simd.h"
#include "triangle_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "triangle_contacts_kernel.cpp"
#include "highway.h"
#include "skin_leaf.h"

// One after another: each builds on those before.
#include "contact_boxes.h"

#include "contact_slots.h"

#include "contact_blocks.h"

#include "contact_judge.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Places = hn::Rebind<std::int32_t, Floats>;

// Pairs of triangles of a register of one block and a register of another, by their places there.
struct PlacePairs {
  std::size_t count = 0;
  std::int32_t a[kLanes * kLanes + kLanes], b[kLanes * kLanes + kLanes];  // vectors are written past the end

  HWY_INLINE void add(std::size_t one, hn::Mask<Floats> others) {
    constexpr Places kPlaces;
    hn::StoreU(hn::Set(kPlaces, static_cast<std::int32_t>(one)), kPlaces, a + count);
    count += hn::CompressStore(hn::Iota(kPlaces, 0), hn::RebindMask(kPlaces, others), kPlaces, b + count);
  }
  HWY_INLINE void finish() {
    constexpr Places kPlaces;
    hn::StoreU(hn::Zero(kPlaces), kPlaces, a + count);
    hn::StoreU(hn::Zero(kPlaces), kPlaces, b + count);
  }
};

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

// The triangles of two registers of the blocks whose boxes touch; of one leaf each two once. Of neighbours most that
// lies side by side shares a corner, which the collector would tell too, one by one.
HWY_INLINE void find_places(const Block& block, std::size_t i, const Block& other, std::size_t j, bool neighbours,
                            PlacePairs& out) {
  constexpr Floats kFloats;
  constexpr hn::Rebind<std::uint32_t, Floats> kTriangles;
  const float* const lows[3] = {other.low[0], other.low[1], other.low[2]};
  const float* const highs[3] = {other.high[0], other.high[1], other.high[2]};
  const std::size_t end = block.count - i < kLanes ? block.count : i + kLanes;
  const auto used = hn::FirstN(kFloats, other.count - j);
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
    if (block.leaf == other.leaf) {
      const auto triangles = hn::LoadU(kTriangles, other.triangles + j);
      const auto later = hn::Gt(triangles, hn::Set(kTriangles, block.triangles[one]));
      apart = hn::Or(apart, hn::Not(hn::RebindMask(kFloats, later)));
    }
    out.add(one - i, hn::AndNot(apart, used));
  }
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
      const Candidate candidate{block.leaf,
                                other.leaf,
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
      if (block.leaf == other.leaf && other.triangles[last] <= block.triangles[i]) {
        continue;  // each two triangles of a leaf once
      }
      if (pair_registers<kFirst>(block, i, other, j, neighbours, collector)) {
        return true;
      }
    }
  }
  return false;
}

// Two leaves whose boxes touch; or one, with itself.
template <bool kFirst>
HWY_NOINLINE bool pair_leaves(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  if (scene.positions != nullptr) {
    gather(scene, a);
    gather(scene, b);
  }
  const BoxProbe probe(box_at(scene.leaves, b));
  const std::size_t count_a = scene.surface->leaves.data[a].triangle_count;
  const std::size_t count_b = scene.surface->leaves.data[b].triangle_count;
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

// One leaf against those of a sphere: leaves [first, end).
template <bool kFirst>
HWY_INLINE bool pair_leaf(const ContactScene& scene, std::size_t leaf, std::size_t first, std::size_t end,
                          ContactCollector& collector) {
  const BoxProbe probe(box_at(scene.leaves, leaf));
  for (std::size_t j = first; j < end; j += kLanes) {
    for (std::uint64_t bits = probe.touching(scene.leaves, j, end - j); bits != 0; bits &= bits - 1) {
      if (pair_leaves<kFirst>(scene, leaf, j + lowest_bit(bits), collector)) {
        return true;
      }
    }
  }
  return false;
}

// The same from bones: what their balls do not part is skinned.
template <bool kFirst>
HWY_INLINE bool pair_ball(const ContactScene& scene, std::size_t leaf, std::size_t first, std::size_t end,
                          ContactCollector& collector) {
  const BallProbe balls(scene, leaf);
  BoxProbe probe(box_at(scene.leaves, leaf));
  for (std::size_t j = first; j < end; j += kLanes) {
    std::uint64_t bits = probe.touching(scene.leaves, j, end - j);
    bits &= bits == 0 ? 0 : balls.touching(scene, j);
    if (bits != 0 && scene.is_loaded[leaf] == 0) {
      skin(scene, leaf);
      probe = BoxProbe(box_at(scene.leaves, leaf));
      bits &= probe.touching(scene.leaves, j, end - j);
    }
    for (; bits != 0; bits &= bits - 1) {
      const std::size_t other = j + lowest_bit(bits);
      skin(scene, other);
      if (box_at(scene.leaves, leaf).touches(box_at(scene.leaves, other))) {
        if (pair_leaves<kFirst>(scene, leaf, other, collector)) {
          return true;
        }
      }
    }
  }
  return false;
}

// The leaves of one sphere.
HWY_INLINE void pair_within(const ContactScene& scene, std::size_t sphere, ContactCollector& collector) {
  const std::size_t end = scene.first_leaf[sphere + 1];
  for (std::size_t leaf = scene.first_leaf[sphere]; leaf < end; ++leaf) {
    if (scene.positions != nullptr) {
      pair_leaves<false>(scene, leaf, leaf, collector);
      pair_leaf<false>(scene, leaf, leaf + 1, end, collector);
    } else {
      skin(scene, leaf);
      pair_leaves<false>(scene, leaf, leaf, collector);
      pair_ball<false>(scene, leaf, leaf + 1, end, collector);
    }
  }
}

template <bool kFirst>
HWY_INLINE void pair_spheres(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  const std::size_t end_a = scene.first_leaf[a + 1], first_b = scene.first_leaf[b], end_b = scene.first_leaf[b + 1];
  const BoxProbe probe_a(box_at(scene.spheres, a));
  if (end_b - first_b <= kLanes && probe_a.touching(scene.leaves, first_b, end_b - first_b) == 0) {
    return;  // most spheres whose boxes touch
  }
  const BoxProbe probe_b(box_at(scene.spheres, b));
  for (std::size_t i = scene.first_leaf[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe_b.touching(scene.leaves, i, end_a - i); bits != 0; bits &= bits - 1) {
      const std::size_t leaf = i + lowest_bit(bits);
      if (scene.positions != nullptr ? pair_leaf<kFirst>(scene, leaf, first_b, end_b, collector)
                                     : pair_ball<kFirst>(scene, leaf, first_b, end_b, collector)) {
        return;
      }
    }
  }
}

// Exact boxes of a sphere's leaves and of all of them, where it has none yet.
HWY_NOINLINE void bound_sphere(const ContactScene& scene, std::size_t sphere) {
  if (scene.is_bounded[sphere] != 0) {
    return;
  }
  scene.is_bounded[sphere] = 1;
  for (std::size_t i = scene.first_leaf[sphere]; i < scene.first_leaf[sphere + 1]; ++i) {
    if (scene.positions != nullptr) {
      put_box(scene.leaves, i, box_of_leaf(scene, scene.surface->leaves.data[i]));
    } else {
      skin(scene, i);
    }
  }
  unite_leaves(scene, sphere);
}

bool touch(const ContactScene& scene, std::size_t a, std::size_t b, ContactCollector& collector) {
  bound_sphere(scene, a);
  bound_sphere(scene, b);
  const Box box_b = box_at(scene.spheres, b);
  if (!box_at(scene.spheres, a).touches(box_b)) {
    return false;
  }
  const BoxProbe probe(box_b);
  const std::size_t end_a = scene.first_leaf[a + 1], first_b = scene.first_leaf[b], end_b = scene.first_leaf[b + 1];
  for (std::size_t i = scene.first_leaf[a]; i < end_a; i += kLanes) {
    for (std::uint64_t bits = probe.touching(scene.leaves, i, end_a - i); bits != 0; bits &= bits - 1) {
      if (pair_leaf<true>(scene, i + lowest_bit(bits), first_b, end_b, collector)) {
        return true;
      }
    }
  }
  return false;
}

HWY_INLINE bool is_enabled(const ContactScene& scene, std::size_t sphere) {
  return scene.disabled.size == 0 || !test_bit(scene.disabled, sphere);
}

template <bool kFirst>
HWY_INLINE void find(const ContactScene& scene, ContactCollector& collector) {
  if (scene.positions != nullptr) {
    bound_leaves(scene);
  } else {
    bound_balls(scene);
  }
  for (std::size_t s = 0; s < scene.sphere_count; ++s) {
    unite_leaves(scene, s);
  }
  for (std::size_t a = 0; a < scene.sphere_count; ++a) {
    if (!is_enabled(scene, a)) {
      continue;
    }
    const auto sphere = static_cast<std::uint32_t>(a);
    if (scene.neighbours) {
      begin_spheres(collector, {sphere, sphere});
      pair_within(scene, a, collector);
    }
    const BoxProbe probe(box_at(scene.spheres, a));
    for (std::size_t first = a + 1; first < scene.sphere_count; first += kLanes) {
      std::uint64_t bits = probe.touching(scene.spheres, first, scene.sphere_count - first);
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t b = first + lowest_bit(bits);
        if (is_enabled(scene, b) && (test_bit(scene.ignored, ignored_bit(a, b)) ? scene.neighbours : scene.apart)) {
          begin_spheres(collector, {sphere, static_cast<std::uint32_t>(b)});
          pair_spheres<kFirst>(scene, a, b, collector);
        }
      }
    }
  }
}

void find_all(const ContactScene& scene, ContactCollector& collector) { find<false>(scene, collector); }
void find_first(const ContactScene& scene, ContactCollector& collector) { find<true>(scene, collector); }

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find_all);
SPHERECHAIN_KERNELS(find_first);
SPHERECHAIN_KERNELS(touch);

}  // namespace

void find_candidates(Target resolved, const ContactScene& scene, ContactCollector& collector) {
  find_all_kernels[index_of(resolved)](scene, collector);
}

void find_spheres(Target resolved, const ContactScene& scene, ContactCollector& collector) {
  find_first_kernels[index_of(resolved)](scene, collector);
}

bool skins_touch(Target resolved, const ContactScene& scene, Pair spheres, ContactCollector& collector) {
  return touch_kernels[index_of(resolved)](scene, spheres.a, spheres.b, collector);
}

}  // namespace spherechain
#endif
