// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/limb_path.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace spherechain::baker {
namespace {

// A shoulder or hip this much shorter than the bone after it does not make half a limb: it is the girdle.
constexpr double kGirdleRatio = 0.6;

// More than any creature has: such names mean something else.
constexpr std::size_t kLimbsMax = 64;

bool is_open(Word word) {
  return word == Word::kShoulder || word == Word::kHip || word == Word::kArm || word == Word::kLeg;
}
bool is_girdle_or_upper(Word word) { return word == Word::kShoulder || word == Word::kHip; }

// The highest rank that an ambiguous word can have.
int rank_of(Word word) {
  switch (word) {
    case Word::kClavicle:
    case Word::kHipGirdle:
      return kGirdle;
    case Word::kShoulder:
    case Word::kHip:
    case Word::kUpperArm:
    case Word::kThigh:
      return kUpper;
    case Word::kArm:
    case Word::kLeg:
    case Word::kForeArm:
    case Word::kShin:
      return kLower;
    case Word::kHand:
    case Word::kFoot:
      return kExtremity;
    case Word::kFinger:
    case Word::kToe:
      return kDigit;
    default:
      return -1;
  }
}

bool leads_off(const Hint& hint) {
  return hint.word == Word::kAttachment || hint.word == Word::kCloth || hint.word == Word::kControl ||
         hint.word == Word::kHair || hint.word == Word::kHeadPart;
}

// The highest rank of a family's words at a node or below; 100 more where a role file put one of them there.
std::vector<int> farthest_ranks(const Skeleton& s, const std::vector<Hint>& hints, Family family) {
  std::vector<int> ranks(hints.size(), -1);
  for (int n = s.count(); n-- > 0;) {
    if (!s.alive[n] || leads_off(hints[n])) {
      ranks[n] = -1;
      continue;
    }
    if (family_of(hints[n].word) == family) {
      ranks[n] = std::max(ranks[n], rank_of(hints[n].word) + (hints[n].given ? 100 : 0));
    }
    if (const int parent = s.parent[n]; parent >= 0) ranks[parent] = std::max(ranks[parent], ranks[n]);
  }
  return ranks;
}

std::vector<int> way_down(const Skeleton& s, const std::vector<Hint>& hints, const std::vector<int>& farthest,
                          int top) {
  std::vector<int> nodes{top};
  for (;;) {
    int best = -1;
    const auto key = [&](int child) {
      return std::tuple(farthest[child], s.reach[child] + s.bone(child), s.weight[child], s.names[child]);
    };
    for (const int child : s.children[nodes.back()]) {
      const bool side_twist = hints[child].twist && s.children[child].empty();
      if (!s.alive[child] || leads_off(hints[child]) || side_twist) continue;
      if (best < 0 || key(child) > key(best)) best = child;
    }
    if (best < 0) return nodes;
    nodes.push_back(best);
  }
}

// Which of the open words is what follows from the words before and after it on the way.
std::vector<Rank> resolve(const Skeleton& s, const std::vector<Hint>& hints, const std::vector<int>& nodes) {
  const std::size_t n = nodes.size();
  const auto word = [&](std::size_t i) { return hints[nodes[i]].word; };
  const auto fixed = [&](std::size_t i, int rank) { return !is_open(word(i)) && rank_of(word(i)) == rank; };
  const auto any = [&](std::size_t from, const auto& holds) {
    for (std::size_t i = from; i < n; ++i) {
      if (holds(i)) return true;
    }
    return false;
  };
  std::vector<Rank> ranks(n, kGirdle);
  std::size_t upper = n;  // where lengths have to decide
  if (!any(0, [&](std::size_t i) { return fixed(i, kUpper) || fixed(i, kLower); })) {
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_open(word(i))) open.push_back(i);
    }
    std::vector<double> lengths;
    for (std::size_t k = 0; k < open.size() && open[k] + 1 < n; ++k) {
      lengths.push_back((s.position[nodes[open[k] + 1]] - s.position[nodes[open[k]]]).norm());
    }
    if (!open.empty()) {
      const std::size_t first = find_long_bones(lengths);
      const bool short_start = open.size() == 2 && lengths.size() == 2 && is_girdle_or_upper(word(open[0])) &&
                               lengths[0] < kGirdleRatio * lengths[1];
      upper = open[short_start ? 1 : first];
    }
  }
  // For each node, tells if a hand or an upper bone follows it on the path.
  std::vector<bool> hand_follows(n, false), upper_follows(n, false);
  bool hand = false, upper_by_word = false, open_before_lower = false;
  for (std::size_t i = n; i-- > 0;) {
    hand_follows[i] = hand;
    upper_follows[i] = upper_by_word || open_before_lower;
    hand = hand || fixed(i, kExtremity);
    upper_by_word = upper_by_word || fixed(i, kUpper);
    open_before_lower = !fixed(i, kLower) && (open_before_lower || word(i) == Word::kArm || word(i) == Word::kLeg);
  }
  bool has_upper = false, has_lower = false;
  for (std::size_t i = 0; i < n; ++i) {
    int rank = rank_of(word(i));
    if (has_lower && is_open(word(i)) && !hints[nodes[i]].twist && !hand_follows[i]) {
      rank = kExtremity;  // some languages call an arm and a hand, a leg and a foot by one word
    } else if (is_open(word(i)) && upper < n) {
      rank = i < upper ? kGirdle : static_cast<int>(std::min<std::size_t>(kUpper + (i - upper), kDigit));
    } else if (is_girdle_or_upper(word(i))) {
      rank = upper_follows[i] ? kGirdle : kUpper;
    } else if (is_open(word(i))) {
      rank = has_upper ? kLower : kUpper;
    }
    if (rank < 0) rank = i > 0 ? ranks[i - 1] : kGirdle;
    if (i > 0) {
      rank = std::max(rank, static_cast<int>(ranks[i - 1]));
      // A second hand is its knuckles, a second foot its ball.
      if (rank == kExtremity && ranks[i - 1] == kExtremity && !hints[nodes[i]].twist) rank = kDigit;
    }
    has_upper = has_upper || rank == kUpper;
    has_lower = has_lower || fixed(i, kLower);
    ranks[i] = static_cast<Rank>(rank);
  }
  return ranks;
}

// The topmost nodes with a limb's words, a limb each but for torn ones; girdles first.
std::vector<int> find_tops(const Skeleton& s, const std::vector<Hint>& hints) {
  const auto starts = [&](int n) {
    return s.alive[n] && family_of(hints[n].word) != Family::kNone && rank_of(hints[n].word) < kDigit;
  };
  // Which families and sides there are above and below: bit 3 * family + side.
  const auto bit = [&](Family family, NamedSide side) {
    return 1U << (3 * static_cast<int>(family) + static_cast<int>(side));
  };
  const auto own = [&](int n) { return starts(n) ? bit(family_of(hints[n].word), hints[n].side) : 0U; };
  std::vector<unsigned> above(hints.size(), 0), below(hints.size(), 0);
  for (int n = s.count(); n-- > 0;) {
    if (const int parent = s.parent[n]; parent >= 0) below[parent] |= below[n] | own(n);
  }
  const auto of_side = [&](NamedSide side) { return bit(Family::kArm, side) | bit(Family::kLeg, side); };
  // A node above limbs of another side is of the trunk, whatever its name ("Pelvis_L", the lower one).
  const auto of_trunk = [&](int n) {
    return (hints[n].side != NamedSide::kLeft && (below[n] & of_side(NamedSide::kLeft)) != 0) ||
           (hints[n].side != NamedSide::kRight && (below[n] & of_side(NamedSide::kRight)) != 0);
  };
  std::vector<int> tops;
  for (int n = 0; n < s.count(); ++n) {
    if (const int parent = s.parent[n]; parent >= 0) above[n] = above[parent] | (of_trunk(parent) ? 0U : own(parent));
    if (!starts(n) || of_trunk(n)) continue;
    const Family family = family_of(hints[n].word);
    unsigned same = bit(family, hints[n].side) | bit(family, NamedSide::kNone);
    if (hints[n].side == NamedSide::kNone) same |= bit(family, NamedSide::kLeft) | bit(family, NamedSide::kRight);
    if ((above[n] & same) == 0) tops.push_back(n);
  }
  if (tops.size() > kLimbsMax) return {};
  const auto key = [&](int n) {
    const Vec3& p = s.position[n];
    return std::tuple(is_girdle_or_upper(hints[n].word) ? kGirdle : rank_of(hints[n].word), s.names[n], p.x(), p.y(),
                      p.z());
  };
  std::sort(tops.begin(), tops.end(), [&](int l, int r) { return key(l) < key(r); });
  return tops;
}

// Where an exporter hung the bones of a limb on the root, a fore arm goes on where an upper arm ends.
LimbPath* find_torn(const Skeleton& s, const std::vector<Hint>& hints, std::vector<LimbPath>& limbs, int top) {
  const Hint& hint = hints[top];
  if (is_open(hint.word)) return nullptr;
  const int rank = rank_of(hint.word);
  LimbPath* nearest = nullptr;
  const auto gap = [&](const LimbPath& limb) { return (s.position[limb.nodes.back()] - s.position[top]).norm(); };
  for (LimbPath& limb : limbs) {
    int reached = kGirdle;
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      if (!is_girdle_or_upper(hints[limb.nodes[i]].word)) reached = std::max<int>(reached, limb.ranks[i]);
    }
    const bool goes_on = reached < rank || (reached == rank && rank >= kLower);
    const bool same_place = limb.place == hint.place || hint.place == Place::kNone;
    if (limb.family != family_of(hint.word) || limb.side != hint.side || !goes_on || !same_place) continue;
    if (nearest == nullptr || gap(limb) < gap(*nearest)) nearest = &limb;
  }
  return nearest;
}

}  // namespace

int LimbPath::first(Rank rank) const {
  const auto found = std::find(ranks.begin(), ranks.end(), rank);
  return found == ranks.end() ? -1 : static_cast<int>(found - ranks.begin());
}

std::size_t find_long_bones(const std::vector<double>& lengths) {
  std::size_t best = 0;
  double longest = -1;
  for (std::size_t i = 0; i + 1 < lengths.size(); ++i) {
    const double both = std::min(lengths[i], lengths[i + 1]);
    if (both > longest * (1 + 1e-6)) {
      longest = both;
      best = i;
    }
  }
  return best;
}

std::vector<int> main_path(const Skeleton& s, const std::vector<Hint>& hints, int top, Family family) {
  return way_down(s, hints, farthest_ranks(s, hints, family), top);
}

std::vector<LimbPath> find_limb_paths(const Skeleton& s, const std::vector<Hint>& hints) {
  const std::array<std::vector<int>, 2> farthest{farthest_ranks(s, hints, Family::kArm),
                                                 farthest_ranks(s, hints, Family::kLeg)};
  std::vector<LimbPath> limbs;
  for (const int top : find_tops(s, hints)) {
    const Hint& hint = hints[top];
    const Family family = family_of(hint.word);
    const std::vector<int> nodes = way_down(s, hints, farthest[family == Family::kLeg], top);
    LimbPath* limb = find_torn(s, hints, limbs, top);
    if (limb == nullptr) limb = &limbs.emplace_back(LimbPath{family, hint.side, Place::kNone, {}, {}, {}});
    limb->roots.push_back(top);
    limb->nodes.insert(limb->nodes.end(), nodes.begin(), nodes.end());
    limb->ranks = resolve(s, hints, limb->nodes);
    for (const int node : nodes) {
      if (limb->place == Place::kNone) limb->place = hints[node].place;
      if (limb->side == NamedSide::kNone) limb->side = hints[node].side;
    }
  }
  std::erase_if(limbs, [](const LimbPath& limb) { return limb.ranks.back() == kGirdle; });
  return limbs;
}

}  // namespace spherechain::baker
