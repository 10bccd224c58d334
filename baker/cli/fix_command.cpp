// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/installed.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/fix/fix_character.h"
#include "baker/import/robot_model.h"
#include "baker/motion/capture.h"
#include "baker/motion/sequence.h"
#include "baker/os/own_folder.h"
#include "baker/os/written_file.h"
#include "baker/page/page_of_two.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "fix report";

bool is_report_file(const std::string& name) {
  return name == "fix.json" || (name.starts_with("clip_") && name.ends_with(".html"));
}

struct Pages {
  int written = 0;
  std::string notes;  // a line for each that cannot be shown: what was mended is written by then
};

bool has_page(const Mend& mend) {
  return !mend.is_still() || std::any_of(mend.events.begin(), mend.events.end(), [](const MendedEvent& event) {
    return event.outcome == MendOutcome::kRefused;
  });
}

// Pages of the clips that changed, or would have, before and after side by side.
Pages write_pages(const FixOptions& options, const fs::path& page, const FixedCharacter& fixed, OwnFolder& report,
                  Progress& progress) {
  Pages out;
  if (!fs::is_regular_file(page)) {
    out.notes =
        "spherechain: warning: no pages: " + page.string() + " is not there (it is built where Node and npm are)\n";
    return out;
  }
  std::optional<AnimatedAsset> before, after;
  for (std::size_t i = 0; i < fixed.clips.size(); ++i) {
    if (!has_page(fixed.clips[i].mend)) continue;
    for (std::optional<AnimatedAsset>* one : {&before, &after}) {
      if (!*one)
        one->emplace(OpenAsset(fixed.asset, options.input), options.input, fixed.source.file, MotionChoice(),
                     FrameChoice());
    }
    before->play_clip(fixed.before[i], {0, 0});
    PageOptions page_options;
    page_options.template_file = page.string();
    page_options.title = fs::path(options.input).filename().string() + ": before (grey) and after (blue)";
    page_options.names = {"before", "after"};
    page_options.they_meet = false;
    page_options.events = page_events(fixed.clips[i]);
    page_options.fps = before->clips()[0].fps;  // the mended one's own may be another
    after->play_clip(fixed.after[i], {0, page_options.fps});
    const std::string doing = fmt::format("page {} of {}", i + 1, fixed.clips.size());
    std::string html;
    try {
      html = view_page_of_two(*before, *after, nullptr, page_options, [&](int frame) {
        if (frame % 10 == 0) progress.show(fmt::format("{}, frame {} of {}", doing, frame, before->frame_count()));
      });
    } catch (const Error& error) {
      if (error.code() != ExitCode::kUsage) throw;
      const std::string what = error.what();  // and in brackets what to do, which other commands can
      out.notes += fmt::format("spherechain: warning: {}: has no page: {}\n", fixed.clips[i].name,
                               what.substr(0, what.rfind(" (")));
      continue;
    }
    report.write(fmt::format("clip_{}.html", i), html);
    ++out.written;
  }
  return out;
}

// By the ending of its name.
FileKind output_kind(const FixOptions& options) {
  if (has_ending(options.output, ".bvh")) return FileKind::kBvh;
  return has_ending(options.output, ".fbx") ? FileKind::kFbx : FileKind::kGlb;
}

void check_files(const FixOptions& options) {
  check_regular_file(options.input);
  refuse_robot(options.input);
  const FileKind kind = output_kind(options);
  const bool writes_bvh = kind == FileKind::kBvh;
  if (writes_bvh && !has_ending(options.motion, ".bvh")) {
    throw Error(ExitCode::kUsage,
                "-o: " + options.output + ": a BVH is written of a BVH alone (--motion TAKE.bvh, or name it .glb)");
  }
  if (kind == FileKind::kFbx && !options.motion.empty()) {
    throw Error(ExitCode::kUsage, "-o: " + options.output + ": an FBX gets no new clip of --motion (name it .glb)");
  }
  if (kind == FileKind::kGlb && !has_ending(options.output, ".glb")) {
    throw Error(ExitCode::kUsage,
                "-o: " + options.output +
                    (fs::is_directory(options.output)
                         ? " is a folder"
                         : " is written as a binary glTF (name it .glb), or as the FBX that was read (.fbx)"));
  }
  if (fs::is_directory(options.motion)) {
    throw Error(ExitCode::kUsage, "--motion: " + options.motion + " is a folder (name one recording)");
  }
  if (is_sequence(options.motion)) {
    throw Error(ExitCode::kUsage, "--motion: " + options.motion + " holds meshes, and no joints to turn");
  }
  if (!options.report.empty()) OwnFolder::check(options.report, kKind, is_report_file);
  std::vector<CommandFile> inputs{
      {"--keep", options.keep}, {"--baseline", options.baseline}, {"--decisions", options.decisions}};
  MotionChoice motion;
  motion.motion = options.motion;
  check_outputs(with_motion(with_source(std::move(inputs), "INPUT", options.input), motion),
                {{"-o", options.output, kind, writes_bvh ? options.motion : options.input}},
                options.force ? Force::kGiven : Force::kOffered);
}

}  // namespace

ExitCode run_fix(const FixOptions& options) {
  const fs::path page = installed_page("viewer.html");  // now: a long run may outlive its program's file
  const FileKind kind = output_kind(options);
  const bool writes_bvh = kind == FileKind::kBvh;
  FixJob job;
  job.input = options.input;
  job.clip = options.clip;
  if (!options.motion.empty()) job.recordings = {options.motion};
  job.is_recording_written = writes_bvh;
  job.is_fbx_written = kind == FileKind::kFbx;
  job.config = default_config();
  if (!options.keep.empty()) job.config = read_config(read_file(options.keep), options.keep, job.config);
  if (!options.character.empty()) job.config.bake.import.character = options.character;
  if (options.size.is_given()) job.config.bake.size = options.size;
  if (!options.baseline.empty()) job.baseline = read_baseline(options.baseline, false);
  if (!options.decisions.empty()) job.decisions = read_decisions(options.decisions);
  job.parts = options.parts;
  job.mend = {options.budget, options.margin};
  check_files(options);
  if (!options.motion.empty()) read_capture(options.motion);  // now: a bake may take minutes

  FixedCharacter fixed;
  std::string again;
  Pages pages;
  {
    Progress progress("fix " + options.input + ":");
    fixed = fix_character(job, [&](const std::string& doing) { progress.show(doing); });
    write_atomically(options.output, fixed.bytes);
    if (!options.report.empty()) {
      progress.show("report");
      OwnFolder report(options.report, kKind);
      report.write("fix.json", fix_json(fixed.clips));
      pages = write_pages(options, page, fixed, report, progress);
      report.finish();
    }
    if (writes_bvh) {
      progress.show("carrying over again");
      again = fmt::format("carried over again, the skin is within {:.2f} mm of what was mended\n",
                          carried_over_again(fixed, options.input, options.output));
    }
  }
  say(stderr, "{}", pages.notes);
  if (!options.baseline.empty() && !fixed.is_in_baseline) {
    say(stderr, "spherechain: warning: {}: has no event of this character and these clips\n", options.baseline);
  }
  for (const Decision& decision : fixed.unused_decisions) {
    const bool is_elsewhere =
        !options.clip.empty() && std::none_of(fixed.clips.begin(), fixed.clips.end(),
                                              [&](const MendedClip& clip) { return clip.name == decision.clip; });
    if (is_elsewhere) continue;
    say(stderr, "spherechain: warning: {}: is about no event of this run: {}\n", options.decisions,
        decision_text(decision));
  }
  for (const std::string& part : fixed.unused_parts) {
    say(stderr, "spherechain: warning: {}: a rule names '{}', which this character has not\n", options.keep, part);
  }
  say("{}{}wrote {}\n", fix_text(fixed.clips), again, options.output);
  if (!options.report.empty()) {
    say("wrote {}: fix.json and {} page{}\n", options.report, pages.written, pages.written == 1 ? "" : "s");
  }
  return leaves_faults(fixed.clips) ? ExitCode::kTargetMissed : ExitCode::kDone;
}

}  // namespace spherechain::baker
