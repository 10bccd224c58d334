// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts between two frames (docs/performance.md). Checks that the poses of substeps have nothing that
// the steps lack, then times both in turn.
#include <fmt/format.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <algorithm>
#include <exception>
#include <functional>
#include <random>
#include <stdexcept>

#include "runtime/src/simd/simd.h"
#include "runtime/src/skin/skin_inputs.h"
#include "runtime/src/step/step_job.h"
#include "table.h"
#include "wrestlers.h"

using namespace spherechain;
using namespace spherechain::bench;

namespace {

const Target kBest = supported_targets()[0];
constexpr double kTolerance = 1e-4;  // of the height
constexpr int kSubsteps = 64;        // looked at to compare

// Nanoseconds this thread has run. Waiting for a core of a shared machine does not count.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

struct Step {
  std::vector<float> bones[2];          // SC_ROWS_3X4
  std::vector<sc_transform> joints[2];  // the same, each joint in the space of the pose
  double substeps;                      // so that no two vertices change their distance by more than the tolerance
  bool is_free;                         // nothing touches
};

std::vector<float> palette(const baker::Deformation& pose) {
  std::vector<float> out(12 * pose.bones.size());
  for (std::size_t b = 0; b < pose.bones.size(); ++b) put(pose.bones[b], out.data() + 12 * b);
  return out;
}

std::vector<float> blend(const Step& step, double t) {
  std::vector<float> out(step.bones[0].size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<float>(double{step.bones[0][i]} + t * (double{step.bones[1][i]} - double{step.bones[0][i]}));
  }
  return out;
}

struct Contestant {
  std::string name;
  int passes;
  std::function<void(const Step&)> run;
  std::vector<std::vector<double>> times = {};  // by step, of each pass

  Times mean(const std::vector<Step>& steps, bool free_only) const {
    double medians = 0, minima = 0, count = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (free_only && !steps[i].is_free) continue;
      std::vector<double> pass = times[i];
      std::sort(pass.begin(), pass.end());
      medians += pass[pass.size() / 2];
      minima += pass[0];
      count += 1;
    }
    return {medians / count, minima / count};
  }
};

class Bench {
 public:
  Bench(int steps, int passes, double rate) {
    load(human_, "human", "{}", 33);
    table_ = memory_for(skin_table_words(&human_.asset));
    require(prepare_skin(&human_.asset, table_.data()->words, skin_table_words(&human_.asset)), "skin table");
    require(read_skin_table(human_.view(), table_.data()->words, surface_), "skin table");
    contacts_.resize(4096);
    parts_.resize(4096);
    Motion sized;
    sized.body.asset = &human_.asset;
    sized.joint_count = human_.view().bone_count();
    scratch_ = memory_for(std::max(step_scratch_words(&sized, nullptr), skin_scratch_words(&human_.asset)));
    std::mt19937 random(13);
    const auto motions = motions_of(human_.bake);
    for (const auto& [name, motion] : motions) {
      if (motion->duration() <= 0) continue;
      for (int i = 0; i < steps; ++i) {
        const double length = 1 / (rate * motion->duration());
        // The first frame of a recording is no pose of it.
        const double t = 2 * length + (1 - 3 * length) * static_cast<double>(random()) / 4294967296.0;
        add(motion->at(t), motion->at(t + length));
      }
    }
    contestants_.push_back(
        {"contacts in the frame where a step starts", passes, [this](const Step& s) { frame(s.bones[0]); }});
    contestants_.push_back({"a step of matrices", passes, [this](const Step& s) { step(s, SC_BLEND_LINEAR); }});
    contestants_.push_back({"a step of joints, slerp", passes, [this](const Step& s) { step(s, SC_BLEND_SLERP); }});
    contestants_.push_back({"a step of joints, nlerp", passes, [this](const Step& s) { step(s, SC_BLEND_NLERP); }});
    compare();
    time_all();
  }

  // Steps of the recordings at 5 to 60 a second, of matrices and of joints: poses at four 1024ths of each, as the
  // quaternions are blended here, have no contact that the step lacks, but for such as are no deeper than the
  // tolerance.
  void check_steps(int count) {
    std::mt19937 random(17);
    std::vector<NamedMotion> motions = motions_of(human_.bake);
    motions.erase(
        std::remove_if(motions.begin(), motions.end(), [](const auto& m) { return m.motion->duration() <= 0; }),
        motions.end());
    std::size_t looked_at = 0, off = 0, begun = 0;
    double deepest = 0;
    for (int i = 0; i < count; ++i) {
      const baker::Motion& motion = *motions[random() % motions.size()].motion;
      const double rate = 5 + 55 * static_cast<double>(random()) / 4294967296.0,
                   length = 1 / (rate * motion.duration());
      const double t = 2 * length + (1 - 3 * length) * static_cast<double>(random()) / 4294967296.0;
      const Step s = step_of(motion.at(t), motion.at(t + length));
      const Blend blending = i % 2 == 0 ? SC_BLEND_LINEAR : SC_BLEND_SLERP;
      const std::size_t found = step(s, blending);
      for (std::size_t k = 0; k < found; ++k) begun += contacts_[k].at_start == 0 ? 1 : 0;
      for (int k = 0; k < 4; ++k) {
        const double at = static_cast<double>(1 + random() % 1023) / 1024;
        const std::vector<float> bones = blending == SC_BLEND_LINEAR ? blend(s, at) : slerp(s, at);
        for (const Penetration& penetration : measure(bones)) {
          ++looked_at;
          const auto end = contacts_.begin() + static_cast<std::ptrdiff_t>(found);
          if (std::any_of(contacts_.begin(), end, [&](const StepContact& c) {
                return c.part_a == penetration.part_a && c.part_b == penetration.part_b && double{c.begin} <= at &&
                       double{c.end} >= at;
              })) {
            continue;
          }
          ++off;
          deepest = std::max(deepest, double{penetration.depth} / double{human_.view().info().height});
        }
      }
    }
    fmt::print(
        "{} steps, 4 poses of each: {} pairs of body parts touch, {} of them begin in a step; {} outside of the times "
        "found, {:.2g} of the height deep at most\n",
        count, looked_at, begun, off, deepest);
    if (deepest > kTolerance) throw std::runtime_error("a step lacks a contact that is deeper than the tolerance");
  }

  Table table() const {
    Table out;
    double substeps = 0;
    std::size_t free = 0;
    for (const Step& s : steps_) {
      substeps += s.substeps / static_cast<double>(steps_.size());
      free += s.is_free ? 1 : 0;
    }
    out.context = {
        machine(),
        fmt::format("target {}, {} steps of assimp-testmodels' human.zae, {} of them without a contact",
                    sc_target_name(kBest), steps_.size(), free),
        fmt::format("poses on the way, {} a step: {} pairs of body parts touch, 0 of them missing, none by more "
                    "than {:.3f} of a step earlier or later; {} found that begin or end in a step",
                    kSubsteps, looked_at_, latest_, begun_)};
    for (const Contestant& c : contestants_) {
      out.rows.push_back({"P12", c.name + ", mean", c.mean(steps_, false), ""});
      if (free > 0) out.rows.push_back({"P12", c.name + ", no contact", c.mean(steps_, true), ""});
    }
    const double of_frame = contestants_[0].mean(steps_, false).median;
    for (std::size_t i = 1; i < contestants_.size(); ++i) {
      const double mean = contestants_[i].mean(steps_, false).median;
      out.goals.push_back(
          {"P12 " + contestants_[i].name + ": mean over a frame's contacts", "x", mean / of_frame, 3, false});
      if (free > 0) {
        out.goals.push_back({"P12 " + contestants_[i].name + ": no contact", "us",
                             contestants_[i].mean(steps_, true).median / 1e3, 15, false});
      }
      out.goals.push_back({"P12 " + contestants_[i].name + ": substeps for the same guarantee, over it", "x",
                           substeps * of_frame / mean, 10, true});
    }
    return out;
  }

 private:
  void add(const baker::Deformation& from, const baker::Deformation& to) {
    steps_.push_back(step_of(from, to));
    Step& out = steps_.back();
    out.substeps = 1 + greatest_move(out) / (kTolerance * double{human_.view().info().height});
  }
  Step step_of(const baker::Deformation& from, const baker::Deformation& to) const {
    Step out;
    const baker::Deformation* const ends[] = {&from, &to};
    for (int end = 0; end < 2; ++end) {
      out.bones[end] = palette(*ends[end]);
      for (std::size_t b = 0; b < human_.view().bone_count(); ++b) {
        const baker::Affine world = ends[end]->bones[b] * affine_at(human_.view().bone(b).inverse_bind).inverse();
        const Eigen::Quaterniond turn(world.linear());
        const auto at = [&](Eigen::Index i) { return static_cast<float>(world.translation()[i]); };
        out.joints[end].push_back({{at(0), at(1), at(2)},
                                   {static_cast<float>(turn.x()), static_cast<float>(turn.y()),
                                    static_cast<float>(turn.z()), static_cast<float>(turn.w())},
                                   {1, 1, 1}});
      }
    }
    return out;
  }
  std::vector<float> slerp(const Step& s, double t) const {
    std::vector<float> out(s.bones[0].size());
    for (std::size_t b = 0; b < s.joints[0].size(); ++b) {
      const auto turn = [&](int end) {
        const float* const q = s.joints[end][b].rotation;
        return Eigen::Quaterniond(double{q[3]}, double{q[0]}, double{q[1]}, double{q[2]}).normalized();
      };
      const auto place = [&](int end) {
        const sc_vec3& p = s.joints[end][b].translation;
        return baker::Vec3(double{p.x}, double{p.y}, double{p.z});
      };
      const baker::Affine world = Eigen::Translation3d(place(0) + t * (place(1) - place(0))) *
                                  baker::Affine(turn(0).slerp(t, turn(1)).toRotationMatrix());
      put(world * affine_at(human_.view().bone(b).inverse_bind), out.data() + 12 * b);
    }
    return out;
  }
  // Finds a frame's contacts and their depths.
  std::vector<Penetration> measure(const std::vector<float>& bones) {
    SkinContactJob find;
    find.asset = &human_.asset;
    find.skin_table = table_.data()->words;
    find.pose = pose_of(bones);
    find.scratch = scratch_.data()->words;
    find.scratch_words = 8 * scratch_.size();
    triangles_.resize(1 << 16);
    find.triangles = triangles_.data();
    find.triangle_capacity = triangles_.size();
    require(find.run(), "a frame");
    PenetrationJob job;
    job.asset = find.asset;
    job.skin_table = find.skin_table;
    job.pose = find.pose;
    job.contacts = triangles_.data();
    job.contact_count = find.triangle_count;
    job.quick = 1;
    Memory room = memory_for(penetration_scratch_words(find.asset, job.contact_count));
    job.scratch = room.data()->words;
    job.scratch_words = 8 * room.size();
    std::vector<Penetration> out(find.part_count);
    job.penetrations = out.data();
    job.penetration_capacity = out.size();
    require(job.run(), "depth");
    out.resize(job.penetration_count);
    return out;
  }
  // Twice what a vertex moves at most: two may go against each other.
  double greatest_move(const Step& s) const {
    std::vector<float> positions[2];
    for (int end = 0; end < 2; ++end) {
      positions[end].assign(3 * human_.bake.character.source_positions.size(), 0);
      skin_surface(surface_, pose_of(s.bones[end]), kBest, positions[end].data(), 3);
    }
    double most = 0;
    for (std::size_t i = 0; i < positions[0].size(); i += 3) {
      double squared = 0;
      for (std::size_t k = i; k < i + 3; ++k) squared += std::pow(double{positions[1][k]} - double{positions[0][k]}, 2);
      most = std::max(most, squared);
    }
    return 2 * std::sqrt(most);
  }
  Pose pose_of(const std::vector<float>& bones) const {
    Pose out = human_.pose(0);
    out.bones = bones.data();
    return out;
  }
  std::size_t frame(const std::vector<float>& bones) {
    SkinContactJob job;
    job.asset = &human_.asset;
    job.skin_table = table_.data()->words;
    job.pose = pose_of(bones);
    job.scratch = scratch_.data()->words;
    job.scratch_words = 8 * scratch_.size();
    job.parts = parts_.data();
    job.part_capacity = parts_.size();
    require(job.run(), "a frame");
    return job.part_count;
  }
  std::size_t step(const Step& s, Blend blend) {
    StepJob job;
    job.a.body.asset = &human_.asset;
    job.a.body.skin_table = table_.data()->words;
    job.a.blend = blend;
    if (blend == SC_BLEND_LINEAR) {
      job.a.body.pose = pose_of(s.bones[0]);
      job.a.end = pose_of(s.bones[1]);
    } else {
      job.a.start_joints = s.joints[0].data();
      job.a.end_joints = s.joints[1].data();
      job.a.joint_count = s.joints[0].size();
    }
    job.scratch = scratch_.data()->words;
    job.scratch_words = 8 * scratch_.size();
    job.contacts = contacts_.data();
    job.contact_capacity = contacts_.size();
    require(job.run(), "a step");
    return job.contact_count;
  }

  void compare() {
    for (Step& s : steps_) {
      const std::size_t count = step(s, SC_BLEND_LINEAR);
      s.is_free = count == 0;
      for (std::size_t i = 0; i < count; ++i) begun_ += contacts_[i].at_start == 0 || contacts_[i].at_end == 0 ? 1 : 0;
      const std::vector<StepContact> found(contacts_.begin(), contacts_.begin() + static_cast<std::ptrdiff_t>(count));
      for (int k = 0; k <= kSubsteps; ++k) {
        const double t = static_cast<double>(k) / kSubsteps;
        const std::size_t part_count = frame(blend(s, t));
        for (std::size_t i = 0; i < part_count; ++i) {
          ++looked_at_;
          const auto of = std::find_if(found.begin(), found.end(), [&](const StepContact& c) {
            return c.part_a == parts_[i].part_a && c.part_b == parts_[i].part_b;
          });
          if (of == found.end()) throw std::runtime_error("a pose on the way has a contact that the step lacks");
          // A contact that is no deeper than the tolerance may be found later, or be gone earlier.
          latest_ = std::max({latest_, double{of->begin} - t, t - double{of->end}});
        }
      }
    }
  }

  // One pass over the steps at a time, in an order drawn at random over all passes of all contestants.
  void time_all() {
    std::vector<Contestant*> order;
    for (Contestant& c : contestants_) {
      c.times.resize(steps_.size());
      order.insert(order.end(), static_cast<std::size_t>(c.passes), &c);
    }
    std::shuffle(order.begin(), order.end(), std::mt19937(1));
    for (Contestant* c : order) {
      for (std::size_t i = 0; i < steps_.size(); ++i) {
        const double start = now();
        c->run(steps_[i]);
        c->times[i].push_back(now() - start);
      }
    }
  }

  PosedCharacter human_;
  Memory table_, scratch_;
  Surface surface_;
  std::vector<Step> steps_;
  std::vector<StepContact> contacts_;
  std::vector<PartContact> parts_;
  std::vector<TriangleContact> triangles_;
  std::vector<Contestant> contestants_;
  std::size_t looked_at_ = 0, begun_ = 0;
  double latest_ = 0;  // of a step
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What touches between two frames: time and comparison (docs/performance.md)");
  int steps = 40, passes = 21;
  double rate = 30;
  int check = 0;
  app.add_option("--steps", steps, "of each recording");
  app.add_option("--passes", passes, "over all steps");
  app.add_option("--rate", rate, "steps a second");
  app.add_option("--check", check, "compare so many random steps with poses on the way, and time nothing");
  CLI11_PARSE(app, argc, argv);
  try {
    if (check > 0) {
      Bench(1, 1, rate).check_steps(check);
    } else {
      Bench(steps, passes, rate).table().print();
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
