// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <limits>

#include "baker/mesh/surface_query.h"
#include "baker/rig/rig.h"

namespace spherechain::baker {
namespace {

// Segment proportions of men after de Leva 1996 (Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters):
// between joint centres, as fractions of the distance named.
constexpr double kElbow = 0.512;     // shoulder to wrist
constexpr double kKnee = 0.493;      // hip to ankle
constexpr double kOmphalion = 0.24;  // middle of the hips to the base of the neck: where the lumbar spine bends
constexpr double kXiphion = 0.60;    // and where the rib cage begins

// A neck is narrowest between its two joints.
constexpr double kNape = 0.85;  // from the chest junction to the narrowest neck: the seventh vertebra
constexpr double kSkull =
    0.28;  // from the base of the neck to the crown: as low as the jaw, so that the skull stays in one piece
constexpr double kClavicle = 0.60;  // from the chest junction to the narrowest neck: the sternum's upper end

// Fractions of the height.
constexpr double kShoulderInside = 0.032;  // the joint is deeper than the armpit's plane, on the arm's axis
constexpr double kHipInside = 0.028;       // and deeper than the crotch's plane, on the thigh's axis
constexpr double kAnkleBelow = 0.025;      // a leg is narrowest above its malleoli, at 0.07; the joint is at 0.04
constexpr double kSternum = 0.015;         // half the distance between the clavicles' inner ends

// How much a centre line has to bend to overrule the proportions: squared deviation against squared shift, both as
// fractions of the chord.
constexpr double kBendTrust = 0.02;

double squared_distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (a + t * ab - p).squaredNorm();
}

// The middle joint of a limb: where two straight bones follow the line best, near the usual proportion.
Vec3 middle_joint(const Polyline& line, double usual) {
  constexpr int kSteps = 200;
  const Vec3 &root = line.points().front(), &end = line.points().back();
  const double length = line.length();
  double best_cost = std::numeric_limits<double>::max();
  Vec3 best = line.at(usual * length);
  for (int i = kSteps / 4; i <= 3 * kSteps / 4; ++i) {
    const double fraction = static_cast<double>(i) / kSteps;
    const Vec3 joint = line.at(fraction * length);
    double deviation = 0;
    for (int k = 0; k <= kSteps; ++k) {
      const Vec3 p = line.at(length * k / kSteps);
      deviation += k < i ? squared_distance_to_segment(p, root, joint) : squared_distance_to_segment(p, joint, end);
    }
    const double shift = fraction - usual;
    const double cost = deviation / (kSteps + 1) / (length * length) + kBendTrust * shift * shift;
    if (cost < best_cost) {
      best_cost = cost;
      best = joint;
    }
  }
  return best;
}

struct LimbJoints {
  Vec3 root, middle, end, tip;
};

// `from` .. `to`: the stretch that gives the upper bone's axis; `inside`: how far before the line's start the joint is;
// `beyond`: how far the last joint is past the narrowest section, straight on.
LimbJoints limb_joints(const Limb& limb, double from, double to, double inside, double beyond, double usual) {
  const Vec3 axis = (limb.line.at(to) - limb.line.at(from)).normalized();
  LimbJoints joints;
  joints.root = limb.line.at(from) - (from + inside) * axis;
  const Vec3 narrowest = limb.line.at(limb.extremity);
  const Polyline outside = limb.line.part(from, limb.extremity);
  joints.end = narrowest + beyond * (narrowest - limb.line.at(limb.extremity - (to - from))).normalized();
  std::vector<Vec3> points{joints.root};
  points.insert(points.end(), outside.points().begin(), outside.points().end());
  points.push_back(joints.end);
  joints.middle = middle_joint(Polyline(std::move(points)), usual);
  joints.tip = limb.line.points().back();
  return joints;
}

}  // namespace

std::vector<Joint> place_joints(const Regions& regions) {
  const BodyFrame& frame = regions.frame;
  const double h = frame.height;
  std::array<LimbJoints, 4> limbs;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const Limb& limb = regions.limbs[i];
    limbs[i] = limb.along > 0.5 ? limb_joints(limb, 0.02 * h, 0.08 * h, kShoulderInside * h, 0, kElbow)
                                : limb_joints(limb, 0.04 * h, 0.16 * h, kHipInside * h, kAnkleBelow * h, kKnee);
  }

  // Three sure points say where the spine runs; the skeleton's curve between them is noise from the torso's shape.
  const auto in_plane = [&](const Vec3& p) { return Vec3(p - (p - frame.origin).dot(frame.left) * frame.left); };
  const Vec3 pelvis = in_plane(0.5 * (limbs[2].root + limbs[3].root));
  const Vec3 throat = in_plane(regions.spine.at(regions.spine_neck));
  const Polyline back({pelvis, in_plane(regions.chest), throat});
  const double chest = back.length() - (throat - in_plane(regions.chest)).norm();
  const auto above_chest = [&](double fraction) { return back.at(chest + fraction * (back.length() - chest)); };
  const Vec3 neck = above_chest(kNape), sternum = above_chest(kClavicle);
  const double nape = chest + kNape * (back.length() - chest);
  const Vec3 spine = back.at(kOmphalion * nape), rib_cage = back.at(kXiphion * nape);
  // From above: inside, the mouth would be in the way. The skeleton's own end wanders to the face.
  const auto top = SurfaceQuery(regions.body.mesh).first_hit(throat + 2 * h * frame.up, -frame.up);
  const Vec3 crown = top ? top->point : Vec3(throat + 0.15 * h * frame.up);
  const Vec3 head = throat + kSkull * (crown - throat);

  std::vector<Joint> joints{{"pelvis", -1, pelvis, spine},
                            {"spine", 0, spine, rib_cage},
                            {"chest", 1, rib_cage, neck},
                            {"neck", 2, neck, head},
                            {"head", 3, head, crown}};
  const auto chain = [&](const std::string& side, int parent, const LimbJoints& limb,
                         std::array<const char*, 3> names) {
    const auto first = static_cast<int>(joints.size());
    joints.push_back({side + names[0], parent, limb.root, limb.middle});
    joints.push_back({side + names[1], first, limb.middle, limb.end});
    joints.push_back({side + names[2], first + 1, limb.end, limb.tip});
  };
  for (const std::size_t i : {0U, 1U}) {
    const std::string side = i == 0 ? "left_" : "right_";
    const Vec3 inner = sternum + (i == 0 ? kSternum : -kSternum) * h * frame.left;
    joints.push_back({side + "clavicle", 2, inner, limbs[i].root});
    chain(side, static_cast<int>(joints.size()) - 1, limbs[i], {"shoulder", "elbow", "wrist"});
  }
  for (const std::size_t i : {2U, 3U}) chain(i == 2 ? "left_" : "right_", 0, limbs[i], {"hip", "knee", "ankle"});
  for (Joint& joint : joints) {
    for (Vec3* p : {&joint.position, &joint.tail}) *p = p->cast<float>().cast<double>();
  }
  return joints;
}

}  // namespace spherechain::baker
