// SPDX-License-Identifier: GPL-3.0-or-later
// Each verdict once more, from the CSV files alone.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "csv.h"

namespace {

const std::vector<Row>& claims() {
  static const std::vector<Row> rows = read_csv("claims.csv");
  return rows;
}

std::string verdict(const std::string& id) { return only(claims(), "id", id).front().at("verdict"); }

std::string graded(bool all, bool some) { return all ? "holds" : some ? "holds in part" : "does not hold"; }

double median_of(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
}

double mean_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}

// Spearman's, by counting what is smaller and what is equal.
double spearman(const std::vector<double>& x, const std::vector<double>& y) {
  const auto ranks = [](const std::vector<double>& v) {
    std::vector<double> out;
    for (const double a : v) {
      double rank = 0;
      for (const double b : v) rank += b < a ? 1 : b == a ? 0.5 : 0;
      out.push_back(rank);
    }
    return out;
  };
  const std::vector<double> a = ranks(x), b = ranks(y);
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_of(a)) * (b[i] - mean_of(b));
    aa += (a[i] - mean_of(a)) * (a[i] - mean_of(a));
    bb += (b[i] - mean_of(b)) * (b[i] - mean_of(b));
  }
  return ab / std::sqrt(aa * bb);
}

std::vector<Row> depth_series() {
  const std::vector<Row> sweep = read_csv("sweep.csv");
  std::vector<Row> rows = only(sweep, "series", "penetration_depth");
  for (const Row& row : only(sweep, "series", "penetration_depth_extremities")) rows.push_back(row);
  return rows;
}

std::vector<double> times(const std::string& method, const std::string& animation) {
  return numbers(only(only(read_csv("figure15.csv"), "method", method), "animation", animation), "us");
}

}  // namespace

TEST_CASE("the page and the Markdown state every claim with its verdict and finding") {
  const std::string page = read_output("index.html"), markdown = read_output("paper.md");
  CHECK(claims().size() == 14);
  for (const Row& claim : claims()) {
    CHECK(page.find(">" + claim.at("verdict") + "</span>") != std::string::npos);
    CHECK(markdown.find("| " + claim.at("verdict") + " |") != std::string::npos);
    // Up to the first character that either escapes.
    const std::string finding = claim.at("finding").substr(0, claim.at("finding").find_first_of("&<>|"));
    CHECK(page.find(finding) != std::string::npos);
    CHECK(markdown.find(finding) != std::string::npos);
  }
}

TEST_CASE("adjustment, shape: recomputed from figure13_spheres.csv") {
  const std::vector<Row> spheres = read_csv("figure13_spheres.csv");
  double gain = 0;
  bool never_worse = true;
  for (const Row& row : spheres) {
    const double change = number(row, "vertices_phi1_mm") - number(row, "vertices_phi1_adjusted_mm");
    gain += change;
    never_worse = never_worse && change >= 0;
  }
  CHECK(verdict("adjustment") == graded(never_worse && gain > 0, gain > 0));

  const std::vector<double> e = numbers(spheres, "eccentricity_half");
  for (const auto& [id, phi2] : {std::pair("shape", "rays_phi2_mm"), std::pair("shape_rays", "rays_phi2_rays_mm")}) {
    std::vector<double> lead;
    double of[2] = {0, 0}, right[2] = {0, 0};
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      lead.push_back(number(spheres[i], phi2) - number(spheres[i], "rays_phi1_adjusted_mm"));
      const int group = e[i] > median_of(e) ? 1 : 0;
      ++of[group];
      if (group == 1 ? lead[i] > 0 : lead[i] < 0) ++right[group];
    }
    const bool round = right[0] >= 0.75 * of[0], eccentric = right[1] >= 0.75 * of[1];
    CHECK(verdict(id) == graded(round && eccentric && spearman(e, lead) >= 0.5, round || eccentric));
  }
}

TEST_CASE("sphere count, tests, turn over: recomputed from sweep.csv and readings.csv") {
  bool stated = false, less = false, more = false, any_m1_less = false;
  for (const Row& row : depth_series()) {
    const double entries = number(row, "chain_entries_table1") / number(row, "spheres");
    less = less || entries <= 138.0 / 80;
    more = more || entries >= 138.0 / 80;
    any_m1_less = any_m1_less || number(row, "full_tests_m1") < number(row, "full_tests_m2") ||
                  number(row, "tests_m1") < number(row, "tests_m2");
  }
  stated = less && more;
  CHECK(verdict("sphere_count") == graded(stated, false));
  CHECK(verdict("turn_over") == graded(!any_m1_less, true));

  const std::vector<Row> readings = read_csv("readings.csv");
  CHECK(readings.size() == 6);
  const auto fewer = std::count_if(readings.begin(), readings.end(), [](const Row& row) {
    return number(row, "full_tests_m2") < number(row, "full_tests_m1");
  });
  CHECK(verdict("fewer_tests") == graded(fewer == 6, fewer > 0));
}

TEST_CASE("overlaps, time, animation: recomputed from figure15.csv") {
  const std::vector<Row> all = read_csv("figure15.csv");
  const std::vector<double> m1 = numbers(only(all, "method", "M1"), "overlaps"),
                            m2 = numbers(only(all, "method", "M2"), "overlaps");
  bool never_fewer = true;
  for (std::size_t i = 0; i < m1.size(); ++i) never_fewer = never_fewer && m1[i] >= m2[i];
  const bool more = mean_of(m1) > mean_of(m2);
  CHECK(verdict("overlaps") == graded(more && never_fewer, more));

  bool faster[2];
  for (const int full : {0, 1}) {
    const std::vector<double> slow = numbers(only(all, "method", full == 1 ? "M1 full" : "M1"), "us"),
                              fast = numbers(only(all, "method", full == 1 ? "M2 full" : "M2"), "us");
    std::vector<double> ratio;
    for (std::size_t i = 0; i < slow.size(); ++i) ratio.push_back(slow[i] / fast[i]);
    faster[full] = median_of(ratio) > 1;
  }
  CHECK(verdict("m2_faster") == graded(faster[0] && faster[1], faster[0] || faster[1]));

  bool same = true, grows = true;
  const std::vector<Row> series = depth_series();
  for (const auto& [method, column] : {std::pair("M1", "us_m1"), std::pair("M2", "us_m2")}) {
    const double arms = median_of(times(method, "arms")), legs = median_of(times(method, "legs"));
    same = same && std::max(arms, legs) <= 1.1 * std::min(arms, legs);
    grows = grows && spearman(numbers(series, "spheres"), numbers(series, column)) >= 0.9;
  }
  CHECK(verdict("animation") == graded(same && grows, same || grows));
}

TEST_CASE("spheres a level, pivots: recomputed from sweep.csv") {
  const std::vector<Row> sweep = read_csv("sweep.csv");
  const std::vector<double> f = numbers(only(sweep, "series", "spheres_per_level"), "torso_f_mean_mm");
  REQUIRE(f.size() == 3);
  CHECK(verdict("per_level") == graded(f[1] < f[0] && f[2] < f[1], f[1] < f[0]));

  int better = 0;
  for (const char* series : {"pivots_paper", "pivots_moments"}) {
    const std::vector<Row> rows = only(sweep, "series", series);
    const double with_four = number(only(rows, "value", "4").front(), "refit_sphere_p95_mm");
    if (number(rows.back(), "refit_sphere_p95_mm") < 0.9 * with_four) ++better;
    CHECK(number(rows.back(), "value") == 16);
  }
  CHECK(verdict("more_pivots") == graded(better == 2, better > 0));
}

TEST_CASE("defaults: recomputed from sweep.csv") {
  const std::vector<Row> sweep = read_csv("sweep.csv"), defaults = read_csv("defaults.csv");
  CHECK(defaults.size() == 4);
  const auto follows = [&](const char* setting) {
    return number(only(defaults, "setting", setting).front(), "follows");
  };
  for (const auto& [setting, series, error] : {std::tuple("spheres_per_level", "spheres_per_level", "torso_f_mean_mm"),
                                               std::tuple("pivots", "pivots_moments", "refit_sphere_p95_mm")}) {
    const std::vector<Row> rows = only(sweep, "series", series);
    const std::vector<double> errors = numbers(rows, error);
    const double enough = 1.1 * *std::min_element(errors.begin(), errors.end());
    const auto first = std::find_if(errors.begin(), errors.end(), [&](double e) { return e <= enough; });
    CHECK(follows(setting) == number(rows[static_cast<std::size_t>(first - errors.begin())], "value"));
  }
  // The bend: no other depth lies farther below the line from the first to the last.
  const std::vector<Row> depths = only(sweep, "series", "penetration_depth_extremities");
  const std::vector<double> cost = numbers(depths, "spheres"), error = numbers(depths, "core_f_mean_mm");
  const auto [c0, c1] = std::minmax_element(cost.begin(), cost.end());
  const auto [e0, e1] = std::minmax_element(error.begin(), error.end());
  double best = 1e9, chosen = 1e9;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    const double sum = (cost[i] - *c0) / (*c1 - *c0) + (error[i] - *e0) / (*e1 - *e0);
    best = std::min(best, sum);
    if (number(depths[i], "value") == follows("penetration_depth")) chosen = sum;
  }
  CHECK(chosen == best);
}

TEST_CASE(
    "trees: every method finds as many pairs, and the verdict and the first leads are recomputed from trees.csv") {
  const std::vector<Row> trees = read_csv("trees.csv");
  const auto us = [&](const std::string& series, const std::string& spheres, const std::string& method) {
    return number(only(only(only(trees, "series", series), "spheres", spheres), "method", method).front(), "us");
  };
  for (const Row& row : trees) {
    if (row.at("method") == "M1") continue;
    const std::vector<Row> m2 =
        only(only(only(trees, "series", row.at("series")), "spheres", row.at("spheres")), "method", "M2");
    CHECK(row.at("overlaps") == m2.front().at("overlaps"));
  }
  const std::vector<std::string> names{"binary tree", "quadtree", "octree"};
  int behind = 0;
  for (const char* spheres : {"50", "84"}) {
    double fastest = 1e9;
    for (const std::string& tree : names) fastest = std::min(fastest, us("baked", spheres, tree));
    behind += fastest >= 0.95 * std::min(us("baked", spheres, "M1"), us("baked", spheres, "M2")) ? 1 : 0;
  }
  CHECK(verdict("no_trees") == graded(behind == 2, behind > 0));

  for (const Row& row : read_csv("tree_wins.csv")) {
    const std::vector<Row> series = only(only(trees, "series", row.at("series")), "method", row.at("tree"));
    for (const auto& [column, method] :
         {std::pair("from_m1", "M1"), std::pair("from_m2", "M2"), std::pair("from_all_pairs", "all_pairs")}) {
      const double from = row.at(column) == "nowhere" ? 1e9 : number(row, column);
      double last_behind = 0;
      for (const Row& count : series) {
        const bool leads = number(count, "us") < 0.95 * us(row.at("series"), count.at("spheres"), method);
        if (!leads) last_behind = std::max(last_behind, number(count, "spheres"));
      }
      for (const Row& count : series) {
        CHECK((number(count, "spheres") >= from) == (number(count, "spheres") > last_behind));
      }
    }
  }
}
