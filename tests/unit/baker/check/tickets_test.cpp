#include "baker/check/tickets.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baker/check/formats.h"

namespace {

namespace bk = spherechain::baker;

bk::EvaluatedEvent fault(const char* part, const char* other, double from, double to, double percent) {
  bk::EvaluatedEvent out;
  out.event.parts = {part, other};
  out.event.kind = SC_CLASS_PENETRATION;
  out.event.from = out.event.deepest = from;
  out.event.to = to;
  out.event.depth_percent = percent;
  out.event.depth_mm = 18 * percent;
  out.event.eye = bk::Vec3::UnitX();
  return out;
}

bk::EvaluatedClip clip(const char* name, std::vector<bk::EvaluatedEvent> events) {
  bk::EvaluatedClip out{"hero", "hero.glb", {}, {}, {}, 100, 0, 30, false, std::move(events), {}};
  out.clip.clip = name;
  out.clip.character_key = "key";
  return out;
}

// A biped with a tail.
const std::vector<bk::BodyPart>& body() {
  using bk::Side;
  static const std::vector<bk::BodyPart> parts{
      {"hips", Side::kNone, 0},           {"chest", Side::kNone, 1, 0},     {"head", Side::kNone, 2, 1},
      {"left arm", Side::kLeft, 3, 1},    {"left hand", Side::kLeft, 4, 3}, {"right arm", Side::kRight, 5, 1},
      {"right hand", Side::kRight, 6, 5}, {"left leg", Side::kLeft, 7, 0},  {"right leg", Side::kRight, 8, 0},
      {"tail", Side::kNone, 9, 0},        {"tail tip", Side::kNone, 10, 9}};
  return parts;
}

std::vector<bk::Ticket> tickets_of(const std::vector<bk::EvaluatedClip>& clips) {
  bk::CharacterResult character;
  for (const bk::BodyPart& part : body()) character.parts.push_back(part.name);
  character.limbs = bk::limbs_of(body());
  return bk::find_tickets(clips, {{"key", character}});
}

}  // namespace

TEST_CASE("a limb is all that hangs on one part of the trunk, which both sides hang on") {
  CHECK(bk::limbs_of(body()) == std::vector<std::string>{"", "", "head", "left arm", "left arm", "right arm",
                                                         "right arm", "left leg", "right leg", "tail", "tail"});
  CHECK(bk::limbs_of({{"snake", bk::Side::kNone, 0}}) == std::vector<std::string>{"snake"});
}

TEST_CASE("one cause is one ticket: repeats, mirrored sides, a limb through several parts, equal clips") {
  const auto count = [](const std::vector<bk::EvaluatedEvent>& events) {
    return tickets_of({clip("walk", events)}).size();
  };
  const auto hand = fault("left hand", "hips", 10, 20, 3);
  CHECK(count({hand, fault("left hand", "hips", 50, 60, 2)}) == 1);
  CHECK(count({hand, fault("hips", "right hand", 50, 60, 2)}) == 1);
  CHECK(count({hand, fault("left arm", "chest", 12, 22, 2)}) == 1);
  CHECK(count({hand, fault("left arm", "chest", 18, 30, 2)}) == 2);    // at another time
  CHECK(count({hand, fault("right hand", "chest", 12, 22, 2)}) == 2);  // only the trunk is the same
  CHECK(count({hand, fault("tail tip", "left leg", 10, 20, 2), fault("tail", "right leg", 10, 20, 2)}) == 2);
  // The tail meets what meets the hand at the same time, but is another limb's fault.
  CHECK(count({hand, fault("left hand", "tail", 10, 20, 2), fault("tail", "right leg", 10, 20, 1)}) == 2);
  auto over_loop = fault("left arm", "chest", 90, 15, 2);
  over_loop.event.depths_mm.resize(25);
  CHECK(count({fault("left hand", "hips", 95, 99, 3), over_loop}) == 1);
  auto excused = hand, gone = hand;
  excused.rule = "fine";
  gone.state = bk::EventState::kResolved;
  CHECK(count({excused, gone}) == 0);

  const auto other = fault("tail", "left leg", 70, 80, 2);
  CHECK(tickets_of({clip("walk", {hand, other}), clip("walk again", {hand, other})}).size() == 2);
  CHECK(tickets_of({clip("walk", {hand}), clip("run", {fault("left hand", "hips", 10, 20, 3.1)})}).size() == 2);
}

TEST_CASE("tickets come with the worst first: deeper, longer, inside, seen; ids stay as depths and times change") {
  auto inside = fault("left hand", "hips", 0, 10, 3), hidden = fault("head", "chest", 0, 10, 9);
  inside.event.kind = SC_CLASS_INSIDE;
  inside.event.swallowed = 0.8;
  hidden.event.eye.reset();
  const auto deep = fault("tail", "left leg", 40, 50, 6), brief = fault("right leg", "left leg", 60, 61, 6);
  const auto walk = clip("walk", {hidden, brief, deep, inside});
  const std::vector<bk::Ticket> tickets = tickets_of({walk});
  REQUIRE(tickets.size() == 4);
  std::vector<std::size_t> order;
  for (const bk::Ticket& ticket : tickets) order.push_back(ticket.events[0].event);
  CHECK(order == std::vector<std::size_t>{3, 2, 1, 0});
  CHECK(tickets[0].title == "hero walk: left hand in hips");
  CHECK(tickets[1].severity == doctest::Approx(6 * std::sqrt(11.0 / 30)));

  auto flickers = deep;
  flickers.event.depths_mm = {0, 90, 0, 0, 0, 0, 0, 0, 0, 108, 108};
  CHECK(bk::severity(flickers.event, 30) == doctest::Approx(6 * std::sqrt(0.1)));
  CHECK(bk::frames_text(flickers.event) == "frames 40-50, 3 faulty");

  auto later = walk;
  later.events[3].event.from = 3;
  later.events[3].event.depth_percent = 4;
  later.events[3].state = bk::EventState::kKnown;
  const bk::Ticket again = tickets_of({later})[0];
  CHECK(again.id == tickets[0].id);
  CHECK(again.state == bk::EventState::kKnown);
  CHECK(tickets[0].state == bk::EventState::kNew);
  CHECK(again.id != tickets[1].id);
}

TEST_CASE("text has a ticket's other events below its worst; or only what is new") {
  bk::Verdict verdict;
  verdict.clips = {clip("walk", {fault("left hand", "hips", 10, 20, 3), fault("left arm", "chest", 10, 20, 4)})};
  verdict.clips[0].events[1].state = bk::EventState::kKnown;
  verdict.tickets = tickets_of(verdict.clips);
  const std::string all = bk::check_text(verdict, false), fresh = bk::check_text(verdict, true);
  CHECK(all.starts_with("hero walk"));
  CHECK(all.find("left arm in chest  72 mm, 4.0 %") < all.find("\n  hero walk"));
  CHECK(fresh.starts_with("hero walk  frames 10-20  left hand in hips  54 mm, 3.0 %"));
  CHECK(fresh.find("left arm") == std::string::npos);
}
