// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "play/play.h"
#include "play/player.h"
#include "write/atomic_file.h"

namespace spherechain::baker {

nlohmann::ordered_json pairs_json(Span<const Pair> pairs);

// One entry of `play --json`'s `frames`; `player` has just run it.
nlohmann::ordered_json frame_json(const AnimatedAsset& animated, int index, const FrameResult& result,
                                  const Player& player);

// What `play --json` writes, `head`'s keys and then `frames`: frame by frame, for all of them may not fit in memory.
class PlayFile {
 public:
  // Nothing is there before the last of `frames` frames, at least one, is added. Throws Error(kFile), as add does.
  PlayFile(const std::filesystem::path& path, const nlohmann::ordered_json& head, int frames);
  void add(const nlohmann::ordered_json& frame);

 private:
  AtomicFile file_;
  int left_;
};

}  // namespace spherechain::baker
