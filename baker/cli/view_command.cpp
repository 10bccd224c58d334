// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>

#include "cli/between.h"
#include "cli/commands.h"
#include "cli/installed.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "page/page.h"
#include "page/page_inputs.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

fs::path viewer_template() {
  const fs::path page = installed_page("viewer.html");
  if (!fs::is_regular_file(page)) {
    throw Error(ExitCode::kFile, page.string() + ": the viewer's page is not installed (build spherechain with Node)");
  }
  return page;
}

}  // namespace

ExitCode run_view(const ViewOptions& options) {
  check_outputs(
      with_motion(
          with_source({{"ASSET", options.asset}, {"--report", options.report}, {"--validation", options.validation}},
                      "--source", options.source),
          options.motion),
      {{"-o", options.output}});
  check_replaceable(options.output, "<!doctype html", "a page", options.force);
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
  std::string html;
  {
    Progress progress("view " + options.asset + ":");
    html = view_page(animated, page,
                     [&](int i) { progress.show(fmt::format("frame {} of {}", i + 1, animated.frame_count())); });
  }
  write_atomically(options.output, html);
  if (html.size() > kLargePageBytes) {
    fmt::print(
        stderr,
        "spherechain: warning: {}: {:.0f} MB take browsers long to open (fewer frames: --frames, one clip: --clip)\n",
        options.output, static_cast<double>(html.size()) / 1e6);
  }
  fmt::print("wrote {} ({:.1f} MB): open it in a browser\n", options.output, static_cast<double>(html.size()) / 1e6);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
