// SPDX-License-Identifier: MIT
// Tables of the pairs to look at: jobs with one find what jobs without find (jobs.h compares them for every test of
// pairs), and none is taken for another's.
#include <doctest/doctest.h>

#include <algorithm>

#include "jobs.h"
#include "owned_filter.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

struct OwnedTable {
  OwnedTable(const Asset& asset, RadiusKind radius, const Filter* filter = nullptr)
      : words(DetectTable::words_needed(asset)), table{{words.data(), words.size()}} {
    REQUIRE(prepare_detect(asset, radius, filter, table) == Status::kOk);
  }
  std::vector<std::uint64_t> words;
  DetectTable table;
};

DetectJob job_of(const Asset& asset, const std::vector<Sphere>& spheres, const DetectTable& table) {
  DetectJob job;
  job.asset = &asset;
  job.spheres = {spheres.data(), spheres.size()};
  job.table = &table;
  return job;
}

}  // namespace

TEST_CASE("a table keeps the filter it was prepared with, and a job adds its own filter's padding") {
  const OpenedAsset opened(random_asset(6, 1).parts);
  const std::vector<Sphere> heap(6, {0, 0, 0, 1});
  OwnedFilter owned(opened.asset);
  for (std::uint32_t b = 1; b < 6; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) CHECK(ignore_pair(opened.asset, owned.filter, a, b, b != 5) == Status::kOk);
  }
  CHECK(disable_sphere(opened.asset, owned.filter, 4) == Status::kOk);
  const OwnedTable of_filter(opened.asset, RadiusKind::kDetect, &owned.filter);
  DetectJob job = job_of(opened.asset, heap, of_filter.table);
  REQUIRE(job.run() == Status::kOk);
  CHECK(job.pair_count == 4);  // (0, 5) to (3, 5)
  CHECK(job.test_count == 4);
  CHECK(reset_filter(opened.asset, owned.filter) == Status::kOk);
  job.filter = &owned.filter;
  REQUIRE(job.run() == Status::kOk);
  CHECK(job.pair_count == 4);
  CHECK(pad_sphere(opened.asset, owned.filter, 5, -2.0F) == Status::kOk);
  REQUIRE(job.run() == Status::kOk);
  CHECK(job.pair_count == 0);  // radii 1 and -1
  const OwnedTable again(opened.asset, RadiusKind::kDetect, &owned.filter);
  job.table = &again.table;
  REQUIRE(job.run() == Status::kOk);
  CHECK(job.test_count == 15 - random_asset(6, 1).ignored_pairs.size());
}

TEST_CASE("a table of another asset or radius, or cut short, is refused") {
  const OpenedAsset opened(random_asset(20, 1).parts), other(random_asset(20, 2).parts);
  const std::vector<Sphere> heap(20, {0, 0, 0, 1});
  const OwnedTable table(opened.asset, RadiusKind::kDetect);
  DetectJob job = job_of(opened.asset, heap, table.table);
  CHECK(job.run() == Status::kOk);
  job.radius = RadiusKind::kFit;
  CHECK(job.run() == Status::kBadArgument);
  job.radius = RadiusKind::kDetect;
  job.asset = &other.asset;
  CHECK(job.run() == Status::kBadArgument);
  job.asset = &opened.asset;
  DetectTable changed = table.table;
  job.table = &changed;
  for (const std::size_t size : {table.words.size() - 1, std::size_t{1}, std::size_t{0}}) {
    changed.words.size = size;
    CHECK(job.run() == Status::kContextTooSmall);
  }
  changed.words.data = nullptr;
  CHECK(job.run() == Status::kNullArgument);
}

TEST_CASE("an asset opened where another one lay does not take its table") {
  const TinyAsset first = random_asset(20, 1);
  TinyAsset second = random_asset(20, 1);
  second.parts.chains.push_back(second.parts.chains[0]);
  OpenedAsset opened(first.parts);
  const OwnedTable table(opened.asset, RadiusKind::kDetect);
  const OpenedAsset later(second.parts);
  const std::vector<Sphere> heap(20, {0, 0, 0, 1});
  std::vector<std::uint64_t> words = table.words;
  const OwnedTable of_later(later.asset, RadiusKind::kDetect);
  words[0] = of_later.words[0];  // as if at the same address
  const DetectTable stale{{words.data(), words.size()}};
  CHECK(job_of(later.asset, heap, stale).run() == Status::kBadArgument);
}

TEST_CASE("a table of an asset with fewer near pairs is not taken for one of more, however long it is") {
  TinyAsset first = random_asset(20, 1);
  first.parts.near_fit.clear();
  first.parts.near_detect.clear();
  TinyAsset second = first;
  second.parts.near_detect = {{2, 5, 0.5F}};
  const OpenedAsset opened(first.parts);
  const OpenedAsset later(second.parts);
  const OwnedTable table(opened.asset, RadiusKind::kDetect), of_later(later.asset, RadiusKind::kDetect);
  std::vector<std::uint64_t> words = table.words;
  words.resize(of_later.words.size() + words.size());
  words[0] = of_later.words[0];  // as if at the same address
  const std::vector<Sphere> heap(20, {0, 0, 0, 1});
  const DetectTable stale{{words.data(), words.size()}};
  CHECK(job_of(later.asset, heap, stale).run() == Status::kBadArgument);
}

TEST_CASE("a table finds as many pairs as there are, whether they fit the runtime's short list or not") {
  TinyAsset tiny = random_asset(128, 1);
  tiny.parts.ignored.assign(tiny.parts.ignored.size(), 0);
  tiny.parts.near_fit.clear();
  tiny.parts.near_detect.clear();
  for (const bool has_near : {false, true}) {
    for (std::uint32_t b = 1; has_near && b < 16; ++b) {  // of a heap of sixteen, all pairs but the first sphere's
      for (std::uint32_t a = 1; a < b; ++a) tiny.parts.near_detect.push_back({a, b, 0.5F});
    }
    std::sort(tiny.parts.near_detect.begin(), tiny.parts.near_detect.end(),
              [](const NearPair& l, const NearPair& r) { return l.a != r.a ? l.a < r.a : l.b < r.b; });
    const OpenedAsset opened(tiny.parts);
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < 128; ++i) spheres.push_back({i < 16 ? 0.0F : 10.0F * static_cast<float>(i), 0, 0, 1});
    for (std::size_t couples = 0; couples < 20; ++couples) {
      CAPTURE(couples);
      if (couples > 0) spheres[127 - couples].x = spheres[15 + couples].x;
      for (const Target target : supported_targets()) {
        // detect() compares with what a job with a table finds.
        const Detected found = detect(opened.asset, spheres, Method::kM2, RadiusKind::kDetect, target);
        CHECK(found.status == Status::kOk);
        CHECK(found.pairs.size() == 120 + couples);
        CHECK(detect(opened.asset, spheres, Method::kM1, RadiusKind::kDetect, target).status == Status::kOk);
      }
    }
  }
}

TEST_CASE("more chains than a word has bits are counted with a table as well") {
  TinyAsset tiny = random_asset(30, 3);
  const std::size_t own = tiny.parts.chains.size();
  while (tiny.parts.chains.size() < 150) tiny.parts.chains.push_back(tiny.parts.chains[tiny.parts.chains.size() % own]);
  const OpenedAsset opened(tiny.parts);
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < 30; ++i) spheres.push_back({static_cast<float>(i % 10), 0, 0, 0.4F});
  const Detected found = detect(opened.asset, spheres, Method::kM1, RadiusKind::kDetect);
  CHECK(found.status == Status::kOk);
  CHECK(found.chain_pairs.size() > 64);
}

TEST_CASE("prepare_detect refuses what it cannot fill and writes nothing then") {
  const OpenedAsset opened(random_asset(20, 1).parts);
  const Asset closed;
  OwnedFilter owned(opened.asset);
  std::vector<std::uint64_t> words(DetectTable::words_needed(opened.asset), 7);
  const auto status_of = [&](const Asset& asset, RadiusKind radius, std::uint64_t* data, std::size_t size) {
    DetectTable table{{data, size}};
    return prepare_detect(asset, radius, &owned.filter, table);
  };
  const std::size_t size = words.size();
  CHECK(status_of(closed, RadiusKind::kFit, words.data(), size) == Status::kNotOpen);
  CHECK(status_of(opened.asset, static_cast<RadiusKind>(2), words.data(), size) == Status::kBadArgument);
  CHECK(status_of(opened.asset, RadiusKind::kFit, words.data(), size - 1) == Status::kContextTooSmall);
  CHECK(status_of(opened.asset, RadiusKind::kFit, nullptr, size) == Status::kNullArgument);
  auto* askew = reinterpret_cast<std::uint64_t*>(reinterpret_cast<char*>(words.data()) + 4);
  CHECK(status_of(opened.asset, RadiusKind::kFit, askew, size) == Status::kMisaligned);
  owned.filter.ignored.data = words.data();
  CHECK(status_of(opened.asset, RadiusKind::kFit, words.data(), size) == Status::kSharedMemory);
  owned.filter.ignored.size = 1;
  CHECK(status_of(opened.asset, RadiusKind::kFit, words.data(), size) == Status::kBadFilter);
  CHECK(words == std::vector<std::uint64_t>(size, 7));
}

TEST_CASE("a job writes over no table") {
  const OpenedAsset opened(random_asset(20, 1).parts);
  const std::vector<Sphere> heap(20, {0, 0, 0, 1});
  const OwnedTable table(opened.asset, RadiusKind::kDetect);
  const std::vector<std::uint64_t> before = table.words;
  DetectJob job = job_of(opened.asset, heap, table.table);
  job.bits = {table.table.words.data + 8, DetectJob::bit_words(opened.asset)};
  CHECK(job.run() == Status::kSharedMemory);
  CHECK(table.words == before);
}

}  // namespace spherechain::test
