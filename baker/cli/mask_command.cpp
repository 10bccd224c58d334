// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/installed.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/mask/clips.h"
#include "baker/mask/find_hidden.h"
#include "baker/mask/raised_limbs.h"
#include "baker/mask/write_mask.h"
#include "baker/os/written_file.h"
#include "baker/page/mask_page.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

void check_files(const MaskOptions& options, FileKind kind) {
  check_regular_file(options.input);
  const std::string& output = options.output;
  const bool is_named_right = kind == FileKind::kJson   ? has_ending(output, ".json")
                              : kind == FileKind::kPage ? has_ending(output, ".html")
                                                        : has_ending(output, ".glb") || has_ending(output, ".vrm");
  if (!is_named_right) {
    throw Error(ExitCode::kUsage,
                "-o: " + output +
                    (fs::is_directory(output)      ? " is a folder"
                     : kind == FileKind::kJson     ? " is written as JSON (name it .json)"
                     : kind == FileKind::kPage     ? " is written as a page (name it .html)"
                     : has_ending(output, ".json") ? " is written as a binary glTF (name it .glb, or take --as json)"
                     : has_ending(output, ".html") ? " is written as a binary glTF (name it .glb, or take --as page)"
                                                   : " is written as a binary glTF (name it .glb or .vrm)"));
  }
  std::vector<CommandFile> inputs = with_source({}, "CHARACTER", options.input);
  for (const std::string& recording : options.motions) {
    MotionChoice motion;
    motion.motion = recording;
    inputs = with_motion(std::move(inputs), motion);
  }
  check_outputs(inputs, {{"-o", options.output, kind}}, options.force ? Force::kGiven : Force::kOffered);
}

std::string percent_text(double part, double whole) {
  return fmt::format("{:.1f} %", whole > 0 ? 100 * part / whole : 0);
}

std::string mask_text(const HiddenSkin& skin, const std::vector<HiddenMesh>& meshes, std::size_t clips,
                      int random_poses, double margin_percent) {
  std::string out = fmt::format(
      "{} frames of {} clip{}{}\n"
      "hidden    {} of {} triangles ({}), {} of the area\n"
      "near edge {} triangles are never seen, and stay: within {:.3g} % of the height of skin that is seen\n",
      skin.frames - random_poses, clips, clips == 1 ? "" : "s",
      random_poses > 0 ? fmt::format(", {} random poses", random_poses) : "", skin.hidden, skin.is_hidden.size(),
      percent_text(static_cast<double>(skin.hidden), static_cast<double>(skin.is_hidden.size())),
      percent_text(skin.hidden_area, skin.area), skin.near_edge, margin_percent);
  if (skin.poke_area > 0) {
    out += fmt::format("poke-through: {} of the area that shows through clothes in these frames goes\n",
                       percent_text(skin.poke_hidden_area, skin.poke_area));
  }
  for (const HiddenMesh& mesh : meshes) {
    if (!mesh.hidden.empty())
      out += fmt::format("  {:<24} {:>7} of {}\n", mesh.name, mesh.hidden.size(), mesh.triangles);
  }
  return out;
}

}  // namespace

std::vector<std::string> mask_forms() { return {"triangles", "vertex-colour", "attribute", "json", "page"}; }

ExitCode run_mask(const MaskOptions& options) {
  const FileKind kind = options.as == "json"   ? FileKind::kJson
                        : options.as == "page" ? FileKind::kPage
                                               : FileKind::kGlb;
  check_files(options, kind);
  MaskPage page;
  if (kind == FileKind::kPage) page.template_file = viewer_template().string();
  HiddenSkin hidden;
  std::vector<HiddenMesh> meshes;
  std::vector<std::string> clip_names, warnings;
  {
    Progress progress("mask " + options.input + ":");
    progress.show("import");
    ImportOptions import;
    import.character = options.character;
    GlbFile glb = glb_of_bytes(read_as_glb(options.input), options.input);
    const Character character = import_character(options.input, import);
    const std::vector<PrimitiveRun> runs = primitive_runs(character, glb.json);
    const LayeredSkin skin = make_layered_skin(character, runs, glb.json);
    const std::vector<Clip> clips = clips_for_mask(character, options.input, import, options.motions,
                                                   [&](const std::string& doing) { progress.show(doing); });
    for (const Clip& clip : clips) clip_names.push_back(clip.name);
    hidden = find_hidden(character, skin, clips, options.random_poses, options.margin / 100,
                         [&](int done, int all) { progress.show(fmt::format("frame {} of {}", done, all)); });
    if (hidden.hidden == 0) {
      throw Error(ExitCode::kFile, options.input + ": all of its skin is seen, or no other piece covers it");
    }
    for (const std::string& limbs : limbs_never_raised(character, clips)) {
      warnings.push_back(
          fmt::format("no clip raises the {}: one that does may show what is hidden (--motion adds a "
                      "recording)",
                      limbs));
    }
    meshes = hidden_meshes(glb.json, runs, hidden);
    if (kind == FileKind::kJson) {
      write_atomically(options.output, mask_json(meshes, hidden, clip_names));
    } else if (kind == FileKind::kPage) {
      page.title = fs::path(options.input).filename().string();
      for (const PrimitiveRun& run : runs) page.mesh_names.push_back(run_name(run, glb.json));
      import.look = true;
      page.look = read_source(options.input, import).look;
      write_atomically(options.output, mask_page(character, skin, clips, hidden, page, [&](int done, int all) {
                         progress.show(fmt::format("page: frame {} of {}", done + 1, all));
                       }));
    } else {
      write_mask(glb, options.input, runs, hidden,
                 options.as == "triangles"   ? MaskForm::kTriangles
                 : options.as == "attribute" ? MaskForm::kAttribute
                                             : MaskForm::kVertexColour);
      write_atomically(options.output, glb.bytes());
    }
  }
  for (const std::string& warning : warnings) say(stderr, "spherechain: warning: {}: {}\n", options.input, warning);
  say("{}wrote {}\n", mask_text(hidden, meshes, clip_names.size(), options.random_poses, options.margin),
      options.output);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
