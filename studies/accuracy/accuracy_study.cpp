// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain validate` with more scores: of a ragdoll of capsules, of spheres with other radii and rest distances,
// and of a test along the chains alone. Takes validate's options, and writes its JSON with the keys chains, capsules,
// radius_curve and rest_curve.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/play/target.h"
#include "baker/report/validation.h"
#include "baker/truth/truth_cache.h"
#include "baker/truth/validate.h"
#include "capsules.h"
#include "curve.h"

using namespace spherechain;
using namespace spherechain::baker;
using nlohmann::ordered_json;

namespace {

// The score of a ragdoll whose radii are this quantile: of the spheres' true pairs, and of its own, without pairs
// within one capsule or between ignored ones.
struct CapsulePoint {
  double quantile;
  Score score, own;
};

struct FrameScores {
  Score chains;
  std::vector<CurvePoint> curve;
  std::vector<CapsulePoint> capsules;
};

double no_depth(const TrueContact&) { return 0; }

class Study {
 public:
  Study(const AnimatedAsset& animated, Radius radius)
      : chains_(animated.asset()),
        curve_(animated.asset(), radius),
        close_(kCloseSurface * animated.frame().height),
        frames_(static_cast<std::size_t>(animated.frame_count())) {
    const TruthSurface surface = surface_of(animated.asset(), animated.character());
    for (int tenths = 5; tenths <= 10; ++tenths) {
      ragdolls_.emplace_back(tenths / 10.0, CapsuleRagdoll(animated, surface, tenths / 10.0));
    }
    const TruthSurface& owned = ragdolls_.front().second.surface();
    close_capsules_ = close_owners(owned, pack(animated.character().source_positions), owned.sphere, close_);
  }

  // From several threads at once, a frame each.
  void add(const ValidatedFrame& frame) {
    FrameScores& out = frames_[static_cast<std::size_t>(frame.index)];
    out.chains = score_frame(frame.truth, chains_.sharing(frame.touching), frame.is_close, frame.is_apart, no_depth);
    out.curve = curve_.measure(frame.spheres, frame.truth, frame.is_close, frame.is_apart);
    out.capsules = score_ragdolls(frame);
  }

  void write(ordered_json& out) const {
    FrameScores sum;
    for (const FrameScores& frame : frames_) {
      sum.chains.add(frame.chains);
      baker::add(sum.curve, frame.curve);
      if (sum.capsules.empty()) {
        sum.capsules = frame.capsules;
        continue;
      }
      for (std::size_t i = 0; i < frame.capsules.size(); ++i) {
        sum.capsules[i].score.add(frame.capsules[i].score);
        sum.capsules[i].own.add(frame.capsules[i].own);
      }
    }
    out["chains"] = score_json(sum.chains);
    if (!sum.capsules.empty()) {
      ordered_json curve = ordered_json::array();
      for (const CapsulePoint& point : sum.capsules) {
        ordered_json entry{{"quantile", point.quantile}};
        entry.update(score_json(point.score));
        entry["own_truth_pairs"] = point.own.true_pairs;
        entry["own_pair_recall"] = score_json(point.own)["pair_recall"];
        curve.push_back(std::move(entry));
      }
      out["capsules"] = {{"count", ragdolls_.front().second.capsules().size()}, {"curve", std::move(curve)}};
    }
    out["radius_curve"] = out["rest_curve"] = ordered_json::array();
    for (const CurvePoint& point : sum.curve) {
      ordered_json entry;
      if (point.change.rest_scale) {
        entry["rest_scale"] = *point.change.rest_scale;
      } else {
        entry["scale"] = point.change.scale;
      }
      entry["all_pairs"] = score_json(point.all_pairs);
      entry["chains"] = score_json(point.chains);
      out[point.change.rest_scale ? "rest_curve" : "radius_curve"].push_back(std::move(entry));
    }
  }

 private:
  std::vector<CapsulePoint> score_ragdolls(const ValidatedFrame& frame) const {
    // All of them own the same triangles. A whole mesh as a pose moves no capsule.
    const CapsuleRagdoll& any = ragdolls_.front().second;
    if (any.capsules().empty() || !frame.deformation.positions.empty()) return {};
    Closeness closeness(any.surface(), frame.positions, close_);
    const auto is_close = [&](const Pair& pair) { return closeness(pair); };
    const auto is_apart = [&](const Pair& pair) { return close_capsules_.count(pair) == 0; };
    const FrameTruth shared = any.by_capsules(frame.truth),
                     own = frame_truth(
                         frame.found, frame.rest_pairs, any.surface(),
                         [&](std::uint32_t a, std::uint32_t b) { return any.is_ignored(a, b); }, frame.is_far);
    std::vector<CapsulePoint> points;
    for (const auto& [quantile, ragdoll] : ragdolls_) {
      const std::vector<Pair> pairs = ragdoll.pairs(frame.deformation);
      points.push_back({quantile, score_frame(shared, pairs, is_close, is_apart, no_depth),
                        score_frame(own, pairs, is_close, is_apart, no_depth)});
    }
    return points;
  }

  ChainMembers chains_;
  Curve curve_;
  double close_;
  std::vector<std::pair<double, CapsuleRagdoll>> ragdolls_;
  std::set<Pair> close_capsules_;  // at rest
  std::vector<FrameScores> frames_;
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Scores spheres, chains and capsules against the exact intersections"};
  std::string asset, source, radius = "detect", json;
  MotionChoice motion;
  FrameChoice frames;
  ValidateSettings settings;
  app.add_option("ASSET", asset)->required();
  app.add_option("--source", source)->required();
  app.add_option("--clip", motion.clip);
  app.add_option("--poses", motion.poses);
  app.add_option("--motion", motion.motion);
  app.add_option("--frames", frames.count);
  app.add_option("--radius", radius)->check(CLI::IsMember({"fit", "detect"}));
  app.add_flag("--contacts", settings.contacts);
  app.add_option("--json", json)->required();
  CLI11_PARSE(app, argc, argv);
  try {
    settings.radius = radius == "fit" ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
    settings.target = choose_target("auto");
    settings.cache = cache_folder();
    const AnimatedAsset animated(asset, source, motion, frames);
    Study study(animated, settings.radius);
    const Validation found = validate(
        animated, settings, [](int) {}, [&](const ValidatedFrame& frame) { study.add(frame); });
    ordered_json out = ordered_json::parse(validation_json(found, animated, settings));
    study.write(out);
    std::ofstream(json) << out.dump(1) << '\n';
  } catch (const std::exception& error) {
    fmt::print(stderr, "accuracy_study: error: {}\n", error.what());
    return 1;
  }
  return 0;
}
