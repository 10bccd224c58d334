// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/play/asset_file.h"
#include "baker/report/report.h"

namespace spherechain::baker {

ExitCode run_inspect(const InspectOptions& options) {
  if (options.roles) {
    ImportOptions import;
    import.character = options.character;
    const Character character = import_character(options.asset, import);
    const Roles roles = find_roles(character.rig, character.source_positions);
    say("{}", options.json ? roles_json(character.rig, roles) : roles_text(character.rig, roles));
    return ExitCode::kDone;
  }
  const OpenAsset file = open_asset(options.asset);
  say("{}", options.json ? inspect_json(file) : inspect_text(file));
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
