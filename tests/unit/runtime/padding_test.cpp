// SPDX-License-Identifier: MIT
// A filter's padding, against a plain loop over all pairs.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kInstances = 19;  // a wide register and some

// From three radii less to one more; some to a radius of 0, and some to the next below it.
void pad_randomly(const Asset& asset, const std::vector<Sphere>& spheres, std::mt19937& random, Filter& filter) {
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    const float radius = spheres[i].radius;
    float padding = radius * uniform(random, -3, 1);
    if (i % 5 == 3) padding = -radius;
    if (i % 5 == 4) padding = std::nextafter(-radius, -1.0F);
    REQUIRE(sc_pad_sphere(&asset, &filter, i, padding) == SC_OK);
  }
}

std::vector<Pair> touching_pairs(const TinyAsset& tiny, const std::vector<Sphere>& spheres,
                                 const std::vector<float>& padding) {
  std::vector<Pair> pairs;
  const std::set<Pair> ignored(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end());
  for (std::uint32_t a = 0; a < spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size(); ++b) {
      const Sphere &p = spheres[a], &q = spheres[b];
      const float ra = p.radius + padding[a], rb = q.radius + padding[b];
      if (ra < 0 || rb < 0 || ignored.count({a, b}) != 0) continue;
      float scale = 1;
      for (const RestPair& rest : tiny.parts.rest_detect) {
        if (rest.a == a && rest.b == b) scale = rest.rest_scale;
      }
      const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, t = scale * (ra + rb);
      if ((dx * dx + dy * dy) + dz * dz < t * t) pairs.push_back({a, b});
    }
  }
  return pairs;
}

std::vector<CrowdPair> crowd_pairs(const Asset& asset, const std::vector<Sphere>& spheres, const Filter& filter,
                                   Target target, std::size_t room) {
  CrowdBuffers buffers(asset, kInstances, 2);
  std::vector<CrowdPair> pairs(room);
  buffers.job.spheres = spheres.data();
  buffers.job.filter = &filter;
  buffers.job.target = target;
  buffers.job.pairs = pairs.data();
  buffers.job.pair_capacity = pairs.size();
  REQUIRE(buffers.job.run() == SC_OK);
  pairs.resize(buffers.job.pair_count);
  return pairs;
}

}  // namespace

TEST_CASE("spheres padded to below 0 touch nothing: every job, target and table has a plain loop's pairs") {
  for (const unsigned n : {2U, 20U, 70U, 128U, 150U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const TinyAsset tiny = random_asset(n, n);
    const OpenedAsset opened(tiny.parts);
    std::vector<std::vector<Sphere>> poses;
    std::vector<Sphere> crowd;
    for (std::size_t i = 0; i < kInstances; ++i) {
      poses.push_back(random_spheres(n, random));
      crowd.insert(crowd.end(), poses[i].begin(), poses[i].end());
    }
    OwnedFilter owned(opened.asset);
    pad_randomly(opened.asset, poses[0], random, owned.filter);
    const std::vector<Pair> wanted = touching_pairs(tiny, poses[0], owned.padding);
    CHECK((wanted.empty() == (n == 2)));
    std::vector<CrowdPair> of_crowd;
    for (std::uint32_t i = 0; i < kInstances; ++i) {
      for (const Pair& pair : touching_pairs(tiny, poses[i], owned.padding)) of_crowd.push_back({i, pair});
    }
    for (const Target target : supported_targets()) {
      INFO(std::string(sc_target_name(target)));
      const Detected found = detect(opened.asset, poses[0], SC_RADIUS_DETECT, target, &owned.filter);
      CHECK(found.status == SC_OK);
      CHECK(found.pairs == wanted);
      CHECK(same_bits(crowd_pairs(opened.asset, crowd, owned.filter, target, 3 * of_crowd.size() + 99), of_crowd));
    }
  }
}

}  // namespace spherechain::test
