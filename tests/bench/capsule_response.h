// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/play/bone_joints.h"
#include "baker/play/play.h"
#include "baker/volumes/colliders.h"

namespace spherechain::bench {

using baker::Affine, baker::Vec3;

// Keeps arms out of the body as games do it: by the capsules of `spherechain export --volumes capsules`. Pairs of
// capsules are pushed apart by the joints that sc_respond turns, with its mobility, budget, rate and release. Capsules
// that are adjacent or overlap at rest are ignored, as in the export. Each frame starts from the last frame's turns.
class CapsuleResponse {
 public:
  explicit CapsuleResponse(const baker::AnimatedAsset& animated);

  struct Corrected {
    baker::Deformation pose;
    double us;  // processor time of the correction
  };
  // Turns the arms of the animated pose. `seconds` since the last frame; `starts_clip`: it forgets the frames before.
  Corrected correct(const baker::Deformation& animated, double seconds, bool starts_clip);

  // The ends and radii of all capsules in the last frame, in the source's units: for pictures.
  struct Placed {
    Vec3 a, b;
    double radius;
  };
  const std::vector<Placed>& placed() const { return placed_; }

 private:
  struct Turning {
    std::size_t joint;
    double mobility;
    bool is_elbow;
    std::size_t below = 0;  // of an elbow: the wrist
    Vec3 turn = Vec3::Zero();
  };
  struct Capsule {
    std::size_t joint;
    Vec3 a, b;  // in the joint's space
    double radius;
    unsigned moved_by = 0;  // a bit for each turning joint
  };
  struct Row {
    std::size_t pair;
    double gap, wanted, pull;
    std::vector<Vec3> opens, turns;
  };
  void add_capsules(const baker::Colliders& colliders);
  void place(std::vector<Affine>& world, bool with_turns) const;
  void place_capsules(const std::vector<Affine>& world);
  double gap_of(std::size_t pair, Vec3& on_a, Vec3& on_b) const;
  void find_rows(const std::vector<Affine>& world);
  void solve(const std::vector<Affine>& world, const std::vector<Vec3>& rest);

  const baker::AnimatedAsset& animated_;
  baker::BoneJoints joints_;
  double height_;
  std::vector<Turning> turning_;
  std::vector<Capsule> capsules_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  std::vector<sc_transform> locals_;
  std::vector<Affine> world_;  // as animated
  std::vector<Placed> placed_;
  std::vector<double> animated_gaps_;  // of each pair
  std::vector<Row> rows_;
};

}  // namespace spherechain::bench
