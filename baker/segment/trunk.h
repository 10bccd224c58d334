// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "segment/segment.h"

namespace spherechain::baker {

// The middle of the starts of the limbs with sides at one end of the trunk; `otherwise` where there are none.
Vec3 middle_of_starts(const Regions& regions, double along, const Vec3& otherwise);

// More than two pairs of legs: each leaves the trunk where its two starts are on average, between those ends.
void place_along(Regions& regions, const Vec3& hip, const Vec3& chest);

// The middle of the trunk's own skin at a point's height: legs leave a quadruped's trunk at its belly.
Vec3 middle_of_trunk(const SurfaceQuery& trunk, const BodyFrame& frame, Vec3 point);

// Where the trunk ends by its own skin, and the neck begins: at `neck`, its upper end where there is none.
TorsoEnds ends_by_skin(const Mesh& mesh, const Regions& regions, const Vec3* neck);

}  // namespace spherechain::baker
