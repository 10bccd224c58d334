// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/roles/joint_parts.h"

#include <algorithm>
#include <string_view>

namespace spherechain::baker {
namespace {

constexpr double kSamePlace = 0.005;  // of the rig's size

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// "Arm1_grp" and "Arm1_jnt" have the same numbers, "Arm1" and "Arm2" are two joints.
bool same_numbers(std::string_view a, std::string_view b) {
  const auto numbers = [](std::string_view name) {
    std::string out;
    for (std::size_t i = 0; i < name.size(); ++i) {
      if (is_digit(name[i]))
        out += name[i];
      else if (i > 0 && is_digit(name[i - 1]))
        out += ' ';
    }
    while (!out.empty() && out.back() == ' ') out.pop_back();
    return out;
  };
  return numbers(a) == numbers(b);
}

struct Joiner {
  Skeleton& s;
  const std::vector<Hint>& hints;

  bool same_place(int a, int b) const { return (s.position[a] - s.position[b]).norm() <= kSamePlace * s.size; }
  bool tells_nothing(int n) const { return hints[n].word == Word::kNone || hints[n].word == Word::kControl; }
  bool same_word(int a, int b) const {
    const Word word = hints[a].word;
    const bool of_body = word >= Word::kPelvis && word <= Word::kTail;
    return of_body && word == hints[b].word && hints[a].side == hints[b].side;
  }
  int living_children(int n) const {
    return static_cast<int>(
        std::count_if(s.children[n].begin(), s.children[n].end(), [&](int child) { return s.alive[child]; }));
  }

  // The joint that a node without skin leads to, if it only stands in for it. `below`: such joints of the nodes below.
  int stands_for(int n, const std::vector<int>& below) const {
    if (s.weight[n] > 0 || !s.alive[n] || hints[n].given || living_children(n) != 1) return -1;
    const int child =
        *std::find_if(s.children[n].begin(), s.children[n].end(), [&](int c) { return static_cast<bool>(s.alive[c]); });
    const int joint = below[child] >= 0 ? below[child] : child;
    if (!(s.weight[joint] > 0)) return -1;
    if (same_place(n, joint)) return tells_nothing(n) || same_word(n, joint) ? joint : -1;
    // "LeftFoot" above "LeftFoot_end" is a joint itself.
    const std::string_view own = s.names[n], name = s.names[joint];
    const bool named = (same_word(n, joint) && !hints[joint].twist) ||
                       (tells_nothing(n) && !name.empty() && own.find(name) != std::string_view::npos);
    return named && !name.starts_with(own) && same_numbers(own, name) ? joint : -1;
  }

  bool is_twin(int n) const {
    const int parent = s.parent[n];
    if (parent < 0 || !(s.weight[n] > 0) || !(s.weight[parent] > 0) || hints[n].given) return false;
    return living_children(n) == 0 && same_place(n, parent) && (hints[n].word == Word::kNone || same_word(n, parent));
  }

  // A living node hangs on the next living one above.
  void hang(int n) {
    int above = s.parent[n];
    while (above >= 0 && s.joint[above] >= 0) above = s.parent[above];
    if (above == s.parent[n]) return;
    std::erase(s.children[s.parent[n]], n);
    s.parent[n] = above;
    if (above >= 0) s.children[above].push_back(n);
  }
};

}  // namespace

void join_joint_parts(Skeleton& s, const std::vector<Hint>& hints) {
  Joiner joiner{s, hints};
  std::vector<int> skinned_below(hints.size(), 0);
  int skinned = 0;
  for (int n = s.count(); n-- > 0;) {
    if (s.weight[n] > 0) {
      ++skinned_below[n];
      ++skinned;
    }
    if (s.parent[n] >= 0) skinned_below[s.parent[n]] += skinned_below[n];
  }
  std::vector<int> joint(hints.size(), -1);
  for (int n = s.count(); n-- > 0;) {
    // A node above all skin is the rig's root.
    if (skinned_below[n] < skinned) joint[n] = joiner.stands_for(n, joint);
  }
  for (int n = 0; n < s.count(); ++n) {
    if (joint[n] < 0 && joiner.is_twin(n)) joint[n] = s.parent[n];
  }
  s.joint = joint;
  for (int n = 0; n < s.count(); ++n) {
    if (joint[n] >= 0)
      s.alive[n] = false;
    else if (s.alive[n])
      joiner.hang(n);
  }
  s.measure();
}

}  // namespace spherechain::baker
