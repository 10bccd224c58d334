// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "baked_human.h"

using namespace spherechain::baker;

TEST_CASE("a rebake gives the bytes of a bake from the file, whether its spheres stay or not" *
          doctest::test_suite("many bakes")) {
  const Bake& balanced = baked_human();
  const Bake& paper = paper_baked_human();
  CHECK(rebake(balanced, paper.settings).asset == paper.asset);

  BakeSettings other = balanced.settings;
  other.bind.pivots = 16;
  const Bake carried_by_more = rebake(balanced, other);
  CHECK(carried_by_more.asset != balanced.asset);
  CHECK(rebake(carried_by_more, balanced.settings).asset == balanced.asset);
}
