// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "report/json_text.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kWorstMisses = 20;

const char* radius_name(RadiusKind radius) { return radius == RadiusKind::kFit ? "fit" : "detect"; }
const char* method_name(Method method) { return method == Method::kM1 ? "m1" : "m2"; }

// The shares of a score, as the contract names them.
ordered_json score_json(const Score& score) {
  return {{"pair_recall", score.pair_recall()},
          {"frame_any_recall", score.frame_any_recall()},
          {"frame_all_recall", score.frame_all_recall()},
          {"precision", score.precision()},
          {"reported_per_frame", score.reported_per_frame()}};
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

// The points whose radius, or whose rest-distance rule, is another.
ordered_json curve_json(const std::vector<CurvePoint>& curve, bool radius) {
  ordered_json out = ordered_json::array();
  for (const CurvePoint& point : curve) {
    if (radius == point.change.near_fraction.has_value()) continue;
    ordered_json entry;
    if (radius) {
      entry["scale"] = point.change.scale;
    } else {
      entry["near_fraction"] = *point.change.near_fraction;
    }
    entry["m1"] = score_json(point.m1);
    entry["m2"] = score_json(point.m2);
    out.push_back(std::move(entry));
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

std::string curve_row(const std::string& name, const Score& m1, const Score& m2) {
  return fmt::format("  {:<16} {:>9.4f} {:>9.4f} {:>9.2f}   {:>9.4f} {:>9.4f} {:>9.2f}\n", name, m2.pair_recall(),
                     m2.precision(), m2.reported_per_frame(), m1.pair_recall(), m1.precision(),
                     m1.reported_per_frame());
}

std::string curve_text(const Validation& validation) {
  std::string out = fmt::format("\n{:<18} {:>9} {:>9} {:>9}   {:>9} {:>9} {:>9}\n", "", "M2 recall", "precision",
                                "a frame", "M1 recall", "precision", "a frame");
  out += curve_row("as it is", validation.m1, validation.m2);
  for (const CurvePoint& point : validation.curve) {
    const std::string name = point.change.near_fraction ? fmt::format("near at {:.1f}", *point.change.near_fraction)
                                                        : fmt::format("radius x {:.1f}", point.change.scale);
    out += curve_row(name, point.m1, point.m2);
  }
  return out;
}

std::size_t shown_misses(const Validation& validation) { return std::min(validation.misses.size(), kWorstMisses); }

}  // namespace

std::string validation_json(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings) {
  const double height = animated.frame().height;
  const Score& score = validation.score;
  const AssetInfo info = animated.asset().info();
  ordered_json out{
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
      {"missed_depth", score.missed_depth / height},
      {"radius", radius_name(settings.radius)},
      {"mode", method_name(settings.method)},
      {"skin", reports_skin(animated.asset(), settings)},
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
  for (const auto& [name, spheres] : {std::pair{"m1", &validation.m1}, std::pair{"m2", &validation.m2}}) {
    out[name] = score_json(*spheres);
    out[name]["missed_depth"] = spheres->missed_depth / height;
  }
  if (validation.capsules > 0) {
    out["capsules"] = {{"count", validation.capsules}, {"curve", ordered_json::array()}};
    for (const CapsulePoint& point : validation.capsule_curve) {
      ordered_json entry{{"quantile", point.quantile}};
      entry.update(score_json(point.score));
      entry["own_truth_pairs"] = point.own.true_pairs;
      entry["own_pair_recall"] = point.own.pair_recall();
      out["capsules"]["curve"].push_back(std::move(entry));
    }
  }
  out["by_region"] = groups_json(validation.by_region);
  out["by_chain"] = groups_json(validation.by_chain);
  out["radius_curve"] = curve_json(validation.curve, true);
  out["near_curve"] = curve_json(validation.curve, false);
  out["worst_misses"] = ordered_json::array();
  for (std::size_t i = 0; i < shown_misses(validation); ++i) {
    const Miss& miss = validation.misses[i];
    out["worst_misses"].push_back({{"frame", miss.frame},
                                   {"time", animated.time(miss.frame)},
                                   {"spheres", {miss.spheres.a, miss.spheres.b}},
                                   {"triangle_pairs", miss.triangle_pairs},
                                   {"depth", miss.depth / height}});
  }
  return json_text(out, 1) + "\n";
}

std::string validation_text(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings) {
  const double height = animated.frame().height;
  const Score& score = validation.score;
  std::string out = fmt::format("{} frames, radius {}, {}{}\n\n", score.frames, radius_name(settings.radius),
                                settings.method == Method::kM1 ? "M1" : "M2",
                                reports_skin(animated.asset(), settings) ? ", reported by the skin" : "");
  out += fmt::format("triangle pairs that intersect   {:>8}\n", validation.raw_pairs);
  out += fmt::format("  at rest too                   {:>8}\n", validation.rest);
  out += fmt::format("  of one sphere                 {:>8}\n", validation.same_sphere);
  out += fmt::format("  of ignored spheres            {:>8}\n", validation.ignored);
  out += fmt::format("  true                          {:>8}  in {} frames\n\n", score.true_pairs, score.true_frames);
  out += fmt::format("pair recall      {:.4f}\n", score.pair_recall());
  out += fmt::format("frame recall     {:.4f} any, {:.4f} all\n", score.frame_any_recall(), score.frame_all_recall());
  out += fmt::format("precision        {:.4f}\n", score.precision());
  out += fmt::format("reported         {:.2f} pairs a frame\n", score.reported_per_frame());
  out += fmt::format("missed depth     {:.2f} % of the height\n", 100 * score.missed_depth / height);
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
  if (!validation.misses.empty()) out += "\nworst misses: frame, spheres, triangle pairs, depth in % of the height\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(shown_misses(validation), 5); ++i) {
    const Miss& miss = validation.misses[i];
    out += fmt::format("  {:>5}  {:>3} - {:<3} {:>5}  {:.2f}\n", miss.frame, miss.spheres.a, miss.spheres.b,
                       miss.triangle_pairs, 100 * miss.depth / height);
  }
  if (validation.capsules > 0) {
    out += fmt::format("\n{:<18} {:>9} {:>9} {:>9}   {:>9}\n", fmt::format("{} capsules", validation.capsules),
                       "recall", "precision", "a frame", "own truth");
    for (const CapsulePoint& point : validation.capsule_curve) {
      out += fmt::format("  {:<16} {:>9.4f} {:>9.4f} {:>9.2f}   {:>9.4f}\n",
                         fmt::format("quantile {:.1f}", point.quantile), point.score.pair_recall(),
                         point.score.precision(), point.score.reported_per_frame(), point.own.pair_recall());
    }
  }
  out += groups_text("between regions", validation.by_region);
  out += groups_text("by chain", validation.by_chain);
  out += curve_text(validation);
  return out;
}

}  // namespace spherechain::baker
