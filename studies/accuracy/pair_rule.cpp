// SPDX-License-Identifier: GPL-3.0-or-later
#include "pair_rule.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "baker/bind/bind.h"
#include "baker/truth/surface.h"

namespace spherechain::baker {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();

double rest_radius(const RestSphere& sphere, Radius kind) {
  return kind == SC_RADIUS_FIT ? sphere.radius : sphere.detect_radius;
}

double rest_distance(const RestSphere& a, const RestSphere& b) {
  return std::hypot(double{a.center.x} - b.center.x, double{a.center.y} - b.center.y, double{a.center.z} - b.center.z);
}

// The part of the rest distance that the asset's rest_pairs pairs are reported at.
double own_fraction(const OpenAsset& asset, Radius kind) {
  std::vector<double> parts;
  for (const RestPair& pair : asset->rest_pairs(kind)) {
    const RestSphere &a = asset->spheres()[pair.a], &b = asset->spheres()[pair.b];
    parts.push_back(pair.rest_scale * (rest_radius(a, kind) + rest_radius(b, kind)) / rest_distance(a, b));
  }
  if (parts.empty()) return kPaperRestScale;
  const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
  std::nth_element(parts.begin(), middle, parts.end());
  return *middle;
}

}  // namespace

PairRule::PairRule(const OpenAsset& asset, Radius radius, const RuleChange& change)
    : scale_(static_cast<float>(change.scale)) {
  const double fraction = change.rest_scale.value_or(own_fraction(asset, radius));
  const Span<const RestSphere> spheres = asset->spheres();
  const Span<const RestPair> rest_pairs = asset->rest_pairs(radius);
  const auto before = [](const RestPair& l, const Pair& r) { return Pair{l.a, l.b} < r; };
  for (std::uint32_t a = 0; a < spheres.size; ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size; ++b) {
      if (is_ignored(asset, a, b)) continue;
      const double distance = rest_distance(spheres[a], spheres[b]);
      const double sum = rest_radius(spheres[a], radius) + rest_radius(spheres[b], radius);
      const RestPair* own = std::lower_bound(rest_pairs.begin(), rest_pairs.end(), Pair{a, b}, before);
      const bool is_own = own != rest_pairs.end() && own->a == a && own->b == b;
      // At scale 1 the asset says which pairs are near; one it does not list is none.
      float rest_scale = kNever;
      if (is_own && !change.rest_scale) {
        rest_scale = own->rest_scale / scale_;
      } else if (const double part = fraction * distance / (change.scale * sum);
                 part < 1 && (change.rest_scale || change.scale > 1)) {
        rest_scale = static_cast<float>(part);
      }
      entries_.push_back({{a, b}, rest_scale});
    }
  }
}

std::vector<Pair> PairRule::pairs(const std::vector<Sphere>& spheres) const {
  std::vector<Pair> out;
  for (const auto& [pair, rest_scale] : entries_) {
    const Sphere &a = spheres[pair.a], &b = spheres[pair.b];
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    const float sum = (a.radius + b.radius) * scale_, limit = rest_scale == kNever ? sum : rest_scale * sum;
    const float squared = (dx * dx + dy * dy) + dz * dz;
    if (squared < sum * sum && squared < limit * limit) out.push_back(pair);
  }
  return out;
}

ChainMembers::ChainMembers(const OpenAsset& asset) {
  for (std::size_t c = 0; c < asset->chain_count(); ++c) {
    in_.emplace_back(asset->spheres().size);
    for (const std::uint32_t sphere : asset->chain(c).spheres) in_.back()[sphere] = true;
  }
}

bool ChainMembers::share_one(const Pair& pair) const {
  return std::any_of(in_.begin(), in_.end(), [&](const auto& in) { return in[pair.a] && in[pair.b]; });
}

std::vector<Pair> ChainMembers::sharing(const std::vector<Pair>& pairs) const {
  std::vector<Pair> out;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(out), [&](const Pair& pair) { return share_one(pair); });
  return out;
}

}  // namespace spherechain::baker
