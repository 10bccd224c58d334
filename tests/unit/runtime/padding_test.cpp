// SPDX-License-Identifier: MIT
// A filter's padding, against a plain loop over all pairs.
#include <doctest/doctest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <set>

#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "spherechain/contacts.h"
#include "spherechain/spherechain.h"
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
    REQUIRE(pad_sphere(asset, filter, i, padding) == Status::kOk);
  }
}

std::set<Pair> chained_pairs(const Asset& asset) {
  std::set<Pair> pairs;
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const Span<const std::uint32_t> spheres = asset.chain(c).spheres;
    for (std::size_t i = 0; i < spheres.size; ++i) {
      for (std::size_t k = i + 1; k < spheres.size; ++k)
        pairs.insert({std::min(spheres[i], spheres[k]), std::max(spheres[i], spheres[k])});
    }
  }
  return pairs;
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
      float reach = 1;
      for (const NearPair& near : tiny.parts.near_detect) {
        if (near.a == a && near.b == b) reach = near.reach;
      }
      const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, t = reach * (ra + rb);
      if ((dx * dx + dy * dy) + dz * dz < t * t) pairs.push_back({a, b});
    }
  }
  return pairs;
}

// The first pair alone, with a table or without.
std::vector<Pair> first_pair(const Asset& asset, const std::vector<Sphere>& spheres, const Filter& filter,
                             Target target, bool has_table) {
  std::vector<std::uint64_t> words(DetectTable::words_needed(asset));
  DetectTable table{{words.data(), words.size()}};
  REQUIRE(prepare_detect(asset, RadiusKind::kDetect, &filter, table) == Status::kOk);
  std::vector<Pair> pairs(1);
  DetectJob job;
  job.asset = &asset;
  job.spheres = {spheres.data(), spheres.size()};
  job.filter = &filter;
  job.table = has_table ? &table : nullptr;
  job.target = target;
  job.first_only = true;
  job.pairs = {pairs.data(), 1};
  REQUIRE(job.run() == Status::kOk);
  pairs.resize(job.pair_count);
  return pairs;
}

std::vector<CrowdPair> crowd_pairs(const Asset& asset, const std::vector<Sphere>& spheres, const Filter& filter,
                                   Target target, std::size_t room) {
  CrowdBuffers buffers(asset, kInstances, 2);
  std::vector<CrowdPair> pairs(room);
  buffers.job.spheres = spheres.data();
  buffers.job.filter = &filter;
  buffers.job.target = target;
  buffers.job.pairs = {pairs.data(), pairs.size()};
  REQUIRE(buffers.job.run() == Status::kOk);
  pairs.resize(buffers.job.pair_count);
  return pairs;
}

std::vector<Pair> c_pairs(const OpenedAsset& opened, const std::vector<Sphere>& spheres, const Filter& filter) {
  std::vector<std::uint64_t> memory(sc_asset_size() / 8 + 1);
  sc_detect_job job = SC_DETECT_JOB_INIT;
  REQUIRE(sc_asset_open(SC_ABI_VERSION, memory.data(), 8 * memory.size(), opened.bytes.data(), opened.bytes.size(),
                        &job.asset, nullptr, 0) == SC_OK);
  const sc_filter own = {filter.ignored.data,  filter.ignored.size, filter.disabled.data,
                         filter.disabled.size, filter.padding.data, filter.padding.size};
  std::vector<sc_sphere> c_spheres;
  for (const Sphere& s : spheres) c_spheres.push_back({s.x, s.y, s.z, s.radius});
  std::vector<sc_pair> pairs(spheres.size() * spheres.size());
  job.spheres = c_spheres.data();
  job.sphere_count = c_spheres.size();
  job.filter = &own;
  job.pairs = pairs.data();
  job.pair_capacity = pairs.size();
  REQUIRE(sc_detect(&job) == SC_OK);
  std::vector<Pair> out;
  for (std::size_t i = 0; i < job.pair_count; ++i) out.push_back({pairs[i].a, pairs[i].b});
  return out;
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
    std::vector<Pair> first = wanted, chained;
    first.resize(std::min<std::size_t>(wanted.size(), 1));
    const std::set<Pair> in_chains = chained_pairs(opened.asset);
    for (const Pair& pair : wanted) {
      if (in_chains.count(pair) != 0) chained.push_back(pair);
    }
    std::vector<CrowdPair> of_crowd;
    for (std::uint32_t i = 0; i < kInstances; ++i) {
      for (const Pair& pair : touching_pairs(tiny, poses[i], owned.padding)) of_crowd.push_back({i, pair});
    }
    for (const Target target : supported_targets()) {
      INFO(to_string(target));
      const auto pairs_by = [&](Method method) {
        const Detected found = detect(opened.asset, poses[0], method, RadiusKind::kDetect, target, &owned.filter);
        CHECK(found.status == Status::kOk);
        return found.pairs;
      };
      CHECK(pairs_by(Method::kM2) == wanted);
      CHECK(pairs_by(Method::kM1) == chained);
      for (const bool has_table : {false, true})
        CHECK(first_pair(opened.asset, poses[0], owned.filter, target, has_table) == first);
      CHECK(crowd_pairs(opened.asset, crowd, owned.filter, target, 3 * of_crowd.size() + 99) == of_crowd);
    }
    CHECK(c_pairs(opened, poses[0], owned.filter) == wanted);
  }
}

TEST_CASE("a contact of a sphere padded to below 0 has no depth and is never the deepest") {
  const OpenedAsset opened(random_asset(3, 1).parts);
  const std::vector<Sphere> spheres{{0, 0, 0, 2}, {0.25F, 0, 0, 1}, {1.5F, 0, 0, 1}};
  const std::vector<Pair> pairs{{0, 1}, {0, 2}, {1, 2}};
  OwnedFilter owned(opened.asset);
  REQUIRE(pad_sphere(opened.asset, owned.filter, 1, -1.5F) == Status::kOk);
  std::vector<Contact> contacts(3);
  ContactJob job;
  job.asset = &opened.asset;
  job.spheres = {spheres.data(), 3};
  job.pairs = {pairs.data(), 3};
  job.filter = &owned.filter;
  job.contacts = {contacts.data(), 3};
  REQUIRE(job.run() == Status::kOk);
  CHECK(job.deepest == 1);
  CHECK(contacts[1].depth == 1.5F);
  for (const std::size_t i : {0U, 2U}) {
    CHECK(std::isnan(contacts[i].depth));
    CHECK(std::isnan(contacts[i].severity));
    CHECK(contacts[i].normal.x == 1.0F);
  }
}

}  // namespace spherechain::test
