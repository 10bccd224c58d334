// SPDX-License-Identifier: GPL-3.0-or-later
// Real glTF files: a body of real size through bake and back, and characters of the folder SPHERECHAIN_TEST_DATA names.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "baker/edits/held_props.h"
#include "baker/motion/clip.h"
#include "baker/pipeline/pipeline.h"
#include "baker/play/asset_file.h"
#include "baker/play/play.h"
#include "gltf_reference.h"
#include "human.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using Eigen::Vector3d;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// The human as a skinned mesh on one joint, scaled to centimetres under a root that scales back, with a staff on the
// joint.
Glb human_with_staff() {
  const Mesh& body = human().regions.body.mesh;
  Glb glb;
  std::vector<float> positions;
  for (const Vec3& p : body.positions) {
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(100 * p[k]));
  }
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : body.triangles) corners.insert(corners.end(), t.begin(), t.end());
  std::vector<float> weights(4 * body.positions.size(), 0);
  for (std::size_t v = 0; v < body.positions.size(); ++v) weights[4 * v] = 1;
  glb.json["meshes"] = {
      {{"primitives",
        {{{"attributes",
           {{"POSITION", glb.accessor(positions, "VEC3")},
            {"JOINTS_0", glb.accessor(std::vector<std::uint8_t>(4 * body.positions.size(), 0), "VEC4")},
            {"WEIGHTS_0", glb.accessor(weights, "VEC4")}}},
          {"indices", glb.accessor(corners, "SCALAR")}}}}},
      {{"primitives",
        {{{"attributes", {{"POSITION", glb.accessor(box_corners(0, 0, 0), "VEC3")}}},
          {"indices", glb.accessor(box_triangles(), "SCALAR")}}}}}};
  glb.json["skins"] = {{{"joints", {1}}}};
  glb.json["nodes"] = {{{"scale", {0.01, 0.01, 0.01}}, {"children", {1, 2}}},
                       {{"name", "hips"}, {"children", {3}}},
                       {{"mesh", 0}, {"skin", 0}},
                       {{"mesh", 1}, {"scale", {2, 80, 2}}, {"translation", {90, 80, 0}}}};
  return glb;
}

std::string test_data(const char* file) { return std::string(std::getenv("SPHERECHAIN_TEST_DATA")) + "/" + file; }
const bool kNoTestData = std::getenv("SPHERECHAIN_TEST_DATA") == nullptr;

double worst_distance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  REQUIRE(a.size() == b.size());
  double worst = 0;
  for (std::size_t v = 0; v < a.size(); ++v) worst = std::max(worst, (a[v] - b[v]).norm());
  return worst;
}

}  // namespace

TEST_CASE("an asset with attachments finds the same source again, and fits the file's own buffers" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const Glb glb = human_with_staff();
  const fs::path source = folder.write("staff.glb", glb.bytes()), asset = folder.path / "staff.sphc";
  BakeSettings settings = make_settings("paper", "{}", "");
  const Bake baked = bake(source, settings, {});
  CHECK(baked.character.metres_per_unit == doctest::Approx(0.01));
  CHECK(baked.character.source_positions.size() == human().regions.body.mesh.positions.size() + 8);
  folder.write("staff.sphc", {baked.asset.begin(), baked.asset.end()});

  const AnimatedAsset animated(asset.string(), source.string(), {}, {});
  const spherechain::Span<const sc_source_buffer> buffers = animated.asset()->source_buffers();
  REQUIRE(buffers.size == 2);
  for (std::size_t p = 0; p < 2; ++p) {
    const std::size_t view = p == 0 ? 0 : 4;  // of the positions
    std::vector<float> buffer(3 * buffers[p].vertex_count);
    std::memcpy(buffer.data(), glb.binary.data() + glb.json["bufferViews"][view]["byteOffset"].get<std::size_t>(),
                sizeof(float) * buffer.size());
    const auto check = [&] {
      return sc_check_source(animated.asset().handle(), p, buffer.data(), buffers[p].vertex_count, 12);
    };
    CHECK(check() == SC_OK);
    buffer[5] += 0.01F;
    CHECK(check() == SC_WRONG_SOURCE);
  }
}

TEST_CASE("hands ignore what they hold, and a hat makes nobody taller" * doctest::test_suite("many bakes") *
          doctest::skip(kNoTestData)) {
  const Bake baked = bake(test_data("KayKit_Barbarian.glb"), make_settings("balanced", "{}", ""), {});
  CHECK(baked.regions.frame.height * baked.character.metres_per_unit == doctest::Approx(2.186).epsilon(0.001));
  const std::vector<BodyPart>& parts = baked.body_parts.parts;
  std::vector<std::set<std::string>> parts_of(baked.spheres.spheres.size());
  for (std::size_t t = 0; t < baked.binding.sphere_of_triangle.size(); ++t) {
    const std::uint8_t part = baked.body_parts.of_triangle[baked.character.skin_source_triangle[t]];
    parts_of[baked.binding.sphere_of_triangle[t]].insert(parts[part].name);
  }
  const auto& ignored = baked.binding.ignored;
  const PartPairs held = held_props(baked.body_parts);
  CHECK(held.size() == 14);  // three things in one hand, two in the other
  for (const auto& [a, b] : held) {
    for (std::uint32_t i = 0; i < parts_of.size(); ++i) {
      for (std::uint32_t j = 0; j < parts_of.size(); ++j) {
        if (parts_of[i].count(a) + parts_of[j].count(b) < 2) continue;
        CHECK(std::binary_search(ignored.begin(), ignored.end(),
                                 std::pair<std::uint32_t, std::uint32_t>(std::minmax(i, j))));
      }
    }
  }
}

TEST_CASE("files of the real world are where assimp's independent reader sees them, at rest and in a clip" *
          doctest::skip(kNoTestData)) {
  for (const char* name : {"CesiumMan.glb", "cesium_man_khronos.gltf", "mh_boxing.glb", "Fox.glb"}) {
    const std::string file = test_data(name);
    INFO(file);
    const SourceMesh ours = read_with_tinygltf(file, {}), theirs = read_with_assimp(file);
    const std::vector<Vector3d> rest = world_positions(ours, world_of(ours.rig.nodes));
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : rest) box.extend(p);
    const double tolerance = 1e-5 * box.diagonal().norm();  // both read singles
    CHECK(worst_distance(rest, world_positions(theirs, world_of(theirs.rig.nodes))) < tolerance);
    const double seconds = 0.37 * ours.rig.clips.front().duration;
    CHECK(worst_distance(world_positions(ours, world_at(ours.rig, ours.rig.clips.front(), seconds)),
                         world_positions(theirs, world_at(theirs.rig, theirs.rig.clips.front(), seconds))) < tolerance);
  }
}

TEST_CASE("a file's weapons, hats and capes on joints are read with the skin" * doctest::skip(kNoTestData)) {
  const SourceMesh mesh = read_with_tinygltf(test_data("KayKit_Barbarian.glb"), {});
  CHECK(mesh.meshes == 13);
  CHECK(mesh.triangles.size() == 6543);
  CHECK(mesh.rig.clips.size() == 76);
  CHECK(std::count_if(mesh.rig.nodes.begin(), mesh.rig.nodes.end(), [](auto& n) { return n.is_attachment; }) == 7);
}
