// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/baseline.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "baker/check/json_input.h"
#include "baker/events/class_names.h"
#include "baker/mesh/error.h"
#include "baker/play/asset_file.h"
#include "baker/report/json_text.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// An event over a loop's seam is both at the start and at the end.
bool overlap(double from_a, double to_a, double from_b, double to_b) {
  if (from_a > to_a) return overlap(0, to_a, from_b, to_b) || overlap(from_a, 1e9, from_b, to_b);
  if (from_b > to_b) return overlap(from_a, to_a, 0, to_b) || overlap(from_a, to_a, from_b, 1e9);
  return from_a <= to_b && from_b <= to_a;
}

constexpr const char* kList = "spherechain_baseline";

// An entry of a baseline. Says what is wrong by the entry's number, from 1, and the key.
class EntryReader {
 public:
  EntryReader(const ordered_json& entry, std::size_t number, const std::string& file)
      : entry_(entry), place_(fmt::format("{}: '{}', entry {}", file, kList, number)) {}

  KnownEvent read() const {
    if (!entry_.is_object()) throw Error(ExitCode::kFile, place_ + ": is not an object (--accept writes one)");
    KnownEvent out{};
    out.character = text("character");
    out.clip = text("clip");
    out.parts = parts();
    out.kind = kind();
    out.from = number("from_seconds");
    out.to = number("to_seconds");
    out.depth_mm = number("depth_mm");
    out.state = state();
    out.entry = entry_;
    return out;
  }

 private:
  [[noreturn]] void fail(const char* key, const std::string& expected) const {
    const std::string found = entry_.contains(key) ? "is not " : "is missing: ";
    throw Error(ExitCode::kFile, fmt::format("{}: '{}' {}{}", place_, key, found, expected));
  }

  const ordered_json& at(const char* key) const {
    static const ordered_json kNone;
    const auto found = entry_.find(key);
    return found == entry_.end() ? kNone : *found;
  }

  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(key, "a name");
    return at(key).get<std::string>();
  }

  double number(const char* key) const {
    if (!at(key).is_number() || !(at(key).get<double>() >= 0)) fail(key, "a number, 0 or more");
    return at(key).get<double>();
  }

  std::array<std::string, 2> parts() const {
    const ordered_json& list = at("parts");
    if (!list.is_array() || list.size() != 2 || !list[0].is_string() || !list[1].is_string()) {
      fail("parts", "a list of two body parts");
    }
    return {list[0].get<std::string>(), list[1].get<std::string>()};
  }

  PenetrationClass kind() const {
    const std::string name = at("class").is_string() ? text("class") : std::string();
    const PenetrationClass out = class_of_name(name);
    if (name != sc_penetration_class_name(out)) fail("class", "a class of contacts (penetration, deep_fold)");
    return out;
  }

  EventState state() const {
    if (at("state") == "accepted") return EventState::kAccepted;
    if (at("state") != "known") fail("state", "accepted or known");
    return EventState::kKnown;
  }

  const ordered_json& entry_;
  std::string place_;
};

}  // namespace

const char* state_name(EventState state) {
  switch (state) {
    case EventState::kNew:
      return "new";
    case EventState::kKnown:
      return "known";
    case EventState::kAccepted:
      return "accepted";
    case EventState::kResolved:
      break;
  }
  return "resolved";
}

Baseline read_baseline(const std::string& file, bool may_be_missing) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    if (may_be_missing) return {};
    throw Error(ExitCode::kFile, file + ": no such file (--accept writes it)");
  }
  Baseline out;
  out.file = parse_input(read_file(file), file, "is no baseline");
  const auto list = out.file.is_object() ? out.file.find(kList) : out.file.end();
  if (list == out.file.end() || !list->is_array()) {
    throw Error(ExitCode::kFile,
                fmt::format("{}: is no baseline: it has no list '{}' (--accept writes one)", file, kList));
  }
  for (const ordered_json& entry : *list) {
    out.events.push_back(EntryReader(entry, out.events.size() + 1, file).read());
  }
  return out;
}

std::string to_bytes(const Baseline& baseline) {
  ordered_json events = ordered_json::array();
  for (const KnownEvent& event : baseline.events) {
    ordered_json entry = event.entry.is_object() ? event.entry : ordered_json::object();
    entry.update({{"character", event.character},
                  {"clip", event.clip},
                  {"parts", event.parts},
                  {"class", sc_penetration_class_name(event.kind)},
                  {"from_seconds", event.from},
                  {"to_seconds", event.to},
                  {"depth_mm", event.depth_mm},
                  {"state", state_name(event.state)}});
    events.push_back(std::move(entry));
  }
  ordered_json out = baseline.file.is_object() ? baseline.file : ordered_json::object();
  out[kList] = std::move(events);
  return json_text(out, 1) + "\n";
}

bool is_same(const KnownEvent& known, const Event& event, double fps) {
  const bool same_parts =
      known.parts == event.parts || (known.parts[0] == event.parts[1] && known.parts[1] == event.parts[0]);
  const double half = 0.5 / fps;  // an event of one frame has a length, too
  return same_parts && overlap(known.from - half, known.to + half, event.from / fps - half, event.to / fps + half);
}

bool is_looked_for(const KnownEvent& known, const ClipResult& result) {
  if (result.continuous || known.from > known.to) return true;
  constexpr double kRounding = 1e-3;  // frames
  const double from = known.from * result.fps, to = known.to * result.fps;
  return from >= result.frames || std::ceil(from - kRounding) <= to + kRounding;
}

bool is_worse(const KnownEvent& known, const Event& event) {
  return event.kind > known.kind || event.depth_mm > 1.1 * known.depth_mm + 1;
}

}  // namespace spherechain::baker
