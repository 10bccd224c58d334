// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton over a whole clip. Each penetration of two body parts in a frame adds a constraint: their deepest points
// separate along the way out. Constraints of earlier rounds stay, so that separated parts do not come back. If an event
// gets no better, a search by trial gives its limb target turns.
#include "baker/fix/mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "baker/fix/constraints.h"
#include "baker/fix/find_faults.h"
#include "baker/fix/goals.h"
#include "baker/fix/joints.h"
#include "baker/fix/obstacle.h"
#include "baker/fix/part_joints.h"
#include "baker/fix/separations.h"
#include "baker/fix/solve.h"
#include "baker/fix/time_windows.h"
#include "baker/fix/ways_out.h"
#include "baker/motion/same_pose.h"

namespace spherechain::baker {
namespace {

constexpr int kRounds = 24;
constexpr int kPatience = 3;         // rounds without progress before an event counts as stuck
constexpr int kFreeRounds = 4;       // rounds without faults in which joints return as far as they can
constexpr int kLookBetween = 4;      // rounds from one check between frames to the next, while frames have faults
constexpr int kFadeOuts = 3;         // tries to fade out turns that made something worse
constexpr double kStepLimit = 10;    // degrees: step limit of a joint in a round
constexpr double kSmoothingMax = 4;  // frames
constexpr double kStill = 1;         // degrees: a round with smaller steps may be the last
constexpr double kLeave = 3;         // cost of leaving the turns at the start of a round, while there is a fault
constexpr double kPad = 0.35;        // seconds around an event in which joints may turn
constexpr double kShallow = 10;      // mm
constexpr double kNear = 5;          // mm
constexpr double kLess = 0.8;        // an event counts as reduced below this share of its depth
constexpr double kBetter = 0.9;      // an event gets better below this share of the residual
constexpr double kTie = 1e7;         // weight that keeps a loop's ends equal
constexpr double kConstraintWeight = 1e4, kConstraintWeightMax = 1e5;  // weight of separations; it doubles each round

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

class Mender {
 public:
  Mender(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
         const std::function<bool(const MendedEvent&)>& leave, const std::function<void(const std::string&)>& report)
      : animated_(animated),
        options_(options),
        report_(report),
        mm_(mm_per_unit(animated.asset())),
        height_(animated.frame().height),
        clip_(animated.character().rig, *clip.clip, clip.fps, clip.own_count,
              turning_joints(animated.character().rig, roles, *clip.clip)),
        finder_(animated, clip_),
        separations_(animated, clip_),
        turns_(static_cast<std::size_t>(clip.own_count) * clip_.count(), Vec3::Zero()),
        feet_(joints_of_role(clip_.joints(), roles, "ankle")),
        wrists_(joints_of_role(clip_.joints(), roles, "wrist")),
        planted_(planted_hands(clip_, wrists_, feet_, animated.frame().up, height_)),
        hands_joined_(wrists_.size() == 2 ? frames_with_joined_hands(clip_, wrists_[0], wrists_[1], height_)
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
      std::vector<PosePenetration> now = finder_.in_frames(frames_in_window(round), turns_);
      touches_ = false;
      double badness = add_separations(now);
      if (round > 0 && (badness == 0 || round % kLookBetween == kLookBetween - 1)) {
        const std::vector<PosePenetration> between = finder_.between(whole_frames_in_window(), turns_);
        badness += add_separations(between);
        now.insert(now.end(), between.begin(), between.end());
        rounds_.push_back({turns_, now, in_window_});
      }
      report_(fmt::format("round {}: {:.1f} mm too deep", round + 1, badness * mm_));
      if (badness == 0 && was_free && moved < radians(kStill) && !touches_) break;
      if (badness == 0 || free_rounds > 0) {
        if (round > 0 && ++free_rounds > kFreeRounds) break;
      } else if (!go_on(now, round, badness)) {
        break;
      }
      open_windows();
      was_free = badness == 0;
      const double weight = std::min(kConstraintWeight * std::pow(2, round), kConstraintWeightMax);
      moved = apply_limited_step(solve_turns(clip_, in_window_, constraints(weight), turns_, was_free ? 0 : kLeave));
      jumps_.assign(jumps_.size(), 0);
      out.rounds = round + 1;
    }
    take_the_best_rounds();
    calm_down();
    finder_.leave_out({});
    std::vector<PosePenetration> after = take_back_what_fails();
    if (take_back_what_gains_nothing()) {
      after = look_again();
      classify_events(after);
    }
    finder_.leave_out(goals_.harmless());
    explain_what_is_left();
    finish(after, out);
    return out;
  }

 private:
  std::vector<PosePenetration> look_at_all() {
    report_("looking");
    return finder_.in_frames(all_frames(), turns_);
  }

  std::vector<double> all_frames() const {
    std::vector<double> out;
    for (int f = 0; f < clip_.frames(); ++f) out.push_back(f);
    return out;
  }

  // Moves the turns towards `wanted`: within the step limit (except in frames with new target turns), the budget and
  // the hinges. Returns the largest step in radians.
  double apply_limited_step(const Turns& wanted) {
    const double step = radians(kStepLimit), most = radians(options_.budget_degrees);
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

  // Adds separations for penetrations that are too deep. Returns the sum of their residuals.
  double add_separations(const std::vector<PosePenetration>& penetrations) {
    double sum = 0;
    for (const PosePenetration& penetration : penetrations) {
      if (goals_.is_let_be(penetration)) continue;
      sum += goals_.too_deep(penetration);
      touches_ |= mm_ * double{penetration.found.measures.depth} > options_.margin_mm;
      const Penetration* before = goals_.before(place_of(penetration));
      const bool is_shallow = before != nullptr && mm_ * double{before->measures.depth} <= kShallow;
      separations_.add(place_of(penetration), penetration.found, -goals_.allowed(penetration), is_shallow, turns_);
    }
    return sum;
  }

  void open_windows() {
    in_window_.assign(in_window_.size(), 0);
    const int pad = static_cast<int>(std::ceil(kPad * clip_.fps()));
    std::set<int> frames;
    for (const auto& [place, separations] : separations_.all()) frames.insert(static_cast<int>(place.frame));
    for (const auto& [at, turn] : target_turns_) frames.insert(at.first);
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
  // Frames in windows, and times between frames that have separations. In the first round, all frames.
  std::vector<double> frames_in_window(int round) const {
    if (round == 0) return all_frames();
    std::set<double> out;
    for (const int f : whole_frames_in_window()) out.insert(f);
    for (const auto& [place, separations] : separations_.all()) out.insert(place.frame);
    return {out.begin(), out.end()};
  }

  std::vector<Constraint> constraints(double weight) const {
    std::vector<Constraint> out;
    separations_.add_constraints(weight, turns_, out);
    for (const auto& [at, turn] : target_turns_) {
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
      add_pinned_joints(clip_, feet_, f, height_, turns_, out);
      add_pinned_joints(clip_, planted_[static_cast<std::size_t>(f)], f, height_, turns_, out);
      if (hands_joined_[static_cast<std::size_t>(f)] != 0) {
        add_hand_constraint(clip_, wrists_[0], wrists_[1], f, height_, turns_, out);
      }
      add_hinge_limits(clip_, feet_, f, out);
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

  // Searches a way out for events without progress, once. Gives up events that never improved. Returns false if no
  // event makes progress.
  bool go_on(const std::vector<PosePenetration>& now, int round, double badness) {
    std::vector<std::size_t> stuck;
    for (std::size_t e = 0; e < goals_.events.size(); ++e) {
      if (!Goals::is_wanted(goals_.events[e])) continue;
      double left = 0;
      for (const PosePenetration& m : now) {
        if (is_fault(m.found.kind) && Goals::is_in(place_of(m), goals_.events[e]))
          left += double{m.found.measures.depth};
      }
      if (round == 0) progress_[e].begin = left;
      if (progress_[e].gets_better(left, round) || left == 0) continue;
      if (round - progress_[e].round >= kPatience) stuck.push_back(e);
    }
    in_all_.gets_better(badness, round);
    for (const std::size_t e : stuck) {
      if (!progress_[e].was_searched && search_way_out(e, round)) in_all_ = {0, HUGE_VAL, round + 1};
      if (progress_[e].least < kLess * progress_[e].begin || progress_[e].round > round) continue;
      goals_.events[e].outcome = MendOutcome::kOverBudget;
      separations_.forget([&](const PenetrationKey& place) { return Goals::is_in(place, goals_.events[e]); });
    }
    return round - in_all_.round < 2 * kPatience;
  }

  // Searches target turns by trial for an event and all events that share its joints and frames. False if no joint can
  // turn.
  bool search_way_out(std::size_t event, int round) {
    const auto is_open = [&](std::size_t e) {
      return Goals::is_wanted(goals_.events[e]) && !progress_[e].was_searched;
    };
    const LimbInTrouble limb = limb_in_trouble(goals_, parts_, event, is_open);
    progress_[event].was_searched = true;
    if (limb.joints.empty()) return false;
    report_(fmt::format("trying ways out of frames {} to {}", limb.from, limb.to));
    const auto evaluate = [&](const std::vector<TriedPose>& poses) { return left_in(poses, limb); };
    Turns start(turns_.size(), Vec3::Zero());
    for (const auto& [at, turn] : target_turns_)
      start[static_cast<std::size_t>(at.first) * clip_.count() + at.second] = turn;
    for (const auto& [frame, turns] : find_way_out(clip_, limb, radians(options_.budget_degrees), start, evaluate)) {
      for (const Index joint : limb.joints) {
        target_turns_.erase({frame, joint});
        if (!turns[joint].isZero(0)) target_turns_[{frame, joint}] = turns[joint];
      }
      jumps_[static_cast<std::size_t>(frame)] = 1;
    }
    for (const std::size_t e : limb.events) progress_[e] = {progress_[e].begin, HUGE_VAL, round + 1, true};
    separations_.forget([&](const PenetrationKey& place) {
      const bool is_its = limb.moves[place.part] != 0 || limb.moves[place.other] != 0;
      return is_its && place.frame >= limb.from - 1 && place.frame <= limb.to + 1;
    });
    return true;
  }

  // For each run of frames, takes the round with the least penetration; among equal rounds the last one.
  void take_the_best_rounds() {
    for (MendedEvent& event : goals_.events) {
      if (event.outcome == MendOutcome::kOverBudget) event.outcome = MendOutcome::kReduced;
    }
    std::vector<std::vector<double>> left;  // by round and frame
    for (const Round& round : rounds_) {
      left.emplace_back(in_window_.size(), 0);
      for (const PosePenetration& m : round.found) left.back()[static_cast<std::size_t>(m.frame)] += goals_.too_deep(m);
    }
    turns_.assign(turns_.size(), Vec3::Zero());
    for (const std::vector<std::size_t>& span : contiguous_runs(in_window_, loops_)) {
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
    for (const std::vector<std::size_t>& span : contiguous_runs(in_window_, loops_)) {
      std::set<Index> joints = shaking_joints(clip_, span, turns_, height_);
      for (double frames = 1; frames <= kSmoothingMax && !joints.empty(); frames *= 2) {
        for (const Index joint : joints) smooth(clip_, joint, span, frames, loops_, turns_);
        joints = shaking_joints(clip_, span, turns_, height_);
      }
      for (const Index joint : joints) {
        for (const std::size_t f : span) turns_[f * clip_.count() + joint].setZero();
      }
    }
  }

  // Measures all frames, and the times between frames that may have changed.
  std::vector<PosePenetration> look_again() {
    std::vector<PosePenetration> out = finder_.in_frames(all_frames(), turns_);
    const std::vector<PosePenetration> between = finder_.between(whole_frames_in_window(), turns_);
    out.insert(out.end(), between.begin(), between.end());
    return out;
  }

  // Fades out the turns of joints around frames that got worse than before. If that does not help, removes these turns
  // from the whole run of frames. Treats turns that improved no event alike.
  std::vector<PosePenetration> take_back_what_fails() {
    for (int turn = 0; turn <= kFadeOuts; ++turn) {
      std::vector<PosePenetration> after = look_again();
      classify_events(after);
      std::map<Index, std::vector<char>> fails;  // by joint: the failed frames
      const auto fail = [&](Index joint, int from, int to) {
        std::vector<char>& frames = fails.try_emplace(joint, in_window_.size(), 0).first->second;
        for (int f = from; f <= to; ++f) frames[static_cast<std::size_t>(f)] = 1;
      };
      for (const PosePenetration& penetration : after) {
        if (!goals_.is_worse(penetration)) continue;
        const int frame = static_cast<int>(penetration.frame);
        for (const std::uint32_t part : {penetration.found.part, penetration.found.other}) {
          for (const Index joint : parts_.above(part)) fail(joint, frame, frame);
        }
      }
      for (std::size_t e = 0; e < goals_.events.size(); ++e) {
        if (goals_.events[e].outcome != MendOutcome::kOverBudget || goals_.events[e].turn_degrees == 0) continue;
        const auto has_outcome = [&](std::size_t i) {
          return goals_.events[i].outcome != MendOutcome::kAccepted && goals_.events[i].outcome != MendOutcome::kFold;
        };
        const LimbInTrouble limb = limb_in_trouble(goals_, parts_, e, has_outcome);
        const auto is_for_nothing = [&](std::size_t i) { return goals_.events[i].outcome == MendOutcome::kOverBudget; };
        if (!std::all_of(limb.events.begin(), limb.events.end(), is_for_nothing)) continue;
        for (const Index joint : limb.joints) {
          if (turns_in(goals_.events[e], joint)) fail(joint, goals_.events[e].from, goals_.events[e].to);
        }
      }
      if (fails.empty()) return after;
      for (const auto& [joint, frames] : fails) {
        if (turn < kFadeOuts) {
          fade_out(clip_, joint, frames, kPad * (turn + 1) / kFadeOuts, loops_, turns_);
          continue;
        }
        for (const std::vector<std::size_t>& span : contiguous_runs(in_window_, loops_)) {
          if (std::none_of(span.begin(), span.end(), [&](std::size_t f) { return frames[f] != 0; })) continue;
          for (const std::size_t f : span) turns_[f * clip_.count() + joint].setZero();
        }
      }
    }
    std::vector<PosePenetration> after = look_again();
    classify_events(after);
    return after;
  }

  // Removes the turns of each run of frames in which no event is cleared or reduced. False if there were none.
  bool take_back_what_gains_nothing() {
    bool turned = false;
    for (const std::vector<std::size_t>& span : contiguous_runs(in_window_, loops_)) {
      const auto gains = [&](const MendedEvent& event) {
        const bool is_better = event.outcome == MendOutcome::kCleared || event.outcome == MendOutcome::kReduced;
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

  void classify_events(const std::vector<PosePenetration>& after) {
    for (MendedEvent& event : goals_.events) {
      event.depth_after = 0;
      for (const PosePenetration& penetration : after) {
        if (!Goals::is_in(place_of(penetration), event) || !is_fault(penetration.found.kind)) continue;
        event.depth_after = std::max(event.depth_after, mm_ * double{penetration.found.measures.depth});
      }
      event.turn_degrees = greatest_turn(event);
      if (event.outcome == MendOutcome::kAccepted || event.outcome == MendOutcome::kFold) continue;
      event.outcome = event.depth_after == 0                           ? MendOutcome::kCleared
                      : event.depth_after < kLess * event.depth_before ? MendOutcome::kReduced
                                                                       : MendOutcome::kOverBudget;
    }
  }

  void explain_what_is_left() {
    std::map<std::size_t, MendOutcome> reasons;
    for (std::size_t e = 0; e < goals_.events.size(); ++e) {
      if (goals_.events[e].outcome == MendOutcome::kOverBudget) reasons[e] = MendOutcome::kNoWayOut;
    }
    for (const auto& [e, reason] : reasons)
      goals_.events[e].outcome = MendOutcome::kReduced;  // all are to be fixed again
    for (auto& [e, reason] : reasons) reason = reason_of(e);
    for (const auto& [e, reason] : reasons) goals_.events[e].outcome = reason;
  }

  // The reason why an event stayed about as deep.
  MendOutcome reason_of(std::size_t e) {
    MendedEvent& event = goals_.events[e];
    const auto is_left = [&](const PosePenetration& m) {
      return is_fault(m.found.kind) && Goals::is_in(place_of(m), event);
    };
    const bool was_out = std::any_of(rounds_.begin(), rounds_.end(), [&](const Round& round) {
      const auto first = round.looked_at.begin() + event.from, end = round.looked_at.begin() + event.to + 1;
      return std::find(first, end, 0) == end && std::none_of(round.found.begin(), round.found.end(), is_left);
    });
    const auto is_open = [&](std::size_t i) {
      return goals_.events[i].outcome != MendOutcome::kAccepted && goals_.events[i].outcome != MendOutcome::kFold;
    };
    const LimbInTrouble limb = limb_in_trouble(goals_, parts_, e, is_open);
    if (was_out || limb.joints.empty()) return MendOutcome::kNoWayOut;  // the way out was taken back
    report_(fmt::format("asking why frame {} is not free", event.worst));
    const auto evaluate = [&](const std::vector<TriedPose>& poses) { return left_in(poses, limb); };
    const Obstacle obstacle = find_obstacle(clip_, limb, event.worst, options_.budget_degrees, evaluate);
    event.needed_degrees = obstacle.needed_degrees;
    return obstacle.outcome;
  }

  // Residual penetration of a limb in each pose, in heights.
  std::vector<double> left_in(const std::vector<TriedPose>& poses, const LimbInTrouble& limb) {
    std::vector<double> out;
    for (const std::vector<PosePenetration>& penetrations : finder_.in_poses(poses, limb.moves)) {
      out.push_back(0);
      for (const PosePenetration& penetration : penetrations) out.back() += goals_.too_deep(penetration) / height_;
    }
    return out;
  }

  void finish(const std::vector<PosePenetration>& after, Mend& out) {
    out.joints = clip_.joints();
    out.in_window = in_window_;
    out.events = goals_.events;
    out.turns = turns_;
    out.compared = compare(clip_, turns_, feet_, wrists_, mm_);
    for (const PosePenetration& penetration : after)
      out.volume_after += volume_of(penetration.frame, penetration.found, turns_);
    const Turns none(turns_.size(), Vec3::Zero());
    for (const auto& [place, before] : goals_.before()) {
      out.volume_before += volume_of(place.frame, before, none);
      const auto separations = separations_.all().find(place);
      if (separations == separations_.all().end() || separations->second.empty() || !is_fault(before.kind)) continue;
      if (mm_ * double{before.measures.depth} > kShallow) continue;
      ++out.shallow;
      const Deformation pose = clip_.pose(place.frame, turns_).deformation;
      const double apart = mm_ * distance_between(animated_, pose, place.part, place.other);
      out.still_near += apart <= kNear ? 1 : 0;
    }
  }

  // Common volume of two parts of a selected event in a whole frame, in cm3.
  double volume_of(double frame, const Penetration& found, const Turns& turns) {
    const MendedEvent* event = goals_.event_at({frame, found.part, found.other});
    const bool is_its =
        event != nullptr && event->outcome != MendOutcome::kAccepted && event->outcome != MendOutcome::kFold;
    if (!is_its || frame != std::floor(frame)) return 0;
    return finder_.volume(frame, found, turns) * std::pow(mm_ / 10, 3);
  }

  const AnimatedAsset& animated_;
  MendOptions options_;
  const std::function<void(const std::string&)>& report_;
  double mm_, height_;
  TurnedClip clip_;
  FaultFinder finder_;
  Separations separations_;
  Turns turns_;
  std::vector<Index> feet_, wrists_;         // joints
  std::vector<std::vector<Index>> planted_;  // by frame: hands that stand on the ground
  std::vector<char> hands_joined_;           // by frame: 1 if both hands hold one thing
  PartJoints parts_;
  bool loops_, touches_ = false;  // some parts are still closer than the margin
  std::vector<char> in_window_;
  std::vector<char> jumps_;  // by frame: 1 if the step limit does not apply in this round
  Goals goals_;
  std::map<std::pair<int, Index>, Vec3> target_turns_;  // by frame and joint: target turn, a lower bound
  struct Progress {
    double begin = 0, least = HUGE_VAL;  // sums of depths over all frames
    int round = 0;                       // round of the least sum
    bool was_searched = false;

    bool gets_better(double left, int now) {
      if (left >= kBetter * least) return false;
      least = left;
      round = now;
      return true;
    }
  };
  std::vector<Progress> progress_;  // by event
  Progress in_all_;
  struct Round {
    Turns turns;
    std::vector<PosePenetration> found;
    std::vector<char> looked_at;  // by frame
  };
  std::vector<Round> rounds_;
};

}  // namespace

const char* outcome_name(MendOutcome outcome) {
  static constexpr std::array<const char*, 7> kNames{"cleared",     "reduced",      "fold",      "accepted",
                                                     "over_budget", "joint_limits", "no_way_out"};
  return kNames[static_cast<std::size_t>(outcome)];
}

Mend mend_clip(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
               const std::function<bool(const MendedEvent&)>& leave,
               const std::function<void(const std::string&)>& report) {
  return Mender(animated, roles, clip, options, leave, report).run();
}

}  // namespace spherechain::baker
