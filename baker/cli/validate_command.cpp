// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "baker/cli/between.h"
#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/os/written_file.h"
#include "baker/play/target.h"
#include "baker/report/validation.h"
#include "baker/truth/truth_cache.h"
#include "baker/truth/validate.h"

namespace spherechain::baker {

ExitCode run_validate(const ValidateOptions& options) {
  check_outputs(with_motion(with_source({{"ASSET", options.asset}}, "--source", options.source), options.motion),
                {{"--json", options.json, FileKind::kJson}}, Force::kNone);
  ValidateSettings settings;
  settings.radius = options.radius == "fit" ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
  settings.target = choose_target("auto");
  settings.contacts = options.contacts;
  settings.skin = !options.spheres_alone;
  settings.cache = cache_folder();
  AnimatedAsset animated(options.asset, options.source, options.motion, options.frames);
  if (options.continuous) look_between(animated, options.asset);
  Validation validation;
  {
    Progress progress("validate " + options.asset + ":");
    validation = validate(animated, settings, [&](int done) {
      progress.show(fmt::format("{} of {} frames", done, animated.frame_count()));
    });
  }
  if (!options.json.empty()) write_atomically(options.json, validation_json(validation, animated, settings));
  say("{}", validation_text(validation, animated, settings));
  if (!options.json.empty()) say("wrote {}\n", options.json);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
