// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <thread>

#include "jobs.h"
#include "palette.h"
#include "tiny_skin.h"

namespace spherechain::test {

TEST_CASE("four threads that share an asset find what one finds") {
  TinyAsset tiny = random_band(20, 1);
  const TinySkin skin = add_bones(tiny, 5, 2);
  add_skin(tiny, &skin, 4);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const std::vector<Matrix> matrices = random_matrices(5, 3);
  SkinContactJob job;
  job.asset = &opened.asset;
  job.pose = pose_of(matrices);
  const auto pairs = [&] {
    return detect(opened.asset, refit(opened.asset, job.pose, SC_RADIUS_DETECT).spheres, SC_RADIUS_DETECT).pairs;
  };
  const std::vector<Pair> expected = pairs();
  const SkinContacts contacts = find_contacts(job);
  CHECK(!expected.empty());
  CHECK(!contacts.triangles.empty());

  int agreed[4] = {};
  std::vector<std::thread> threads;
  for (int& count : agreed) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        count += pairs() == expected && same_bits(find_contacts(job).triangles, contacts.triangles) ? 1 : 0;
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
