// SPDX-License-Identifier: GPL-3.0-or-later
// The contestants of goal P6: the triangles of a deformed mesh that intersect.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "character.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::bench {

// Input of all contestants: one pose of the character.
struct ContactPose {
  std::vector<float> positions;  // of the source's vertices, x y z after another
  Pose bones;                    // the bones that give these positions
};

class ContactFinder {
 public:
  virtual ~ContactFinder() = default;
  // The timed call. Buffers are made before.
  virtual void find(const ContactPose& pose) = 0;
  // The source triangles that intersect in the pose of the last find(), a < b, in any order. Not timed.
  virtual std::vector<Pair> pairs() = 0;

  const std::string name;

 protected:
  explicit ContactFinder(std::string name) : name(std::move(name)) {}
};

// The asset's skin as peers need it, and its expanded table as the runtime needs it.
struct ContactMesh {
  explicit ContactMesh(const PosedCharacter& character);

  // True if the runtime looks for this pair: of two spheres that are not ignored, and no neighbours.
  bool is_wanted(std::uint32_t a, std::uint32_t b) const;
  // The corner of a triangle (by its place in source_triangles) in a pose.
  const float* corner(const ContactPose& pose, std::size_t triangle, std::size_t k) const {
    return pose.positions.data() + 3 * std::size_t{corners[3 * triangle + k]};
  }

  const PosedCharacter& character;
  Memory skin_table;
  Surface surface;  // a view of skin_table
  std::vector<std::uint32_t> source_triangles;
  std::vector<std::uint32_t> corners;   // source vertices, three a triangle
  std::vector<std::uint32_t> welds;     // the same corners: equal where they are at one place at rest
  std::vector<std::uint32_t> spheres;   // of the triangles
  std::vector<std::uint32_t> vertices;  // a weld's source vertex
};

using ContactFinders = std::vector<std::unique_ptr<ContactFinder>>;

// The product's question: which body parts touch, and in how many triangles. From vertices, from bones, from both.
ContactFinders runtime_part_finders(const ContactMesh& mesh);
// The same three with a list of the triangles and the segments in which they cross.
ContactFinders runtime_triangle_finders(const ContactMesh& mesh);
// The triangles from bones, and depth, direction and class of the parts (P10): in full, and the quick form.
ContactFinders runtime_depth_finders(const ContactMesh& mesh);
ContactFinders cgal_contact_finders(const ContactMesh& mesh);
ContactFinders embree_contact_finders(const ContactMesh& mesh);
ContactFinders fcl_contact_finders(const ContactMesh& mesh);

}  // namespace spherechain::bench
