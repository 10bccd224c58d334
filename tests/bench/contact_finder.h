// SPDX-License-Identifier: GPL-3.0-or-later
// Who competes for goal P6: the triangles of a deformed mesh that intersect.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "character.h"
#include "spherechain/surface.h"

namespace spherechain::bench {

// What all are given: a character's surface, the asset's triangles in the source's order, and one pose of it.
struct ContactPose {
  std::vector<float> positions;  // of the source's vertices, x y z after another
  BoneMatrices bones;            // that give them
};

class ContactFinder {
 public:
  virtual ~ContactFinder() = default;
  // This is what is timed: from a pose to an array of pairs. Buffers are made before.
  virtual void find(const ContactPose& pose) = 0;
  // Of the last find(): source triangle numbers, a < b, in any order.
  virtual std::vector<TrianglePair> pairs() const = 0;

  const std::string name;

 protected:
  explicit ContactFinder(std::string name) : name(std::move(name)) {}
};

// What a peer needs of the surface.
struct ContactMesh {
  explicit ContactMesh(const PosedCharacter& character);

  // Of different spheres that are not ignored, and no neighbours: what the runtime looks for.
  bool is_wanted(std::uint32_t a, std::uint32_t b) const;
  // The corner of a triangle (by its place in source_triangles) in a pose.
  const float* corner(const ContactPose& pose, std::size_t triangle, std::size_t k) const {
    return pose.positions.data() + 3 * std::size_t{corners[3 * triangle + k]};
  }

  const PosedCharacter& character;
  std::vector<std::uint32_t> source_triangles;
  std::vector<std::uint32_t> corners;   // source vertices, three a triangle
  std::vector<std::uint32_t> welds;     // the same corners: equal where they are at one place at rest
  std::vector<std::uint32_t> spheres;   // of the triangles
  std::vector<std::uint32_t> vertices;  // a weld's source vertex
};

using ContactFinders = std::vector<std::unique_ptr<ContactFinder>>;

// From vertices, from bones and from both.
ContactFinders runtime_contact_finders(const ContactMesh& mesh);
ContactFinders cgal_contact_finders(const ContactMesh& mesh);
ContactFinders embree_contact_finders(const ContactMesh& mesh);
ContactFinders fcl_contact_finders(const ContactMesh& mesh);

}  // namespace spherechain::bench
