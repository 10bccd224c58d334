// SPDX-License-Identifier: GPL-3.0-or-later
// spherechain: the command line tool. README.md has the contract.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/import/notes.h"
#include "baker/os/terminal.h"
#include "baker/pipeline/pipeline.h"
#include "baker/play/target.h"
#include "baker/volumes/fit_volumes.h"
#include "baker/write/version.h"

namespace {

using namespace spherechain::baker;

int fail(ExitCode code, const std::string& message) {
  say(stderr, "spherechain: error: {}\n", one_line(message));
  return static_cast<int>(code);
}

// CLI::Range takes what is neither too small nor too large, and nan is neither.
std::string refuse_nan(const std::string& text) {
  return std::isnan(std::strtod(text.c_str(), nullptr)) ? "Value " + text + " is not a number" : std::string();
}

// A script's variable that is not set would else go for an option that is not given.
std::string refuse_empty(const std::string& text) { return text.empty() ? "is empty" : std::string(); }

CLI::Option* add_name(CLI::App& command, const std::string& option, std::string& name, const std::string& description) {
  return command.add_option(option, name, description)->check(refuse_empty);
}

// Other tools take it for standard output, which has a command's words for people.
std::string refuse_dash(const std::string& text) {
  return text == "-" ? "- is standard output elsewhere, here it is not (name a file)" : std::string();
}

CLI::Option* add_output(CLI::App& command, const std::string& option, std::string& name,
                        const std::string& description) {
  return add_name(command, option, name, description)->check(refuse_dash);
}

// Output that cannot be printed (full disk, closed file) counts as an output that cannot be written.
int flush(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  return fail(ExitCode::kFile, "standard output: cannot be written");
}

void add_continuous(CLI::App& command, bool& continuous) {
  command.add_flag("--continuous", continuous, "Look between frames, too: for what touches in neither of two");
}

// The choice of motion, the same for every command that animates.
void add_motion(CLI::App& command, MotionChoice& motion, FrameChoice& frames, bool& continuous) {
  CLI::Option_group& choice = *command.add_option_group(
      "Motion", "What to play; without a choice all clips of the source's own, or the rest pose");
  add_name(choice, "--clip", motion.clip, "A clip of the source's own: its name or number");
  add_name(choice, "--poses", motion.poses, "Pose file, or a folder or .txt list of meshes that are poses");
  add_name(choice, "--motion", motion.motion,
           "File of motion capture (BVH, FBX, Collada, AMASS), or folder or .txt list of meshes that are frames");
  choice.require_option(0, 1);
  command
      .add_option("--frames", frames.count,
                  "Number of frames, evenly spaced over all clips (default: each clip's own at --fps; 40 of poses)")
      ->check(CLI::Range(1, 1000000));
  command.add_option("--fps", frames.fps, "Frames a second")
      ->check(CLI::Range(1e-3, 1e6))
      ->check(refuse_nan)
      ->capture_default_str();
  add_continuous(command, continuous);
}

void add_character(CLI::App& command, std::string& character) {
  add_name(command, "--character", character,
           "Of several characters in a file the one to take: the name of its node, or of its skin");
}

void add_size(CLI::App& command, GivenSize& size) {
  const auto add = [&](const char* option, std::optional<double>& number, const char* description) {
    return command.add_option(option, number, description)
        ->check(CLI::Range(kSizeFactorMin, kSizeFactorMax))
        ->check(refuse_nan);
  };
  CLI::Option* scale = add("--scale", size.scale, "The character is so many times as large as its file says");
  add("--height", size.height, "Metres that the character is tall, or long where it is no biped")->excludes(scale);
}

void add_with(CLI::App& command, WithOptions& with) {
  CLI::Option_group& second = *command.add_option_group("Second character", "Shown beside the first");
  CLI::Option* const asset = add_name(second, "--with", with.asset, "Its asset (.sphc)");
  for (CLI::Option* option :
       {add_name(second, "--with-source", with.source, "The mesh it was baked from, where it is another asset"),
        add_name(second, "--with-clip", with.motion.clip, "A clip of that mesh: its name or number"),
        add_name(second, "--with-poses", with.motion.poses, "As --poses, for the second"),
        add_name(second, "--with-motion", with.motion.motion, "As --motion, for the second"),
        second
            .add_option("--at", with.at,
                        "Where it stands: metres to the left and forward of the first, and degrees that it is turned "
                        "(default: where its file has it; another asset's alone)")
            ->delimiter(',')
            ->expected(3)
            ->check(refuse_nan)
            ->check(CLI::Range(-10000.0, 10000.0))
            ->type_name("LEFT,FORWARD,DEGREES")}) {
    option->needs(asset);
  }
}

void add_radius(CLI::App& command, std::string& radius) {
  command.add_option("--radius", radius, "Radius pairs are reported at")
      ->check(CLI::IsMember({"fit", "detect"}))
      ->capture_default_str();
}

void add_respond(CLI::App& command, bool& respond, int& ahead) {
  CLI::Option* flag = command.add_flag(
      "--respond", respond, "Keep hands and arms out of the body as a game does; look at the corrected motion");
  command.add_option("--ahead", ahead, "Frames that --respond knows in advance")->check(CLI::Range(0, 3))->needs(flag);
}

// Returns --at-most.
CLI::Option* add_volumes(CLI::App& command, std::string& volumes, int& at_most, const std::string& description) {
  CLI::Option* shape = command.add_option("--volumes", volumes, description);
  shape->check(CLI::IsMember(std::vector<std::string>(std::begin(kVolumeShapes), std::end(kVolumeShapes))));
  return command
      .add_option("--at-most", at_most, "Volumes in all (default: as many as pay; as many spheres as the asset has)")
      ->check(CLI::Range(1, 10000));
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  ignore_file_size_signal();
  CLI::App app{"Self-collision of animated characters by sphere chains."};
  app.name("spherechain");
  app.set_version_flag("--version", std::string("spherechain ") + kVersion + "\ntargets: " + supported_targets_text());
  app.require_subcommand(1);
  app.footer(
      "Exit: 0 done; 1 internal error; 2 usage; 3 a file cannot be read or written, or has the wrong content;\n"
      "4 the body that was asked for is not there; 5 done, but a target in the settings was not met, or fix leaves "
      "faults;\n"
      "6 done, but a library fails its check.");
  std::function<ExitCode()> run;

  BakeOptions bake;
  CLI::App* bake_command = app.add_subcommand("bake", "Turn a character into an asset");
  add_name(*bake_command, "INPUT", bake.input, "glTF, or anything assimp reads")->required();
  add_output(*bake_command, "-o,--output", bake.output, "Asset to write (.sphc)")->required();
  add_name(*bake_command, "--config", bake.config, "JSON file that changes the profile's settings");
  add_name(*bake_command, "--roles", bake.roles, "JSON file of roles by node name, before names and shape");
  add_name(*bake_command, "--edits", bake.edits,
           "Edits that the page of view saved: spheres, and parts that are ignored");
  bake_command->add_option("--profile", bake.profile, "Where the settings start")
      ->check(CLI::IsMember({"paper", "balanced"}))
      ->capture_default_str();
  bake_command
      ->add_option("--body", bake.body,
                   "What to look for: biped, quadruped, or auto, any number of limbs (default auto)")
      ->check(CLI::IsMember({"biped", "quadruped", "auto"}));
  bake_command->add_option("--spheres", bake.spheres, "At most so many spheres (default: as many as the body needs)")
      ->check(CLI::Range(kSpheresMin, kSpheresMax));
  bake_command->add_flag("--extremities", bake.extremities,
                         "Spheres in head, hands and feet too (profile balanced has them)");
  add_character(*bake_command, bake.character);
  add_size(*bake_command, bake.size);
  CLI::Option* prop = bake_command->add_flag("--prop", bake.prop, "A rigid thing without a rig: a sword, a chair");
  for (const char* other : {"--profile", "--roles", "--body", "--extremities", "--edits"}) {
    prop->excludes(bake_command->get_option(other));
  }
  add_output(*bake_command, "--report", bake.report, "JSON report to write");
  add_output(*bake_command, "--preview", bake.preview, "glTF binary to write: regions, joints and spheres");
  bake_command->add_flag("--force", bake.force, "Replace an output file of another kind");
  bake_command->callback([&] { run = [&] { return run_bake(bake); }; });

  InspectOptions inspect;
  CLI::App* inspect_command = app.add_subcommand("inspect", "Print what an asset holds, or what a rig's joints are");
  add_name(*inspect_command, "ASSET", inspect.asset, "Asset (.sphc); with --roles a character")->required();
  inspect_command->add_flag("--roles", inspect.roles, "Print the role of each node of a character's rig, and why");
  add_character(*inspect_command, inspect.character);
  inspect_command->add_flag("--json", inspect.json, "As JSON");
  inspect_command->callback([&] { run = [&] { return run_inspect(inspect); }; });

  PlayOptions play;
  CLI::App* play_command =
      app.add_subcommand("play", "Animate an asset's source and report which body parts touch, and when");
  add_name(*play_command, "ASSET", play.asset, "Asset (.sphc)")->required();
  add_name(*play_command, "--source", play.source, "The mesh it was baked from")->required();
  add_motion(*play_command, play.motion, play.frames, play.continuous);
  add_radius(*play_command, play.radius);
  play_command
      ->add_option("--backend", play.backend,
                   "How it is computed: auto is simd, with the best instructions this machine has, where "
                   "SPHERECHAIN_TARGET names no others; cuda plays all frames at once on a GPU, from bones")
      ->check(CLI::IsMember({"auto", "scalar", "simd", "cuda"}))
      ->capture_default_str();
  play_command->add_flag("--contacts", play.contacts, "List the triangles that intersect in the JSON, too");
  add_respond(*play_command, play.respond, play.ahead);
  CLI::Option* play_json = add_output(*play_command, "--json", play.json, "JSON file to write");
  add_output(*play_command, "--palettes", play.palettes,
             "The skinning matrices of every frame to write (.npz), in place of looking for contacts")
      ->excludes(play_json);
  play_command->callback([&] { run = [&] { return run_play(play); }; });

  ValidateOptions validate;
  CLI::App* validate_command = app.add_subcommand(
      "validate", "Compare skin contacts and spheres with the exact intersections of the deformed mesh");
  add_name(*validate_command, "ASSET", validate.asset, "Asset (.sphc)")->required();
  add_name(*validate_command, "--source", validate.source, "The mesh it was baked from")->required();
  add_motion(*validate_command, validate.motion, validate.frames, validate.continuous);
  add_radius(*validate_command, validate.radius);
  validate_command->add_flag("--contacts", validate.contacts, "Compare the narrow phase's triangle pairs too");
  validate_command->add_flag("--spheres-alone", validate.spheres_alone,
                             "Judge the spheres that touch, not those whose skins intersect");
  add_output(*validate_command, "--json", validate.json, "JSON file to write");
  validate_command->callback([&] { run = [&] { return run_validate(validate); }; });

  FixOptions fix;
  CLI::App* fix_command = app.add_subcommand("fix", "Turn joints of a clip so that its body parts leave each other");
  add_name(*fix_command, "INPUT", fix.input, "Character: glTF, or anything assimp reads")->required();
  add_output(
      *fix_command, "-o,--output", fix.output,
      "The same with the clips mended (.glb; .fbx of an FBX); with --motion TAKE.bvh also that recording mended (.bvh)")
      ->required();
  CLI::Option* clip = add_name(*fix_command, "--clip", fix.clip, "The clip to mend: its name or number (default: all)");
  add_name(*fix_command, "--motion", fix.motion,
           "Recording (BVH, FBX, Collada, glTF) to carry over and mend, in place of the character's own clips")
      ->excludes(clip);
  add_character(*fix_command, fix.character);
  add_size(*fix_command, fix.size);
  add_name(*fix_command, "--keep", fix.keep, "Rules, as check --config has them: what is fine as it is");
  add_name(*fix_command, "--baseline", fix.baseline, "What check --accept wrote: faults that are accepted are left");
  add_name(*fix_command, "--decisions", fix.decisions,
           "What a page of --report saved: events that it refuses stay as animated");
  fix_command->add_option("--parts", fix.parts, "Body parts, with commas between: only faults of these are mended")
      ->delimiter(',')
      ->check(refuse_empty);
  fix_command->add_option("--budget", fix.budget, "Degrees that an event may turn a joint, at most")
      ->check(CLI::Range(0.1, 180.0))
      ->check(refuse_nan)
      ->capture_default_str();
  fix_command->add_option("--margin", fix.margin, "Millimetres between what was pushed apart")
      ->check(CLI::Range(0.0, 100.0))
      ->check(refuse_nan)
      ->capture_default_str();
  add_output(*fix_command, "--report", fix.report, "Folder to write: fix.json, and pages of before and after");
  fix_command->add_flag("--force", fix.force, "Replace output files of another kind");
  fix_command->callback([&] { run = [&] { return run_fix(fix); }; });

  ExportOptions exported;
  CLI::App* export_command =
      app.add_subcommand("export", "Write an asset's body parts as colliders for another program");
  add_name(*export_command, "ASSET", exported.asset, "Asset (.sphc)")->required();
  export_command->add_option("--to", exported.format, "Format to write (docs/exporting.md)")
      ->required()
      ->check(CLI::IsMember(export_formats()));
  add_output(*export_command, "-o,--output", exported.output, "File to write; what belongs to it is written beside it")
      ->required();
  CLI::Option* exported_source =
      add_name(*export_command, "--source", exported.source,
               "The mesh it was baked from: to measure the fit on its clips; vrm, khr and omi write into it");
  add_name(*export_command, "--motion", exported.motion,
           "Recording (BVH, FBX, Collada, glTF, AMASS) to carry over, in place of the source's own clips")
      ->needs(exported_source);
  add_volumes(*export_command, exported.volumes, exported.at_most,
              "Their shape (default: the best that the format holds)");
  add_name(*export_command, "--filter", exported.filter, "What filter wrote: pairs that need no test are ignored");
  add_size(*export_command, exported.size);
  export_command->add_flag("--force", exported.force, "Replace an output file of another kind");
  export_command->callback([&] { run = [&] { return run_export(exported); }; });

  FilterOptions filter;
  CLI::App* filter_command = app.add_subcommand("filter", "Say which pairs of body parts can meet, and need testing");
  add_name(*filter_command, "ASSET", filter.asset, "Asset (.sphc)")->required();
  add_name(*filter_command, "--source", filter.source, "The mesh it was baked from")->required();
  add_name(*filter_command, "--motion", filter.motion,
           "File of motion capture (BVH, FBX, Collada, AMASS), or folder or .txt list of meshes, besides the source's "
           "clips");
  filter_command->add_option("--poses", filter.poses, "Number of random poses within joint limits")
      ->check(CLI::Range(0, 10000000))
      ->capture_default_str();
  add_name(*filter_command, "--limits", filter.limits, "JSON file of joint limits (default: from the source's clips)");
  add_output(*filter_command, "-o,--output", filter.output, "JSON file to write");
  filter_command->callback([&] { run = [&] { return run_filter(filter); }; });

  MaskOptions mask;
  CLI::App* mask_command = app.add_subcommand("mask", "Find the skin below clothes that no clip shows, and hide it");
  add_name(*mask_command, "CHARACTER", mask.input, "Character: glTF, or anything assimp reads")->required();
  add_output(*mask_command, "-o,--output", mask.output, "The character to write (.glb, .vrm), or the mask (.json)")
      ->required();
  mask_command
      ->add_option("--motion", mask.motions,
                   "Recording (BVH, FBX, Collada, glTF) to look at besides the character's own clips; may be repeated")
      ->check(refuse_empty)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  mask_command
      ->add_option("--margin", mask.margin, "Keep skin that is this near to skin that is seen, in % of the height")
      ->check(CLI::Range(0.0, 10.0))
      ->check(refuse_nan)
      ->capture_default_str();
  mask_command
      ->add_option("--random-poses", mask.random_poses, "Look at so many random poses within the clips' limits, too")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  mask_command->add_option("--as", mask.as, "Without the hidden triangles, or with a mask")
      ->check(CLI::IsMember(mask_forms()))
      ->capture_default_str();
  add_character(*mask_command, mask.character);
  mask_command->add_flag("--force", mask.force, "Replace an output file of another kind");
  mask_command->callback([&] { run = [&] { return run_mask(mask); }; });

  ViewOptions view;
  CLI::App* view_command = app.add_subcommand("view", "Write a page that shows an asset on its source in motion");
  add_name(*view_command, "ASSET", view.asset, "Asset (.sphc)")->required();
  add_name(*view_command, "--source", view.source, "The mesh it was baked from")->required();
  add_output(*view_command, "-o,--output", view.output, "Page to write (.html)")->required();
  add_motion(*view_command, view.motion, view.frames, view.continuous);
  add_with(*view_command, view.with);
  add_radius(*view_command, view.radius);
  add_respond(*view_command, view.respond, view.ahead);
  add_volumes(*view_command, view.volumes, view.at_most, "Colliders to show, as export writes them")
      ->needs("--volumes");
  add_name(*view_command, "--filter", view.filter,
           "What filter wrote: colliders of pairs that need no test do not turn red")
      ->needs("--volumes");
  add_name(*view_command, "--report", view.report, "The report that bake wrote, to show in the page");
  add_name(*view_command, "--validation", view.validation, "What validate --json wrote, to show in the page");
  view_command->add_flag("--force", view.force, "Replace an output file that is not a page");
  view_command->callback([&] { run = [&] { return run_view(view); }; });

  CheckOptions check;
  CLI::App* check_command =
      app.add_subcommand("check", "Say which clips of a library are broken: where, when and how deep");
  check_command
      ->add_option("LIBRARY", check.library,
                   "Characters: files, folders, or a JSON manifest; with --merge folders that --shard wrote")
      ->required()
      ->check(refuse_empty);
  add_output(*check_command, "-o,--output", check.output, "Folder of the report to write")->required();
  add_name(*check_command, "--config", check.config, "JSON file of rules");
  add_output(*check_command, "--baseline", check.baseline, "JSON file of faults that are known or accepted");
  check_command->add_flag("--accept", check.accept, "Accept all faults: write them to the baseline");
  check_command->add_option("--fail-on", check.fail_on, "What makes the exit code 6")
      ->check(CLI::IsMember({"penetration", "new", "none"}))
      ->capture_default_str();
  check_command->add_option("--max-depth", check.max_depth, "Depth in mm up to which any fault is fine")
      ->check(CLI::Range(0.0, 1e6))
      ->check(refuse_nan);
  add_name(*check_command, "--motion", check.motion, "Recording, or a folder of them, to carry over to each character");
  check_command->add_option("--fps", check.fps, "Frames a second (default: each clip's own)")
      ->check(CLI::Range(1e-3, 1e6))
      ->check(refuse_nan);
  add_character(*check_command, check.character);
  add_size(*check_command, check.size);
  add_continuous(*check_command, check.continuous);
  check_command->add_option("--jobs", check.jobs, "Processes at a time (default: one for each core)")
      ->check(CLI::Range(1, 1024));
  add_output(*check_command, "--fix", check.fix,
             "Folder: mend each character with faults into it, as fix does, with these rules and this baseline");
  check_command->add_flag("--folds", check.folds, "List folds, shells and contacts as at rest, too");
  add_name(*check_command, "--cache", check.cache, "Folder that keeps results: what has not changed is not computed");
  add_name(*check_command, "--shard", check.shard, "I/N: check the I-th of N parts, for --merge");
  check_command->add_flag("--merge", check.merge, "Join the results of all shards");
  add_output(*check_command, "--json", check.json, "JSON file to write");
  add_output(*check_command, "--junit", check.junit, "JUnit XML file to write");
  add_output(*check_command, "--sarif", check.sarif, "SARIF file to write");
  check_command->callback([&] { run = [&] { return run_check(check); }; });

  ScoreOptions score;
  CLI::App* score_command = app.add_subcommand("score", "Score clips: exact numbers, and those that papers print");
  score_command->add_option("LIBRARY", score.library, "Characters: files, folders, or a JSON manifest, as for check")
      ->required()
      ->check(refuse_empty);
  add_output(*score_command, "-o,--output", score.output, "Folder to write: score.json, score.csv and a page")
      ->required();
  CLI::Option* score_motion = add_name(*score_command, "--motion", score.motion,
                                       "Recording, or a folder of them, in place of the characters' own clips");
  score_command
      ->add_option("--bodies", score.bodies,
                   "More characters for the same recordings, or MakeHuman's folder of data: people from baby to old")
      ->check(refuse_empty)
      ->needs(score_motion);
  add_name(*score_command, "--clip", score.clip, "One of the characters' own clips: its name or number (default: all)")
      ->excludes(score_motion);
  add_name(*score_command, "--reference", score.reference,
           "What clips are compared with: the name of one, a recording, or a folder of them or a character by names");
  score_command->add_option("--metrics", score.metrics, "Metrics to measure, with commas between (default: all)")
      ->allow_extra_args(false)
      ->delimiter(',')
      ->check(refuse_empty);
  score_command
      ->add_option("--keep-below", score.keep_below,
                   "METRIC=NUMBER, with commas between: list the clips to keep, in which all are below, and the others")
      ->allow_extra_args(false)
      ->delimiter(',')
      ->check(refuse_empty);
  score_command->add_option("--keep-above", score.keep_above, "The same of metrics of which more is better")
      ->allow_extra_args(false)
      ->delimiter(',')
      ->check(refuse_empty);
  score_command->add_option("--fps", score.fps, "Frames a second (default: each clip's own)")
      ->check(CLI::Range(1e-3, 1e6))
      ->check(refuse_nan);
  add_character(*score_command, score.character);
  add_size(*score_command, score.size);
  CLI::Option* score_json = score_command->add_flag("--json", score.json, "Print the JSON in place of a table");
  score_command->add_flag("--csv", score.csv, "Print the CSV in place of a table")->excludes(score_json);
  score_command->callback([&] { run = [&] { return run_score(score); }; });

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return flush(app.exit(help));
  } catch (const CLI::CallForAllHelp& help) {
    return flush(app.exit(help));
  } catch (const CLI::CallForVersion& version) {
    return flush(app.exit(version));
  } catch (const CLI::ParseError& error) {
    // For an unknown command, the library says only that a command is missing.
    const std::vector<std::string> unknown = app.remaining();
    const std::string what = unknown.empty() ? error.what() : "there is no command or option '" + unknown.front() + "'";
    const std::vector<CLI::App*> named = app.get_subcommands();
    const std::string command = named.empty() ? std::string() : named.front()->get_name() + " ";
    return fail(ExitCode::kUsage, what + " (try spherechain " + command + "--help)");
  }
  try {
    const ExitCode code = run();
    for (const std::string& note : take_notes()) say(stderr, "spherechain: note: {}\n", one_line(note));
    return flush(static_cast<int>(code));
  } catch (const Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return flush(0);  // the library's own exception says no more
    return fail(ExitCode::kInternal, std::string("internal error: ") + error.what());
  }
}
