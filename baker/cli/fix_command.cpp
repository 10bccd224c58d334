// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "check/rules.h"
#include "cli/commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "fix/fix_report.h"
#include "fix/mend.h"
#include "fix/write_clip.h"
#include "pipeline/pipeline.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

Event event_of(const MendedEvent& mended, const std::vector<BodyPart>& parts) {
  Event event;
  event.parts = {parts[mended.part_a].name, parts[mended.part_b].name};
  event.kind = mended.kind;
  event.depth_mm = mended.depth_before;
  return event;
}

}  // namespace

ExitCode run_fix(const FixOptions& options) {
  CheckConfig config = default_config();
  if (!options.keep.empty()) config = read_config(read_file(options.keep), options.keep, config);
  check_regular_file(options.input);
  check_outputs(with_source({{"--keep", options.keep}}, "INPUT", options.input),
                {{"-o", options.output}, {"--report", options.report}});
  check_replaceable(options.output, "glTF", "a GLB file", options.force);
  check_replaceable_json(options.report, options.force, "--force replaces it");

  std::vector<MendedClip> clips;
  std::string bytes = read_file(options.input);
  {
    Progress progress("fix " + options.input + ":");
    const Bake baked = bake(options.input, config.bake, [&](const std::string& stage) { progress.show(stage); });
    MotionChoice motion;
    motion.clip = options.clip;
    const std::string_view asset(reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size());
    const AnimatedAsset animated(OpenAsset(asset, options.input), options.input, options.input, motion, {0, 0});
    const std::vector<BodyPart> parts = parts_of(animated.asset()).parts;
    for (const ClipFrames& clip : animated.clips()) {
      if (clip.clip == nullptr) {
        throw Error(ExitCode::kFile, options.input + ": has no clips to mend");
      }
      const auto start = std::chrono::steady_clock::now();
      const auto leave = [&](const MendedEvent& event) {
        const Event known = event_of(event, parts);
        return config.rules.leaves_out(known) || !config.rules.excuse(known).empty();
      };
      Mend mend = mend_clip(animated, baked.roles, clip, {options.budget, options.margin}, leave,
                            [&](const std::string& doing) { progress.show(clip.name + ": " + doing); });
      const TurnedClip turned(animated.character().rig, *clip.clip, clip.fps, clip.own_count, mend.joints);
      const std::vector<RotationTrack> tracks = turned_tracks(turned, mend.turns, mend.in_window);
      bytes = with_tracks(bytes, options.input, animated.character().rig, clip.clip->in_file, tracks);
      const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
      clips.push_back({clip.name, std::move(mend), turned.count(), seconds.count()});
    }
    if (!options.report.empty()) write_atomically(options.report, fix_json(clips, parts));
    write_atomically(options.output, bytes);
    progress.show("done");
    for (const MendedClip& clip : clips) fmt::print("{}", fix_text(clip, parts));
  }
  fmt::print("wrote {}\n", options.output);
  return leaves_faults(clips) ? ExitCode::kTargetMissed : ExitCode::kDone;
}

}  // namespace spherechain::baker
