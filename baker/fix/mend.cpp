// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton over a whole clip: each two body parts that are in each other in a frame give a wish, that their deepest
// points part along the way out. Wishes of earlier rounds stay: what was pushed out once must not come back.
#include "fix/mend.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "check/clip_check.h"
#include "fix/find_faults.h"
#include "fix/joints.h"
#include "fix/pushes.h"
#include "fix/solve.h"
#include "fix/ways_out.h"

namespace spherechain::baker {
namespace {

constexpr int kRounds = 16;
constexpr int kTrying = 10;        // after so many, what stays is left
constexpr int kPatience = 3;       // rounds that an event may take without getting better
constexpr int kFreeRounds = 4;     // at most, once there is no fault, in which joints go back as far as they can
constexpr int kTapers = 3;         // tries to take back softly what got worse
constexpr double kStep = 10;       // degrees that a joint turns in a round, at most
constexpr double kStill = 1;       // degrees: a round that turns joints by less may be the last
constexpr double kLeave = 3;       // of a turn from where the round starts, while there is a fault
constexpr double kSame = 2e-4;     // radians: too little to look again
constexpr double kPad = 0.35;      // seconds around an event in which joints turn, too
constexpr double kShallow = 10;    // mm
constexpr double kNear = 5;        // mm
constexpr double kLess = 0.8;      // of its depth: an event is reduced
constexpr double kDeeper = 0.5;    // mm: so much deeper than before is a fault, too
constexpr double kFoldDeeper = 2;  // the same of folds, which move with the joint
constexpr double kWish = 1e4, kWishMost = 1e6;  // the weight of pushes grows by round

using PartPair = std::pair<std::uint32_t, std::uint32_t>;

MeetingPlace place_of(const Meeting& meeting) { return {meeting.frame, meeting.found.part_a, meeting.found.part_b}; }

class Mender {
 public:
  Mender(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options)
      : animated_(animated),
        character_(animated.character()),
        options_(options),
        mm_(mm_per_unit(animated.asset())),
        height_(animated.frame().height),
        clip_(character_.rig, *clip.clip, clip.fps, clip.own_count, turning_joints(character_.rig, roles, *clip.clip)),
        finder_(animated, clip_),
        pushes_(animated, clip_),
        turns_(static_cast<std::size_t>(clip.own_count) * clip_.count(), Vec3::Zero()),
        feet_(joints_of_role(clip_.joints(), roles, "ankle")),
        wrists_(joints_of_role(clip_.joints(), roles, "wrist")),
        loops_(same_pose(clip_.pose(0, turns_).deformation, clip_.pose(clip_.frames() - 1, turns_).deformation,
                         animated.frame())),
        in_window_(static_cast<std::size_t>(clip.own_count), 0),
        jumps_(static_cast<std::size_t>(clip.own_count), 0) {
    for (const BodyPart& part : parts_of(animated.asset()).parts) {
      joints_of_part_.push_back(part.bone < 0 ? std::vector<Index>{} : clip_.above(static_cast<Index>(part.bone)));
    }
  }

  Mend run(const std::function<bool(const MendedEvent&)>& leave, const std::function<void(const std::string&)>& told) {
    std::vector<double> all;
    for (int f = 0; f < clip_.frames(); ++f) all.push_back(f);
    told("looking");
    const std::vector<Meeting> before = finder_.in_frames(all, turns_);
    for (const Meeting& meeting : before) before_[place_of(meeting)] = meeting.found;
    make_events(before, leave);
    finder_.leave_out(harmless(before));
    Mend out;
    Turns best = turns_;
    const double still = kStill * std::numbers::pi / 180;
    double least = HUGE_VAL, moved = 0;
    bool was_free = false;
    int free_rounds = 0;
    for (int round = 0; round < kRounds && (!is_idle() || moved > still); ++round) {
      const std::vector<Meeting> now = round == 0 ? before : look(frames_in_window());
      double badness = add_pushes(now);
      if (round > 0 && (badness == 0 || round % 4 == 3)) {
        badness += add_pushes(finder_.between(whole_frames_in_window(), turns_));
      }
      told(fmt::format("round {}: {:.1f} mm too deep", round + 1, badness * mm_));
      if (badness <= least && round > 0) {
        least = badness;
        best = turns_;
      }
      if (least == 0) {
        if ((badness == 0 && was_free && moved < still) || ++free_rounds > kFreeRounds) break;
      } else if (give_up(now, round, round >= kTrying, told)) {
        least = HUGE_VAL;
      }
      open_windows();
      was_free = badness == 0;
      const double weight = std::min(kWish * std::pow(2, round), kWishMost);
      moved = take(solve_turns(clip_, in_window_, wishes(weight), turns_, was_free ? 0 : kLeave));
      jumps_.assign(jumps_.size(), 0);
      out.rounds = round + 1;
    }
    turns_ = best;
    finder_.leave_out({});
    seen_.clear();
    take_back_what_fails();
    finish(out);
    return out;
  }

 private:
  // A joint turns a little a round, and never beyond the budget. Returns the farthest that one turns; radians.
  double take(const Turns& wanted) {
    const double step = kStep * std::numbers::pi / 180, most = options_.budget_degrees * std::numbers::pi / 180;
    double farthest = 0;
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      Vec3 to = wanted[i] - turns_[i];
      if (to.norm() > step && jumps_[i / clip_.count()] == 0) to *= step / to.norm();
      to += turns_[i];
      if (to.norm() > most) to *= most / to.norm();
      farthest = std::max(farthest, (to - turns_[i]).norm());
      turns_[i] = to;
    }
    return farthest;
  }

  // Pairs of parts that are never more than layers of each other, or as at rest.
  static std::set<PartPair> harmless(const std::vector<Meeting>& meetings) {
    std::map<PartPair, PenetrationClass> worst;
    for (const Meeting& m : meetings) {
      PenetrationClass& kind = worst.try_emplace({m.found.part_a, m.found.part_b}, m.found.kind).first->second;
      kind = std::max(kind, m.found.kind);
    }
    std::set<PartPair> out;
    for (const auto& [pair, kind] : worst) {
      if (kind <= SC_CLASS_SHELL) out.insert(pair);
    }
    return out;
  }

  // What was found before in a frame holds while joints turn by no more than can be seen.
  std::vector<Meeting> look(const std::vector<double>& frames) {
    std::vector<double> changed;
    for (const double frame : frames) {
      std::vector<Vec3> now = clip_.turns_at(frame, turns_);
      const auto known = seen_.find(frame);
      bool is_same = known != seen_.end();
      for (std::size_t j = 0; is_same && j < now.size(); ++j)
        is_same = (now[j] - known->second.turns[j]).norm() < kSame;
      if (is_same) continue;
      changed.push_back(frame);
      seen_[frame] = {std::move(now), {}};
    }
    for (const Meeting& meeting : finder_.in_frames(changed, turns_)) seen_[meeting.frame].found.push_back(meeting);
    std::vector<Meeting> out;
    for (const double frame : frames) {
      const std::vector<Meeting>& found = seen_[frame].found;
      out.insert(out.end(), found.begin(), found.end());
    }
    return out;
  }

  bool is_idle() const {
    return std::none_of(events_.begin(), events_.end(), [](const MendedEvent& e) { return is_wanted(e); });
  }
  static bool is_wanted(const MendedEvent& event) { return event.outcome == Outcome::kReduced; }

  void make_events(const std::vector<Meeting>& before, const std::function<bool(const MendedEvent&)>& leave) {
    std::vector<PartMeeting> faults;
    for (const Meeting& meeting : before) {
      if (is_fault(meeting.found.kind)) faults.push_back({static_cast<int>(meeting.frame), meeting.found});
    }
    for (const EventSpan& span : join_events(faults, clip_.frames(), false)) {
      const Penetration& worst = faults[span.deepest].found;
      MendedEvent event{worst.part_a, worst.part_b, span.from, span.to, worst.kind, mm_ * double{worst.depth}, 0};
      if (worst.kind == SC_CLASS_DEEP_FOLD || worst.part_a == worst.part_b) event.outcome = Outcome::kFold;
      if (leave(event)) event.outcome = Outcome::kAccepted;
      events_.push_back(event);
    }
  }

  const MendedEvent* event_of(const Meeting& meeting) const {
    for (const MendedEvent& event : events_) {
      if (is_in(place_of(meeting), event)) return &event;
    }
    return nullptr;
  }

  // How deep a pair may be, in the source's units; negative: so far apart.
  double allowed(const Meeting& meeting) {
    const MendedEvent* event = event_of(meeting);
    const double apart = -options_.margin_mm / mm_;
    if (event != nullptr && is_wanted(*event) && meeting.frame >= event->from && meeting.frame <= event->to)
      return apart;
    const bool is_new =
        event == nullptr && meeting.found.kind == SC_CLASS_PENETRATION && meeting.found.part_a != meeting.found.part_b;
    if (is_new) return apart;
    const auto known = before_.find({std::round(meeting.frame), meeting.found.part_a, meeting.found.part_b});
    return known == before_.end() ? 0 : double{known->second.depth};
  }

  bool is_let_be(const Meeting& meeting, double may_be) const {
    if (may_be < 0) return false;
    const Penetration& p = meeting.found;
    const double slack =
        (is_fault(p.kind) && p.kind != SC_CLASS_DEEP_FOLD ? kDeeper : kFoldDeeper) / mm_ + 0.1 * may_be;
    // What is no fault and not to part is let be: folds and touches come and go with a joint.
    return double{p.depth} - may_be <= slack || !is_fault(p.kind) || p.part_a == p.part_b;
  }
  static double too_deep(const Meeting& meeting, double may_be) {
    if (!is_fault(meeting.found.kind)) return 0;
    return double{meeting.found.depth} - std::max(may_be, 0.0);
  }

  // Wishes for what is too deep; returns by how much in all.
  double add_pushes(const std::vector<Meeting>& meetings) {
    double sum = 0;
    for (const Meeting& meeting : meetings) {
      const Penetration& p = meeting.found;
      const double may_be = allowed(meeting);
      if (is_let_be(meeting, may_be)) continue;
      sum += too_deep(meeting, may_be);
      const auto known = before_.find(place_of(meeting));
      const bool is_shallow = known != before_.end() && mm_ * double{known->second.depth} <= kShallow;
      pushes_.add(place_of(meeting), p, -may_be, is_shallow, turns_);
    }
    return sum;
  }

  void open_windows() {
    in_window_.assign(static_cast<std::size_t>(clip_.frames()), 0);
    const int pad = static_cast<int>(std::ceil(kPad * clip_.fps()));
    std::set<int> frames;
    for (const auto& [place, pushes] : pushes_.all()) frames.insert(static_cast<int>(place.frame));
    for (const auto& [at, turn] : led_) frames.insert(at.first);
    for (const int frame : frames) {
      for (int f = std::max(0, frame - pad); f <= std::min(clip_.frames() - 1, frame + 1 + pad); ++f) {
        in_window_[static_cast<std::size_t>(f)] = 1;
      }
    }
    if (loops_) {
      const std::size_t last = in_window_.size() - 1;
      in_window_[0] = in_window_[last] = static_cast<char>(in_window_[0] | in_window_[last]);
    }
  }
  std::vector<int> whole_frames_in_window() const {
    std::vector<int> out;
    for (int f = 0; f < clip_.frames(); ++f) {
      if (in_window_[static_cast<std::size_t>(f)] != 0) out.push_back(f);
    }
    return out;
  }
  // And those between two that have been looked at.
  std::vector<double> frames_in_window() const {
    std::set<double> out;
    for (const int f : whole_frames_in_window()) out.insert(f);
    for (const auto& [place, pushes] : pushes_.all()) out.insert(place.frame);
    return {out.begin(), out.end()};
  }

  std::vector<Wish> wishes(double weight) const {
    std::vector<Wish> out;
    pushes_.add_wishes(weight, turns_, out);
    if (loops_) {
      for (Index j = 0; j < clip_.count(); ++j) {
        for (int k = 0; k < 3; ++k) {
          const Vec3 axis = Vec3::Unit(k);
          out.push_back({{{0, j, axis}, {clip_.frames() - 1, j, -axis}}, 0, kWishMost, kWishMost});
        }
      }
    }
    for (const auto& [at, turn] : led_) {
      out.push_back({{{at.first, at.second, turn.normalized()}}, turn.norm(), weight, 0});
    }
    for (const int f : whole_frames_in_window()) add_pins(clip_, feet_, f, height_, turns_, out);
    return out;
  }

  double greatest_turn(const MendedEvent& event) const {
    double most = 0;
    for (int f = event.from; f <= event.to; ++f) {
      for (Index j = 0; j < clip_.count(); ++j) {
        most = std::max(most, turns_[static_cast<std::size_t>(f) * clip_.count() + j].norm());
      }
    }
    return most * 180 / std::numbers::pi;
  }

  // Events that get no better are led out by trial, once, and then left as they are. False where there is none.
  bool give_up(const std::vector<Meeting>& now, int round, bool is_last,
               const std::function<void(const std::string&)>& told) {
    best_left_.resize(events_.size(), HUGE_VAL);
    best_round_.resize(events_.size(), 0);
    was_led_.resize(events_.size(), 0);
    std::vector<std::size_t> stuck;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      if (!is_wanted(events_[e])) continue;
      double left = 0;
      for (const Meeting& m : now) {
        if (is_fault(m.found.kind) && is_in(place_of(m), events_[e])) left += double{m.found.depth};
      }
      if (left < 0.9 * best_left_[e]) {
        best_left_[e] = left;
        best_round_[e] = round;
      }
      if (left > 0 && (is_last || round - best_round_[e] >= kPatience)) stuck.push_back(e);
    }
    for (const std::size_t e : stuck) {
      if (was_led_[e] != 0 || !lead_out(e, round, told)) events_[e].outcome = Outcome::kOverBudget;
    }
    for (const std::size_t e : stuck) {
      if (is_wanted(events_[e])) continue;
      pushes_.forget([&](const MeetingPlace& place) { return is_in(place, events_[e]); });
    }
    return !stuck.empty();
  }

  // The joints that move one of two parts and not the other, of the cheap ones, and none that a foot hangs on.
  std::set<Index> joints_between(std::uint32_t a, std::uint32_t b) const {
    std::set<Index> one(joints_of_part_[a].begin(), joints_of_part_[a].end()),
        other(joints_of_part_[b].begin(), joints_of_part_[b].end()), all;
    std::set_symmetric_difference(one.begin(), one.end(), other.begin(), other.end(), std::inserter(all, all.end()));
    const auto price = [&](Index joint) { return clip_.joints()[joint].price.eigenvalues().real().minCoeff(); };
    for (const Index foot : feet_) {
      for (const Index joint : clip_.above_joint(foot)) all.erase(joint);
    }
    double least = HUGE_VAL;
    for (const Index joint : all) least = std::min(least, price(joint));
    std::erase_if(all, [&](Index joint) { return price(joint) > 2.1 * least; });
    return all;
  }

  // By trial, with all events that it shares joints and time with. False where no joint can.
  bool lead_out(std::size_t first, int round, const std::function<void(const std::string&)>& told) {
    LimbInTrouble limb{{}, events_[first].from, events_[first].to, 0};
    std::set<Index> joints = joints_between(events_[first].part_a, events_[first].part_b);
    if (joints.empty()) return false;
    std::set<std::size_t> group{first};
    for (bool grows = true; grows;) {
      grows = false;
      for (std::size_t e = 0; e < events_.size(); ++e) {
        const MendedEvent& event = events_[e];
        if (!is_wanted(event) || was_led_[e] != 0 || group.contains(e) || event.from > limb.to + 1 ||
            event.to < limb.from - 1)
          continue;
        const std::set<Index> its = joints_between(event.part_a, event.part_b);
        if (std::none_of(its.begin(), its.end(), [&](Index joint) { return joints.contains(joint); })) continue;
        group.insert(e);
        joints.insert(its.begin(), its.end());
        limb.from = std::min(limb.from, event.from);
        limb.to = std::max(limb.to, event.to);
        grows = true;
      }
    }
    limb.joints.assign(joints.begin(), joints.end());
    const auto moves = [&](std::uint32_t part) {
      return std::any_of(joints_of_part_[part].begin(), joints_of_part_[part].end(),
                         [&](Index j) { return joints.contains(j); });
    };
    double worst = -1;
    for (int f = limb.from; f <= limb.to; ++f) {
      double sum = 0;
      for (const std::size_t e : group) {
        const auto known = before_.find({static_cast<double>(f), events_[e].part_a, events_[e].part_b});
        if (known != before_.end()) sum += double{known->second.depth};
      }
      if (sum > worst) limb.worst = f;
      worst = std::max(worst, sum);
    }
    told(fmt::format("trying ways out of frames {} to {}", limb.from, limb.to));
    const auto judge = [&](const std::vector<TriedPose>& poses) {
      std::vector<double> out;
      for (const std::vector<Meeting>& meetings : finder_.in_poses(poses)) {
        double sum = 0;
        for (const Meeting& meeting : meetings) {
          if (!moves(meeting.found.part_a) && !moves(meeting.found.part_b)) continue;
          const double may_be = allowed(meeting);
          if (!is_let_be(meeting, may_be)) sum += too_deep(meeting, may_be);
        }
        out.push_back(sum);
      }
      return out;
    };
    const double budget = options_.budget_degrees * std::numbers::pi / 180;
    for (const auto& [frame, turns] : find_way_out(clip_, limb, budget, turns_, judge)) {
      for (const Index joint : limb.joints) {
        led_.erase({frame, joint});
        if (!turns[joint].isZero(0)) led_[{frame, joint}] = turns[joint];
      }
      jumps_[static_cast<std::size_t>(frame)] = 1;
    }
    for (const std::size_t e : group) {
      was_led_[e] = 1;
      best_left_[e] = HUGE_VAL;
      best_round_[e] = round + 1;
    }
    pushes_.forget([&](const MeetingPlace& place) {
      return place.frame >= limb.from - 1 && place.frame <= limb.to + 1 && (moves(place.part_a) || moves(place.part_b));
    });
    return true;
  }

  static bool is_in(const MeetingPlace& place, const MendedEvent& event) {
    return place.part_a == event.part_a && place.part_b == event.part_b && place.frame >= event.from - 1 &&
           place.frame <= event.to + 1;
  }

  // Where something is worse than before, joints turn back around it, softly; and where that does not help, in all that
  // lies together in time.
  void take_back_what_fails() {
    for (int turn = 0; turn <= kTapers; ++turn) {
      std::vector<char> fails(in_window_.size(), 0);
      const std::vector<int> whole = whole_frames_in_window();
      std::vector<Meeting> after = look({whole.begin(), whole.end()});
      const std::vector<Meeting> between = finder_.between(whole, turns_);
      after.insert(after.end(), between.begin(), between.end());
      bool any = false;
      for (const Meeting& meeting : after) {
        if (!is_fault(meeting.found.kind) || !is_worse(meeting)) continue;
        fails[static_cast<std::size_t>(meeting.frame)] = 1;
        any = true;
      }
      if (!any) return;
      if (turn < kTapers) {
        taper(fails, kPad * (turn + 1) / kTapers);
      } else {
        turn_back(fails);
      }
    }
  }

  // No turn within so many seconds of what fails; then all of it within as many more.
  void taper(const std::vector<char>& fails, double seconds) {
    const double pad = seconds * clip_.fps();
    for (std::size_t f = 0; f < fails.size(); ++f) {
      double near = HUGE_VAL;
      for (std::size_t g = 0; g < fails.size(); ++g) {
        if (fails[g] == 0) continue;
        const double apart = std::abs(static_cast<double>(f) - static_cast<double>(g));
        near = std::min({near, apart, loops_ ? static_cast<double>(fails.size() - 1) - apart : apart});
      }
      const double share = std::clamp((near - pad) / pad, 0.0, 1.0), smooth = share * share * (3 - 2 * share);
      for (std::size_t j = 0; j < clip_.count(); ++j) turns_[f * clip_.count() + j] *= smooth;
    }
  }

  void turn_back(std::vector<char> fails) {
    if (loops_) fails[0] = fails[fails.size() - 1] = fails_at_seam(fails);
    for (std::size_t begin = 0; begin < fails.size(); ++begin) {
      std::size_t end = begin;
      bool any = false;
      for (; end < fails.size() && in_window_[end] != 0; ++end) any |= fails[end] != 0;
      if (any) {
        std::fill(turns_.begin() + static_cast<std::ptrdiff_t>(begin * clip_.count()),
                  turns_.begin() + static_cast<std::ptrdiff_t>(end * clip_.count()), Vec3::Zero());
      }
      begin = end;
    }
  }

  // Of a loop: whether what lies together around its seam fails.
  char fails_at_seam(const std::vector<char>& fails) const {
    char any = 0;
    for (std::size_t f = 0; f < fails.size() && in_window_[f] != 0; ++f) any |= fails[f];
    for (std::size_t f = fails.size(); f-- > 0 && in_window_[f] != 0;) any |= fails[f];
    return any;
  }

  // Than the same parts were around that time.
  bool is_worse(const Meeting& meeting) const {
    double most = 0;
    for (int f = static_cast<int>(meeting.frame) - 1; f <= static_cast<int>(meeting.frame) + 2; ++f) {
      const auto known = before_.find({static_cast<double>(f), meeting.found.part_a, meeting.found.part_b});
      if (known != before_.end()) most = std::max(most, double{known->second.depth});
    }
    return double{meeting.found.depth} > most + kFoldDeeper / mm_;
  }

  void finish(Mend& out) {
    out.joints = clip_.joints();
    out.in_window = in_window_;
    std::vector<double> all;
    for (int f = 0; f < clip_.frames(); ++f) all.push_back(f);
    std::vector<Meeting> after = finder_.in_frames(all, turns_);
    const std::vector<Meeting> between = finder_.between(whole_frames_in_window(), turns_);
    after.insert(after.end(), between.begin(), between.end());
    for (MendedEvent& event : events_) {
      event.depth_after = 0;
      for (const Meeting& meeting : after) {
        if (!is_in(place_of(meeting), event) || !is_fault(meeting.found.kind)) continue;
        event.depth_after = std::max(event.depth_after, mm_ * double{meeting.found.depth});
      }
      event.turn_degrees = greatest_turn(event);
      if (event.outcome == Outcome::kAccepted || event.outcome == Outcome::kFold) continue;
      event.outcome = event.depth_after == 0                           ? Outcome::kCleared
                      : event.depth_after < kLess * event.depth_before ? Outcome::kReduced
                                                                       : Outcome::kOverBudget;
    }
    out.events = events_;
    out.turns = turns_;
    out.compared = compare(clip_, turns_, feet_, wrists_, mm_);
    for (const auto& [place, pushes] : pushes_.all()) {
      const auto known = before_.find(place);
      if (pushes.empty() || known == before_.end() || !is_fault(known->second.kind)) continue;
      if (mm_ * double{known->second.depth} > kShallow) continue;
      ++out.shallow;
      out.still_near += mm_ * pushes_.nearest(place, turns_) <= kNear ? 1 : 0;
    }
  }

  const AnimatedAsset& animated_;
  const Character& character_;
  MendOptions options_;
  double mm_, height_;
  TurnedClip clip_;
  FaultFinder finder_;
  Pushes pushes_;
  Turns turns_;
  std::vector<Index> feet_, wrists_;  // joints
  bool loops_;
  std::vector<char> in_window_;
  std::vector<char> jumps_;                    // of each frame: joints may turn far in this round
  std::map<std::pair<int, Index>, Vec3> led_;  // of a frame's joint: how far it is to turn at least
  std::vector<std::vector<Index>> joints_of_part_;
  std::map<MeetingPlace, Penetration> before_;
  std::vector<MendedEvent> events_;
  struct Seen {
    std::vector<Vec3> turns;
    std::vector<Meeting> found;
  };
  std::map<double, Seen> seen_;
  std::vector<double> best_left_;  // of each event, mm in all
  std::vector<int> best_round_;
  std::vector<char> was_led_;
};

}  // namespace

const char* outcome_name(Outcome outcome) {
  static constexpr std::array<const char*, 5> kNames{"cleared", "reduced", "over_budget", "fold", "accepted"};
  return kNames[static_cast<std::size_t>(outcome)];
}

Mend mend_clip(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
               const std::function<bool(const MendedEvent&)>& leave,
               const std::function<void(const std::string&)>& told) {
  return Mender(animated, roles, clip, options).run(leave, told);
}

}  // namespace spherechain::baker
