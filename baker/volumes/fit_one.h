// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "volumes/volume.h"

namespace spherechain::baker {

enum class VolumeShape : std::uint8_t { kSpheres, kCones, kCapsules, kEllipsoids, kBoxes };

// A point of a body's skin, in the body's frame, that stands for some of its area.
struct BodySample {
  Vec3 point;
  double area;
};

// Moves the surface of one volume to the samples that it stands for (`own`, their indices): least squares of their
// distances, those that stick out four times as much as those inside. Samples that it does not stand for only have to
// stay outside. A round end does not begin beyond the samples, however open they are there. Starts from `start`, where
// there is one of that shape, else from the samples' axes. There is at least one sample of its own.
Volume fit_one(VolumeShape shape, const std::vector<BodySample>& samples, const std::vector<int>& own,
               const std::optional<Volume>& start);

// Grows it by what leaves this share of its own samples' area inside.
Volume grown(const Volume& volume, const std::vector<BodySample>& samples, const std::vector<int>& own,
             double coverage);

}  // namespace spherechain::baker
