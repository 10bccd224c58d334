// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "baker/motion/capture.h"

namespace spherechain::baker {

// A recording on a character's own skeleton: as a clip of the character's nodes, and from these back to the
// recording's.
class CarriedMotion : public Motion {
 public:
  virtual const Capture& capture() const = 0;
  int frame_count() const override { return duration() > 0 ? 0 : 1; }  // of one pose

  // The motion of the character's nodes, with keys at the recording's frames. Paths that keep their rest value have no
  // channel. Throws Error(kFile) if bones are sheared: rotations and translations cannot express that.
  virtual Clip clip() const = 0;

  // The character's nodes whose turns the recording can take over.
  virtual std::vector<Index> recorded_nodes() const = 0;

  // The rotations of the recording's nodes, each in its parent's space, at which the character's nodes are turned as
  // in `world` (world_at). A node of the recording that no node of the character follows keeps the rotation that it has
  // in its parent's space.
  virtual std::vector<Eigen::Quaterniond> recorded_rotations(double seconds,
                                                             const std::vector<Affine>& world) const = 0;
};

// Plays `file` on a character with a skin of its own, whose `rig` must outlive it. Where its skeleton is the skin's
// own, nodes are matched by name, else by role. Throws Error(kFile) as read_capture, body_of and CaptureMotion do.
std::unique_ptr<CarriedMotion> carried_motion(const std::filesystem::path& file, const SourceRig& rig,
                                              const std::vector<Vec3>& rest, const BodyFrame& frame,
                                              const std::string& character);

}  // namespace spherechain::baker
