// SPDX-License-Identifier: MIT
#include "runtime/src/penetrations/visibility.h"

#include <algorithm>

namespace spherechain {
namespace {

constexpr std::size_t kSampled = 8;    // segments
constexpr std::size_t kSearched = 32;  // until one is seen
constexpr float kRounding = 4e-6F;     // relative; several times the rounding error of a vertex's place in view

// A bit for each of eight half-planes around the line of sight that a vertex lies in, in its slot of a cluster. No
// triangle whose corners share a half-plane meets the line.
constexpr std::size_t kSlotsMax = 256;
using Sides = std::int32_t[kSlotsMax];

void find_sides(const PosedSkin& skin, std::size_t c, const Sight& sight, Sides& sides) {
  const Cluster& cluster = skin.surface->clusters[c];
  const std::uint32_t* const vertices = skin.surface->cluster_vertices.data + cluster.first_vertex;
  const Vec3 u = to_float(sight.view.u), v = to_float(sight.view.v), from = to_float(sight.view.origin);
  float farthest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    farthest += std::max(std::abs(skin.low[axis][c]), std::abs(skin.high[axis][c]));
  }
  const float error = kRounding * (farthest + std::abs(from.x) + std::abs(from.y) + std::abs(from.z));
  float s[kSlotsMax], t[kSlotsMax];
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    const float* const p = skin.positions + 3 * std::size_t{vertices[i]};
    const float x = p[0] - from.x, y = p[1] - from.y, z = p[2] - from.z;
    s[i] = u.x * x + (u.y * y + u.z * z);
    t[i] = v.x * x + (v.y * y + v.z * z);
  }
  const auto code = [&](float side, std::int32_t bit) {
    return (side > error ? bit : 0) | (side < -error ? 2 * bit : 0);
  };
  for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
    sides[i] = code(s[i], 1) | code(t[i], 4) | code(s[i] + t[i], 16) | code(s[i] - t[i], 64);
  }
}

}  // namespace

bool Visibility::is_free(const Sight& sight) {
  for (const Blocker& blocker : blockers_) {
    if (blocker.skin != nullptr && sight.ray.reach(blocker.skin->corners(blocker.triangle)) < HUGE_VAL) {
      return false;
    }
  }
  return !meets_skin(skins_.a, sight) && (skins_.are_one() || !meets_skin(skins_.b, sight));
}

bool Visibility::meets_skin(const PosedSkin& skin, const Sight& sight) {
  for (std::size_t c = 0; c < skin.surface->clusters.size; ++c) {
    if (c % PosedSkin::kGroup == 0 && !sight.ray.meets(skin.group_low, skin.group_high, c / PosedSkin::kGroup)) {
      c += PosedSkin::kGroup - 1;
      continue;
    }
    if (sight.ray.meets(skin.low, skin.high, c) && meets_cluster(skin, c, sight)) {
      return true;
    }
  }
  return false;
}

bool Visibility::meets_cluster(const PosedSkin& skin, std::size_t c, const Sight& sight) {
  const Cluster& cluster = skin.surface->clusters[c];
  Sides sides;
  find_sides(skin, c, sight, sides);
  const std::uint8_t* corner = skin.surface->corners.data + 3 * std::size_t{cluster.first_triangle};
  for (std::uint32_t i = 0; i < cluster.triangle_count; ++i, corner += 3) {
    const std::uint32_t t = cluster.first_triangle + i;
    if ((sides[corner[0]] & sides[corner[1]] & sides[corner[2]]) == 0 && sight.ray.reach(skin.corners(t)) < HUGE_VAL) {
      blockers_[next_blocker_++ % kBlockers] = {&skin, t};
      return true;
    }
  }
  return false;
}

double Visibility::best_cosine(const Segment3& segment, const Double3 (&axes)[3], const Gaze& gaze, Double3& free) {
  Double3 out = segment.normal_a + segment.normal_b;
  if (!normalize(out)) {
    out = segment.normal_a;
  }
  const Double3 from = 0.5 * (segment.from + segment.to) + gaze.clearance * out;
  const auto cosine_of = [&](const Double3& direction) {
    return std::max(0.0, std::min(dot(direction, segment.normal_a), dot(direction, segment.normal_b)));
  };
  if (is_free({from, out})) {
    return cosine_of(out);  // none is better
  }
  double best = is_free({from, free}) ? cosine_of(free) : -1;
  for (int k = 0; k < 27 && (best < 0 || gaze.wants_length); ++k) {
    const int u = k % 3 - 1, v = k / 3 % 3 - 1, w = k / 9 - 1;
    Double3 direction = double(u) * axes[0] + (double(v) * axes[1] + double(w) * axes[2]);
    if (normalize(direction) && cosine_of(direction) > best && is_free({from, direction})) {
      best = cosine_of(direction);
      free = direction;
    }
  }
  return best;
}

Seen Visibility::look(const Contour& contour, const Double3 (&axes)[3], const Gaze& gaze) {
  std::fill(blockers_, blockers_ + kBlockers, Blocker{nullptr, 0});
  const std::size_t size = contour.segments.size;
  Double3 free = axes[0];  // the last ray that left: likely to be free again
  for (const std::size_t wanted : {kSampled, kSearched}) {
    const std::size_t step = (size + wanted - 1) / wanted, first = step / 2;
    const std::size_t count = (size - first + step - 1) / step;
    std::size_t seen = 0;
    double cosines = 0;
    for (std::size_t i = first; i < size && (wanted == kSampled || seen == 0); i += step) {
      const double cosine = best_cosine(contour.segments[i], axes, gaze, free);
      seen += cosine >= 0 ? 1 : 0;
      cosines += std::max(0.0, cosine);
    }
    if (seen > 0 || step == 1) {
      return {static_cast<double>(seen) / static_cast<double>(count),
              contour.length * cosines / static_cast<double>(count)};
    }
  }
  return {0, 0};
}

}  // namespace spherechain
