// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "baker/bind/bind_moments.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kBatchPairs = 96;

using Pairs = std::vector<BonePair>;  // sorted

Pairs pairs_of(const std::vector<Index>& bones) {
  Pairs out;
  for (std::size_t k = 0; k < bones.size(); ++k) {
    for (std::size_t l = k; l < bones.size(); ++l) out.push_back({bones[k], bones[l]});
  }
  return out;
}

// Saving from putting both into one batch: shared pairs are stored once, and there is one batch less. 0 if they do not
// fit into one.
std::size_t gain_of(const Pairs& a, const Pairs& b) {
  Pairs shared;
  std::ranges::set_intersection(a, b, std::back_inserter(shared));
  const std::size_t together = a.size() + b.size() - shared.size();
  return together <= std::max({kBatchPairs, a.size(), b.size()}) ? shared.size() + 1 : 0;
}

struct Cluster {
  Pairs pairs;
  std::vector<const SphereMoments*> spheres;
};

// Puts together, again and again, the two clusters that gain most by it.
std::vector<Cluster> merge(std::vector<Cluster> clusters) {
  std::vector<std::vector<std::size_t>> gains;  // with those before
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    std::vector<std::size_t>& row = gains.emplace_back();
    for (std::size_t j = 0; j < i; ++j) row.push_back(gain_of(clusters[i].pairs, clusters[j].pairs));
  }
  while (true) {
    std::size_t most = 0, keep = 0, drop = 0;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (gains[i][j] > most) {
          most = gains[i][j];
          keep = j;
          drop = i;
        }
      }
    }
    if (most == 0) return clusters;
    Pairs together;
    std::ranges::set_union(clusters[keep].pairs, clusters[drop].pairs, std::back_inserter(together));
    clusters[keep].pairs = std::move(together);
    clusters[keep].spheres.insert(clusters[keep].spheres.end(), clusters[drop].spheres.begin(),
                                  clusters[drop].spheres.end());
    const auto at = static_cast<std::ptrdiff_t>(drop);
    clusters.erase(clusters.begin() + at);
    gains.erase(gains.begin() + at);
    for (std::size_t i = drop; i < gains.size(); ++i) gains[i].erase(gains[i].begin() + at);
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      if (i == keep) continue;
      gains[std::max(i, keep)][std::min(i, keep)] = gain_of(clusters[keep].pairs, clusters[i].pairs);
    }
  }
}

}  // namespace

std::vector<MomentBatch> make_batches(const std::vector<SphereMoments>& spheres) {
  std::map<std::vector<Index>, Cluster> of_bones;
  for (const SphereMoments& sphere : spheres) {
    Cluster& cluster = of_bones[sphere.bones];
    cluster.pairs = pairs_of(sphere.bones);
    cluster.spheres.push_back(&sphere);
  }
  std::vector<Cluster> clusters;
  clusters.reserve(of_bones.size());
  for (auto& [bones, cluster] : of_bones) clusters.push_back(std::move(cluster));

  std::vector<MomentBatch> out;
  for (Cluster& cluster : merge(std::move(clusters))) {
    MomentBatch& batch = out.emplace_back();
    batch.pairs = std::move(cluster.pairs);
    for (const SphereMoments* sphere : cluster.spheres) {
      batch.spheres.push_back(*sphere);
      for (const BonePair& pair : pairs_of(sphere->bones)) {
        const auto place = std::ranges::lower_bound(batch.pairs, pair);
        batch.spheres.back().places.push_back(static_cast<std::uint8_t>(place - batch.pairs.begin()));
      }
    }
  }
  return out;
}

}  // namespace spherechain::baker
