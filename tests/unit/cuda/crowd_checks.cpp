// SPDX-License-Identifier: MIT
#include "crowd_checks.h"

#include <doctest/doctest.h>

#include <utility>

#include "jobs.h"

namespace spherechain::test {

void check_pairs(const GroupInput& in, const GroupOutput& got, const Expected& wanted) {
  CHECK(got.counts == wanted.counts);
  if (in.wants_bits) CHECK(got.bits == wanted.bits);
  if (in.pair_capacity == 0) return;
  CHECK(got.pair_count == wanted.pairs.size());
  std::vector<bool> taken(in.pair_capacity);
  std::size_t before = 0;
  bool same = true;
  for (std::size_t i = 0; i < in.instance_count; ++i) {
    for (std::size_t k = 0; k < wanted.counts[i]; ++k) {
      const std::size_t place = got.starts[i] + k;
      same &= place < wanted.pairs.size();
      if (place < in.pair_capacity) {
        same &= !taken[place] && got.pairs[place].instance == i && got.pairs[place].pair == wanted.pairs[before + k];
        taken[place] = true;
      }
    }
    before += wanted.counts[i];
  }
  CHECK(same);
}

void run_and_check(std::vector<GroupInput> in, const std::vector<Expected>& wanted) {
  for (std::size_t g = 0; g < in.size(); ++g) in[g].pair_capacity = wanted[g].pairs.size() + 3;
  const CrowdRun run = run_crowd(in);
  REQUIRE(run.status == SC_OK);
  for (std::size_t g = 0; g < in.size(); ++g) {
    CAPTURE(g);
    CHECK(same_bits(run.groups[g].refitted, wanted[g].spheres));
    check_pairs(in[g], run.groups[g], wanted[g]);
  }
}

void run_and_check(GroupInput in, const Expected& wanted) {
  run_and_check(std::vector<GroupInput>{std::move(in)}, {wanted});
}

}  // namespace spherechain::test
