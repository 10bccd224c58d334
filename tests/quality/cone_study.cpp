// SPDX-License-Identifier: GPL-3.0-or-later
// How many cones find what spheres find: a table in Markdown for docs/accuracy.md, some rows a character.
//   cone_study CHARACTER[+MOTION]... ; what ends in .json is a file of settings for the characters after it
// Each pair of cones, or spheres, is reported below a scale of its own: where the contacts in random poses, times their
// worth, exceed its false alarms most, as the bake's calibration has it. All sets get the same treatment.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "calibrate/random_poses.h"
#include "cone_sets.h"
#include "measure/sphere_quality.h"
#include "pipeline/pipeline.h"
#include "play/player.h"
#include "truth/contacts.h"
#include "truth/far_parts.h"
#include "truth/score.h"

namespace {

using namespace spherechain::baker;
using spherechain::Pair;
using spherechain::Sphere;
using spherechain::quality::Cone;
using spherechain::quality::ConeSet;
using spherechain::quality::ConeSets;

constexpr int kFrames = 60, kPoses = 600;
constexpr double kClose = 0.003;  // of the height, as validate's
constexpr double kAsked = 0.99;   // the far recall at which sets are compared
constexpr double kExpected = 4;   // other poses that a moment of a clip counts for
constexpr std::size_t kSteps = 200;
constexpr double kReach = 2;  // the largest scale

// Contacts and false alarms of a pair, by scale.
struct Evidence {
  std::array<double, kSteps> contacts{}, alarms{};

  void add(double scale, bool touch, double times) {
    const auto step = static_cast<std::size_t>(std::max(0.0, scale) / kReach * kSteps);
    if (step < kSteps) (touch ? contacts : alarms)[step] += times;
  }
  void add(const Evidence& other, double times) {
    for (std::size_t i = 0; i < kSteps; ++i) {
      contacts[i] += times * other.contacts[i];
      alarms[i] += times * other.alarms[i];
    }
  }
  double best(double worth) const {
    double sum = 0, most = 0, scale = 0.3;
    for (std::size_t i = 0; i < kSteps; ++i) {
      sum += worth * contacts[i] - alarms[i];
      if (sum > most) most = sum, scale = std::max(0.3, kReach / kSteps * static_cast<double>(i + 1));
    }
    return scale;
  }
};

struct Frame {
  std::vector<float> positions;
  std::vector<Sphere> spheres;
  std::vector<Pair> contacts;
};

class Study {
 public:
  Study(const AnimatedAsset& animated, const std::string& name) : animated_(animated), name_(name) {
    std::vector<Joint> joints;
    for (std::size_t i = 0; i < animated.asset()->joint_count(); ++i) {
      const auto joint = animated.asset()->joint(i);
      const auto at = [](const sc_vec3& v) { return Vec3(double{v.x}, double{v.y}, double{v.z}); };
      joints.push_back({joint.name, joint.parent, at(joint.position), at(joint.tail)});
    }
    const RandomPoses poses(animated.character(), joints);
    Random random(7);
    for (int i = 0; i < kPoses && poses.any(); ++i) {
      const RandomPoses::Pose pose = poses.next(random, i % 3, static_cast<double>(i) / kPoses);
      poses_.push_back(frame_of({pose.bones, pose.morphs, {}}));
      weights_.push_back(i % 3 == 0 && poses.have_clips() ? kExpected : 1);
    }
    for (int i = 0; i < animated.frame_count(); ++i) frames_.push_back(frame_of(animated.deformation(i)));
  }

  void run(bool spheres_alone) const {
    const ConeSet spheres = sets_.spheres();
    Score product;
    Judge judge(*this, spheres);
    for (const Frame& frame : frames_) {
      Player player(animated_.asset(), SC_RADIUS_DETECT, false, true, SC_TARGET_BEST);
      player.run(frame.positions);
      product.add(judge.score(frame, {player.pairs().begin(), player.pairs().end()}));
    }
    print(spheres, "the asset's own scales", product);
    measure(spheres);
    if (spheres_alone) return;
    for (const double part : {1.0, 0.5, 0.35, 0.25}) measure(sets_.cones(part));
  }

 private:
  // A frame's score, with its own triangles for each link.
  class Judge {
   public:
    Judge(const Study& study, const ConeSet& set)
        : study_(study),
          set_(set),
          near_(close_owners(study.surface_, pack(study.animated_.character().source_positions), set.owner,
                             study.close_)) {}

    bool is_near(const Pair& pair) const { return near_.count(pair) > 0; }
    Score score(const Frame& frame, const std::vector<Pair>& reported) const {
      FrameTruth truth;
      truth.pairs = frame.contacts;
      std::copy_if(frame.contacts.begin(), frame.contacts.end(), std::back_inserter(truth.far),
                   [&](const Pair& pair) { return study_.is_far_(pair); });
      std::map<Pair, std::vector<Pair>> contacts;
      for (const Pair& pair : frame.contacts) contacts[study_.owners(set_, pair)].push_back(pair);
      for (auto& [links, triangles] : contacts) truth.contacts.push_back({links, std::move(triangles)});
      return score_frame(
          truth, reported,
          [&](const Pair& pair) {
            return any_closer(study_.surface_, frame.positions, set_.of_link[pair.a], set_.of_link[pair.b],
                              study_.close_);
          },
          [&](const Pair& pair) { return !is_near(pair); }, [](const TrueContact&) { return 0.0; });
    }

   private:
    const Study& study_;
    const ConeSet& set_;
    std::set<Pair> near_;
  };

  Frame frame_of(const Deformation& deformation) const {
    Frame out;
    out.positions = pack(animated_.positions(deformation));
    out.spheres = refit_spheres(animated_.asset(), out.positions, SC_RADIUS_DETECT);
    // Folds of neighbours too: what lies in one primitive, or between ignored ones, counts as missed.
    out.contacts = find_contacts(animated_.asset(), out.positions, SC_SCOPE_ALL, SC_TARGET_BEST);
    std::sort(out.contacts.begin(), out.contacts.end());
    return out;
  }

  Pair owners(const ConeSet& set, const Pair& triangles) const {
    const auto [a, b] =
        std::minmax({set.owner[surface_.of_source[triangles.a]], set.owner[surface_.of_source[triangles.b]]});
    return {a, b};
  }

  std::vector<Evidence> evidence(const ConeSet& set, const Judge& judge) const {
    const std::vector<Pair> pairs = set.pairs();
    std::vector<Evidence> out(pairs.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      std::set<Pair> touching;
      for (const Pair& pair : poses_[i].contacts) touching.insert(owners(set, pair));
      const std::vector<double> scales = set.touching_scales(poses_[i].spheres);
      for (std::size_t p = 0; p < pairs.size(); ++p) out[p].add(scales[p], touching.count(pairs[p]) > 0, weights_[i]);
    }
    // What nearly touches at rest has a contact there; others borrow an average pair of each link and of the body.
    const std::vector<double> at_rest = set.touching_scales(sets_.rest());
    std::vector<std::pair<Evidence, double>> of_link(set.links.size() + 1);
    const auto lend = [&](std::size_t p, bool back) {
      for (const std::size_t link : {std::size_t{pairs[p].a}, std::size_t{pairs[p].b}, set.links.size()}) {
        auto& [sum, count] = of_link[link];
        if (back) {
          out[p].add(sum, 1 / count);
        } else {
          sum.add(out[p], 1), ++count;
        }
      }
    };
    for (const bool back : {false, true}) {
      for (std::size_t p = 0; p < pairs.size(); ++p) {
        if (0.9 * at_rest[p] >= 1) {
          lend(p, back);
        } else if (back) {
          out[p].add(at_rest[p] * (judge.is_near(pairs[p]) ? 1.03 : 0.8), true, kExpected);
        }
      }
    }
    return out;
  }

  // At the least worth that finds what is asked; else with the most.
  void measure(const ConeSet& set) const {
    const Judge judge(*this, set);
    const std::vector<Pair> pairs = set.pairs();
    const std::vector<Evidence> found = evidence(set, judge);
    std::vector<std::vector<double>> scales;
    for (const Frame& frame : frames_) scales.push_back(set.touching_scales(frame.spheres));
    Score score;
    double worth = 1;
    for (; worth < 1000; worth *= 1.5) {
      score = {};
      for (std::size_t i = 0; i < frames_.size(); ++i) {
        std::vector<Pair> reported;
        for (std::size_t p = 0; p < pairs.size(); ++p) {
          if (scales[i][p] < found[p].best(worth)) reported.push_back(pairs[p]);
        }
        score.add(judge.score(frames_[i], reported));
      }
      if (score.far_recall().value_or(1) >= kAsked) break;
    }
    print(set, fmt::format("a contact worth {:.0f}", worth), score);
  }

  void print(const ConeSet& set, const std::string& rule, const Score& score) const {
    const auto share = [](std::optional<double> of) { return of ? fmt::format("{:.1f}", 100 * *of) : "-"; };
    std::vector<Ball> balls;
    for (std::size_t i = 0; i < set.links.size(); ++i) {
      const Cone cone = set.cone(i, sets_.rest());
      for (int k = 0; k <= 16; ++k) {
        const double at = k / 16.0;
        balls.push_back(
            {cone.from + at * (cone.to - cone.from), cone.from_radius + at * (cone.to_radius - cone.from_radius)});
      }
    }
    const SphereQuality quality = body_.measure(balls, [](Index) { return true; });
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {:.1f} | {:.0f}, {:.1f} |\n", name_, set.name, set.links.size(),
               rule, share(score.far_recall()), share(score.apart_precision()), share(score.precision()),
               score.reported_per_frame(), 100 * quality.outside,
               100 * quality.protrusion_p95 / animated_.frame().height);
    std::fflush(stdout);
  }

  const AnimatedAsset& animated_;
  std::string name_;
  TruthSurface surface_ = surface_of(animated_.asset(), animated_.character());
  double close_ = kClose * animated_.frame().height;
  FarParts is_far_{animated_, surface_, close_};
  ConeSets sets_{animated_, surface_};
  SampledBody body_{animated_.character().body, 20000};
  std::vector<Frame> poses_, frames_;
  std::vector<double> weights_;
};

std::string read(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void study(const std::string& character, const std::string& settings) {
  const std::size_t plus = character.find('+');
  const std::string mesh = character.substr(0, plus);
  MotionChoice motion;
  if (plus != std::string::npos) motion.motion = character.substr(plus + 1);
  const std::filesystem::path file = std::filesystem::temp_directory_path() / fmt::format("cones{}.sphc", getpid());
  const Bake baked = bake(mesh, make_settings("balanced", settings, "study"), {});
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(baked.asset.data()), static_cast<std::streamsize>(baked.asset.size()));
  FrameChoice frames;
  frames.count = kFrames;
  const AnimatedAsset animated(file.string(), mesh, motion, frames);
  std::filesystem::remove(file);
  std::string name = std::filesystem::path(mesh).filename().string();
  if (plus != std::string::npos) name += " + " + std::filesystem::path(motion.motion).filename().string();
  Study(animated, name).run(settings != "{}");
}

}  // namespace

int main(int argc, char** argv) {
  fmt::print(
      "| character | set | primitives | scales | far recall | apart precision | precision | pairs a frame | "
      "outside, p95 % |\n|---|---|---|---|---|---|---|---|---|\n");
  try {
    std::string settings = "{}";
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      if (word.ends_with(".json")) {
        settings = read(word);
      } else {
        study(word, settings);
      }
    }
    return argc > 1 ? 0 : 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "cone_study: {}\n", error.what());
    return 3;
  }
}
