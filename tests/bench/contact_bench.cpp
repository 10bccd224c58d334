// SPDX-License-Identifier: GPL-3.0-or-later
// Exact skin contacts and their depth (docs/performance.md). Checks that all contestants find the same, then times
// them.
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <random>
#include <stdexcept>

#include "contact_finder.h"
#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_inputs.h"
#include "table.h"

using namespace spherechain;
using namespace spherechain::bench;

namespace {

using Pairs = std::vector<Pair>;

const Target kBest = supported_targets()[0];
constexpr float kTolerance = 1e-5F;  // of the height

// Nanoseconds this thread has run. Waiting for a core of a shared machine does not count.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

Pairs sorted(Pairs pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// The goals are for the product's question. Lists of triangles are the runtime's too.
enum class Kind { kProduct, kTriangleList, kDepth, kPeer };

struct Contestant {
  std::unique_ptr<ContactFinder> finder;
  int passes;
  Kind kind;
  bool is_exact;
  std::vector<std::vector<double>> times;  // by pose, of each pass
  std::size_t missing = 0, extra = 0;      // against CGAL, over all poses

  // Over the poses for which `wanted` is 1: each one's median, and its minimum.
  template <typename Reduce>
  Times reduce(const std::vector<bool>& wanted, const Reduce& of_all) const {
    std::vector<double> medians, minima;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (wanted[i]) {
        std::vector<double> pass = times[i];
        std::sort(pass.begin(), pass.end());
        medians.push_back(pass[pass.size() / 2]);
        minima.push_back(pass[0]);
      }
    }
    return {of_all(medians), of_all(minima)};
  }
};

class ContactBench {
 public:
  ContactBench(std::size_t pose_count, int passes, bool with_peers, bool with_fcl, const std::string& settings) {
    load(human_, "human", settings, pose_count);
    mesh_ = std::make_unique<ContactMesh>(human_);
    for (std::size_t i = 0; i < human_.poses.size(); ++i) {
      poses_.push_back({skinned(i), human_.pose(i)});
    }
    const auto add = [&](ContactFinders finders, int count, Kind kind, bool is_exact = true) {
      for (auto& finder : finders) contestants_.push_back({std::move(finder), count, kind, is_exact, {}});
    };
    add(runtime_part_finders(*mesh_), passes, Kind::kProduct);
    add(runtime_triangle_finders(*mesh_), passes, Kind::kTriangleList);
    add(runtime_depth_finders(*mesh_), std::min(passes, 7), Kind::kDepth);
    add(cgal_contact_finders(*mesh_), with_peers ? 3 : 0, Kind::kPeer);
    if (with_peers) {
      add(embree_contact_finders(*mesh_), 3, Kind::kPeer);
    }
    if (with_fcl) {
      add(fcl_contact_finders(*mesh_), 1, Kind::kPeer, false);
    }
    compare();
    time_all();
  }

  Table table() {
    Table out;
    const std::vector<bool> all(poses_.size(), true);
    std::vector<bool> free;
    std::size_t pairs = 0, free_count = 0;
    for (const Pairs& expected : expected_) {
      free.push_back(expected.empty());
      free_count += expected.empty() ? 1 : 0;
      pairs += expected.size();
    }
    out.context = {machine(),
                   fmt::format("target {}, {} poses of assimp-testmodels' human.zae, {} of them without a contact; "
                               "{} triangles in {} clusters of {} spheres",
                               sc_target_name(kBest), poses_.size(), free_count, mesh_->source_triangles.size(),
                               mesh_->surface.clusters.size, human_.sphere_count()),
                   fmt::format("contacts over all poses: {} pairs of triangles (CGAL)", pairs)};
    const auto worst = [](const std::vector<double>& v) { return *std::max_element(v.begin(), v.end()); };
    struct Figures {
      const Contestant& of;
      Times mean, worst, free;
    };
    std::vector<Figures> figures;
    for (const Contestant& c : contestants_) {
      if (c.passes == 0) continue;
      figures.push_back(
          {c, c.reduce(all, mean), c.reduce(all, worst), free_count > 0 ? c.reduce(free, mean) : Times{}});
      const Figures& f = figures.back();
      out.rows.push_back(
          {"P6", c.finder->name + ", mean", f.mean, fmt::format("{} missing, {} extra", c.missing, c.extra)});
      out.rows.push_back({"P6", c.finder->name + ", worst pose", f.worst, ""});
      if (free_count > 0) {
        out.rows.push_back({"P6", c.finder->name + ", no contact", f.free, ""});
      }
    }
    const auto from_bones = std::find_if(figures.begin(), figures.end(), [](const Figures& f) {
      return f.of.kind == Kind::kProduct && f.of.finder->name.find("bones") != std::string::npos;
    });
    for (const Figures& own : figures) {
      if (own.of.kind == Kind::kDepth && own.of.finder->name.find("quick") != std::string::npos) {
        out.goals.push_back({"P10 " + own.of.finder->name + ": mean over the contacts' own", "x",
                             own.mean.median / from_bones->mean.median, 5, false});
      }
      if (own.of.finder->name.find("inside") != std::string::npos) {
        out.goals.push_back({"P10 " + own.of.finder->name + ": mean", "us", own.mean.median / 1e3, 20, false});
      }
      if (own.of.kind != Kind::kProduct) continue;
      const auto goal = [&](const std::string& what, const char* unit, double reached, double wanted, bool at_least) {
        out.goals.push_back({"P6 " + own.of.finder->name + ": " + what, unit, reached, wanted, at_least});
      };
      if (free_count > 0) {
        goal("no contact", "us", own.free.median / 1e3, 10, false);
      }
      for (const Figures& other : figures) {
        const std::string& peer = other.of.finder->name;
        if (peer.rfind("CGAL", 0) == 0) {
          goal("mean over CGAL's", "x", other.mean.median / own.mean.median, 1000, true);
          goal("worst over CGAL's", "x", other.worst.median / own.worst.median, 200, true);
        } else if (peer.rfind("Embree", 0) == 0) {
          goal("mean over Embree's", "x", other.mean.median / own.mean.median, 100, true);
        }
      }
    }
    return out;
  }

 private:
  // Skinned by the runtime, so that contacts from bones and from vertices are of the very same positions.
  std::vector<float> skinned(std::size_t pose) const {
    const std::vector<float> expected = human_.mesh(pose);
    std::vector<float> out = expected;  // the runtime writes the surface's vertices alone
    skin_surface(mesh_->surface, human_.pose(pose), kBest, out.data(), 3);
    // All contestants get these positions: a mistake here would be everyone's.
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (!(std::abs(out[i] - expected[i]) < kTolerance * human_.view().info().height)) {
        throw std::runtime_error("the skinned vertices are not the mesh's");
      }
    }
    return out;
  }

  void compare() {
    for (Contestant& c : contestants_) {
      if (c.finder->name.rfind("CGAL", 0) == 0) {
        for (const ContactPose& pose : poses_) {
          c.finder->find(pose);
          expected_.push_back(sorted(c.finder->pairs()));
        }
      }
    }
    for (Contestant& c : contestants_) {
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        c.finder->find(poses_[i]);
        const Pairs found = sorted(c.finder->pairs());
        Pairs both;
        std::set_intersection(found.begin(), found.end(), expected_[i].begin(), expected_[i].end(),
                              std::back_inserter(both));
        c.missing += expected_[i].size() - both.size();
        c.extra += found.size() - both.size();
      }
      if (c.is_exact && c.missing + c.extra > 0) {
        throw std::runtime_error(fmt::format("{}: {} pairs missing, {} extra", c.finder->name, c.missing, c.extra));
      }
    }
  }

  // One pass over the poses at a time, in an order drawn at random over all passes of all contestants.
  void time_all() {
    std::vector<Contestant*> order;
    for (Contestant& c : contestants_) {
      c.times.resize(poses_.size());
      order.insert(order.end(), static_cast<std::size_t>(c.passes), &c);
    }
    ContactPose pose = poses_[0];
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    for (Contestant* c : order) {
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        pose = poses_[i];  // into the caches, where a game's skinning has just left it
        const double start = now();
        c->finder->find(pose);
        c->times[i].push_back(now() - start);
      }
    }
  }

  PosedCharacter human_;
  std::unique_ptr<ContactMesh> mesh_;
  std::vector<ContactPose> poses_;
  std::vector<Pairs> expected_;
  std::vector<Contestant> contestants_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times exact skin contacts against peers: goal P6"};
  std::size_t pose_count = 121;
  int passes = 31;
  bool alone = false, with_fcl = false;
  std::string json, settings = "{}";
  app.add_option("--poses", pose_count, "Real poses, over eleven motions")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--passes", passes, "Of the runtime over the poses; peers make 3, FCL 1")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_flag("--alone", alone, "Without timing peers");
  app.add_flag("--fcl", with_fcl, "With FCL, which takes seconds for some poses: choose few");
  app.add_option("--settings", settings, "JSON: the bake's")->capture_default_str();
  app.add_option("--json", json, "File to write the table to as well");
  CLI11_PARSE(app, argc, argv);
  try {
    const Table table = std::make_unique<ContactBench>(pose_count, passes, !alone, with_fcl, settings)->table();
    table.print();
    if (!json.empty()) {
      table.write_json(json);
    }
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "spherechain_bench_contacts: {}\n", error.what());
    return 1;
  }
}
