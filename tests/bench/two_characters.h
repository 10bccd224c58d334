// SPDX-License-Identifier: GPL-3.0-or-later
// Two animated characters that stand or walk near each other, and the response keeps the arms of each out of the other.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "baker/play/responder.h"

namespace spherechain::bench {

// Where the second is. Both are scaled to 1.75 m, and the middles of their shoulders are held 1.4 m above their spots.
enum class Stance {
  kFacing,   // before the first, and looks at it
  kBeside,   // at its left
  kPassing,  // at its left, looks the other way, and goes forward and backward by 1 m, in four seconds
};

class TwoCharacters {
 public:
  // `metres`: between the middles of their shoulders. Both animations must outlive it.
  TwoCharacters(const baker::AnimatedAsset& first, const baker::AnimatedAsset& second, Target target, Stance stance,
                double metres);

  struct Frame {
    std::array<baker::Deformation, 2> animated, corrected;  // in the world
    baker::ArmPose alone_before[2], alone_after[2];         // each one's faults with itself
    baker::ArmPose before, after;                           // an arm's faults with the other character; ends of both
    bool is_faulty_before, is_faulty_after;                 // any part, with the other character
    bool starts_clip;
    double us;  // processor time of both responses
  };
  int frame_count() const;
  // Frames come in their order.
  Frame frame(int number);

 private:
  struct Character {
    const baker::AnimatedAsset& animated;
    baker::BoneJoints joints;
    baker::Responder responder;
    baker::ArmMeter meter;
    baker::SkinPlayer skin;
    int later;  // its first frame
    sc_transform place{};
    baker::Affine upright = baker::Affine::Identity();  // y up, z forward at first
    baker::Affine to_world;

    Character(const baker::AnimatedAsset& own, const baker::AnimatedAsset& other, Target target, int later);
    void stand(const baker::Affine& where, int frame);
    std::pair<baker::Vec3, baker::Vec3> shoulders(int frame) const;
    baker::Deformation placed(const baker::Deformation& pose) const;
  };
  // Measures both against each other.
  void measure(const std::array<baker::Deformation, 2>& poses, baker::ArmPose& arms, bool& is_faulty);

  baker::Affine second_at(double seconds) const;

  Character first_, second_;
  Stance stance_;
  double metres_;
};

}  // namespace spherechain::bench
