// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "baker/play/play.h"
#include "baker/play/player.h"
#include "baker/truth/contacts.h"
#include "baker/truth/far_parts.h"
#include "baker/truth/groups.h"
#include "baker/truth/score.h"

namespace spherechain::baker {

// A reported pair counts as right where the regions are nearer than this; body parts are far, and skins apart, where at
// rest they are not. A fraction of the height.
inline constexpr double kCloseSurface = 0.003;

struct ValidateSettings {
  Radius radius = SC_RADIUS_DETECT;
  Target target = SC_TARGET_SCALAR;
  bool contacts = false;        // the narrow phase too
  bool skin = true;             // report spheres whose skins intersect; else spheres that touch
  std::filesystem::path cache;  // see truth_cache.h; empty: none
};

// A contact that was not reported.
struct Miss {
  int frame;
  Pair spheres;
  std::size_t triangle_pairs;
  // Depth of the two body parts if no report names them: a fault that is missed entirely. Else 0, as for pairs that are
  // no fault. Mesh units.
  double depth;
};

// The runtime's pairs against the truth, over all frames of a motion. `score`, `misses` and the groups are of the pairs
// reported: those whose skins intersect, or those of the method asked for.
struct Validation {
  std::size_t raw_pairs = 0, rest = 0, same_sphere = 0, ignored = 0, degenerate = 0;  // see FrameTruth
  Score score;
  std::vector<Miss> misses;  // the deepest first
  // The narrow phase's errors: from vertices; and from matrices alone in the frames that bones move, none where no
  // frame is.
  ContactErrors contacts, neighbour_contacts;
  std::optional<ContactErrors> contacts_from_bones, neighbour_contacts_from_bones;
  Score skin;                        // of the pairs of spheres whose skins intersect
  Score all_pairs;                   // of the pairs of spheres that touch
  std::vector<PairGroup> by_region;  // regions without any pair are left out
};

// A frame that is being validated, for what measures more of it.
struct ValidatedFrame {
  int index;
  const TruthSurface& surface;
  const FarParts& is_far;
  const std::vector<Pair>& rest_pairs;  // triangles that intersect at rest
  const Deformation& deformation;
  const std::vector<float>& positions;
  const Intersections& found;
  const FrameTruth& truth;
  const std::vector<Sphere>& spheres;  // refitted
  const std::vector<Pair>& touching;   // spheres
  const std::vector<Pair>& reported;
  const std::function<bool(const Pair&)>&is_close, &is_apart;  // see score_frame()
};

// The result is the same whatever the number of threads. `progress` gets the number of frames that are done, one call
// at a time; `observe` gets each frame, from several threads at once. Throws Error(kFile) if the asset has no clusters.
Validation validate(const AnimatedAsset& animated, const ValidateSettings& settings,
                    const std::function<void(int)>& progress,
                    const std::function<void(const ValidatedFrame&)>& observe = {});

}  // namespace spherechain::baker
