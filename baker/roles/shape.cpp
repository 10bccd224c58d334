// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/shape.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "baker/roles/limb_path.h"

namespace spherechain::baker {
namespace {

// Fractions of the rig's size.
constexpr double kApart = 0.05;      // a pair's tips, at least
constexpr double kAsymmetry = 0.06;  // mean distance of the mirrored nodes from nodes, at most
constexpr double kInPlane = 0.03;    // mean distance of what is in the middle

constexpr double kAlike = 0.15;      // difference of a pair's lengths
constexpr double kOneSided = 0.7;    // share of a limb's distance from the plane that is on one side
constexpr double kLong = 0.3;        // of the longest limb: shorter pairs are ears, eyes, breasts
constexpr double kPointsAway = 0.5;  // cosine from which legs point away from the arms

// No character's rig has more; the search would take long.
constexpr std::size_t kNodesMax = 600;
constexpr std::size_t kChildrenMax = 40;

struct Plane {
  Vec3 point, normal;
  double distance(const Vec3& p) const { return (p - point).dot(normal); }
  Vec3 mirror(const Vec3& p) const { return p - 2 * distance(p) * normal; }
};

double asymmetry(const std::vector<Vec3>& positions, const Plane& plane, double worst) {
  double sum = 0;
  for (const Vec3& position : positions) {
    const Vec3 image = plane.mirror(position);
    double nearest = worst;
    for (const Vec3& other : positions) nearest = std::min(nearest, (other - image).norm());
    sum += nearest;
  }
  return sum / static_cast<double>(positions.size());
}

// Among the planes that mirror a child of a node to another one: the one that fits all nodes best.
std::optional<Plane> find_symmetry(const Skeleton& s) {
  std::optional<Plane> best;
  double least = kAsymmetry * s.size;
  std::vector<Vec3> positions;  // of what is alive
  for (int n = 0; n < s.count(); ++n) {
    if (s.alive[n]) positions.push_back(s.position[n]);
  }
  if (positions.size() > kNodesMax) return best;
  for (int n = 0; n < s.count(); ++n) {
    if (s.children[n].size() > kChildrenMax) continue;
    for (const int a : s.children[n]) {
      for (const int b : s.children[n]) {
        if (a >= b || !s.alive[a] || !s.alive[b]) continue;
        const double la = s.reach[a] + s.bone(a), lb = s.reach[b] + s.bone(b);
        const Vec3 across = s.tip[a] - s.tip[b];
        if (std::abs(la - lb) > kAlike * std::max(la, lb) || across.norm() < kApart * s.size) continue;
        const Plane plane{0.5 * (s.tip[a] + s.tip[b]), across.normalized()};
        const double error = asymmetry(positions, plane, 4 * kAsymmetry * s.size);
        if (error >= least) continue;
        least = error;
        best = plane;
      }
    }
  }
  return best;
}

struct Pair {
  std::vector<int> tops;
  Vec3 start = Vec3::Zero();  // mean of where they leave the trunk
  Vec3 along = Vec3::Zero();  // mean way from there to the tips, as a part of their length
  double depth = 0;
};

void add_limb(const Skeleton& s, int top, Family family, std::vector<Hint>& hints) {
  const bool arm = family == Family::kArm;
  const auto set = [&](int node, Word word) {
    hints[node].word = word;
    hints[node].reason = kByShape;
  };
  const std::vector<int> nodes = main_path(s, hints, top, family);
  std::vector<double> lengths;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) lengths.push_back(s.bone(nodes[i + 1]));
  const std::size_t upper = find_long_bones(lengths);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (i < upper) set(nodes[i], arm ? Word::kClavicle : Word::kHipGirdle);
    if (i == upper) set(nodes[i], arm ? Word::kUpperArm : Word::kThigh);
    if (i == upper + 1) set(nodes[i], arm ? Word::kForeArm : Word::kShin);
    if (i == upper + 2) set(nodes[i], arm ? Word::kHand : Word::kFoot);
    if (i > upper + 2) set(nodes[i], arm ? Word::kFinger : Word::kToe);
  }
  if (upper + 2 >= nodes.size()) return;
  const std::vector<int> in_hand = s.inherited([&](int n) { return n == nodes[upper + 2] ? 1 : -1; });
  for (int n = nodes[upper + 2] + 1; n < s.count(); ++n) {
    if (in_hand[n] > 0) set(n, arm ? Word::kFinger : Word::kToe);
  }
}

}  // namespace

std::vector<Hint> hints_from_shape(const Skeleton& s) {
  std::vector<Hint> hints(s.parent.size());
  const std::optional<Plane> plane = find_symmetry(s);
  if (!plane) return hints;

  // Signed and absolute distances from the plane, each summed over a node and all nodes under it.
  std::vector<double> sum(hints.size(), 0), sum_abs(hints.size(), 0), count(hints.size(), 0);
  std::vector<bool> lateral(hints.size(), false);
  for (int n = s.count(); n-- > 0;) {
    if (!s.alive[n]) continue;
    const double d = plane->distance(s.position[n]);
    sum[n] += d;
    sum_abs[n] += std::abs(d);
    count[n] += 1;
    lateral[n] = sum_abs[n] > kInPlane * s.size * count[n] && std::abs(sum[n]) > kOneSided * sum_abs[n];
    if (const int p = s.parent[n]; p >= 0) {
      sum[p] += sum[n];
      sum_abs[p] += sum_abs[n];
      count[p] += count[n];
    }
  }
  const std::vector<int> is_off_middle = s.inherited([&](int n) { return lateral[n] ? 1 : -1; });
  std::vector<int> tops;
  double longest = 0;
  const auto length = [&](int n) { return s.reach[n] + s.bone(n); };
  for (int n = 0; n < s.count(); ++n) {
    if (!lateral[n] || (s.parent[n] >= 0 && is_off_middle[s.parent[n]] > 0)) continue;
    tops.push_back(n);
    longest = std::max(longest, length(n));
  }
  std::vector<Pair> pairs;
  std::vector<bool> taken(hints.size(), false);
  for (const int a : tops) {
    if (taken[a]) continue;
    int partner = -1;
    for (const int b : tops) {
      if (b == a || taken[b] || sum[a] * sum[b] > 0) continue;
      const auto apart = [&](int n) { return (s.tip[n] - plane->mirror(s.tip[a])).norm(); };
      if (partner < 0 || apart(b) < apart(partner)) partner = b;
    }
    if (partner < 0 || length(a) < kLong * longest) {
      hints[a].word = Word::kHeadPart;
      hints[a].reason = "small and off the middle";
      continue;
    }
    Pair pair;
    for (const int n : {a, partner}) {
      taken[n] = true;
      pair.tops.push_back(n);
      pair.start += 0.5 * s.position[n];
      pair.along += 0.5 * (s.tip[n] - s.position[n]) / std::max(length(n), 1e-12);
      pair.depth += s.depth[n];
    }
    pairs.push_back(pair);
  }
  int arms = -1;
  if (pairs.size() == 2) {
    const Vec3 between = (pairs[1].start - pairs[0].start).normalized();
    const double away[2] = {-pairs[0].along.dot(between), pairs[1].along.dot(between)};
    const int legs = away[0] > away[1] ? 0 : 1;
    const bool upright = away[legs] > kPointsAway;
    arms = upright ? 1 - legs : (pairs[0].depth > pairs[1].depth ? 0 : 1);
  }
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Family family = static_cast<int>(p) == arms ? Family::kArm : Family::kLeg;
    for (const int top : pairs[p].tops) add_limb(s, top, family, hints);
  }
  return hints;
}

}  // namespace spherechain::baker
