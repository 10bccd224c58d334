// SPDX-License-Identifier: GPL-3.0-or-later
// Meetings of body parts joined over frames, what a baseline takes for the same, and how names reach JUnit.
#include "baker/events/join_events.h"

#include <doctest/doctest.h>

#include "baker/check/baseline.h"
#include "baker/check/formats.h"

namespace bk = spherechain::baker;

namespace {

// Depths of the parts 0 and 1 by frame; 0 where they do not meet.
std::vector<bk::FramePenetration> meetings(const std::vector<double>& depths) {
  std::vector<bk::FramePenetration> out;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (depths[i] <= 0) continue;
    out.push_back({static_cast<int>(i), {}});
    out.back().found.other = 1;
    out.back().found.measures.depth = static_cast<float>(depths[i]);
  }
  return out;
}

// "from-to@deepest", one after another.
std::string events(const std::vector<double>& depths, bool loops = false) {
  const std::vector<bk::FramePenetration> list = meetings(depths);
  std::string out;
  for (const bk::EventSpan& span : bk::join_events(list, static_cast<int>(depths.size()), loops)) {
    out += (out.empty() ? "" : " ") + std::to_string(span.from) + "-" + std::to_string(span.to) + "@" +
           std::to_string(list[span.deepest].frame);
  }
  return out;
}

bk::Event event(int from, int to, double depth) {
  bk::Event out;
  out.parts = {"right hand", "left thigh"};
  out.kind = SC_CLASS_PENETRATION;
  out.from = from;
  out.to = to;
  out.depth_mm = depth;
  return out;
}

bk::KnownEvent known(double from, double to, double depth) {
  return {"hero", "run", {"left thigh", "right hand"}, SC_CLASS_PENETRATION, from,
          to,     depth, bk::EventState::kAccepted};
}

}  // namespace

TEST_CASE("an event goes on over three frames without a meeting, not over four") {
  CHECK(events({0, 1, 2, 1, 0}) == "1-3@2");
  CHECK(events({1, 0, 0, 0, 2}) == "0-4@4");
  CHECK(events({1, 0, 0, 0, 0, 2}) == "0-0@0 5-5@5");
  CHECK(events({}).empty());
  CHECK(events({0, 0}).empty());
}

TEST_CASE("clips shorter than a gap have whole events") {
  CHECK(events({3}) == "0-0@0");
  CHECK(events({3}, true) == "0-0@0");
  CHECK(events({1, 2}, true) == "0-1@1");
  CHECK(events({1, 0, 2}, true) == "0-2@2");
}

TEST_CASE("the deepest frame is the earliest of equals") { CHECK(events({1, 4, 2, 4}) == "0-3@1"); }

TEST_CASE("an event goes on over the seam of a loop") {
  const std::vector<double> seam{5, 1, 0, 0, 0, 0, 0, 2, 5};
  CHECK(events(seam) == "0-1@0 7-8@8");
  CHECK(events(seam, true) == "7-1@0");
  CHECK(events({0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0}, true) == "9-1@9");  // gap of one: the last frame is the first
  CHECK(events({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0}, true) == "11-2@11");         // three
  CHECK(events({0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0}, true) == "3-3@3 11-11@11");  // four
  CHECK(events({1, 1, 1, 1, 1}, true) == "0-4@0");
}

TEST_CASE("frames between add to the events of whole frames, and join none of them") {
  const auto events_at = [](const std::vector<double>& numbers) {
    std::string out;
    for (const bk::EventSpan& span :
         bk::join_events(meetings(std::vector<double>(numbers.size(), 1)), numbers, false)) {
      for (const std::size_t m : span.penetrations) out += std::to_string(numbers[m]).substr(0, 3) + " ";
      out += "| ";
    }
    return out;
  };
  CHECK(events_at({0, 1, 2}) == "0.0 1.0 2.0 | ");
  CHECK(events_at({0, 4}) == "0.0 4.0 | ");
  CHECK(events_at({0, 0.2, 0.5, 0.7, 0.9, 4}) == "0.0 0.2 0.5 0.7 0.9 4.0 | ");  // still a gap of three frames
  CHECK(events_at({0, 2.5, 5}) == "0.0 2.5 | 5.0 | ");
  CHECK(events_at({0.5, 5}) == "0.5 | 5.0 | ");
  CHECK(events_at({3.5, 5}) == "3.5 5.0 | ");
  CHECK(events_at({0.5, 0.7}) == "0.5 0.7 | ");
}

TEST_CASE("events of different parts are apart") {
  std::vector<bk::FramePenetration> list = meetings({1, 1});
  list.push_back(list[1]);
  list.back().found.other = 2;
  const std::vector<bk::EventSpan> spans = bk::join_events(list, 2, false);
  REQUIRE(spans.size() == 2);
  CHECK(spans[0].deepest == 0);
  CHECK(list[spans[1].deepest].found.other == 2);
}

TEST_CASE("a known event is of the same parts at the same time, at any rate") {
  CHECK(bk::is_same(known(1, 2, 10), event(30, 60, 10), 30));
  CHECK(bk::is_same(known(1, 2, 10), event(120, 130, 10), 60));
  CHECK_FALSE(bk::is_same(known(1, 2, 10), event(64, 90, 10), 30));
  CHECK(bk::is_same(known(1, 1, 10), event(30, 30, 10), 30));
  bk::Event other = event(30, 60, 10);
  other.parts[0] = "left hand";
  CHECK_FALSE(bk::is_same(known(1, 2, 10), other, 30));
  // Over the seam of a loop.
  CHECK(bk::is_same(known(1.8, 0.2, 10), event(3, 4, 10), 30));
  CHECK(bk::is_same(known(1.8, 0.2, 10), event(57, 2, 10), 30));
  CHECK_FALSE(bk::is_same(known(1.8, 0.2, 10), event(20, 30, 10), 30));
}

TEST_CASE("what is a tenth and a millimetre deeper than what was accepted is worse") {
  CHECK_FALSE(bk::is_worse(known(0, 1, 20), event(0, 30, 22.9)));
  CHECK(bk::is_worse(known(0, 1, 20), event(0, 30, 23.1)));
  bk::KnownEvent fold = known(0, 1, 20);
  fold.kind = SC_CLASS_DEEP_FOLD;
  CHECK(bk::is_worse(fold, event(0, 30, 20)));
}

TEST_CASE("a name in JUnit has no character that XML lacks") {
  bk::Verdict verdict;
  verdict.clips.emplace_back();
  verdict.clips[0].character = "a\x01<\xef\xbf\xbe&\xef\xbf\xbf\xff\xef\xbf\xbdz";
  CHECK(bk::check_junit(verdict).find("classname=\"a &lt; &amp; \xef\xbf\xbd\xef\xbf\xbdz\"") != std::string::npos);
}
