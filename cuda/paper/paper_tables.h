// SPDX-License-Identifier: MIT
// What the paper's threads read of an asset, in the host's memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "paper_threads.h"

namespace spherechain::cuda_paper {

// The asset, open, must outlive it.
struct Tables {
  Tables(const AssetView& asset_, Radius radius_) : asset(&asset_), radius(radius_), chain_begin{0} {
    for (std::size_t c = 0; c < asset->chain_count(); ++c) {
      const Span<const std::uint32_t> spheres = asset->chain(c).spheres;
      members.insert(members.end(), spheres.begin(), spheres.end());
      chain_begin.push_back(static_cast<std::uint32_t>(members.size()));
      longest_chain = std::max(longest_chain, static_cast<std::uint32_t>(spheres.size));
    }
  }

  std::uint32_t sphere_count() const { return static_cast<std::uint32_t>(asset->spheres().size); }
  std::uint32_t chain_count() const { return static_cast<std::uint32_t>(asset->chain_count()); }

  // For threads on the host.
  Scene scene(const Sphere* spheres) const {
    const Span<const RestPair> rest = asset->rest_pairs(radius);
    return {spheres,        sphere_count(),        chain_begin.data(), chain_count(),
            members.data(), asset->ignored().data, rest.data,          static_cast<std::uint32_t>(rest.size)};
  }

  const AssetView* asset;
  Radius radius;
  std::vector<std::uint32_t> chain_begin, members;
  std::uint32_t longest_chain = 0;
};

}  // namespace spherechain::cuda_paper
