// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/os/child_process.h"
#include "baker/report/json_text.h"
#include "baker/report/report.h"
#include "baker/report/vec3_json.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

const char* name_of(BodySource body) {
  return body == BodySource::kSkin ? "skin" : body == BodySource::kRepaired ? "repaired" : "wrapped";
}

// The skin's triangles that the body's are not made of.
std::size_t count_other_triangles(const Bake& bake) {
  const std::vector<Index>& source = bake.regions.body.source_triangle;
  std::set<Index> body(source.begin(), source.end());
  body.erase(kNoIndex);
  return bake.character.skin.triangles.size() - body.size();
}

ordered_json closing_section(const ClosingReport& closing) {
  ordered_json out{{"body", name_of(closing.body)},
                   {"welded_by_tolerance", closing.welded},
                   {"t_junctions_split", closing.t_junctions},
                   {"triangles_turned", closing.turned},
                   {"edges_parted", closing.parted},
                   {"holes_closed", closing.holes},
                   {"seconds", closing.seconds}};
  if (closing.body == BodySource::kWrapped) {
    out["wrap"] = {{"alpha", closing.alpha},
                   {"offset", closing.offset},
                   {"triangles", closing.triangles},
                   {"thin_area", closing.thin},
                   {"holes_closed_first", closing.holes_first},
                   {"tried", closing.wraps}};
  }
  return out;
}

// One line about the repair of a body that was not closed. Empty if it was closed.
std::string closing_line(const ClosingReport& closing) {
  if (closing.body == BodySource::kSkin) return {};
  std::string line = fmt::format(
      "not one closed surface: {} vertices all but coincide, {} T-junctions, {} triangles turned, {} edges of more "
      "than two triangles, {} holes; ",
      closing.welded, closing.t_junctions, closing.turned, closing.parted, closing.holes);
  if (closing.body == BodySource::kRepaired) return line + fmt::format("repaired in {:.1f} s\n", closing.seconds);
  return line + fmt::format("wrapped with alpha = diameter / {:.0f} ({} triangles, {} tried) in {:.1f} s\n",
                            1 / closing.alpha, closing.triangles, closing.wraps, closing.seconds);
}

// The strategies that were tried before the one that was taken, a line each; nothing where the first was taken.
std::string passed_over_lines(const Choice& choice) {
  std::string lines;
  for (const PassedOver& passed : choice.passed_over) {
    if (passed.reason.cause == Reason::Cause::kDoesNotApply) continue;
    lines += fmt::format("by {}, not by {}: {}\n", choice.strategy, passed.strategy, passed.reason.what);
  }
  return lines;
}

ordered_json import_section(const Bake& bake) {
  const ImportReport& report = bake.character.report;
  return {{"importer", report.importer},
          {"meshes", report.meshes},
          {"components", report.components},
          {"source_vertices", bake.character.source_positions.size()},
          {"source_triangles", bake.character.source_triangles.size()},
          {"welded_vertices", report.welded_vertices},
          {"body_vertices", bake.regions.body.mesh.positions.size()},
          {"body_triangles", bake.regions.body.mesh.triangles.size()},
          {"other_triangles", count_other_triangles(bake)},
          {"degenerate_dropped", report.degenerate_dropped},
          {"duplicates_dropped", report.duplicates_dropped},
          {"points_and_lines_dropped", report.points_and_lines_dropped},
          {"bones_dropped", report.bones_dropped},
          {"metres_per_unit", bake.character.metres_per_unit},
          {"up_axis_of_file", to_json(bake.character.up_hint)}};
}

double region_area(const Bake& bake, std::size_t region) {
  double area = 0;
  for (std::size_t t = 0; t < bake.character.skin.triangles.size(); ++t) {
    if (bake.regions.of_skin[t] == region) area += triangle_area(bake.character.skin, t);
  }
  return area;
}

ordered_json segment_section(const Bake& bake) {
  const BodyFrame& frame = bake.regions.frame;
  ordered_json regions = ordered_json::array();
  for (std::size_t r = 0; r < bake.regions.count(); ++r) {
    ordered_json entry{{"name", bake.regions.name(r)},
                       {"fit", bake.regions.is_by_bones(r) ? "generic" : "paper"},
                       {"triangles", std::count(bake.regions.of_skin.begin(), bake.regions.of_skin.end(), r)},
                       {"area", region_area(bake, r)}};
    if (r < bake.regions.limbs.size()) {
      entry["length_to_wrist_or_ankle"] = bake.regions.limbs[r].extremity;
      entry["starts_at"] = to_json(bake.regions.limbs[r].line.at(0));
    }
    regions.push_back(std::move(entry));
  }
  ordered_json passed_over = ordered_json::array();
  for (const PassedOver& passed : bake.segmented_by.passed_over) {
    passed_over.push_back({{"strategy", passed.strategy},
                           {"tried", passed.reason.cause != Reason::Cause::kDoesNotApply},
                           {"reason", passed.reason.what}});
  }
  return {{"provider", bake.regions.provider},
          {"strategy", bake.segmented_by.strategy},
          {"passed_over", std::move(passed_over)},
          {"facing", bake.regions.facing},
          {"height", frame.height},
          {"left", to_json(frame.left)},
          {"up", to_json(frame.up)},
          {"forward", to_json(frame.forward)},
          {"regions", std::move(regions)}};
}

ordered_json fit_entry(const Ball& ball, const TorsoFit& fit, const Mesh& mesh) {
  const FError error = f_error(ball, mesh, fit.vertices);
  ordered_json f = ordered_json::array();
  for (const Index v : fit.vertices) f.push_back(signed_f(ball, mesh.positions[v]));
  return {{"center", to_json(ball.center)},
          {"radius", ball.radius},
          {"mean_abs_F", error.mean_abs},
          {"max_abs_F", error.max_abs},
          {"F", std::move(f)}};
}

const char* name_of(Side side) { return side == Side::kLeft ? "left" : side == Side::kRight ? "right" : "none"; }

ordered_json fit_section(const Bake& bake) {
  const Mesh& mesh = bake.regions.body.mesh;
  ordered_json torso = ordered_json::array();
  for (const TorsoFit& fit : bake.spheres.torso) {
    ordered_json vertices = ordered_json::array();
    for (const Index v : fit.vertices) vertices.push_back(to_json(mesh.positions[v]));
    torso.push_back({{"sphere", fit.sphere},
                     {"level", bake.spheres.spheres[fit.sphere].level},
                     {"side", name_of(bake.spheres.spheres[fit.sphere].side)},
                     {"vertices", std::move(vertices)},
                     {"phi1", fit_entry(fit.phi1, fit, mesh)},
                     {"phi1_adjusted", fit_entry(fit.phi1_adjusted, fit, mesh)},
                     {"phi2", fit_entry(fit.phi2, fit, mesh)}});
  }
  ordered_json limbs = ordered_json::array();
  for (std::size_t r = 0; r < bake.regions.limbs.size(); ++r) {
    const std::vector<std::uint32_t>& ids = bake.spheres.of_region[r];
    ordered_json depths = ordered_json::array();
    for (std::size_t i = 1; i < ids.size(); ++i) {
      depths.push_back(penetration_depth(bake.spheres.spheres[ids[i - 1]].ball, bake.spheres.spheres[ids[i]].ball));
    }
    limbs.push_back(
        {{"name", bake.regions.name(r)}, {"spheres", ids.size()}, {"penetration_depths", std::move(depths)}});
  }
  return {{"torso", std::move(torso)}, {"limbs", std::move(limbs)}};
}

std::size_t count_extremity(const Bake& bake, std::size_t region) {
  const std::vector<std::uint32_t>& ids = bake.spheres.of_region[region];
  return static_cast<std::size_t>(
      std::count_if(ids.begin(), ids.end(), [&](std::uint32_t i) { return bake.spheres.spheres[i].extremity; }));
}

// A march at penetration depth PD takes about length / (2 r (1 - PD)) spheres.
std::string why_this_count(const Bake& bake) {
  if (bake.regions.is_tree()) {
    return "A sphere for each part; where the skin was farthest from its sphere, its triangles were halved.";
  }
  std::string why;
  for (std::size_t r = 0; r < bake.regions.limbs.size(); ++r) {
    double radius = 0;
    const std::size_t count = bake.spheres.of_region[r].size() - count_extremity(bake, r);
    for (std::size_t i = 0; i < count; ++i) radius += bake.spheres.spheres[bake.spheres.of_region[r][i]].ball.radius;
    why += fmt::format("{}{} {} (length {:.3f}, mean radius {:.4f})", r == 0 ? "" : ", ", bake.regions.name(r), count,
                       bake.regions.limbs[r].extremity, radius / static_cast<double>(count));
  }
  why += fmt::format(
      ", torso {} (levels {}). Limb spheres touch the skin: their radius is the distance to it, the shortest "
      "ray, and not the mean ray; smaller spheres, so more of them at the same penetration depth.",
      bake.spheres.of_region[bake.spheres.torso_region()].size() - count_extremity(bake, bake.spheres.torso_region()),
      bake.spheres.level_heights.size());
  if (bake.settings.fit.extremities) {
    why += " Past where the paper stops:";
    for (std::size_t r = 0; r < bake.regions.count(); ++r) {
      why += fmt::format("{} {} {}", r == 0 ? "" : ",", bake.regions.name(r), count_extremity(bake, r));
    }
    why += ".";
  }
  return why;
}

ordered_json counts_section(const Bake& bake) {
  const std::size_t n = bake.spheres.spheres.size();
  std::size_t chains_tests = 0;
  const auto ignored = [&](std::uint32_t a, std::uint32_t b) {
    return std::binary_search(bake.binding.ignored.begin(), bake.binding.ignored.end(),
                              std::pair<std::uint32_t, std::uint32_t>(std::minmax(a, b)));
  };
  for (const Chain& chain : bake.chains.chains) {
    for (std::size_t i = 0; i < chain.spheres.size(); ++i) {
      for (std::size_t j = i + 1; j < chain.spheres.size(); ++j)
        chains_tests += ignored(chain.spheres[i], chain.spheres[j]) ? 0 : 1;
    }
  }
  return {{"spheres", n},
          {"why", why_this_count(bake)},
          {"chain_entries", bake.chains.entries()},
          {"chains_tests", chains_tests},
          {"all_pairs_tests", n * (n - 1) / 2 - bake.binding.ignored.size()},
          {"ignored_pairs", bake.binding.ignored.size()},
          {"rest_pairs_fit", bake.binding.rest_fit.size()},
          {"rest_pairs_detect", bake.binding.rest_detect.size()}};
}

// Fewest and most of a sphere.
std::pair<std::size_t, std::size_t> pivots_used(const Bake& bake) {
  const auto fewer = [](const BoundSphere& a, const BoundSphere& b) { return a.pivots.size() < b.pivots.size(); };
  const auto [fewest, most] = std::minmax_element(bake.binding.spheres.begin(), bake.binding.spheres.end(), fewer);
  return {fewest->pivots.size(), most->pivots.size()};
}

ordered_json quality_section(const Bake& bake) {
  const FitQuality& quality = bake.quality;
  ordered_json far = ordered_json::array();
  for (const std::uint8_t region : quality.far_regions()) far.push_back(bake.regions.name(region));
  return {{"grade", fit_grade_name(quality.grade())},
          {"far_area", quality.far_area},
          {"far_regions", std::move(far)},
          {"protrusion", quality.protrusion},
          {"distance_mean", quality.distance_mean},
          {"distance_p95", quality.distance_p95},
          {"distance_max", quality.distance_max}};
}

ordered_json bind_section(const Bake& bake) {
  ordered_json spheres = ordered_json::array();
  for (std::size_t i = 0; i < bake.binding.spheres.size(); ++i) {
    const BoundSphere& sphere = bake.binding.spheres[i];
    spheres.push_back({{"sphere", i},
                       {"pivots", sphere.pivots.size()},
                       {"sum_of_weight_magnitudes", sphere.weight_sum},
                       {"radius", sphere.rest.radius},
                       {"detect_radius", sphere.detect_radius},
                       {"moved_by_refit_at_rest", (sphere.rest.center - bake.spheres.spheres[i].ball.center).norm()}});
  }
  const auto [fewest, most] = pivots_used(bake);
  return {{"refit", refit_name(static_cast<spherechain::RefitRule>(bake.binding.rule))},
          {"pivots", {{"asked", bake.settings.bind.pivots}, {"fewest", fewest}, {"most", most}}},
          {"quality", quality_section(bake)},
          {"spheres", std::move(spheres)}};
}

ordered_json edits_section(const Bake& bake) {
  const Edits& edits = bake.settings.edits;
  return {{"asked", edits.spheres.size() + edits.ignored_parts.size()},
          {"applied", bake.edits_done.applied},
          {"missed", bake.edits_done.missed},
          {"notes", bake.edits_done.notes}};
}

std::string joined(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

std::string figures_line(const FitQuality& quality) {
  return fmt::format(
      "{:.0f} % of the skin is within {:.0f} % of the height of its sphere; spheres stand out {:.1f} % on average\n",
      100 * (1 - quality.far_area), 100 * kWellFitted, 100 * quality.protrusion);
}

}  // namespace

std::string bake_report_json(const Bake& bake) {
  ordered_json stages = ordered_json::array();
  double total = 0;
  for (const StageTime& time : bake.times) {
    stages.push_back({{"stage", time.stage}, {"seconds", time.seconds}});
    total += time.seconds;
  }
  const ordered_json report{{"writer", kWriter},
                            {"source", {{"file", bake.character.file}, {"sha256", bake.character.sha256}}},
                            {"settings", ordered_json::parse(to_json(bake.settings))},
                            {"import", import_section(bake)},
                            {"closing", closing_section(bake.closing)},
                            {"segment", segment_section(bake)},
                            {"counts", counts_section(bake)},
                            {"fit", fit_section(bake)},
                            {"bind", bind_section(bake)},
                            {"edits", edits_section(bake)},
                            {"unit_note", unit_note(bake)},
                            {"missed_targets", missed_targets(bake)},
                            {"stages", std::move(stages)},
                            {"total_seconds", total},
                            {"peak_memory_mb", peak_memory_mb()}};
  return json_text(report, 1) + "\n";
}

// Whether the frame's height is one upwards: a biped's stature, or the longest extent if that is upwards.
bool is_tall(const Bake& bake) {
  if (!bake.regions.is_tree()) return is_biped(bake.regions);
  if (bake.roles.kind == BodyKind::kBiped) return true;
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const Vec3& p : bake.character.skin.positions) {
    low = std::min(low, p.dot(bake.regions.frame.up));
    high = std::max(high, p.dot(bake.regions.frame.up));
  }
  return high - low > 0.999 * bake.regions.frame.height;
}

std::string unit_note(double metres, const std::vector<std::string>& parts) {
  constexpr double kSmallest = 0.02, kLargest = 50, kSmallestBiped = 0.5, kLargestBiped = 3, kHuman = 1.7;
  const auto has = [&](const char* part) { return std::find(parts.begin(), parts.end(), part) != parts.end(); };
  const bool is_person = has("left hand") && has("right hand") && has("left thigh") && has("right thigh");
  if (is_person && (metres < kSmallestBiped || metres > kLargestBiped)) {
    return fmt::format(
        "this biped is {:.4g} m tall: --height {} (or --scale {:.3g}) gives it a human's size, and limits in mm their "
        "meaning (--scale 1 says that its size is right)",
        metres, kHuman, kHuman / metres);
  }
  if (metres >= kSmallest && metres <= kLargest) return {};
  return fmt::format(
      "measures {:.4g} m: its file names no unit, or a wrong one (give --height); until then depths in % of the height "
      "are right, those in mm, volumes and masses are not",
      metres);
}

std::string unit_note(const Bake& bake) {
  if (bake.settings.size.is_given()) return {};
  std::vector<std::string> parts;
  for (const BodyPart& part : bake.body_parts.parts) parts.push_back(part.name);
  return unit_note(bake.regions.frame.height * bake.character.metres_per_unit, parts);
}

std::string bake_report_text(const Bake& bake) {
  const double metres = bake.regions.frame.height * bake.character.metres_per_unit;
  const std::string what =
      bake.settings.import.prop ? "a prop" : fmt::format("{} body", bake.regions.body.mesh.triangles.size());
  std::string out = fmt::format("{}: {} triangles ({}), {} components, {:.3f} m {}; {}\n", bake.character.file,
                                bake.character.source_triangles.size(), what, bake.character.report.components, metres,
                                is_tall(bake) ? "tall" : "long", bake.regions.facing);
  if (const std::string note = unit_note(bake); !note.empty())
    out += "note: " + bake.character.file + ": " + note + "\n";
  if (const std::size_t dropped = bake.character.report.bones_dropped; dropped > 0) {
    out += fmt::format("left out: {} and what moves them: a prop is rigid, as at rest\n",
                       dropped == 1 ? "1 bone" : fmt::format("{} bones", dropped));
  }
  out += closing_line(bake.closing);
  out += passed_over_lines(bake.segmented_by);
  out += fmt::format("\n{:<14} {:>9} {:>7}\n", "region", "triangles", "spheres");
  for (std::size_t r = 0; r < bake.regions.count(); ++r) {
    out += fmt::format("{:<14} {:>9} {:>7}\n", bake.regions.name(r),
                       std::count(bake.regions.of_skin.begin(), bake.regions.of_skin.end(), r),
                       bake.spheres.of_region[r].size());
  }
  out += fmt::format("{} spheres, {} pairs {} ignored\n", bake.spheres.spheres.size(), bake.binding.ignored.size(),
                     bake.settings.edits.ignored_parts.empty() ? "of neighbours" : "of neighbours and of edited parts");
  if (const Edits& edits = bake.settings.edits; !edits.empty()) {
    out += fmt::format("{} of {} edits applied\n", bake.edits_done.applied,
                       edits.spheres.size() + edits.ignored_parts.size());
    for (const std::string& note : bake.edits_done.notes) out += fmt::format("note: {}\n", note);
  }
  out += fmt::format("\n{:<10} {:>8}\n", "stage", "ms");
  double total = 0;
  for (const StageTime& time : bake.times) {
    out += fmt::format("{:<10} {:>8.1f}\n", time.stage, 1e3 * time.seconds);
    total += time.seconds;
  }
  out += fmt::format("{:<10} {:>8.1f}   peak memory {:.0f} MB\n\n", "total", 1e3 * total, peak_memory_mb());
  return bake.settings.import.prop ? out : out + figures_line(bake.quality);
}

std::string generic_fit_text(const std::vector<std::string>& generic, std::size_t parts) {
  if (generic.empty()) return {};
  if (generic.size() == parts) return "; all parts by the generic fit";
  constexpr std::size_t kNamed = 6;
  if (generic.size() > kNamed) return fmt::format("; {} of {} parts by the generic fit", generic.size(), parts);
  return fmt::format("; {} by the generic fit: {}",
                     generic.size() == 1 ? "1 part" : fmt::format("{} parts", generic.size()), joined(generic));
}

std::string fit_line(const Bake& bake) {
  const FitQuality& quality = bake.quality;
  if (bake.settings.import.prop) {
    return fmt::format("prop: {} spheres hold all of it, and stand out {:.1f} % of the height on average\n",
                       bake.spheres.spheres.size(), 100 * quality.protrusion);
  }
  std::vector<std::string> far, generic;
  for (const std::uint8_t region : quality.far_regions()) far.push_back(bake.regions.name(region));
  if (far.empty()) {
    const std::vector<double>& shares = quality.far_of_region;
    far.push_back(
        bake.regions.name(static_cast<std::size_t>(std::max_element(shares.begin(), shares.end()) - shares.begin())));
  }
  for (std::size_t r = 0; r < bake.regions.count(); ++r) {
    if (bake.regions.is_by_bones(r)) generic.push_back(bake.regions.name(r));
  }
  std::string line = fmt::format("fit: {}", fit_grade_name(quality.grade()));
  if (quality.grade() != FitGrade::kGood) line += "; badly fitted: " + joined(far);
  return line + generic_fit_text(generic, bake.regions.count()) + "\n";
}

}  // namespace spherechain::baker
