// SPDX-License-Identifier: GPL-3.0-or-later
#include "tree_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "tree_time.h"

namespace spherechain::paper {
namespace {

constexpr double kTreeLead = 0.95;  // less of the other's time than that is a lead

std::vector<double> sphere_counts(const Table& series) {
  std::vector<double> out = series.numbers("spheres");
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

double us_at(const Table& series, double spheres, const char* method) {
  return series.where("spheres", spheres).where("method", method).number(0, "us");
}

const char* fastest_tree(const Table& series, double spheres) {
  return *std::min_element(kTrees.begin(), kTrees.end(), [&](const char* a, const char* b) {
    return us_at(series, spheres, a) < us_at(series, spheres, b);
  });
}

// The fewest spheres from which on a tree leads at every count.
std::optional<double> wins_from(const Table& series, const char* tree, const char* other) {
  const std::vector<double> counts = sphere_counts(series);
  std::optional<double> out;
  for (auto count = counts.rbegin(); count != counts.rend(); ++count) {
    if (us_at(series, *count, tree) >= kTreeLead * us_at(series, *count, other)) break;
    out = *count;
  }
  return out;
}

}  // namespace

Verdict judge_no_trees(const Table& trees) {
  const Table baked = trees.where("series", kBaked);
  if (baked.empty()) return {kNotRun, ""};
  std::size_t behind = 0;
  std::string finding = "Fastest tree against the faster of M1 and M2, and the product's all_pairs:";
  for (const double stated : {kSummedSpheres, kStatedSpheres}) {
    const double spheres = baked.number(nearest_count(baked, stated), "spheres");
    const char* const tree = fastest_tree(baked, spheres);
    const double us = us_at(baked, spheres, tree);
    const double loop = std::min(us_at(baked, spheres, kLoopM1), us_at(baked, spheres, kLoopM2));
    behind += us >= kTreeLead * loop ? 1 : 0;
    finding += fmt::format("{} {:.2f} us ({}) against {:.2f} and {:.2f} at {:g} spheres",
                           finding.back() == ':' ? "" : ",", us, tree, loop, us_at(baked, spheres, kJob), spheres);
  }
  return {graded(behind == 2, behind > 0), finding + "."};
}

Table tree_wins(const Table& trees) {
  Table out{"tree_wins", {"series", "tree", "from_m1", "from_m2", "from_all_pairs"}, {}};
  for (const std::string& series : trees.words("series")) {
    const Table t = trees.where("series", series);
    for (const char* tree : kTrees) {
      std::vector<Cell> row{series, tree};
      for (const char* other : {kLoopM1, kLoopM2, kJob}) {
        const std::optional<double> from = wins_from(t, tree, other);
        row.push_back(from ? Cell(*from) : Cell("nowhere"));
      }
      out.add(std::move(row));
    }
  }
  return out;
}

std::string tree_verdict(const Table& trees) {
  const Table baked = trees.where("series", kBaked);
  if (baked.empty()) return "";
  const std::vector<double> counts = sphere_counts(baked);
  std::string ratios;
  double least_ratio = std::numeric_limits<double>::infinity();
  for (const double spheres : counts) {
    const double ratio = us_at(baked, spheres, fastest_tree(baked, spheres)) / us_at(baked, spheres, kJob);
    least_ratio = std::min(least_ratio, ratio);
    ratios += fmt::format("{}{:.1f} at {:g} spheres", ratios.empty() ? "" : ", ", ratio, spheres);
  }
  return fmt::format(
      "{} A character has at most {} spheres. On baked chains the fastest tree takes this share of the "
      "time of the product's all_pairs: {}.",
      least_ratio < kTreeLead ? "A tree would pay in the product on some baked chains."
                              : "Trees stay out of the product: they win on no baked chains.",
      baker::kSpheresMax, ratios);
}

}  // namespace spherechain::paper
