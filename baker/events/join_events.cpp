// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/events/join_events.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

namespace spherechain::baker {
namespace {

using Parts = std::pair<std::uint32_t, std::uint32_t>;

Parts part_pair_of(const FramePenetration& penetration) {
  return std::minmax(penetration.found.part, penetration.found.other);
}

bool is_bridged(double last, double next) { return next - last - 1 <= kGapMax; }

void sort_events(std::vector<EventSpan>& spans, const std::vector<FramePenetration>& penetrations) {
  const auto key = [&](const EventSpan& span) {
    return std::tuple(span.from, part_pair_of(penetrations[span.deepest]), span.to);
  };
  std::sort(spans.begin(), spans.end(), [&](const EventSpan& l, const EventSpan& r) { return key(l) < key(r); });
}

// The last event of a loop goes on as the first where no more than a gap lies between.
void close_loop(std::vector<EventSpan>& spans, int frames, const std::vector<FramePenetration>& penetrations) {
  if (spans.size() < 2) return;
  const int period = frames - 1;
  EventSpan &first = spans.front(), &last = spans.back();
  if (!is_bridged(last.to, first.from + period)) return;
  first.from = last.from;
  if (penetrations[last.deepest].found.measures.depth > penetrations[first.deepest].found.measures.depth)
    first.deepest = last.deepest;
  first.penetrations.insert(first.penetrations.begin(), last.penetrations.begin(), last.penetrations.end());
  spans.pop_back();
}

}  // namespace

std::vector<EventSpan> join_events(const std::vector<FramePenetration>& penetrations, int frames, bool loops) {
  std::map<Parts, std::vector<EventSpan>> by_parts;
  for (std::size_t i = 0; i < penetrations.size(); ++i) {
    const FramePenetration& penetration = penetrations[i];
    std::vector<EventSpan>& spans = by_parts[part_pair_of(penetration)];
    if (spans.empty() || !is_bridged(spans.back().to, penetration.frame)) {
      spans.push_back({penetration.frame, penetration.frame, i, {i}});
      continue;
    }
    EventSpan& span = spans.back();
    span.to = penetration.frame;
    span.penetrations.push_back(i);
    if (penetration.found.measures.depth > penetrations[span.deepest].found.measures.depth) span.deepest = i;
  }
  std::vector<EventSpan> out;
  for (auto& [parts, spans] : by_parts) {
    if (loops) close_loop(spans, frames, penetrations);
    out.insert(out.end(), spans.begin(), spans.end());
  }
  sort_events(out, penetrations);
  return out;
}

std::vector<EventSpan> join_events(const std::vector<FramePenetration>& penetrations,
                                   const std::vector<double>& numbers, bool loops) {
  const auto number = [&](std::size_t m) { return numbers[static_cast<std::size_t>(penetrations[m].frame)]; };
  std::vector<FramePenetration> whole;
  std::vector<std::size_t> place;                      // of those in `penetrations`
  std::map<Parts, std::vector<std::size_t>> by_parts;  // all
  for (std::size_t m = 0; m < penetrations.size(); ++m) {
    by_parts[part_pair_of(penetrations[m])].push_back(m);
    if (is_between(number(m))) continue;
    whole.push_back({static_cast<int>(number(m)), penetrations[m].found});
    place.push_back(m);
  }
  const int frames = numbers.empty() ? 0 : static_cast<int>(numbers.back()) + 1;
  std::vector<EventSpan> out = join_events(whole, frames, loops);
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> event_of(penetrations.size(), kNone);
  for (std::size_t e = 0; e < out.size(); ++e) {
    out[e].deepest = place[out[e].deepest];
    for (std::size_t& m : out[e].penetrations) event_of[m = place[m]] = e;
  }
  // `m` comes right before or after `known`, which is in an event.
  const auto join = [&](std::size_t m, std::size_t known, bool is_after) {
    if (event_of[m] != kNone || event_of[known] == kNone) return;
    if (!is_bridged(number(std::min(m, known)), number(std::max(m, known)))) return;
    std::vector<std::size_t>& all = out[event_of[known]].penetrations;
    all.insert(std::find(all.begin(), all.end(), known) + (is_after ? 1 : 0), m);
    event_of[m] = event_of[known];
  };
  for (const auto& [parts, of_them] : by_parts) {
    for (std::size_t i = 1; i < of_them.size(); ++i) join(of_them[i], of_them[i - 1], true);
    for (std::size_t i = of_them.size(); i-- > 1;) join(of_them[i - 1], of_them[i], false);
    for (std::size_t i = 0; i < of_them.size(); ++i) {
      if (i > 0) join(of_them[i], of_them[i - 1], true);
      if (event_of[of_them[i]] != kNone) continue;
      event_of[of_them[i]] = out.size();
      out.push_back({0, 0, of_them[i], {of_them[i]}});
    }
  }
  for (EventSpan& span : out) {
    span.from = penetrations[span.penetrations.front()].frame;
    span.to = penetrations[span.penetrations.back()].frame;
  }
  sort_events(out, penetrations);
  return out;
}

}  // namespace spherechain::baker
