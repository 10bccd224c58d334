// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton over a whole clip: each two body parts that are in each other in a frame give a wish, that their deepest
// points part along the way out. Wishes of earlier rounds stay: what was pushed out once must not come back. Where that
// leads nowhere, a limb is led along a way that was tried out.
#include "fix/mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "check/clip_check.h"
#include "fix/find_faults.h"
#include "fix/goals.h"
#include "fix/joints.h"
#include "fix/obstacle.h"
#include "fix/part_joints.h"
#include "fix/pins.h"
#include "fix/pushes.h"
#include "fix/solve.h"
#include "fix/spans.h"
#include "fix/ways_out.h"

namespace spherechain::baker {
namespace {

constexpr int kRounds = 24;
constexpr int kPatience = 3;      // rounds that an event may take without getting better
constexpr int kFreeRounds = 4;    // at most, once there is no fault, in which joints go back as far as they can
constexpr int kLookBetween = 4;   // rounds, while there are faults in frames
constexpr int kTapers = 3;        // tries to take back softly what got worse
constexpr double kStep = 10;      // degrees that a joint turns in a round, at most
constexpr double kSmoothest = 4;  // frames
constexpr double kStill = 1;      // degrees: a round that turns joints by less may be the last
constexpr double kLeave = 3;      // of a turn from where the round starts, while there is a fault
constexpr double kPad = 0.35;     // seconds around an event in which joints turn, too
constexpr double kShallow = 10;   // mm
constexpr double kNear = 5;       // mm
constexpr double kLess = 0.8;     // of its depth: an event is reduced
constexpr double kBetter = 0.9;   // of what is left: it gets better
constexpr double kTie = 1e7;      // of a loop's ends
constexpr double kWish = 1e4, kWishMost = 1e5;  // the weight of pushes grows by round

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

class Mender {
 public:
  Mender(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
         const std::function<bool(const MendedEvent&)>& leave, const std::function<void(const std::string&)>& told)
      : animated_(animated),
        options_(options),
        told_(told),
        mm_(mm_per_unit(animated.asset())),
        height_(animated.frame().height),
        clip_(animated.character().rig, *clip.clip, clip.fps, clip.own_count,
              turning_joints(animated.character().rig, roles, *clip.clip)),
        finder_(animated, clip_),
        pushes_(animated, clip_),
        turns_(static_cast<std::size_t>(clip.own_count) * clip_.count(), Vec3::Zero()),
        feet_(joints_of_role(clip_.joints(), roles, "ankle")),
        wrists_(joints_of_role(clip_.joints(), roles, "wrist")),
        planted_(planted_hands(clip_, wrists_, feet_, animated.frame().up, height_)),
        grips_(wrists_.size() == 2 ? gripping_frames(clip_, wrists_[0], wrists_[1], height_)
                                   : std::vector<char>(static_cast<std::size_t>(clip.own_count), 0)),
        parts_(animated, clip_, feet_),
        loops_(same_pose(clip_.pose(0, turns_).deformation, clip_.pose(clip_.frames() - 1, turns_).deformation,
                         animated.frame())),
        in_window_(static_cast<std::size_t>(clip.own_count), 0),
        jumps_(in_window_),
        goals_(look_at_all(), clip.own_count, mm_, options.margin_mm, leave),
        progress_(goals_.events.size()) {
    finder_.leave_out(goals_.harmless());
  }

  Mend run() {
    Mend out;
    double moved = 0;
    bool was_free = false;
    int free_rounds = 0;
    for (int round = 0; round < kRounds && (!is_idle() || moved > radians(kStill)); ++round) {
      std::vector<Meeting> now = finder_.in_frames(frames_in_window(round), turns_);
      touches_ = false;
      double badness = add_pushes(now);
      if (round > 0 && (badness == 0 || round % kLookBetween == kLookBetween - 1)) {
        const std::vector<Meeting> between = finder_.between(whole_frames_in_window(), turns_);
        badness += add_pushes(between);
        now.insert(now.end(), between.begin(), between.end());
        rounds_.push_back({turns_, now, in_window_});
      }
      told_(fmt::format("round {}: {:.1f} mm too deep", round + 1, badness * mm_));
      if (badness == 0 && was_free && moved < radians(kStill) && !touches_) break;
      if (badness == 0 || free_rounds > 0) {
        if (round > 0 && ++free_rounds > kFreeRounds) break;
      } else if (!go_on(now, round, badness)) {
        break;
      }
      open_windows();
      was_free = badness == 0;
      const double weight = std::min(kWish * std::pow(2, round), kWishMost);
      moved = take(solve_turns(clip_, in_window_, wishes(weight), turns_, was_free ? 0 : kLeave));
      jumps_.assign(jumps_.size(), 0);
      out.rounds = round + 1;
    }
    take_the_best_rounds();
    calm_down();
    finder_.leave_out({});
    std::vector<Meeting> after = take_back_what_fails();
    if (take_back_what_gains_nothing()) {
      after = look_again();
      judge_events(after);
    }
    finder_.leave_out(goals_.harmless());
    explain_what_is_left();
    finish(after, out);
    return out;
  }

 private:
  std::vector<Meeting> look_at_all() {
    told_("looking");
    return finder_.in_frames(all_frames(), turns_);
  }

  std::vector<double> all_frames() const {
    std::vector<double> out;
    for (int f = 0; f < clip_.frames(); ++f) out.push_back(f);
    return out;
  }

  // A joint turns a little a round, unless it is led, and never beyond the budget and its hinge. Returns the farthest
  // that one turns; radians.
  double take(const Turns& wanted) {
    const double step = radians(kStep), most = radians(options_.budget_degrees);
    double farthest = 0;
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      Vec3 to = wanted[i] - turns_[i];
      if (to.norm() > step && jumps_[i / clip_.count()] == 0) to *= step / to.norm();
      to = clip_.within_limits(static_cast<int>(i / clip_.count()), static_cast<Index>(i % clip_.count()),
                               turns_[i] + to, most);
      farthest = std::max(farthest, (to - turns_[i]).norm());
      turns_[i] = to;
    }
    return farthest;
  }

  bool is_idle() const { return std::none_of(goals_.events.begin(), goals_.events.end(), Goals::is_wanted); }

  // Wishes for what is too deep; returns by how much in all.
  double add_pushes(const std::vector<Meeting>& meetings) {
    double sum = 0;
    for (const Meeting& meeting : meetings) {
      if (goals_.is_let_be(meeting)) continue;
      sum += goals_.too_deep(meeting);
      touches_ |= mm_ * double{meeting.found.measures.depth} > options_.margin_mm;
      const Penetration* before = goals_.before(place_of(meeting));
      const bool is_shallow = before != nullptr && mm_ * double{before->measures.depth} <= kShallow;
      pushes_.add(place_of(meeting), meeting.found, -goals_.allowed(meeting), is_shallow, turns_);
    }
    return sum;
  }

  void open_windows() {
    in_window_.assign(in_window_.size(), 0);
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
  // And those between two that have been looked at. In the first round all.
  std::vector<double> frames_in_window(int round) const {
    if (round == 0) return all_frames();
    std::set<double> out;
    for (const int f : whole_frames_in_window()) out.insert(f);
    for (const auto& [place, pushes] : pushes_.all()) out.insert(place.frame);
    return {out.begin(), out.end()};
  }

  std::vector<Wish> wishes(double weight) const {
    std::vector<Wish> out;
    pushes_.add_wishes(weight, turns_, out);
    for (const auto& [at, turn] : led_) {
      out.push_back({{{at.first, at.second, turn.normalized()}}, turn.norm(), weight, 0});
    }
    if (loops_) {
      for (Index j = 0; j < clip_.count(); ++j) {
        for (int k = 0; k < 3; ++k) {
          const Vec3 axis = Vec3::Unit(k);
          out.push_back({{{0, j, axis}, {clip_.frames() - 1, j, -axis}}, 0, kTie, kTie});
        }
      }
    }
    for (const int f : whole_frames_in_window()) {
      add_pins(clip_, feet_, f, height_, turns_, out);
      add_pins(clip_, planted_[static_cast<std::size_t>(f)], f, height_, turns_, out);
      if (grips_[static_cast<std::size_t>(f)] != 0) {
        add_grip(clip_, wrists_[0], wrists_[1], f, height_, turns_, out);
      }
      add_limits(clip_, feet_, f, out);
    }
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

  // Events that get no better are led out by trial, once; those that do not get better at all are left as they are.
  // False where nothing gets better any more.
  bool go_on(const std::vector<Meeting>& now, int round, double badness) {
    std::vector<std::size_t> stuck;
    for (std::size_t e = 0; e < goals_.events.size(); ++e) {
      if (!Goals::is_wanted(goals_.events[e])) continue;
      double left = 0;
      for (const Meeting& m : now) {
        if (is_fault(m.found.kind) && Goals::is_in(place_of(m), goals_.events[e]))
          left += double{m.found.measures.depth};
      }
      if (round == 0) progress_[e].begin = left;
      if (progress_[e].gets_better(left, round) || left == 0) continue;
      if (round - progress_[e].round >= kPatience) stuck.push_back(e);
    }
    in_all_.gets_better(badness, round);
    for (const std::size_t e : stuck) {
      if (!progress_[e].was_led && lead_out(e, round)) in_all_ = {0, HUGE_VAL, round + 1};
      if (progress_[e].least < kLess * progress_[e].begin || progress_[e].round > round) continue;
      goals_.events[e].outcome = Outcome::kOverBudget;
      pushes_.forget([&](const MeetingPlace& place) { return Goals::is_in(place, goals_.events[e]); });
    }
    return round - in_all_.round < 2 * kPatience;
  }

  // By trial, with all that it shares joints and time with. False where no joint can.
  bool lead_out(std::size_t event, int round) {
    const auto is_open = [&](std::size_t e) { return Goals::is_wanted(goals_.events[e]) && !progress_[e].was_led; };
    const LimbInTrouble limb = limb_in_trouble(goals_, parts_, event, is_open);
    progress_[event].was_led = true;
    if (limb.joints.empty()) return false;
    told_(fmt::format("trying ways out of frames {} to {}", limb.from, limb.to));
    const auto judge = [&](const std::vector<TriedPose>& poses) { return left_in(poses, limb); };
    Turns start(turns_.size(), Vec3::Zero());
    for (const auto& [at, turn] : led_) start[static_cast<std::size_t>(at.first) * clip_.count() + at.second] = turn;
    for (const auto& [frame, turns] : find_way_out(clip_, limb, radians(options_.budget_degrees), start, judge)) {
      for (const Index joint : limb.joints) {
        led_.erase({frame, joint});
        if (!turns[joint].isZero(0)) led_[{frame, joint}] = turns[joint];
      }
      jumps_[static_cast<std::size_t>(frame)] = 1;
    }
    for (const std::size_t e : limb.events) progress_[e] = {progress_[e].begin, HUGE_VAL, round + 1, true};
    pushes_.forget([&](const MeetingPlace& place) {
      const bool is_its = limb.moves[place.part] != 0 || limb.moves[place.other] != 0;
      return is_its && place.frame >= limb.from - 1 && place.frame <= limb.to + 1;
    });
    return true;
  }

  // For each run of frames, takes the round with the least penetration; among equal rounds the last one.
  void take_the_best_rounds() {
    for (MendedEvent& event : goals_.events) {
      if (event.outcome == Outcome::kOverBudget) event.outcome = Outcome::kReduced;
    }
    std::vector<std::vector<double>> left;  // of each round and frame
    for (const Round& round : rounds_) {
      left.emplace_back(in_window_.size(), 0);
      for (const Meeting& m : round.found) left.back()[static_cast<std::size_t>(m.frame)] += goals_.too_deep(m);
    }
    turns_.assign(turns_.size(), Vec3::Zero());
    for (const std::vector<std::size_t>& span : spans_of(in_window_, loops_)) {
      double least = HUGE_VAL;
      for (std::size_t r = 0; r < rounds_.size(); ++r) {
        double sum = 0;
        for (const std::size_t f : span) sum += left[r][f];
        if (sum > least) continue;
        least = sum;
        for (const std::size_t f : span) {
          for (std::size_t i = f * clip_.count(); i < (f + 1) * clip_.count(); ++i) turns_[i] = rounds_[r].turns[i];
        }
      }
    }
  }

  // Shaking is worse than penetrating: smooths the corrections, and fades them out at joints that still shake.
  void calm_down() {
    for (const std::vector<std::size_t>& span : spans_of(in_window_, loops_)) {
      std::set<Index> joints = shaking_joints(clip_, span, turns_, height_);
      for (double frames = 1; frames <= kSmoothest && !joints.empty(); frames *= 2) {
        for (const Index joint : joints) smooth(clip_, joint, span, frames, loops_, turns_);
        joints = shaking_joints(clip_, span, turns_, height_);
      }
      for (const Index joint : joints) {
        for (const std::size_t f : span) turns_[f * clip_.count() + joint].setZero();
      }
    }
  }

  // In all frames, and between those that may have changed.
  std::vector<Meeting> look_again() {
    std::vector<Meeting> out = finder_.in_frames(all_frames(), turns_);
    const std::vector<Meeting> between = finder_.between(whole_frames_in_window(), turns_);
    out.insert(out.end(), between.begin(), between.end());
    return out;
  }

  // Where something is worse than before, the joints that move it turn back around it, softly; and where that does not
  // help, in all that lies together in time. So do joints that turned for nothing.
  std::vector<Meeting> take_back_what_fails() {
    for (int turn = 0; turn <= kTapers; ++turn) {
      std::vector<Meeting> after = look_again();
      judge_events(after);
      std::map<Index, std::vector<char>> fails;  // of a joint: the frames
      const auto fail = [&](Index joint, int from, int to) {
        std::vector<char>& frames = fails.try_emplace(joint, in_window_.size(), 0).first->second;
        for (int f = from; f <= to; ++f) frames[static_cast<std::size_t>(f)] = 1;
      };
      for (const Meeting& meeting : after) {
        if (!goals_.is_worse(meeting)) continue;
        const int frame = static_cast<int>(meeting.frame);
        for (const std::uint32_t part : {meeting.found.part, meeting.found.other}) {
          for (const Index joint : parts_.above(part)) fail(joint, frame, frame);
        }
      }
      for (std::size_t e = 0; e < goals_.events.size(); ++e) {
        if (goals_.events[e].outcome != Outcome::kOverBudget || goals_.events[e].turn_degrees == 0) continue;
        const auto has_outcome = [&](std::size_t i) {
          return goals_.events[i].outcome != Outcome::kAccepted && goals_.events[i].outcome != Outcome::kFold;
        };
        const LimbInTrouble limb = limb_in_trouble(goals_, parts_, e, has_outcome);
        const auto is_for_nothing = [&](std::size_t i) { return goals_.events[i].outcome == Outcome::kOverBudget; };
        if (!std::all_of(limb.events.begin(), limb.events.end(), is_for_nothing)) continue;
        for (const Index joint : limb.joints) {
          if (turns_in(goals_.events[e], joint)) fail(joint, goals_.events[e].from, goals_.events[e].to);
        }
      }
      if (fails.empty()) return after;
      for (const auto& [joint, frames] : fails) {
        if (turn < kTapers) {
          taper(clip_, joint, frames, kPad * (turn + 1) / kTapers, loops_, turns_);
          continue;
        }
        for (const std::vector<std::size_t>& span : spans_of(in_window_, loops_)) {
          if (std::none_of(span.begin(), span.end(), [&](std::size_t f) { return frames[f] != 0; })) continue;
          for (const std::size_t f : span) turns_[f * clip_.count() + joint].setZero();
        }
      }
    }
    std::vector<Meeting> after = look_again();
    judge_events(after);
    return after;
  }

  // Joints turn back in each span of time in which no event is cleared or reduced. False where none had turned there.
  bool take_back_what_gains_nothing() {
    bool turned = false;
    for (const std::vector<std::size_t>& span : spans_of(in_window_, loops_)) {
      const auto gains = [&](const MendedEvent& event) {
        const bool is_better = event.outcome == Outcome::kCleared || event.outcome == Outcome::kReduced;
        const auto is_in = [&](std::size_t f) {
          return f >= static_cast<std::size_t>(event.from) && f <= static_cast<std::size_t>(event.to);
        };
        return is_better && std::any_of(span.begin(), span.end(), is_in);
      };
      if (std::any_of(goals_.events.begin(), goals_.events.end(), gains)) continue;
      for (const std::size_t f : span) {
        for (std::size_t i = f * clip_.count(); i < (f + 1) * clip_.count(); ++i) {
          turned = turned || !turns_[i].isZero(0);
          turns_[i].setZero();
        }
      }
    }
    return turned;
  }

  bool turns_in(const MendedEvent& event, Index joint) const {
    for (int f = event.from; f <= event.to; ++f) {
      if (!turns_[static_cast<std::size_t>(f) * clip_.count() + joint].isZero(0)) return true;
    }
    return false;
  }

  void judge_events(const std::vector<Meeting>& after) {
    for (MendedEvent& event : goals_.events) {
      event.depth_after = 0;
      for (const Meeting& meeting : after) {
        if (!Goals::is_in(place_of(meeting), event) || !is_fault(meeting.found.kind)) continue;
        event.depth_after = std::max(event.depth_after, mm_ * double{meeting.found.measures.depth});
      }
      event.turn_degrees = greatest_turn(event);
      if (event.outcome == Outcome::kAccepted || event.outcome == Outcome::kFold) continue;
      event.outcome = event.depth_after == 0                           ? Outcome::kCleared
                      : event.depth_after < kLess * event.depth_before ? Outcome::kReduced
                                                                       : Outcome::kOverBudget;
    }
  }

  void explain_what_is_left() {
    std::map<std::size_t, Outcome> reasons;
    for (std::size_t e = 0; e < goals_.events.size(); ++e) {
      if (goals_.events[e].outcome == Outcome::kOverBudget) reasons[e] = Outcome::kNoWayOut;
    }
    for (const auto& [e, reason] : reasons) goals_.events[e].outcome = Outcome::kReduced;  // all are wanted again
    for (auto& [e, reason] : reasons) reason = reason_of(e);
    for (const auto& [e, reason] : reasons) goals_.events[e].outcome = reason;
  }

  // Why an event is about as deep as it was.
  Outcome reason_of(std::size_t e) {
    MendedEvent& event = goals_.events[e];
    const auto is_left = [&](const Meeting& m) { return is_fault(m.found.kind) && Goals::is_in(place_of(m), event); };
    const bool was_out = std::any_of(rounds_.begin(), rounds_.end(), [&](const Round& round) {
      const auto first = round.looked_at.begin() + event.from, end = round.looked_at.begin() + event.to + 1;
      return std::find(first, end, 0) == end && std::none_of(round.found.begin(), round.found.end(), is_left);
    });
    const auto is_open = [&](std::size_t i) {
      return goals_.events[i].outcome != Outcome::kAccepted && goals_.events[i].outcome != Outcome::kFold;
    };
    const LimbInTrouble limb = limb_in_trouble(goals_, parts_, e, is_open);
    if (was_out || limb.joints.empty()) return Outcome::kNoWayOut;  // that way was taken back
    told_(fmt::format("asking why frame {} is not free", event.worst));
    const auto judge = [&](const std::vector<TriedPose>& poses) { return left_in(poses, limb); };
    const Obstacle obstacle = find_obstacle(clip_, limb, event.worst, options_.budget_degrees, judge);
    event.needed_degrees = obstacle.needed_degrees;
    return obstacle.outcome;
  }

  // How much of a limb is in others in each pose; heights.
  std::vector<double> left_in(const std::vector<TriedPose>& poses, const LimbInTrouble& limb) {
    std::vector<double> out;
    for (const std::vector<Meeting>& meetings : finder_.in_poses(poses, limb.moves)) {
      out.push_back(0);
      for (const Meeting& meeting : meetings) out.back() += goals_.too_deep(meeting) / height_;
    }
    return out;
  }

  void finish(const std::vector<Meeting>& after, Mend& out) {
    out.joints = clip_.joints();
    out.in_window = in_window_;
    out.events = goals_.events;
    out.turns = turns_;
    out.compared = compare(clip_, turns_, feet_, wrists_, mm_);
    for (const Meeting& meeting : after) out.volume_after += volume_of(meeting.frame, meeting.found, turns_);
    const Turns none(turns_.size(), Vec3::Zero());
    for (const auto& [place, before] : goals_.before()) {
      out.volume_before += volume_of(place.frame, before, none);
      const auto pushes = pushes_.all().find(place);
      if (pushes == pushes_.all().end() || pushes->second.empty() || !is_fault(before.kind)) continue;
      if (mm_ * double{before.measures.depth} > kShallow) continue;
      ++out.shallow;
      const Deformation pose = clip_.pose(place.frame, turns_).deformation;
      const double apart = mm_ * distance_between(animated_, pose, place.part, place.other);
      out.still_near += apart <= kNear ? 1 : 0;
    }
  }

  // How much of two parts that are to be mended is in each other in a whole frame, cm3.
  double volume_of(double frame, const Penetration& found, const Turns& turns) {
    const MendedEvent* event = goals_.event_at({frame, found.part, found.other});
    const bool is_its = event != nullptr && event->outcome != Outcome::kAccepted && event->outcome != Outcome::kFold;
    if (!is_its || frame != std::floor(frame)) return 0;
    return finder_.volume(frame, found, turns) * std::pow(mm_ / 10, 3);
  }

  const AnimatedAsset& animated_;
  MendOptions options_;
  const std::function<void(const std::string&)>& told_;
  double mm_, height_;
  TurnedClip clip_;
  FaultFinder finder_;
  Pushes pushes_;
  Turns turns_;
  std::vector<Index> feet_, wrists_;         // joints
  std::vector<std::vector<Index>> planted_;  // of each frame: hands that stand on the ground
  std::vector<char> grips_;                  // of each frame: hands hold one thing
  PartJoints parts_;
  bool loops_, touches_ = false;  // what is to part is not yet out
  std::vector<char> in_window_;
  std::vector<char> jumps_;  // of each frame: joints may turn far in this round
  Goals goals_;
  std::map<std::pair<int, Index>, Vec3> led_;  // of a frame's joint: how far it is to turn at least
  struct Progress {
    double begin = 0, least = HUGE_VAL;  // depths of all frames
    int round = 0;                       // of the least
    bool was_led = false;

    bool gets_better(double left, int now) {
      if (left >= kBetter * least) return false;
      least = left;
      round = now;
      return true;
    }
  };
  std::vector<Progress> progress_;  // of each event
  Progress in_all_;
  struct Round {
    Turns turns;
    std::vector<Meeting> found;
    std::vector<char> looked_at;  // of each frame
  };
  std::vector<Round> rounds_;
};

}  // namespace

const char* outcome_name(Outcome outcome) {
  static constexpr std::array<const char*, 7> kNames{"cleared",     "reduced",      "fold",      "accepted",
                                                     "over_budget", "joint_limits", "no_way_out"};
  return kNames[static_cast<std::size_t>(outcome)];
}

Mend mend_clip(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
               const std::function<bool(const MendedEvent&)>& leave,
               const std::function<void(const std::string&)>& told) {
  return Mender(animated, roles, clip, options, leave, told).run();
}

}  // namespace spherechain::baker
