// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "report/page.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Build tree and installation have the same shape: bin/spherechain and share/spherechain/viewer.html.
fs::path viewer_template() {
  const fs::path page = fs::canonical("/proc/self/exe").parent_path().parent_path() / "share/spherechain/viewer.html";
  if (!fs::is_regular_file(page)) {
    throw Error(ExitCode::kFile, page.string() + ": the viewer's page is not installed (build spherechain with Node)");
  }
  return page;
}

std::string read_report(const std::string& file) {
  if (file.empty()) return {};
  std::string text = read_file(file);
  if (!nlohmann::json::accept(text)) throw Error(ExitCode::kFile, file + ": is not a bake report (not valid JSON)");
  return text;
}

std::string read_validation(const std::string& file) {
  if (file.empty()) return {};
  std::string text = read_file(file);
  const nlohmann::json found = nlohmann::json::parse(text, nullptr, false);
  if (!found.is_object() || !found.contains("worst_misses") || !found.contains("m2")) {
    throw Error(ExitCode::kFile, file + ": is not what validate --json writes");
  }
  return text;
}

}  // namespace

ExitCode run_view(const ViewOptions& options) {
  check_outputs(with_motion({{"ASSET", options.asset},
                             {"--source", options.source},
                             {"--report", options.report},
                             {"--validation", options.validation}},
                            options.motion),
                {{"-o", options.output}});
  check_replaceable(options.output, "<!doctype html", "a page", options.force);
  PageOptions page;
  page.template_file = viewer_template().string();
  page.report = read_report(options.report);
  page.validation = read_validation(options.validation);
  page.title = fs::path(options.asset).filename().string();
  page.radius = options.radius == "fit" ? RadiusKind::kFit : RadiusKind::kDetect;
  const AnimatedAsset animated(options.asset, options.source, options.motion, options.frames);
  page.motion = options.motion.name().empty() ? animated.clip_at(0) : options.motion.name();
  if (page.motion.empty()) page.motion = "rest";
  page.fps = options.frames.fps;
  std::string html;
  {
    Progress progress("view " + options.asset + ":");
    html = view_page(animated, page,
                     [&](int i) { progress.show(fmt::format("frame {} of {}", i + 1, animated.frame_count())); });
  }
  write_atomically(options.output, html);
  fmt::print("wrote {} ({:.1f} MB): open it in a browser\n", options.output, static_cast<double>(html.size()) / 1e6);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
