// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "check/rules.h"
#include "cli/commands.h"
#include "cli/installed.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "fix/fix_report.h"
#include "fix/mend.h"
#include "fix/write_clip.h"
#include "page/page_of_two.h"
#include "pipeline/pipeline.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

void make_folder(const std::string& path) {
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) throw Error(ExitCode::kFile, path + ": no such folder can be made (" + failed.message() + ")");
}

Event event_of(const MendedEvent& mended, const std::vector<BodyPart>& parts) {
  Event event;
  event.parts = {parts[mended.part_a].name, parts[mended.part_b].name};
  event.kind = mended.kind;
  event.depth_mm = mended.depth_before;
  return event;
}

// Pages of the clips that changed, before and after side by side. Returns a line for each that cannot be shown: what
// was mended is written by then.
std::string write_pages(const FixOptions& options, const fs::path& page, const Bake& baked, const AnimatedAsset& before,
                        const std::vector<MendedClip>& clips) {
  for (const auto& entry : fs::directory_iterator(options.report)) {
    const std::string name = entry.path().filename().string();  // of an earlier run
    if (name.starts_with("clip_") && name.ends_with(".html")) fs::remove(entry.path());
  }
  std::string notes;
  if (!fs::is_regular_file(page)) return notes;
  const std::string_view asset(reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size());
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const MendedClip& clip = clips[i];
    if (std::all_of(clip.mend.turns.begin(), clip.mend.turns.end(), [](const Vec3& x) { return x.isZero(0); }))
      continue;
    MotionChoice motion;
    // By its number where others have its name.
    const std::vector<Clip>& all = before.character().rig.clips;
    const Clip& own = *before.clips()[i].clip;
    const bool is_only =
        std::count_if(all.begin(), all.end(), [&](const Clip& other) { return other.name == own.name; }) == 1;
    motion.clip = is_only ? own.name : std::to_string(&own - all.data());
    const AnimatedAsset one(OpenAsset(asset, options.input), options.input, options.input, motion, {0, 0});
    PageOptions page_options;
    page_options.template_file = page.string();
    page_options.title = fs::path(options.input).filename().string() + ": before (grey) and after (blue)";
    page_options.names = {"before", "after"};
    page_options.they_meet = false;
    page_options.fps = one.clips()[0].fps;  // the mended one's own may be another
    const AnimatedAsset other(OpenAsset(asset, options.input), options.input, options.output, motion,
                              {0, page_options.fps});
    const Place beside{mm_per_unit(one.asset()) * one.frame().height / 1000, 0, 0};
    std::string html;
    try {
      html = view_page_of_two(one, other, &beside, page_options, [](int) {});
    } catch (const Error& error) {
      if (error.code() != ExitCode::kUsage) throw;
      const std::string what = error.what();  // and in brackets what to do, which other commands can
      notes += fmt::format("spherechain: warning: {}: has no page: {}\n", clip.name, what.substr(0, what.rfind(" (")));
      continue;
    }
    write_atomically(fs::path(options.report) / fmt::format("clip_{}.html", i), html);
  }
  return notes;
}

}  // namespace

ExitCode run_fix(const FixOptions& options) {
  const fs::path page = installed_page("viewer.html");  // now: a long run may outlive its program's file
  CheckConfig config = default_config();
  if (!options.keep.empty()) config = read_config(read_file(options.keep), options.keep, config);
  check_regular_file(options.input);
  const std::string json = options.report.empty() ? "" : (fs::path(options.report) / "fix.json").string();
  if (fs::path(options.output).extension() != ".glb") {
    throw Error(ExitCode::kUsage, "-o: " + options.output + " is written as a binary glTF (name it .glb)");
  }
  if (fs::exists(options.report) && !fs::is_directory(options.report)) {
    throw Error(ExitCode::kFile, options.report + ": is no folder");
  }
  check_outputs(with_source({{"--keep", options.keep}}, "INPUT", options.input), {{"-o", options.output}});
  check_replaceable(options.output, "glTF", "a GLB file", options.force);
  check_replaceable_json(json, options.force, "--force replaces it");

  std::vector<MendedClip> clips;
  std::string text, notes, bytes;
  {
    Progress progress("fix " + options.input + ":");
    const Bake baked = bake(options.input, config.bake, [&](const std::string& stage) { progress.show(stage); });
    MotionChoice motion;
    motion.clip = options.clip;
    const std::string_view asset(reinterpret_cast<const char*>(baked.asset.data()), baked.asset.size());
    const AnimatedAsset animated(OpenAsset(asset, options.input), options.input, options.input, motion, {0, 0});
    const std::vector<BodyPart> parts = parts_of(animated.asset()).parts;
    for (const std::string& name : config.rules.named_parts()) {
      if (std::none_of(parts.begin(), parts.end(), [&](const BodyPart& part) { return part.name == name; })) {
        notes += fmt::format("spherechain: warning: {}: a rule names '{}', which this character has not\n",
                             options.keep, name);
      }
    }
    for (const ClipFrames& clip : animated.clips()) {
      if (clip.clip == nullptr || animated.asset()->bone_count() == 0) {
        throw Error(ExitCode::kFile,
                    options.input + (clip.clip == nullptr ? ": has no clips to mend" : ": no bones move it"));
      }
      if (bytes.empty()) bytes = read_as_glb(options.input);
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
      clips.push_back({clip.name, std::move(mend), seconds.count()});
    }
    write_atomically(options.output, bytes);
    if (!json.empty()) {
      progress.show("report");
      make_folder(options.report);
      write_atomically(json, fix_json(clips, parts));
      notes += write_pages(options, page, baked, animated, clips);
    }
    text = fix_text(clips, parts);
  }
  fmt::print(stderr, "{}", notes);
  fmt::print("{}", text);
  fmt::print("wrote {}\n", options.output);
  if (!json.empty()) fmt::print("wrote {}: fix.json, and a page of each clip that changed\n", options.report);
  return leaves_faults(clips) ? ExitCode::kTargetMissed : ExitCode::kDone;
}

}  // namespace spherechain::baker
