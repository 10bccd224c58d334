// SPDX-License-Identifier: GPL-3.0-or-later
// Two animated characters that stand or walk near each other, and the response keeps the arms of each out of the other.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "baker/play/responder.h"

namespace spherechain::bench {

// How the second stands to the first. Both are scaled to 1.75 m.
enum class Stance {
  kFacing,   // before it, and looks at it
  kBeside,   // at its left
  kPassing,  // at its left and looks the other way, half-way through the motion
};

// Which pose of the second the first one stays out of. The second always stays out of the first as corrected.
enum class Seen {
  kLastFrame,  // as corrected in the last frame
  kAnimated,   // as animated in this frame
  kEach,       // as kAnimated, and the second stays out of the first as animated, too
};

class TwoCharacters {
 public:
  // `metres`: between the middles of their shoulders. Both animations must outlive it.
  TwoCharacters(const baker::AnimatedAsset& first, const baker::AnimatedAsset& second, Target target, Stance stance,
                double metres, Seen seen);

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
    Body looker;  // as animated
    int later;    // its first frame
    sc_transform place{};
    baker::Affine to_world;

    Character(const baker::AnimatedAsset& own, const baker::AnimatedAsset& other, Target target, int later);
    void stand(const baker::Affine& where, int frame);
    baker::Vec3 shoulder(const baker::Deformation& pose, std::string_view name) const;
    baker::Deformation placed(const baker::Deformation& pose) const;
  };
  // Measures both against each other.
  void measure(const std::array<baker::Deformation, 2>& poses, baker::ArmPose& arms, bool& is_faulty);

  Character first_, second_;
  Seen seen_;
};

}  // namespace spherechain::bench
