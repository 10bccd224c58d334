// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "motion/motion.h"
#include "play/asset_file.h"
#include "spherechain/penetrations.h"
#include "spherechain/skin_contacts.h"

namespace spherechain::baker {

class AnimatedAsset;

// Whether a penetration is of these two parts, whichever goes in.
inline bool are_of(const Penetration& found, std::uint32_t part_a, std::uint32_t part_b) {
  return std::minmax(found.part, found.other) == std::minmax(part_a, part_b);
}

// x, y, z of each of the source's vertices, which must outlive the pose.
sc_pose pose_of(const std::vector<float>& vertices);

// A deformation as the runtime takes it: by bones and morph weights, for an asset that these move.
class BonePose {
 public:
  BonePose(const OpenAsset& asset, const Deformation& deformation);
  sc_pose pose() const;

 private:
  std::vector<float> bones_, morphs_;
};

// Whole meshes as poses have no bones.
bool moved_by_bones(const OpenAsset& asset, const Deformation& deformation);

// The same where bones move the asset, else the deformed vertices. Every command asks so, as games do: vertices that
// are skinned elsewhere differ in their last bits, and so may a contact that hardly is one.
class SkinPose {
 public:
  SkinPose(const AnimatedAsset& animated, const Deformation& deformation);
  sc_pose pose() const { return bones_ ? bones_->pose() : pose_of(vertices_); }

 private:
  std::optional<BonePose> bones_;
  std::vector<float> vertices_;
};

// Runs a job on triangles that intersect until there is room for all of them.
template <typename Job>
void list_triangles(Job& job, std::vector<TriangleContact>& contacts) {
  contacts.resize(std::max<std::size_t>(contacts.capacity(), 256));
  for (bool fits = false; !fits;) {
    job.triangles = contacts.data();
    job.triangle_capacity = contacts.size();
    const Status status = job.run();
    if (status.code != SC_OVERFLOW) check_runtime(status);
    fits = job.triangle_count <= contacts.size();
    contacts.resize(job.triangle_count);
  }
}

// The runtime's exact contacts of one pose after another, and what they measure. The asset must have clusters.
class SkinPlayer {
 public:
  SkinPlayer(const OpenAsset& asset, Target target);

  // Finds which body parts meet, and lists nothing: what a game asks.
  void ask(const sc_pose& pose);
  // The triangles that intersect. Both lists hold until the next call.
  const std::vector<TriangleContact>& find(const sc_pose& pose);
  // What find() found in that pose, sorted by body parts. `is_next`: the pose follows the last one measured, and
  // directions may follow that one's.
  const std::vector<Penetration>& measure(const sc_pose& pose, bool is_next);
  // The same by the quick form: along one direction, as games do.
  const std::vector<Penetration>& measure_quickly(const sc_pose& pose) { return measure_quickly(pose, contacts_); }
  // Of some pairs of parts: `contacts` are all of theirs.
  const std::vector<Penetration>& measure_quickly(const sc_pose& pose, const std::vector<TriangleContact>& contacts);
  // Two body parts alone, in full, whatever came before. `contacts` are all of theirs in that pose.
  Penetration measure_parts(const sc_pose& pose, const std::vector<TriangleContact>& contacts);

 private:
  SkinContactJob job(const sc_pose& pose);
  PenetrationJob measure_job(const sc_pose& pose, const std::vector<TriangleContact>& contacts);
  const std::vector<Penetration>& run(PenetrationJob& job);

  const OpenAsset& asset_;
  Target target_;
  std::vector<std::uint64_t> scratch_, measure_scratch_;
  std::vector<TriangleContact> contacts_;
  std::vector<Penetration> penetrations_, before_;
  std::size_t part_count_ = 0;  // pairs of parts in contact
};

}  // namespace spherechain::baker
