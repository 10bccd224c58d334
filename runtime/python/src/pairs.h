// SPDX-License-Identifier: MIT
// The pairs of spheres that touch, for one thread, however many they are.
#pragma once

#include "loaded_asset.h"
#include "pairs/detect_job.h"

namespace spherechain::python {

class PairFinder {
 public:
  PairFinder(const LoadedAsset& asset, Radius radius) : pairs_(kFirstCapacity) {
    job_.asset = &asset.asset();
    job_.sphere_count = asset.info().sphere_count;
    job_.radius = radius;
    job_.table = asset.detect_table(radius);
  }

  // Valid until the next call.
  Span<const Pair> find(const Sphere* spheres) {
    job_.spheres = spheres;
    Status status = run();
    if (status == SC_OVERFLOW) {
      pairs_.resize(job_.pair_count);
      status = run();
    }
    require(status);
    return {pairs_.data(), job_.pair_count};
  }

 private:
  static constexpr std::size_t kFirstCapacity = 256;

  Status run() {
    job_.pairs = pairs_.data();
    job_.pair_capacity = pairs_.size();
    return job_.run();
  }

  DetectJob job_;
  std::vector<Pair> pairs_;
};

}  // namespace spherechain::python
