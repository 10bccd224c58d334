// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "baker/os/atomic_file.h"
#include "baker/play/play.h"
#include "baker/play/player.h"
#include "baker/report/part_contacts.h"

namespace spherechain::baker {

nlohmann::ordered_json pairs_json(Span<const Pair> pairs);

// One entry of `play --json`'s `frames`; `player` has just run it.
nlohmann::ordered_json frame_json(const AnimatedAsset& animated, int index, const FrameResult& result,
                                  const Player& player);

// Its skin contacts, with the triangles where `list_triangles` is true.
nlohmann::ordered_json skin_json(const Player& player, const Player::TriangleDetection& skin,
                                 const PartContacts& contacts, const PartCounts& counts, bool list_triangles);

// A frame's `penetrations`, deepest first.
nlohmann::ordered_json penetrations_json(const AnimatedAsset& animated, const std::vector<Penetration>& penetrations,
                                         const PartContacts& contacts);

// Writer of `play --json`: the keys of `head`, then `frames`, then the keys of `tail`. Writes frame by frame, because
// all frames may not fit in memory.
class PlayFile {
 public:
  // The file is there after finish(), which comes after the last of `frames` frames, at least one. Throws Error(kFile),
  // as the others do.
  PlayFile(const std::filesystem::path& path, const nlohmann::ordered_json& head, int frames);
  void add(const nlohmann::ordered_json& frame);
  void finish(const nlohmann::ordered_json& tail);

 private:
  AtomicFile file_;
  int left_;
};

}  // namespace spherechain::baker
