// SPDX-License-Identifier: GPL-3.0-or-later
// The preview as another tool reads it: through tinygltf, with nothing taken from the code that wrote it.
#include "baker/report/preview.h"

#include <doctest/doctest.h>
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>

#include "baked_human.h"
#include "baker/motion/poses.h"
#include "baker/segment/region_colours.h"
#include "runtime/src/refit/refit_job.h"

using namespace spherechain::baker;
using Eigen::Affine3d;

namespace {

struct Preview {
  tinygltf::Model model;
  std::map<std::string, std::size_t> node_of_name;
  std::vector<int> parent;

  explicit Preview(const std::string& bytes) {
    std::string error, warning;
    REQUIRE_MESSAGE(tinygltf::TinyGLTF().LoadBinaryFromMemory(&model, &error, &warning,
                                                              reinterpret_cast<const unsigned char*>(bytes.data()),
                                                              static_cast<unsigned>(bytes.size())),
                    error);
    CHECK(error + warning == "");
    parent.assign(model.nodes.size(), -1);
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
      CHECK(node_of_name.emplace(model.nodes[n].name, n).second);  // names are unique
      for (const int child : model.nodes[n].children) parent[static_cast<std::size_t>(child)] = static_cast<int>(n);
    }
  }

  const tinygltf::Node& node(const std::string& name) const { return model.nodes[node_of_name.at(name)]; }
  const std::string& parent_of(const std::string& name) const {
    return model.nodes[static_cast<std::size_t>(parent[node_of_name.at(name)])].name;
  }

  Affine3d local(const tinygltf::Node& node) const {
    Affine3d m = Affine3d::Identity();
    if (!node.translation.empty()) m.translate(Vec3(node.translation.data()));
    if (!node.rotation.empty()) m.rotate(Eigen::Quaterniond(node.rotation.data()));
    if (!node.scale.empty()) m.scale(Vec3(node.scale.data()));
    return m;
  }
  Affine3d world(std::size_t n) const {
    const Affine3d own = local(model.nodes[n]);
    return parent[n] < 0 ? own : Affine3d(world(static_cast<std::size_t>(parent[n])) * own);
  }
  Affine3d world(const std::string& name) const { return world(node_of_name.at(name)); }

  template <typename T, std::size_t N>
  std::vector<std::array<T, N>> read(int id) const {
    const tinygltf::Accessor& accessor = model.accessors[static_cast<std::size_t>(id)];
    const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    REQUIRE(tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(accessor.componentType)) == sizeof(T));
    REQUIRE(tinygltf::GetNumComponentsInType(static_cast<unsigned>(accessor.type)) == N);
    std::vector<std::array<T, N>> out(accessor.count);
    REQUIRE(view.byteLength == accessor.count * N * sizeof(T));
    std::memcpy(out.data(), model.buffers[0].data.data() + view.byteOffset + accessor.byteOffset, view.byteLength);
    return out;
  }

  const tinygltf::Primitive& skin() const {
    return model.meshes[static_cast<std::size_t>(node("skin").mesh)].primitives.at(0);
  }
  template <typename T, std::size_t N>
  std::vector<std::array<T, N>> attribute(const char* name) const {
    return read<T, N>(skin().attributes.at(name));
  }

  // The skin where its joints put it.
  std::vector<Vec3> skin_in_world() const {
    const tinygltf::Skin& skin = model.skins.at(0);
    const auto inverse_bind = read<float, 16>(skin.inverseBindMatrices);
    std::vector<Affine3d> matrices;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const Eigen::Matrix4f m = Eigen::Matrix4f(inverse_bind[j].data());
      matrices.push_back(world(static_cast<std::size_t>(skin.joints[j])) * Affine3d(m.cast<double>()));
    }
    const auto positions = attribute<float, 3>("POSITION");
    const auto joints = attribute<std::uint16_t, 4>("JOINTS_0");
    const auto weights = attribute<float, 4>("WEIGHTS_0");
    std::vector<Vec3> out(positions.size(), Vec3::Zero());
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec3 p = Eigen::Vector3f(positions[v].data()).cast<double>();
      for (std::size_t k = 0; k < 4; ++k) out[v] += static_cast<double>(weights[v][k]) * (matrices[joints[v][k]] * p);
    }
    return out;
  }
};

const Preview& human_preview() {
  static const Preview preview(preview_glb(baked_human()));
  return preview;
}

// Each sphere's name, worked out from the opened asset.
std::vector<std::string> names_of_spheres(const spherechain::baker::OpenAsset& asset) {
  std::map<std::string, int> count;
  std::vector<std::string> names;
  for (const spherechain::RestSphere& sphere : asset->spheres()) {
    const std::string region = asset->region(sphere.region).name;
    if (region == "torso") {
      std::string name = "torso_level_" + std::to_string(sphere.level);
      if (sphere.side == SC_SIDE_LEFT) name += "_left";
      if (sphere.side == SC_SIDE_RIGHT) name += "_right";
      names.push_back(name);
    } else {
      const int place = count[region]++;
      names.push_back(region + (place < 10 ? "_0" : "_") + std::to_string(place));
    }
  }
  return names;
}

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

// A point of the file as glTF wants it: metres from between the feet, x to the character's left, y up, z forward.
Vec3 in_metres(const Bake& bake, const Vec3& p) {
  const BodyFrame& frame = bake.regions.frame;
  const Vec3 d = bake.character.metres_per_unit * (p - frame.origin);
  return {d.dot(frame.left), d.dot(frame.up), d.dot(frame.forward)};
}

double height(const Bake& bake) { return bake.regions.frame.height * bake.character.metres_per_unit; }

// The same bake had the file been in other units and axes.
Bake moved(Bake bake, const Eigen::Matrix3d& rotation, double scale, const Vec3& shift) {
  const auto move = [&](Vec3& p) { p = scale * rotation * p + shift; };
  for (auto* points :
       {&bake.character.source_positions, &bake.regions.body.mesh.positions, &bake.character.skin.positions})
    for (Vec3& p : *points) move(p);
  for (Joint& joint : bake.joints) {
    move(joint.position);
    move(joint.tail);
  }
  for (BoundSphere& sphere : bake.binding.spheres) {
    move(sphere.rest.center);
    sphere.rest.radius *= scale;
  }
  BodyFrame& frame = bake.regions.frame;
  move(frame.origin);
  for (Vec3* axis : {&frame.left, &frame.up, &frame.forward}) *axis = rotation * *axis;
  frame.height *= scale;
  bake.character.metres_per_unit /= scale;
  return bake;
}

}  // namespace

TEST_CASE("a preview has the skin, every joint and every sphere by its name, all spheres of one mesh") {
  const Bake& bake = baked_human();
  const Preview& preview = human_preview();
  CHECK(preview.model.nodes.size() == 2 + bake.joints.size() + bake.spheres.spheres.size());
  CHECK(preview.model.meshes.size() == 2);
  std::set<int> meshes;
  for (const std::string& name : names_of_spheres(open_asset_of(bake))) {
    INFO(name);
    REQUIRE(preview.node_of_name.count(name) == 1);
    meshes.insert(preview.node(name).mesh);
    CHECK(preview.node_of_name.count(preview.parent_of(name)) == 1);
  }
  CHECK(meshes.size() == 1);
  CHECK(*meshes.begin() != preview.node("skin").mesh);
  for (const Joint& joint : bake.joints) {
    INFO(joint.name);
    CHECK(preview.parent_of(joint.name) ==
          (joint.parent < 0 ? "character" : bake.joints[static_cast<std::size_t>(joint.parent)].name));
  }
}

TEST_CASE("a preview's spheres have the asset's centres and radii, in metres and the character's own axes") {
  const Bake& bake = baked_human();
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  const std::vector<std::string> names = names_of_spheres(asset);
  const double tolerance = 1e-5 * height(bake);  // the asset's floats
  for (std::size_t i = 0; i < names.size(); ++i) {
    INFO(names[i]);
    const Affine3d world = human_preview().world(names[i]);
    const spherechain::RestSphere& sphere = asset->spheres()[i];
    CHECK((world.translation() - in_metres(bake, to_vec3(sphere.center))).norm() < tolerance);
    const double radius = static_cast<double>(sphere.radius) * bake.character.metres_per_unit;
    for (int k = 0; k < 3; ++k) CHECK(std::abs(world.linear().col(k).norm() - radius) < tolerance);
  }
}

TEST_CASE("the preview's sphere has radius 1 and faces outwards") {
  const Preview& preview = human_preview();
  const int mesh = preview.node("left_arm_00").mesh;
  const tinygltf::Primitive& primitive = preview.model.meshes[static_cast<std::size_t>(mesh)].primitives.at(0);
  const auto positions = preview.read<float, 3>(primitive.attributes.at("POSITION"));
  for (const auto& p : positions) CHECK(Eigen::Vector3f(p.data()).norm() == doctest::Approx(1).epsilon(1e-6));
  const auto indices = preview.read<std::uint32_t, 1>(primitive.indices);
  Mesh sphere;
  for (const auto& p : positions) sphere.positions.push_back(Eigen::Vector3f(p.data()).cast<double>());
  for (std::size_t i = 0; i < indices.size(); i += 3)
    sphere.triangles.push_back({indices[i][0], indices[i + 1][0], indices[i + 2][0]});
  CHECK(count_open_edges(sphere) == 0);
  for (std::size_t t = 0; t < sphere.triangles.size(); ++t)
    CHECK(triangle_cross(sphere, t).dot(triangle_centroid(sphere, t)) > 0);
}

TEST_CASE("a preview's triangles are the character's, each in its own region's colour alone") {
  const Bake& bake = baked_human();
  const Preview& preview = human_preview();
  const auto positions = preview.attribute<float, 3>("POSITION"), colours = preview.attribute<float, 3>("COLOR_0"),
             normals = preview.attribute<float, 3>("NORMAL");
  const auto indices = preview.read<std::uint32_t, 1>(preview.skin().indices);
  const Mesh& mesh = bake.character.skin;
  REQUIRE(indices.size() == 3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint8_t region = bake.regions.of_skin[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = indices[3 * t + k][0];
      REQUIRE(Eigen::Vector3f(positions[v].data()).cast<double>() == mesh.positions[mesh.triangles[t][k]]);
      REQUIRE(Eigen::Vector3f(normals[v].data()).norm() == doctest::Approx(1).epsilon(1e-5));
      for (std::size_t c = 0; c < 3; ++c) {
        // From glTF's linear values to the palette's sRGB (IEC 61966-2-1).
        const double x = static_cast<double>(colours[v][c]);
        const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
        REQUIRE(std::abs(srgb - static_cast<double>(kRegionColours[region][c])) < 1e-4);
      }
    }
  }
}

TEST_CASE("a preview's skin weights sum to one and leave the skin where it is at rest") {
  const Bake& bake = baked_human();
  const Preview& preview = human_preview();
  const std::size_t joints = preview.model.skins.at(0).joints.size();
  CHECK(joints == bake.joints.size());
  const auto weights = preview.attribute<float, 4>("WEIGHTS_0");
  const auto indices = preview.attribute<std::uint16_t, 4>("JOINTS_0");
  for (std::size_t v = 0; v < weights.size(); ++v) {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      REQUIRE(weights[v][k] >= 0);
      REQUIRE(indices[v][k] < joints);
      sum += static_cast<double>(weights[v][k]);
    }
    REQUIRE(std::abs(sum - 1) < 1e-6);
  }
  const auto positions = preview.attribute<float, 3>("POSITION");
  const std::vector<Vec3> world = preview.skin_in_world();
  for (std::size_t v = 0; v < world.size(); ++v) {
    const Vec3 p = Eigen::Vector3f(positions[v].data()).cast<double>();
    REQUIRE((world[v] - in_metres(bake, p)).norm() < 1e-5 * height(bake));
  }
}

TEST_CASE("a preview is the same in metres whatever the file's units and axes") {
  const Bake& bake = baked_human();
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(2.3, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Preview other(preview_glb(moved(bake, rotation, 100, {30, -200, 75})));
  const double tolerance = 1e-5 * height(bake);
  const std::vector<Vec3> here = human_preview().skin_in_world(), there = other.skin_in_world();
  REQUIRE(here.size() == there.size());
  for (std::size_t v = 0; v < here.size(); ++v) REQUIRE((here[v] - there[v]).norm() < tolerance);
  for (const std::string& name : names_of_spheres(open_asset_of(bake))) {
    INFO(name);
    const Affine3d a = human_preview().world(name), b = other.world(name);
    CHECK((a.translation() - b.translation()).norm() < tolerance);
    CHECK(std::abs(a.linear().col(0).norm() - b.linear().col(0).norm()) < tolerance);
  }
}

TEST_CASE(
    "a joint turned in another tool takes the skin along, and its spheres to where the runtime's refit puts them") {
  const Bake& bake = baked_human();
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  const std::vector<std::string> names = names_of_spheres(asset);
  const std::vector<VertexWeights> weights = rig_weights(bake.character, bake.regions.body, bake.joints);
  for (const char* name : {"left_elbow", "right_hip"}) {
    INFO(name);
    Pose pose;
    pose.rotations[name] = Eigen::AngleAxisd(-1.0, Vec3::UnitX());
    const std::vector<Vec3> posed =
        deform(bake.character.source_positions, weights, bones_of(bake.joints, bake.regions.frame, pose));
    const std::vector<float> buffer = pack(posed);
    std::vector<spherechain::Sphere> spheres(names.size());
    spherechain::RefitJob refit;
    refit.asset = asset.handle();
    refit.pose.vertices = buffer.data();
    refit.pose.vertex_count = posed.size();
    refit.spheres = spheres.data();
    refit.sphere_capacity = spheres.size();
    REQUIRE(refit.run() == SC_OK);

    Preview preview = human_preview();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(-1.0, bake.regions.frame.left));
    preview.model.nodes[preview.node_of_name.at(name)].rotation = {turn.x(), turn.y(), turn.z(), turn.w()};
    const std::vector<Vec3> turned = preview.skin_in_world();
    const auto indices = preview.read<std::uint32_t, 1>(preview.skin().indices);
    for (std::size_t t = 0; t < bake.character.skin.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Index source = bake.character.source_triangles[bake.character.skin_source_triangle[t]][k];
        REQUIRE((turned[indices[3 * t + k][0]] - in_metres(bake, posed[source])).norm() < 1e-5 * height(bake));
      }
    }
    double sum = 0, still = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const Vec3 center = preview.world(names[i]).translation();
      sum += (center - in_metres(bake, Vec3(spheres[i].x, spheres[i].y, spheres[i].z))).norm();
      still += (center - human_preview().world(names[i]).translation()).norm();
    }
    // One joint carries a sphere whole where skin blends two: off near the joint, and there only.
    CHECK(sum < 0.03 * still);
  }
}
