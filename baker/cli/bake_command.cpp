// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/os/written_file.h"
#include "baker/pipeline/pipeline.h"
#include "baker/play/asset_file.h"
#include "baker/report/preview.h"
#include "baker/report/report.h"

namespace spherechain::baker {

ExitCode run_bake(const BakeOptions& options) {
  BakeSettings settings = make_settings(options.prop ? "prop" : options.profile,
                                        options.config.empty() ? "{}" : read_file(options.config), options.config);
  if (options.spheres > 0) settings.fit.spheres = options.spheres;
  if (options.extremities) settings.fit.extremities = true;
  if (!options.body.empty()) settings.segment.body = parse_body(options.body);
  if (!options.character.empty()) settings.import.character = options.character;
  if (options.size.is_given()) settings.size = options.size;
  if (!options.roles.empty()) settings.roles = parse_role_file(read_file(options.roles), options.roles);
  if (!options.edits.empty()) {
    settings.edits = parse_edits(read_file(options.edits), options.edits);
    check_edits(settings, options.edits);
  }
  check_regular_file(options.input);
  check_outputs(with_source({{"--config", options.config}, {"--roles", options.roles}, {"--edits", options.edits}},
                            "INPUT", options.input),
                {{"-o", options.output, FileKind::kAsset},
                 {"--report", options.report, FileKind::kJson},
                 {"--preview", options.preview, FileKind::kGlb}},
                options.force ? Force::kGiven : Force::kOffered);

  Bake result;
  std::string preview;
  {
    Progress progress("bake " + options.input + ":");
    result = bake(options.input, settings, [&](const std::string& stage) { progress.show(stage); });
    if (!options.preview.empty()) {
      progress.show("preview");
      preview = preview_glb(result);
    }
  }
  // The asset last: where report or preview cannot be written, no asset without them stays behind.
  if (!options.report.empty()) write_atomically(options.report, bake_report_json(result));
  if (!options.preview.empty()) write_atomically(options.preview, preview);
  write_atomically(options.output, {reinterpret_cast<const char*>(result.asset.data()), result.asset.size()});

  say("{}", bake_report_text(result));
  say("wrote {} ({} bytes)\n", options.output, result.asset.size());
  if (!options.report.empty()) say("wrote {}\n", options.report);
  if (!options.preview.empty()) say("wrote {} ({} bytes)\n", options.preview, preview.size());
  say("{}", fit_line(result));
  const std::vector<std::string> missed = missed_targets(result);
  for (const std::string& target : missed) say(stderr, "spherechain: target missed: {}: {}\n", options.input, target);
  for (const std::string& edit : result.edits_done.missed)
    say(stderr, "spherechain: edit missed: {}: {}\n", options.edits.empty() ? options.config : options.edits, edit);
  return missed.empty() && result.edits_done.missed.empty() ? ExitCode::kDone : ExitCode::kTargetMissed;
}

}  // namespace spherechain::baker
