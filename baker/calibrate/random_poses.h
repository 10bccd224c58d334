// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/calibrate/random.h"
#include "baker/import/import.h"
#include "baker/import/moved_nodes.h"
#include "baker/rig/rig.h"

namespace spherechain::baker {

// Poses that a character may take, of three kinds in turn:
// 1. a moment of one of its clips, as it is;
// 2. a moment of its own for each branch of the skeleton, or that of the joint above, as chance has it: limbs bend as
//    in the clips, and meet as they do not there;
// 3. each joint turned about its three axes on its own, evenly in a box of rotation vectors: the smallest around all
//    keys of the clips and 10 degrees more. So are translations, scales and morph weights, without the 10 degrees.
// In the second kind each joint turns by up to 5 degrees more about each axis. Without clips all poses are of the
// third kind: a joint turns by up to 45 degrees, and morphs keep their weight at rest. A rig with pivots and clips has
// the second kind in place of the third.
// A robot's poses have a value of each joint evenly within its limits; a hinge without limits turns once around, and a
// slide without them stays.
class RandomPoses {
 public:
  // `joints`: the automatic rig's, for a character without bones. The character must outlive this.
  RandomPoses(const Character& character, const std::vector<Joint>& joints);

  // True if there is anything to move.
  bool any() const { return !rig_.bones.empty(); }
  bool have_clips() const { return clips_ != nullptr; }

  // Lets the joints of that name turn, in poses of the third kind, by rotation vectors between these two from where
  // they are at rest, about their own axes; in radians. False where there are none.
  bool limit(const std::string& joint, const Vec3& low, const Vec3& high);

  struct Pose {
    std::vector<Affine> bones;  // for each bone: rest -> posed
    std::vector<double> morphs;
  };
  // Draws a pose of kind 0 to 2 (see above). Kind 0 takes the pose at share `part` of the clips' time.
  Pose next(Random& random, int kind, double part) const;

 private:
  struct Range {
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  };
  struct Limits {
    Eigen::Quaterniond middle = Eigen::Quaterniond::Identity();  // reference rotation of the rotation vectors
    Range turn, translation, scale;
    bool moves = false;  // else the node keeps its transform
  };

  struct Moment {
    std::size_t clip;
    double seconds;
  };
  Moment moment_at(double part) const;
  Moment any_moment(Random& random) const;
  // The clip times of all nodes.
  std::vector<Moment> of_branches(Random& random) const;
  // A moving node's transform, and its components.
  struct Parts {
    explicit Parts(const Node& node)
        : rotation(node.rotation), translation(node.translation), scale(node.scale), local(node.local) {}
    Eigen::Quaterniond rotation;
    Vec3 translation, scale;
    Affine local;
  };
  std::vector<Parts> at_moments(const std::vector<Moment>& of_node) const;
  void turn_about_pivot(Index n, Parts& parts, const Eigen::Quaterniond& rotation) const;
  std::vector<Parts> bent(std::vector<Parts> moving, Random& random) const;
  std::vector<Parts> turned(Random& random) const;
  std::vector<Parts> driven(Random& random) const;
  void plan();
  std::vector<Affine> bones_in(const std::vector<Parts>& moving) const;

  SourceRig rig_;                             // nodes, bones and to_rest; of an automatic rig, too
  std::vector<Limits> limits_;                // of each node
  std::vector<Clip> const* clips_ = nullptr;  // none: all poses are of the third kind
  std::vector<std::vector<std::vector<const Channel*>>> channels_;  // of each clip and node
  std::vector<int> children_;                                       // of each node
  std::vector<Index> moving_;                                       // nodes with limits
  MovedNodes moved_;
  std::vector<Vec3> own_pivots_;                   // of each node, in its own space; empty without SourceRig::pivots
  std::vector<std::pair<double, double>> morphs_;  // the least and the greatest weight
};

}  // namespace spherechain::baker
