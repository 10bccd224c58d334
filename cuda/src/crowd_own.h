// SPDX-License-Identifier: MIT
// The crowd's kernel where the instances come as spheres: what a warp has for the one that it tests.
#pragma once

#include "crowd_view.h"

namespace spherechain::cuda {

// What a warp has found of the instance whose pairs it tests.
struct alignas(16) Found {
  std::uint32_t count, queued, is_full;
  std::uint32_t radius;  // of bounds: a float of no sign, which is ordered as its bits are
};

struct OwnState {
  Found found;
  std::uint64_t start;           // of the instance's list
  float box[kBoxFigures];        // around all centres: low, high
  std::uint32_t queue[kQueued];  // (unit * kLanePairs + pair) * kLanes + lane
};

// What a warp has for itself, and its lane.
struct Own {
  OwnState* state;
  float* seen;    // [x, y, z, power][place_of(sphere)]: rounded, from the instance's origin
  float* powers;  // [pair of spheres][first, second, first, second]
  std::uint64_t* bits;
  std::uint64_t* ordered_bits;  // in the order of sorted pairs
  float* boxes;                 // [axis, low or high][lane]
  std::uint32_t* parts;         // [lane]: pairs in each lane's part of the ordered bits
  Float4* spheres;
  std::uint32_t lane, instance;

  // `place`: the instance's in its block.
  SPHERECHAIN_HD Own(const GroupView& v, const Shared& shared, const Place& at, std::uint32_t place)
      : lane(at.lane()), instance(at.block * kFewInstances + place) {
    const SharedLayout& layout = v.layout;
    unsigned char* const bytes = shared.own + at.warp() * layout.own_size;
    state = reinterpret_cast<OwnState*>(bytes);
    seen = reinterpret_cast<float*>(bytes + layout.own_seen);
    powers = reinterpret_cast<float*>(bytes + layout.own_powers);
    bits = reinterpret_cast<std::uint64_t*>(bytes + layout.own_bits);
    ordered_bits = reinterpret_cast<std::uint64_t*>(bytes + layout.own_ordered_bits);
    boxes = reinterpret_cast<float*>(bytes + layout.own_boxes);
    parts = reinterpret_cast<std::uint32_t*>(bytes + layout.own_parts);
    spheres = reinterpret_cast<Float4*>(bytes + layout.own_spheres);
  }
};

}  // namespace spherechain::cuda
