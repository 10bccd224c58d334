// SPDX-License-Identifier: GPL-3.0-or-later
// Exact contacts of two bodies that wrestle, and of a crowd (docs/performance.md). Checks that all find the
// same, then times them in turn.
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <exception>
#include <functional>
#include <random>
#include <stdexcept>

#include "runtime/src/penetrations/penetration_jobs.h"
#include "runtime/src/refit/refit_job.h"
#include "runtime/src/simd/simd.h"
#include "table.h"
#include "wrestlers.h"

using namespace spherechain;
using namespace spherechain::bench;

namespace {

const Target kBest = supported_targets()[0];

// Nanoseconds this thread has run. Waiting for a core of a shared machine does not count.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

// A thousand characters in the poses of the wrestlers, as dense as people stand: two a square metre.
class Crowd {
 public:
  static constexpr std::size_t kCount = 1000;

  explicit Crowd(const Wrestlers& bodies) : bodies_(bodies) {
    const PosedCharacter& human = bodies.human();
    const AssetInfo info = human.view().info();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> turn(0, 6.28), off(-0.1, 0.1);
    const double metre = 1 / double{info.metres_per_unit};
    const baker::Vec3 up(double{info.up.x}, double{info.up.y}, double{info.up.z});
    const baker::Vec3 left(double{info.left.x}, double{info.left.y}, double{info.left.z});
    const baker::Vec3 forward = left.cross(up);
    for (std::size_t i = 0; i < kCount; ++i) {
      const Frame& frame = bodies.frames()[random() % bodies.frames().size()];
      const double x = (static_cast<double>(i % 32) + off(random)) * 0.7071 * metre;
      const double z = (static_cast<double>(i / 32) + off(random)) * 0.7071 * metre;
      const Eigen::AngleAxisd turned(turn(random), up);
      std::vector<float> out = frame.bones[0];
      const baker::Vec3 middle(double{out[3]}, double{out[7]}, double{out[11]});  // about where it stands
      const baker::Vec3 level = middle - middle.dot(up) * up;
      for (std::size_t b = 0; b < out.size(); b += 12) {
        const baker::Affine placed = Eigen::Translation3d(x * left + z * forward) * baker::Affine(turned) *
                                     Eigen::Translation3d(-level) * affine_at(out.data() + b);
        put(placed, out.data() + b);
      }
      bones_.push_back(std::move(out));
    }
    spheres_.resize(kCount * human.sphere_count());
    scene_.resize(kCount);
    pairs_.resize(64 * kCount);
    scratch_ = memory_for(std::max(sc_scene_scratch_words(kCount), body_scratch_words(&human.asset, &human.asset)));
    parts_.resize(human.view().part_count() * human.view().part_count());
  }

  // Refits all and finds the pairs with spheres that touch.
  std::size_t find_by_spheres() {
    const PosedCharacter& human = bodies_.human();
    for (std::size_t i = 0; i < kCount; ++i) {
      Sphere* const out = spheres_.data() + i * human.sphere_count();
      RefitJob job;
      job.asset = &human.asset;
      job.pose = pose(i);
      job.spheres = out;
      job.sphere_capacity = human.sphere_count();
      require(job.run(), "refit");
      scene_[i].spheres = out;
      scene_[i].sphere_count = human.sphere_count();
    }
    return meet();
  }
  // Bounds all, and finds the contacts of the skins of all whose boxes touch; gives how many pairs of bodies have some.
  std::size_t find_contacts() {
    for (std::size_t i = 0; i < kCount; ++i) {
      scene_[i].spheres = nullptr;
      scene_[i].sphere_count = 0;
      const JobBody one = body(i);
      require(bound_body(one, scene_[i].low, scene_[i].high), "bounds");
    }
    boxes_touch = meet();
    std::size_t with_contacts = 0;
    for (std::size_t i = 0; i < boxes_touch; ++i) {
      BodyContactJob job;
      job.a = body(pairs_[i].a);
      job.b = body(pairs_[i].b);
      job.scratch = scratch_.data()->words;
      job.scratch_words = 8 * scratch_.size();
      job.parts = parts_.data();
      job.part_capacity = parts_.size();
      require(job.run(), "contacts in the crowd");
      with_contacts += job.part_count > 0 ? 1 : 0;
    }
    return with_contacts;
  }
  std::size_t boxes_touch = 0;

 private:
  Pose pose(std::size_t i) const {
    Pose out = bodies_.human().pose(0);
    out.bones = bones_[i].data();
    return out;
  }
  JobBody body(std::size_t i) const {
    JobBody out;
    out.asset = &bodies_.human().asset;
    out.skin_table = bodies_.table();
    out.pose = pose(i);
    return out;
  }
  std::size_t meet() {
    SceneJob job;
    job.bodies = scene_.data();
    job.body_count = kCount;
    job.scratch = scratch_.data()->words;
    job.scratch_words = 8 * scratch_.size();
    job.pairs = pairs_.data();
    job.pair_capacity = pairs_.size();
    require(job.run(), "scene");
    return job.pair_count;
  }

  const Wrestlers& bodies_;
  std::vector<std::vector<float>> bones_;
  std::vector<Sphere> spheres_;
  std::vector<SceneBody> scene_;
  std::vector<Pair> pairs_;
  std::vector<PartContact> parts_;
  Memory scratch_;
};

struct Contestant {
  std::string name;
  int passes;
  std::function<void(const Frame&)> run;
  std::vector<std::vector<double>> times = {};  // by frame, of each pass

  // The mean of the frames' medians, and of their minima.
  Times mean() const {
    double medians = 0, minima = 0;
    for (std::vector<double> pass : times) {
      std::sort(pass.begin(), pass.end());
      medians += pass[pass.size() / 2];
      minima += pass[0];
    }
    const auto count = static_cast<double>(times.size());
    return {medians / count, minima / count};
  }
};

class Bench {
 public:
  Bench(int frames, int passes) : bodies_(frames), crowd_(bodies_) {
    const PosedCharacter& human = bodies_.human();
    const std::size_t parts = human.view().part_count();
    parts_.resize(parts * parts);
    triangles_.resize(1 << 20);
    scratch_ = memory_for(std::max(body_scratch_words(&human.asset, &human.asset), skin_scratch_words(&human.asset)));
    compare();
    for (const int body : {0, 1}) {
      contestants_.push_back({body == 0 ? "body a with itself" : "body b with itself", passes,
                              [this, body](const Frame& frame) { find_own(frame, body); }});
    }
    contestants_.push_back({"a with b, from bones", passes, [this](const Frame& f) { find(f, true, true, false); }});
    contestants_.push_back(
        {"a with b, from vertices", passes, [this](const Frame& f) { find(f, false, true, false); }});
    contestants_.push_back({"CGAL box_intersection_d + do_intersect", 3, [this](const Frame& f) {
                              baker::find_intersections(bodies_.truth(), f.positions[0], bodies_.truth(),
                                                        f.positions[1]);
                            }});
    time_all();
    for (int pass = 0; pass < passes; ++pass) {
      const double start = now();
      by_spheres_ = crowd_.find_by_spheres();
      const double middle = now();
      with_contacts_ = crowd_.find_contacts();
      crowd_times_[0].push_back(middle - start);
      crowd_times_[1].push_back(now() - middle);
    }
  }

  // Contacts from bones, from vertices and mixed of so many placements, against CGAL's.
  void check_placements(int count) {
    std::mt19937 random(7);
    std::size_t pairs = 0, free = 0;
    for (int i = 0; i < count; ++i) {
      const Frame frame = bodies_.random_placement(random);
      BodyContactJob mixed = job_of(frame, true);
      mixed.b.pose = pose_of(frame, 1, false);
      if (find(frame, true, false, true) != frame.expected || find(frame, false, false, true) != frame.expected ||
          run(mixed, false, true) != frame.expected) {
        throw std::runtime_error(fmt::format("placement {}: the contacts are not CGAL's", i));
      }
      pairs += frame.expected.size();
      free += frame.expected.empty() ? 1 : 0;
    }
    fmt::print("{} random placements, {} of them without a contact: {} pairs of triangles, 0 missing, 0 extra\n", count,
               free, pairs);
  }

  Table table() const {
    Table out;
    std::size_t pairs = 0, free = 0;
    for (const Frame& frame : bodies_.frames()) {
      pairs += frame.expected.size();
      free += frame.expected.empty() ? 1 : 0;
    }
    out.context = {
        machine(),
        fmt::format("target {}, {} frames of three clips in which two of assimp-testmodels' "
                    "human.zae wrestle, {} of them without a contact",
                    sc_target_name(kBest), bodies_.frames().size(), free),
        fmt::format("contacts over all frames: {} pairs of triangles, from bones and from vertices CGAL's: 0 "
                    "missing, 0 extra",
                    pairs)};
    for (const Contestant& c : contestants_) out.rows.push_back({"P12", c.name + ", mean", c.mean(), ""});
    const auto times_of = [](std::vector<double> times) {
      std::sort(times.begin(), times.end());
      return Times{times[times.size() / 2], times[0]};
    };
    const Times by_spheres = times_of(crowd_times_[0]), by_skin = times_of(crowd_times_[1]);
    out.rows.push_back({"P12", "crowd of 1,000: refit, spheres that touch", by_spheres,
                        fmt::format("{} pairs of characters", by_spheres_)});
    out.rows.push_back(
        {"P12", "crowd of 1,000: bounds, skins that intersect", by_skin,
         fmt::format("{} pairs of characters, of {} whose boxes touch", with_contacts_, crowd_.boxes_touch)});
    out.goals.push_back({"P12 crowd of 1,000, spheres", "ms", by_spheres.median / 1e6, 2, false});
    out.goals.push_back({"P12 crowd of 1,000, skins", "ms", by_skin.median / 1e6, 20, false});
    const auto median = [&](std::size_t i) { return contestants_[i].mean().median; };
    out.goals.push_back(
        {"P12 two bodies over the self-contact's mean", "x", median(2) / ((median(0) + median(1)) / 2), 1.5, false});
    out.goals.push_back({"P12 CGAL's over two bodies'", "x", median(4) / median(2), 1000, true});
    return out;
  }

 private:
  BodyContactJob job_of(const Frame& frame, bool from_bones) {
    BodyContactJob job;
    for (int body = 0; body < 2; ++body) {
      JobBody& of = body == 0 ? job.a : job.b;
      of.asset = &bodies_.human().asset;
      of.skin_table = bodies_.table();
      of.pose = pose_of(frame, body, from_bones);
    }
    job.scratch = scratch_.data()->words;
    job.scratch_words = 8 * scratch_.size();
    return job;
  }
  Pose pose_of(const Frame& frame, int body, bool from_bones) const {
    Pose pose;
    if (from_bones) {
      pose = bodies_.human().pose(0);
      pose.bones = frame.bones[body].data();
    } else {
      pose.vertices = frame.positions[body].data();
      pose.vertex_count = frame.positions[body].size() / 3;
    }
    return pose;
  }

  std::vector<Pair> find(const Frame& frame, bool from_bones, bool has_parts, bool has_triangles) {
    return run(job_of(frame, from_bones), has_parts, has_triangles);
  }
  std::vector<Pair> run(BodyContactJob job, bool has_parts, bool has_triangles) {
    if (has_parts) {
      job.parts = parts_.data();
      job.part_capacity = parts_.size();
    }
    if (has_triangles) {
      job.triangles = triangles_.data();
      job.triangle_capacity = triangles_.size();
    }
    require(job.run(), "two bodies");
    std::vector<Pair> out;
    for (std::size_t i = 0; has_triangles && i < job.triangle_count; ++i) {
      out.push_back({triangles_[i].triangle_a, triangles_[i].triangle_b});
    }
    return out;
  }
  void find_own(const Frame& frame, int body) {
    SkinContactJob job;
    job.asset = &bodies_.human().asset;
    job.skin_table = bodies_.table();
    job.pose = pose_of(frame, body, true);
    job.scratch = scratch_.data()->words;
    job.scratch_words = 8 * scratch_.size();
    job.parts = parts_.data();
    job.part_capacity = parts_.size();
    require(job.run(), "one body");
  }

  void compare() {
    for (const Frame& frame : bodies_.frames()) {
      for (const bool from_bones : {true, false}) {
        if (find(frame, from_bones, false, true) != frame.expected) {
          throw std::runtime_error("the contacts of two bodies are not CGAL's");
        }
      }
    }
  }

  // One pass over the frames at a time, in an order drawn at random over all passes of all contestants.
  void time_all() {
    std::vector<Contestant*> order;
    for (Contestant& c : contestants_) {
      c.times.resize(bodies_.frames().size());
      order.insert(order.end(), static_cast<std::size_t>(c.passes), &c);
    }
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    for (Contestant* c : order) {
      for (std::size_t i = 0; i < bodies_.frames().size(); ++i) {
        const double start = now();
        c->run(bodies_.frames()[i]);
        c->times[i].push_back(now() - start);
      }
    }
  }

  Wrestlers bodies_;
  Crowd crowd_;
  std::vector<double> crowd_times_[2];
  std::size_t by_spheres_ = 0, with_contacts_ = 0;
  Memory scratch_;
  std::vector<PartContact> parts_;
  std::vector<TriangleContact> triangles_;
  std::vector<Contestant> contestants_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Times exact contacts of two bodies against CGAL's and against each body's own: goal P12"};
  int frames = 20, passes = 21, placements = 0;
  std::string json;
  app.add_option("--frames", frames, "Of each of the three clips")->capture_default_str()->check(CLI::Range(1, 10000));
  app.add_option("--passes", passes, "Of the runtime over the frames; CGAL makes 3")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--placements", placements, "Random ones to check against CGAL first; 10,000 take some 15 minutes")
      ->check(CLI::Range(0, 10000000));
  app.add_option("--json", json, "File to write the table to as well");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto bench = std::make_unique<Bench>(frames, passes);
    if (placements > 0) bench->check_placements(placements);
    const Table table = bench->table();
    table.print();
    if (!json.empty()) table.write_json(json);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "spherechain_bench_bodies: {}\n", error.what());
    return 1;
  }
}
