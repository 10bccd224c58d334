// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/goals.h"

#include <algorithm>
#include <cmath>

#include "baker/events/join_events.h"

namespace spherechain::baker {
namespace {

constexpr double kDeeper = 0.5;       // mm: extra depth that is not yet a fault
constexpr double kFoldDeeper = 2;     // the same for folds, which move with the joint
constexpr double kDeeperShare = 0.1;  // plus this share of the depth before

}  // namespace

Goals goals_of(const std::vector<PosePenetration>& before, int frames, const std::vector<BodyPart>& parts,
               double mm_per_unit, double margin_mm, const std::function<bool(const Event&)>& leave) {
  std::map<PenetrationKey, Penetration> at;
  std::vector<FramePenetration> faults;
  for (const PosePenetration& penetration : before) {
    at[place_of(penetration)] = penetration.found;
    if (is_fault(penetration.found.kind)) faults.push_back({static_cast<int>(penetration.frame), penetration.found});
  }
  std::vector<WorkingEvent> events;
  for (const EventSpan& span : join_events(faults, frames, false)) {
    const Penetration& worst = faults[span.deepest].found;
    Event found;
    found.parts = {parts[worst.part].name, parts[worst.other].name};
    found.kind = worst.kind;
    found.from = span.from;
    found.to = span.to;
    found.deepest = faults[span.deepest].frame;
    found.depth_mm = mm_per_unit * double{worst.measures.depth};
    const bool is_fold = worst.kind == SC_CLASS_DEEP_FOLD || worst.part == worst.other;
    const WorkingState state = leave(found) ? WorkingState::kAccepted
                               : is_fold    ? WorkingState::kFold
                                            : WorkingState::kOpen;
    events.push_back({std::move(found), worst.part, worst.other, state});
  }
  return {std::move(events), std::move(at), mm_per_unit, margin_mm};
}

bool Goals::has_open_events() const {
  return std::any_of(events.begin(), events.end(), [](const WorkingEvent& event) { return event.is_open(); });
}

const Penetration* Goals::before(const PenetrationKey& place) const {
  const auto known = before_.find(place);
  return known == before_.end() ? nullptr : &known->second;
}

const WorkingEvent* Goals::event_at(const PenetrationKey& place) const {
  const auto event =
      std::find_if(events.begin(), events.end(), [&](const WorkingEvent& e) { return e.contains(place); });
  return event == events.end() ? nullptr : &*event;
}

double Goals::allowed(const PosePenetration& penetration) const {
  const double apart = -margin_mm_ / mm_;
  const WorkingEvent* event = event_at(place_of(penetration));
  if (event == nullptr) {
    const bool is_new =
        penetration.found.kind >= SC_CLASS_PENETRATION && penetration.found.part != penetration.found.other;
    if (is_new) return apart;
  } else if (event->is_open() && penetration.frame >= event->found.from && penetration.frame <= event->found.to) {
    return apart;
  }
  const Penetration* known = before({std::round(penetration.frame), penetration.found.part, penetration.found.other});
  return known == nullptr ? 0 : double{known->measures.depth};
}

bool Goals::is_let_be(const PosePenetration& penetration) const {
  const double may_be = allowed(penetration);
  if (may_be < 0) return false;
  const Penetration& p = penetration.found;
  // Pairs that are no faults and were not separated are left alone: folds and touches come and go with a joint.
  if (!is_fault(p.kind) || p.part == p.other) return true;
  const double slack = (p.kind == SC_CLASS_DEEP_FOLD ? kFoldDeeper : kDeeper) / mm_ + kDeeperShare * may_be;
  return double{p.measures.depth} - may_be <= slack;
}

double Goals::too_deep(const PosePenetration& penetration) const {
  if (!is_fault(penetration.found.kind) || is_let_be(penetration)) return 0;
  return double{penetration.found.measures.depth} - std::max(allowed(penetration), 0.0);
}

bool Goals::is_worse(const PosePenetration& penetration) const {
  if (!is_fault(penetration.found.kind)) return false;
  const double first = std::floor(penetration.frame) - 1, last = std::ceil(penetration.frame) + 1;
  double most = 0;
  for (double f = first; f <= last; ++f) {
    const Penetration* known = before({f, penetration.found.part, penetration.found.other});
    if (known != nullptr && is_fault(known->kind)) most = std::max(most, double{known->measures.depth});
  }
  return double{penetration.found.measures.depth} > most + kFoldDeeper / mm_;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> Goals::harmless() const {
  std::map<std::pair<std::uint32_t, std::uint32_t>, PenetrationClass> worst;
  for (const auto& [place, found] : before_) {
    PenetrationClass& kind = worst.try_emplace(std::minmax(place.part, place.other), found.kind).first->second;
    kind = std::max(kind, found.kind);
  }
  std::set<std::pair<std::uint32_t, std::uint32_t>> out;
  for (const auto& [pair, kind] : worst) {
    if (kind <= SC_CLASS_SHELL) out.insert(pair);
  }
  return out;
}

}  // namespace spherechain::baker
