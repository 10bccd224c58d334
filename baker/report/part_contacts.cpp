// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/part_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/play/skin_player.h"
#include "baker/report/number_json.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kRunsShownMax = 6;

std::string runs_text(const std::vector<std::pair<double, double>>& runs) {
  std::string out;
  for (std::size_t i = 0; i < std::min(runs.size(), kRunsShownMax); ++i) {
    const auto [first, last] = runs[i];
    if (i > 0) out += ", ";
    out += frame_text(first);
    if (first != last) out += '-' + frame_text(last);
  }
  if (runs.size() > kRunsShownMax) out += fmt::format(" and {} more", runs.size() - kRunsShownMax);
  return out;
}

ordered_json runs_json(const std::vector<std::pair<double, double>>& runs) {
  ordered_json out = ordered_json::array();
  for (const auto& [first, last] : runs) out.push_back({number_json(first), number_json(last)});
  return out;
}

// In no frame, but between frames.
bool is_between_only(const std::vector<std::pair<double, double>>& runs) {
  return std::all_of(runs.begin(), runs.end(),
                     [](const auto& run) { return run.first == run.second && run.first != std::floor(run.first); });
}

// Pads every column but the last to its widest cell.
std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string out;
  for (const auto& row : rows) {
    out += "  ";
    for (std::size_t k = 0; k + 1 < row.size(); ++k) out += fmt::format("{:{}}   ", row[k], widths[k]);
    out += row.back() + "\n";
  }
  return out;
}

// `before` is the number of the frame before, or -1.
void add_to_runs(std::vector<std::pair<double, double>>& runs, double number, double before) {
  if (!runs.empty() && runs.back().second == before) {
    runs.back().second = number;
  } else {
    runs.emplace_back(number, number);
  }
}

}  // namespace

std::size_t PartContacts::part_of(std::uint32_t triangle) const {
  if (triangle < parts_.of_triangle.size()) return parts_.of_triangle[triangle];
  throw Error(ExitCode::kFile, animated_.file() + ": names triangles that its source does not have (bake it again)");
}

PartCounts PartContacts::add(int frame, const std::vector<Pair>& triangles,
                             const std::vector<Penetration>& penetrations) {
  PartCounts counts;
  for (const Pair& pair : triangles) ++counts[std::minmax({part_of(pair.a), part_of(pair.b)})];
  const MotionFrame& at = animated_.frame_at(frame);
  clips_.resize(animated_.clips().size());
  Clip& clip = clips_[at.clip];
  const bool is_own = at.between == 0;
  clip.contact_frames += is_own && !counts.empty() ? 1 : 0;
  const double number = animated_.number(frame);
  const double before = frame > animated_.clips()[at.clip].first ? animated_.number(frame - 1) : -1;
  for (const auto& [pair, count] : counts) {
    Contact& contact = clip.contacts[pair];
    add_to_runs(contact.runs, number, before);
    if (count > contact.triangle_pairs_max) {
      contact.triangle_pairs_max = count;
      contact.frame_of_max = number;
    }
  }
  bool has_fault = false;
  for (const Penetration& found : penetrations) {
    Contact& contact = clip.contacts[std::minmax<std::size_t>(found.part, found.other)];
    contact.parts = {found.part, found.other};
    const bool fault = is_fault(found.kind);
    has_fault = has_fault || fault;
    if (fault) add_to_runs(contact.fault_runs, number, before);
    const auto rank = [](PenetrationClass kind) { return is_fault(kind) ? kind : SC_CLASS_REST; };
    if (std::pair(rank(found.kind), mm_ * double{found.measures.depth}) >
        std::pair(rank(contact.kind), contact.depth_mm_max)) {
      contact.depth_mm_max = mm_ * double{found.measures.depth};
      contact.frame_of_depth_max = number;
      contact.direction = found.direction;
      contact.kind = found.kind;
      contact.swallowed = std::round(1e4 * double{found.measures.swallowed}) / 1e4;
      contact.passes_through = found.measures.through != 0;
    }
  }
  clip.fault_frames += is_own && has_fault ? 1 : 0;
  last_frame_ = frame;
  return counts;
}

std::string PartContacts::head(std::size_t index, const std::string& motion) const {
  const ClipFrames& frames = animated_.clips()[index];
  std::string what = frames.clip != nullptr ? "clip " + frames.name : motion.empty() ? "rest pose" : "motion " + motion;
  const int count = frames.count - frames.between;
  const std::string of = count == frames.own_count ? "" : fmt::format(" of {}", frames.own_count);
  const char* unit = count == 1 && of.empty() ? "frame" : "frames";
  what += fmt::format(": {}{} {} at {:.4g} fps", count, of, unit, frames.fps);
  if (frames.between > 0) {
    what += fmt::format(", and {} {} between them", frames.between, frames.between == 1 ? "pose" : "poses");
  }
  const int with_contact = clips_[index].contact_frames;
  if (with_contact == 0 && frames.between == 0) return what + ". No contact.\n";
  return what + fmt::format("; skin contacts in {} {}, faults in {}\n", with_contact,
                            with_contact == 1 ? "frame" : "frames", clips_[index].fault_frames);
}

std::string PartContacts::rows(const Clip& clip) const {
  std::vector<Row> order;
  std::map<PenetrationClass, int, std::greater<>> others;
  for (const auto& entry : clip.contacts) {
    const PenetrationClass kind = entry.second.kind;
    if (is_fault(kind)) {
      order.push_back(&entry);
    } else {
      ++others[kind];
    }
  }
  std::stable_sort(order.begin(), order.end(), [](Row l, Row r) {
    const auto key = [](Row row) { return std::pair(row->second.kind, row->second.depth_mm_max); };
    return key(l) > key(r);
  });
  std::vector<std::vector<std::string>> cells;
  for (const Row row : order) {
    const Contact& contact = row->second;
    const auto [first, second] = contact.parts;
    const auto& runs = contact.fault_runs;
    const char* unit = runs.size() == 1 && runs[0].first == runs[0].second ? "frame " : "frames ";
    const std::string what = contact.kind == SC_CLASS_DEEP_FOLD ? "deep fold, "
                             : contact.kind == SC_CLASS_INSIDE
                                 ? fmt::format("{}{:.0f} % inside, ", contact.passes_through ? "goes through, " : "",
                                               100 * contact.swallowed)
                                 : "";
    const auto& [x, y, z] = contact.direction;
    cells.push_back({name(first), first == second ? "itself" : name(second), unit + runs_text(runs),
                     fmt::format("{}{:.0f} mm deep at {}, out along ({:.2f}, {:.2f}, {:.2f})", what,
                                 contact.depth_mm_max, frame_text(contact.frame_of_depth_max), x, y, z)});
  }
  std::string rest;
  for (const auto& [kind, count] : others) {
    const char* plural = count == 1 ? "" : kind == SC_CLASS_TOUCH ? "es" : "s";
    const std::string what = kind == SC_CLASS_REST ? "contact" : sc_penetration_class_name(kind);
    rest += fmt::format("{}{} {}{}{}", rest.empty() ? "  besides: " : ", ", count, what, plural,
                        kind == SC_CLASS_REST ? " as at rest" : "");
  }
  std::string between;
  for (const auto& [parts, contact] : clip.contacts) {
    if (!is_between_only(contact.runs)) continue;
    const auto [first, second] = contact.parts;
    between += fmt::format("{}{}, {} at {} ({}, {:.0f} mm)", between.empty() ? "  between frames only: " : "; ",
                           name(first), name(second), frame_text(contact.frame_of_depth_max),
                           sc_penetration_class_name(contact.kind), contact.depth_mm_max);
  }
  return table(cells) + (rest.empty() ? rest : rest + "\n") + (between.empty() ? between : between + "\n");
}

std::string PartContacts::text(const std::string& motion) const {
  std::string out;
  for (std::size_t i = 0; i < clips_.size(); ++i) {
    if (animated_.clips()[i].first > last_frame_) break;
    out += head(i, motion) + rows(clips_[i]);
  }
  return out;
}

ordered_json PartContacts::json() const {
  ordered_json out = ordered_json::array();
  for (std::size_t i = 0; i < clips_.size(); ++i) {
    const ClipFrames& frames = animated_.clips()[i];
    ordered_json contacts = ordered_json::array();
    for (const auto& [pair, contact] : clips_[i].contacts) {
      contacts.push_back({{"a", name(pair.first)},
                          {"b", name(pair.second)},
                          {"frames", runs_json(contact.runs)},
                          {"fault_frames", runs_json(contact.fault_runs)},
                          {"triangle_pairs_max", contact.triangle_pairs_max},
                          {"frame_of_max", number_json(contact.frame_of_max)},
                          {"class", sc_penetration_class_name(contact.kind)},
                          {"swallowed", contact.swallowed},
                          {"through", contact.passes_through},
                          {"depth_mm_max", contact.depth_mm_max},
                          {"frame_of_depth_max", number_json(contact.frame_of_depth_max)}});
    }
    out.push_back({{"name", frames.name},
                   {"first_frame", frames.first},
                   {"frame_count", frames.count},
                   {"own_frame_count", frames.own_count},
                   {"fps", frames.fps},
                   {"contact_frames", clips_[i].contact_frames},
                   {"fault_frames", clips_[i].fault_frames},
                   {"contacts", std::move(contacts)}});
  }
  return out;
}

}  // namespace spherechain::baker
