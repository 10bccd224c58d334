// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/from_skin.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "baker/segment/by_shape.h"
#include "rigged_human.h"

using namespace spherechain::baker;

namespace {

// The human with the automatic rig as if its file had brought it along.
Character with_rig(const RiggedHuman& human) {
  Character character = human.character;
  for (const Joint& joint : human.joints) {
    Node node;
    node.name = joint.name;
    node.parent = joint.parent;
    const Vec3 origin = joint.parent < 0 ? Vec3::Zero() : human.joints[joint.parent].position;
    node.local.translation() = joint.position - origin;
    Affine inverse_bind = Affine::Identity();
    inverse_bind.translation() = -joint.position;
    character.rig.bones.push_back({static_cast<Index>(character.rig.nodes.size()), inverse_bind});
    character.rig.nodes.push_back(node);
  }
  character.rig.weights = rig_weights(character, character.largest_piece, human.joints);
  return character;
}

struct SkinnedHuman {
  RiggedHuman human;
  Character character = with_rig(human);
  Roles roles = find_roles(character.rig, character.source_positions);
  SkinRegions regions = segment_from_skin(character, character.largest_piece, roles);
};

const SkinnedHuman& skinned_human() {
  static const SkinnedHuman fixture;
  return fixture;
}

// Share of the body's area that has the same region from skin as from shape.
double agreement(const Character& character, const SkinRegions& skin, const Regions& shape) {
  double same = 0;
  for (std::size_t t = 0; t < skin.of_triangle.size(); ++t) {
    const bool torso = skin.of_triangle[t] == SkinRegions::kNoLimb;
    if ((torso ? shape.torso_region() : skin.of_triangle[t]) == shape.of_triangle[t]) {
      same += triangle_area(character.largest_piece.mesh, t);
    }
  }
  return same / surface_area(character.largest_piece.mesh);
}

// Pieces of each label, over shared edges.
std::size_t count_pieces(const Mesh& mesh, const std::vector<std::uint8_t>& labels) {
  const auto neighbours = triangle_neighbours(mesh);
  std::vector<bool> seen(labels.size(), false);
  std::size_t pieces = 0;
  for (Index seed = 0; seed < labels.size(); ++seed) {
    if (seen[seed]) continue;
    ++pieces;
    std::vector<Index> stack{seed};
    seen[seed] = true;
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (const Index n : neighbours[t]) {
        if (n == kNoIndex || seen[n] || labels[n] != labels[seed]) continue;
        seen[n] = true;
        stack.push_back(n);
      }
    }
  }
  return pieces;
}

}  // namespace

TEST_CASE("regions from skin agree with regions from shape on 95 % of the area") {
  const SkinnedHuman& human = skinned_human();
  REQUIRE(human.roles.limbs.size() == 4);
  CHECK(agreement(human.character, human.regions, ::human().regions) >= 0.95);
}

TEST_CASE("regions from skin agree with regions from shape on a MakeHuman body with its own rig") {
  const char* folder = std::getenv("SPHERECHAIN_TEST_DATA");
  if (folder == nullptr) return;
  const Character character = import_character(std::string(folder) + "/mh_boxing.glb");
  const SkinRegions skin =
      segment_from_skin(character, character.largest_piece, find_roles(character.rig, character.source_positions));
  CHECK(agreement(character, skin, *segment_by_shape(character, character.largest_piece, {})) >= 0.95);
}

TEST_CASE("every region from skin is one piece, and eyes are the head's") {
  const SkinnedHuman& human = skinned_human();
  CHECK(count_pieces(human.character.largest_piece.mesh, human.regions.of_triangle) == 5);
  CHECK(std::set<std::uint8_t>(human.regions.of_triangle.begin(), human.regions.of_triangle.end()).size() == 5);
  REQUIRE(human.regions.of_skin.size() == human.character.skin.triangles.size());
  std::set<Index> body(human.character.largest_piece.source_triangle.begin(),
                       human.character.largest_piece.source_triangle.end());
  std::size_t others = 0;
  for (std::size_t t = 0; t < human.regions.of_skin.size(); ++t) {
    if (body.count(human.character.skin_source_triangle[t]) > 0) continue;
    ++others;
    CHECK(human.regions.of_skin[t] == SkinRegions::kNoLimb);
  }
  CHECK(others > 0);
}

TEST_CASE("a patch of skin that hangs on the wrong joint joins what is around it") {
  SkinnedHuman human = skinned_human();
  const auto wrist = static_cast<Index>(human.human.joint("left_wrist"));
  // The crown of the head follows the hand, and one thigh's middle nothing at all.
  const double crown = human.human.own_axes(human.human.joints[human.human.joint("head")].tail).y();
  for (std::size_t v = 0; v < human.character.source_positions.size(); ++v) {
    VertexWeights& weights = human.character.rig.weights[v];
    const double height = human.human.own_axes(human.character.source_positions[v]).y();
    if (height > crown - 0.02) weights = {{wrist}, {1.0}};
    if (height > 0.35 && height < 0.37) weights = {};
  }
  const SkinRegions regions = segment_from_skin(human.character, human.character.largest_piece, human.roles);
  CHECK(count_pieces(human.character.largest_piece.mesh, regions.of_triangle) == 5);
  CHECK(agreement(human.character, regions, ::human().regions) >= 0.95);
}

TEST_CASE("a limb's line runs from its cut through its joints to its tip") {
  const SkinnedHuman& human = skinned_human();
  const double height = human.human.frame.height;
  for (std::size_t i = 0; i < 4; ++i) {
    CAPTURE(human.roles.limbs[i].name);
    const SkinLimb& limb = human.regions.limbs[i];
    const Limb& shape = ::human().regions.limbs[i];
    // By shape it ends a finger's or a toe's width elsewhere, and begins where the curve skeleton does.
    CHECK((limb.line.points().back() - shape.line.points().back()).norm() < 0.05 * height);
    CHECK((limb.line.at(0) - shape.line.at(0)).norm() < 0.05 * height);
    CHECK((limb.line.at(limb.extremity) - shape.line.at(shape.extremity)).norm() < 0.05 * height);
    // The triangles along it are the limb's.
    const SurfaceQuery surface(human.character.largest_piece.mesh);
    for (int k = 1; k < 10; ++k) {
      const Index t = surface.closest(limb.line.at(0.1 * k * limb.line.length())).triangle;
      CHECK(human.regions.of_triangle[t] == i);
    }
  }
}

TEST_CASE("a limb that moves no skin has no triangles and no line") {
  SkinnedHuman human = skinned_human();
  const auto chest = static_cast<Index>(human.human.joint("chest"));
  for (VertexWeights& weights : human.character.rig.weights) {
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      if (human.roles.of_node[weights.joint[k]].limb == 1) weights.joint[k] = chest;
    }
  }
  const SkinRegions regions = segment_from_skin(human.character, human.character.largest_piece, human.roles);
  CHECK(regions.limbs[1].line.points().empty());
  CHECK(std::count(regions.of_triangle.begin(), regions.of_triangle.end(), 1) == 0);
  CHECK(std::count(regions.of_triangle.begin(), regions.of_triangle.end(), 0) > 0);
}
