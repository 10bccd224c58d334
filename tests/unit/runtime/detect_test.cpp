// SPDX-License-Identifier: MIT
// The pairs M1 and M2 find, against a brute force written apart.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

// What the header says of one pair, without bit tables and without testing the full reach first.
class Rules {
 public:
  Rules(const TinyAsset& tiny, RadiusKind kind) : ignored_(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end()) {
    for (const NearPair& near : kind == RadiusKind::kFit ? tiny.parts.near_fit : tiny.parts.near_detect) {
      reach_[{near.a, near.b}] = near.reach;
    }
  }

  bool is_ignored(Pair pair) const { return ignored_.count(pair) > 0; }

  bool touch(Pair pair, const std::vector<Sphere>& spheres) const {
    const Sphere p = spheres[pair.a];
    const Sphere q = spheres[pair.b];
    const float dx = q.x - p.x, dy = q.y - p.y, dz = q.z - p.z;
    const float sum = p.radius + q.radius;
    const auto near = reach_.find(pair);
    const float s = near == reach_.end() ? sum : near->second * sum;
    return ((dx * dx + dy * dy) + dz * dz) < s * s;
  }

 private:
  std::set<Pair> ignored_;
  std::map<Pair, float> reach_;
};

Detected brute_force_all(const TinyAsset& tiny, const std::vector<Sphere>& spheres, RadiusKind kind) {
  const Rules rules(tiny, kind);
  Detected result{Status::kOk, {}, {}, {}, 0};
  for (std::uint32_t a = 0; a < spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size(); ++b) {
      if (!rules.is_ignored({a, b})) {
        ++result.test_count;
        if (rules.touch({a, b}, spheres)) {
          result.pairs.push_back({a, b});
        }
      }
    }
  }
  return result;
}

Detected brute_force_chains(const TinyAsset& tiny, const std::vector<Sphere>& spheres, RadiusKind kind) {
  const Rules rules(tiny, kind);
  Detected result{Status::kOk, {}, {}, {}, 0};
  std::set<Pair> unique;
  for (std::uint32_t c = 0; c < tiny.parts.chains.size(); ++c) {
    const std::vector<std::uint32_t>& members = tiny.parts.chains[c].spheres;
    for (auto i = members.begin(); i != members.end(); ++i) {
      for (auto j = i + 1; j != members.end(); ++j) {
        const Pair pair = *i < *j ? Pair{*i, *j} : Pair{*j, *i};
        if (!rules.is_ignored(pair)) {
          ++result.test_count;
          if (rules.touch(pair, spheres)) {
            result.chain_pairs.push_back({c, pair});
            unique.insert(pair);
          }
        }
      }
    }
  }
  result.pairs.assign(unique.begin(), unique.end());
  return result;
}

// FNV-1a over the pairs' numbers and where each frame ends.
struct Fnv {
  std::uint64_t hash = 14695981039346656037U;

  void add(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) hash = (hash ^ (value >> shift & 0xFF)) * 1099511628211U;
  }
  void add(const std::vector<Pair>& pairs) {
    for (const Pair& pair : pairs) add(pair.a), add(pair.b);
    add(0xFFFFFFFFU);
  }
};

// The table of the header, by its formula.
std::vector<std::uint64_t> bits_of(const std::vector<Pair>& pairs, std::size_t n) {
  std::vector<std::uint64_t> words((n * (n - 1) / 2 + 63) / 64);
  for (const Pair& pair : pairs) {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    words[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  return words;
}

}  // namespace

TEST_CASE("M1 and M2 find what a brute force finds, at every size from 1 to 140 and some more, on every target") {
  std::size_t found = 0;
  for (unsigned n = 1; n <= 400; n += n < 140 ? 1 : 65) {
    CAPTURE(n);
    const TinyAsset tiny = random_asset(n, n);
    const OpenedAsset opened(tiny.parts);
    REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
    std::mt19937 random(n);
    const std::vector<Sphere> spheres = random_spheres(n, random);
    for (const RadiusKind kind : {RadiusKind::kFit, RadiusKind::kDetect}) {
      const Detected all = brute_force_all(tiny, spheres, kind);
      const Detected chains = brute_force_chains(tiny, spheres, kind);
      for (const Target target : supported_targets()) {
        CAPTURE(to_string(target));
        const Detected m2 = detect(opened.asset, spheres, Method::kM2, kind, target);
        CHECK(m2.status == Status::kOk);
        CHECK(m2.pairs == all.pairs);
        CHECK(m2.bits == bits_of(all.pairs, n));
        CHECK(m2.test_count == all.test_count);
        const Detected m1 = detect(opened.asset, spheres, Method::kM1, kind, target);
        CHECK(m1.status == Status::kOk);
        CHECK(m1.pairs == chains.pairs);
        CHECK(m1.bits == bits_of(chains.pairs, n));
        CHECK(same_bits(m1.chain_pairs, chains.chain_pairs));
        CHECK(m1.test_count == chains.test_count);
      }
      CHECK(std::includes(all.pairs.begin(), all.pairs.end(), chains.pairs.begin(), chains.pairs.end()));
      found += chains.pairs.size();
    }
  }
  CHECK(found > 40000);  // the comparison above was not of empty lists
}

TEST_CASE("the pairs of a thousand frames hash to the same value on every target and every machine") {
  const OpenedAsset opened(random_asset(74, 1).parts);
  for (const Target target : supported_targets()) {
    CAPTURE(to_string(target));
    std::mt19937 random(1);
    Fnv m1, m2;
    for (int frame = 0; frame < 1000; ++frame) {
      const std::vector<Sphere> spheres = random_spheres(74, random);
      m1.add(detect(opened.asset, spheres, Method::kM1, RadiusKind::kDetect, target).pairs);
      m2.add(detect(opened.asset, spheres, Method::kM2, RadiusKind::kFit, target).pairs);
    }
    CHECK(m1.hash == 12491407778378117761U);
    CHECK(m2.hash == 8351330327361619244U);
  }
}

TEST_CASE("M1 takes chains as long as the asset, in any order") {
  for (const std::uint32_t n : {65U, 127U, 128U, 129U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    TinyAsset tiny = random_asset(n, n);
    std::vector<std::uint32_t> all;
    for (std::uint32_t i = 0; i < n; ++i) all.push_back((i * 61 + 7) % n);
    tiny.parts.chains = {{"all", {0}, all}, {"back", {0}, {all.rbegin(), all.rend()}}};
    const OpenedAsset opened(tiny.parts);
    REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
    const std::vector<Sphere> spheres = random_spheres(n, random);
    const Detected m1 = detect(opened.asset, spheres, Method::kM1, RadiusKind::kDetect);
    const Detected chains = brute_force_chains(tiny, spheres, RadiusKind::kDetect);
    CHECK(m1.pairs == chains.pairs);
    CHECK(same_bits(m1.chain_pairs, chains.chain_pairs));
    CHECK(m1.test_count == chains.test_count);
  }
}

TEST_CASE("M1 reports a pair once, and in the raw list once a chain, in chain order") {
  TinyAsset tiny = random_asset(5, 1);
  tiny.parts.ignored.assign(1, 0);
  tiny.parts.near_detect.clear();
  tiny.parts.chains = {{"one", {0, 4}, {3, 1, 2}}, {"two", {1, 4}, {1, 0, 3}}};
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  const Detected m1 = detect(opened.asset, heap, Method::kM1, RadiusKind::kDetect);
  CHECK(m1.pairs == std::vector<Pair>{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}});
  const std::vector<ChainPair> raw{{0, {1, 3}}, {0, {2, 3}}, {0, {1, 2}}, {1, {0, 1}}, {1, {1, 3}}, {1, {0, 3}}};
  CHECK(same_bits(m1.chain_pairs, raw));
  CHECK(m1.test_count == 6);
  CHECK(detect(opened.asset, heap, Method::kM2, RadiusKind::kDetect).pairs.size() == 10);
}

TEST_CASE("the first pair is the first of the list, with its bit alone, on every target and at every size") {
  for (const unsigned n : {1U, 2U, 30U, 64U, 129U, 300U}) {
    std::mt19937 random(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    for (int sparse = 0; sparse < 4; ++sparse) {
      std::vector<Sphere> spheres = random_spheres(n, random);
      for (Sphere& sphere : spheres) sphere.radius *= sparse == 0 ? 1.0F : 0.2F / static_cast<float>(sparse);
      const std::vector<Pair> all = detect(opened.asset, spheres, Method::kM2, RadiusKind::kFit).pairs;
      for (const Target target : supported_targets()) {
        Pair first{77, 77};
        std::vector<std::uint64_t> bits(DetectJob::bit_words(opened.asset), 5);
        DetectJob job;
        job.asset = &opened.asset;
        job.spheres = {spheres.data(), spheres.size()};
        job.radius = RadiusKind::kFit;
        job.target = target;
        job.first_only = true;
        job.bits = {bits.data(), bits.size()};
        REQUIRE(job.run() == Status::kOk);
        CHECK(job.pair_count == (all.empty() ? 0 : 1));
        CHECK(bits == bits_of({all.begin(), all.begin() + (all.empty() ? 0 : 1)}, n));
        job.pairs = {&first, 1};
        REQUIRE(job.run() == Status::kOk);
        CHECK(first == (all.empty() ? Pair{77, 77} : all[0]));
      }
    }
  }
}

TEST_CASE("M2 counts each pair as its only overlap") {
  const OpenedAsset opened(random_asset(5, 1).parts);
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  DetectJob job;
  job.asset = &opened.asset;
  job.spheres = {heap.data(), heap.size()};
  REQUIRE(job.run() == Status::kOk);
  CHECK(job.pair_count == 10 - random_asset(5, 1).ignored_pairs.size());
  CHECK(job.chain_pair_count == job.pair_count);
}

TEST_CASE("the same spheres give the same pairs again, whatever the scratch memory held") {
  const OpenedAsset opened(random_asset(40, 3).parts);
  std::mt19937 random(4);
  std::vector<std::uint64_t> words(DetectContext::words_needed(opened.asset));
  CHECK(words.size() == (40 * 39 / 2 + 63) / 64);
  DetectContext context{{words.data(), words.size()}};
  for (int frame = 0; frame < 5; ++frame) {
    const std::vector<Sphere> spheres = random_spheres(40, random);
    const Detected fresh = detect(opened.asset, spheres, Method::kM1, RadiusKind::kDetect);
    std::vector<Pair> pairs(fresh.pairs.size());
    DetectJob job;
    job.asset = &opened.asset;
    job.spheres = {spheres.data(), spheres.size()};
    job.method = Method::kM1;
    job.context = &context;
    job.pairs = {pairs.data(), pairs.size()};
    CHECK(job.run() == Status::kOk);
    CHECK(pairs == fresh.pairs);
  }
}

}  // namespace spherechain::test
