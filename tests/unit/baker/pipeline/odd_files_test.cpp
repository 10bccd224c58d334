// SPDX-License-Identifier: GPL-3.0-or-later
// Files that no artist means to write: each bakes, or ends with an error that says what is wrong.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include "baker/mesh/error.h"
#include "baker/pipeline/pipeline.h"
#include "creatures.h"
#include "glb_writer.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

// A quadruped of tubes: each is a joint under node 0, and each vertex follows the tube next to it.
struct Beast {
  std::vector<Tube> tubes = quadruped_tubes();
  std::vector<float> positions, weights, inverse_binds;
  std::vector<std::uint16_t> joints;
  std::vector<std::uint32_t> corners;
  json nodes = {{{"name", "root"}, {"children", json::array()}}};

  Beast() {
    const SourceMesh mesh = melt(tubes, 0.16);
    for (const Tube& tube : tubes) {
      nodes[0]["children"].push_back(nodes.size());
      nodes.push_back({{"name", "joint" + std::to_string(nodes.size())},
                       {"translation", {tube.from.x(), tube.from.y(), tube.from.z()}}});
      for (int i = 0; i < 12; ++i) inverse_binds.push_back(i % 5 == 0 ? 1.0F : 0.0F);
      for (int k = 0; k < 3; ++k) inverse_binds.push_back(static_cast<float>(-tube.from[k]));
      inverse_binds.push_back(1);
    }
    for (const Vec3& p : mesh.positions) {
      std::size_t nearest = 0;
      for (std::size_t t = 1; t < tubes.size(); ++t) {
        if ((p - middle(t)).norm() < (p - middle(nearest)).norm()) nearest = t;
      }
      for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
      joints.insert(joints.end(), {static_cast<std::uint16_t>(nearest), 0, 0, 0});
      weights.insert(weights.end(), {1, 0, 0, 0});
    }
    for (const Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  }

  Vec3 middle(std::size_t tube) const { return (tubes[tube].from + tubes[tube].to) / 2; }
  std::size_t vertices() const { return joints.size() / 4; }
  int add_joint() {
    nodes[0]["children"].push_back(nodes.size());
    nodes.push_back({{"name", "more"}});
    for (int i = 0; i < 16; ++i) inverse_binds.push_back(i % 5 == 0 ? 1.0F : 0.0F);
    return static_cast<int>(nodes.size()) - 2;
  }
  // The vertices that follow a joint go through `change`.
  void for_vertices_of(std::uint16_t joint, const std::function<void(float*)>& change) {
    for (std::size_t v = 0; v < vertices(); ++v) {
      if (joints[4 * v] == joint) change(&positions[3 * v]);
    }
  }

  std::string bytes() const {
    Glb glb;
    json skinned{{"mesh", 0}, {"skin", 0}}, all = nodes, joint_nodes = json::array();
    all.push_back(skinned);
    for (std::size_t n = 1; n < nodes.size(); ++n) joint_nodes.push_back(n);
    glb.json["nodes"] = all;
    glb.json["scenes"] = {{{"nodes", {0, nodes.size()}}}};
    glb.json["meshes"] = {{{"primitives",
                            {{{"attributes",
                               {{"POSITION", glb.accessor(positions, "VEC3")},
                                {"JOINTS_0", glb.accessor(joints, "VEC4")},
                                {"WEIGHTS_0", glb.accessor(weights, "VEC4")}}},
                              {"indices", glb.accessor(corners, "SCALAR")}}}}}};
    glb.json["skins"] = {{{"joints", joint_nodes}, {"inverseBindMatrices", glb.accessor(inverse_binds, "MAT4")}}};
    return glb.bytes();
  }
};

// "bakes", or the error.
std::string outcome(const Beast& beast) {
  const TemporaryFolder folder;
  const std::string file = folder.write("odd.glb", beast.bytes()).string();
  try {
    return bake(file, {}, {}).asset.empty() ? "an empty asset" : "bakes";
  } catch (const Error& error) {
    const std::string what = error.what();
    CHECK(what.rfind(file + ": ", 0) == 0);
    return what;
  }
}

struct Case {
  const char* name;
  const char* outcome;  // the whole of "bakes", or a part of the error
  std::function<void(Beast&)> change;
};

const float kNotANumber = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();

}  // namespace

TEST_CASE("odd files bake or say what is wrong with them") {
  const std::vector<Case> cases{
      {"nothing is odd", "bakes", [](Beast&) {}},
      {"a joint that moves nothing", "bakes", [](Beast& b) { b.add_joint(); }},
      {"a joint that moves one triangle", "bakes",
       [](Beast& b) {
         const auto joint = static_cast<std::uint16_t>(b.add_joint());
         for (std::size_t c = 0; c < 3; ++c) b.joints[4 * b.corners[c]] = joint;
       }},
      {"joints of one triangle each", "bakes",
       [](Beast& b) {
         for (std::size_t t = 0; t < 40; ++t) {
           const auto joint = static_cast<std::uint16_t>(b.add_joint());
           for (std::size_t c = 0; c < 3; ++c) b.joints[4 * b.corners[30 * t + c]] = joint;
         }
       }},
      {"all weights zero", "bakes", [](Beast& b) { std::fill(b.weights.begin(), b.weights.end(), 0.0F); }},
      {"weights of a limb zero", "bakes",
       [](Beast& b) {
         for (std::size_t v = 0; v < b.vertices(); ++v) {
           if (b.joints[4 * v] == 1) b.weights[4 * v] = 0;
         }
       }},
      {"weights below zero", "bakes", [](Beast& b) { b.weights[0] = -1; }},
      {"a region without an area", "bakes",
       [](Beast& b) { b.for_vertices_of(1, [](float* p) { p[0] = p[1] = p[2] = 0.5F; }); }},
      {"a region in a plane", "bakes", [](Beast& b) { b.for_vertices_of(1, [](float* p) { p[0] = 0.25F; }); }},
      {"a region on a line", "bakes", [](Beast& b) { b.for_vertices_of(1, [](float* p) { p[0] = p[1] = 0.25F; }); }},
      {"every vertex at one place", "has no size",
       [](Beast& b) { std::fill(b.positions.begin(), b.positions.end(), 1.0F); }},
      {"every triangle on a line", "has no triangles with an area",
       [](Beast& b) {
         for (std::size_t v = 0; v < b.vertices(); ++v) b.positions[3 * v] = b.positions[3 * v + 1] = 0;
       }},
      {"every triangle twice", "bakes",
       [](Beast& b) {
         const std::vector<std::uint32_t> once = b.corners;
         b.corners.insert(b.corners.end(), once.begin(), once.end());
       }},
      {"a position that is no number", "not finite", [](Beast& b) { b.positions[7] = kNotANumber; }},
      {"a position without end", "not finite", [](Beast& b) { b.positions[7] = kInfinite; }},
      {"a weight that is no number", "not finite", [](Beast& b) { b.weights[8] = kNotANumber; }},
      {"a bind pose that is no number", "not finite", [](Beast& b) { b.inverse_binds[3] = kNotANumber; }},
      {"a bind pose without a size", "bakes", [](Beast& b) { std::fill_n(b.inverse_binds.begin() + 16, 11, 0.0F); }},
      {"a joint beyond the skin's", "follows joint 999", [](Beast& b) { b.joints[0] = 999; }},
      {"a vertex beyond the mesh's", "uses vertex", [](Beast& b) { b.corners[5] = 99999; }},
      {"all nodes of one name", "bakes",
       [](Beast& b) {
         for (json& node : b.nodes) node["name"] = "bone";
       }},
      {"nodes without a name", "bakes",
       [](Beast& b) {
         for (json& node : b.nodes) node.erase("name");
       }},
      {"a joint of no size", "bakes",
       [](Beast& b) {
         b.nodes[2]["scale"] = {0, 0, 0};
       }},
      {"a node that is its own child", "is its own ancestor",
       [](Beast& b) {
         b.nodes[0]["children"].erase(0);
         b.nodes[1]["children"] = {1};
       }},
      {"nodes in a circle", "is its own ancestor",
       [](Beast& b) {
         b.nodes[0]["children"].erase(0);
         b.nodes[0]["children"].erase(0);
         b.nodes[1]["children"] = {2};
         b.nodes[2]["children"] = {1};
       }},
      {"a node with two parents", "has two parents", [](Beast& b) { b.nodes[2]["children"] = {1}; }},
  };
  for (const Case& odd : cases) {
    CAPTURE(odd.name);
    Beast beast;
    odd.change(beast);
    const std::string came = outcome(beast);
    CHECK_MESSAGE(came.find(odd.outcome) != std::string::npos, came);
  }
}
