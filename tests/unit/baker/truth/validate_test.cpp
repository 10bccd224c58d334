// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>
#include <sched.h>

#include "baked_human.h"
#include "baker/os/parallel.h"
#include "baker/report/validation.h"
#include "baker/truth/groups.h"
#include "baker/truth/validate.h"
#include "human.h"
#include "jobs.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using spherechain::Pair;
using spherechain::Sphere;
using spherechain::test::detect;
using spherechain::test::refit;

TEST_CASE("every true and every reported pair is between two regions") {
  const OpenAsset asset = open_asset_of(baked_human());
  const std::vector<Sphere> spheres = refit(asset, pack(posed_human("arms_crossed.json")), SC_RADIUS_DETECT).spheres;
  const std::vector<Pair> reported = detect(asset, spheres, SC_RADIUS_DETECT).pairs;
  REQUIRE(reported.size() > 2);
  FrameTruth truth;
  truth.contacts = {{reported[0], {{1, 2}, {1, 3}}}, {{0, 1}, {{7, 9}}}};
  RegionGroups regions(asset);
  regions.add(truth, reported);
  PairGroup sum;
  for (const PairGroup& group : regions.groups()) {
    sum.true_pairs += group.true_pairs;
    sum.found_pairs += group.found_pairs;
    sum.reported += group.reported;
  }
  CHECK(sum.true_pairs == 3);
  CHECK(sum.found_pairs == 2);
  CHECK(sum.reported == reported.size());
}

TEST_CASE("contacts that one list has and the other has not are missing or extra") {
  const ContactErrors errors = compare({{1, 2}, {1, 4}, {3, 4}, {5, 6}}, {{1, 2}, {1, 3}, {3, 4}, {7, 8}, {7, 9}});
  CHECK(errors.missing == 3);
  CHECK(errors.extra == 2);
  CHECK(compare({}, {}).missing == 0);
}

TEST_CASE("a validation is the same with one thread and with many") {
  const TemporaryFolder folder;
  const Bake& bake = baked_human();
  const std::string asset = folder.write("human.sphc", std::string(bake.asset.begin(), bake.asset.end())).string();
  const AnimatedAsset animated(asset, kHumanFile,
                               {std::string(SPHERECHAIN_SAMPLES) + "/poses/arms_crossed.json", {}, {}}, {4, 30});
  const auto run = [&] {
    int last = 0;
    const Validation found = validate(animated, {}, [&](int done) {
      CHECK(done == last + 1);
      last = done;
    });
    CHECK(last == 4);
    return validation_json(found, animated, {});
  };
  cpu_set_t all, one;
  REQUIRE(sched_getaffinity(0, sizeof all, &all) == 0);
  CPU_ZERO(&one);
  CPU_SET(sched_getcpu(), &one);
  const std::string with_many = run();
  REQUIRE(sched_setaffinity(0, sizeof one, &one) == 0);
  CHECK(thread_count() == 1);
  const std::string with_one = run();
  sched_setaffinity(0, sizeof all, &all);
  CHECK(with_one == with_many);
}
