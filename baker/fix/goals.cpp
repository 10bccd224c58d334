// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/goals.h"

#include <algorithm>
#include <cmath>

#include "baker/bind/part_names.h"
#include "baker/events/join_events.h"

namespace spherechain::baker {
namespace {

constexpr double kDeeper = 0.5;       // mm: extra depth that is not yet a fault
constexpr double kFoldDeeper = 2;     // the same for folds, which move with the joint
constexpr double kDeeperShare = 0.1;  // plus this share of the depth before
constexpr double kFoldShare = 0.65;   // of what the rule allows a fold: so much stays

// Neighbours on one skin always meet near their joint, and need not be apart.
bool may_fold(const Penetration& found) {
  const Relation relation = found.measures.relation;
  const bool are_neighbours = relation == SC_RELATION_NEAR || relation == SC_RELATION_SIBLINGS ||
                              relation == SC_RELATION_JOINED ||
                              double{found.measures.rest_distance} < 1.5 * double{sc_default_rule().neighbours};
  return found.measures.is_one_piece != 0 && are_neighbours;
}

// Belly, chest, hips and thighs of one skin: flesh that lies on flesh.
bool are_soft(const std::vector<BodyPart>& parts, const Penetration& found) {
  const auto is_soft = [&](std::uint32_t part) {
    const int mobility = parts[part].mobility;
    return mobility == mobility_of("torso") || mobility == mobility_of("thigh");
  };
  return found.measures.is_one_piece != 0 && is_soft(found.part) && is_soft(found.other);
}

double allowed_fold(const Penetration& found) {
  return kFoldShare * (double{found.measures.depth} - double{found.fault_depth});
}

}  // namespace

Event event_of(const EventSpan& span, const std::vector<FramePenetration>& faults, const std::vector<BodyPart>& parts,
               double mm_per_unit) {
  const auto& [frame, worst] = faults[span.deepest];
  Event out;
  out.parts = {parts[worst.part].name, parts[worst.other].name};
  out.kind = worst.kind;
  out.from = span.from;
  out.to = span.to;
  out.deepest = frame;
  out.depth_mm = mm_per_unit * double{worst.measures.depth};
  return out;
}

Goals goals_of(const std::vector<PosePenetration>& before, const std::vector<PosePenetration>& sequence, int frames,
               const std::vector<BodyPart>& parts, double mm_per_unit, const MendOptions& options,
               const std::function<bool(const Event&)>& leave) {
  std::map<PenetrationKey, Penetration> at;
  std::vector<FramePenetration> faults;
  for (const PosePenetration& penetration : before) at[place_of(penetration)] = penetration.found;
  for (const PosePenetration& penetration : sequence) {
    if (is_fault(penetration.found.kind)) faults.push_back({static_cast<int>(penetration.frame), penetration.found});
  }
  std::vector<WorkingEvent> events;
  for (const EventSpan& span : join_events(faults, frames, false)) {
    const Penetration& worst = faults[span.deepest].found;
    Event found = event_of(span, faults, parts, mm_per_unit);
    const bool is_fold = worst.part == worst.other || (!options.is_soft_parted && are_soft(parts, worst)) ||
                         std::all_of(span.penetrations.begin(), span.penetrations.end(),
                                     [&](std::size_t i) { return faults[i].found.kind == SC_CLASS_DEEP_FOLD; });
    const WorkingState state = leave(found) ? WorkingState::kAccepted
                               : is_fold    ? WorkingState::kFold
                                            : WorkingState::kOpen;
    events.push_back({std::move(found), worst.part, worst.other, state});
    for (const auto& [place, penetration] : at) {
      const bool counts = events.back().contains(place) && is_fault(penetration.kind);
      events.back().depths_before += counts ? mm_per_unit * double{penetration.measures.depth} : 0;
    }
  }
  return {std::move(events), std::move(at), mm_per_unit, options.margin_mm};
}

bool Goals::is_left_alone(std::uint32_t part, std::uint32_t other) const {
  bool is_one = false, are_all = true;
  for (const WorkingEvent& event : events) {
    if (event.part != part || event.other != other) continue;
    is_one = true;
    are_all &= event.is_left_alone();
  }
  return is_one && are_all;
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
  const Penetration* known = before({std::round(penetration.frame), penetration.found.part, penetration.found.other});
  if (event == nullptr) {
    const Penetration& found = penetration.found;
    // To a strict eye events are longer. That holds for those that are left alone, too.
    const bool stays = known != nullptr && is_fault(known->kind) && is_left_alone(found.part, found.other);
    if (!stays && found.kind >= SC_CLASS_PENETRATION && found.part != found.other) return apart;
  } else if (event->is_open() && penetration.frame >= event->found.from && penetration.frame <= event->found.to) {
    return may_fold(penetration.found) ? allowed_fold(penetration.found) : apart;
  }
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

double Goals::worse_by(const PosePenetration& penetration) const {
  if (!(penetration.found.fault_depth > 0)) return 0;
  const double first = std::floor(penetration.frame) - 1, last = std::ceil(penetration.frame) + 1;
  double most = 0;
  bool was_fault = false;
  for (double f = first; f <= last; ++f) {
    const Penetration* known = before({f, penetration.found.part, penetration.found.other});
    if (known == nullptr) continue;
    most = std::max(most, double{known->measures.depth});
    was_fault |= known->fault_depth > 0;
  }
  if (!was_fault) return HUGE_VAL;
  const double by = double{penetration.found.measures.depth} - most;
  return by > kFoldDeeper / mm_ + kDeeperShare * most ? by : 0;
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
