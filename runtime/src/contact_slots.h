// SPDX-License-Identifier: MIT
// The vertices of a leaf, in its slots. Included by triangle_contacts_kernel.cpp once a
// target, after highway.h; no include guard.
#include <cfloat>

#include "contact_scene.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Where a leaf's skinned vertices are.
struct Slots {
  float* axes[3];
  std::size_t count;
};

// Each axis starts at a multiple of kContactPadding floats. A leaf's slots, a multiple of half of that, are rounded up
// to one: half of it for each leaf before is room enough.
HWY_INLINE Slots slots_of(const ContactScene& scene, std::size_t leaf_index) {
  static_assert(2 * kSlotLanes == kContactPadding, "half of it");
  constexpr std::size_t kWhole = kContactPadding;
  const Leaf& leaf = scene.surface->leaves.data[leaf_index];
  const std::size_t room = (leaf.vertex_count + kWhole - 1) / kWhole * kWhole;
  const std::size_t place = (leaf.first_slot + kSlotLanes * leaf_index + kWhole - 1) / kWhole * kWhole;
  float* first = scene.slots + 3 * place;
  return {{first, first + room, first + 2 * room}, (leaf.vertex_count + kSlotLanes - 1) / kSlotLanes * kSlotLanes};
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void copy_vertices(const ContactScene& scene, const Leaf& leaf, const Slots& slots) {
  const std::uint32_t* vertices = scene.surface->leaf_vertices.data + leaf.first_vertex;
  const std::uint32_t* source = scene.surface->source_vertices.data;
  for (std::size_t i = 0; i < leaf.vertex_count; ++i) {
    const float* p = scene.positions + source[vertices[i]] * scene.stride;
    slots.axes[0][i] = p[0];
    slots.axes[1][i] = p[1];
    slots.axes[2][i] = p[2];
  }
}

#else

// Four at a time, turned; the last ones repeat the last vertex.
HWY_INLINE void copy_vertices(const ContactScene& scene, const Leaf& leaf, const Slots& slots) {
  constexpr hn::CappedTag<float, 4> kFour;
  const std::uint32_t* vertices = scene.surface->leaf_vertices.data + leaf.first_vertex;
  const std::uint32_t* source = scene.surface->source_vertices.data;
  const std::size_t last = leaf.vertex_count - std::size_t{1};
  const auto vertex = [&](std::size_t i) HWY_ATTR {
    return load_position(scene.positions + source[vertices[i < last ? i : last]] * scene.stride);
  };
  for (std::size_t i = 0; i <= last; i += 4) {
    const auto a = vertex(i), b = vertex(i + 1), c = vertex(i + 2), d = vertex(i + 3);
    const auto xy_ac = hn::InterleaveLower(kFour, a, c), xy_bd = hn::InterleaveLower(kFour, b, d);
    const auto z_ac = hn::InterleaveUpper(kFour, a, c), z_bd = hn::InterleaveUpper(kFour, b, d);
    hn::Store(hn::InterleaveLower(kFour, xy_ac, xy_bd), kFour, slots.axes[0] + i);
    hn::Store(hn::InterleaveUpper(kFour, xy_ac, xy_bd), kFour, slots.axes[1] + i);
    hn::Store(hn::InterleaveLower(kFour, z_ac, z_bd), kFour, slots.axes[2] + i);
  }
}

#endif

// Where it is not yet: a leaf's vertices from the source's.
HWY_NOINLINE void gather(const ContactScene& scene, std::size_t leaf_index) {
  if (scene.is_loaded[leaf_index] == 0) {
    scene.is_loaded[leaf_index] = 1;
    copy_vertices(scene, scene.surface->leaves.data[leaf_index], slots_of(scene, leaf_index));
  }
}

// Where it is not yet: a leaf's vertices from the bones, and its own box in place of its ball's.
HWY_NOINLINE void skin(const ContactScene& scene, std::size_t leaf_index) {
  if (scene.is_loaded[leaf_index] != 0) {
    return;
  }
  scene.is_loaded[leaf_index] = 1;
  const Leaf& leaf = scene.surface->leaves.data[leaf_index];
  const Slots slots = slots_of(scene, leaf_index);
  skin_leaf(scene.skin, leaf, slots.axes[0], slots.axes[1], slots.axes[2]);
  constexpr hn::CappedTag<float, kSlotLanes> kSlots;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto low = hn::Set(kSlots, FLT_MAX), high = hn::Set(kSlots, -FLT_MAX);
    for (std::size_t i = 0; i < slots.count; i += hn::MaxLanes(kSlots)) {
      const auto p = hn::LoadU(kSlots, slots.axes[axis] + i);
      low = hn::Min(p, low);
      high = hn::Max(p, high);
    }
    scene.leaves.low[axis][leaf_index] = hn::GetLane(hn::MinOfLanes(kSlots, low));
    scene.leaves.high[axis][leaf_index] = hn::GetLane(hn::MaxOfLanes(kSlots, high));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();
