// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/report/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/report/json_text.h"
#include "baker/report/number_json.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kWorstMisses = 20;

const char* radius_name(Radius radius) { return radius == SC_RADIUS_FIT ? "fit" : "detect"; }

// The subject of the figures that have no name of their own.
const char* reported_name(const ValidateSettings& settings) { return settings.skin ? "skin" : "all_pairs"; }

// Null where there is nothing to share.
ordered_json share_json(const std::optional<double>& share) {
  return share ? ordered_json(*share) : ordered_json(nullptr);
}

std::string share_text(const std::optional<double>& share, int digits) {
  return share ? fmt::format("{:.{}f}", *share, digits) : "-";
}

ordered_json errors_json(const ContactErrors& errors) { return {{"missing", errors.missing}, {"extra", errors.extra}}; }

ordered_json groups_json(const std::vector<PairGroup>& groups) {
  ordered_json out = ordered_json::array();
  for (const PairGroup& group : groups) {
    out.push_back({{"name", group.name},
                   {"truth_pairs", group.true_pairs},
                   {"found_pairs", group.found_pairs},
                   {"reported", group.reported}});
  }
  return out;
}

std::string groups_text(const std::string& title, const std::vector<PairGroup>& groups) {
  std::string out = fmt::format("\n{:<28} {:>8} {:>8} {:>10}\n", title, "true", "found", "reported");
  for (const PairGroup& group : groups) {
    out +=
        fmt::format("  {:<26} {:>8} {:>8} {:>10}\n", group.name, group.true_pairs, group.found_pairs, group.reported);
  }
  return out;
}

std::string score_line(const char* name, const Score& score) {
  return fmt::format("{} recall {}, precision {}, far recall {}, apart precision {}, {:.1f} pairs a frame\n", name,
                     share_text(score.pair_recall(), 3), share_text(score.precision(), 3),
                     share_text(score.far_recall(), 3), share_text(score.apart_precision(), 3),
                     score.reported_per_frame());
}

// The skin beside the spheres.
std::string scores_text(const Validation& validation, double mm) {
  std::string out = fmt::format("{:<20} {:>11} {:>10} {:>10} {:>10} {:>10} {:>15}\n", "", "pair recall", "precision",
                                "a frame", "any found", "all found", "missed depth");
  for (const auto& [name, score] :
       {std::pair{"skin", &validation.skin}, std::pair{"spheres, all pairs", &validation.all_pairs}}) {
    out += fmt::format("{:<20} {:>11} {:>10} {:>10.2f} {:>10} {:>10} {:>12.0f} mm\n", name,
                       share_text(score->pair_recall(), 4), share_text(score->precision(), 4),
                       score->reported_per_frame(), share_text(score->frame_any_recall(), 4),
                       share_text(score->frame_all_recall(), 4), mm * score->missed_depth);
  }
  return out +
         "(missed depth: of the deepest fault between two body parts of which nothing is reported;\n any, all: share "
         "of the frames with a true pair)\n";
}

std::size_t shown_misses(const Validation& validation) { return std::min(validation.misses.size(), kWorstMisses); }

}  // namespace

ordered_json score_json(const Score& score) {
  return {{"pair_recall", share_json(score.pair_recall())},
          {"far_recall", share_json(score.far_recall())},
          {"frame_any_recall", share_json(score.frame_any_recall())},
          {"frame_all_recall", share_json(score.frame_all_recall())},
          {"precision", share_json(score.precision())},
          {"apart_precision", share_json(score.apart_precision())},
          {"reported_per_frame", score.reported_per_frame()}};
}

std::string validation_json(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings) {
  const double mm = mm_per_unit(animated.asset());
  const Score& score = validation.score;
  const AssetInfo info = animated.asset()->info();
  ordered_json out{
      {"writer", kWriter},
      {"frames", score.frames},
      {"source", {{"file", info.source_file}, {"sha256", info.source_sha256}}},
      {"settings_sha256", info.settings_sha256},
      {"raw_pairs", validation.raw_pairs},
      {"out_of_scope",
       {{"rest", validation.rest}, {"same_sphere", validation.same_sphere}, {"ignored", validation.ignored}}},
      {"truth_pairs", score.true_pairs},
  };
  out.update(score_json(score));
  out.update({
      {"missed_depth_mm", mm * score.missed_depth},
      {"radius", radius_name(settings.radius)},
      {"reported", reported_name(settings)},
      {"truth_frames", score.true_frames},
      {"degenerate_triangles", validation.degenerate},
  });
  if (settings.contacts) {
    out["contacts_missing"] = validation.contacts.missing;
    out["contacts_extra"] = validation.contacts.extra;
    if (const auto& from_bones = validation.contacts_from_bones) {
      out["contacts_from_bones"] = errors_json(*from_bones);
    }
    out["neighbour_contacts"] = errors_json(validation.neighbour_contacts);
    if (const auto& from_bones = validation.neighbour_contacts_from_bones) {
      out["neighbour_contacts_from_bones"] = errors_json(*from_bones);
    }
  }
  for (const auto& [name, of] : {std::pair{"skin", &validation.skin}, std::pair{"all_pairs", &validation.all_pairs}}) {
    out[name] = score_json(*of);
    out[name]["missed_depth_mm"] = mm * of->missed_depth;
  }
  out["by_region"] = groups_json(validation.by_region);
  out["worst_misses"] = ordered_json::array();
  for (std::size_t i = 0; i < shown_misses(validation); ++i) {
    const Miss& miss = validation.misses[i];
    out["worst_misses"].push_back({{"frame", miss.frame},
                                   {"time", animated.time(miss.frame)},
                                   {"clip_frame", number_json(animated.number(miss.frame))},
                                   {"spheres", {miss.spheres.a, miss.spheres.b}},
                                   {"triangle_pairs", miss.triangle_pairs},
                                   {"depth_mm", mm * miss.depth}});
    if (const std::string& clip = animated.clip_at(miss.frame); !clip.empty())
      out["worst_misses"].back()["clip"] = clip;
  }
  return json_text(out, 1) + "\n";
}

std::string validation_text(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings) {
  const double mm = mm_per_unit(animated.asset());
  const Score& score = validation.score;
  std::string out = fmt::format("{} frames, radius {}\n\n", score.frames, radius_name(settings.radius));
  out += fmt::format("triangle pairs that intersect   {:>8}\n", validation.raw_pairs);
  out += fmt::format("  at rest too                   {:>8}\n", validation.rest);
  out += fmt::format("  of one sphere                 {:>8}\n", validation.same_sphere);
  out += fmt::format("  of ignored spheres            {:>8}\n", validation.ignored);
  out += fmt::format("  true                          {:>8}  in {} frames\n\n", score.true_pairs, score.true_frames);
  if (score.true_pairs == 0) out += "no true contact in this motion: there is nothing to recall\n";
  out += score_line("spheres:", validation.all_pairs) + score_line("skin:   ", validation.skin) + "\n";
  out += scores_text(validation, mm);
  if (settings.contacts) {
    const auto errors = [](const ContactErrors& of) {
      return fmt::format("{} missing, {} extra", of.missing, of.extra);
    };
    const auto line = [&](const char* name, const ContactErrors& contacts,
                          const std::optional<ContactErrors>& from_bones) {
      return fmt::format("{:<17}{}; from bones {}\n", name, errors(contacts),
                         from_bones ? errors(*from_bones) : "not compared: none move it");
    };
    out += line("contacts", validation.contacts, validation.contacts_from_bones);
    out += line("of neighbours", validation.neighbour_contacts, validation.neighbour_contacts_from_bones);
  }
  if (!validation.misses.empty()) {
    out += fmt::format(
        "\nworst misses of {}: frame, spheres, triangle pairs, depth in mm where it is a fault of which nothing is "
        "reported\n",
        reported_name(settings));
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(shown_misses(validation), 5); ++i) {
    const Miss& miss = validation.misses[i];
    out += fmt::format("  {:>5}  {:>3} - {:<3} {:>5}  {:.0f}\n", miss.frame, miss.spheres.a, miss.spheres.b,
                       miss.triangle_pairs, mm * miss.depth);
  }
  out += groups_text(fmt::format("{} between regions", reported_name(settings)), validation.by_region);
  return out;
}

}  // namespace spherechain::baker
