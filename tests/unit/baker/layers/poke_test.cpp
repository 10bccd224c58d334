// SPDX-License-Identifier: GPL-3.0-or-later
// Skin that shows through clothes: an arm in a sleeve, of which a patch moves outwards by a known length.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/layers/poke_finder.h"
#include "baker/motion/clip.h"
#include "baker/motion/motion.h"
#include "glb_writer.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

constexpr int kAround = 24;
constexpr double kArm = 0.2, kSleeve = 0.23, kHalfArm = 0.9, kHalfSleeve = 0.4;  // metres

struct Tube {
  const char* name;
  double radius, half;
  int rings;
  double rim;        // how much narrower its ends are
  bool has_patch;    // a joint of its own moves a patch of it, half as far as the joint goes
  double bulge = 0;  // how far the patch stands out at rest
};

// The patch: 6 rings of 2.5 cm by 3 columns, on the side of +z.
bool is_in_patch(int ring, int column) { return ring >= 33 && ring <= 39 && (column <= 1 || column >= kAround - 2); }

// The side of a cylinder along y, without ends.
int add_tube(Glb& glb, const Tube& tube) {
  std::vector<float> positions, weights;
  std::vector<std::uint8_t> joints;
  std::vector<std::uint16_t> corners;
  for (int ring = 0; ring <= tube.rings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      const bool moves = tube.has_patch && is_in_patch(ring, k);
      const double angle = 2 * std::numbers::pi * k / kAround;
      const double r = tube.radius - (ring == 0 || ring == tube.rings ? tube.rim : 0);
      for (const double x : {r * std::sin(angle), tube.half * (2.0 * ring / tube.rings - 1),
                             r * std::cos(angle) + (moves ? tube.bulge : 0)}) {
        positions.push_back(static_cast<float>(x));
      }
      for (const int joint : {0, 1, 0, 0}) joints.push_back(static_cast<std::uint8_t>(joint));
      for (const float weight : {moves ? 0.5F : 1.0F, moves ? 0.5F : 0.0F, 0.0F, 0.0F}) weights.push_back(weight);
    }
  }
  for (int ring = 0; ring < tube.rings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      const int a = ring * kAround + k, b = ring * kAround + (k + 1) % kAround;
      for (const int corner : {a, b, b + kAround, a, b + kAround, a + kAround}) {
        corners.push_back(static_cast<std::uint16_t>(corner));
      }
    }
  }
  const json attributes{{"POSITION", glb.accessor(positions, "VEC3")},
                        {"JOINTS_0", glb.accessor(joints, "VEC4")},
                        {"WEIGHTS_0", glb.accessor(weights, "VEC4")}};
  const json primitive{{"attributes", attributes}, {"indices", glb.accessor(corners, "SCALAR")}, {"material", 0}};
  glb.json["meshes"].push_back({{"name", tube.name}, {"primitives", {primitive}}});
  return static_cast<int>(glb.json["meshes"].size()) - 1;
}

// A second, in which the patch's joint goes outwards by `way` and back.
Glb arm_in_sleeve(double way, const std::vector<Tube>& over, double bulge = 0) {
  Glb glb;
  glb.json["materials"] = {{{"name", "cloth"}, {"doubleSided", true}}};
  glb.json["nodes"] = {{{"name", "root"}, {"children", {1}}}, {{"name", "patch"}}};
  glb.json["skins"] = {{{"joints", {0, 1}}}};
  std::vector<Tube> tubes{{"arm", kArm, kHalfArm, 72, kArm, true, bulge}};
  tubes.insert(tubes.end(), over.begin(), over.end());
  for (const Tube& tube : tubes) {
    glb.json["scenes"][0]["nodes"].push_back(glb.json["nodes"].size());
    glb.json["nodes"].push_back({{"name", tube.name}, {"mesh", add_tube(glb, tube)}, {"skin", 0}});
  }
  const int times = glb.accessor(std::vector<float>{0, 0.4F, 0.6F, 1}, "SCALAR"),
            places = glb.accessor(
                std::vector<float>{0, 0, 0, 0, 0, static_cast<float>(way), 0, 0, static_cast<float>(way), 0, 0, 0},
                "VEC3");
  glb.json["animations"] = {{{"name", "breathe"},
                             {"samplers", {{{"input", times}, {"output", places}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  return glb;
}

const Tube kSleeveTube{"sleeve", kSleeve, kHalfSleeve, 16, kSleeve - kArm - 0.002, false};

// In the middle of the clip.
std::vector<PokeSpot> spots_of(const Glb& glb) {
  const TemporaryFolder folder;
  const Character character = import_character(folder.write("arm.glb", glb.bytes()));
  const LayeredSkin skin = make_layered_skin(character, primitive_runs(character, glb.json), glb.json);
  const RestView rest = look_at_rest(skin, 2, 1.0 / 400);
  const std::vector<Cover> covers = find_covers(skin, rest.is_inverted);
  const PokeTest pokes(skin, rest.is_inverted, covers, character.rig);
  const Deformation pose = sample(character.rig, character.rig.clips[0], 0.5);
  return PokeFinder(skin, rest, covers, pokes, character.rig)
      .find(deform(skin.rest.positions, character.rig.weights, pose.bones));
}

}  // namespace

TEST_CASE("poke: skin that comes through its sleeve is one warning, with its area and height") {
  const TemporaryFolder folder;
  const auto in = folder.write("arm.glb", arm_in_sleeve(0.1, {kSleeveTube}).bytes()), out = folder.path / "result.json";
  const tool::Run run =
      tool::run(fmt::format("check {} -o {} --json {}", in.string(), (folder.path / "report").string(), out.string()));
  CHECK_MESSAGE(run.code == 0, run.error);
  const json result = json::parse(tool::contents(out));
  CHECK(result["summary"]["pokes"] == 1);
  CHECK(result["summary"]["penetrations"] == 0);
  CHECK(result["summary"]["fails"] == false);
  CHECK(result["tickets"].empty());
  REQUIRE(result["clips"][0]["events"].size() == 1);
  const json& poke = result["clips"][0]["events"][0];
  CHECK(poke["class"] == "poke");
  CHECK(poke["pieces"] == json{"arm", "sleeve"});
  CHECK(poke["fails"] == false);
  // The patch goes 50 mm outwards and has 30 mm to the sleeve. The faces between the corners lie 1 % farther in.
  CHECK(poke["height_mm"].get<double>() ==
        doctest::Approx(50 - 30 * std::cos(std::numbers::pi / kAround)).epsilon(0.03));
  // 6 rings by 3 columns, and around them the triangles with two of three corners in the patch.
  const double column = 2 * kArm * std::sin(std::numbers::pi / kAround), ring = 0.025;
  CHECK(poke["area_cm2"].get<double>() > 1e4 * 6 * 3 * column * ring);
  CHECK(poke["area_cm2"].get<double>() < 1e4 * 8 * 5 * 1.8 * column * ring);
  CHECK(poke["from"].get<int>() >= 6);
  CHECK(poke["to"].get<int>() <= 24);
  CHECK(run.out.find("poke-through: 1 spot of arm through sleeve, worst ") != std::string::npos);
  const std::string page = tool::contents(SPHERECHAIN_SAMPLES "/../docs/json.md");
  for (const auto& [key, value] : poke.items()) CHECK_MESSAGE(page.find("`" + key + "`") != std::string::npos, key);
}

TEST_CASE("poke: a wider coat hides it") {
  const Tube coat{"coat", 0.29, 0.6, 24, 0.088, false};
  CHECK(spots_of(arm_in_sleeve(0.1, {kSleeveTube, coat})).empty());
}

TEST_CASE("poke: skin that has come through at rest is left out") {
  CHECK(spots_of(arm_in_sleeve(0.02, {kSleeveTube}, 0.05)).empty());
}

TEST_CASE("poke: 0.6 mm are too little on a body of 1.8 m") {
  CHECK(spots_of(arm_in_sleeve(2 * (kSleeve - kArm + 0.0003), {kSleeveTube})).empty());
}
