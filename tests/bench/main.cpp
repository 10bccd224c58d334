// SPDX-License-Identifier: GPL-3.0-or-later
// Spheres and their pairs (docs/performance.md): one command, one table. First all contestants must find the same
// pairs, then they are timed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <thread>

#include "character.h"
#include "check_pairs.h"
#include "crowd_run.h"
#include "mesh_refit.h"
#include "pair_finder.h"
#include "port_probe.h"
#include "runtime/src/refit/refit_job.h"
#include "runtime/src/simd/simd.h"
#include "table.h"
#include "timing.h"

using namespace spherechain;
using namespace spherechain::bench;

namespace {

constexpr std::size_t kMeshes = 64;  // poses whose meshes are kept: 700 KB each
constexpr std::size_t kCrowd = 10000;
constexpr std::size_t kProbeSteps = 1000, kProbeCalls = 100;
constexpr std::size_t kLongProbeSteps = 2000000;  // milliseconds, as a crowd takes
constexpr std::size_t kPosesInCache = 8;          // 7 KB of matrices
constexpr double kSphereTolerance = 1e-5;         // of the height
constexpr double kTestOperations = 8;             // floating-point operations of a pair test

const Target kBest = supported_targets()[0];

const std::string kList = "spherechain all pairs, list";
const std::string kBits = "spherechain all pairs, bits";
const std::string kProbe = "multiply-add of one vector";
const std::string kTwoProbes = "multiply-adds alone, 2 threads, each one";
const std::string kMeshRefit = "Embree refit of the mesh";
const std::string kVertexRefit = "spherechain refit from vertices";
std::string bones_of(const PosedCharacter& c) { return "spherechain refit from bones, " + c.name; }
std::string bones_in_cache(const PosedCharacter& c) { return bones_of(c) + ", cached"; }
std::string crowd_of(const PosedCharacter& c, int threads) {
  return fmt::format("spherechain crowd, {}, {} thread{}", c.name, threads, threads > 1 ? "s" : "");
}

void require(bool holds, const std::string& what) {
  if (!holds) {
    throw std::runtime_error(what);
  }
}

// Check for timed jobs: makes no text unless the job failed.
void check(Status status) {
  if (status != SC_OK) {
    throw std::runtime_error(std::string("a timed job: ") + sc_code_text(status.code));
  }
}

RefitJob job_of(const PosedCharacter& character, const Pose& pose, std::vector<Sphere>& out) {
  RefitJob job;
  job.asset = &character.asset;
  job.pose = pose;
  job.spheres = out.data();
  job.sphere_capacity = out.size();
  return job;
}

Pose vertices_of(const std::vector<float>& mesh) {
  Pose pose;
  pose.vertices = mesh.data();
  pose.vertex_count = mesh.size() / 3;
  return pose;
}

// The largest difference between the spheres from bones and those from the mesh.
double refit_error(const PosedCharacter& character, std::size_t pose, const std::vector<float>& mesh) {
  std::vector<Sphere> expected(character.sphere_count());
  require(job_of(character, vertices_of(mesh), expected).run() == SC_OK, "refit from vertices");
  double worst = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Sphere &l = expected[i], &r = character.spheres[pose][i];
    for (const float difference : {l.x - r.x, l.y - r.y, l.z - r.z, l.radius - r.radius}) {
      require(std::isfinite(difference), character.name + ": spheres that are not finite");
      worst = std::max(worst, std::abs(static_cast<double>(difference)));
    }
  }
  return worst / character.view().info().height;
}

class Bench {
 public:
  Bench(std::size_t pose_count, int repetitions) : timing_(repetitions) {
    load(human_, "73 spheres", "{}", pose_count);
    load(body_, "50 spheres", R"({"extremities": false})", pose_count);
    for (PosedCharacter* c : {&human_, &body_}) {
      c->name = fmt::format("{} spheres", c->sphere_count());
    }
    context(machine());
    context(fmt::format("target {}, {} repetitions, {} poses of assimp-testmodels' human.zae", sc_target_name(kBest),
                        repetitions, human_.poses.size()));
    add_refits();  // first: some peers crash on spheres that are not finite
    add_finders();
    add_crowds();
    timing_.add(
        kProbe, kProbeCalls, [](std::size_t) { run_multiply_adds(kBest, kProbeSteps); }, kProbeSteps * kProbeChains);
    timing_.add(
        kTwoProbes, 1,
        [](std::size_t) {
          std::thread other([] { run_multiply_adds(kBest, kLongProbeSteps); });
          run_multiply_adds(kBest, kLongProbeSteps);
          other.join();
        },
        2 * kLongProbeSteps * kProbeChains, true);
  }

  Table run() {
    timing_.run_all();
    fill_rows();
    fill_goals();
    return table_;
  }

 private:
  void context(const std::string& line) { table_.context.push_back(line); }

  void add_finders() {
    finders_ = runtime_finders(human_.asset);
    for (const auto& peers : {&fcl_finders, &bullet_finders, &embree_finders, &ode_finders, &cgal_finders}) {
      for (auto& finder : peers(human_.asset)) {
        finders_.push_back(std::move(finder));
      }
    }
    for (const auto& finder : finders_) {
      agreements_.push_back(check_pairs(human_, *finder));
      require(agreements_.back().difference.empty(), finder->name + ": " + agreements_.back().difference);
      timing_.add(finder->name, human_.spheres.size(),
                  [this, f = finder.get()](std::size_t i) { f->find(human_.spheres[i].data()); });
    }
    require(agreements_[0].pairs > 0, "no spheres touch in any pose: nothing to compare");
    context(
        fmt::format("pair sets over all poses: equal ({} pairs), once the asset's rule for rest pairs and a test of "
                    "the spheres is applied to what peers find",
                    agreements_[0].pairs));
  }

  void add_refits() {
    for (std::size_t i = 0; i < kMeshes; ++i) {
      const std::size_t pose = i * human_.poses.size() / kMeshes;
      meshes_.push_back(human_.mesh(pose));
      for (const PosedCharacter* c : {&human_, &body_}) {
        const double error = refit_error(*c, pose, meshes_.back());
        worst_refit_ = std::max(worst_refit_, error);
        require(error < kSphereTolerance, c->name + ": the spheres from bones are not those from the mesh");
      }
    }
    context(fmt::format("spheres from bones and from the mesh: within {:.1g} of the height", worst_refit_));
    mesh_refit_ = std::make_unique<MeshRefit>(human_, meshes_);
    for (std::size_t i = 0; i < kMeshes; ++i) {
      mesh_refit_->refit(i);
      require(mesh_refit_->bounds(i), kMeshRefit + ": the tree's box is not the mesh's");
    }
    timing_.add(kMeshRefit, kMeshes, [this](std::size_t i) { mesh_refit_->refit(i); });
    spheres_.resize(human_.sphere_count());
    timing_.add(kVertexRefit, kMeshes,
                [this](std::size_t i) { check(job_of(human_, vertices_of(meshes_[i]), spheres_).run()); });
    for (const PosedCharacter* c : {&human_, &body_}) {
      timing_.add(bones_of(*c), c->poses.size(), [c, job = job_of(*c, c->pose(0), spheres_)](std::size_t i) mutable {
        job.pose.bones = c->matrices[i].data();
        check(job.run());
      });
      timing_.add(bones_in_cache(*c), c->poses.size(),
                  [c, job = job_of(*c, c->pose(0), spheres_)](std::size_t i) mutable {
                    job.pose.bones = c->matrices[i % kPosesInCache].data();
                    check(job.run());
                  });
    }
  }

  void add_crowds() {
    for (const PosedCharacter* c : {&human_, &body_}) {
      for (const int threads : {1, 2}) {
        crowds_.push_back(std::make_unique<CrowdRun>(*c, kCrowd, static_cast<std::size_t>(threads)));
        CrowdRun* crowd = crowds_.back().get();
        crowd->run();
        require(crowd->has_the_pairs_of(*c), "the crowd's pairs are not those of its characters");
        timing_.add(
            crowd_of(*c, threads), 1, [crowd](std::size_t) { crowd->run(); }, kCrowd, threads > 1);
      }
    }
  }

  double median(const std::string& name) { return timing_.of(name).median; }

  void row(const char* section, const std::string& name, const std::string& note = "") {
    table_.rows.push_back({section, name, timing_.of(name), note});
  }

  void fill_rows() {
    const char* const kinds[] = {"the pairs", "touching spheres", "touching boxes"};
    for (std::size_t i = 0; i < finders_.size(); ++i) {
      const PairFinder& finder = *finders_[i];
      row("P1", finder.name,
          fmt::format("{:6.1f}x  {}: {} found{}", median(finder.name) / median(kList),
                      kinds[static_cast<int>(finder.found)], agreements_[i].candidates,
                      agreements_[i].ties > 0 ? fmt::format(", {} ties", agreements_[i].ties) : ""));
    }
    const std::size_t n = human_.sphere_count();
    const std::size_t pairs = n * (n - 1) / 2;
    limit_ = static_cast<double>(pairs) / static_cast<double>(lanes_of(kBest)) * kTestOperations * median(kProbe);
    table_.rows.push_back({"P2",
                           "port limit of all pairs' tests",
                           {limit_, limit_},
                           fmt::format("{} pairs in vectors of {}, {} operations each at {:.3f} ns", pairs,
                                       lanes_of(kBest), kTestOperations, median(kProbe))});
    row("P3", kMeshRefit, fmt::format("{} triangles", human_.bake.character.source_triangles.size()));
    row("P3", kVertexRefit);
    for (const PosedCharacter* c : {&human_, &body_}) {
      row("P3", bones_of(*c),
          fmt::format("{} bones, {} pairs of them, {} products of one with a moment", c->view().bone_count(),
                      c->view().moment_tables().pairs.size, c->view().moment_tables().moments.size));
      row("P3", bones_in_cache(*c), fmt::format("{} poses in turn", kPosesInCache));
    }
    for (const PosedCharacter* c : {&human_, &body_}) {
      for (const int threads : {1, 2}) {
        row("P4", crowd_of(*c, threads), fmt::format("{} characters, bones in, pairs out", kCrowd));
      }
    }
    row("P4", kTwoProbes, fmt::format("{:.2f} of two alone", median(kProbe) / median(kTwoProbes) / 2));
  }

  void goal(const std::string& name, const char* unit, double reached, double wanted, bool at_least) {
    table_.goals.push_back({name, unit, reached, wanted, at_least});
  }

  void fill_goals() {
    constexpr struct {
      const char* peer;
      double times;
    } kPeers[] = {{"FCL tree", 20},
                  {"FCL tree + sphere test", 30},
                  {"Bullet broad phase", 40},
                  {"Embree commit + collide", 60},
                  {"CGAL box_self_intersection_d", 60}};
    for (const auto& [peer, times] : kPeers) {
      goal(fmt::format("P1 faster than {}", peer), "x", median(peer) / median(kList), times, true);
    }
    goal("P2 all pairs as bits over the port limit", "x", median(kBits) / limit_, 1.5, false);
    goal("P3 refit from bones, " + body_.name, "us", median(bones_in_cache(body_)) / 1e3, 0.5, false);
    goal("P3 faster than Embree's refit", "x", median(kMeshRefit) / median(bones_of(body_)), 1000, true);
    goal("P4 crowd, " + body_.name, "us", median(crowd_of(body_, 1)) / 1e3, 0.8, false);
    goal("P4 parallel efficiency, 2 threads", "", median(crowd_of(body_, 1)) / median(crowd_of(body_, 2)) / 2, 0.85,
         true);
  }

  Timing timing_;
  Table table_;
  PosedCharacter human_, body_;
  PairFinders finders_;
  std::vector<Agreement> agreements_;
  std::vector<std::vector<float>> meshes_;
  std::unique_ptr<MeshRefit> mesh_refit_;
  std::vector<Sphere> spheres_;
  std::vector<std::unique_ptr<CrowdRun>> crowds_;
  double worst_refit_ = 0, limit_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times the runtime against its peers: goals P1 to P4"};
  std::size_t pose_count = 1024;
  int repetitions = 15;
  std::string json;
  app.add_option("--poses", pose_count, "Real poses, over eleven motions")
      ->capture_default_str()
      ->check(CLI::Range(kMeshes, std::size_t{100000}));
  app.add_option("--repetitions", repetitions, "Passes over the poses; medians and minima are over these")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--json", json, "File to write the table to as well");
  CLI11_PARSE(app, argc, argv);
  try {
    const Table table = std::make_unique<Bench>(pose_count, repetitions)->run();
    table.print();
    if (!json.empty()) {
      table.write_json(json);
    }
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "spherechain_bench: {}\n", error.what());
    return 1;
  }
}
