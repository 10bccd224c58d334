// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace spherechain {

// A borrowed array. The runtime neither owns nor frees what it points to.
template <typename T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;

  constexpr T& operator[](std::size_t i) const { return data[i]; }
  constexpr T* begin() const { return data; }
  constexpr T* end() const { return data + size; }
};

struct Vec3 {
  float x, y, z;
};

// A refitted sphere, in the units and space of the vertices it was refitted from. 16 bytes, four floats.
struct Sphere {
  float x, y, z;
  float radius;
};

// Two touching spheres, a < b: indices into the asset's spheres.
struct Pair {
  std::uint32_t a, b;

  friend constexpr bool operator==(const Pair& l, const Pair& r) { return l.a == r.a && l.b == r.b; }
  friend constexpr bool operator!=(const Pair& l, const Pair& r) { return !(l == r); }
  friend constexpr bool operator<(const Pair& l, const Pair& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; }
};

// Which of a sphere's radii an operation uses. kFit is the paper's; kDetect is the one pairs are reported at by
// default.
enum class RadiusKind : std::uint8_t { kFit = 0, kDetect = 1 };

// M1: chain by chain, as the paper's section 5.2. M2: over all spheres of the mesh.
enum class Method : std::uint8_t { kM1 = 1, kM2 = 2 };

}  // namespace spherechain
