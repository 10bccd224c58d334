// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's experiments: Figures 13, 15 and 16, its claims, and what each setting brings.

#include <CLI/CLI.hpp>
#include <chrono>
#include <fstream>
#include <iostream>
#include <thread>

#include "baker/mesh/error.h"
#include "baker/os/written_file.h"
#include "report.h"
#include "tree_time.h"

using namespace spherechain;
using namespace spherechain::paper;

namespace {

struct Options {
  std::string out = "out/paper", docs, character = "/usr/share/assimp/models/Collada/human.zae",
              poses = SPHERECHAIN_POSES, gpu = SPHERECHAIN_GPU_TIME;
  bool quick = false;
};

std::string machine() {
  std::ifstream info("/proc/cpuinfo");
  std::string line, processor = "unknown processor";
  while (std::getline(info, line)) {
    if (line.rfind("model name", 0) == 0) {
      processor = line.substr(line.find(':') + 2);
      break;
    }
  }
  return processor + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores, compiler " + __VERSION__;
}

// A quick run has fewer points, but the same experiments.
std::vector<Setting> settings(bool quick) {
  std::vector<Setting> out;
  const auto add = [&](const char* series, const char* profile, const std::string& key, std::vector<double> values,
                       const std::string& more = "") {
    for (const double value : values) {
      std::ostringstream json;
      json << "{\"" << key << "\":" << value << more << "}";
      out.push_back({series, value, profile, json.str()});
    }
  };
  using Values = std::vector<double>;
  add(kDepthPaper, "paper", "penetration_depth",
      quick ? Values{0, 0.3, 0.5} : Values{0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6});
  add(kDepthExtremities, "balanced", "penetration_depth",
      quick ? Values{0.1, 0.3, 0.5} : Values{0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5});
  add(kPerLevel, "balanced", "spheres_per_level", {1, 2, 3});
  add(kDelta, "balanced", "delta", quick ? Values{0.005, 0.015, 0.03} : Values{0.0025, 0.005, 0.01, 0.015, 0.03, 0.06});
  // One pivot makes no sphere: it has no distance from the centre, and its weight cannot place the centre.
  add(kPivotsPaper, "balanced", "pivots", quick ? Values{4, 16} : Values{2, 4, 6, 8, 12, 16}, ",\"refit\":\"paper\"");
  add(kPivotsMoments, "balanced", "pivots", quick ? Values{4, 8, 16} : Values{4, 6, 8, 12, 16});
  return out;
}

// More chains to build trees over, up to the greatest depth.
std::vector<Setting> baked_chains(bool quick) {
  std::vector<Setting> out;
  const auto add = [&](const char* profile, double depth) {
    std::ostringstream json;
    json << "{\"penetration_depth\":" << depth << "}";
    out.push_back({kBaked, depth, profile, json.str()});
  };
  add("paper", 0.6);
  if (quick) return out;
  for (const double depth : {0.8, 0.9}) add("paper", depth);
  add("balanced", 0.9);
  return out;
}

void run(const Options& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto progress = [&](const std::string& what) {
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
    std::fprintf(stderr, "%6.1f s  %s\n", passed.count(), what.c_str());
  };
  progress("bake and both animations");
  const Study study(options.character, options.poses, 40);
  progress("points inside and on the skin");
  const baker::SampledBody samples(study.paper().regions.body.mesh, options.quick ? 2000 : 10000);

  Results results;
  results.machine = machine();
  results.gpu = read_gpu_time(options.gpu);
  progress("Figure 13");
  results.accuracy = measure_accuracy(study, study.paper());
  progress("Figure 15");
  results.running_time = measure_running_time(study, study.paper(), options.quick ? 21 : 501);
  results.sweep = measure_sweep(study, samples, settings(options.quick), kDepthPaper, options.quick ? 3 : 51, progress);

  progress("sphere sets");
  const Table dense = results.sweep.sweep.where("series", kDepthPaper);
  const std::size_t row = nearest_count(dense, kStatedSpheres);
  const Bake denser = study.bake("paper", dense.word(row, "settings"));
  results.quality =
      measure_quality(study, samples, {{"paper", study.paper()}, {"balanced", study.balanced()}, {"denser", denser}});

  progress("trees over chains");
  const std::vector<std::uint32_t> parts =
      options.quick ? std::vector<std::uint32_t>{2, 20} : std::vector<std::uint32_t>{2, 4, 10, 20, 40, 100, 200};
  results.trees = measure_trees(study, baked_chains(options.quick), parts, options.quick ? 3 : 51);

  write_page(options.out, results);
  const auto write_asset = [&](const char* name, const Bake& bake) {
    baker::write_atomically(std::filesystem::path(options.out) / name,
                            {reinterpret_cast<const char*>(bake.asset.data()), bake.asset.size()});
  };
  write_asset("paper.sphc", study.paper());
  write_asset("balanced.sphc", study.balanced());
  if (!options.docs.empty()) write_docs(options.docs, results);
  progress("wrote " + options.out + "/index.html");
  const Table claims = evaluate_claims(results);
  for (std::size_t i = 0; i < claims.rows.size(); ++i) {
    std::printf("%-16s %s\n", claims.word(i, "verdict").c_str(), claims.word(i, "paper_says").c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"The paper's experiments on a character: CSV files and a page"};
  Options options;
  app.add_option("-o,--out", options.out, "folder to write")->capture_default_str();
  app.add_option("--docs", options.docs, "Markdown file to write too");
  app.add_option("--character", options.character, "mesh file")->capture_default_str();
  app.add_option("--poses", options.poses, "folder of the two animations")->capture_default_str();
  app.add_option("--gpu", options.gpu, "what spherechain_figure16 wrote, if it was run")->capture_default_str();
  app.add_flag("--quick", options.quick, "fewer points and repetitions");
  CLI11_PARSE(app, argc, argv);
  try {
    run(options);
  } catch (const baker::Error& error) {
    std::cerr << "paper_experiments: error: " << error.what() << '\n';
    return static_cast<int>(error.code());
  }
  return 0;
}
