// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/rig/rig.h"

#include <doctest/doctest.h>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "baker/segment/by_shape.h"
#include "rigged_human.h"

using namespace spherechain::baker;

namespace {

// The human in other units, turned and moved.
Character moved(const Character& character, const Eigen::Matrix3d& rotation, double scale, const Vec3& shift) {
  SourceMesh source;
  for (const Vec3& p : character.source_positions) source.positions.push_back(scale * rotation * p + shift);
  for (const Index t : character.largest_piece.source_triangle)
    source.triangles.push_back(character.source_triangles[t]);
  return build_character(source, "moved");
}

std::string other_side(const std::string& joint) {
  if (joint.starts_with("left_")) return "right_" + joint.substr(5);
  if (joint.starts_with("right_")) return "left_" + joint.substr(6);
  return joint;
}

Vec3 mirrored(const Vec3& p) { return {-p.x(), p.y(), p.z()}; }

}  // namespace

TEST_CASE("the skeleton has the joints that pose files name, parents before children") {
  const RiggedHuman& h = rigged_human();
  for (const char* side : {"left_", "right_"}) {
    for (const char* name : {"clavicle", "shoulder", "elbow", "wrist", "hip", "knee", "ankle"}) {
      CHECK(h.joint(std::string(side) + name) < h.joints.size());
    }
  }
  for (const char* name : {"pelvis", "spine", "chest", "neck", "head"}) CHECK(h.joint(name) < h.joints.size());
  for (std::size_t j = 0; j < h.joints.size(); ++j) {
    CHECK(h.joints[j].parent < static_cast<int>(j));
    CHECK((h.joints[j].tail - h.joints[j].position).norm() > 0.03 * h.frame.height);
  }
}

TEST_CASE("joints sit at the heights anatomy gives them") {
  const RiggedHuman& h = rigged_human();
  // Fractions of the height; 0.03 is the spread between bodies and tables (Drillis and Contini, de Leva).
  const std::pair<const char*, double> heights[] = {{"left_ankle", 0.04},    {"left_knee", 0.28}, {"left_hip", 0.52},
                                                    {"left_shoulder", 0.81}, {"neck", 0.84},      {"head", 0.91}};
  for (const auto& [name, height] : heights) {
    INFO(name);
    CHECK(std::abs(h.own_axes(h.joints[h.joint(name)].position).y() - height) < 0.03);
  }
}

TEST_CASE("left and right joints mirror each other to 1.5 % of the height") {
  const RiggedHuman& h = rigged_human();
  for (const Joint& joint : h.joints) {
    INFO(joint.name);
    const Vec3 other = h.own_axes(h.joints[h.joint(other_side(joint.name))].position);
    CHECK((h.own_axes(joint.position) - mirrored(other)).norm() < 0.015);
  }
}

TEST_CASE("joints turn, move and scale with the mesh") {
  const RiggedHuman& h = rigged_human();
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Vec3 shift(30, -200, 75);
  const Character other = moved(h.character, rotation, 100, shift);
  const std::vector<Joint> joints = place_joints(*segment_by_shape(other, other.largest_piece, {}));
  REQUIRE(joints.size() == h.joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    INFO(joints[j].name);
    CHECK(joints[j].name == h.joints[j].name);
    // Positions are floats: the curve skeleton answers to their last bits, and by this much.
    CHECK((joints[j].position - (100 * rotation * h.joints[j].position + shift)).norm() < 0.005 * 100 * h.frame.height);
  }
}

TEST_CASE("weights sum to one, none is negative, the largest comes first") {
  const RiggedHuman& h = rigged_human();
  REQUIRE(h.weights.size() == h.body.positions.size());
  for (const VertexWeights& w : h.weights) {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      REQUIRE(w.weight[k] >= 0);
      REQUIRE(w.joint[k] < h.joints.size());
      if (k > 0) REQUIRE(w.weight[k] <= w.weight[k - 1]);
      sum += w.weight[k];
    }
    REQUIRE(sum == doctest::Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("weights depend on nothing but mesh and joints, and are the same every time") {
  const RiggedHuman& h = rigged_human();
  const std::vector<VertexWeights> again = bone_heat_weights(h.body, h.joints);
  for (std::size_t v = 0; v < again.size(); ++v) {
    REQUIRE(again[v].joint == h.weights[v].joint);
    REQUIRE(again[v].weight == h.weights[v].weight);
  }
}

TEST_CASE("weights do not change with position, orientation and unit") {
  const RiggedHuman& h = rigged_human();
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(2.0, Vec3(1, 1, -1).normalized()).toRotationMatrix();
  const Vec3 shift(3, 4, 5);
  Mesh mesh = h.body;
  for (Vec3& p : mesh.positions) p = 10 * rotation * p + shift;
  std::vector<Joint> joints = h.joints;
  for (Joint& joint : joints) {
    joint.position = 10 * rotation * joint.position + shift;
    joint.tail = 10 * rotation * joint.tail + shift;
  }
  const std::vector<VertexWeights> weights = bone_heat_weights(mesh, joints);
  double sum = 0;
  for (std::size_t v = 0; v < weights.size(); ++v) sum += std::abs(weights[v].weight[0] - h.weights[v].weight[0]);
  // A line of sight that grazes the skin may end the other way: a few vertices, not the mean.
  CHECK(sum / static_cast<double>(weights.size()) < 1e-5);
}

TEST_CASE("weights of left and right mirror each other on average") {
  const RiggedHuman& h = rigged_human();
  for (const char* name : {"shoulder", "elbow", "wrist", "hip", "knee", "ankle", "clavicle"}) {
    INFO(name);
    double left = 0, right = 0;
    for (std::size_t v = 0; v < h.weights.size(); ++v) {
      left += h.weight(v, std::string("left_") + name);
      right += h.weight(v, std::string("right_") + name);
    }
    CHECK(std::abs(left - right) <= 0.05 * right);
  }
}

TEST_CASE("a turned elbow moves its own hand rigidly and leaves the other arm exactly where it was") {
  const RiggedHuman& h = rigged_human();
  const std::size_t elbow = h.joint("left_elbow");
  const std::vector<Vec3> posed = h.posed(turn("left_elbow", 70, {0.3, -1, 0.2}));
  const Vec3 axis = 0.3 * h.frame.left - 1.0 * h.frame.up + 0.2 * h.frame.forward;
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(70 * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
  const Vec3 pivot = h.joints[elbow].position;
  std::size_t hand = 0;
  for (std::size_t v = 0; v < posed.size(); ++v) {
    if (h.own_axes(h.body.positions[v]).x() < 0) REQUIRE(posed[v] == h.body.positions[v]);
    if (h.weight(v, "left_wrist") < 0.5) continue;
    ++hand;
    const Vec3 rigid = rotation * (h.body.positions[v] - pivot) + pivot;
    REQUIRE((posed[v] - rigid).norm() < 0.001 * h.frame.height);
  }
  CHECK(hand > 1000);
}

TEST_CASE("a raised thigh does not take the other one along") {
  const RiggedHuman& h = rigged_human();
  const std::vector<Vec3> posed = h.posed(turn("left_hip", 90, {-1, 0, 0}));
  for (std::size_t v = 0; v < posed.size(); ++v) {
    const Vec3 p = h.own_axes(h.body.positions[v]);
    if (p.x() < -0.02 && p.y() < 0.42) REQUIRE(posed[v] == h.body.positions[v]);
  }
}

TEST_CASE("arms do not pull at the flank across the gap") {
  const RiggedHuman& h = rigged_human();
  for (std::size_t v = 0; v < h.weights.size(); ++v) {
    const Vec3 p = h.own_axes(h.body.positions[v]);
    if (std::abs(p.x()) > 0.11 || p.y() > 0.70) continue;
    for (const char* name : {"left_elbow", "left_wrist", "right_elbow", "right_wrist"}) REQUIRE(h.weight(v, name) == 0);
    for (const char* name : {"left_shoulder", "right_shoulder"}) REQUIRE(h.weight(v, name) < 0.1);
  }
}

TEST_CASE("every source vertex has weights, and the eyes go with the head") {
  const RiggedHuman& h = rigged_human();
  const std::vector<VertexWeights> weights = rig_weights(h.character, h.character.largest_piece, h.joints);
  REQUIRE(weights.size() == h.character.source_positions.size());
  std::size_t others = 0;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    REQUIRE(weights[v].weight[0] > 0);
    if (h.character.largest_piece.of_source[v] != kNoIndex) continue;
    ++others;
    CHECK(weights[v].joint[0] == h.joint("head"));
    CHECK(weights[v].weight[0] > 0.8);
  }
  CHECK(others > 0);
}
