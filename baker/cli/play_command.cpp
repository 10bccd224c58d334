// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "baker/cli/between.h"
#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"
#include "baker/play/cuda_frames.h"
#include "baker/play/hidden_joints.h"
#include "baker/play/player.h"
#include "baker/play/responder.h"
#include "baker/play/target.h"
#include "baker/report/collider_report.h"
#include "baker/report/palette_file.h"
#include "baker/report/part_contacts.h"
#include "baker/report/parts.h"
#include "baker/report/play_frames.h"
#include "baker/report/report.h"
#include "baker/report/response_report.h"
#include "baker/write/version.h"

namespace spherechain::baker {
namespace {

using nlohmann::ordered_json;

// Means over all frames: what the spheres tell beside the skin, and what each costs.
class Tally {
 public:
  void add(const FrameResult& result, Span<const Pair> alarmed, const std::vector<Pair>& skin, double skin_us,
           double measure_us) {
    ++frames_;
    last_ = result;
    refit_us_ += result.refit_us;
    all_pairs_us_ += result.all_pairs.us;
    skin_us_ += skin_us;
    measure_us_ += measure_us;
    skin_ += skin.size();
    alarmed_ += alarmed.size;
    for (const Pair& pair : alarmed) confirmed_ += std::binary_search(skin.begin(), skin.end(), pair) ? 1 : 0;
  }

  std::string spheres_text() const {
    const double n = frames_;
    std::string out = fmt::format("spheres: {:.1f} pairs a frame as a cheap alarm", static_cast<double>(alarmed_) / n);
    if (alarmed_ > 0) {
      out += fmt::format("; the skin confirms {:.1f} of them ({:.0f} %)", static_cast<double>(confirmed_) / n,
                         100.0 * static_cast<double>(confirmed_) / static_cast<double>(alarmed_));
    }
    if (skin_ > confirmed_) {
      out += fmt::format("; they miss {:.1f} that touch", static_cast<double>(skin_ - confirmed_) / n);
    }
    return out + "\n";
  }

  std::string times_text() const {
    const double n = frames_;
    const auto row = [&](const char* name, const std::string& tests, const std::string& pairs, double us) {
      return fmt::format("{:<10} {:>8} {:>10} {:>10.2f}\n", name, tests, pairs, us / n);
    };
    const auto mean = [&](std::size_t pairs) { return fmt::format("{:.1f}", static_cast<double>(pairs) / n); };
    std::string out = fmt::format("{:<10} {:>8} {:>10} {:>10}\n", "a frame", "tests", "pairs", "us");
    out += row("refit", "", "", refit_us_);
    out += row("all pairs", std::to_string(last_.all_pairs.tests), mean(alarmed_), all_pairs_us_);
    return out + row("skin", "", mean(skin_), skin_us_) + row("depth", "", "", measure_us_);
  }

 private:
  int frames_ = 0;
  FrameResult last_;
  double refit_us_ = 0, all_pairs_us_ = 0, skin_us_ = 0, measure_us_ = 0;
  // Pairs of spheres; alarmed: they touch.
  std::size_t skin_ = 0, alarmed_ = 0, confirmed_ = 0;
};

std::string frames_text(const AnimatedAsset& animated) {
  const std::size_t clips = animated.clips().size();
  return clips > 1 ? fmt::format("{} clips, {} frames\n", clips, animated.frame_count()) : std::string();
}

ExitCode write_palettes(const AnimatedAsset& animated, std::optional<Responder>& responder,
                        const PlayOptions& options) {
  PaletteFile file(options.palettes, animated);
  {
    Progress progress("play " + options.asset + ":");
    for (int i = 0; i < animated.frame_count(); ++i) {
      progress.show(fmt::format("frame {} of {}", i + 1, animated.frame_count()));
      file.add(i, responder ? responder->respond(i) : animated.deformation(i));
    }
  }
  file.finish();
  const int frames = animated.frame_count();
  say("{} frame{} of {} joints\nwrote {}\n", frames, frames == 1 ? "" : "s", animated.asset()->bone_count(),
      options.palettes);
  return ExitCode::kDone;
}

}  // namespace

ExitCode run_play(const PlayOptions& options) {
  check_outputs(with_motion(with_source({{"ASSET", options.asset}}, "--source", options.source), options.motion),
                {{"--json", options.json, FileKind::kJson}, {"--palettes", options.palettes, FileKind::kPalettes}},
                Force::kNone);
  const bool on_cuda = options.backend == "cuda";
  const Target target = choose_target(on_cuda ? "auto" : options.backend);
  const Radius radius = options.radius == "fit" ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
  AnimatedAsset animated(options.asset, options.source, options.motion, options.frames);
  if (options.continuous) look_between(animated, options.asset);
  animated.check_clusters();
  std::optional<Responder> responder;
  if (options.respond) responder.emplace(animated, target, options.ahead);
  if (!options.palettes.empty()) return write_palettes(animated, responder, options);
  CudaFrames cuda;
  if (on_cuda) cuda = play_on_cuda(animated, radius);
  Player player(animated.asset(), radius, target);
  PartContacts contacts(animated);
  std::vector<HiddenJoints> hidden(animated.clips().size(), HiddenJoints(animated));  // of each clip
  Tally tally;
  const char* const refit = refit_name(animated.asset()->refit_rule());
  const ColliderAlarms alarms = collider_alarms_of(animated);
  std::optional<PlayFile> file;
  if (!options.json.empty()) {
    file.emplace(options.json,
                 ordered_json{{"writer", kWriter},
                              {"backend", on_cuda ? "cuda" : backend_name(target)},
                              {"target", on_cuda ? "cuda" : sc_target_name(target)},
                              {"radius", options.radius},
                              {"refit", refit},
                              {"parts", parts_json(part_rows(animated.asset()))}},
                 animated.frame_count());
  }
  {
    Progress progress("play " + options.asset + ":");
    for (int i = 0; i < animated.frame_count(); ++i) {
      progress.show(fmt::format("frame {} of {}", i + 1, animated.frame_count()));
      const Deformation deformation = responder ? responder->respond(i) : animated.deformation(i);
      if (animated.frame_at(i).between == 0) hidden[animated.frame_at(i).clip].add(deformation);
      const std::vector<float> positions = pack(animated.positions(deformation));
      FrameResult result;
      if (on_cuda) {
        CudaFrame& frame = cuda.frames[static_cast<std::size_t>(i)];
        result.all_pairs = player.take(std::move(frame.spheres), frame.pairs, cuda.us);
      } else {
        result = player.run(positions);
      }
      const bool is_next = i > 0 && animated.frame_at(i).clip == animated.frame_at(i - 1).clip;
      const Player::TriangleDetection skin = player.detect_triangles(SkinPose(animated, deformation).pose(), is_next);
      const PartCounts counts = contacts.add(i, skin.pairs, skin.penetrations);
      tally.add(result, player.pairs(), player.spheres_of(skin.pairs), skin.us, skin.measure_us);
      if (!file) continue;
      ordered_json frame = frame_json(animated, i, result, player);
      frame["skin"] = skin_json(player, skin, contacts, counts, options.contacts);
      frame["penetrations"] = penetrations_json(animated, skin.penetrations, contacts);
      file->add(frame);
    }
    if (file) {
      ordered_json tail{{"clips", contacts.json()}};
      if (alarms.poses > 0) tail["colliders"] = collider_json(alarms, animated);
      if (responder) tail["response"] = response_json(responder->measures());
      file->finish(tail);
    }
  }
  for (std::size_t c = 0; c < hidden.size(); ++c) {
    const std::string& clip = animated.clips()[c].name;
    const std::string text = unseen_text(hidden[c], animated.clips()[c]);
    if (!text.empty()) add_note(options.source + ": " + (clip.empty() ? text : clip + ": " + text));
  }
  say("{}{}\n{}\n{}(radius {}, refit {}, backend {})\n", frames_text(animated), contacts.text(options.motion.name()),
      tally.spheres_text(), tally.times_text(), options.radius, refit,
      on_cuda ? "cuda: refit and all pairs in one" : backend_text(target));
  say("{}", collider_text(alarms, animated));
  if (responder) say("{}", response_text(responder->measures(), animated));
  if (!options.json.empty()) say("wrote {}\n", options.json);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
