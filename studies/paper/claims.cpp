// SPDX-License-Identifier: GPL-3.0-or-later
#include "claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gpu_claims.h"
#include "statistics.h"
#include "tree_claims.h"

namespace spherechain::paper {
namespace {

std::vector<double> ratio(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i) out.push_back(a[i] / b[i]);
  return out;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out;
  for (std::size_t i = 0; i < a.size(); ++i) out.push_back(a[i] - b[i]);
  return out;
}

std::size_t count_if_positive(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](double v) { return v > 0; }));
}

Verdict evaluate_adjustment(const Results& results) {
  const Table& t = results.accuracy.spheres;
  const std::vector<double> before = t.numbers("vertices_phi1_mm"), after = t.numbers("vertices_phi1_adjusted_mm");
  const std::vector<double> gain = difference(before, after);
  const bool never_worse = least(gain) >= 0, better = mean(gain) > 0;
  return {graded(never_worse && better, better),
          fmt::format("Mean |F| over the vertices falls from {:.1f} to {:.1f} mm; lower at {} of {} spheres, by {:.1f} "
                      "to {:.1f} mm.",
                      mean(before), mean(after), count_if_positive(gain), gain.size(), least(gain), most(gain))};
}

// Spheres split at the median eccentricity: `right` counts where phi1' is better
// among the eccentric, phi2 among the round.
struct Split {
  std::size_t eccentric = 0, eccentric_right = 0, round = 0, round_right = 0, round_worse = 0;
  double correlation = 0;
};

Split split_by_shape(const Table& spheres, const std::string& phi2) {
  const std::vector<double> e = spheres.numbers("eccentricity_half");
  const std::vector<double> advantage = difference(spheres.numbers(phi2), spheres.numbers("rays_phi1_adjusted_mm"));
  Split out;
  out.correlation = rank_correlation(e, advantage);
  for (std::size_t i = 0; i < e.size(); ++i) {
    const bool eccentric = e[i] > median(e);
    ++(eccentric ? out.eccentric : out.round);
    if (eccentric && advantage[i] > 0) ++out.eccentric_right;
    if (!eccentric && advantage[i] < 0) ++out.round_right;
    if (!eccentric && advantage[i] > 0) ++out.round_worse;
  }
  return out;
}

Verdict evaluate_shape(const Results& results, const std::string& phi2) {
  const Table& t = results.accuracy.spheres;
  const Split split = split_by_shape(t, phi2);
  const auto three_quarters = [](std::size_t right, std::size_t of) { return 4 * right >= 3 * of; };
  const bool eccentric = three_quarters(split.eccentric_right, split.eccentric);
  const bool round = three_quarters(split.round_right, split.round);
  std::string finding = fmt::format(
      "phi1' is better at {} of the {} more eccentric spheres, phi2 at {} of the {} rounder ones; rank correlation of "
      "eccentricity and the lead of phi1' {:.2f}. Mean |F| at the rays: phi1' {:.1f} mm, phi2 {:.1f} mm. The "
      "half-sections' "
      "eccentricity is {:.2f} to {:.2f}, the whole sections' {:.2f} to {:.2f}.",
      split.eccentric_right, split.eccentric, split.round_right, split.round, split.correlation,
      mean(t.numbers("rays_phi1_adjusted_mm")), mean(t.numbers(phi2)), least(t.numbers("eccentricity_half")),
      most(t.numbers("eccentricity_half")), least(t.numbers("eccentricity_section")),
      most(t.numbers("eccentricity_section")));
  if (split.eccentric_right == split.eccentric && split.round_worse == split.round) {
    finding += " So phi1' is better whatever the shape.";
  }
  const Table& series = results.sweep.accuracy;
  if (!series.empty()) {
    const Split more = split_by_shape(series, phi2);
    finding += fmt::format(
        " Over the {} spheres of all penetration depths: {} of {}, {} of {}, rank correlation {:.2f}.",
        series.rows.size(), more.eccentric_right, more.eccentric, more.round_right, more.round, more.correlation);
  }
  return {graded(eccentric && round && split.correlation >= 0.5, eccentric || round), finding};
}

Table all_depths(const Results& results) {
  Table out = results.sweep.sweep.where("series", kDepthPaper);
  const Table more = results.sweep.sweep.where("series", kDepthExtremities);
  out.rows.insert(out.rows.end(), more.rows.begin(), more.rows.end());
  return out;
}

Verdict evaluate_sphere_count(const Results& results) {
  const Table t = all_depths(results);
  const std::vector<double> ours = ratio(t.numbers("chain_entries_table1"), t.numbers("spheres"));
  const double stated = kChainCount * kStatedChain / kStatedSpheres,
               summed = kChainCount * kStatedChain / kSummedSpheres;
  const auto within = [&](double value) { return value >= least(ours) && value <= most(ours); };
  return {
      graded(within(stated), false),
      fmt::format("138 entries over 80 spheres are {:.2f} a sphere, over 46 they are {:.2f}. Our {} bakes of {:g} to "
                  "{:g} spheres have {:.2f} to {:.2f} by Table 1. With the eight torso spheres of Figure 13, "
                  "3x + 2t + 3|T| + |D| = 138 leaves x = 38 limb spheres: 46 in the mesh. 80 is its number of rays.",
                  stated, summed, ours.size(), least(t.numbers("spheres")), most(t.numbers("spheres")), least(ours),
                  most(ours))};
}

// M1 / M2 of a column over the sphere counts of a series, and where it passes 1.
struct Turn {
  double low, high;
  std::string text;
};

Turn turn_over(const Table& series, const std::string& m1, const std::string& m2) {
  const std::vector<double> r = ratio(series.numbers(m1), series.numbers(m2)), n = series.numbers("spheres");
  std::vector<std::size_t> order(n.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return n[a] < n[b]; });
  std::string crossings;
  for (std::size_t i = 1; i < order.size(); ++i) {
    if ((r[order[i - 1]] > 1) != (r[order[i]] > 1)) {
      crossings += fmt::format("{}between {:g} and {:g} spheres", crossings.empty() ? "" : " and ", n[order[i - 1]],
                               n[order[i]]);
    }
  }
  return {least(r), most(r),
          fmt::format("{:.2f} to {:.2f} from {:g} to {:g} spheres, {}", least(r), most(r), least(n), most(n),
                      crossings.empty() ? "no turn" : "turning " + crossings)};
}

Verdict evaluate_fewer_tests(const Results& results) {
  const Table readings = compare_readings(results);
  std::size_t fewer = 0;
  std::string list;
  for (std::size_t i = 0; i < readings.rows.size(); ++i) {
    const double m1 = readings.number(i, "full_tests_m1"), m2 = readings.number(i, "full_tests_m2");
    if (m2 < m1) ++fewer;
    list += fmt::format("{}{} {:g} against {:g}", i > 0 ? "; " : "", readings.word(i, "reading"), m1, m2);
  }
  return {graded(fewer == readings.rows.size(), fewer > 0),
          fmt::format("M2 needs fewer by n_c n^2 and m^2 in {} of {} readings (M1 against M2: {}).", fewer,
                      readings.rows.size(), list)};
}

Verdict evaluate_turn_over(const Results& results) {
  const Table core = results.sweep.sweep.where("series", kDepthPaper);
  const Table whole = results.sweep.sweep.where("series", kDepthExtremities);
  bool turns = false;
  std::string finding = fmt::format(
      "All pairs compared, six chains need fewer tests than the mesh only where a chain holds less than 1/sqrt(6) = "
      "41 % of its spheres; with chains of 23 that is from {:.0f} spheres on. M1 / M2:",
      std::ceil(kStatedChain * std::sqrt(kChainCount)));
  for (const auto& [name, series] :
       {std::pair(std::string("without head, hands and feet"), core), std::pair(std::string("with them"), whole)}) {
    if (series.empty()) continue;
    const Turn full = turn_over(series, "full_tests_m1", "full_tests_m2");
    const Turn tests = turn_over(series, "tests_m1", "tests_m2"), time = turn_over(series, "us_m1", "us_m2");
    turns = turns || full.low < 1 || tests.low < 1;
    finding += fmt::format(" {}: full tests {}; tests without ignored pairs {}; time {}.", name, full.text, tests.text,
                           time.text);
  }
  return {graded(!turns, true), finding};
}

Verdict evaluate_overlaps(const Results& results) {
  const Table m1 = results.running_time.where("method", "M1"), m2 = results.running_time.where("method", "M2");
  const std::vector<double> more = difference(m1.numbers("overlaps"), m2.numbers("overlaps"));
  const double sum1 = mean(m1.numbers("overlaps")), sum2 = mean(m2.numbers("overlaps"));
  const std::vector<double> less = difference(m2.numbers("overlaps"), m1.numbers("overlaps"));
  return {graded(sum1 > sum2 && count_if_positive(less) == 0, sum1 > sum2),
          fmt::format("{:.2f} overlaps a frame in M1, {:.2f} in M2; more in M1 in {} of {} frames, fewer in {}.", sum1,
                      sum2, count_if_positive(more), more.size(), count_if_positive(less))};
}

Verdict evaluate_m2_faster(const Results& results) {
  const Table& t = results.running_time;
  const auto us = [&](const char* method) { return t.where("method", method).numbers("us"); };
  const std::vector<double> ours = ratio(us("M1"), us("M2")), full = ratio(us("M1 full"), us("M2 full"));
  const bool by_ours = median(ours) > 1, by_full = median(full) > 1;
  return {graded(by_ours && by_full, by_ours || by_full),
          fmt::format("M1 / M2 in time, median over {} frames: {:.2f} where ignored pairs are left out ({:.2f} and "
                      "{:.2f} us), {:.2f} over all pairs ({:.2f} and {:.2f} us). The product's all_pairs: {:.2f} us.",
                      ours.size(), median(ours), median(us("M1")), median(us("M2")), median(full),
                      median(us("M1 full")), median(us("M2 full")), median(us("all_pairs")))};
}

Verdict evaluate_animation(const Results& results) {
  const Table series = all_depths(results);
  bool same = true, grows = true;
  std::string finding;
  for (const std::string method : {"M1", "M2"}) {
    const Table t = results.running_time.where("method", method);
    const std::vector<std::string> names = t.words("animation");
    std::vector<double> medians;
    for (const std::string& name : names) medians.push_back(median(t.where("animation", name).numbers("us")));
    const double spread = most(medians) / least(medians);
    const std::string column = method == "M1" ? "us_m1" : "us_m2";
    const double correlation = rank_correlation(series.numbers("spheres"), series.numbers(column));
    same = same && spread <= 1.1;
    grows = grows && correlation >= 0.9;
    finding += fmt::format(
        "{}{}: {:.2f} us in {}, {:.2f} us in {}, a factor of {:.2f}; over {:g} to {:g} spheres it grows "
        "as m^{:.1f}, a factor of {:.1f} (rank correlation {:.2f}).",
        finding.empty() ? "" : " ", method, medians.front(), names.front(), medians.back(), names.back(), spread,
        least(series.numbers("spheres")), most(series.numbers("spheres")),
        growth_exponent(series.numbers("spheres"), series.numbers(column)),
        most(series.numbers(column)) / least(series.numbers(column)), correlation);
  }
  return {graded(same && grows, same || grows), finding};
}

Verdict evaluate_pivots(const Results& results) {
  std::string finding;
  std::size_t better = 0, rules = 0;
  for (const auto& [series, name] :
       {std::pair(kPivotsPaper, "the paper's rule"), std::pair(kPivotsMoments, "moments")}) {
    const Table t = results.sweep.sweep.where("series", series);
    if (t.empty()) continue;
    const std::vector<double> error = t.numbers("refit_sphere_p95_mm"), pivots = t.numbers("value");
    const auto four = static_cast<std::size_t>(std::find(pivots.begin(), pivots.end(), 4.0) - pivots.begin());
    ++rules;
    if (four < error.size() && error.back() < 0.9 * error[four]) ++better;
    finding += fmt::format("{}{}: 95th percentile of the refitted sphere's distance", finding.empty() ? "" : " ", name);
    for (std::size_t i = 0; i < error.size(); ++i) {
      finding += fmt::format("{} {:.1f} mm with {:g}", i > 0 ? "," : "", error[i], pivots[i]);
    }
    finding += ".";
  }
  return {rules == 0 ? kNotRun : graded(better == rules, better > 0), finding};
}

Verdict evaluate_per_level(const Results& results) {
  const Table t = results.sweep.sweep.where("series", kPerLevel);
  if (t.empty()) return {kNotRun, ""};
  const std::vector<double> f = t.numbers("torso_f_mean_mm");
  std::string list;
  for (std::size_t i = 0; i < f.size(); ++i) {
    list += fmt::format("{}{:.1f} mm with {:g} ({:g} spheres)", i > 0 ? ", " : "", f[i], t.number(i, "value"),
                        t.number(i, "spheres"));
  }
  const bool two = f.size() > 1 && f[1]<f[0], three = f.size()> 2 && f[2] < f[1];
  return {graded(two && three, two), "Mean |F| over the torso's vertices: " + list + "."};
}

}  // namespace

std::size_t nearest_count(const Table& series, double spheres) {
  const std::vector<double> n = series.numbers("spheres");
  const auto nearer = [&](double a, double b) { return std::abs(a - spheres) < std::abs(b - spheres); };
  return static_cast<std::size_t>(std::min_element(n.begin(), n.end(), nearer) - n.begin());
}

std::size_t bend(const std::vector<double>& cost, const std::vector<double>& error) {
  const auto scaled = [](const std::vector<double>& v, std::size_t i) {
    return (v[i] - least(v)) / (most(v) - least(v));
  };
  std::size_t best = 0;
  for (std::size_t i = 1; i < cost.size(); ++i) {
    if (scaled(cost, i) + scaled(error, i) < scaled(cost, best) + scaled(error, best)) best = i;
  }
  return best;
}

std::size_t cheapest_within_tenth(const std::vector<double>& cost, const std::vector<double>& error) {
  std::size_t best = cost.size();
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (error[i] <= 1.1 * least(error) && (best == cost.size() || cost[i] < cost[best])) best = i;
  }
  return best;
}

Table compare_readings(const Results& results) {
  Table out{"readings",
            {"reading", "penetration_depth", "spheres", "chain_entries_table1", "full_tests_m1", "full_tests_m2",
             "tests_m1", "tests_m2", "overlaps_m1", "overlaps_m2", "us_m1", "us_m2"},
            {}};
  for (const double spheres : {kSummedSpheres, kStatedSpheres}) {
    out.add({spheres == kSummedSpheres ? "the paper by its chains" : "the paper as stated",
             kStatedDepth,
             spheres,
             kChainCount * kStatedChain,
             kChainCount * kStatedChain * kStatedChain,
             spheres * spheres,
             {},
             {},
             {},
             {},
             {},
             {}});
  }
  const auto add = [&](const std::string& name, const char* series, const auto& choose) {
    const Table t = results.sweep.sweep.where("series", series);
    if (t.empty()) return;
    const std::size_t row = choose(t);
    std::vector<Cell> cells{name};
    for (std::size_t c = 1; c < out.columns.size(); ++c) cells.push_back(t.at(row, out.columns[c]));
    out.add(std::move(cells));
  };
  const auto at_default = [](const Table& t) {
    const std::vector<double> v = t.numbers("value");
    const auto nearer = [](double a, double b) { return std::abs(a - kStatedDepth) < std::abs(b - kStatedDepth); };
    return static_cast<std::size_t>(std::min_element(v.begin(), v.end(), nearer) - v.begin());
  };
  const auto near_80 = [](const Table& t) { return nearest_count(t, kStatedSpheres); };
  add("ours, profile paper", kDepthPaper, at_default);
  add("ours, denser", kDepthPaper, near_80);
  add("ours, profile balanced", kDepthExtremities, at_default);
  add("ours with head, hands and feet, nearest to 80", kDepthExtremities, near_80);
  return out;
}

Table evaluate_claims(const Results& results) {
  Table out{"claims", {"id", "where", "paper_says", "rule", "verdict", "finding"}, {}};
  const auto add = [&](const char* id, const char* where, const char* says, const char* rule, Verdict verdict) {
    out.add({id, where, says, rule, verdict.verdict, verdict.finding});
  };
  add("adjustment", "section 6", "The sphere adjustment enhances the accuracy of phi1.",
      "Mean |F| over the vertices is lower after it: at no torso sphere higher; in part: on average.",
      evaluate_adjustment(results));
  add("shape", "section 6, Figure 13",
      "phi1' has a better approximation than phi2 in regions with non circular shape, otherwise phi2 has.",
      "Spheres split at the median eccentricity of the half-section they stand for, compared in mean |F| at its rays: "
      "phi1' better at three quarters of the more eccentric, phi2 at three quarters of the others, rank correlation at "
      "least 0.5; in part: one of the two halves.",
      evaluate_shape(results, "rays_phi2_mm"));
  add("shape_rays", "section 6, Figure 13", "The same, phi2 read as the ball around the rays' colliding points alone.",
      "The same.", evaluate_shape(results, "rays_phi2_rays_mm"));
  add("per_level", "section 3.2", "Two or more spheres a level approximate better than one.",
      "Mean |F| over the torso falls from one to two and from two to three; in part: from one to two.",
      evaluate_per_level(results));
  add("sphere_count", "section 6", "The six chains of 23 spheres contain 138, more than the mesh's 80.",
      "138 / 80 entries a sphere lie in the range that Table 1 gives over our bakes of all penetration depths.",
      evaluate_sphere_count(results));
  add("overlaps", "section 6, Figure 15", "The number of overlaps is bigger in M1.",
      "More a frame on average, and in no frame fewer; in part: on average.", evaluate_overlaps(results));
  add("fewer_tests", "section 6", "M2 needs fewer tests than M1.",
      "m^2 < n_c n^2 in every reading of the sphere count; in part: in some.", evaluate_fewer_tests(results));
  add("m2_faster", "section 6, Figure 15", "On the CPU M2 is faster than M1.",
      "Median over the frames, by plain loops: without ignored pairs, and over all pairs; in part: by one of the two.",
      evaluate_m2_faster(results));
  add("turn_over", "section 6", "The same at 46 and at 80 spheres: M2 stays ahead whatever their number.",
      "M1 needs more tests than M2 in every bake of both series; in part: in some.", evaluate_turn_over(results));
  add("animation", "section 6", "The time depends on the number of spheres, not on the animation.",
      "The two animations' medians differ by at most a tenth, and time rises with the spheres (rank correlation at "
      "least "
      "0.9), for M1 and M2; in part: one of the two.",
      evaluate_animation(results));
  add("more_pivots", "sections 5.1 and 7", "More pivot polygons refit more accurately.",
      "The 95th percentile of the refitted sphere's distance (see the sweep) with the most pivots is at least a tenth "
      "below that with four, for "
      "both "
      "refit rules; in part: for one.",
      evaluate_pivots(results));
  add("no_trees", "sections 1 and 5.2", "There are so few spheres that the chains need no hierarchy.",
      "At the two counts of baked chains nearest to 46 and 80, medians over the frames: the fastest tree, its refit "
      "included, not a twentieth below the faster of M1 and M2 in plain loops; in part: at one of them.",
      evaluate_no_trees(results.trees));
  const Table gpu = gpu_medians(results.gpu);
  add("gpu", "section 6, Figure 16", "On the GPU M1 takes less time than M2.",
      "At the two sphere counts nearest to 46 and 80, medians over the frames: M1's faster kernel at least a twentieth "
      "below M2's, the kernels alone and with launch and copies; in part: at one count, or by one of the times.",
      evaluate_gpu_m1_faster(gpu));
  add("gpu_many", "section 6", "Few spheres do not exploit the parallelism: about 10,000 or more are needed.",
      "The GPU, launch and copies included, behind one core of the CPU at every count below some 10,000 and ahead "
      "there; in part: behind at the fewest spheres, ahead at the most.",
      evaluate_gpu_needs_many(gpu));
  return out;
}

Table derive_defaults(const Results& results) {
  Table out{"defaults", {"setting", "current", "follows", "rule", "finding"}, {}};
  struct Rule {
    const char *setting, *series;
    double current;
    const char *error, *unit;
    const char* words;
  };
  const auto add = [&](const Rule& rule, const auto& choose) {
    const Table t = results.sweep.sweep.where("series", rule.series);
    if (t.rows.size() < 3) return;
    const std::vector<double> values = t.numbers("value"), errors = t.numbers(rule.error);
    std::string finding = std::string(rule.error) + ":";
    for (std::size_t i = 0; i < values.size(); ++i) {
      finding += fmt::format("{} {:.3g}{}{} at {:g}", i > 0 ? "," : "", errors[i], *rule.unit == 0 ? "" : " ",
                             rule.unit, values[i]);
    }
    out.add({rule.setting, rule.current, values[choose(t, values, errors)], rule.words, finding});
  };
  const baker::BakeSettings current = baker::make_settings("balanced", "{}", "balanced");
  using Values = std::vector<double>;
  const auto cheapest = [](const Table&, const Values& values, const Values& errors) {
    return cheapest_within_tenth(values, errors);
  };
  add({"penetration_depth", kDepthExtremities, current.fit.penetration_depth, "core_f_mean_mm", "mm",
       "Where mean |F| over what the paper covers bends most over the spheres: farthest from the line between the "
       "ends."},
      [](const Table& t, const Values&, const Values& errors) { return bend(t.numbers("spheres"), errors); });
  add({"spheres_per_level", kPerLevel, static_cast<double>(current.fit.spheres_per_level), "torso_f_mean_mm", "mm",
       "The fewest within a tenth of the least mean |F| over the torso."},
      cheapest);
  add({"delta", kDelta, current.fit.delta, "spheres", "",
       "The longest climb that places as many spheres as the shortest, mean |F| over the torso within a tenth of the "
       "least."},
      [](const Table& t, const Values& values, const Values& spheres) {
        const Values f = t.numbers("torso_f_mean_mm");
        const double shortest =
            spheres[static_cast<std::size_t>(std::min_element(values.begin(), values.end()) - values.begin())];
        std::size_t best = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
          if (spheres[i] == shortest && f[i] <= 1.1 * least(f) && values[i] > values[best]) best = i;
        }
        return best;
      });
  add({"pivots", kPivotsMoments, static_cast<double>(current.bind.pivots), "refit_sphere_p95_mm", "mm",
       "The fewest within a tenth of the least 95th percentile of the refitted sphere's distance."},
      cheapest);
  return out;
}

}  // namespace spherechain::paper
