// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/decisions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/check/json_input.h"
#include "baker/fix/acting.h"
#include "baker/fix/time_windows.h"
#include "baker/mesh/error.h"
#include "baker/play/asset_file.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr const char* kList = "spherechain_decisions";
constexpr double kStepMax = 1;                         // % of the height a frame: a faster fade is a jerk
constexpr std::array<double, 3> kFades{0.35, 0.7, 1};  // seconds, until one is slow enough
constexpr double kHeldMin = 0.5;                       // degrees: a turn that one may see
constexpr double kDeeperMax = 2;                       // mm: an event is still as deep as it was

class DecisionReader {
 public:
  DecisionReader(const ordered_json& entry, std::size_t number, const std::string& file)
      : entry_(entry), place_(fmt::format("{}: '{}', entry {}", file, kList, number)) {}

  Decision read() const {
    if (!entry_.is_object()) throw Error(ExitCode::kFile, place_ + ": is not an object");
    Decision out;
    const ordered_json &clip = at("clip"), &parts = at("parts"), &decision = at("decision");
    if (!clip.is_string()) fail("clip", "a clip's name");
    out.clip = clip.get<std::string>();
    if (!parts.is_array() || parts.size() != 2 || !parts[0].is_string() || !parts[1].is_string()) {
      fail("parts", "a list of two body parts");
    }
    out.parts = {parts[0].get<std::string>(), parts[1].get<std::string>()};
    out.from = frame("from");
    out.to = frame("to");
    if (decision != "accept" && decision != "refuse") fail("decision", "accept or refuse");
    out.is_refused = decision == "refuse";
    return out;
  }

 private:
  [[noreturn]] void fail(const char* key, const char* expected) const {
    const char* found = entry_.contains(key) ? "is not " : "is missing: ";
    throw Error(ExitCode::kFile, fmt::format("{}: '{}' {}{}", place_, key, found, expected));
  }
  const ordered_json& at(const char* key) const {
    static const ordered_json kNone;
    const auto found = entry_.find(key);
    return found == entry_.end() ? kNone : *found;
  }
  int frame(const char* key) const {
    const ordered_json& value = at(key);
    const double number = value.is_number() ? value.get<double>() : -1;
    if (!(number >= 0 && number <= 1e9) || number != std::floor(number)) fail(key, "a frame's number");
    return static_cast<int>(number);
  }

  const ordered_json& entry_;
  std::string place_;
};

bool are_same(const std::array<std::string, 2>& a, const std::array<std::string, 2>& b) {
  return a == b || (a[0] == b[1] && a[1] == b[0]);
}

// Frames that an event needs as they are: its own, and one on either side, so that nothing changes between frames.
struct Frames {
  int from, to;
};
Frames frames_of(const MendedEvent& event) {
  return {static_cast<int>(event.before.from) - 1, static_cast<int>(event.before.to) + 1};
}

class Refuser {
 public:
  Refuser(const ClipFacts& facts, const Roles& roles, const std::vector<char>& is_refused, Mend& mend)
      : facts_(facts), mend_(mend), measure_(facts, roles), is_refused_(is_refused) {
    for (std::size_t e = 0; e < mend.events.size(); ++e) {
      const MendOutcome outcome = mend.events[e].outcome;
      const bool is_left = outcome == MendOutcome::kFold || outcome == MendOutcome::kAccepted;
      if (is_left) is_refused_[e] = 0;
      is_kept_.push_back(
          is_refused_[e] == 0 && (outcome == MendOutcome::kCleared || outcome == MendOutcome::kReduced) ? 1 : 0);
      joints_.push_back(joints_of_event(mend.events[e], facts, roles));
    }
  }

  Refusals run() {
    const Turns turns = mend_.turns;
    const double allowed = std::max(kStepMax, step_of(turns));
    for (const double fade : kFades) {
      mend_.turns = turns;
      fade_ = fade;
      take_back();
      if (step_of(mend_.turns) <= allowed) break;
    }
    close_windows();
    Refusals out;
    measure_again(turns, out);
    out.held_by.resize(mend_.events.size());
    for (std::size_t e = 0; e < mend_.events.size(); ++e) {
      if (is_refused_[e] == 0) continue;
      mend_.events[e].outcome = MendOutcome::kRefused;
      for (std::size_t k = 0; k < mend_.events.size(); ++k) {
        if (is_kept_[k] != 0 && holds(k, e)) out.held_by[e].push_back(k);
      }
    }
    return out;
  }

 private:
  double step_of(const Turns& turns) { return measure_.of_clip(turns).step_percent; }

  bool needs(std::size_t event, Index joint) const {
    return std::binary_search(joints_[event].begin(), joints_[event].end(), joint);
  }
  // True if an accepted event keeps a joint turned in a frame of a refused one.
  bool holds(std::size_t kept, std::size_t refused) const {
    const MendedEvent& its = mend_.events[refused];
    const double reach = fade_ * facts_.clip.fps();
    for (int f = static_cast<int>(its.before.from); f <= static_cast<int>(its.before.to); ++f) {
      if (distance({kept}, f) >= reach) continue;
      for (const Index joint : joints_[kept]) {
        const Vec3& turn = mend_.turns[static_cast<std::size_t>(f) * facts_.clip.count() + joint];
        if (needs(refused, joint) && to_degrees(turn.norm()) > kHeldMin) return true;
      }
    }
    return false;
  }

  bool is_in(std::size_t event, const std::vector<std::size_t>& run) const {
    const MendedEvent& its = mend_.events[event];
    return std::any_of(run.begin(), run.end(), [&](std::size_t f) {
      return static_cast<double>(f) >= its.before.from && static_cast<double>(f) <= its.before.to;
    });
  }

  // Frames from f to the nearest of the events' frames.
  double distance(const std::vector<std::size_t>& events, int f) const {
    double out = HUGE_VAL;
    const int period = facts_.clip.frames() - 1;
    for (const std::size_t e : events) {
      const Frames its = frames_of(mend_.events[e]);
      for (const int turn : {-period, 0, period}) {
        if (turn != 0 && !facts_.loops) continue;
        out = std::min(out, std::max({0.0, double(its.from - (f + turn)), double(f + turn - its.to)}));
      }
    }
    return out;
  }

  // A turn stays only if an accepted event needs its joint.
  void take_back() {
    for (const std::vector<std::size_t>& run : contiguous_runs(mend_.in_window, facts_.loops)) {
      std::vector<std::size_t> refused, kept;
      for (std::size_t e = 0; e < mend_.events.size(); ++e) {
        if (!is_in(e, run)) continue;
        if (is_refused_[e] != 0) refused.push_back(e);
        if (is_kept_[e] != 0) kept.push_back(e);
      }
      if (refused.empty()) continue;
      for (Index joint = 0; joint < facts_.clip.count(); ++joint) take_back(joint, run, refused, kept);
    }
  }

  void take_back(Index joint, const std::vector<std::size_t>& run, std::vector<std::size_t> refused,
                 std::vector<std::size_t> kept) {
    // A joint that no event needs turns along with others: a hand on the same thing.
    const auto is_needed = [&](std::size_t e) { return needs(e, joint); };
    const bool goes_along =
        std::none_of(refused.begin(), refused.end(), is_needed) && std::none_of(kept.begin(), kept.end(), is_needed);
    if (!goes_along) {
      std::erase_if(refused, [&](std::size_t e) { return !needs(e, joint); });
      std::erase_if(kept, [&](std::size_t e) { return !needs(e, joint); });
    }
    if (refused.empty()) return;
    const double pad = kWindowPad * facts_.clip.fps(), length = fade_ * facts_.clip.fps();
    const auto falls = [&](double distance) {
      const double t = std::clamp(distance / length, 0.0, 1.0);
      return 1 - t * t * (3 - 2 * t);
    };
    for (const std::size_t f : run) {
      Vec3& turn = mend_.turns[f * facts_.clip.count() + joint];
      if (kept.empty()) {
        turn.setZero();
        continue;
      }
      const auto frame = static_cast<int>(f);
      const double refusal = falls(distance(refused, frame) - pad), keep = falls(distance(kept, frame));
      turn *= 1 - refusal * (1 - keep);
    }
  }

  // Runs of frames in which nothing turns any more get no keys.
  void close_windows() {
    const std::size_t count = facts_.clip.count();
    for (const std::vector<std::size_t>& run : contiguous_runs(mend_.in_window, facts_.loops)) {
      const bool turns = std::any_of(run.begin(), run.end(), [&](std::size_t f) {
        const auto first = mend_.turns.begin() + static_cast<std::ptrdiff_t>(f * count);
        return std::any_of(first, first + static_cast<std::ptrdiff_t>(count),
                           [](const Vec3& turn) { return !turn.isZero(0); });
      });
      if (turns) continue;
      for (const std::size_t f : run) mend_.in_window[f] = 0;
    }
  }

  bool is_of(const MendedEvent& event, const PosePenetration& one) const {
    const Frames its = frames_of(event);
    const bool are_its = (event.part == one.found.part && event.other == one.found.other) ||
                         (event.part == one.found.other && event.other == one.found.part);
    return are_its && one.frame >= its.from && one.frame <= its.to;
  }

  void measure_again(const Turns& cured, Refusals& out) {
    std::vector<int> changed;
    const std::size_t count = facts_.clip.count();
    for (int f = 0; f < facts_.clip.frames(); ++f) {
      const auto is_as_cured = [&](int g) {
        const auto at = static_cast<std::size_t>(std::min(g, facts_.clip.frames() - 1)) * count;
        return std::equal(cured.begin() + static_cast<std::ptrdiff_t>(at),
                          cured.begin() + static_cast<std::ptrdiff_t>(at + count),
                          mend_.turns.begin() + static_cast<std::ptrdiff_t>(at));
      };
      if (!is_as_cured(f) || !is_as_cured(f + 1)) changed.push_back(f);
    }
    FaultFinder finder(facts_.animated, facts_.clip);
    std::vector<PosePenetration> found = finder.in_sequence(mend_.turns);
    const std::vector<PosePenetration> between = finder.between(changed, mend_.turns);
    found.insert(found.end(), between.begin(), between.end());
    std::erase_if(found, [](const PosePenetration& one) { return !is_fault(one.found.kind); });
    measure_events(found);
    mend_.compared = compare(facts_.clip, mend_.turns, facts_.feet, facts_.wrists, facts_.mm);
    std::vector<FramePenetration> fresh;
    mend_.volume_after = 0;
    for (const PosePenetration& one : found) {
      const bool is_mended = std::any_of(mend_.events.begin(), mend_.events.end(), [&](const MendedEvent& event) {
        return event.outcome != MendOutcome::kFold && event.outcome != MendOutcome::kAccepted && is_of(event, one);
      });
      if (!is_between(one.frame) && is_mended) {
        mend_.volume_after += finder.volume(one.frame, one.found, mend_.turns) * std::pow(facts_.mm / 10, 3);
      }
      const bool is_known = std::any_of(mend_.events.begin(), mend_.events.end(),
                                        [&](const MendedEvent& event) { return is_of(event, one); });
      const double depth_mm = facts_.mm * double{one.found.measures.depth};
      if (!is_known && depth_mm > kDeeperMax) fresh.push_back({static_cast<int>(one.frame), one.found});
    }
    std::stable_sort(fresh.begin(), fresh.end(), [](const auto& a, const auto& b) { return a.frame < b.frame; });
    const BodyParts parts = body_parts_of(facts_.animated.asset());
    for (const EventSpan& span : join_events(fresh, facts_.clip.frames(), false)) {
      out.new_faults.push_back(event_of(span, fresh, parts.parts, facts_.mm));
    }
  }

  void measure_events(const std::vector<PosePenetration>& found) {
    const std::size_t count = facts_.clip.count();
    for (MendedEvent& event : mend_.events) {
      event.depth_after_mm = event.turn_degrees = 0;
      for (const PosePenetration& one : found) {
        if (is_of(event, one)) {
          event.depth_after_mm = std::max(event.depth_after_mm, facts_.mm * double{one.found.measures.depth});
        }
      }
      const auto from = static_cast<std::size_t>(event.before.from), to = static_cast<std::size_t>(event.before.to);
      for (std::size_t i = from * count; i < (to + 1) * count; ++i) {
        event.turn_degrees = std::max(event.turn_degrees, to_degrees(mend_.turns[i].norm()));
      }
    }
  }

  const ClipFacts& facts_;
  Mend& mend_;
  ActingMeasure measure_;
  std::vector<char> is_refused_, is_kept_;
  std::vector<std::vector<Index>> joints_;  // of each event
  double fade_ = 0;                         // seconds
};

}  // namespace

bool Decision::is_of(const std::string& its_clip, const MendedEvent& event) const {
  return clip == its_clip && are_same(parts, event.before.parts) && from == static_cast<int>(event.before.from) &&
         to == static_cast<int>(event.before.to);
}

std::string decision_text(const Decision& decision) {
  return fmt::format("'{}': {}, {}, frames {}-{}", decision.clip, decision.parts[0], decision.parts[1], decision.from,
                     decision.to);
}

std::vector<Decision> read_decisions(const std::string& file) {
  const ordered_json json = parse_input(read_file(file), file, "is no file of decisions");
  const auto list = json.is_object() ? json.find(kList) : json.end();
  if (list == json.end() || !list->is_array()) {
    throw Error(ExitCode::kFile,
                fmt::format("{}: is no file of decisions: it has no list '{}' (a page of fix --report saves one)", file,
                            kList));
  }
  std::vector<Decision> out;
  for (const ordered_json& entry : *list) {
    const Decision decision = DecisionReader(entry, out.size() + 1, file).read();
    for (const Decision& other : out) {
      if (other.clip == decision.clip && are_same(other.parts, decision.parts) && other.from == decision.from &&
          other.to == decision.to && other.is_refused != decision.is_refused) {
        throw Error(ExitCode::kFile,
                    fmt::format("{}: accepts and refuses one event: {}", file, decision_text(decision)));
      }
    }
    out.push_back(decision);
  }
  return out;
}

Refusals refuse_events(const ClipFacts& facts, const Roles& roles, const std::vector<char>& is_refused, Mend& mend) {
  return Refuser(facts, roles, is_refused, mend).run();
}

}  // namespace spherechain::baker
