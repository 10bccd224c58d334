// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton over a whole clip: each two body parts that are in each other in a frame give a wish, that their deepest
// points part along the way out. Wishes of earlier rounds stay: what was pushed out once must not come back.
#include "fix/mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "fix/find_faults.h"
#include "fix/solve.h"

namespace spherechain::baker {
namespace {

constexpr int kRounds = 16;
constexpr int kTrying = 10;      // after so many, what stays is left
constexpr int kPatience = 3;     // rounds that an event may take without getting better
constexpr int kTapers = 3;       // tries to take back softly what got worse
constexpr double kStep = 10;     // degrees that a joint turns in a round, at most
constexpr double kStill = 1;     // degrees: a round that turns joints by less may be the last
constexpr double kSame = 2e-4;   // radians: too little to look again
constexpr double kPad = 0.35;    // seconds around an event in which joints turn, too
constexpr double kShallow = 10;  // mm
constexpr double kDeeper = 0.5;  // mm: so much deeper than before is a fault, too
constexpr double kFoldDeeper = 2;  // the same of folds, which move with the joint
constexpr double kSameWay = 0.5;   // cosine
constexpr std::size_t kMemory = 4;  // pushes of a pair of parts in a frame
// Lengths, in heights.
constexpr double kArm = 0.3;        // an arm's
constexpr double kFarthest = 0.03;  // what a push asks for in a round, at most
// Weights, against a radian of a shoulder; of a miss of an arm's length.
constexpr double kWish = 1e4, kWishMost = 1e6;  // it grows by round
constexpr double kPullBack = 50;                // of what was shallow: it ends near
constexpr double kFoot = 1e6;                   // of a foot that moves

using PartPair = std::pair<std::uint32_t, std::uint32_t>;
using At = std::tuple<double, std::uint32_t, std::uint32_t>;  // frame and parts

At at_of(const Meeting& meeting) { return {meeting.frame, meeting.found.part_a, meeting.found.part_b}; }

// The deepest points, which are to part along `way`.
struct Push {
  SkinSpot a, b;
  Vec3 way;
  double target;  // how far b is to be from a along the way: negative: no deeper than that
  bool is_shallow;
};

Vec3 to_vec3(const spherechain::Vec3& v) { return {v.x, v.y, v.z}; }

class Mender {
 public:
  Mender(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options)
      : animated_(animated),
        character_(animated.character()),
        options_(options),
        mm_(mm_per_unit(animated.asset())),
        height_(animated.frame().height),
        clip_(character_.rig, *clip.clip, clip.fps, clip.own_count, turning_joints(character_.rig, roles)),
        finder_(animated, clip_),
        turns_(static_cast<std::size_t>(clip.own_count) * clip_.count(), Vec3::Zero()) {
    for (Index j = 0; j < clip_.count(); ++j) {
      const std::string& role = roles.of_node[clip_.joints()[j].node].role;
      if (role == "left_elbow" || role == "right_elbow" || role == "left_knee" || role == "right_knee") make_hinge(j);
      if (role == "left_ankle" || role == "right_ankle") feet_.push_back(j);
      if (role == "left_wrist" || role == "right_wrist") wrists_.push_back(j);
    }
  }

  Mend run(const std::function<bool(const MendedEvent&)>& leave, const std::function<void(const std::string&)>& told) {
    std::vector<double> all;
    for (int f = 0; f < clip_.frames(); ++f) all.push_back(f);
    told("looking");
    const std::vector<Meeting> before = finder_.in_frames(all, turns_);
    for (const Meeting& meeting : before) depth_before_[at_of(meeting)] = meeting.found;
    make_events(before, leave);
    finder_.leave_out(harmless(before));
    Mend out;
    Turns best = turns_;
    const double still = kStill * std::numbers::pi / 180;
    double least = HUGE_VAL, moved = 0;
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
      const bool is_last = badness == 0 || round >= kTrying;
      if (const bool gave_up = give_up(now, round, is_last); gave_up) {
        least = HUGE_VAL;
      } else if (badness == 0 && moved < still) {
        break;
      }
      open_windows();
      weight_ = std::min(kWish * std::pow(2, round), kWishMost);
      moved = take(solve_turns(clip_, in_window_, wishes(), turns_));
      out.rounds = round + 1;
    }
    turns_ = best;
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
      if (to.norm() > step) to *= step / to.norm();
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
      std::vector<Vec3> now = turns_at(frame);
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

  // In an elbow or a knee: the axis across its two bones, as the clip bends it.
  void make_hinge(Index joint) {
    Vec3 sum = Vec3::Zero(), along = Vec3::Zero();
    const Index node = clip_.joints()[joint].node;
    const SourceRig& rig = character_.rig;
    int child = -1;
    for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
      if (rig.nodes[n].parent == static_cast<int>(node) && child < 0) child = static_cast<int>(n);
    }
    if (child < 0) return;
    const Vec3 lower = rig.nodes[static_cast<std::size_t>(child)].translation;
    const Turns none(turns_.size(), Vec3::Zero());
    for (int f = 0; f < clip_.frames(); f += std::max(1, clip_.frames() / 100)) {
      Eigen::Quaterniond rotation = rig.nodes[node].rotation;
      for (const Channel& channel : clip_.clip().channels) {
        if (channel.target == node && channel.path == ChannelPath::kRotation) {
          rotation = Eigen::Quaterniond(sample(channel, f / clip_.fps()));
        }
      }
      const Vec3 upper = rotation.inverse() * rig.nodes[node].translation;
      if (upper.norm() < 1e-9 || lower.norm() < 1e-9) return;
      const Vec3 axis = upper.normalized().cross(lower.normalized());
      sum += sum.dot(axis) < 0 ? Vec3(-axis) : axis;
      along = lower.normalized();
    }
    if (sum.norm() < 1e-3) return;
    const Vec3 axis = sum.normalized();
    const Eigen::Matrix3d own = clip_.joints()[joint].price;
    constexpr double kOff = 30, kTwist = 4;
    clip_.set_price(joint, own * (kOff * Eigen::Matrix3d::Identity() - (kOff - 1) * axis * axis.transpose() -
                                  (kOff - kTwist) * along * along.transpose()));
  }

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
      if (is_in(meeting.frame, meeting.found.part_a, meeting.found.part_b, event)) return &event;
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
    const auto known = depth_before_.find({std::round(meeting.frame), meeting.found.part_a, meeting.found.part_b});
    return known == depth_before_.end() ? 0 : double{known->second.depth};
  }

  // Wishes for what is too deep; returns by how much in all.
  double add_pushes(const std::vector<Meeting>& meetings) {
    double sum = 0;
    for (const Meeting& meeting : meetings) {
      const Penetration& p = meeting.found;
      const double may_be = allowed(meeting), excess = double{p.depth} - may_be;
      const double slack =
          (is_fault(p.kind) && p.kind != SC_CLASS_DEEP_FOLD ? kDeeper : kFoldDeeper) / mm_ + 0.1 * may_be;
      if (may_be >= 0 && excess <= slack) continue;
      if (may_be >= 0 && (p.kind == SC_CLASS_REST || p.kind == SC_CLASS_SHELL || p.part_a == p.part_b)) continue;
      if (is_fault(p.kind) || may_be >= 0) sum += may_be < 0 ? double{p.depth} : excess;
      const auto known = depth_before_.find(at_of(meeting));
      const bool is_shallow = known != depth_before_.end() && mm_ * double{known->second.depth} <= kShallow;
      Push push{spot_of(p.deepest_a), spot_of(p.deepest_b), to_vec3(p.direction), -may_be, is_shallow};
      std::vector<Push>& all = pushes_[at_of(meeting)];
      if (!all.empty() && all.back().way.dot(push.way) < kSameWay && is_under_way(at_of(meeting), all)) continue;
      all.erase(std::remove_if(all.begin(), all.end(), [&](const Push& old) { return old.way.dot(push.way) < 0; }),
                all.end());
      if (all.size() == kMemory) all.erase(all.begin());
      all.push_back(push);
    }
    return sum;
  }

  // Is a way out not at its end yet? Then another is not begun.
  bool is_under_way(const At& at, const std::vector<Push>& pushes) const {
    const double frame = std::get<0>(at);
    const TurnedClip::Pose pose = clip_.pose(frame, turns_);
    const std::vector<Vec3> now = turns_at(frame);
    return std::any_of(pushes.begin(), pushes.end(),
                       [&](const Push& push) { return gap(push, pose, now) < push.target - kDeeper / mm_; });
  }

  SkinSpot spot_of(const SkinPoint& point) const {
    SkinSpot out;
    for (std::size_t k = 0; k < 3; ++k) {
      out.vertices[k] = character_.source_triangles[point.triangle][k];
      out.shares[k] = double{point.weights[k]};
    }
    return out;
  }

  void open_windows() {
    in_window_.assign(static_cast<std::size_t>(clip_.frames()), 0);
    const int pad = static_cast<int>(std::ceil(kPad * clip_.fps()));
    for (const auto& [at, pushes] : pushes_) {
      const int frame = static_cast<int>(std::get<0>(at));
      for (int f = std::max(0, frame - pad); f <= std::min(clip_.frames() - 1, frame + 1 + pad); ++f) {
        in_window_[static_cast<std::size_t>(f)] = 1;
      }
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
    for (const auto& [at, pushes] : pushes_) out.insert(std::get<0>(at));
    return {out.begin(), out.end()};
  }

  std::vector<Wish> wishes() const {
    std::vector<Wish> out;
    const double arm = kArm * height_;
    for (const auto& [at, pushes] : pushes_) {
      const double frame = std::get<0>(at);
      const TurnedClip::Pose pose = clip_.pose(frame, turns_);
      const std::vector<Vec3> now = turns_at(frame);
      for (const Push& push : pushes) {
        const SpotMotion a =
            motion_of(clip_, pose, character_.source_positions, animated_.weights(), push.a, now.data());
        const SpotMotion b =
            motion_of(clip_, pose, character_.source_positions, animated_.weights(), push.b, now.data());
        const double gap = push.way.dot(b.at - a.at);
        Wish wish;
        wish.weight = weight_ / (arm * arm);
        wish.weight_over = push.is_shallow ? kPullBack / (arm * arm) : 0;
        wish.value = std::min(push.target - gap, kFarthest * height_);
        std::map<Index, Vec3> by;
        for (const auto& [joint, moves] : b.by_joint)
          by.try_emplace(joint, Vec3::Zero()).first->second += moves.transpose() * push.way;
        for (const auto& [joint, moves] : a.by_joint)
          by.try_emplace(joint, Vec3::Zero()).first->second -= moves.transpose() * push.way;
        for (const auto& [joint, d] : by) {
          wish.value += d.dot(now[joint]);
          add_parts(wish, frame, joint, d);
        }
        out.push_back(std::move(wish));
      }
    }
    for (const int f : whole_frames_in_window()) pin_feet(f, out);
    return out;
  }

  std::vector<Vec3> turns_at(double frame) const {
    const auto first = static_cast<std::size_t>(frame);
    const std::size_t next = std::min(first + 1, static_cast<std::size_t>(clip_.frames()) - 1), count = clip_.count();
    const double share = frame - std::floor(frame);
    std::vector<Vec3> out;
    for (std::size_t j = 0; j < count; ++j) {
      out.push_back((1 - share) * turns_[first * count + j] + share * turns_[next * count + j]);
    }
    return out;
  }
  static void add_parts(Wish& wish, double frame, Index joint, const Vec3& by) {
    const double share = frame - std::floor(frame);
    const int first = static_cast<int>(frame);
    wish.parts.push_back({first, joint, (1 - share) * by});
    if (share > 0) wish.parts.push_back({first + 1, joint, share * by});
  }

  // Three points that each foot carries stay where the clip has them.
  void pin_feet(int frame, std::vector<Wish>& out) const {
    if (feet_.empty()) return;
    const Turns none(turns_.size(), Vec3::Zero());
    const TurnedClip::Pose pose = clip_.pose(frame, turns_), wanted = clip_.pose(frame, none);
    const double arm = kArm * height_;
    for (const Index foot : feet_) {
      for (int k = 0; k < 3; ++k) {
        const Vec3 own =
            k == 0 ? Vec3::Zero() : Vec3(Vec3::Unit(k - 1) * 0.1 * height_ / pose.axes[foot].linear().col(0).norm());
        const Vec3 at = pose.axes[foot] * own, to = wanted.axes[foot] * own;
        std::vector<std::pair<Index, Eigen::Matrix3d>> moves;
        for (int n = static_cast<int>(clip_.joints()[foot].node); n >= 0;
             n = character_.rig.nodes[static_cast<std::size_t>(n)].parent) {
          for (Index j = 0; j < clip_.count(); ++j) {
            if (static_cast<int>(clip_.joints()[j].node) != n) continue;
            const Vec3 l = pose.axes[j].linear().inverse() * (at - pose.axes[j].translation());
            Eigen::Matrix3d cross;
            cross << 0, -l.z(), l.y(), l.z(), 0, -l.x(), -l.y(), l.x(), 0;
            const Vec3& x = turns_[static_cast<std::size_t>(frame) * clip_.count() + j];
            moves.emplace_back(j, -pose.axes[j].linear() * cross * turn_derivative(x));
          }
        }
        for (int axis = 0; axis < 3; ++axis) {
          Wish wish;
          wish.weight = wish.weight_over = kFoot / (arm * arm);
          wish.value = to[axis] - at[axis];
          for (const auto& [joint, m] : moves) {
            const Vec3 by = m.row(axis).transpose();
            wish.value += by.dot(turns_[static_cast<std::size_t>(frame) * clip_.count() + joint]);
            wish.parts.push_back({frame, joint, by});
          }
          out.push_back(std::move(wish));
        }
      }
    }
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

  // Events that get no better are left as they are. False where there is none.
  bool give_up(const std::vector<Meeting>& now, int round, bool is_last) {
    best_left_.resize(events_.size(), HUGE_VAL);
    best_round_.resize(events_.size(), 0);
    bool any = false;
    for (std::size_t e = 0; e < events_.size(); ++e) {
      MendedEvent& event = events_[e];
      if (!is_wanted(event)) continue;
      double left = 0;
      for (const Meeting& m : now) {
        if (is_fault(m.found.kind) && is_in(m.frame, m.found.part_a, m.found.part_b, event))
          left += double{m.found.depth};
      }
      if (left < 0.9 * best_left_[e]) {
        best_left_[e] = left;
        best_round_[e] = round;
      }
      if (left == 0 || (!is_last && round - best_round_[e] < kPatience)) continue;
      event.outcome = Outcome::kOverBudget;
      any = true;
      for (auto& [at, pushes] : pushes_) {
        const auto& [frame, a, b] = at;
        if (is_in(frame, a, b, event)) pushes.clear();
      }
    }
    return any;
  }

  static bool is_in(double frame, std::uint32_t a, std::uint32_t b, const MendedEvent& event) {
    return a == event.part_a && b == event.part_b && frame >= event.from - 1 && frame <= event.to + 1;
  }

  // Where something is worse than before, joints turn back around it, softly; and where that does not help, in all that
  // lies together in time.
  void take_back_what_fails() {
    if (in_window_.empty()) return;
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
        taper(fails);
      } else {
        turn_back(fails);
      }
    }
  }

  void taper(const std::vector<char>& fails) {
    const double pad = kPad * clip_.fps();
    for (std::size_t f = 0; f < fails.size(); ++f) {
      double near = HUGE_VAL;
      for (std::size_t g = 0; g < fails.size(); ++g) {
        if (fails[g] != 0) near = std::min(near, std::abs(static_cast<double>(f) - static_cast<double>(g)));
      }
      const double share = std::clamp((near - pad) / pad, 0.0, 1.0), smooth = share * share * (3 - 2 * share);
      for (std::size_t j = 0; j < clip_.count(); ++j) turns_[f * clip_.count() + j] *= smooth;
    }
  }

  void turn_back(const std::vector<char>& fails) {
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

  // Than the same parts were around that time.
  bool is_worse(const Meeting& meeting) const {
    double most = 0;
    for (int f = static_cast<int>(meeting.frame) - 1; f <= static_cast<int>(meeting.frame) + 2; ++f) {
      const auto known = depth_before_.find({f, meeting.found.part_a, meeting.found.part_b});
      if (known != depth_before_.end()) most = std::max(most, double{known->second.depth});
    }
    return double{meeting.found.depth} > most + kFoldDeeper / mm_;
  }

  void finish(Mend& out) {
    out.joints = clip_.joints();
    out.in_window = in_window_.empty() ? std::vector<char>(static_cast<std::size_t>(clip_.frames()), 0) : in_window_;
    std::vector<double> all;
    for (int f = 0; f < clip_.frames(); ++f) all.push_back(f);
    const std::vector<Meeting> after = finder_.in_frames(all, turns_);
    for (MendedEvent& event : events_) {
      event.depth_after = 0;
      for (const Meeting& meeting : after) {
        if (meeting.found.part_a != event.part_a || meeting.found.part_b != event.part_b ||
            meeting.frame < event.from || meeting.frame > event.to || !is_fault(meeting.found.kind)) {
          continue;
        }
        event.depth_after = std::max(event.depth_after, mm_ * double{meeting.found.depth});
      }
      event.turn_degrees = greatest_turn(event);
      if (event.outcome == Outcome::kAccepted || event.outcome == Outcome::kFold) continue;
      if (event.depth_after == 0) {
        event.outcome = Outcome::kCleared;
      } else if (event.depth_after < 0.8 * event.depth_before) {
        event.outcome = Outcome::kReduced;
      }
    }
    out.events = events_;
    out.turns = turns_;
    compare(out);
    count_near(out);
  }

  // What feet and wrists do that they did not do before.
  void compare(Mend& out) const {
    const Turns none(turns_.size(), Vec3::Zero());
    std::vector<std::vector<std::array<Vec3, 2>>> wrists(wrists_.size());  // before and after
    for (int f = 0; f < clip_.frames(); ++f) {
      const TurnedClip::Pose before = clip_.pose(f, none), after = clip_.pose(f, turns_);
      for (const Index foot : feet_) {
        const Affine &a = before.axes[foot], &b = after.axes[foot];
        out.feet_mm = std::max(out.feet_mm, mm_ * (a.translation() - b.translation()).norm());
        const double scale = std::cbrt(a.linear().determinant());
        const Eigen::Quaterniond p(Eigen::Matrix3d(a.linear() / scale)), q(Eigen::Matrix3d(b.linear() / scale));
        out.feet_degrees = std::max(out.feet_degrees, p.angularDistance(q) * 180 / std::numbers::pi);
      }
      for (std::size_t w = 0; w < wrists_.size(); ++w) {
        wrists[w].push_back({before.axes[wrists_[w]].translation(), after.axes[wrists_[w]].translation()});
      }
    }
    double sums[2] = {};
    for (const auto& way : wrists) {
      for (std::size_t f = 3; f < way.size(); ++f) {
        constexpr double kMoved = 3;  // mm
        if (mm_ * (way[f - 1][0] - way[f - 1][1]).norm() < kMoved) continue;
        for (std::size_t k = 0; k < 2; ++k) {
          sums[k] += (way[f][k] - 3 * way[f - 1][k] + 3 * way[f - 2][k] - way[f - 3][k]).norm();
        }
      }
    }
    if (sums[0] > 0) out.jerk_ratio = sums[1] / sums[0];
  }

  void count_near(Mend& out) const {
    constexpr double kNear = 5;  // mm
    for (const auto& [at, pushes] : pushes_) {
      const auto known = depth_before_.find(at);
      if (pushes.empty() || known == depth_before_.end() || !is_fault(known->second.kind)) continue;
      if (mm_ * double{known->second.depth} > kShallow) continue;
      ++out.shallow;
      const double frame = std::get<0>(at);
      const TurnedClip::Pose pose = clip_.pose(frame, turns_);
      double nearest = HUGE_VAL;
      for (const Push& push : pushes) nearest = std::min(nearest, std::abs(gap(push, pose, turns_at(frame))));
      out.still_near += mm_ * nearest <= kNear ? 1 : 0;
    }
  }
  double gap(const Push& push, const TurnedClip::Pose& pose, const std::vector<Vec3>& turns) const {
    const auto at = [&](const SkinSpot& spot) {
      return motion_of(clip_, pose, character_.source_positions, animated_.weights(), spot, turns.data()).at;
    };
    return push.way.dot(at(push.b) - at(push.a));
  }

  const AnimatedAsset& animated_;
  const Character& character_;
  MendOptions options_;
  double mm_, height_;
  TurnedClip clip_;
  FaultFinder finder_;
  Turns turns_;
  std::vector<Index> feet_, wrists_;  // joints
  std::vector<char> in_window_;
  std::map<At, Penetration> depth_before_;
  std::map<At, std::vector<Push>> pushes_;
  std::vector<MendedEvent> events_;
  struct Seen {
    std::vector<Vec3> turns;
    std::vector<Meeting> found;
  };
  std::map<double, Seen> seen_;
  std::vector<double> best_left_;  // of each event, mm in all
  std::vector<int> best_round_;
  double weight_ = kWish;
};

// What a radian costs. Joints near the trunk carry more with them.
double price_of(const std::string& role) {
  static const std::map<std::string, double> kPrices{{"shoulder", 1}, {"elbow", 1}, {"wrist", 2},  {"clavicle", 4},
                                                     {"neck", 6},     {"head", 6},  {"spine", 12}, {"chest", 12},
                                                     {"hip", 12},     {"knee", 12}, {"ankle", 25}};
  std::string name = role;
  for (const char* side : {"left_", "right_"}) {
    if (name.starts_with(side)) name = name.substr(std::string(side).size());
  }
  const auto found = kPrices.find(name);
  return found == kPrices.end() ? 0 : found->second;
}

}  // namespace

const char* outcome_name(Outcome outcome) {
  static constexpr std::array<const char*, 5> kNames{"cleared", "reduced", "over_budget", "fold", "accepted"};
  return kNames[static_cast<std::size_t>(outcome)];
}

std::vector<TurningJoint> turning_joints(const SourceRig& rig, const Roles& roles) {
  std::vector<TurningJoint> out;
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    const double price = n < roles.of_node.size() ? price_of(roles.of_node[n].role) : 0;
    if (price > 0) out.push_back({n, price * Eigen::Matrix3d::Identity()});
  }
  if (!out.empty()) return out;
  for (const Bone& bone : rig.bones) {
    // Not the one that carries all others.
    const auto is_below = [&](const Bone& other) {
      int n = static_cast<int>(other.node);
      while (n >= 0 && n != static_cast<int>(bone.node)) n = rig.nodes[static_cast<std::size_t>(n)].parent;
      return n >= 0;
    };
    const auto is_it = [&](const TurningJoint& joint) { return joint.node == bone.node; };
    if (std::all_of(rig.bones.begin(), rig.bones.end(), is_below)) continue;
    if (std::none_of(out.begin(), out.end(), is_it)) out.push_back({bone.node});
  }
  return out;
}

Mend mend_clip(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
               const std::function<bool(const MendedEvent&)>& leave,
               const std::function<void(const std::string&)>& told) {
  return Mender(animated, roles, clip, options).run(leave, told);
}

}  // namespace spherechain::baker
