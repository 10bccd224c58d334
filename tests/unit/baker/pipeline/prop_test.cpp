// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid things as assets of their own: one bone, spheres that hold all of the mesh, nothing that meets itself.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <numbers>

#include "baked_human.h"
#include "baker/pipeline/pipeline.h"
#include "gltf_reference.h"
#include "jobs.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;
using nlohmann::json;
using spherechain::test::find_contacts;
using spherechain::test::refit;
using tool::check_error;
using tool::contents;
using tool::run;

namespace {

int add_mesh(Glb& glb, const std::vector<float>& corners, const std::vector<std::uint16_t>& triangles) {
  glb.json["meshes"].push_back({{"primitives",
                                 {{{"attributes", {{"POSITION", glb.accessor(corners, "VEC3")}}},
                                   {"indices", glb.accessor(triangles, "SCALAR")}}}}});
  return static_cast<int>(glb.json["meshes"].size()) - 1;
}

// 12 triangles.
Glb box() {
  Glb glb;
  glb.json["nodes"] = {{{"mesh", add_mesh(glb, box_corners(1, 2, 3), box_triangles())}}};
  return glb;
}

// Two triangles in a plane: no pivots carry a centre there but their middle.
Glb plate() {
  Glb glb;
  glb.json["nodes"] = {{{"mesh", add_mesh(glb, {-1, 0, -1, 5, 0, -1, 0, 0, 1, -1, 0, 1}, {0, 2, 1, 0, 3, 2})}}};
  return glb;
}

// A blade open at its lower end, an open handle, and a flat guard that both go through: two nodes of one plate,
// crossed.
Glb sword() {
  constexpr int kSides = 12, kRings = 30;
  std::vector<float> corners;
  std::vector<std::uint16_t> triangles;
  const auto tube = [&](double from, double to, double wide, double thick) {
    const auto first = static_cast<std::uint16_t>(corners.size() / 3);
    for (int ring = 0; ring <= kRings; ++ring) {
      for (int side = 0; side < kSides; ++side) {
        const double angle = 2 * std::numbers::pi * side / kSides, along = from + (to - from) * ring / kRings;
        for (const double c : {wide * std::cos(angle), along, thick * std::sin(angle)}) {
          corners.push_back(static_cast<float>(c));
        }
      }
    }
    for (int ring = 0; ring < kRings; ++ring) {
      for (int side = 0; side < kSides; ++side) {
        const auto at = [&](int r, int s) { return static_cast<std::uint16_t>(first + r * kSides + s % kSides); };
        for (const std::uint16_t v : {at(ring, side), at(ring + 1, side), at(ring, side + 1), at(ring, side + 1),
                                      at(ring + 1, side), at(ring + 1, side + 1)}) {
          triangles.push_back(v);
        }
      }
    }
  };
  tube(0.1, 1, 0.03, 0.004);
  tube(-0.1, 0.12, 0.015, 0.015);
  Glb glb;
  const int plate = add_mesh(glb, {-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1}, {0, 2, 1, 0, 3, 2});
  const int blade = add_mesh(glb, corners, triangles);
  glb.json["nodes"] = {{{"name", "blade"}, {"mesh", blade}, {"children", {1, 2}}},
                       {{"mesh", plate}, {"translation", {0, 0.11, 0}}, {"scale", {0.08, 1, 0.02}}},
                       {{"mesh", plate}, {"translation", {0, 0.11, 0}}, {"scale", {0.02, 1, 0.08}}}};
  return glb;
}

Bake bake_prop(const Glb& glb, const std::string& name) {
  const TemporaryFolder folder;
  return bake(folder.write(name + ".glb", glb.bytes()), make_settings("prop", "{}", "test"), {});
}

void check_one_rigid_thing(const Bake& bake, const std::string& name) {
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  const spherechain::AssetInfo info = sc_asset_get_info(asset.handle());
  REQUIRE(info.bone_count == 1);
  CHECK(std::string(sc_asset_bone(asset.handle(), 0).name) == kPropBone);
  REQUIRE(info.part_count == 1);
  CHECK(sc_asset_part(asset.handle(), 0).name == name);
  CHECK(sc_asset_part(asset.handle(), 0).bone == 0);
  CHECK(info.morph_count == 0);
  CHECK(asset->joint_count() == 0);
  CHECK(info.ignored_pair_count == info.sphere_count * (info.sphere_count - 1) / 2);
  CHECK(info.sphere_count <= static_cast<std::size_t>(kPropSpheres));
}

// Each triangle lies in its sphere and in its cluster's bounds.
void check_bounds(const Bake& bake) {
  const Character& character = bake.character;
  std::size_t count = 0;
  for (const Cluster& cluster : bake.clusters.clusters) {
    const BoundSphere& sphere = bake.binding.spheres[cluster.sphere];
    for (const Index t : cluster.triangles) {
      for (const Index v : character.skin.triangles[t]) {
        const Vec3& p = character.skin.positions[v];
        CHECK((p - sphere.rest.center).norm() <= sphere.detect_radius * (1 + 1e-9));
        CHECK(((p - cluster.box.center).cwiseAbs().array() <= cluster.box.half.array() * (1 + 1e-6) + 1e-9).all());
      }
    }
    count += cluster.triangles.size();
  }
  CHECK(count == character.skin.triangles.size());
}

// A turn and a way: rows.
const std::array<float, 12> kMoved{0, 0, 1, 5, 1, 0, 0, -7, 0, 1, 0, 2};

void check_moves_by_one_matrix(const Bake& bake) {
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  spherechain::Pose pose;
  pose.bones = kMoved.data();
  pose.bone_count = 1;
  pose.bone_layout = SC_ROWS_3X4;
  const auto moved = refit(asset, pose, SC_RADIUS_DETECT);
  REQUIRE(moved.status == SC_OK);
  for (std::size_t i = 0; i < moved.spheres.size(); ++i) {
    const sc_rest_sphere rest = sc_asset_sphere(asset.handle(), i);
    const auto close = [&](float a, float b) { return std::abs(a - b) < 1e-4F; };
    CHECK(close(moved.spheres[i].x, rest.center.z + 5));
    CHECK(close(moved.spheres[i].y, rest.center.x - 7));
    CHECK(close(moved.spheres[i].z, rest.center.y + 2));
    CHECK(close(moved.spheres[i].radius, rest.detect_radius));
  }
  spherechain::SkinContactJob job;
  job.asset = asset.handle();
  job.pose = pose;
  const auto contacts = find_contacts(job);
  CHECK(contacts.status == SC_OK);
  CHECK(contacts.triangles.empty());
}

}  // namespace

TEST_CASE("a box, a plate and a sword of open shells are props: one bone moves them, their spheres hold them") {
  for (const auto& [glb, name] : {std::pair{box(), "box"}, std::pair{plate(), "plate"}, std::pair{sword(), "sword"}}) {
    CAPTURE(std::string(name));
    const Bake bake = bake_prop(glb, name);
    check_one_rigid_thing(bake, name);
    check_bounds(bake);
    check_moves_by_one_matrix(bake);
    CHECK(bake.asset == bake_prop(glb, name).asset);
  }
}

TEST_CASE("a prop is all nodes of its file, as they stand: two of one plate are two plates") {
  const Bake bake = bake_prop(sword(), "sword");
  CHECK(bake.character.report.meshes == 3);
  const std::vector<Eigen::Vector3d> expected = world_positions(sword());
  REQUIRE(bake.character.source_positions.size() == expected.size());
  for (std::size_t v = 0; v < expected.size(); ++v) {
    CHECK((bake.character.source_positions[v] - expected[v]).norm() < 1e-6);
  }
}

TEST_CASE("a rigged file is a prop as it rests, and the report says so; a rigid mesh on a joint stays") {
  Glb glb = two_boxes();
  const int box = add_mesh(glb, box_corners(1, 1, 1), box_triangles());
  glb.json["nodes"].push_back({{"mesh", box}, {"translation", {9, 0, 0}}});
  glb.json["nodes"][2]["children"] = {glb.json["nodes"].size() - 1};
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("boxes.glb", glb.bytes()), asset = folder.path / "boxes.sphc",
                              report = folder.path / "report.json";
  const tool::Run baked =
      run(fmt::format("bake {} --prop -o {} --report {}", file.string(), asset.string(), report.string()));
  REQUIRE_MESSAGE(baked.code == 0, baked.error);
  CHECK(baked.out.find("(a prop)") != std::string::npos);
  CHECK(baked.out.find("a prop is rigid, as at rest") != std::string::npos);
  const json said = json::parse(contents(report));
  CHECK(said["settings"]["prop"] == true);
  CHECK(said["import"]["bones_dropped"] > 1);
  CHECK(said["import"]["meshes"] == 2);
  CHECK(said["segment"]["strategy"] == "prop");
  check_one_rigid_thing(bake(file, make_settings("prop", "{}", "test"), {}), "boxes");
}

TEST_CASE("commands that read an asset take a prop's") {
  const TemporaryFolder folder;
  const std::string file = folder.write("sword.glb", sword().bytes()).string(),
                    asset = (folder.path / "sword.sphc").string();
  REQUIRE(run(fmt::format("bake {} --prop -o {}", file, asset)).code == 0);
  for (const std::string& command :
       {fmt::format("inspect {} --json", asset), fmt::format("play {} --source {}", asset, file),
        fmt::format("validate {} --source {} --contacts", asset, file)}) {
    const tool::Run done = run(command);
    CHECK_MESSAGE(done.code == 0, command << ": " << done.error);
  }
}

TEST_CASE("what only characters have is refused for a prop") {
  const TemporaryFolder folder;
  const std::string file = folder.write("box.glb", box().bytes()).string(), asset = (folder.path / "box.sphc").string();
  for (const char* other : {"--body biped", "--roles roles.json", "--profile paper", "--extremities"}) {
    check_error(run(fmt::format("bake {} --prop -o {} {}", file, asset, other)), 2, {"--prop", "excludes"});
  }
  for (const char* config : {R"({"body": "biped"})", R"({"roles": {"Neck": "head"}})", R"({"refit": "paper"})"}) {
    const std::string settings = folder.write("config.json", config).string();
    check_error(run(fmt::format("bake {} --prop -o {} --config {}", file, asset, settings)), 3,
                {settings, "is for characters, not for a prop"});
  }
  CHECK_FALSE(std::filesystem::exists(asset));
  CHECK(to_json(make_settings("prop", "{}", "")) == to_json(make_settings("balanced", R"({"prop": true})", "")));
}
