// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/limbed_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "baker/mesh/decompose.h"
#include "baker/mesh/surface_query.h"
#include "baker/segment/branches.h"

namespace spherechain::baker {
namespace {

// Share of the tree's longest path: shorter branches are ears, horns, toes.
constexpr double kLimbLengthMin = 0.1;
// Shares of the mesh's diameter. How far a limb's mirrored tip may be from its mate's in an uneven pose, and a tail's
// from itself; how much worse than the best a plane of symmetry may be.
constexpr double kUneven = 0.2, kAsAlike = 0.01;
// Parts of the trunk's length from which neck and tail are limbs: those of the roles of joints.
constexpr double kLongNeck = 0.75, kLongTail = 0.25;
// Cosine from which legs go on from the trunk: a biped's.
constexpr double kUpright = 0.7;
// A tube's length in its radii, at least.
constexpr double kTube = 6;

constexpr const char* kNoBranches = "the shape has no branches: arms and legs are missing";

struct Plane {
  Vec3 point, normal;
  double distance(const Vec3& p) const { return (p - point).dot(normal); }
  Vec3 mirrored(const Vec3& p) const { return p - 2 * distance(p) * normal; }
};

struct Pair {
  Index a, b;  // tips
};

struct Symmetry {
  Plane plane;
  std::vector<Pair> pairs;    // across the plane
  std::vector<Index> middle;  // tips in it
};

class Finder {
 public:
  Finder(const Mesh& mesh, const CurveSkeleton& skeleton, bool four_legs)
      : mesh_(mesh),
        tree_(find_long_branches(skeleton, kLimbLengthMin)),
        points_(skeleton.points),
        four_legs_(four_legs) {
    for (Index node = 0; node < tree_.at.size(); ++node) {
      if (tree_.is_tip(node)) tips_.push_back(node);
    }
    constexpr int kSamples = 200;
    double length = 0;
    for (const auto& branch : tree_.branches) length += branch.line.length();
    for (const auto& branch : tree_.branches) {
      for (double s = 0; s < branch.line.length(); s += length / kSamples) samples_.push_back(branch.line.at(s));
    }
    size_ = diameter(mesh);
  }

  Attempt<BodyPlan> run(const std::optional<Vec3>& facing) const {
    if (tips_.size() < 2) return Reason{kNoBranches};
    if (tips_.size() == 2 && !four_legs_) return tube(facing);
    const Symmetry symmetry = find_symmetry();
    const std::size_t pairs = symmetry.pairs.size(), mated = 2 * pairs + symmetry.middle.size();
    if (mated < tips_.size()) {
      return Reason{"the long branches do not pair left and right: of " + std::to_string(tips_.size()) + " ends " +
                    std::to_string(tips_.size() - mated) + " have no mate"};
    }
    if (pairs < 2) {
      return Reason{"arms or legs are missing: the shape has " + std::to_string(tips_.size()) + " ends, of which " +
                    std::to_string(2 * pairs) + " are limbs in pairs"};
    }
    if (four_legs_ && pairs != 2) {
      return Reason{"a quadruped has two pairs of limbs: the shape has " + std::to_string(pairs)};
    }
    return limbed(symmetry, facing);
  }

 private:
  // The curve through the tree from one node to another.
  Polyline path(Index from, Index to) const {
    std::vector<Vec3> points;
    walk(from, to, kNoIndex, points);
    return Polyline(std::move(points));
  }
  bool walk(Index node, Index to, Index barred, std::vector<Vec3>& points) const {
    if (node == to) {
      points.push_back(points_[node]);
      return true;
    }
    for (const Index b : tree_.at[node]) {
      if (b == barred) continue;
      const auto& branch = tree_.branches[b];
      const bool forward = branch.from == node;
      const std::size_t before = points.size();
      const Polyline line = forward ? branch.line : branch.line.reversed();
      points.insert(points.end(), line.points().begin(), line.points().end());
      if (walk(forward ? branch.to : branch.from, to, b, points)) return true;
      points.resize(before);
    }
    return false;
  }

  // The junctions on the way between two nodes.
  bool junctions(Index node, Index to, Index barred, std::vector<Index>& out) const {
    out.push_back(node);
    if (node == to) return true;
    for (const Index b : tree_.at[node]) {
      if (b == barred) continue;
      const auto& branch = tree_.branches[b];
      if (junctions(branch.from == node ? branch.to : branch.from, to, b, out)) return true;
    }
    out.pop_back();
    return false;
  }

  // Where a pair's ways to its tips part: the junction between them that is nearest to the plane.
  Index hub(const Pair& pair, const Plane& plane) const {
    std::vector<Index> nodes;
    junctions(pair.a, pair.b, kNoIndex, nodes);
    return *std::min_element(nodes.begin(), nodes.end(), [&](Index l, Index r) {
      return std::abs(plane.distance(points_[l])) < std::abs(plane.distance(points_[r]));
    });
  }

  // Mean distance of the mirrored skeleton from the skeleton.
  double asymmetry(const Plane& plane) const {
    double sum = 0;
    for (const Vec3& p : samples_) {
      const Vec3 mirrored = plane.mirrored(p);
      double least = std::numeric_limits<double>::max();
      for (const Vec3& q : samples_) least = std::min(least, (mirrored - q).squaredNorm());
      sum += std::sqrt(least);
    }
    return sum / static_cast<double>(samples_.size()) / size_;
  }

  // The closest tips first; a tip in the plane is its own mate.
  Symmetry pair_tips(const Plane& plane) const {
    struct Match {
      double distance;
      Index a, b;
    };
    std::vector<Match> matches;
    for (std::size_t i = 0; i < tips_.size(); ++i) {
      for (std::size_t j = i; j < tips_.size(); ++j) {
        const double distance = (plane.mirrored(points_[tips_[i]]) - points_[tips_[j]]).norm();
        if (distance < kUneven * size_) matches.push_back({distance, tips_[i], tips_[j]});
      }
    }
    std::sort(matches.begin(), matches.end(), [](const Match& l, const Match& r) { return l.distance < r.distance; });
    Symmetry symmetry{plane, {}, {}};
    std::vector<Index> taken;
    const auto free = [&](Index tip) { return std::find(taken.begin(), taken.end(), tip) == taken.end(); };
    for (const Match& match : matches) {
      if (!free(match.a) || !free(match.b)) continue;
      taken.push_back(match.a);
      if (match.a == match.b) {
        symmetry.middle.push_back(match.a);
      } else {
        taken.push_back(match.b);
        symmetry.pairs.push_back({match.a, match.b});
      }
    }
    return symmetry;
  }

  Symmetry find_symmetry() const {
    Vec3 centroid = Vec3::Zero();
    for (const Vec3& p : samples_) centroid += p / static_cast<double>(samples_.size());
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Vec3& p : samples_) covariance += (p - centroid) * (p - centroid).transpose();
    std::vector<Plane> planes;
    const PrincipalAxes axes = principal_axes(covariance);
    for (int k = 0; k < 3; ++k) planes.push_back({centroid, axes.vectors.col(k)});
    for (std::size_t i = 0; i < tips_.size(); ++i) {
      for (std::size_t j = i + 1; j < tips_.size(); ++j) {
        planes.push_back({centroid, (points_[tips_[i]] - points_[tips_[j]]).normalized()});
      }
    }
    std::vector<double> scores;
    for (const Plane& plane : planes) scores.push_back(asymmetry(plane));
    const double best = *std::min_element(scores.begin(), scores.end());
    // A flat body is as symmetric top to bottom: the plane with more pairs is the one.
    std::optional<Symmetry> chosen;
    double chosen_score = 0;
    for (std::size_t i = 0; i < planes.size(); ++i) {
      if (scores[i] > best + kAsAlike) continue;
      Symmetry symmetry = pair_tips(planes[i]);
      const std::size_t mates = symmetry.pairs.size(), most = chosen ? chosen->pairs.size() : 0;
      if (chosen && (mates < most || (mates == most && scores[i] >= chosen_score))) continue;
      chosen = std::move(symmetry);
      chosen_score = scores[i];
    }
    return *chosen;
  }

  void place(BodyFrame& frame) const {
    frame.origin = surface_centroid(mesh_);
    frame = with_up(frame, frame.up, mesh_);
  }

  // Mean distance of the outer half of a branch from the skin: a head is thick, a tail is not.
  double thickness(const SurfaceQuery& surface, const Polyline& line) const {
    constexpr int kPoints = 12;
    double sum = 0;
    for (int i = 0; i < kPoints; ++i) {
      sum += surface.closest(line.at(line.length() * (0.5 + 0.5 * i / kPoints))).distance;
    }
    return sum / kPoints;
  }

  Attempt<BodyPlan> tube(const std::optional<Vec3>& facing) const {
    const SurfaceQuery surface(mesh_);
    Polyline line = path(tips_[0], tips_[1]);
    const double radius = surface.closest(line.at(0.5 * line.length())).distance;
    if (line.length() < kTube * radius) return Reason{kNoBranches};
    const Polyline reversed = line.reversed();
    const Vec3 along = line.points().back() - line.points().front();
    if (auto reason = check_facing(facing, along, "body")) return *reason;
    const bool head_first = facing ? along.dot(*facing) < 0 : thickness(surface, reversed) > thickness(surface, line);
    if (head_first) line = reversed;
    BodyPlan plan;
    plan.facing = facing ? "the head is where the settings say" : "the head is the thicker end";
    plan.frame.up = (line.points().back() - line.points().front()).normalized();
    // Nothing tells a tube's left: the axis it bends least in.
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    const Vec3 centroid = surface_centroid(mesh_);
    for (const Vec3& p : line.points()) covariance += (p - centroid) * (p - centroid).transpose();
    const Vec3 flat = principal_axes(covariance).vectors.col(0);
    const Vec3 across = flat - flat.dot(plan.frame.up) * plan.frame.up;
    plan.frame.left = across.norm() > 0.1 ? Vec3(across.normalized()) : Vec3(plan.frame.up.unitOrthogonal());
    place(plan.frame);
    plan.limbs = {{"body", Side::kNone, 0, line, LimbEnd::kTip}};
    return plan;
  }

  struct Limbs {
    Pair pair;
    Index hub;
    Vec3 at;  // between the two, a quarter of the way out
    Polyline a, b;
  };

  Attempt<BodyPlan> limbed(const Symmetry& symmetry, const std::optional<Vec3>& facing) const {
    const SurfaceQuery surface(mesh_);
    std::vector<Limbs> pairs;
    for (const Pair& pair : symmetry.pairs) {
      Limbs limbs{pair, hub(pair, symmetry.plane), {}, {}, {}};
      limbs.a = path(limbs.hub, pair.a);
      limbs.b = path(limbs.hub, pair.b);
      limbs.at = 0.5 * (limbs.a.at(0.25 * limbs.a.length()) + limbs.b.at(0.25 * limbs.b.length()));
      pairs.push_back(std::move(limbs));
    }
    // The trunk lies between the two pairs that are farthest apart.
    Vec3 trunk = Vec3::Zero();
    for (const Limbs& l : pairs) {
      for (const Limbs& r : pairs) {
        Vec3 between = r.at - l.at;
        between -= between.dot(symmetry.plane.normal) * symmetry.plane.normal;
        if (between.norm() > trunk.norm()) trunk = between;
      }
    }
    if (!(trunk.norm() > 0)) return Reason{"the limbs leave no trunk between them"};
    trunk.normalize();
    const auto order = [&] {
      std::sort(pairs.begin(), pairs.end(),
                [&](const Limbs& l, const Limbs& r) { return l.at.dot(trunk) > r.at.dot(trunk); });
    };
    order();

    const auto reach = [](const Limbs& limbs) {
      return Vec3((limbs.a.points().back() - limbs.a.points().front()) +
                  (limbs.b.points().back() - limbs.b.points().front()));
    };
    BodyPlan plan;
    // Upright: the legs go on from the trunk, at either end of it.
    const double at_low = -reach(pairs.back()).normalized().dot(trunk);
    const double at_high = reach(pairs.front()).normalized().dot(trunk);
    const bool upright = pairs.size() == 2 && !four_legs_ && std::max(at_low, at_high) > kUpright;
    if (upright) {
      if (at_high > at_low) {
        trunk = -trunk;
        order();
      }
      const auto foot = [](const Polyline& leg) { return Vec3(leg.points().back() - leg.at(0.85 * leg.length())); };
      const Vec3 forward = facing.value_or(foot(pairs.back().a) + foot(pairs.back().b));
      plan.facing = facing ? "forward is the direction in the settings" : "forward is where the feet point";
      plan.frame.left = symmetry.plane.normal;
      const Vec3 ahead = plan.frame.left.cross(trunk);
      if (auto reason = check_facing(facing, ahead, "forward axis")) return *reason;
      if (ahead.dot(forward) < 0) plan.frame.left = -plan.frame.left;
    } else {
      if (auto reason = check_facing(facing, trunk, "trunk")) return *reason;
      if (heads_back(surface, symmetry, pairs, trunk, facing)) {
        trunk = -trunk;
        order();
      }
      plan.facing = facing ? "the head is where the settings say" : "the head is the thicker end";
      Vec3 down = Vec3::Zero();
      for (const Limbs& limbs : pairs) down += reach(limbs);
      down -= down.dot(trunk) * trunk;
      const bool other_way = trunk.cross(down).dot(symmetry.plane.normal) < 0;
      plan.frame.left = other_way ? Vec3(-symmetry.plane.normal) : symmetry.plane.normal;
    }
    plan.frame.left = lateral_axis(mesh_, plan.frame.left);
    plan.frame.up = trunk;
    place(plan.frame);

    const Index front = pairs.front().hub, rear = pairs.back().hub;
    plan.spine = front == rear ? Polyline({pairs.back().at, pairs.front().at}) : path(rear, front);
    for (std::size_t i = 0; i < pairs.size(); ++i) add_pair(plan, pairs, i, upright);
    add_middle(plan, symmetry, front, rear, (pairs.front().at - pairs.back().at).norm(), upright);
    return plan;
  }

  // Does `trunk` point away from the head?
  bool heads_back(const SurfaceQuery& surface, const Symmetry& symmetry, const std::vector<Limbs>& pairs,
                  const Vec3& trunk, const std::optional<Vec3>& facing) const {
    if (facing) return facing->dot(trunk) < 0;
    double at_front = 0, at_back = 0, feet = 0;
    const Vec3 middle = 0.5 * (pairs.front().at + pairs.back().at);
    for (const Index tip : symmetry.middle) {
      const bool front = (points_[tip] - middle).dot(trunk) > 0;
      double& end = front ? at_front : at_back;
      end = std::max(end, thickness(surface, path(front ? pairs.front().hub : pairs.back().hub, tip)));
    }
    // Without head and tail: feet point forward.
    for (const Limbs& limbs : pairs) {
      for (const Polyline* leg : {&limbs.a, &limbs.b}) {
        feet += (leg->points().back() - leg->at(0.85 * leg->length())).dot(trunk);
      }
    }
    return at_front == at_back ? feet < 0 : at_back > at_front;
  }

  void add_pair(BodyPlan& plan, const std::vector<Limbs>& pairs, std::size_t i, bool upright) const {
    const Limbs& limbs = pairs[i];
    const auto left_of = [&](const Polyline& line) {
      return (line.points().back() - plan.frame.origin).dot(plan.frame.left);
    };
    const bool a_left = left_of(limbs.a) > left_of(limbs.b);
    std::string name = "leg_" + std::to_string(i + 1);
    if (pairs.size() == 2) name = upright ? (i == 0 ? "arm" : "leg") : (i == 0 ? "foreleg" : "hindleg");
    const double along = pairs.size() == 2 ? (i == 0 ? 1.0 : 0.0)
                                           : (limbs.at - pairs.back().at).dot(plan.frame.up) /
                                                 (pairs.front().at - pairs.back().at).dot(plan.frame.up);
    plan.limbs.push_back({"left_" + name, Side::kLeft, along, a_left ? limbs.a : limbs.b, LimbEnd::kHand});
    plan.limbs.push_back({"right_" + name, Side::kRight, along, a_left ? limbs.b : limbs.a, LimbEnd::kHand});
  }

  // The longest curves on from either end of the trunk.
  void add_middle(BodyPlan& plan, const Symmetry& symmetry, Index front, Index rear, double trunk, bool upright) const {
    const Vec3 middle = plan.spine.at(0.5 * plan.spine.length());
    Polyline head, tail;
    for (const Index tip : symmetry.middle) {
      const bool ahead = (points_[tip] - middle).dot(plan.frame.up) > 0;
      Polyline line = path(ahead ? front : rear, tip);
      Polyline& longest = ahead ? head : tail;
      if (line.length() > longest.length()) longest = std::move(line);
    }
    if (head.length() > kLongNeck * trunk && !upright) {
      plan.limbs.push_back({"neck", Side::kNone, 1, head, LimbEnd::kHand});
    } else {
      plan.head = head;
    }
    if (tail.length() > kLongTail * trunk) plan.limbs.push_back({"tail", Side::kNone, 0, tail, LimbEnd::kTip});
  }

  const Mesh& mesh_;
  BranchTree tree_;
  const std::vector<Vec3>& points_;
  bool four_legs_;
  std::vector<Index> tips_;
  std::vector<Vec3> samples_;  // along the branches, evenly
  double size_;
};

}  // namespace

Attempt<BodyPlan> find_limbed_plan(const Mesh& mesh, const CurveSkeleton& skeleton, bool four_legs,
                                   const std::optional<Vec3>& facing) {
  return Finder(mesh, skeleton, four_legs).run(facing);
}

}  // namespace spherechain::baker
