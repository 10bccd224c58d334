// SPDX-License-Identifier: GPL-3.0-or-later
// A game that asks a body, `play`, `check` and `fix` call the same things faults, in every frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <tuple>

#include "baker/pipeline/pipeline.h"
#include "baker/play/play.h"
#include "baker/play/skin_player.h"
#include "baker/play/target.h"
#include "spherechain/body.h"
#include "temporary_folder.h"
#include "test_characters.h"
#include "wall_and_arm.h"

using namespace spherechain::baker;

namespace {

using Faults = std::set<std::tuple<std::uint32_t, std::uint32_t, int, float>>;

template <typename List>
Faults faults_of(const List& found) {
  Faults out;
  for (const spherechain::Penetration& one : found) {
    if (spherechain::is_fault(one.kind)) out.emplace(one.part, one.other, one.kind, one.measures.depth);
  }
  return out;
}

// Gives how many faults all frames have.
std::size_t check_one_answer(const std::filesystem::path& character) {
  const Bake baked = bake(character, make_settings("balanced", "{}", "test"), {});
  const std::string bytes(reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size());
  const AnimatedAsset animated(OpenAsset(bytes, "asset"), "asset", character, MotionChoice{}, FrameChoice{0, 0});
  const spherechain::Model model(bytes.data(), bytes.size(), nullptr, 0, SC_LAYOUT_UNSET);
  REQUIRE_MESSAGE(model, model.message());
  spherechain::Body game(model);
  SkinPlayer play(animated.asset(), choose_target("auto")), check(animated.asset(), choose_target("scalar"));
  spherechain::Query query;
  std::size_t faults = 0, differences = 0;
  for (int i = 0; i < animated.frame_count(); ++i) {
    const SkinPose pose(animated, animated.deformation(i));
    REQUIRE(game.set_pose(pose.pose()) == SC_OK);
    const spherechain::Penetrations found = game.penetrations(query);
    REQUIRE(game.status() == SC_OK);
    query.previous = found.items;
    query.previous_count = found.count;
    const Faults expected = faults_of(found);
    play.set_pose(pose.pose());
    check.set_pose(pose.pose());
    differences += faults_of(play.measure(i > 0)) == expected ? 0 : 1;
    differences += faults_of(check.measure_quickly(nullptr, i > 0)) == expected ? 0 : 1;
    faults += expected.size();
  }
  CHECK_MESSAGE(differences == 0, character.filename().string());
  return faults;
}

}  // namespace

TEST_CASE(
    "characters of SPHERECHAIN_TEST_DATA: game, play and check find the same faults in every frame of every clip") {
  const char* folder = std::getenv("SPHERECHAIN_TEST_DATA");
  if (folder == nullptr) {
    MESSAGE("skipped: SPHERECHAIN_TEST_DATA names no folder of rigged characters");
    return;
  }
  std::size_t faults = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const std::string ending = file.path().extension();
    if (ending == ".glb" || ending == ".gltf" || ending == ".fbx" || ending == ".vrm") faults += check_one_answer(file);
  }
  CHECK(faults > 1000);
}

TEST_CASE("game, play and check find the same faults of an arm that goes through a wall") {
  const TemporaryFolder folder;
  CHECK(check_one_answer(folder.write("arm.glb", wall_and_arm({0, 5, 10, 20, 30, 40, 30, 20, 10, 0}))) > 3);
}
