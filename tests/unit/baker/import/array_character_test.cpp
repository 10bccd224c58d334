// SPDX-License-Identifier: GPL-3.0-or-later
// Characters in the tables of R2ET.
#include "baker/import/array_character.h"

#include <doctest/doctest.h>

#include "array_bytes.h"
#include "baker/motion/carried_motion.h"
#include "baker/roles/roles.h"
#include "refusal.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

using Tables = std::vector<std::pair<std::string, std::string>>;

const std::vector<std::string> kR2etNames{
    "Hips",        "Spine",    "Spine1",     "Spine2",   "Neck",         "Head",     "LeftUpLeg", "LeftLeg",
    "LeftFoot",    "LeftToe",  "RightUpLeg", "RightLeg", "RightFoot",    "RightToe", "LeftClav",  "LeftArm",
    "LeftForearm", "LeftHand", "RightClav",  "RightArm", "RightForearm", "RightHand"};
constexpr int kR2etParents[] = {-1, 0, 1, 2, 3, 4, 0, 6, 7, 8, 0, 10, 11, 12, 3, 14, 15, 16, 3, 18, 19, 20};

// A man of 22 boxes in centimetres, a box around each joint, as R2ET writes one down: vertices from the hips on.
Tables r2et_man() {
  const double offsets[22][3] = {{0, 95, 0},  {0, 10, 0},  {0, 12, 0},  {0, 12, 0},  {0, 18, 0},  {0, 10, 0},
                                 {9, -5, 0},  {0, -40, 0}, {0, -40, 0}, {0, -6, 12}, {-9, -5, 0}, {0, -40, 0},
                                 {0, -40, 0}, {0, -6, 12}, {7, 12, 0},  {11, 2, 0},  {27, 0, 0},  {25, 0, 0},
                                 {-7, 12, 0}, {-11, 2, 0}, {-27, 0, 0}, {-25, 0, 0}};
  std::vector<double> skeleton, vertices, weights;
  std::vector<std::int64_t> faces;
  std::vector<Vec3> places;
  for (std::size_t j = 0; j < 22; ++j) {
    const Vec3 offset(offsets[j][0], offsets[j][1], offsets[j][2]);
    skeleton.insert(skeleton.end(), offset.begin(), offset.end());
    places.push_back(kR2etParents[j] < 0 ? Vec3(Vec3::Zero())
                                         : Vec3(places[static_cast<std::size_t>(kR2etParents[j])] + offset));
    const auto first = static_cast<std::int64_t>(8 * j);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at = places[j] + 4 * Vec3((corner & 1) * 2 - 1, (corner & 2) - 1, (corner & 4) / 2.0 - 1);
      vertices.insert(vertices.end(), at.begin(), at.end());
      for (std::size_t k = 0; k < 22; ++k) weights.push_back(k == j ? 0.6 : k == 0 ? 0.2 : 0);
    }
    for (const int corner :
         {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
      faces.push_back(first + corner);
  }
  return {{"rest_vertices", npy(vertices, "(176, 3)")},
          {"rest_faces", npy("'<i8'", "(264, 3)", raw(faces))},
          {"skinning_weights", npy(weights, "(176, 22)")},
          {"skeleton", npy(skeleton, "(22, 3)")},
          {"joint_names", npy(kR2etNames)},
          {"subject", npy("'|S3'", "()", "man")}};
}

Tables with_table(Tables tables, const std::string& name, const std::string& bytes) {
  for (auto& [own, old] : tables) {
    if (own == name) old = bytes;
  }
  return tables;
}

}  // namespace

TEST_CASE("a character of R2ET has its skin, its weights and its joints where they are") {
  const TemporaryFolder folder;
  const fs::path file = folder.write("man.npz", npz(r2et_man()));
  const Character character = import_character(file);
  CHECK(character.source_positions.size() == 176);
  CHECK(character.source_triangles.size() == 264);
  CHECK(character.metres_per_unit == 0.01);
  CHECK(character.buffers.at(0).name == "man");
  const SourceRig& rig = character.rig;
  REQUIRE(rig.nodes.size() == 22);
  const std::vector<Vec3> rest = rest_positions(rig);
  for (std::size_t j = 0; j < 22; ++j) {
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < 8; ++k) middle += character.source_positions[8 * j + k] / 8;
    CHECK((rest[j] - middle).norm() < 1e-4);
    CHECK(rig.weights[8 * j].joint[0] == j);
    CHECK(rig.weights[8 * j].weight[0] == doctest::Approx(j == 0 ? 1 : 0.75));
  }
  CHECK(find_roles(rig, character.source_positions).of_node[20].role == "right_elbow");
}

TEST_CASE("a character of R2ET is the same in the GLB that the tool makes of it, in metres on its feet") {
  const TemporaryFolder folder;
  const fs::path file = folder.write("man.npz", npz(r2et_man())), glb = folder.write("man.glb", read_as_glb(file));
  const SourceMesh a = read_source(file), b = read_source(glb);
  REQUIRE(b.positions.size() == a.positions.size());
  CHECK(b.triangles == a.triangles);
  for (std::size_t v = 0; v < a.positions.size(); ++v) {
    CHECK((b.positions[v] - a.positions[v]).norm() < 1e-4);
    CHECK(b.rig.weights[v].weight[1] == doctest::Approx(a.rig.weights[v].weight[1]));
  }
  const std::vector<Affine> world = world_of(b.rig.nodes);
  for (std::size_t n = 0; n < world.size(); ++n) {
    if (b.rig.nodes[n].name == "LeftToe") CHECK((world[n].translation() - Vec3(0.09, 0.04, 0.12)).norm() < 1e-6);
  }
}

TEST_CASE("tables of a character that do not fit each other are refused") {
  const TemporaryFolder folder;
  const auto says = [&](const Tables& tables, const char* part) {
    const std::string what = refusal(folder.write("bad.npz", npz(tables)));
    CAPTURE(what);
    CHECK(contains(what, part));
  };
  const Tables good = r2et_man();
  says(with_table(good, "rest_faces", npy({0, 1, 176}, "(1, 3)")), "triangle 0 uses vertex 176 of 176");
  says(with_table(good, "rest_faces", npy({0, 1, -1}, "(1, 3)")), "uses vertex -1");
  says(with_table(good, "rest_vertices", npy({0, 1, 2, 3}, "(2, 2)")), "'rest_vertices' is no table of rows of 3");
  says(with_table(good, "skinning_weights", npy(std::vector<double>(22, 1), "(1, 22)")), "no row for each vertex");
  says(with_table(good, "skeleton", npy({0, 0, 0}, "(1, 3)")), "1 joints");
  says(with_table(good, "joint_names", npy(std::vector<std::string>{"Hips"})), "no name for each joint");
  says({good[0], good[1]}, "has no 'skeleton'");
}
