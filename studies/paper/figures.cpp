// SPDX-License-Identifier: GPL-3.0-or-later
#include "figures.h"

#include <fmt/format.h>

#include <cmath>

#include "statistics.h"

namespace spherechain::paper {
namespace {

// Labels as readers write them.
constexpr const char *kPhi1 = "φ1", *kAdjusted = "φ1′", *kEnclosing = "φ2 (band)", *kEnclosingRays = "φ2 (rays)";

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& v : values) v *= factor;
  return values;
}

std::vector<double> divided(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] /= b[i];
  return a;
}

// A sphere's own half of the disk, its rays in the order of their angle.
Table own_half(const Table& rays, double sphere) {
  Table half = rays.where("sphere", sphere).where("own_half", 1);
  if (half.word(0, "side") == "right") {  // r0 closes the right half as r80
    half.rows.push_back(half.rows.front());
    half.rows.erase(half.rows.begin());
    half.rows.back()[3] = half.rows.size() + 39;
  }
  return half;
}

}  // namespace

Figure accuracy_figure(const Results& results) {
  Figure figure{"figure13",
                "|F| of each torso sphere at the points its level's disk hits, over the rays of its own half. Top row: "
                "left spheres (r0 forward, r20 left, r40 back); bottom row: right spheres (r60 right, r80 = r0).",
                0,
                236,
                {}};
  const Table& spheres = results.accuracy.spheres;
  figure.columns = spheres.rows.size() / 2;
  for (const char* side : {"left", "right"}) {
    for (std::size_t s = 0; s < spheres.rows.size(); ++s) {
      if (spheres.word(s, "side") != side) continue;
      const Table half = own_half(results.accuracy.rays, static_cast<double>(s));
      Panel panel{fmt::format("sphere {}: eccentricity {:.2f}", s, spheres.number(s, "eccentricity_half")),
                  "ray",
                  "|F| (mm)",
                  {}};
      panel.x_tick = 10;
      const std::vector<double> ray = half.numbers("ray");
      panel.series = {{kPhi1, Colour::kBlue, Style::kDashed, ray, half.numbers("abs_f_phi1_mm")},
                      {kAdjusted, Colour::kGreen, Style::kLine, ray, half.numbers("abs_f_phi1_adjusted_mm")},
                      {kEnclosing, Colour::kVermilion, Style::kLine, ray, half.numbers("abs_f_phi2_mm")},
                      {kEnclosingRays, Colour::kOrange, Style::kDashed, ray, half.numbers("abs_f_phi2_rays_mm")}};
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

Figure shape_figure(const Results& results) {
  Figure figure{
      "figure13_shape",
      "Mean |F| at the rays of every torso sphere against the eccentricity of the cross-section it stands for; "
      "all penetration depths of the sweep, without head, hands and feet.",
      2,
      290,
      {}};
  const Table& t = results.sweep.accuracy.empty() ? results.accuracy.spheres : results.sweep.accuracy;
  for (const auto& [column, label] : {std::pair("eccentricity_half", "eccentricity of the sphere's half-section"),
                                      std::pair("eccentricity_section", "eccentricity of the whole section")}) {
    const std::vector<double> e = t.numbers(column);
    Panel panel{"", label, "mean |F| at the rays (mm)", {}};
    panel.series = {{kAdjusted, Colour::kGreen, Style::kMarks, e, t.numbers("rays_phi1_adjusted_mm")},
                    {kEnclosing, Colour::kVermilion, Style::kMarks, e, t.numbers("rays_phi2_mm")},
                    {kEnclosingRays, Colour::kOrange, Style::kMarks, e, t.numbers("rays_phi2_rays_mm")}};
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

Figure running_time_figure(const Results& results) {
  Figure figure{
      "figure15",
      "The running stage frame by frame, profile paper: time of the overlap tests and overlaps found. Dashed: the "
      "product's jobs. Left: arms; right: legs.",
      2,
      250,
      {}};
  const Table& t = results.running_time;
  for (const char* column : {"us", "overlaps"}) {
    for (const std::string& animation : t.words("animation")) {
      const Table one = t.where("animation", animation);
      const bool time = std::string(column) == "us";
      Panel panel{"animation of the " + animation, "frame", time ? "time (µs)" : "overlaps", {}};
      for (const auto& [method, colour] : {std::pair("M1", Colour::kBlue), std::pair("M2", Colour::kVermilion),
                                           std::pair("all_pairs", Colour::kGreen), std::pair("refit", Colour::kGrey)}) {
        const Table rows = one.where("method", method);
        const bool of_product = colour == Colour::kGreen || colour == Colour::kGrey;
        if (!time && of_product) continue;  // all_pairs finds what M2 finds
        panel.series.push_back({method, colour, of_product ? Style::kDashed : Style::kLineAndMarks,
                                rows.numbers("frame"), rows.numbers(column)});
      }
      figure.panels.push_back(std::move(panel));
    }
  }
  return figure;
}

Figure sphere_count_figure(const Results& results) {
  Figure figure{
      "sphere_count",
      "Over penetration depths: what M1 and M2 cost against the number of spheres, their ratio (above 1 M2 is "
      "ahead), and the share of the mesh's spheres that a chain holds (below 41 % M1 needs fewer tests of all "
      "pairs). Dashed: with head, hands and feet. Diamonds: the paper's two readings.",
      3,
      300,
      {}};
  Panel cost{"time of a frame", "spheres (log)", "time (µs, log)", {}}, ratio{"M1 / M2", "spheres", "ratio", {}},
      share{"a chain's share", "spheres", "spheres of a chain / of the mesh", {}};
  cost.log_axes = true;
  const Table core = results.sweep.sweep.where("series", kDepthPaper);
  const Table whole = results.sweep.sweep.where("series", kDepthExtremities);
  const auto chain_share = [](const Table& t) {
    std::vector<double> out = divided(t.numbers("full_tests_m1"), t.numbers("full_tests_m2"));
    for (double& v : out) v = std::sqrt(v / kChainCount);
    return out;
  };
  for (const bool extremities : {false, true}) {
    const Table& t = extremities ? whole : core;
    if (t.empty()) continue;
    const auto label = [&](const char* name) { return extremities ? "" : name; };
    const std::vector<double> n = t.numbers("spheres");
    const Style style = extremities ? Style::kDashed : Style::kLineAndMarks;
    cost.series.push_back({label("M1"), Colour::kBlue, style, n, t.numbers("us_m1")});
    cost.series.push_back({label("M2"), Colour::kVermilion, style, n, t.numbers("us_m2")});
    ratio.series.push_back({label("tests, all pairs"), Colour::kGreen, style, n,
                            divided(t.numbers("full_tests_m1"), t.numbers("full_tests_m2"))});
    ratio.series.push_back({label("time"), Colour::kPurple, style, n, divided(t.numbers("us_m1"), t.numbers("us_m2"))});
    share.series.push_back({label("share"), Colour::kGrey, style, n, chain_share(t)});
  }
  const Series readings{"the paper: 46, 80",
                        Colour::kOrange,
                        Style::kMarks,
                        {kSummedSpheres, kStatedSpheres},
                        {kChainCount * kStatedChain * kStatedChain / (kSummedSpheres * kSummedSpheres),
                         kChainCount * kStatedChain * kStatedChain / (kStatedSpheres * kStatedSpheres)},
                        {"46", "80"}};
  ratio.series.push_back(readings);
  ratio.references.push_back({"as many", false, 1});
  Series shares = readings;
  shares.y = {kStatedChain / kSummedSpheres, kStatedChain / kStatedSpheres};
  share.series.push_back(shares);
  share.references.push_back({"1/√6", false, 1 / std::sqrt(kChainCount)});
  figure.panels = {cost, ratio, share};
  return figure;
}

Figure sweep_figure(const Results& results, const std::string& setting, const std::string& axis,
                    const std::vector<SweepLine>& lines) {
  Figure figure{
      "sweep_" + setting,
      "Over " + axis +
          ": spheres; |F| over the torso's vertices and over all that the paper covers (core); skin outside all "
          "spheres at the two radii; distance (Hausdorff) of the refitted sphere from the one that fits the "
          "deformed skin best, frames of both animations.",
      4,
      250,
      {}};
  Panel spheres{"spheres", axis, "spheres", {}}, fit{"fit", axis, "|F| (mm)", {}};
  Panel uncovered{"skin outside the spheres", axis, "% of the area", {}};
  Panel refit{"refit", axis, "distance of spheres (mm)", {}};
  for (const SweepLine& line : lines) {
    const Table t = results.sweep.sweep.where("series", line.series);
    if (t.empty()) continue;
    const auto add = [&](Panel& panel, const std::string& label, Colour colour, const std::string& column,
                         double factor) {
      panel.series.push_back({&line == &lines.back() ? label : "", colour, line.style, t.numbers("value"),
                              scaled(t.numbers(column), factor)});
    };
    add(spheres, "spheres", Colour::kGrey, "spheres", 1);
    add(fit, "torso, mean", Colour::kBlue, "torso_f_mean_mm", 1);
    add(fit, "torso, 95th percentile", Colour::kVermilion, "torso_f_p95_mm", 1);
    add(fit, "core, mean", Colour::kOrange, "core_f_mean_mm", 1);
    add(uncovered, "fit radius", Colour::kGreen, "uncovered_body_fit", 100);
    add(uncovered, "detect radius", Colour::kPurple, "uncovered_body_detect", 100);
    add(refit, "refit, mean", Colour::kBlue, "refit_sphere_mean_mm", 1);
    add(refit, "refit, 95th percentile", Colour::kVermilion, "refit_sphere_p95_mm", 1);
  }
  if (lines.size() > 1) figure.caption += fmt::format(" Dashed: {}; solid: {}.", lines[0].label, lines[1].label);
  figure.panels = {spheres, fit, uncovered, refit};
  const Table defaults = derive_defaults(results).where("setting", setting);
  if (!defaults.empty()) {
    figure.caption += fmt::format(" Dotted: the default, {:g}.", defaults.number(0, "current"));
    for (Panel& panel : figure.panels) panel.references.push_back({"", true, defaults.number(0, "current")});
  }
  return figure;
}

Figure quality_figure(const Results& results) {
  Figure figure{
      "quality",
      "Sphere sets by the field's measures, for the whole body, for what the paper covers (core: without head, "
      "hands and feet) and for the torso of that. Coverage is better to the right, the others to the left.",
      4,
      300,
      {},
      120};
  std::vector<std::string> sets;
  const Table core = results.quality.where("part", "core");
  for (std::size_t i = 0; i < core.rows.size(); ++i) {
    sets.push_back(core.word(i, "set") + (core.word(i, "radius") == "detect" ? ", detect radius" : ""));
  }
  struct Measure {
    const char *title, *label, *column;
    double scale;
  };
  for (const Measure& m : {Measure{"coverage", "% of the volume", "coverage", 100},
                           Measure{"outside the skin", "% of the volume", "outside_volume", 100},
                           Measure{"protrusion", "95th percentile (mm)", "protrusion_p95_mm", 1},
                           Measure{"gap to the skin", "mean (mm)", "gap_mean_mm", 1}}) {
    Panel panel{m.title, m.label, "", {}};
    panel.rows = sets;
    for (const auto& [part, colour] :
         {std::pair("body", Colour::kGrey), std::pair("core", Colour::kBlue), std::pair("torso", Colour::kVermilion)}) {
      Series series{
          part, colour, Style::kMarks, scaled(results.quality.where("part", part).numbers(m.column), m.scale), {}};
      for (std::size_t i = 0; i < sets.size(); ++i) series.y.push_back(static_cast<double>(i));
      panel.series.push_back(std::move(series));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace spherechain::paper
