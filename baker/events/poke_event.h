// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/layers/poke_finder.h"

namespace spherechain::baker {

// Skin that shows through clothes: spots of one piece below one other piece at one body part, joined over frames. It is
// a warning, and never a fault.
struct PokeEvent {
  std::array<std::string, 2> pieces;   // names: the skin, and what it shows through
  std::string part;                    // the body part; empty: none is known
  double from = 0, to = 0, worst = 0;  // frames; in the worst one most of it is seen
  int place = 0;                       // of the worst one among the frames that were looked at
  double area_cm2 = 0, height_mm = 0;  // in the worst frame
  Vec3 point = Vec3::Zero();           // the middle of its largest spot there; the pose's space, source units
  Vec3 eye = Vec3::Zero();             // from there to an eye that sees it; unit length
};

// A spot in a frame of a clip. `part`: number of the body part that most of it is on.
struct FrameSpot {
  int frame;
  Index part;
  PokeSpot spot;
};

// Spots of the same pieces and part, joined over gaps of up to `gap` frames: numbers in `spots`, which are by frame.
std::vector<std::vector<std::size_t>> join_spots(const std::vector<FrameSpot>& spots, int gap);

// docs/json.md
nlohmann::ordered_json poke_json(const PokeEvent& event);

// All of an event, and back; throws nlohmann::json::exception for other JSON.
nlohmann::ordered_json stored_poke(const PokeEvent& event);
PokeEvent read_stored_poke(const nlohmann::ordered_json& json);

}  // namespace spherechain::baker
