// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/events.h"

#include <algorithm>
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
  if (meetings[last.deepest].depth_mm > meetings[first.deepest].depth_mm) first.deepest = last.deepest;
  spans.pop_back();
}

}  // namespace

std::vector<EventSpan> join_events(const std::vector<PartMeeting>& meetings, int frames, bool loops) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<EventSpan>> by_parts;
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    const PartMeeting& meeting = meetings[i];
    std::vector<EventSpan>& spans = by_parts[{meeting.part_a, meeting.part_b}];
    if (spans.empty() || !is_bridged(spans.back().to, meeting.frame)) {
      spans.push_back({meeting.frame, meeting.frame, i});
      continue;
    }
    EventSpan& span = spans.back();
    span.to = meeting.frame;
    if (meeting.depth_mm > meetings[span.deepest].depth_mm) span.deepest = i;
  }
  std::vector<EventSpan> out;
  for (auto& [parts, spans] : by_parts) {
    if (loops) close_loop(spans, frames, meetings);
    out.insert(out.end(), spans.begin(), spans.end());
  }
  std::sort(out.begin(), out.end(), [&](const EventSpan& l, const EventSpan& r) {
    const auto key = [&](const EventSpan& span) {
      const PartMeeting& m = meetings[span.deepest];
      return std::tuple(span.from, m.part_a, m.part_b, span.to);
    };
    return key(l) < key(r);
  });
  return out;
}

}  // namespace spherechain::baker
