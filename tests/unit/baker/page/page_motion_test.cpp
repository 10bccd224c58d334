// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/page_motion.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

using namespace spherechain::baker;

TEST_CASE("the page stores the morph targets that its frames move, and puts the others into the rest positions") {
  Character character;
  character.source_positions = {{0, 0, 0}, {1, 0, 0}};
  character.rig.morphs = {
      {"off", {0}, {{5, 5, 5}}, 0}, {"smile", {0}, {{0, 1, 0}}, 0}, {"wide", {1}, {{2, 0, 0}}, 0.5}};
  PageMotion motion(character, {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), 1});
  for (const double smile : {0.0, 0.25, 1.0}) {
    Deformation deformation;
    deformation.morphs = {0, smile, 0.5};
    motion.add(deformation, character.source_positions);
  }
  const nlohmann::ordered_json stored = motion.json();
  REQUIRE(stored["morphs"].size() == 1);
  CHECK(stored["morphs"][0]["name"] == "smile");
  CHECK(stored["morphs"][0]["weights"] == "AAAAAAAAgD4AAIA/");  // 0, 0.25, 1
  const nlohmann::ordered_json all = motion.json(PageMotion::Still::kInMotion);
  REQUIRE(all["morphs"].size() == 2);
  CHECK(all["morphs"][1]["name"] == "wide");
  CHECK(motion.rest() == std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}});
}
