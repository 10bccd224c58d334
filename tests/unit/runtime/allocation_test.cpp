// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "counting_new.h"
#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {

// symbol_rules.cmake sees to malloc.
TEST_CASE("open, refit and detect allocate nothing") {
  const TinyAsset tiny = random_asset(60, 1);
  const OpenedAsset opened(tiny.parts);
  std::vector<Sphere> spheres(60);
  std::vector<Pair> pairs(2000);
  std::vector<ChainPair> chain_pairs(4000);
  std::vector<std::uint64_t> words(DetectContext::words_needed(opened.asset));
  DetectContext context{{words.data(), words.size()}};
  RefitJob refit;
  refit.positions = tiny.rest.data();
  refit.vertex_count = tiny.parts.vertex_count;
  refit.spheres = {spheres.data(), spheres.size()};
  DetectJob detect;
  detect.spheres = {spheres.data(), spheres.size()};
  detect.context = &context;
  detect.pairs = {pairs.data(), pairs.size()};
  detect.chain_pairs = {chain_pairs.data(), chain_pairs.size()};

  const std::size_t before = allocation_count();
  Asset asset;
  char message[160];
  const Status open_status = asset.open(opened.bytes.data(), opened.bytes.size(), message, sizeof message);
  const Status source_status = check_source(asset, refit.positions, refit.vertex_count);
  refit.asset = &asset;
  detect.asset = &asset;
  const Status refit_status = refit.run();
  const Status m2_status = detect.run();
  const std::size_t m2_pairs = detect.pair_count;
  detect.method = Method::kM1;
  const Status m1_status = detect.run();
  Asset closed;
  const Status bad_status = closed.open(opened.bytes.data(), opened.bytes.size() - 100, message, sizeof message);
  const std::size_t after = allocation_count();

  CHECK(after == before);
  CHECK(open_status == Status::kOk);
  CHECK(source_status == Status::kOk);
  CHECK(refit_status == Status::kOk);
  CHECK(m2_status == Status::kOk);
  CHECK(m1_status == Status::kOk);
  CHECK(bad_status == Status::kCorrupt);
  CHECK(m2_pairs > 0);
  CHECK(before > 0);  // the counter does count
}

}  // namespace spherechain::test
