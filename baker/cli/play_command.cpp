// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "mesh/error.h"
#include "play/cuda_frames.h"
#include "play/player.h"
#include "play/target.h"
#include "report/play_frames.h"
#include "report/report.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// What all frames together show.
class Tally {
 public:
  void add(int index, const FrameResult& result, const Player& player, const std::optional<Player::SkinDetection>& skin,
           const std::optional<Player::TriangleDetection>& triangles, const Asset& asset) {
    ++frames_;
    last_ = result;
    refit_us_ += result.refit_us;
    if (result.m1) {
      m1_us_ += result.m1->us;
      m1_raw_ += result.m1->raw_pairs;
    }
    if (result.m2) m2_us_ += result.m2->us;
    const Span<const Pair> pairs = player.pairs();
    pairs_ += pairs.size;
    touching_ += pairs.size > 0 ? 1 : 0;
    if (skin) {
      has_skin_ = true;
      skin_pairs_ += skin->pairs.size();
      skin_frames_ += skin->pairs.empty() ? 0 : 1;
      skin_us_ += skin->us;
    }
    if (triangles) {
      has_triangles_ = true;
      triangle_pairs_ += triangles->pairs.size();
      triangle_us_ += triangles->us;
    }
    std::map<std::pair<std::string, std::string>, bool> seen;
    for (const Pair& pair : pairs) {
      std::string a = asset.region(asset.spheres()[pair.a].region).name,
                  b = asset.region(asset.spheres()[pair.b].region).name;
      if (b < a) std::swap(a, b);
      seen[{a, b}] = true;
    }
    for (const auto& [names, yes] : seen) ++by_region_.try_emplace(names, index, 0).first->second.second;
  }

  std::string text(const std::string& radius, const std::string& refit, const std::string& backend) const {
    const double n = frames_;
    const std::string pairs = fmt::format("{:.1f}", static_cast<double>(pairs_) / n);
    std::string out = fmt::format("{} frames, radius {}, refit {}, backend {}\n\n", frames_, radius, refit, backend);
    out += fmt::format("{:<6} {:>8} {:>10} {:>12} {:>10}\n", "", "tests", "pairs", "raw pairs", "us");
    out += fmt::format("{:<6} {:>8} {:>10} {:>12} {:>10.2f}\n", "refit", "", "", "", refit_us_ / n);
    if (last_.m1) {
      out += fmt::format("{:<6} {:>8} {:>10} {:>12.1f} {:>10.2f}\n", "M1", last_.m1->tests,
                         last_.m2 ? std::string() : pairs, static_cast<double>(m1_raw_) / n, m1_us_ / n);
    }
    if (last_.m2) {
      out += fmt::format("{:<6} {:>8} {:>10} {:>12} {:>10.2f}\n", "M2", last_.m2->tests, pairs, "", m2_us_ / n);
    }
    if (has_skin_) {
      out += fmt::format("{:<6} {:>8} {:>10.1f} {:>12} {:>10.2f}\n", "skin", "", static_cast<double>(skin_pairs_) / n,
                         "", skin_us_ / n);
    }
    if (has_triangles_) {
      out += fmt::format("{:<9} {:>5} {:>10.1f} {:>12} {:>10.2f}\n", "triangles", "",
                         static_cast<double>(triangle_pairs_) / n, "", triangle_us_ / n);
    }
    out += "(a frame, on average)\n\n";
    if (has_skin_) out += fmt::format("frames with touching skin: {} of {}\n", skin_frames_, frames_);
    out += fmt::format("frames with touching spheres: {} of {}\n", touching_, frames_);
    for (const auto& [names, seen] : by_region_) {
      out += fmt::format("  {:<24} {:>3} frames, from frame {}\n", names.first + " - " + names.second, seen.second,
                         seen.first);
    }
    return out;
  }

 private:
  int frames_ = 0, touching_ = 0, skin_frames_ = 0;
  bool has_skin_ = false, has_triangles_ = false;
  std::size_t skin_pairs_ = 0, triangle_pairs_ = 0;
  double skin_us_ = 0, triangle_us_ = 0;
  FrameResult last_;
  double refit_us_ = 0, m1_us_ = 0, m2_us_ = 0;
  std::size_t pairs_ = 0, m1_raw_ = 0;
  std::map<std::pair<std::string, std::string>, std::pair<int, int>> by_region_;  // regions -> first frame, frames
};

}  // namespace

ExitCode run_play(const PlayOptions& options) {
  check_outputs(with_motion(with_source({{"ASSET", options.asset}}, "--source", options.source), options.motion),
                {{"--json", options.json}});
  check_replaceable_json(options.json, false, "delete it, or name another");
  const bool on_cuda = options.backend == "cuda";
  if (on_cuda && options.mode == "m1") throw Error(ExitCode::kUsage, "--backend cuda: has no M1 (--mode m2)");
  const Target target = choose_target(on_cuda ? "auto" : options.backend);
  const RadiusKind radius = options.radius == "fit" ? RadiusKind::kFit : RadiusKind::kDetect;
  const AnimatedAsset animated(options.asset, options.source, options.motion, options.frames);
  const bool has_leaves = animated.asset().leaf_count() > 0;
  if (options.contacts) animated.check_leaves();
  CudaFrames cuda;
  if (on_cuda) cuda = play_on_cuda(animated, radius);
  Player player(animated.asset(), radius, options.mode != "m2", options.mode != "m1", target);
  Tally tally;
  const char* const refit = refit_name(animated.asset().refit_rule());
  std::optional<PlayFile> file;
  if (!options.json.empty()) {
    file.emplace(options.json,
                 ordered_json{{"backend", on_cuda ? "cuda" : backend_name(target)},
                              {"target", on_cuda ? "cuda" : to_string(target)},
                              {"radius", options.radius},
                              {"refit", refit}},
                 animated.frame_count());
  }
  {
    Progress progress("play " + options.asset + ":");
    for (int i = 0; i < animated.frame_count(); ++i) {
      progress.show(fmt::format("frame {} of {}", i + 1, animated.frame_count()));
      const std::vector<float> positions = pack(animated.positions(animated.deformation(i)));
      FrameResult result;
      if (on_cuda) {
        CudaFrame& frame = cuda.frames[static_cast<std::size_t>(i)];
        result.m2 = player.take(std::move(frame.spheres), frame.pairs, cuda.us);
      } else {
        result = player.run(positions);
      }
      std::optional<Player::SkinDetection> skin;
      if (has_leaves) skin = player.detect_skin(positions);
      std::optional<Player::TriangleDetection> triangles;
      if (options.contacts) triangles = player.detect_triangles(positions);
      tally.add(i, result, player, skin, triangles, animated.asset());
      if (!file) continue;
      ordered_json frame = frame_json(animated, i, result, player);
      if (skin) {
        frame["skin_us"] = skin->us;
        frame["skin_pairs"] = pairs_json({skin->pairs.data(), skin->pairs.size()});
      }
      if (triangles) {
        frame["contacts_us"] = triangles->us;
        ordered_json& contacts = frame["contacts"] = ordered_json::array();
        for (const TrianglePair& pair : triangles->pairs) contacts.push_back({pair.a, pair.b});
      }
      file->add(frame);
    }
  }
  fmt::print("{}", tally.text(options.radius, refit, on_cuda ? "cuda (refit and M2 in one)" : backend_text(target)));
  if (!options.json.empty()) fmt::print("wrote {}\n", options.json);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
