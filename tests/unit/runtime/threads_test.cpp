// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <thread>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {

TEST_CASE("four threads that share an asset find what one finds") {
  const TinyAsset tiny = random_asset(50, 1);
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == Status::kOk);
  const auto run = [&](Method method) {
    const Refitted refitted = refit(opened.asset, tiny.rest, RadiusKind::kDetect);
    return detect(opened.asset, refitted.spheres, method, RadiusKind::kDetect);
  };
  const Detected m1 = run(Method::kM1);
  const Detected m2 = run(Method::kM2);
  CHECK(!m1.pairs.empty());

  int agreed[4] = {};
  std::vector<std::thread> threads;
  for (int& count : agreed) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const Detected one = run(Method::kM1);
        const Detected other = run(Method::kM2);
        count += one.pairs == m1.pairs && same_bits(one.chain_pairs, m1.chain_pairs) && other.pairs == m2.pairs;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (const int count : agreed) {
    CHECK(count == 50);
  }
}

}  // namespace spherechain::test
