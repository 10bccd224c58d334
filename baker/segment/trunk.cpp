// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/trunk.h"

#include <algorithm>
#include <limits>

#include "baker/mesh/ring.h"

namespace spherechain::baker {

Vec3 middle_of_starts(const Regions& regions, double along, const Vec3& otherwise) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const Limb& limb : regions.limbs) {
    if (limb.side == Side::kNone || limb.along != along) continue;
    sum += limb.line.at(0);
    ++count;
  }
  return count > 0 ? Vec3(sum / count) : otherwise;
}

void place_along(Regions& regions, const Vec3& hip, const Vec3& chest) {
  const Vec3 trunk = chest - hip;
  const auto number = [](const std::string& name) { return name.substr(name.rfind('_')); };
  for (Limb& limb : regions.limbs) {
    if (limb.side == Side::kNone) continue;
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (const Limb& other : regions.limbs) {
      if (other.side == Side::kNone || number(other.name) != number(limb.name)) continue;
      sum += other.line.at(0);
      ++count;
    }
    limb.along = std::clamp((sum / count - hip).dot(trunk) / trunk.squaredNorm(), 0.0, 1.0);
  }
}

Vec3 middle_of_trunk(const SurfaceQuery& trunk, const BodyFrame& frame, Vec3 point) {
  constexpr int kRays = 80, kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    point = cast_ring(trunk, point, frame.up, frame.left, kRays).section_centroid();
    point -= (point - frame.origin).dot(frame.left) * frame.left;
  }
  return point;
}

TorsoEnds ends_by_skin(const Mesh& mesh, const Regions& regions, const Vec3* neck) {
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  const auto height = [&](const Vec3& p) { return (p - regions.frame.origin).dot(regions.frame.up); };
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (regions.of_triangle[t] != regions.torso_region()) continue;
    const double h = height(triangle_centroid(mesh, t));
    low = std::min(low, h);
    high = std::max(high, h);
  }
  return {low, neck != nullptr ? std::clamp(height(*neck), low, high) : high};
}

}  // namespace spherechain::baker
