// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "baker/cli/between.h"
#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/installed.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/export/ignore_by_filter.h"
#include "baker/os/written_file.h"
#include "baker/page/page.h"
#include "baker/page/page_inputs.h"
#include "baker/page/page_of_two.h"
#include "baker/play/target.h"
#include "baker/report/response_report.h"
#include "baker/volumes/fit_volumes.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Files that the command reads for the two characters.
std::vector<CommandFile> inputs_of(const ViewOptions& options, const std::string& with_source_file) {
  std::vector<CommandFile> inputs{{"ASSET", options.asset},
                                  {"--report", options.report},
                                  {"--validation", options.validation},
                                  {"--filter", options.filter}};
  inputs = with_motion(with_source(std::move(inputs), "--source", options.source), options.motion);
  if (options.with.asset.empty()) return inputs;
  inputs.push_back({"--with", options.with.asset});
  return with_motion(with_source(std::move(inputs), "--with-source", with_source_file), options.with.motion);
}

void check_with(const ViewOptions& options) {
  const WithOptions& with = options.with;
  const bool is_same = with.asset == options.asset;
  const std::string wrong =
      options.continuous || options.respond || !options.report.empty() || !options.validation.empty() ||
              !options.volumes.empty()
          ? "--with: a page of two shows no report, no validation, no colliders, no response, and frames alone"
      : with.source.empty() && !is_same ? "--with-source: name the mesh that " + with.asset + " was baked from"
      : with.at.empty() && is_same      ? "--at: say where the second stands: it would stand in the first"
      : static_cast<int>(!with.motion.clip.empty()) + static_cast<int>(!with.motion.poses.empty()) +
                  static_cast<int>(!with.motion.motion.empty()) >
              1
          ? "--with-clip, --with-poses, --with-motion: name one"
          : "";
  if (!wrong.empty()) throw Error(ExitCode::kUsage, wrong);
}

}  // namespace

ExitCode run_view(const ViewOptions& options) {
  const WithOptions& with = options.with;
  const std::string with_source_file = with.source.empty() ? options.source : with.source;
  check_outputs(inputs_of(options, with_source_file), {{"-o", options.output, FileKind::kPage}},
                options.force ? Force::kGiven : Force::kOffered);
  if (!with.asset.empty()) check_with(options);
  PageOptions page;
  page.template_file = viewer_template().string();
  page.title = fs::path(options.asset).filename().string();
  page.radius = options.radius == "fit" ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
  AnimatedAsset animated(options.asset, options.source, options.motion, options.frames);
  if (options.continuous) look_between(animated, options.asset);
  if (!options.report.empty()) page.report = read_bake_report(options.report, animated.asset(), options.asset);
  if (!options.validation.empty()) {
    page.validation = read_validation(options.validation, animated.asset(), options.asset);
  }
  page.motion = options.motion.name().empty() ? "rest pose" : options.motion.name();
  page.fps = options.frames.fps;
  std::optional<Colliders> colliders;
  if (!options.volumes.empty()) {
    colliders = fit_volumes(animated.asset(), volume_shape(options.volumes), options.at_most);
    if (!options.filter.empty()) ignore_by_filter(read_part_filter(options.filter, animated.asset()), *colliders);
    page.colliders = &*colliders;
  }
  std::optional<AnimatedAsset> second;
  if (!with.asset.empty()) {
    second.emplace(with.asset, with_source_file, with.motion, options.frames);
    page.title += " (first, grey) and " + fs::path(with.asset).filename().string() + " (second, blue)";
  }
  std::string html;
  if (!second) {
    animated.take_joints();
    const std::string asset = read_file(options.asset);
    page.asset.assign(asset.begin(), asset.end());
  }
  std::optional<Responder> responder;
  if (options.respond) page.responder = &responder.emplace(animated, choose_target("auto"), options.ahead);
  {
    Progress progress("view " + options.asset + ":");
    const auto show = [&](int i) { progress.show(fmt::format("frame {} of {}", i + 1, animated.frame_count())); };
    if (second) {
      const Place place = with.at.empty() ? Place{} : Place{with.at[0], with.at[1], with.at[2]};
      html = view_page_of_two(animated, *second, with.at.empty() ? nullptr : &place, page, show);
    } else {
      html = view_page(animated, page, show);
    }
  }
  write_atomically(options.output, html);
  if (responder) say("{}", response_text(responder->measures(), animated));
  if (html.size() > kLargePageBytes) {
    say(stderr,
        "spherechain: warning: {}: {:.0f} MB take browsers long to open (fewer frames: --frames, one clip: --clip)\n",
        options.output, static_cast<double>(html.size()) / 1e6);
  }
  say("wrote {} ({:.1f} MB): open it in a browser\n", options.output, static_cast<double>(html.size()) / 1e6);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
