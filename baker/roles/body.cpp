// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/body.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace spherechain::baker {
namespace {

// Cosines: legs that point away from the trunk within 45 degrees are a biped's, otherwise forelegs that reach as far
// down as this part of the hind legs stand on the ground.
constexpr double kUpright = 0.7;
constexpr double kStands = 0.6;

struct BodyFinder : Body {
  const Skeleton& s;
  const std::vector<Hint>& hints;
  BodyKind wanted;
  Vec3 up = Vec3::Zero(), forward = Vec3::Zero();
  std::string facing;  // why forward is where it is; empty where that is a guess

  BodyFinder(const Skeleton& skeleton, const std::vector<Hint>& names, BodyKind kind_wanted)
      : s(skeleton), hints(names), wanted(kind_wanted) {
    paths = find_limb_paths(s, hints);
    path_of = s.inherited([&](int n) {
      for (std::size_t i = 0; i < paths.size(); ++i) {
        const std::vector<int>& roots = paths[i].roots;
        if (std::find(roots.begin(), roots.end(), n) != roots.end()) return static_cast<int>(i);
      }
      return -1;
    });
    group_limbs();
    if (paths.empty()) {
      find_single_chain();
    } else {
      find_trunk();
    }
    find_axes();
    settle_sides();
    upper = in_order(upper);
    lower = in_order(lower);
  }

  bool in_limb(int node) const { return path_of[node] >= 0; }
  const Vec3& start(int limb) const {
    const LimbPath& path = paths[limb];
    return s.position[path.nodes[std::max(0, path.first(kUpper))]];
  }
  // The last joint before hand or foot; where the chain ends sooner, what hangs on its end.
  Vec3 end(int limb) const {
    const LimbPath& path = paths[limb];
    const int wrist = path.first(kExtremity);
    return wrist >= 0 ? s.position[path.nodes[wrist]] : s.skin[path.nodes.back()];
  }
  template <typename Get>
  Vec3 mean(const std::vector<int>& group, const Get& get) const {
    Vec3 sum = Vec3::Zero();
    for (const int limb : group) sum += get(limb);
    return group.empty() ? sum : Vec3(sum / static_cast<double>(group.size()));
  }
  Vec3 direction(const std::vector<int>& group) const {
    return mean(group, [&](int i) { return Vec3(end(i) - start(i)); });
  }
  int attach_point(const std::vector<int>& group) const {
    int node = -1;
    bool first = true;
    for (const int limb : group) {
      const int parent = s.parent[paths[limb].roots.front()];
      node = first ? parent : (node < 0 || parent < 0 ? -1 : s.common_ancestor(node, parent));
      first = false;
    }
    return node;
  }
  int find_named(Word word) const { return find_in_middle(s, hints, path_of, word); }

  void group_limbs() {
    std::vector<int> arms, legs;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      (paths[i].family == Family::kArm ? arms : legs).push_back(static_cast<int>(i));
    }
    upper = arms;
    lower = legs;
    if (!arms.empty() || legs.size() != 4) return;
    // Four legs: those in front are named so, or nearer to the head, or farther from the root.
    const int named_head = find_named(Word::kHead) >= 0 ? find_named(Word::kHead) : find_named(Word::kNeck);
    const auto key = [&](int limb) {
      const int parent = s.parent[paths[limb].roots.front()];
      const int place = paths[limb].place == Place::kFront ? 0 : (paths[limb].place == Place::kHind ? 2 : 1);
      const bool measured = named_head >= 0 && parent >= 0;
      return std::tuple(place, measured ? s.length(s.path(parent, named_head)) : 0.0,
                        measured ? (start(limb) - s.position[named_head]).norm() : -s.depth[paths[limb].nodes[0]]);
    };
    std::stable_sort(legs.begin(), legs.end(), [&](int l, int r) { return key(l) < key(r); });
    upper = {legs[0], legs[1]};
    lower = {legs[2], legs[3]};
  }

  void find_trunk() {
    const std::vector<int>& low = lower.empty() ? upper : lower;
    pelvis = attach_point(low);
    chest = lower.empty() || upper.empty() ? -1 : attach_point(upper);
    const std::vector<bool> over_chest = at_or_above(s, chest);
    for (int n = pelvis; n >= 0; n = s.parent[n]) {
      if (hints[n].word != Word::kPelvis || (chest >= 0 && !over_chest[n])) continue;
      pelvis = n;
      break;
    }
    if (const int given = find_named(Word::kPelvis); given >= 0 && (hints[given].given || pelvis < 0)) pelvis = given;
    head = find_named(Word::kHead);
    const auto above_trunk = [&](int n) { return hints[n].word == Word::kNeck || hints[n].word == Word::kHead; };
    if (chest < 0 && pelvis >= 0) {
      chest = pelvis;
      const int top = head >= 0 ? head : find_named(Word::kNeck);
      if (top >= 0 && !lower.empty()) {
        for (const int n : s.path(pelvis, top)) {
          if (above_trunk(n)) break;
          chest = n;
        }
      }
    }
    while (chest >= 0 && chest != pelvis && above_trunk(chest) && s.parent[chest] >= 0) chest = s.parent[chest];
    if (const int given = find_named(Word::kChest); given >= 0 && hints[given].given) chest = given;
    if (pelvis < 0 || chest < 0) return;
    for (const int n : s.path(pelvis, chest)) {
      if (n == pelvis || n == chest || s.weight[n] > 0 || hints[n].word != Word::kRoot) trunk.push_back(n);
    }
    find_neck();
  }

  void find_neck() {
    std::vector<bool> in_trunk(hints.size(), false);
    for (const int n : trunk) in_trunk[n] = true;
    const auto leads_up = [&](int n) {
      const Word word = hints[n].word;
      return s.alive[n] && !in_limb(n) && word != Word::kAttachment && word != Word::kCloth && word != Word::kControl &&
             word != Word::kHair && word != Word::kHeadPart && word != Word::kTail && word != Word::kEye &&
             word != Word::kJaw && !in_trunk[n];
    };
    if (head < 0) {
      // No head by name: the end of the neck, or of the longest way on from the chest.
      const auto best_child = [&](int parent) {
        int best = -1;
        const auto key = [&](int n) {
          // Where all hangs on one body, the longer way is an abdomen or a tail.
          const double way = s.reach[n] + s.bone(n);
          return std::tuple(hints[n].word == Word::kNeck, parent == pelvis ? -way : way, s.weight[n], s.names[n]);
        };
        for (const int child : s.children[parent]) {
          if (leads_up(child) && (best < 0 || key(child) > key(best))) best = child;
        }
        return best;
      };
      for (int n = best_child(chest); n >= 0 && upper.size() + lower.size() > 0; n = best_child(n)) head = n;
    }
    if (head < 0) return;
    for (const int n : s.path(chest, head)) {
      if (!in_trunk[n]) neck_head.push_back(n);
    }
  }

  void find_axes() {
    const Vec3 legs = direction(lower), arms = direction(upper);
    const Vec3 spine = pelvis >= 0 && chest >= 0 ? Vec3(s.position[chest] - s.position[pelvis]) : Vec3::Zero();
    const Vec3 ahead =
        !upper.empty() && !lower.empty()
            ? Vec3(mean(upper, [&](int i) { return start(i); }) - mean(lower, [&](int i) { return start(i); }))
            : spine;
    kind = paths.empty() && trunk.empty() ? BodyKind::kUnknown : BodyKind::kOther;
    const bool four_legs = !upper.empty() && paths[upper[0]].family == Family::kLeg;
    if (upper.size() == 2 && lower.size() == 2) {
      const bool upright = !four_legs && -legs.dot(ahead) > kUpright * legs.norm() * ahead.norm();
      const Vec3 down = legs.normalized();
      const double ground = (mean(lower, [&](int i) { return end(i); }) - s.position[std::max(0, pelvis)]).dot(down);
      const double reached = (mean(upper, [&](int i) { return end(i); }) - s.position[std::max(0, pelvis)]).dot(down);
      const bool stands = arms.dot(down) > 0 && reached > kStands * ground;
      kind = !upright && (four_legs || stands) ? BodyKind::kQuadruped : BodyKind::kBiped;
      if (wanted != BodyKind::kUnknown) kind = wanted;
    }
    if (kind == BodyKind::kBiped || (kind == BodyKind::kOther && lower.size() <= 2)) {
      up = ahead.norm() > 0 ? ahead : Vec3(-legs);
      for (const int limb : lower) {
        const LimbPath& path = paths[limb];
        const int ankle = path.first(kExtremity), toe = path.first(kDigit);
        if (ankle < 0) continue;
        const Vec3 foot = toe >= 0 ? s.position[path.nodes[toe]] : s.skin[path.nodes[ankle]];
        forward += foot - s.position[path.nodes[ankle]];
      }
      facing = "its feet point there";
    } else {
      up = lower.empty() ? Vec3(-arms) : Vec3(-legs - arms);
      forward = ahead;
      if (kind != BodyKind::kQuadruped && head >= 0) {
        forward = s.position[head] - mean(lower, [&](int i) { return start(i); });
      }
      facing = "the head is there";
    }
    up = up.norm() > 0 ? Vec3(up.normalized()) : Vec3::UnitY();
    forward -= forward.dot(up) * up;
    if (forward.norm() < 1e-3 * s.size || !(s.size > 0)) {
      facing.clear();
      forward = Vec3::UnitZ() - up.z() * up;
      if (forward.norm() < 0.5) forward = Vec3::UnitX() - up.x() * up;
    }
    forward.normalize();
  }

  Vec3 left() const { return s.is_mirrored ? forward.cross(up) : up.cross(forward); }

  // Sides the names do not tell are those of the axes.
  void settle_sides() {
    side_notes.resize(paths.size());
    Vec3 middle = mean(upper, [&](int i) { return start(i); });
    if (!lower.empty()) middle = mean(lower, [&](int i) { return start(i); });
    const auto off_middle = [&](std::size_t i) {
      return (0.5 * (start(static_cast<int>(i)) + s.tip[paths[i].nodes.front()]) - middle).dot(left());
    };
    // Limbs with names say which side the others are on, whatever the feet say.
    double named_left = 0;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i].side != NamedSide::kNone)
        named_left += paths[i].side == NamedSide::kLeft ? off_middle(i) : -off_middle(i);
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
      const double off = off_middle(i);
      const NamedSide side = off >= 0 ? NamedSide::kLeft : NamedSide::kRight;
      if (paths[i].side == NamedSide::kNone && named_left != 0) {
        paths[i].side = (off >= 0) == (named_left > 0) ? NamedSide::kLeft : NamedSide::kRight;
        side_notes[i] = "; side by where it is from the limbs whose names tell theirs";
      } else if (paths[i].side == NamedSide::kNone) {
        paths[i].side = side;
        side_notes[i] = facing.empty() ? "; side guessed, nothing tells front from back (a role file can)"
                                       : "; side by where it is, forward because " + facing;
      } else if (paths[i].side != side && !facing.empty() && std::abs(off) > 0.05 * s.size) {
        side_notes[i] = "; side by name, though it is on the other one if forward is right (" + facing + ")";
      }
    }
  }

  // A group's limbs from the front, left before right.
  std::vector<int> in_order(const std::vector<int>& group) const {
    std::array<std::vector<int>, 2> sides;
    for (const int limb : group) sides[paths[limb].side == NamedSide::kRight].push_back(limb);
    std::vector<int> order;
    for (auto& side : sides) {
      const auto key = [&](int limb) {
        const int place = paths[limb].place == Place::kFront ? 0 : (paths[limb].place == Place::kHind ? 2 : 1);
        return std::tuple(place, -(start(limb) + end(limb)).dot(forward), s.names[paths[limb].nodes.front()]);
      };
      std::sort(side.begin(), side.end(), [&](int l, int r) { return key(l) < key(r); });
    }
    for (std::size_t i = 0; i < std::max(sides[0].size(), sides[1].size()); ++i) {
      for (const auto& side : sides) {
        if (i < side.size()) order.push_back(side[i]);
      }
    }
    return order;
  }

  // A body without limbs: the longest way between two of its nodes, from the end nearer to the root.
  void find_single_chain() {
    const bool skinned = std::any_of(s.weight.begin(), s.weight.end(), [](double w) { return w > 0; });
    const auto counts = [&](int n) { return skinned ? s.weight[n] > 0 : bool(s.alive[n]); };
    const auto farthest = [&](int from) {
      std::vector<double> distance(hints.size(), -1);
      double far = 0;
      for (int n = from, child = -1; n >= 0; child = n, n = s.parent[n]) {
        if (child >= 0) far += s.bone(child);
        distance[n] = far;
      }
      int best = from;
      for (int n = 0; n < s.count(); ++n) {
        const int parent = s.parent[n];
        if (distance[n] < 0 && parent >= 0 && distance[parent] >= 0) distance[n] = distance[parent] + s.bone(n);
        if (counts(n) && distance[n] > distance[best]) best = n;
      }
      return best;
    };
    int any = -1;
    for (int n = 0; n < s.count() && any < 0; ++n) any = counts(n) ? n : -1;
    if (any < 0) return;
    pelvis = farthest(any);
    chest = farthest(pelvis);
    if (pelvis == chest) {
      pelvis = chest = -1;
      return;
    }
    if (s.depth[chest] < s.depth[pelvis]) std::swap(pelvis, chest);
    trunk = s.path(pelvis, chest);
  }
};

}  // namespace

int find_in_middle(const Skeleton& s, const std::vector<Hint>& hints, const std::vector<int>& path_of, Word word) {
  int best = -1;
  const auto key = [&](int n) { return std::tuple(hints[n].given, -s.depth[n], s.weight[n], s.names[n]); };
  for (int n = 0; n < s.count(); ++n) {
    if (!s.alive[n] || hints[n].word != word || hints[n].side != NamedSide::kNone || path_of[n] >= 0) continue;
    if (best < 0 || key(n) > key(best)) best = n;
  }
  return best;
}

std::vector<bool> at_or_above(const Skeleton& skeleton, int node) {
  std::vector<bool> out(skeleton.parent.size(), false);
  for (; node >= 0; node = skeleton.parent[node]) out[node] = true;
  return out;
}

Body find_body(const Skeleton& skeleton, const std::vector<Hint>& hints, BodyKind wanted) {
  return BodyFinder(skeleton, hints, wanted);
}

}  // namespace spherechain::baker
