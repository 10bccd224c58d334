// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "play/play.h"
#include "play/player.h"

namespace spherechain::baker {

nlohmann::ordered_json pairs_json(Span<const Pair> pairs);

// One entry of `play --json`'s `frames`; `player` has just run it.
nlohmann::ordered_json frame_json(const AnimatedAsset& animated, int index, const FrameResult& result,
                                  const Player& player);

}  // namespace spherechain::baker
