// SPDX-License-Identifier: MIT
#include "depth/visibility.h"

#include <algorithm>

namespace spherechain {
namespace {

constexpr std::size_t kSampled = 8;    // segments
constexpr std::size_t kSearched = 32;  // until one is seen

// Does the ray meet the triangle? (Moeller and Trumbore)
bool meets(const Double3& from, const Double3& direction, const Corners& t) {
  const Double3 e = t.p[1] - t.p[0], f = t.p[2] - t.p[0], p = cross(direction, f);
  const double determinant = dot(e, p);
  if (!(determinant > 0) && !(determinant < 0)) {
    return false;
  }
  const Double3 r = from - t.p[0], q = cross(r, e);
  const double s = dot(r, p) / determinant, u = dot(direction, q) / determinant;
  return s >= 0 && u >= 0 && s + u <= 1 && dot(f, q) / determinant > 0;
}

}  // namespace

bool Visibility::is_free(const Double3& from, const Double3& direction) {
  for (const Blocker& blocker : blockers_) {
    if (blocker.skin != nullptr && meets(from, direction, blocker.skin->corners(blocker.triangle))) {
      return false;
    }
  }
  return !meets_skin(skins_.a, from, direction) && (skins_.are_one() || !meets_skin(skins_.b, from, direction));
}

bool Visibility::meets_skin(const PosedSkin& skin, const Double3& from, const Double3& direction) {
  const Surface& surface = *skin.surface;
  const double start[3] = {from.x, from.y, from.z};
  const double slope[3] = {1 / direction.x, 1 / direction.y, 1 / direction.z};
  const auto meets_box = [&](const float* const(&low)[3], const float* const(&high)[3], std::size_t i) {
    double enter = 0, leave = HUGE_VAL;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double s = (double{low[axis][i]} - start[axis]) * slope[axis];
      const double t = (double{high[axis][i]} - start[axis]) * slope[axis];
      enter = std::max(enter, std::min(s, t));
      leave = std::min(leave, std::max(s, t));
    }
    return !(enter > leave);
  };
  for (std::size_t c = 0; c < surface.clusters.size; ++c) {
    if (c % PosedSkin::kGroup == 0 && !meets_box(skin.group_low, skin.group_high, c / PosedSkin::kGroup)) {
      c += PosedSkin::kGroup - 1;
      continue;
    }
    if (!meets_box(skin.low, skin.high, c)) {
      continue;
    }
    const Cluster& cluster = surface.clusters[c];
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      if (meets(from, direction, skin.corners(t))) {
        blockers_[next_blocker_++ % kBlockers] = {&skin, t};
        return true;
      }
    }
  }
  return false;
}

double Visibility::best_cosine(const Segment3& segment, const Double3 (&axes)[3], double clearance, Double3& free) {
  Double3 out = segment.normal_a + segment.normal_b;
  if (!normalize(out)) {
    out = segment.normal_a;
  }
  const Double3 from = 0.5 * (segment.from + segment.to) + clearance * out;
  const auto cosine_of = [&](const Double3& direction) {
    return std::max(0.0, std::min(dot(direction, segment.normal_a), dot(direction, segment.normal_b)));
  };
  if (is_free(from, out)) {
    return cosine_of(out);  // none is better
  }
  double best = is_free(from, free) ? cosine_of(free) : -1;
  for (int k = 0; k < 27; ++k) {
    Double3 direction = double(k % 3 - 1) * axes[0] + (double(k / 3 % 3 - 1) * axes[1] + double(k / 9 - 1) * axes[2]);
    if (normalize(direction) && cosine_of(direction) > best && is_free(from, direction)) {
      best = cosine_of(direction);
      free = direction;
    }
  }
  return best;
}

Seen Visibility::look(const Contour& contour, const Double3 (&axes)[3], double clearance) {
  std::fill(blockers_, blockers_ + kBlockers, Blocker{nullptr, 0});
  const std::size_t size = contour.segments.size;
  Double3 free = axes[0];  // the last ray that left: likely to be free again
  for (const std::size_t wanted : {kSampled, kSearched}) {
    const std::size_t step = (size + wanted - 1) / wanted, first = step / 2;
    const std::size_t count = (size - first + step - 1) / step;
    std::size_t seen = 0;
    double cosines = 0;
    for (std::size_t i = first; i < size && (wanted == kSampled || seen == 0); i += step) {
      const double cosine = best_cosine(contour.segments[i], axes, clearance, free);
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
