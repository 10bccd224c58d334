// SPDX-License-Identifier: MIT
#include "runtime/src/penetrations/visibility.h"

#include <algorithm>

namespace spherechain {
namespace {

constexpr std::size_t kSampled = 8;    // segments
constexpr std::size_t kSearched = 32;  // until one is seen

}  // namespace

bool Visibility::is_free(const Ray& ray) {
  for (const Blocker& blocker : blockers_) {
    if (blocker.skin != nullptr && ray.reach(blocker.skin->corners(blocker.triangle)) < HUGE_VAL) {
      return false;
    }
  }
  return !meets_skin(skins_.a, ray) && (skins_.are_one() || !meets_skin(skins_.b, ray));
}

bool Visibility::meets_skin(const PosedSkin& skin, const Ray& ray) {
  const Surface& surface = *skin.surface;
  for (std::size_t c = 0; c < surface.clusters.size; ++c) {
    if (c % PosedSkin::kGroup == 0 && !ray.meets(skin.group_low, skin.group_high, c / PosedSkin::kGroup)) {
      c += PosedSkin::kGroup - 1;
      continue;
    }
    if (!ray.meets(skin.low, skin.high, c)) {
      continue;
    }
    const Cluster& cluster = surface.clusters[c];
    for (std::uint32_t t = cluster.first_triangle; t < cluster.first_triangle + cluster.triangle_count; ++t) {
      if (ray.reach(skin.corners(t)) < HUGE_VAL) {
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
  if (is_free({from, out})) {
    return cosine_of(out);  // none is better
  }
  double best = is_free({from, free}) ? cosine_of(free) : -1;
  for (int k = 0; k < 27; ++k) {
    const int u = k % 3 - 1, v = k / 3 % 3 - 1, w = k / 9 - 1;
    Double3 direction = double(u) * axes[0] + (double(v) * axes[1] + double(w) * axes[2]);
    if (normalize(direction) && cosine_of(direction) > best && is_free({from, direction})) {
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
