// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tiny_bones.h"

namespace spherechain::test {
namespace {

using Vector4 = std::array<double, 4>;
using BoneSet = std::vector<std::uint16_t>;

constexpr Vec3 kOrigin{0.375F, 0.5F, 0.625F};

// Contribution of each bone to one pivot's centroid, positions relative to the origin.
std::map<std::uint16_t, Vector4> pivot_contributions(const TinyAsset& tiny, const TinySkin& skin, const Pivot& pivot) {
  std::map<std::uint16_t, Vector4> out;
  for (const std::uint32_t v : {pivot.a, pivot.b, pivot.c}) {
    const double corner[4] = {double{tiny.rest[3 * v]} - double{kOrigin.x},
                              double{tiny.rest[3 * v + 1]} - double{kOrigin.y},
                              double{tiny.rest[3 * v + 2]} - double{kOrigin.z}, 1};
    for (const auto& [bone, weight] : skin.weights[v]) {
      for (std::size_t axis = 0; axis < 4; ++axis) {
        out[static_cast<std::uint16_t>(bone)][axis] += weight / 3 * corner[axis];
      }
    }
  }
  return out;
}

// A sphere's pivots as its bones move them, as shares of the centre and as differences from it.
struct SphereParts {
  SphereParts(const TinyAsset& tiny, const TinySkin& skin, const RestSphere& sphere) {
    const auto first = tiny.parts.pivots.begin() + sphere.first_pivot;
    std::vector<std::map<std::uint16_t, Vector4>> parts;
    for (auto pivot = first; pivot != first + sphere.pivot_count; ++pivot) {
      parts.push_back(pivot_contributions(tiny, skin, *pivot));
      for (const auto& [bone, q] : parts.back()) {
        for (std::size_t axis = 0; axis < 4; ++axis) {
          centers[bone][axis] += double{pivot->weight} * q[axis];
        }
      }
    }
    for (auto& part : parts) {
      std::map<std::uint16_t, Vector4>& own = differences.emplace_back();
      for (const auto& [bone, u] : centers) {
        for (std::size_t axis = 0; axis < 4; ++axis) {
          own[bone][axis] = part[bone][axis] - u[axis];
        }
      }
    }
    for (const auto& [bone, u] : centers) {
      bones.push_back(bone);
    }
  }

  // At rest, where every bone leaves everything as it is.
  double spread() const {
    double sum = 0;
    for (const auto& own : differences) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double d = 0;
        for (const auto& [bone, v] : own) {
          d += v[axis];
        }
        sum += d * d;
      }
    }
    return sum > 0 ? std::sqrt(sum / static_cast<double>(differences.size())) : 1;  // of one pivot: any
  }

  Moment moment(std::uint16_t k, std::uint16_t l, double spread) const {
    Moment out{};
    for (std::size_t i = 0; i < kMomentSize; ++i) {
      double sum = 0;
      for (const auto& own : differences) {
        sum += own.at(k)[i / 4] * own.at(l)[i % 4];
      }
      const double times = k != l || i / 4 < i % 4 ? 2 : i / 4 == i % 4 ? 1 : 0;
      out.values[i] = static_cast<float>(times * sum / (static_cast<double>(differences.size()) * spread * spread));
    }
    return out;
  }

  BoneSet bones;
  std::map<std::uint16_t, Vector4> centers;
  std::vector<std::map<std::uint16_t, Vector4>> differences;  // of each pivot
};

using PairSet = std::set<std::pair<std::uint16_t, std::uint16_t>>;

void add_pairs(const BoneSet& bones, PairSet& pairs) {
  for (std::size_t k = 0; k < bones.size(); ++k) {
    for (std::size_t l = k; l < bones.size(); ++l) {
      pairs.insert({bones[k], bones[l]});
    }
  }
}

void add_sphere(const SphereParts& sphere, std::uint32_t i, double spread, const PairSet& pairs, MomentParts& out) {
  out.spheres.push_back(i);
  out.bone_counts.push_back(static_cast<std::uint8_t>(sphere.bones.size()));
  for (const std::uint16_t bone : sphere.bones) {
    const Vector4& u = sphere.centers.at(bone);
    out.bones.push_back(bone);
    out.centers.push_back(
        {static_cast<float>(u[0]), static_cast<float>(u[1]), static_cast<float>(u[2]), static_cast<float>(u[3])});
  }
  PairSet own;
  add_pairs(sphere.bones, own);
  for (const auto& pair : own) {
    out.pair_places.push_back(static_cast<std::uint8_t>(std::distance(pairs.begin(), pairs.find(pair))));
    out.moments.push_back(sphere.moment(pair.first, pair.second, spread));
  }
}

}  // namespace

void add_moments(TinyAsset& tiny, const TinySkin& skin, std::size_t batch_pairs) {
  AssetParts& parts = tiny.parts;
  std::vector<SphereParts> spheres;
  std::vector<std::uint32_t> order;
  for (RestSphere& sphere : parts.spheres) {
    order.push_back(static_cast<std::uint32_t>(spheres.size()));
    spheres.emplace_back(tiny, skin, sphere);
    sphere.pivot_spread = static_cast<float>(spheres.back().spread());
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return spheres[a].bones < spheres[b].bones; });

  MomentParts& out = parts.moments = {};
  out.origin = kOrigin;
  out.reference = static_cast<std::uint32_t>(parts.bones.size() / 2);
  for (std::size_t first = 0; first < order.size();) {
    PairSet pairs;
    std::size_t end = first;
    for (PairSet more; end < order.size(); ++end) {
      add_pairs(spheres[order[end]].bones, more);
      if (end > first && more.size() > batch_pairs) {
        break;
      }
      pairs = more;
    }
    out.batches.push_back({static_cast<std::uint32_t>(pairs.size()), static_cast<std::uint32_t>(end - first)});
    for (const auto& [a, b] : pairs) {
      out.pairs.push_back({a, b});
    }
    for (; first < end; ++first) {
      const std::uint32_t i = order[first];
      add_sphere(spheres[i], i, double{parts.spheres[i].pivot_spread}, pairs, out);
    }
  }
}

}  // namespace spherechain::test
