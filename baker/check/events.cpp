// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/events.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

namespace spherechain::baker {
namespace {

bool is_bridged(int last, int next) { return next - last - 1 <= kGapMax; }

// The last event of a loop goes on as the first where no more than a gap lies between.
void close_loop(std::vector<EventSpan>& spans, int frames, const std::vector<PartMeeting>& meetings) {
  if (spans.size() < 2) return;
  const int period = frames - 1;
  EventSpan &first = spans.front(), &last = spans.back();
  if (!is_bridged(last.to, first.from + period)) return;
  first.from = last.from;
  if (meetings[last.deepest].found.depth > meetings[first.deepest].found.depth) first.deepest = last.deepest;
  first.meetings.insert(first.meetings.begin(), last.meetings.begin(), last.meetings.end());
  spans.pop_back();
}

}  // namespace

std::vector<EventSpan> join_events(const std::vector<PartMeeting>& meetings, int frames, bool loops) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<EventSpan>> by_parts;
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    const PartMeeting& meeting = meetings[i];
    std::vector<EventSpan>& spans = by_parts[{meeting.found.part_a, meeting.found.part_b}];
    if (spans.empty() || !is_bridged(spans.back().to, meeting.frame)) {
      spans.push_back({meeting.frame, meeting.frame, i, {i}});
      continue;
    }
    EventSpan& span = spans.back();
    span.to = meeting.frame;
    span.meetings.push_back(i);
    if (meeting.found.depth > meetings[span.deepest].found.depth) span.deepest = i;
  }
  std::vector<EventSpan> out;
  for (auto& [parts, spans] : by_parts) {
    if (loops) close_loop(spans, frames, meetings);
    out.insert(out.end(), spans.begin(), spans.end());
  }
  std::sort(out.begin(), out.end(), [&](const EventSpan& l, const EventSpan& r) {
    const auto key = [&](const EventSpan& span) {
      const Penetration& of = meetings[span.deepest].found;
      return std::tuple(span.from, of.part_a, of.part_b, span.to);
    };
    return key(l) < key(r);
  });
  return out;
}

}  // namespace spherechain::baker
