// SPDX-License-Identifier: GPL-3.0-or-later
#include "report.h"

#include <fmt/format.h>

#include "baker/os/written_file.h"
#include "figures.h"
#include "spherechain/types.h"
#include "tree_claims.h"

namespace spherechain::paper {
namespace {

struct ShownColumn {
  std::string column, header;
  int digits = 0;  // after the point
  double scale = 1;
};

struct ShownTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

ShownTable show(const Table& table, const std::vector<ShownColumn>& columns) {
  ShownTable out;
  for (const ShownColumn& column : columns) out.header.push_back(column.header);
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    out.rows.emplace_back();
    for (const ShownColumn& column : columns) {
      const Cell& cell = table.at(r, column.column);
      out.rows.back().push_back(cell.number ? fmt::format("{:.{}f}", column.scale * *cell.number, column.digits)
                                            : cell.word);
    }
  }
  return out;
}

struct Section {
  std::string title;
  std::vector<std::string> text;
  std::vector<Figure> figures;
  std::vector<ShownTable> tables;
};

Section gpu_section(const Results& results) {
  Section out{"Figure 16: time of a frame on a GPU", {}, {}, {}};
  if (results.gpu.frames.empty()) {
    out.text.push_back("Not run: it takes a machine with a GPU (`spherechain_figure16`).");
    return out;
  }
  out.text = {
      "The paper's own mappings (`studies/cuda`) for one character. M2: a thread tests one sphere against the whole "
      "mesh "
      "(m^2 tests). M1: a thread takes one chain, or one sphere of a chain, and tests the whole chain (n_c n^2 tests). "
      "Measured on: " +
          results.gpu.machine + ", by `" + results.gpu.command +
          "`. CUDA events time the kernel alone. The host's clock times its launch, with the count back. \"With "
          "copies\" "
          "also takes the frame's spheres there and brings the pairs back. The pairs are compared with the CPU's "
          "before "
          "anything is timed. Every time is a median; launches of more than 0.1 s are timed on every 20th frame.",
      "The two smallest counts are the bakes \"ours, profile paper\" and \"ours, denser\" below. In the others each "
      "sphere of the first is replaced by smaller ones inside it, with the same volume together, in every chain that "
      "holds it. Their pairs are ignored, or are rest pairs, where the two spheres' pair is. The CPU's times are of "
      "one core of the same machine: M1 takes the threads' own code in a loop, M2 is the product's scalar job."};
  out.figures = {gpu_time_figure(results), gpu_count_figure(results)};
  Table medians = gpu_medians(results.gpu);
  for (auto& row : medians.rows) row[2].word = gpu_label(row[2].word);
  out.tables = {show(medians, {{"spheres", "Spheres"},
                               {"method", "Method"},
                               {"frames", "Frames"},
                               {"overlaps", "Overlaps", 1},
                               {"kernel_us", "us, kernel or CPU", 2},
                               {"launch_us", "with launch", 2},
                               {"frame_us", "with launch and copies", 2}})};
  return out;
}

Section tree_section(const Results& results) {
  return {
      "Trees over the chains",
      {"The paper leaves a hierarchy over the chains to future work. These are binary, quad and oct trees "
       "(`studies/paper/chain_trees.h`), refitted bottom up in every frame. A parent encloses its children's "
       "spheres; a wrapped hierarchy (Guibas 2002), which encloses the chain's own spheres more tightly, was not "
       "tried. Each region's spheres have one tree, in the order of their chain. Each tree is tested against "
       "itself and against the others, so the trees find what M2 finds. Trees over the chains of Table 1 would "
       "test a limb's pairs three times, because three chains hold it. Two parents are skipped where all pairs "
       "below them are ignored. Rest pairs are tested one by one.",
       "The pairs of the trees and of the product are compared with M2's before anything is timed. Each frame and "
       "method takes its turn in every repetition. Times are medians, on one core: " +
           results.machine + ". Trees, M1 and M2 are scalar code. The product's all_pairs has its table and runs on " +
           sc_target_name(sc_supported_targets(nullptr)[0]) +
           ". More spheres come from two sources. Baked chains have penetration depths up to the most that the "
           "baker takes. Spheres in parts are those of Figure 16, the parts of a sphere in the order of halves. "
           "They are the trees' best case: all pairs within a sphere and of neighbours are ignored together, and "
           "few others touch.",
       tree_verdict(results.trees)},
      {tree_figure(results)},
      {show(tree_wins(results.trees), {{"series", "Spheres"},
                                       {"tree", "Tree"},
                                       {"from_m1", "Ahead of M1 from"},
                                       {"from_m2", "of M2 from"},
                                       {"from_all_pairs", "of all_pairs from"}}),
       show(tree_times(results.trees), {{"source", "From"},
                                        {"spheres", "Spheres"},
                                        {"overlaps", "Overlaps", 2},
                                        {"us M1", "us M1", 2},
                                        {"us M2", "M2", 2},
                                        {"us binary tree", "binary tree", 2},
                                        {"us quadtree", "quadtree", 2},
                                        {"us octree", "octree", 2},
                                        {"us all_pairs", "all_pairs", 2},
                                        {"refit binary tree", "of it refit, binary", 2},
                                        {"refit quadtree", "quad", 2},
                                        {"refit octree", "oct", 2},
                                        {"tests M1", "Tests M1"},
                                        {"tests M2", "M2"},
                                        {"tests binary tree", "binary tree"},
                                        {"tests quadtree", "quadtree"},
                                        {"tests octree", "octree"}})}};
}

std::vector<Section> sections(const Results& results) {
  std::vector<Section> out;
  out.push_back({"What the paper claims",
                 {"A rule computes each verdict from the run's tables. The rule stands beside it."},
                 {},
                 {show(evaluate_claims(results), {{"paper_says", "The paper says"},
                                                  {"verdict", "Verdict"},
                                                  {"finding", "Finding"},
                                                  {"rule", "Rule"},
                                                  {"where", "Where"}})}});
  out.push_back(
      {"Figure 13: the three fits of the torso",
       {"phi1 is the sphere of the climbing disk. phi1' is the same after the sphere adjustment. phi2 is the minimum "
        "enclosing ball, read in two ways: around the vertices of the sphere's band of the torso (as the bake report "
        "has it), or around the colliding points of the disk's rays. The eccentricity is that of the ellipse with the "
        "section's second moments: 0 for a circle. Left and right spheres mirror each other, so eight spheres are four "
        "shapes.",
        "The paper finds on its body: sphere 0: phi2 is better in the first half of the colliding points; sphere 1: "
        "phi1' is better there; 2 and 3 are like 0 and 1; 4: phi2 from r8; 5: phi2 in r0 to r25; 6: phi1' before r16; "
        "7: phi1' after r16. On this body:"},
       {accuracy_figure(results), shape_figure(results)},
       {show(results.accuracy.spheres, {{"sphere", "Sphere"},
                                        {"level", "Level"},
                                        {"side", "Side"},
                                        {"eccentricity_half", "Eccentricity, half", 2},
                                        {"eccentricity_section", "whole section", 2},
                                        {"rays_phi1_mm", "mean |F| phi1 (mm)", 1},
                                        {"rays_phi1_adjusted_mm", "phi1'", 1},
                                        {"rays_phi2_mm", "phi2", 1},
                                        {"rays_phi2_rays_mm", "phi2 of the rays", 1},
                                        {"phi1_adjusted_better_at", "phi1' better at"},
                                        {"phi2_better_at", "phi2 better at"}})}});
  out.push_back(
      {"Figure 15: time of a frame",
       {"All times are of scalar code on one core, at the paper's radius: " + results.machine +
        ". M1 and M2 are plain loops of one style (`studies/plain_detection.h`), so that their times can be "
        "compared. M1 is no part of the product. The product's refit and its all_pairs job, which finds what M2 finds, "
        "stand beside them. Each frame and method takes its turn in every repetition. A time is the median of the "
        "repetitions."},
       {running_time_figure(results)},
       {}});
  out.push_back(gpu_section(results));
  out.push_back(tree_section(results));
  out.push_back({"46 or 80 spheres",
                 {"Table 1 puts every limb in three chains, L and R in two each, T in three, D in one. So x limb and t "
                  "torso spheres make 3x + 2t + 3|T| + |D| entries. The paper's two numbers, 138 entries and 80 "
                  "spheres, do not fit each other. Here are both readings, and bakes close to them:"},
                 {sphere_count_figure(results)},
                 {show(compare_readings(results), {{"reading", "Reading"},
                                                   {"penetration_depth", "PD", 2},
                                                   {"spheres", "Spheres"},
                                                   {"chain_entries_table1", "Chain entries"},
                                                   {"full_tests_m1", "n_c n^2"},
                                                   {"full_tests_m2", "m^2"},
                                                   {"tests_m1", "Tests M1"},
                                                   {"tests_m2", "Tests M2"},
                                                   {"overlaps_m1", "Overlaps M1", 2},
                                                   {"overlaps_m2", "Overlaps M2", 2},
                                                   {"us_m1", "us M1", 2},
                                                   {"us_m2", "us M2", 2}})}});
  Section sweep{
      "What each setting costs and brings",
      {"One setting changes at a time; the others keep their defaults (profile balanced unless said otherwise). The "
       "skin outside the detect radius is what detect_quantile leaves out, less what neighbours cover. A level's place "
       "is found by bisection between two stops of the disk, so delta matters only where the disk steps over one. One "
       "pivot makes no sphere, because it has no distance from itself."},
      {},
      {show(derive_defaults(results), {{"setting", "Setting"},
                                       {"current", "Default", 3},
                                       {"follows", "Follows", 3},
                                       {"rule", "Rule"},
                                       {"finding", "Finding"}})}};
  const auto add_sweep = [&](const char* setting, const char* axis, const std::vector<SweepLine>& lines) {
    Figure figure = sweep_figure(results, setting, axis, lines);
    if (!figure.panels[0].series.empty()) sweep.figures.push_back(std::move(figure));
  };
  constexpr Style kMain = Style::kLineAndMarks, kOther = Style::kDashed;
  add_sweep("penetration_depth", "penetration depth PD",
            {{kDepthPaper, "profile paper", kOther}, {kDepthExtremities, "profile balanced", kMain}});
  add_sweep("spheres_per_level", "spheres a level N_s", {{kPerLevel, "", kMain}});
  add_sweep("delta", "delta (of the height)", {{kDelta, "", kMain}});
  add_sweep("pivots", "pivots",
            {{kPivotsPaper, "the paper's refit", kOther}, {kPivotsMoments, "refit by moments", kMain}});
  out.push_back(std::move(sweep));
  out.push_back(
      {"Sphere sets by the field's measures",
       {"All sets are measured at the same 10,000 points inside the body and 10,000 points of its skin. Coverage: the "
        "volume inside some sphere. Outside: the spheres' volume outside the skin, of the part's volume. Volume ratio: "
        "the sum of both. Protrusion: how deep points of the spheres lie outside the skin. Gap: how far the skin is "
        "from the spheres. Body is all of it; core is what the paper covers (no head, hands and feet); torso is the "
        "core's torso."},
       {quality_figure(results)},
       {show(results.quality, {{"set", "Set"},
                               {"radius", "Radius"},
                               {"part", "Part"},
                               {"spheres", "Spheres"},
                               {"coverage", "Coverage (%)", 1, 100},
                               {"outside_volume", "Outside (%)", 1, 100},
                               {"volume_ratio", "Volume ratio", 2},
                               {"protrusion_p95_mm", "Protrusion p95 (mm)", 1},
                               {"gap_mean_mm", "Gap mean (mm)", 2},
                               {"gap_p95_mm", "p95 (mm)", 1},
                               {"uncovered_surface", "Uncovered skin (%)", 1, 100}})}});
  return out;
}

constexpr const char* kTitle = "The paper's experiments";

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Sphere chains: the paper's experiments</title>
<style>
body{font:16px/1.5 Helvetica,Arial,sans-serif;color:#222;background:#fff;max-width:1120px;margin:2rem auto;padding:0 1rem}
h1{font-size:1.7rem}h2{font-size:1.25rem;margin-top:2.5rem;border-top:1px solid #ddd;padding-top:1.2rem}
figure{margin:1.2rem 0}figure svg{width:100%;height:auto;border:1px solid #e3e3e3;border-radius:4px}
figcaption{font-size:.9rem;color:#444;margin-top:.3rem}
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.86rem;width:100%}
th,td{text-align:left;vertical-align:top;padding:.35rem .6rem;border-bottom:1px solid #e3e3e3}th{background:#f6f6f6}
td.number{text-align:right;font-variant-numeric:tabular-nums}
.verdict{display:inline-block;padding:.05rem .5rem;border-radius:1rem;white-space:nowrap;font-weight:600}
.holds{background:#d9efe7;color:#00543d}.part{background:#fdf0d0;color:#6b4a00}.fails{background:#fbe0d1;color:#7d3600}
.none{background:#eee;color:#444}
</style></head><body>
)";

std::string verdict_badge(const std::string& word) {
  const char* style = word == kHolds ? "holds" : word == kInPart ? "part" : word == kFails ? "fails" : "none";
  return fmt::format("<span class=\"verdict {}\">{}</span>", style, word);
}

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789.-") == std::string::npos;
}

bool is_verdict(const std::string& text) {
  return text == kHolds || text == kInPart || text == kFails || text == kNotRun;
}

std::string html(const ShownTable& table) {
  std::string out = "<div class=\"wide\"><table><tr>";
  for (const std::string& header : table.header) out += "<th>" + escape(header) + "</th>";
  out += "</tr>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (const std::string& cell : row) {
      out += is_number(cell) ? "<td class=\"number\">" : "<td>";
      out += (is_verdict(cell) ? verdict_badge(cell) : escape(cell)) + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string markdown(const ShownTable& table) {
  std::string out, rule;
  const auto line = [&](const std::vector<std::string>& cells) {
    out += "|";
    for (const std::string& cell : cells) {
      out += ' ';
      for (const char c : cell) out += c == '|' ? std::string("\\|") : std::string(1, c);
      out += " |";
    }
    out += "\n";
  };
  line(table.header);
  for (std::size_t i = 0; i < table.header.size(); ++i) rule += "---|";
  out += "|" + rule + "\n";
  for (const auto& row : table.rows) line(row);
  return out + "\n";
}

std::vector<Table> tables(const Results& results) {
  return {evaluate_claims(results),  derive_defaults(results),
          results.accuracy.rays,     results.accuracy.spheres,
          results.sweep.accuracy,    results.running_time,
          compare_readings(results), results.sweep.sweep,
          results.quality,           results.trees,
          tree_wins(results.trees),  results.gpu.frames,
          gpu_medians(results.gpu)};
}

}  // namespace

void write_page(const std::filesystem::path& folder, const Results& results) {
  std::filesystem::create_directories(folder);
  std::string page = kHead;
  page += fmt::format(
      "<h1>{}</h1>\n<p>Self-collision Detection using Sphere Chains, on the MakeHuman body of Debian's "
      "assimp-testmodels. The tables:",
      kTitle);
  for (const Table& table : tables(results)) {
    baker::write_atomically(folder / (table.name + ".csv"), to_csv(table));
    page += fmt::format(" <a href=\"{0}.csv\">{0}.csv</a>", table.name);
  }
  page += ".</p>\n";
  for (const Section& section : sections(results)) {
    page += "<section><h2>" + escape(section.title) + "</h2>\n";
    for (const std::string& paragraph : section.text) page += "<p>" + escape(paragraph) + "</p>\n";
    for (const Figure& figure : section.figures) {
      const std::string svg = to_svg(figure);
      baker::write_atomically(folder / (figure.name + ".svg"), svg);
      page += "<figure>" + svg + "<figcaption>" + escape(figure.caption) + "</figcaption></figure>\n";
    }
    for (const ShownTable& table : section.tables) page += html(table);
    page += "</section>\n";
  }
  baker::write_atomically(folder / "index.html", page + "</body></html>\n");
}

// Markdown alone: the page has the results, not how to repeat them.
constexpr const char* kSettings = R"(## Settings of these experiments

`bake --config` takes these keys too. Only these experiments turn them; for a product leave them as they are.

| key | values | default | meaning |
|---|---|---|---|
| `rays` | 8 to 4096 | 80 | rays of a ring around a limb, and of a disk in the torso |
| `delta` | 0.0001 to 0.2 | 0.015 | how far the torso's disk climbs at a time, of the height |
| `limb_step` | 0.0001 to 0.05 | 0.0015 | how far the ring marches along a limb at a time, of the height |
| `spheres_per_level` | 1 to 3 | 2 | spheres side by side on a level of the torso |
| `refit` | `moments`, `paper` | `moments` | how spheres follow the skin; `moments` is exact at rest |
| `pivots` | 4 to 16; with refit `paper` 2 to 16 | 8; with refit `paper` 4 | triangles that carry a sphere; the bake takes up to 16 where so few cannot carry it |

Profile `paper` is `{"refit": "paper", "pivots": 4, "extremities": false}`. With refit `paper`, each rest pair is reported nearer than nine tenths of its distance at rest; a prop cannot have it.

)";

void write_docs(const std::filesystem::path& file, const Results& results) {
  const std::filesystem::path folder = std::filesystem::path(file).replace_extension();
  std::filesystem::create_directories(folder);
  std::string page = fmt::format(
      "# {}\n\nWritten by `scripts/paper.sh --docs docs/paper.md`; do not edit. It repeats the experiments of "
      "\"Self-collision Detection using Sphere Chains\" and judges the paper's claims.\n\n"
      "- The character is the MakeHuman body of Debian's `assimp-testmodels`. Two animations of 40 frames move its "
      "arms "
      "and its legs (`samples/poses`).\n"
      "- Profile `paper` is the paper's setting: N_r = 80 rays, N_s = 2 spheres a level, delta = 0.25 of its "
      "decimetres, PD = 30 %.\n"
      "- M1 tests spheres along each chain. M2 tests every sphere against all others. Elsewhere in this project they "
      "are called `chains` and `all_pairs`.\n"
      "- The run also writes `out/paper/index.html`, with all figures, and a CSV file for each table.\n\n",
      kTitle);
  page += kSettings;
  for (const Section& section : sections(results)) {
    page += "## " + section.title + "\n\n";
    for (const std::string& paragraph : section.text) page += paragraph + "\n\n";
    for (const Figure& figure : section.figures) {
      baker::write_atomically(folder / (figure.name + ".svg"), to_svg(figure));
      page += fmt::format("![{2}]({1}/{2}.svg)\n\n{0}\n\n", figure.caption, folder.filename().string(), figure.name);
    }
    for (const ShownTable& table : section.tables) page += markdown(table);
  }
  while (page.ends_with("\n\n")) page.pop_back();
  baker::write_atomically(file, page);
}

}  // namespace spherechain::paper
