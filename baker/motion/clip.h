// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/motion/motion.h"

namespace spherechain::baker {

// Every node's transform into the scene at a time of `clip`.
std::vector<Affine> world_at(const SourceRig& rig, const Clip& clip, double seconds);

// The rig's bones at a time of `clip`. Morphs without a channel keep their rest weight.
Deformation sample(const SourceRig& rig, const Clip& clip, double seconds);

// Frames a second that the clip was made at: the usual rate on whose frames all keys lie, 30 before others; else that
// of its densest channel. 30 where that is no rate a person would make it at.
double rate_of(const Clip& clip);

// Clips of the file's own, one after another. The rig and its clips must outlive it.
class ClipMotion : public Motion {
 public:
  ClipMotion(const SourceRig& rig, std::vector<const Clip*> clips) : rig_(rig), clips_(std::move(clips)) {}
  struct Place {
    std::size_t clip;  // its number
    double seconds;    // from its start
  };
  Place place(double t) const;
  double start(std::size_t clip) const;  // of a clip, in the motion's seconds

  Deformation at(double t) const override;
  double duration() const override { return start(clips_.size()); }

 private:
  const SourceRig& rig_;
  std::vector<const Clip*> clips_;
};

}  // namespace spherechain::baker
