// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "baker/volumes/volume.h"

namespace spherechain::baker {

enum class VolumeShape : std::uint8_t { kSpheres, kCones, kCapsules, kEllipsoids, kBoxes };

// A point of a body's skin, in the body's frame, that stands for some of its area.
struct BodySample {
  Vec3 point;
  double area;
};

// The skin that one body's volumes are fitted to.
struct BodySkin {
  std::vector<BodySample> samples;
  // How far volumes may reach along each of a number of directions (reach_directions): a part's skin is open where the
  // next begins, and nothing else would stop a volume there.
  std::vector<double> reach;
};
const std::vector<Vec3>& reach_directions();  // of unit length

// The main axes of some of the samples (`own`, their indices), the longest first.
Eigen::Matrix3d main_axes(const std::vector<BodySample>& samples, const std::vector<int>& own);

// Moves the surface of one volume to the samples that it stands for (`own`, their indices): least squares of their
// distances, those that stick out four times as much as those inside. Samples that it does not stand for only have to
// stay outside, and it does not reach farther than the skin allows. Starts from `start`, where there is one of that
// shape, else from the samples' axes. There is at least one sample of its own.
Volume fit_one(VolumeShape shape, const BodySkin& skin, const std::vector<int>& own,
               const std::optional<Volume>& start);

// Grows it by what leaves this share of its own samples' area inside.
Volume grown(const Volume& volume, const std::vector<BodySample>& samples, const std::vector<int>& own,
             double coverage);

}  // namespace spherechain::baker
