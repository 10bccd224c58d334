// SPDX-License-Identifier: GPL-3.0-or-later
#include "tree_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "baker/mesh/error.h"
#include "baker/play/asset_file.h"
#include "chain_trees.h"
#include "runtime/src/pairs/detect_job.h"
#include "runtime/src/refit/refit_job.h"
#include "split_spheres.h"
#include "statistics.h"

namespace spherechain::paper {
namespace {

constexpr std::size_t kFrameStep = 4;  // of 40 frames an animation
constexpr int kFewestRepetitions = 3;

struct TreeCost {
  std::size_t tests = 0, overlaps = 0;
  double refit_us = 0, us = 0;
};

// A number of spheres: the asset, its runs and frames, and a game's buffers.
class TreeCase {
 public:
  TreeCase(std::string series, std::string source, const Asset& asset, const Runs& runs,
           std::vector<std::vector<Sphere>> frames)
      : series_(std::move(series)),
        source_(std::move(source)),
        asset_(asset),
        frames_(std::move(frames)),
        plain_(view_of(asset), SC_RADIUS_FIT) {
    for (const std::size_t branching : {2, 4, 8}) trees_.emplace_back(view_of(asset), SC_RADIUS_FIT, runs, branching);
    table_.resize(detect_table_words(&asset));
    baker::check_runtime(prepare_detect(&asset, SC_RADIUS_FIT, nullptr, table_.data(), table_.size()));
  }

  const std::string& series() const { return series_; }
  const std::string& source() const { return source_; }
  std::size_t sphere_count() const { return view_of(asset_).spheres().size; }
  std::size_t frame_count() const { return frames_.size(); }

  // Trees and product against M2; makes room for the product's pairs.
  void compare(std::size_t frame) {
    const Sphere* const spheres = frames_[frame].data();
    const std::vector<Pair> expected = plain_.all_pairs(spheres).pairs;
    if (expected.size() > pairs_.size()) pairs_.resize(expected.size());
    const auto check = [&](const char* method, bool same) {
      if (same) return;
      throw baker::Error(baker::ExitCode::kInternal,
                         fmt::format("{}: other pairs than M2, {} spheres, frame {}", method, sphere_count(), frame));
    };
    for (std::size_t t = 0; t < kTrees.size(); ++t) {
      trees_[t].refit(spheres);
      check(kTrees[t], trees_[t].all_pairs().pairs == expected);
    }
    const std::size_t found = detect(spheres);
    check(kJob, found == expected.size() && std::equal(expected.begin(), expected.end(), pairs_.begin()));
  }

  TreeCost run(const std::string& method, std::size_t frame) {
    const Sphere* const spheres = frames_[frame].data();
    TreeCost cost;
    const auto start = Clock::now();
    if (method == kLoopM1) {
      const PlainResult found = plain_.chains(spheres);
      cost = {found.test_count, found.chain_pairs.size(), 0, 0};
    } else if (method == kLoopM2) {
      const PlainResult found = plain_.all_pairs(spheres);
      cost = {found.test_count, found.pairs.size(), 0, 0};
    } else if (method == kJob) {
      cost = {pairs_of(sphere_count()) - view_of(asset_).ignored_count(), detect(spheres), 0, 0};
    } else {
      ChainTrees& trees =
          trees_[static_cast<std::size_t>(std::find(kTrees.begin(), kTrees.end(), method) - kTrees.begin())];
      trees.refit(spheres);
      cost.refit_us = us_since(start);
      const PlainResult found = trees.all_pairs();
      cost.tests = found.test_count;
      cost.overlaps = found.pairs.size();
    }
    cost.us = us_since(start);
    return cost;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double us_since(Clock::time_point start) {
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
  }

  std::size_t detect(const Sphere* spheres) {
    DetectJob job;
    job.asset = &asset_;
    job.spheres = spheres;
    job.sphere_count = sphere_count();
    job.radius = SC_RADIUS_FIT;
    job.table = table_.data();
    job.pairs = pairs_.data();
    job.pair_capacity = pairs_.size();
    const Status status = job.run();
    if (status != SC_OVERFLOW) baker::check_runtime(status);
    return job.pair_count;
  }

  std::string series_, source_;
  const Asset& asset_;
  std::vector<std::vector<Sphere>> frames_;
  PlainDetection plain_;
  std::vector<ChainTrees> trees_;
  std::vector<std::uint64_t> table_;
  std::vector<Pair> pairs_;
};

std::vector<std::vector<Sphere>> refitted_frames(const baker::OpenAsset& asset, const Study& study) {
  std::vector<std::vector<Sphere>> out;
  for (const Animation& animation : study.animations()) {
    for (std::size_t f = 0; f < animation.frames.size(); f += kFrameStep) {
      const std::vector<float> positions = baker::pack(animation.frames[f]);
      out.emplace_back(asset->spheres().size);
      RefitJob job;
      job.asset = asset.handle();
      job.pose.vertices = positions.data();
      job.pose.vertex_count = positions.size() / 3;
      job.radius = SC_RADIUS_FIT;
      job.spheres = out.back().data();
      job.sphere_capacity = out.back().size();
      baker::check_runtime(job.run());
    }
  }
  return out;
}

// A sphere's parts lie in no order. A tree over neighbours needs one: halved along the longest axis, over and over.
void sort_by_halves(const std::vector<Sphere>& parts, std::uint32_t* begin, std::uint32_t* end) {
  if (end - begin < 2) return;
  constexpr float Sphere::*kAxes[] = {&Sphere::x, &Sphere::y, &Sphere::z};
  float Sphere::*longest = nullptr;
  float length = -1;
  for (float Sphere::*const axis : kAxes) {
    const auto [low, high] = std::minmax_element(
        begin, end, [&](std::uint32_t a, std::uint32_t b) { return parts[a].*axis < parts[b].*axis; });
    if (parts[*high].*axis - parts[*low].*axis > length) {
      length = parts[*high].*axis - parts[*low].*axis;
      longest = axis;
    }
  }
  std::uint32_t* const middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end,
                   [&](std::uint32_t a, std::uint32_t b) { return parts[a].*longest < parts[b].*longest; });
  sort_by_halves(parts, begin, middle);
  sort_by_halves(parts, middle, end);
}

Runs split_runs(const Runs& whole, const bench::SplitAsset& split) {
  const std::vector<Sphere> parts = split.split({{0, 0, 0, 1}});
  std::vector<std::uint32_t> order(parts.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  sort_by_halves(parts, order.data(), order.data() + order.size());
  Runs out;
  for (const auto& run : whole) {
    out.emplace_back();
    for (const std::uint32_t sphere : run) {
      for (const std::uint32_t part : order) {
        out.back().push_back(static_cast<std::uint32_t>(parts.size()) * sphere + part);
      }
    }
  }
  return out;
}

// Every frame and method takes its turn in every repetition.
void measure_case(TreeCase& one, int repetitions, Table& out) {
  constexpr std::array<const char*, 6> kTimed{kLoopM1, kLoopM2, kBinaryTree, kQuadtree, kOctree, kJob};
  struct Samples {
    std::vector<double> refit_us, us;
  };
  const std::size_t frames = one.frame_count();
  std::vector<std::array<Samples, kTimed.size()>> times(frames);
  std::array<std::vector<double>, kTimed.size()> tests, overlaps, refit_us, us;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (std::size_t f = 0; f < frames; ++f) {
      for (std::size_t m = 0; m < kTimed.size(); ++m) {
        const TreeCost cost = one.run(kTimed[m], f);
        times[f][m].refit_us.push_back(cost.refit_us);
        times[f][m].us.push_back(cost.us);
        if (repetition > 0) continue;
        tests[m].push_back(static_cast<double>(cost.tests));
        overlaps[m].push_back(static_cast<double>(cost.overlaps));
      }
    }
  }
  for (std::size_t m = 0; m < kTimed.size(); ++m) {
    for (const auto& frame : times) {
      refit_us[m].push_back(median(frame[m].refit_us));
      us[m].push_back(median(frame[m].us));
    }
    const bool is_tree = std::find(kTrees.begin(), kTrees.end(), std::string(kTimed[m])) != kTrees.end();
    out.add({one.series(), one.source(), one.sphere_count(), kTimed[m], frames, median(tests[m]), mean(overlaps[m]),
             is_tree ? Cell(median(refit_us[m])) : Cell(), median(us[m])});
  }
}

}  // namespace

Table measure_trees(const Study& study, const std::vector<Setting>& baked, const std::vector<std::uint32_t>& parts,
                    int repetitions) {
  const auto open = [](const Bake& bake) {
    return baker::OpenAsset({reinterpret_cast<const char*>(bake.asset.data()), bake.asset.size()}, "a bake");
  };
  const baker::OpenAsset whole = open(study.paper());
  const Runs whole_runs = region_runs(whole.view());
  const std::vector<std::vector<Sphere>> whole_frames = refitted_frames(whole, study);
  Table out{"trees", {"series", "source", "spheres", "method", "frames", "tests", "overlaps", "refit_us", "us"}, {}};
  const auto measure = [&](TreeCase one) {
    for (std::size_t f = 0; f < one.frame_count(); ++f) one.compare(f);
    const double share = static_cast<double>(whole->spheres().size) / static_cast<double>(one.sphere_count());
    measure_case(one, std::max(kFewestRepetitions, static_cast<int>(repetitions * share)), out);
  };
  const auto measure_bake = [&](const Bake& bake, const std::string& source) {
    const baker::OpenAsset asset = open(bake);
    measure({kBaked, source, asset, region_runs(asset.view()), refitted_frames(asset, study)});
  };
  measure_bake(study.paper(), kPaperAsIs);
  measure_bake(study.balanced(), kBalancedAsIs);
  for (const Setting& setting : baked) {
    measure_bake(study.bake(setting.profile, setting.json), fmt::format("{}, PD {:g}", setting.profile, setting.value));
  }
  for (const std::uint32_t count : parts) {
    const bench::SplitAsset split(whole, count);
    std::vector<std::vector<Sphere>> frames;
    for (const std::vector<Sphere>& frame : whole_frames) frames.push_back(split.split(frame));
    measure({kSplit, fmt::format("paper in {} parts", count), split.asset(), split_runs(whole_runs, split),
             std::move(frames)});
  }
  return out;
}

}  // namespace spherechain::paper
