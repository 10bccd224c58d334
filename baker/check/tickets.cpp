// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/tickets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "baker/check/formats.h"
#include "baker/os/sha256.h"

namespace spherechain::baker {
namespace {

constexpr double kInsidePercent = 20;  // of the height: the depth that all of a part inside counts for
constexpr double kUnseen = 0.25;       // the weight of what no eye sees
constexpr double kSecondsMin = 0.1, kSecondsMax = 4;
constexpr double kSameDepth = 0.01;  // events of equal clips differ by less, as a share of the depth

using Parts = std::array<std::string, 2>;

std::string mirrored(std::string name) {
  for (const auto& [from, to] : {std::pair<std::string, std::string>("left ", "right "), {"right ", "left "}}) {
    if (name.starts_with(from)) return to + name.substr(from.size());
  }
  return name;
}

// The same for both orders of two parts, and for the mirrored two.
Parts unordered(const Parts& parts) {
  Parts own = parts, other{mirrored(parts[0]), mirrored(parts[1])};
  std::sort(own.begin(), own.end());
  std::sort(other.begin(), other.end());
  return std::min(own, other);
}

// The number of frames that two events of a clip of `end` frames share. One over the seam of a loop has two ranges.
double shared_frames(const Event& a, const Event& b, double end) {
  const auto ranges = [&](const Event& e) {
    using Range = std::pair<double, double>;
    return e.from <= e.to ? std::vector<Range>{{e.from, e.to + 1}} : std::vector<Range>{{e.from, end}, {0, e.to + 1}};
  };
  double shared = 0;
  for (const auto& [from, to] : ranges(a)) {
    for (const auto& [other_from, other_to] : ranges(b))
      shared += std::max(0.0, std::min(to, other_to) - std::max(from, other_from));
  }
  return shared;
}

double frames_of(const Event& event, double end) { return shared_frames(event, event, end); }

// Sets of events that grow together.
class Groups {
 public:
  explicit Groups(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), std::size_t{0}); }
  std::size_t find(std::size_t i) {
    while (root_[i] != i) i = root_[i] = root_[root_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) { root_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<std::size_t> root_;
};

class Grouping {
 public:
  Grouping(const std::vector<EvaluatedClip>& clips, const std::map<std::string, CharacterResult>& characters)
      : clips_(clips), first_(clips.size() + 1), groups_(0) {
    for (std::size_t c = 0; c < clips.size(); ++c) {
      first_[c] = open_.size();
      for (std::size_t e = 0; e < clips[c].events.size(); ++e) {
        if (clips[c].events[e].is_open()) open_.push_back({c, e});
      }
    }
    first_[clips.size()] = open_.size();
    groups_ = Groups(open_.size());
    for (std::size_t c = 0; c < clips.size(); ++c) {
      const auto character = characters.find(clips[c].clip.character_key);
      if (character != characters.end()) join_within(c, character->second);
    }
    join_equal_clips();
  }

  std::vector<Ticket> tickets() {
    std::map<std::size_t, std::vector<Ticket::Shown>> members;
    for (std::size_t i = 0; i < open_.size(); ++i) members[groups_.find(i)].push_back(open_[i]);
    std::vector<Ticket> out;
    for (auto& [root, events] : members) out.push_back(ticket(std::move(events)));
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.severity > b.severity; });
    return out;
  }

 private:
  const Event& event(const Ticket::Shown& shown) const { return clips_[shown.clip].events[shown.event].event; }
  double severity_of(const Ticket::Shown& shown) const { return severity(event(shown), clips_[shown.clip].fps); }

  static std::string limb_of(const std::string& part, const CharacterResult& character) {
    for (std::size_t i = 0; i < std::min(character.parts.size(), character.limbs.size()); ++i) {
      if (character.parts[i] == part) return character.limbs[i];
    }
    return {};
  }

  bool overlap(std::size_t a, std::size_t b) const {
    const Event &one = event(open_[a]), &other = event(open_[b]);
    const double end = clips_[open_[a].clip].frames;
    return shared_frames(one, other, end) * 2 > std::min(frames_of(one, end), frames_of(other, end));
  }

  // The worst event that is left makes a group with its repeats, and with what its limb does meanwhile.
  void join_within(std::size_t clip, const CharacterResult& character) {
    std::vector<std::size_t> left(first_[clip + 1] - first_[clip]);
    std::iota(left.begin(), left.end(), first_[clip]);
    std::stable_sort(left.begin(), left.end(),
                     [&](std::size_t a, std::size_t b) { return severity_of(open_[a]) > severity_of(open_[b]); });
    while (!left.empty()) {
      const std::size_t worst = left.front();
      const auto is_repeat = [&](std::size_t i) {
        return unordered(event(open_[i]).parts) == unordered(event(open_[worst]).parts);
      };
      std::vector<std::size_t> repeats;
      std::copy_if(left.begin(), left.end(), std::back_inserter(repeats), is_repeat);
      const auto is_meanwhile = [&](std::size_t i) {
        return std::any_of(repeats.begin(), repeats.end(), [&](std::size_t of) {
          const Parts &parts = event(open_[of]).parts, &own = event(open_[i]).parts;
          const std::string limb = limb_of(parts[0], character);
          const bool has_limb = limb_of(own[0], character) == limb || limb_of(own[1], character) == limb;
          return !limb.empty() && has_limb && overlap(of, i);
        });
      };
      const auto rest = std::stable_partition(left.begin(), left.end(),
                                              [&](std::size_t i) { return is_repeat(i) || is_meanwhile(i); });
      std::for_each(left.begin(), rest, [&](std::size_t i) { groups_.join(i, worst); });
      left.erase(left.begin(), rest);
    }
  }

  bool are_equal(std::size_t a, std::size_t b) const {
    const std::size_t count = first_[a + 1] - first_[a];
    if (count == 0 || count != first_[b + 1] - first_[b]) return false;
    for (std::size_t i = 0; i < count; ++i) {
      const Event &one = event(open_[first_[a] + i]), &other = event(open_[first_[b] + i]);
      const bool are_same = one.parts == other.parts && one.from == other.from && one.to == other.to &&
                            std::abs(one.depth_mm - other.depth_mm) <= kSameDepth * one.depth_mm;
      if (!are_same) return false;
    }
    return true;
  }

  void join_equal_clips() {
    // Clips whose events are all equal begin with the same event, and have as many.
    std::map<std::tuple<std::size_t, std::size_t, double, Parts>, std::vector<std::size_t>> alike;
    for (std::size_t c = 0; c < clips_.size(); ++c) {
      if (first_[c] == first_[c + 1]) continue;
      const Event& begin = event(open_[first_[c]]);
      std::vector<std::size_t>& others =
          alike[{clips_[c].clip.character, first_[c + 1] - first_[c], begin.from, begin.parts}];
      const auto equal = std::find_if(others.begin(), others.end(), [&](std::size_t o) { return are_equal(o, c); });
      if (equal == others.end()) {
        others.push_back(c);
        continue;
      }
      for (std::size_t i = first_[c]; i < first_[c + 1]; ++i) groups_.join(i, first_[*equal] + i - first_[c]);
    }
  }

  Ticket ticket(std::vector<Ticket::Shown> events) const {
    Ticket out;
    // The id is of the first clip's first parts by name, which stay as depths and times change.
    std::string key;
    for (const Ticket::Shown& shown : events) {
      const Parts parts = unordered(event(shown).parts);
      const EvaluatedClip& clip = clips_[shown.clip];
      const std::string own = clip.character + "\n" + clip.clip.clip + "\n" + parts[0] + "\n" + parts[1];
      if (key.empty() || own < key) key = own;
      out.state = std::min(out.state, clip.events[shown.event].state);
    }
    out.id = sha256_of_text(key).substr(0, 8);
    std::stable_sort(events.begin(), events.end(),
                     [&](const auto& a, const auto& b) { return severity_of(a) > severity_of(b); });
    const EvaluatedClip& worst = clips_[events[0].clip];
    out.title = fmt::format("{}{}: {}", worst.character, worst.clip.clip.empty() ? "" : " " + worst.clip.clip,
                            parts_text(event(events[0])));
    out.severity = severity_of(events[0]);
    out.events = std::move(events);
    return out;
  }

  const std::vector<EvaluatedClip>& clips_;
  std::vector<Ticket::Shown> open_;
  std::vector<std::size_t> first_;  // of each clip's in open_
  Groups groups_;                   // of open_
};

}  // namespace

std::vector<std::string> limbs_of(const std::vector<BodyPart>& parts) {
  // Whether the part, or one that hangs on it, is left, and whether one is right.
  std::vector<std::array<bool, 2>> has_sides(parts.size(), {false, false});
  const auto up = [&](std::size_t i) { return static_cast<std::size_t>(parts[i].parent); };
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].side == Side::kNone) continue;
    std::size_t at = i;
    for (std::size_t steps = 0; steps < parts.size(); ++steps) {
      has_sides[at][parts[i].side == Side::kRight ? 1 : 0] = true;
      if (parts[at].parent < 0) break;
      at = up(at);
    }
  }
  const auto is_trunk = [&](std::size_t i) { return has_sides[i][0] && has_sides[i][1]; };
  std::vector<std::string> out(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (is_trunk(i)) continue;
    std::size_t at = i;
    while (parts[at].parent >= 0 && !is_trunk(up(at))) at = up(at);
    out[i] = parts[at].name;
  }
  return out;
}

double severity(const Event& event, double fps) {
  const double inside = event.kind == SC_CLASS_INSIDE ? kInsidePercent * event.swallowed : 0;
  const std::size_t faulty = faulty_frames(event);
  const double frames = faulty > 0               ? static_cast<double>(faulty)
                        : event.from <= event.to ? event.to - event.from + 1
                                                 : static_cast<double>(event.depths_mm.size());
  const double seconds = std::clamp(frames / fps, kSecondsMin, kSecondsMax);
  return (event.depth_percent + inside) * (event.eye ? 1 : kUnseen) * std::sqrt(seconds);
}

std::vector<Ticket> find_tickets(const std::vector<EvaluatedClip>& clips,
                                 const std::map<std::string, CharacterResult>& characters) {
  return Grouping(clips, characters).tickets();
}

}  // namespace spherechain::baker
