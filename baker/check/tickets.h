// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>
#include <string>
#include <vector>

#include "baker/bind/body_parts.h"
#include "baker/check/verdict.h"

namespace spherechain::baker {

// CharacterResult::limbs. The trunk is all parts that left and right ones hang on. A limb is all that hangs on one
// other part that hangs on the trunk: an arm, a leg, a tail, a head.
std::vector<std::string> limbs_of(const std::vector<BodyPart>& parts);

// An event's depth in percent of the height, and 20 more times the share that is inside where a part is inside another;
// a quarter of that where no eye sees it; times the root of the seconds in which it is a fault, which count from .1
// to 4.
double severity(const Event& event, double fps);

// Groups the open events that one cause probably has: in a clip the worst event, its repeats by the same two parts or
// the mirrored ones, and those of the limb that goes in that overlap with one of them for most of the shorter one's
// time; then the worst event that is left. Events of clips whose events are equal go together. `characters` has a
// result for each CheckedClip::character_key. Returns the worst first.
std::vector<Ticket> find_tickets(const std::vector<EvaluatedClip>& clips,
                                 const std::map<std::string, CharacterResult>& characters);

}  // namespace spherechain::baker
