// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "baker/events/poke_event.h"
#include "baker/page/clip_page.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Looks for skin that shows through clothes in the frames of one character's clips.
class PokeWatch {
 public:
  // `animated` must outlive it; `source` is its character's file. A character of one primitive costs nothing. Without
  // the source as a glTF it finds nothing.
  PokeWatch(const AnimatedAsset& animated, const std::filesystem::path& source);
  ~PokeWatch();

  // Looks at a frame of `clip`, or leaves it out: it looks at five frames a second. Frames come in their order.
  void look(const ClipFrames& clip, int frame, const Deformation& pose);

  struct Found {
    std::vector<PokeEvent> events;  // the largest first
    std::vector<PagePoke> shown;    // of each event
  };
  // The events of the frames since the last call.
  Found take(const ClipFrames& clip);

 private:
  struct Layers;

  const AnimatedAsset& animated_;
  std::unique_ptr<Layers> layers_;  // null: no skin can show through
  BodyParts parts_;
  std::vector<FrameSpot> spots_;
};

}  // namespace spherechain::baker
