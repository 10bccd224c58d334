// SPDX-License-Identifier: MIT
#include "tiny_asset.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace spherechain::test {
namespace {

std::uint32_t add_triangle(TinyAsset& tiny, std::size_t sphere, std::array<std::uint32_t, 3> corners) {
  const auto number = static_cast<std::uint32_t>(tiny.corners.size());
  tiny.corners.push_back(corners);
  tiny.triangles[sphere].push_back(number);
  tiny.part_of_triangle.push_back(static_cast<std::uint8_t>(number % 7 == 0 ? 4 : sphere % 5));
  return number;
}

void add_sphere(TinyAsset& tiny, const Vec3& center, float radius) {
  const std::size_t i = tiny.parts.spheres.size();
  RestSphere sphere{};
  sphere.center = center;
  sphere.radius = radius;
  sphere.detect_radius = radius * 1.25F;
  sphere.pivot_spread = radius * 0.75F;
  sphere.first_pivot = static_cast<std::uint32_t>(tiny.parts.pivots.size());
  sphere.pivot_count = 4;
  sphere.region = sphere.part = static_cast<std::uint8_t>(i % 5);
  sphere.side = static_cast<std::uint8_t>(i % 5 != 4 ? 0 : i % 2 == 0 ? SC_SIDE_LEFT : SC_SIDE_RIGHT);
  sphere.level = i % 5 == 4 ? static_cast<std::int16_t>(i / 5) : std::int16_t{-1};
  tiny.parts.spheres.push_back(sphere);
  tiny.triangles.emplace_back();
}

// Four small triangles round the sphere's centre, so that the mean of their centroids is the centre.
void add_pivots(TinyAsset& tiny, const RestSphere& sphere) {
  constexpr std::array<Vec3, 4> kDirections{{{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}};
  constexpr std::array<Vec3, 3> kCorners{{{0.01F, 0.01F, 0}, {-0.01F, 0, 0.01F}, {0, -0.01F, -0.01F}}};
  const Vec3 center = sphere.center;
  for (const Vec3& direction : kDirections) {
    const auto first = static_cast<std::uint32_t>(tiny.rest.size() / 3);
    for (const Vec3& corner : kCorners) {
      tiny.rest.insert(tiny.rest.end(), {center.x + sphere.pivot_spread * direction.x + corner.x,
                                         center.y + sphere.pivot_spread * direction.y + corner.y,
                                         center.z + sphere.pivot_spread * direction.z + corner.z});
    }
    tiny.parts.pivots.push_back({first, first + 1, first + 2, 0.25F});
    add_triangle(tiny, tiny.parts.spheres.size() - 1, {first, first + 1, first + 2});
  }
}

void add_chains(AssetParts& parts, std::mt19937& random) {
  const std::size_t n = parts.spheres.size();
  for (unsigned c = 0; c < 4; ++c) {
    Numbers members(n);
    std::iota(members.begin(), members.end(), 0U);
    for (std::size_t i = n; i > 1; --i) {
      std::swap(members[i - 1], members[random() % i]);
    }
    members.resize((n + 1) / 2);  // half of them, in no order: neither sorted nor disjoint from the other chains
    parts.chains.push_back({"zeta" + std::to_string(c), {static_cast<std::uint8_t>(c % 4), 4}, members});
  }
}

template <typename IsIgnored>
void set_ignored(TinyAsset& tiny, const IsIgnored& is_ignored) {
  const auto n = static_cast<std::uint32_t>(tiny.parts.spheres.size());
  tiny.parts.ignored.assign((std::size_t{n} * (n - 1) / 2 + 63) / 64, 0);
  std::size_t bit = 0;
  for (std::uint32_t b = 1; b < n; ++b) {
    for (std::uint32_t a = 0; a < b; ++a, ++bit) {
      if (is_ignored(a, b)) {
        tiny.parts.ignored[bit / 64] |= std::uint64_t{1} << (bit % 64);
        tiny.ignored_pairs.push_back({a, b});
      }
    }
  }
}

void add_rest_pairs(AssetParts& parts, std::mt19937& random) {
  const auto n = static_cast<std::uint32_t>(parts.spheres.size());
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = a + 1; b < n; ++b) {
      if (random() % 5 == 0) {
        parts.rest_fit.push_back({a, b, uniform(random, 0.3F, 1.0F)});
      }
      if (random() % 5 == 0) {
        parts.rest_detect.push_back({a, b, uniform(random, 0.3F, 1.0F)});
      }
    }
  }
}

// Derives all data that follow from the spheres and triangles.
void finish(TinyAsset& tiny, std::mt19937& random) {
  AssetParts& parts = tiny.parts;
  for (const char* name : {"left_arm", "right_arm", "left_leg", "right_leg", "torso"}) {
    parts.regions.push_back({name, static_cast<std::uint32_t>(parts.regions.size() + 10)});
  }
  parts.parts = {{"left hand", SC_SIDE_LEFT},
                 {"right hand", SC_SIDE_RIGHT},
                 {"left foot", SC_SIDE_LEFT},
                 {"right foot", SC_SIDE_RIGHT},
                 {"chest"}};
  parts.joints = {{"hips", -1, {0, 1, 0}, {0, 1.25F, 0}},
                  {"spine", 0, {0, 1.25F, 0}, {0, 1.5F, 0}},
                  {"left_thigh", 0, {0.125F, 1, 0}, {0.125F, 0.5F, 0}}};
  for (std::size_t s = 1; s < tiny.triangles.size(); s += 2) {
    std::reverse(tiny.triangles[s].begin(), tiny.triangles[s].end());  // no order that a stream could count on
  }
  parts.vertex_count = static_cast<std::uint32_t>(tiny.rest.size() / 3);
  parts.triangle_count = static_cast<std::uint32_t>(tiny.corners.size());
  parts.rest_hash = sc_hash_positions(tiny.rest.data(), parts.vertex_count, 12);
  // A buffer of four vertices, and one of the rest.
  const std::uint32_t rest = parts.vertex_count - 4;
  parts.buffers = {{1, 0, 0, 4, sc_hash_positions(tiny.rest.data(), 4, 12)},
                   {0, 2, 4, rest, sc_hash_positions(tiny.rest.data() + 12, rest, 12)}};
  add_chains(parts, random);
}

}  // namespace

float uniform(std::mt19937& random, float low, float high) {
  return low + (high - low) * (static_cast<float>(random() >> 8) / 16777216.0F);
}

std::vector<Sphere> random_spheres(std::size_t count, std::mt19937& random) {
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    if (random() % 2 == 0) {
      const auto eighths = [&](unsigned below) { return static_cast<float>(random() % below) / 8.0F; };
      spheres.push_back({eighths(8), eighths(8), eighths(8), eighths(3)});
    } else {
      const auto any = [&] { return uniform(random, 0.0F, 1.0F); };
      spheres.push_back({any(), any(), any(), uniform(random, 0.01F, 0.25F)});
    }
  }
  return spheres;
}

TinyAsset random_asset(std::size_t sphere_count, unsigned seed) {
  std::mt19937 random(seed);
  TinyAsset tiny;
  for (std::size_t i = 0; i < sphere_count; ++i) {
    const auto any = [&] { return uniform(random, 0, 1); };
    const Vec3 center{any(), any(), any()};
    add_sphere(tiny, center, uniform(random, 0.05F, 0.25F));
    add_pivots(tiny, tiny.parts.spheres.back());
  }
  finish(tiny, random);
  set_ignored(tiny, [&](std::uint32_t, std::uint32_t) { return random() % 5 == 0; });
  add_rest_pairs(tiny.parts, random);
  return tiny;
}

TinyAsset random_band(std::size_t sphere_count, unsigned seed) {
  constexpr std::uint32_t kRow = 4;  // vertices
  std::mt19937 random(seed);
  TinyAsset tiny;
  Vec3 middle{0.5F, 0.5F, 0.5F};
  const auto add_row = [&] {
    const auto first = static_cast<std::uint32_t>(tiny.rest.size() / 3);
    const auto step = [&] { return uniform(random, -0.25F, 0.25F); };
    const auto inside = [](float x) { return std::min(std::max(x, 0.0F), 1.0F); };
    middle = {inside(middle.x + step()), inside(middle.y + step()), inside(middle.z + step())};
    for (std::uint32_t k = 0; k < kRow; ++k) {
      const float across = 0.1F * static_cast<float>(k);
      tiny.rest.insert(tiny.rest.end(), {middle.x + across + step() / 4, middle.y + step() / 4, middle.z + step() / 4});
    }
    return first;
  };
  for (std::uint32_t s = 0, last = add_row(); s < sphere_count; ++s) {
    if (s % 2 == 1) {  // at the same positions as the last row: vertices of their own
      const std::vector<float> row(tiny.rest.end() - 3 * kRow, tiny.rest.end());
      last = static_cast<std::uint32_t>(tiny.rest.size() / 3);
      tiny.rest.insert(tiny.rest.end(), row.begin(), row.end());
    }
    add_sphere(tiny, middle, 0.25F);
    for (int row = 0; row < 2; ++row) {
      const std::uint32_t next = add_row();
      for (std::uint32_t k = 0; k + 1 < kRow; ++k) {
        add_triangle(tiny, s, {last + k, last + k + 1, next + k});
        add_triangle(tiny, s, {next + k + 1, next + k, last + k + 1});
      }
      last = next;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const auto& [a, b, c] = tiny.corners[tiny.triangles[s][3 * k]];
      tiny.parts.pivots.push_back({a, b, c, 0.25F});
    }
  }
  finish(tiny, random);
  set_ignored(tiny, [](std::uint32_t a, std::uint32_t b) { return b == a + 1; });
  return tiny;
}

}  // namespace spherechain::test
