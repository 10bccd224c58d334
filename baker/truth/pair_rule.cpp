// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/pair_rule.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "bind/bind.h"
#include "truth/surface.h"

namespace spherechain::baker {
namespace {

constexpr double kUsualFraction = BindSettings{}.rest_fraction;
constexpr float kNever = std::numeric_limits<float>::infinity();

double rest_radius(const RestSphere& sphere, RadiusKind kind) {
  return kind == RadiusKind::kFit ? sphere.radius : sphere.detect_radius;
}

double rest_distance(const RestSphere& a, const RestSphere& b) {
  return std::hypot(double{a.center.x} - b.center.x, double{a.center.y} - b.center.y, double{a.center.z} - b.center.z);
}

// The part of the rest distance that the asset's near pairs are reported at.
double own_fraction(const Asset& asset, RadiusKind kind) {
  std::vector<double> parts;
  for (const NearPair& near : asset.near_pairs(kind)) {
    const RestSphere &a = asset.spheres()[near.a], &b = asset.spheres()[near.b];
    parts.push_back(near.reach * (rest_radius(a, kind) + rest_radius(b, kind)) / rest_distance(a, b));
  }
  if (parts.empty()) return kUsualFraction;
  const auto middle = parts.begin() + static_cast<std::ptrdiff_t>(parts.size() / 2);
  std::nth_element(parts.begin(), middle, parts.end());
  return *middle;
}

}  // namespace

PairRule::PairRule(const Asset& asset, RadiusKind radius, const RuleChange& change)
    : scale_(static_cast<float>(change.scale)) {
  const double fraction = change.rest_fraction.value_or(own_fraction(asset, radius));
  const Span<const RestSphere> spheres = asset.spheres();
  const Span<const NearPair> near = asset.near_pairs(radius);
  const auto before = [](const NearPair& l, const Pair& r) { return Pair{l.a, l.b} < r; };
  for (std::uint32_t a = 0; a < spheres.size; ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size; ++b) {
      if (is_ignored(asset, a, b)) continue;
      const double distance = rest_distance(spheres[a], spheres[b]);
      const double sum = rest_radius(spheres[a], radius) + rest_radius(spheres[b], radius);
      const NearPair* own = std::lower_bound(near.begin(), near.end(), Pair{a, b}, before);
      const bool is_own = own != near.end() && own->a == a && own->b == b;
      // At scale 1 the asset says which pairs are near; one it does not list is none.
      float reach = kNever;
      if (is_own && !change.rest_fraction) {
        reach = own->reach / scale_;
      } else if (const double part = fraction * distance / (change.scale * sum);
                 part < 1 && (change.rest_fraction || change.scale > 1)) {
        reach = static_cast<float>(part);
      }
      entries_.push_back({{a, b}, reach});
    }
  }
}

std::vector<Pair> PairRule::pairs(const std::vector<Sphere>& spheres) const {
  std::vector<Pair> out;
  for (const auto& [pair, reach] : entries_) {
    const Sphere &a = spheres[pair.a], &b = spheres[pair.b];
    const float dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
    const float sum = (a.radius + b.radius) * scale_, limit = reach == kNever ? sum : reach * sum;
    const float squared = (dx * dx + dy * dy) + dz * dz;
    if (squared < sum * sum && squared < limit * limit) out.push_back(pair);
  }
  return out;
}

ChainMembers::ChainMembers(const Asset& asset) {
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const ChainView chain = asset.chain(c);
    names_.emplace_back(chain.name);
    in_.emplace_back(asset.spheres().size);
    for (const std::uint32_t sphere : chain.spheres) in_.back()[sphere] = true;
  }
}

bool ChainMembers::share_one(const Pair& pair) const {
  for (std::size_t c = 0; c < in_.size(); ++c) {
    if (holds(c, pair)) return true;
  }
  return false;
}

std::vector<Pair> ChainMembers::sharing(const std::vector<Pair>& pairs) const {
  std::vector<Pair> out;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(out), [&](const Pair& pair) { return share_one(pair); });
  return out;
}

}  // namespace spherechain::baker
