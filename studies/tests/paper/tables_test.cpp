// SPDX-License-Identifier: GPL-3.0-or-later
// The tables against the baked assets beside them and against each other.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/play/asset_file.h"
#include "baker/report/report.h"
#include "csv.h"

namespace {

const nlohmann::json& paper_asset() {
  static const nlohmann::json inspected = [] {
    const auto file = spherechain::baker::open_asset(std::string(SPHERECHAIN_PAPER_OUT) + "/paper.sphc");
    return nlohmann::json::parse(spherechain::baker::inspect_json(file));
  }();
  return inspected;
}

// The sweep's row of the paper's own settings.
Row paper_row() {
  for (const Row& row : only(read_csv("sweep.csv"), "series", "penetration_depth")) {
    if (std::abs(number(row, "value") - 0.3) < 1e-9) return row;
  }
  FAIL("no row at PD 0.3");
  return {};
}

}  // namespace

TEST_CASE("figure 13 has 80 rays of every torso sphere, and each ray is one half's but the two between them") {
  std::size_t torso = 0;
  for (const auto& sphere : paper_asset()["spheres"]) torso += sphere["side"] != "none" ? 1 : 0;
  const std::vector<Row> rays = read_csv("figure13.csv");
  CHECK(rays.size() == 80 * torso);
  for (std::size_t s = 0; s < torso; s += 2) {
    const std::vector<Row> left = only(rays, "sphere", std::to_string(s));
    const std::vector<Row> right = only(rays, "sphere", std::to_string(s + 1));
    REQUIRE(left.size() == 80);
    REQUIRE(right.size() == 80);
    for (std::size_t k = 0; k < 80; ++k) {
      CHECK(number(left[k], "ray") == static_cast<double>(k));
      CHECK(left[k].at("ray_length_mm") == right[k].at("ray_length_mm"));  // one disk a level
      CHECK(number(left[k], "own_half") + number(right[k], "own_half") == (k % 40 == 0 ? 2 : 1));
    }
  }
}

TEST_CASE("figure 13's mean over the vertices is the bake's own, and its runs of rays count up") {
  const std::vector<Row> spheres = read_csv("figure13_spheres.csv");
  double means[3] = {0, 0, 0};
  const char* columns[3] = {"vertices_phi1_mm", "vertices_phi1_adjusted_mm", "vertices_phi2_mm"};
  const char* names[3] = {"phi1", "phi1_adjusted", "phi2"};
  for (const Row& row : spheres) {
    for (int i = 0; i < 3; ++i) means[i] += number(row, columns[i]) / static_cast<double>(spheres.size());
    CHECK(number(row, "rays_better_phi1_adjusted") + number(row, "rays_better_phi2") <= number(row, "hits"));
    CHECK(number(row, "eccentricity_half") > 0);
    CHECK(number(row, "eccentricity_half") < 1);
  }
  for (int i = 0; i < 3; ++i) {
    CHECK(means[i] == doctest::Approx(1000 * paper_asset()["fit"][names[i]]["mean_abs_F"].get<double>()).epsilon(1e-5));
  }
}

TEST_CASE("the ball around the rays' own points is never larger than needed: at least two of them lie on it") {
  const std::vector<Row> rays = read_csv("figure13.csv");
  for (const Row& sphere : read_csv("figure13_spheres.csv")) {
    int on_it = 0;
    for (const Row& ray : only(only(rays, "sphere", sphere.at("sphere")), "own_half", "1")) {
      if (!ray.at("ray_length_mm").empty() && number(ray, "abs_f_phi2_rays_mm") < 1e-6) ++on_it;
    }
    CHECK(on_it >= 2);
  }
}

TEST_CASE("counts at the paper's settings are those that inspect gives") {
  const nlohmann::json& asset = paper_asset();
  const Row row = paper_row();
  const double n = asset["sphere_count"];
  CHECK(number(row, "spheres") == n);
  CHECK(number(row, "chain_entries") == asset["chain_entries"]);
  CHECK(number(row, "ignored_pairs") == asset["ignored_pairs"]);
  double full = 0;
  std::set<int> in_chain;
  for (const auto& chain : asset["chains"]) {
    full += static_cast<double>(chain["spheres"].size() * chain["spheres"].size());
    for (const int sphere : chain["spheres"]) in_chain.insert(sphere);
  }
  CHECK(number(row, "full_tests_m1") == full);
  CHECK(number(row, "full_tests_m2") == n * n);
  CHECK(number(row, "in_no_chain") == n - static_cast<double>(in_chain.size()));
  CHECK(number(row, "tests_m2") == n * (n - 1) / 2 - asset["ignored_pairs"].get<double>());
}

// L and R both hold the middle of a level; the head, which the paper leaves out, is on the way to either arm: in five.
TEST_CASE("every bake's chains hold 3x + 2t + 3|T| + |D| entries as Table 1 counts them") {
  for (const Row& row : read_csv("sweep.csv")) {
    CHECK(number(row, "chain_entries_table1") ==
          3 * number(row, "limb_spheres") + 2 * number(row, "torso_side_spheres") +
              4 * number(row, "torso_middle_spheres") + 3 * number(row, "top_spheres") + number(row, "bottom_spheres") +
              5 * number(row, "head_spheres"));
    CHECK(number(row, "full_tests_m2") == std::pow(number(row, "spheres"), 2));
    CHECK(number(row, "tests_m2") ==
          number(row, "spheres") * (number(row, "spheres") - 1) / 2 - number(row, "ignored_pairs"));
  }
}

TEST_CASE("deeper penetration never takes fewer spheres") {
  const std::vector<Row> sweep = read_csv("sweep.csv");
  for (const char* series : {"penetration_depth", "penetration_depth_extremities"}) {
    const std::vector<double> spheres = numbers(only(sweep, "series", series), "spheres");
    CHECK(spheres.size() >= 3);
    CHECK(std::is_sorted(spheres.begin(), spheres.end()));
    CHECK(spheres.front() < spheres.back());
  }
}

TEST_CASE("figure 15 has every frame of both animations, with the tests that the asset asks for") {
  const std::vector<Row> all = read_csv("figure15.csv");
  const Row row = paper_row();
  for (const auto& [method, tests] : {std::pair("M1", "tests_m1"), std::pair("M2", "tests_m2"),
                                      std::pair("M1 full", "full_tests_m1"), std::pair("M2 full", "full_tests_m2")}) {
    const std::vector<Row> rows = only(all, "method", method);
    CHECK(rows.size() == 80);
    for (const char* animation : {"arms", "legs"}) CHECK(only(rows, "animation", animation).size() == 40);
    for (const Row& frame : rows) {
      CHECK(number(frame, "tests") == number(row, tests));
      CHECK(number(frame, "us") > 0);
    }
  }
  // The full loops see every overlap from both sides, neighbours and the sphere itself included.
  const std::vector<Row> m2 = only(all, "method", "M2"), full = only(all, "method", "M2 full"),
                         product = only(all, "method", "all_pairs");
  REQUIRE(product.size() == m2.size());
  for (std::size_t f = 0; f < m2.size(); ++f) {
    CHECK(product[f].at("overlaps") == m2[f].at("overlaps"));
    CHECK(number(full[f], "overlaps") >= 2 * number(m2[f], "overlaps") + paper_asset()["sphere_count"].get<double>());
  }
}

TEST_CASE("sphere sets: the volume ratio is cover and overhang, larger spheres cover more, the enclosing balls most") {
  const std::vector<Row> quality = read_csv("quality.csv");
  for (const Row& row : quality) {
    CHECK(number(row, "volume_ratio") == doctest::Approx(number(row, "coverage") + number(row, "outside_volume")));
    CHECK(number(row, "gap_mean_mm") <= number(row, "gap_p95_mm") + number(row, "uncovered_surface") * 1000);
  }
  const auto torso_of = [&](const char* set) { return only(only(quality, "set", set), "part", "torso").front(); };
  CHECK(number(torso_of("paper, torso phi2"), "coverage") > number(torso_of("paper, torso phi1'"), "coverage"));
  CHECK(number(torso_of("paper, torso phi2"), "outside_volume") >
        number(torso_of("paper, torso phi1'"), "outside_volume"));
  const std::vector<Row> balanced = only(only(quality, "set", "balanced"), "part", "body");
  CHECK(number(only(balanced, "radius", "detect").front(), "coverage") >
        number(only(balanced, "radius", "fit").front(), "coverage"));
}
