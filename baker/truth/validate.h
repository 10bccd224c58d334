// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "play/play.h"
#include "play/player.h"
#include "truth/contacts.h"
#include "truth/curve.h"
#include "truth/groups.h"

namespace spherechain::baker {

// A reported pair counts as right where the regions are nearer than this; body parts are far, and skins apart, where at
// rest they are not. A fraction of the height.
inline constexpr double kCloseSurface = 0.003;

struct ValidateSettings {
  Radius radius = SC_RADIUS_DETECT;
  Method method = Method::kAllPairs;
  Target target = SC_TARGET_SCALAR;
  bool contacts = false;        // the narrow phase too
  bool skin = true;             // report the pairs whose skins intersect; else those of spheres that touch
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

// A ragdoll of capsules of this quantile (truth/capsules.h): on the truth of the spheres, and on its own, which has
// nothing within one capsule or between ignored ones.
struct CapsulePoint {
  double quantile;
  Score score, own;
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
  Score skin;               // of the pairs of spheres whose skins intersect
  Score chains, all_pairs;  // of the pairs of spheres that touch
  std::vector<CurvePoint> curve;
  std::size_t capsules = 0;  // of the ragdoll; 0 where no bones move the source
  std::vector<CapsulePoint> capsule_curve;
  std::vector<PairGroup> by_region, by_chain;  // regions without any pair are left out
};

// The same whatever the number of threads. `progress` gets the number of finished frames, one call at a time. Throws
// Error(kFile) where the asset has no clusters.
Validation validate(const AnimatedAsset& animated, const ValidateSettings& settings,
                    const std::function<void(int)>& progress);

}  // namespace spherechain::baker
