// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// A joint turns its part of the body about `position`; its bone is the segment from there to `tail`.
struct Joint {
  std::string name;
  int parent;  // -1 for the root; parents come before their children
  Vec3 position, tail;
};

// Places joints in a biped without a skeleton, from its regions' centre lines: pelvis, spine, chest, neck, head, and on
// either side (left_, right_) clavicle, shoulder, elbow, wrist, hip, knee, ankle. Positions are rounded to single
// precision, as in the asset: whoever reads the asset gets the same weights from them.
std::vector<Joint> place_joints(const Regions& regions);

// Bone-heat weights of every vertex of a closed mesh (Baran and Popovic 2007, section 4), at most four joints a vertex.
// The same mesh and joints give the same weights.
std::vector<VertexWeights> bone_heat_weights(const Mesh& mesh, const std::vector<Joint>& joints);

// Weights of every source vertex. The body's come from bone heat; vertices of other pieces (eyes) take those of the
// nearest vertex of the body.
std::vector<VertexWeights> rig_weights(const Character& character, const BodyMesh& body,
                                       const std::vector<Joint>& joints);

}  // namespace spherechain::baker
