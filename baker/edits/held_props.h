// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/edits/ignore_parts.h"

namespace spherechain::baker {

// Pairs of body parts that are not checked: a prop with the hand that holds it and this hand's forearm, and two props
// in one hand. A file may hang on a hand all props that the hand holds at one time or another.
PartPairs held_props(const BodyParts& parts);

}  // namespace spherechain::baker
