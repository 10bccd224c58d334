// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "baker/check/formats.h"
#include "baker/mesh/utf8.h"
#include "baker/play/motion_frames.h"
#include "baker/report/json_text.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// XML has no control characters, nor U+FFFE and U+FFFF, and nothing has bytes that are not UTF-8.
std::string xml(const std::string& text) {
  std::string clean = json_text(text, -1);  // replaces what is not UTF-8
  clean = ordered_json::parse(clean).get<std::string>();
  std::string out;
  for (std::string_view left = clean; !left.empty();) {
    const CodePoint point = *first_code_point(left);
    switch (point.code) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        if (point.code < 0x20 || point.code == 0xFFFE || point.code == 0xFFFF) {
          out += ' ';
        } else {
          out += left.substr(0, point.length);
        }
    }
    left.remove_prefix(point.length);
  }
  return out;
}

std::string uri(const std::string& path) {
  std::string out;
  for (const char c : path) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string("/-._~").find(c) != std::string::npos;
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string fault_text(const EvaluatedEvent& evaluated) {
  const Event& event = evaluated.event;
  const std::string worse = worse_text(evaluated);
  return fmt::format("{}: {}, {:.0f} mm deep at frame {}{}", frames_text(event), parts_text(event), event.depth_mm,
                     frame_text(event.deepest), worse.empty() ? worse : ", " + worse);
}

struct Failures {
  int count = 0;
  std::string lines;  // tickets, the worst first, each with its events of the clip below it
};

std::vector<Failures> failures_of_clips(const Verdict& verdict) {
  std::vector<Failures> out(verdict.clips.size());
  for (const Ticket& ticket : verdict.tickets) {
    std::map<std::size_t, std::string> of_clip;
    for (const auto& [c, e] : ticket.events) {
      const EvaluatedEvent& evaluated = verdict.clips[c].events[e];
      if (!evaluated.fails) continue;
      ++out[c].count;
      of_clip[c] += "  " + fault_text(evaluated) + "\n";
    }
    for (const auto& [c, events] : of_clip)
      out[c].lines += fmt::format("{} (ticket {})\n{}", ticket.title, ticket.id, events);
  }
  return out;
}

std::string testcase(const EvaluatedClip& clip, const Failures& failures) {
  std::string out = fmt::format("  <testcase classname=\"{}\" name=\"{}\"", xml(clip.character),
                                xml(clip.clip.clip.empty() ? "character" : clip.clip.clip));
  if (!clip.clip.error.empty()) return out + fmt::format("><error message=\"{}\"/></testcase>\n", xml(clip.clip.error));
  if (clip.clip.clip.empty()) return out + "><skipped message=\"no clips\"/></testcase>\n";
  if (failures.count == 0) return out + "/>\n";
  return out + fmt::format("><failure message=\"{} {}\" type=\"penetration\">{}</failure></testcase>\n", failures.count,
                           failures.count == 1 ? "fault" : "faults", xml(failures.lines));
}

}  // namespace

std::string check_junit(const Verdict& verdict) {
  const std::vector<Failures> of_clips = failures_of_clips(verdict);
  int failures = 0;
  std::string cases;
  for (std::size_t c = 0; c < verdict.clips.size(); ++c) {
    failures += of_clips[c].count > 0 ? 1 : 0;
    cases += testcase(verdict.clips[c], of_clips[c]);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n <testsuite name=\"spherechain check\" tests=\"{}\" "
      "failures=\"{}\" errors=\"{}\">\n{} </testsuite>\n</testsuites>\n",
      verdict.clips.size(), failures, verdict.summary.errors, cases);
}

std::string check_sarif(const Verdict& verdict) {
  ordered_json results = ordered_json::array();
  const auto add = [&](const EvaluatedClip& clip, const std::string& rule, const char* level,
                       const std::string& text) -> ordered_json& {
    results.push_back({{"ruleId", rule},
                       {"level", level},
                       {"message", {{"text", text}}},
                       {"locations",
                        {{{"physicalLocation", {{"artifactLocation", {{"uri", uri(clip.file)}}}}},
                          {"logicalLocations", {{{"name", clip.clip.clip}, {"kind", "clip"}}}}}}}});
    return results.back();
  };
  for (const EvaluatedClip& clip : verdict.clips) {
    if (!clip.clip.error.empty()) add(clip, "unreadable", "error", clip.clip.error);
    for (const EvaluatedEvent& evaluated : clip.events) {
      if (!is_fault(evaluated.event.kind)) continue;
      const bool is_gone = evaluated.state == EventState::kResolved;
      const char* level = evaluated.fails ? "error" : evaluated.severity == Severity::kIgnore ? "note" : "warning";
      ordered_json& result = add(clip, sc_penetration_class_name(evaluated.event.kind), is_gone ? "none" : level,
                                 clip.clip.clip + ", " + fault_text(evaluated));
      result["baselineState"] = is_gone                               ? "absent"
                                : evaluated.before_mm >= 0            ? "updated"
                                : evaluated.state == EventState::kNew ? "new"
                                                                      : "unchanged";
      if (evaluated.state == EventState::kAccepted || !evaluated.rule.empty()) {
        result["suppressions"] = {
            {{"kind", "external"}, {"justification", evaluated.rule.empty() ? "accepted" : evaluated.rule}}};
      }
    }
  }
  ordered_json rules = ordered_json::array();
  for (const auto& [id, text] : {std::pair("penetration", "A body part is in another."),
                                 std::pair("inside", "Most of a body part is inside another."),
                                 std::pair("deep_fold", "A fold of the skin is very deep."),
                                 std::pair("unreadable", "A file cannot be checked.")}) {
    rules.push_back({{"id", id}, {"shortDescription", {{"text", text}}}});
  }
  return json_text({{"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
                    {"version", "2.1.0"},
                    {"runs",
                     {{{"tool", {{"driver", {{"name", "spherechain"}, {"version", kVersion}, {"rules", rules}}}}},
                       {"results", results}}}}},
                   1) +
         "\n";
}

}  // namespace spherechain::baker
