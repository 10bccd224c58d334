// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/report_folder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "baker/check/formats.h"
#include "baker/check/heat.h"
#include "baker/events/event_json.h"
#include "baker/mesh/error.h"
#include "baker/os/own_folder.h"
#include "baker/page/base64.h"
#include "baker/play/asset_file.h"
#include "baker/report/json_text.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::size_t kStripWidth = 100;

// The deepest fault that no rule excuses, over the clip: bytes of half millimetres.
std::string strip(const EvaluatedClip& clip) {
  const auto frames = static_cast<std::size_t>(clip.frames + clip.between);
  std::vector<std::uint8_t> out(std::clamp<std::size_t>(frames, 1, kStripWidth), 0);
  for (const EvaluatedEvent& evaluated : clip.events) {
    if (!evaluated.is_open()) continue;
    for (std::size_t i = 0; i < evaluated.event.depths_mm.size(); ++i) {
      const std::size_t frame = (static_cast<std::size_t>(evaluated.event.first_place) + i) % frames;
      std::uint8_t& bar = out[frame * out.size() / frames];
      bar = std::max(bar, static_cast<std::uint8_t>(
                              std::clamp(2.0 * static_cast<double>(evaluated.event.depths_mm[i]), 0.0, 255.0)));
    }
  }
  return base64(out);
}

// An event as pages have it, with shorter numbers: a library may have thousands of events.
ordered_json page_event(const EvaluatedEvent& evaluated) {
  const Event& event = evaluated.event;
  ordered_json out = event_json(event);
  for (const char* key : {"direction", "volume_ml"}) out.erase(key);
  out["depth_mm"] = std::round(1000 * event.depth_mm) / 1000;
  out["depth_percent"] = std::round(100 * event.depth_percent) / 100;
  if (event.volume_ml >= 0) out["volume_ml"] = std::round(10 * event.volume_ml) / 10;
  out["text"] = parts_text(event);
  out["place"] = event.place;
  out["state"] = state_name(evaluated.state);
  out["fails"] = evaluated.fails;
  if (!evaluated.rule.empty()) out["rule"] = evaluated.rule;
  if (evaluated.before_mm >= 0) out["before"] = evaluated.before_mm;
  return out;
}

ordered_json page_poke(const EvaluatedPoke& poke) {
  ordered_json out = poke_json(poke.event);
  for (const char* key : {"area_cm2", "height_mm"}) out[key] = std::round(10 * out[key].get<double>()) / 10;
  out["text"] = poke_text(poke.event);
  out["place"] = poke.event.place;
  out["state"] = state_name(EventState::kKnown);
  out["fails"] = false;
  out["poke"] = poke.number;
  return out;
}

std::string data_name(const std::string& key) { return "data/" + key.substr(0, 2) + "/" + key.substr(2, 30); }

// The frame of the worst fault that no rule excuses, as in the library's row; else the clip's first frame.
std::size_t picture_of(const EvaluatedClip& clip) {
  const EvaluatedEvent* worst = nullptr;
  const auto badness = [](const EvaluatedEvent& e) { return std::pair(e.event.kind, e.event.depth_mm); };
  for (const EvaluatedEvent& evaluated : clip.events) {
    if (evaluated.is_open() && (worst == nullptr || badness(evaluated) > badness(*worst))) worst = &evaluated;
  }
  return worst == nullptr ? 0 : static_cast<std::size_t>(worst->event.picture);
}

bool is_on_page(const EvaluatedEvent& evaluated) {
  return is_fault(evaluated.event.kind) || evaluated.state == EventState::kResolved;
}

// The ticket's worst event that has a picture: each two parts have one of their most severe, and one of their deepest.
Ticket::Shown pictured(const Ticket& ticket, const Verdict& verdict) {
  return *std::find_if(ticket.events.begin(), ticket.events.end() - 1, [&](const Ticket::Shown& shown) {
    return verdict.clips[shown.clip].events[shown.event].event.picture > 0;
  });
}

// A ticket as the page has it: its events by row and by place among the row's events.
ordered_json page_ticket(const Ticket& ticket, const Verdict& verdict) {
  ordered_json events = ordered_json::array();
  for (const auto& [c, e] : ticket.events) {
    const auto begin = verdict.clips[c].events.begin();
    events.push_back({c, std::count_if(begin, begin + static_cast<std::ptrdiff_t>(e), is_on_page)});
  }
  const auto [c, e] = pictured(ticket, verdict);
  const auto picture = static_cast<std::size_t>(verdict.clips[c].events[e].event.picture);
  return {{"id", ticket.id},
          {"severity", std::round(100 * ticket.severity) / 100},
          {"events", events},
          {"picture", data_name(verdict.clips[c].clip.key) + picture_file(picture)}};
}

ordered_json page_clip(const EvaluatedClip& clip) {
  ordered_json out{{"character", clip.character}, {"clip", clip.clip.clip}};
  if (!clip.clip.error.empty()) out["error"] = clip.clip.error;
  if (clip.clip.key.empty() || !clip.clip.error.empty()) return out;
  out["fps"] = clip.fps;
  out["frames"] = clip.frames;
  out["fit"] = clip.grade;
  out["data"] = data_name(clip.clip.key);
  out["body"] = data_name(clip.clip.character_key);
  out["strip"] = strip(clip);
  out["picture"] = data_name(clip.clip.key) + picture_file(picture_of(clip));
  ordered_json& events = out["events"] = ordered_json::array();
  int minor = 0;
  for (const EvaluatedEvent& evaluated : clip.events) {
    if (is_on_page(evaluated)) {
      events.push_back(page_event(evaluated));
      if (evaluated.event.picture > 0) events.back()["picture"] = evaluated.event.picture;  // its file's number
    } else {
      ++minor;
    }
  }
  for (const EvaluatedPoke& poke : clip.pokes) events.push_back(page_poke(poke));
  for (const auto& [kind, count] : clip.besides) minor += count;
  out["minor"] = minor;
  return out;
}

// Where on a character's skin its faults are that no rule excuses, in all of its clips.
class HeatMap {
 public:
  void add(const std::string& bytes, const EvaluatedClip& clip) {
    frames_ += clip.frames;
    std::set<std::size_t> open;
    for (const EvaluatedEvent& evaluated : clip.events) {
      if (evaluated.is_open()) open.insert(evaluated.number);
    }
    std::vector<HeatSpot> spots(bytes.size() / sizeof(HeatSpot));
    if (!spots.empty()) std::memcpy(spots.data(), bytes.data(), spots.size() * sizeof(HeatSpot));
    for (const HeatSpot& spot : spots) {
      if (open.count(spot.event) == 0) continue;
      HeatSpot& sum = spots_.try_emplace(spot.triangle, HeatSpot{0, spot.triangle, 0, 0}).first->second;
      sum.frames += spot.frames;
      sum.depth_mm = std::max(sum.depth_mm, spot.depth_mm);
    }
  }
  std::string page() const {
    std::vector<std::uint32_t> triangles, frames;
    std::vector<float> depths;
    for (const auto& [triangle, spot] : spots_) {
      triangles.push_back(triangle);
      frames.push_back(static_cast<std::uint32_t>(std::min<long>(spot.frames, frames_)));  // events may coincide
      depths.push_back(spot.depth_mm);
    }
    const ordered_json json{
        {"of", frames_}, {"triangles", base64(triangles)}, {"frames", base64(frames)}, {"mm", base64(depths)}};
    return "spherechain.heat = " + json_text(json, -1) + ";\n";
  }

 private:
  long frames_ = 0;
  std::map<std::uint32_t, HeatSpot> spots_;
};

bool is_page(const std::string& name) { return name == "index.html" || name == "clip.html" || name == "library.js"; }

constexpr const char* kKind = "check report";

}  // namespace

void check_report_folder(const fs::path& folder) { OwnFolder::check(folder, kKind, is_page); }

bool write_report(const fs::path& folder, const Verdict& verdict, const Store& store, const fs::path& pages) {
  OwnFolder report(folder, kKind);
  const auto take = [&](const std::string& key, const std::string& kind) {
    report.write(data_name(key) + kind, store.take(key, kind));
  };
  ordered_json clips = ordered_json::array();
  std::map<std::string, HeatMap> heat;      // by character
  std::map<std::string, std::string> fits;  // by body
  for (const EvaluatedClip& clip : verdict.clips) {
    clips.push_back(page_clip(clip));
    if (!clips.back().contains("data")) continue;
    take(clip.clip.key, kPageFile);
    take(clip.clip.key, picture_file(picture_of(clip)));
    take(clip.clip.character_key, kPageFile);
    fits[data_name(clip.clip.character_key)] = clip.fit;
    heat[clip.clip.character_key].add(store.take(clip.clip.key, kHeatFile), clip);
  }
  ordered_json tickets = ordered_json::array();
  for (const Ticket& ticket : verdict.tickets) {
    tickets.push_back(page_ticket(ticket, verdict));
    const auto [c, e] = pictured(ticket, verdict);
    const EvaluatedClip& clip = verdict.clips[c];
    const auto picture = static_cast<std::size_t>(clip.events[e].event.picture);
    if (picture != picture_of(clip)) take(clip.clip.key, picture_file(picture));
  }
  for (const auto& [character, map] : heat) report.write(data_name(character) + "_heat.js", map.page());
  const Summary& s = verdict.summary;
  const ordered_json library{{"fails", verdict.fails},
                             {"characters", s.characters},
                             {"clips", s.clips},
                             {"frames", s.frames},
                             {"penetrations", s.penetrations},
                             {"deep_folds", s.deep_folds},
                             {"new", s.fresh},
                             {"errors", s.errors},
                             {"fits", fits},
                             {"tickets", std::move(tickets)},
                             {"rows", std::move(clips)}};
  report.write("library.js", "spherechain.library = " + json_text(library, -1) + ";\n");
  bool has_pages = true;
  for (const std::string page : {"index.html", "clip.html"}) {
    const fs::path made = pages / ("report_" + page);
    std::error_code ignored;
    has_pages = has_pages && fs::is_regular_file(made, ignored);
    if (has_pages) report.write(page, read_file(made.string()));
  }
  report.finish();
  return has_pages;
}

}  // namespace spherechain::baker
