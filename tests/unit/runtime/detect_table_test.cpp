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

using Table = std::vector<std::uint64_t>;

Table table_of(const Asset& asset, const Filter* filter = nullptr) {
  Table words(detect_table_words(&asset));
  REQUIRE(prepare_detect(&asset, SC_RADIUS_DETECT, filter, words.data(), words.size()) == SC_OK);
  return words;
}

DetectJob job_of(const Asset& asset, const std::vector<Sphere>& spheres, const Table& table) {
  DetectJob job;
  job.asset = &asset;
  job.spheres = spheres.data();
  job.sphere_count = spheres.size();
  job.table = table.data();
  return job;
}

constexpr sc_status kWrongTable{SC_BAD_VALUE, SC_FIELD_TABLE};

}  // namespace

TEST_CASE("a table keeps the filter it was prepared with, and takes no other beside it") {
  const OpenedAsset opened(random_asset(6, 1).parts);
  const std::vector<Sphere> heap(6, {0, 0, 0, 1});
  OwnedFilter owned(opened.asset);
  for (std::uint32_t b = 1; b < 6; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) owned.ignore(a, b, b != 5 || a == 4);
  }
  const Table table = table_of(opened.asset, &owned.filter);
  DetectJob job = job_of(opened.asset, heap, table);
  REQUIRE(job.run() == SC_OK);
  CHECK(job.pair_count == 4);  // (0, 5) to (3, 5)
  owned.ignore(0, 5);
  REQUIRE(job.run() == SC_OK);
  CHECK(job.pair_count == 4);
  const Table edited = table_of(opened.asset, &owned.filter);
  job.table = edited.data();
  REQUIRE(job.run() == SC_OK);
  CHECK(job.pair_count == 3);
  job.filter = &owned.filter;
  CHECK(job.run() == sc_status{SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS});
}

TEST_CASE("a table of another asset or radius, or none at all, is refused") {
  const OpenedAsset opened(random_asset(20, 1).parts), other(random_asset(20, 2).parts);
  const std::vector<Sphere> heap(20, {0, 0, 0, 1});
  const Table table = table_of(opened.asset), of_other = table_of(other.asset);
  DetectJob job = job_of(opened.asset, heap, table);
  CHECK(job.run() == SC_OK);
  job.radius = SC_RADIUS_FIT;
  CHECK(job.run() == kWrongTable);
  CHECK(job_of(other.asset, heap, table).run() == kWrongTable);
  CHECK(job_of(opened.asset, heap, Table(table.size(), 7)).run() == kWrongTable);
  CHECK(job_of(other.asset, heap, of_other).run() == SC_OK);
}

TEST_CASE("a table of an asset that lay at the same address is refused where its pairs are others") {
  TinyAsset first = random_asset(20, 1);
  first.parts.rest_fit.clear();
  first.parts.rest_detect.clear();
  TinyAsset second = first;
  second.parts.rest_detect = {{2, 5, 0.5F}};
  const OpenedAsset opened(first.parts), later(second.parts);
  Table stale = table_of(opened.asset);
  const Table of_later = table_of(later.asset);
  stale.resize(of_later.size() + stale.size());
  stale[1] = of_later[1];  // as if at the same address
  const std::vector<Sphere> heap(20, {0, 0, 0, 1});
  CHECK(job_of(later.asset, heap, stale).run() == kWrongTable);
}

TEST_CASE("a table finds as many pairs as there are, whether they fit the runtime's short list or not") {
  TinyAsset tiny = random_asset(128, 1);
  tiny.parts.ignored.assign(tiny.parts.ignored.size(), 0);
  tiny.parts.rest_fit.clear();
  tiny.parts.rest_detect.clear();
  for (const bool has_rest : {false, true}) {
    for (std::uint32_t b = 1; has_rest && b < 16; ++b) {  // of a heap of sixteen, all pairs but the first sphere's
      for (std::uint32_t a = 1; a < b; ++a) tiny.parts.rest_detect.push_back({a, b, 0.5F});
    }
    std::sort(tiny.parts.rest_detect.begin(), tiny.parts.rest_detect.end(), [](const RestPair& l, const RestPair& r) {
      return Pair{l.a, l.b} < Pair{r.a, r.b};
    });
    const OpenedAsset opened(tiny.parts);
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < 128; ++i) spheres.push_back({i < 16 ? 0.0F : 10.0F * static_cast<float>(i), 0, 0, 1});
    for (std::size_t couples = 0; couples < 20; ++couples) {
      CAPTURE(couples);
      if (couples > 0) spheres[127 - couples].x = spheres[15 + couples].x;
      for (const Target target : supported_targets()) {
        // detect() compares with what a job with a table finds.
        const Detected found = detect(opened.asset, spheres, SC_RADIUS_DETECT, target);
        CHECK(found.status == SC_OK);
        CHECK(found.pairs.size() == 120 + couples);
      }
    }
  }
}

}  // namespace spherechain::test
