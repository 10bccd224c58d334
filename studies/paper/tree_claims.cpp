// SPDX-License-Identifier: GPL-3.0-or-later
#include "tree_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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

Verdict evaluate_no_trees(const Table& trees) {
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

Table tree_times(const Table& trees) {
  Table out{"tree_times", {"source", "spheres", "overlaps"}, {}};
  constexpr std::array<const char*, 6> kShown{kLoopM1, kLoopM2, kBinaryTree, kQuadtree, kOctree, kJob};
  for (const char* method : kShown) out.columns.push_back(std::string("us ") + method);
  for (const char* tree : kTrees) out.columns.push_back(std::string("refit ") + tree);
  for (const char* method : kShown) out.columns.push_back(std::string("tests ") + method);
  for (const std::string& source : trees.words("source")) {
    const Table t = trees.where("source", source);
    const auto cell = [&](const char* method, const char* column) { return t.where("method", method).at(0, column); };
    std::vector<Cell> row{source, cell(kLoopM2, "spheres"), cell(kLoopM2, "overlaps")};
    for (const char* method : kShown) row.push_back(cell(method, "us"));
    for (const char* tree : kTrees) row.push_back(cell(tree, "refit_us"));
    for (const char* method : kShown) row.push_back(cell(method, "tests"));
    out.add(std::move(row));
  }
  return out;
}

std::string tree_verdict(const Table& trees) {
  const Table baked = trees.where("series", kBaked);
  if (baked.empty()) return "";
  bool leads = true;
  std::string ratios;
  for (const double spheres : sphere_counts(baked)) {
    const double ratio = us_at(baked, spheres, fastest_tree(baked, spheres)) / us_at(baked, spheres, kJob);
    const std::string source = baked.where("spheres", spheres).word(0, "source");
    if (source == kPaperAsIs || source == kBalancedAsIs) leads = leads && ratio < kTreeLead;
    ratios += fmt::format("{}{:.2g} at {:g} spheres ({})", ratios.empty() ? "" : ", ", ratio, spheres, source);
  }
  return fmt::format("{} Baked chains, the fastest tree's time divided by that of all_pairs: {}.",
                     leads ? "A tree would pay in the product: it leads on the bakes of both profiles."
                           : "Trees stay out of the product: they do not lead on the bakes of both profiles.",
                     ratios);
}

}  // namespace spherechain::paper
