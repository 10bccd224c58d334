// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/segment/segment.h"

namespace spherechain::baker {

// The middle of the starts of the left and right limbs at one end of the trunk; `otherwise` where there are none.
Vec3 middle_of_starts(const Regions& regions, double along, const Vec3& otherwise);

// Sets Limb::along of the left and right limbs where there are more than two pairs: the mean of a pair's two starts,
// projected on the line from hip to chest.
void place_along(Regions& regions, const Vec3& hip, const Vec3& chest);

// The middle of the trunk's own skin at a point's height. A quadruped's legs leave its trunk at the belly, below it.
Vec3 middle_of_trunk(const SurfaceQuery& trunk, const BodyFrame& frame, Vec3 point);

// The heights of the trunk's lower end, by its skin, and of the neck's base: that of `neck`, or the trunk's upper end
// where `neck` is null.
TorsoEnds ends_by_skin(const Mesh& mesh, const Regions& regions, const Vec3* neck);

}  // namespace spherechain::baker
