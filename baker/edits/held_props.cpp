// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/edits/held_props.h"

namespace spherechain::baker {
namespace {

bool is_forearm(const BodyPart& part) { return part.name.ends_with("forearm"); }
bool holds(const BodyPart& part) { return !part.is_prop && (part.name.ends_with("hand") || is_forearm(part)); }

}  // namespace

PartPairs held_props(const BodyParts& parts) {
  const std::vector<BodyPart>& all = parts.parts;
  const auto at = [&](int part) -> const BodyPart& { return all[static_cast<std::size_t>(part)]; };
  // Hand and forearm are one place: the forearm, or the hand of a rig without forearms.
  const auto place_of = [&](int part) {
    const int above = at(part).parent;
    return above >= 0 && is_forearm(at(above)) ? above : part;
  };
  const auto held_at = [&](const BodyPart& part) {
    const bool is_held = part.is_prop && part.parent >= 0 && holds(at(part.parent));
    return is_held ? place_of(part.parent) : -1;
  };
  PartPairs out;
  for (std::size_t p = 0; p < all.size(); ++p) {
    const int place = held_at(all[p]);
    for (std::size_t q = 0; q < all.size() && place >= 0; ++q) {
      const bool is_arm = holds(all[q]) && place_of(static_cast<int>(q)) == place;
      if (is_arm || (q > p && held_at(all[q]) == place)) out.push_back({all[p].name, all[q].name});
    }
  }
  return out;
}

}  // namespace spherechain::baker
