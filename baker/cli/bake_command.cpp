// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>

#include "cli/commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "pipeline/pipeline.h"
#include "play/asset_file.h"
#include "report/report.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Baking onto the input, or onto a file that is no asset, is most likely a slip: nothing is lost to it.
void check_output(const BakeOptions& options) {
  std::error_code ignored;
  check_folder(options.output);
  if (!options.report.empty()) check_folder(options.report);
  if (fs::equivalent(options.input, options.output, ignored)) {
    throw Error(ExitCode::kUsage, options.output + ": input and output are the same file");
  }
  if (!options.report.empty() && fs::weakly_canonical(options.report) == fs::weakly_canonical(options.output)) {
    throw Error(ExitCode::kUsage, options.report + ": report and asset are the same file");
  }
  check_replaceable(options.output, "SPHC", "an asset", options.force, 4);
}

}  // namespace

ExitCode run_bake(const BakeOptions& options) {
  BakeSettings settings =
      make_settings(options.profile, options.config.empty() ? "{}" : read_file(options.config), options.config);
  if (options.extremities) settings.fit.extremities = true;
  if (!fs::exists(options.input)) throw Error(ExitCode::kFile, options.input + ": no such file");
  check_output(options);

  Bake result;
  {
    Progress progress("bake " + options.input + ":");
    result = bake(options.input, settings, [&](const std::string& stage) { progress.show(stage); });
  }
  // The report first: where it cannot be written, no asset without one stays behind.
  if (!options.report.empty()) write_atomically(options.report, bake_report_json(result));
  write_atomically(options.output, {reinterpret_cast<const char*>(result.asset.data()), result.asset.size()});

  fmt::print("{}", bake_report_text(result));
  fmt::print("wrote {} ({} bytes)\n", options.output, result.asset.size());
  if (!options.report.empty()) fmt::print("wrote {}\n", options.report);
  const std::vector<std::string> missed = missed_targets(result);
  for (const std::string& target : missed)
    fmt::print(stderr, "spherechain: target missed: {}: {}\n", options.input, target);
  return missed.empty() ? ExitCode::kDone : ExitCode::kTargetMissed;
}

}  // namespace spherechain::baker
