// SPDX-License-Identifier: GPL-3.0-or-later
// Real glTF files: a body of real size through bake and back, and characters of the folder SPHERECHAIN_TEST_DATA names.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>

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

TEST_CASE("an asset baked with attachments finds the same source again, and fits the file's own buffers" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const Glb glb = human_with_staff();
  const fs::path source = folder.write("staff.glb", glb.bytes()), asset = folder.path / "staff.sphc";
  BakeSettings settings = make_settings("paper", R"({"attachments": true})", "");
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

TEST_CASE("a file's weapons, hats and capes on joints are counted, and come with attachments" *
          doctest::skip(kNoTestData)) {
  const std::string file = test_data("KayKit_Barbarian.glb");
  ImportOptions attachments;
  attachments.attachments = true;
  const SourceMesh without = read_with_tinygltf(file, {}), with = read_with_tinygltf(file, attachments);
  CHECK(without.meshes == 6);
  CHECK(without.attachments_dropped == 7);
  CHECK(with.meshes == 13);
  CHECK(with.triangles.size() == 6543);
  CHECK(with.rig.clips.size() == 76);
}
