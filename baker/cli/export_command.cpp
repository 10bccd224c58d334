// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/outputs.h"
#include "baker/export/formats.h"
#include "baker/export/glb_json.h"
#include "baker/export/ignore_by_filter.h"
#include "baker/export/joint_tables.h"
#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "baker/os/written_file.h"
#include "baker/pipeline/pipeline.h"
#include "baker/play/play.h"
#include "baker/report/report.h"
#include "baker/volumes/fit_volumes.h"
#include "baker/volumes/measure.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

struct ExportFormat {
  const char* name;
  const char* volumes;               // what it holds best
  std::vector<std::string> endings;  // of its file
  Export (*of_colliders)(const Colliders&);
  Export (*of_source)(const Colliders&, const SourceGlb&);  // of a format that is written into the source
  // The clips of a format that has joints.
  std::vector<ExportFile> (*of_clips)(const Colliders&, const std::vector<PosedClip>&) = nullptr;
};

const ExportFormat kExportFormats[] = {
    {"capsules.json", "cones", {".json"}, export_json, nullptr},
    {"vrm", "capsules", {".vrm", ".glb"}, nullptr, export_vrm},
    {"khr", "cones", {".glb", ".vrm"}, nullptr, export_khr},
    {"omi", "cones", {".glb", ".vrm"}, nullptr, export_omi},
    {"mjcf", "capsules", {".xml", ".mjcf"}, export_mjcf, nullptr, mjcf_joint_tables},
    {"urdf", "spheres", {".urdf", ".xml"}, export_urdf, nullptr, urdf_joint_tables},
    {"xrdf", "spheres", {".xrdf", ".yaml", ".yml"}, export_xrdf, nullptr},
    {"curobo", "spheres", {".yml", ".yaml"}, export_curobo, nullptr},
    {"usd", "cones", {".usda", ".usd"}, export_usd, nullptr},
    {"godot", "capsules", {".tscn"}, export_godot, nullptr},
    {"unity", "capsules", {".json"}, export_unity, nullptr},
    {"unreal", "capsules", {".json"}, export_unreal, nullptr},
};

const ExportFormat& format_of(const std::string& name) {
  return *std::find_if(std::begin(kExportFormats), std::end(kExportFormats),
                       [&](const ExportFormat& format) { return format.name == name; });
}

SourceGlb read_source_glb(const OpenAsset& asset, const ExportOptions& options) {
  // Read as for the bake: other options bind other bones.
  const SourceMesh source = read_source(options.source, settings_of(asset, options.asset).import);
  SourceGlb out{read_as_glb(options.source), {}};
  const std::size_t bones = asset->info().bone_count;
  for (std::size_t i = 0; i < bones; ++i) {
    const bool is_there = i < source.rig.bones.size();
    if (!is_there && asset->bone(i).is_rest) {
      out.node_of_bone.push_back(-1);
      continue;
    }
    const std::string name = is_there ? source.rig.nodes[source.rig.bones[i].node].name : std::string();
    if (!is_there || name != asset->bone(i).name) {
      throw Error(ExitCode::kFile, options.source + ": has not the bones of " + options.asset +
                                       " (name the file that it was baked from; one that has bones of its own)");
    }
    out.node_of_bone.push_back(source.rig.nodes[source.rig.bones[i].node].in_file);
  }
  return out;
}

constexpr int kFramesMeasured = 100;

std::string fit_text(const ColliderFit& fit) {
  return fmt::format(
      "{:.0f} % of the skin is inside; its distance is {:.1f} mm on average, {:.1f} mm at the 95th "
      "percentile",
      100 * fit.coverage, 1000 * fit.gap_mean, 1000 * fit.gap_95);
}

// Programs choose how to read a file by its ending.
void check_ending(const ExportFormat& format, const std::string& output) {
  const std::string ending = fs::path(output).extension().string();
  if (std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end()) return;
  throw Error(ExitCode::kUsage, fmt::format("-o {}: --to {} writes a file that ends in {}", output, format.name,
                                            fmt::join(format.endings, " or ")));
}

void say_how_sure(const PartFilter& filter) {
  double at_most = 0;
  for (const FilteredPair& pair : filter.pairs) {
    if (pair.kind == PairKind::kNever) at_most = std::max(at_most, pair.at_most);
  }
  if (at_most == 0) return;
  say("by the filter: parts that met in none of {} poses are not tested; some may meet in up to {:.2g} % of all "
      "poses\n",
      filter.clip_poses + filter.random_poses, 100 * at_most);
}

// Bodies are rigid: a tail of many bones bends out of its volumes.
void say_what_leaves(const Colliders& colliders, const ColliderFit& fit) {
  constexpr double kFollows = 0.6;
  std::vector<std::string> leave;
  for (std::size_t i = 0; i < fit.coverage_of_body.size(); ++i) {
    if (fit.coverage_of_body[i] >= kFollows) continue;
    leave.push_back(fmt::format("{} ({:.0f} % inside)", colliders.bodies[i].name, 100 * fit.coverage_of_body[i]));
  }
  if (!leave.empty()) say("parts that leave the volumes there: {}\n", fmt::join(leave, ", "));
}

void name_output(std::string& bytes, const std::string& mark, const std::string& output) {
  const std::string stem = fs::path(output).stem().string();
  for (std::size_t at = 0; !mark.empty() && (at = bytes.find(mark, at)) != std::string::npos; at += stem.size()) {
    bytes.replace(at, mark.size(), stem);
  }
}

}  // namespace

std::vector<std::string> export_formats() {
  std::vector<std::string> out;
  for (const ExportFormat& format : kExportFormats) out.emplace_back(format.name);
  return out;
}

ExitCode run_export(const ExportOptions& options) {
  const ExportFormat& format = format_of(options.format);
  const MotionChoice motion{{}, {}, options.motion};
  const std::vector<CommandFile> inputs = with_motion(
      with_source({{"ASSET", options.asset}, {"--filter", options.filter}}, "--source", options.source), motion);
  const FileKind kind = format.of_source != nullptr ? FileKind::kGlb : FileKind::kColliders;
  const Force force = options.force ? Force::kGiven : Force::kOffered;
  std::vector<OutputFile> outputs{{"--output", options.output, kind}};
  check_outputs(inputs, outputs, force);
  if (format.of_source != nullptr && options.source.empty()) {
    throw Error(ExitCode::kUsage, "--to " + options.format + " needs --source");
  }
  check_ending(format, options.output);
  // Errors in the files are reported before the fit, which takes seconds.
  const auto open = [&] {
    OpenAsset out = open_asset(options.asset);
    out.resize(options.size);
    return out;
  };
  const OpenAsset asset = open();
  std::optional<PartFilter> filter;
  if (!options.filter.empty()) filter = read_part_filter(options.filter, asset);
  std::optional<AnimatedAsset> animated;
  if (!options.source.empty()) animated.emplace(open(), options.asset, options.source, motion, FrameChoice());
  SourceGlb source;
  if (format.of_source != nullptr) source = read_source_glb(asset, options);
  const std::string shape = options.volumes.empty() ? format.volumes : options.volumes;
  Colliders colliders = fit_volumes(asset, volume_shape(shape), options.at_most);
  if (filter) ignore_by_filter(*filter, colliders);
  std::vector<PosedClip> clips;
  if (animated && format.of_clips != nullptr) {
    clips = posed_clips(*animated, colliders);
    if (clips.empty() && !options.motion.empty()) {
      throw Error(ExitCode::kFile, options.motion + ": moves no bones, so joints have no angles");
    }
    if (!options.motion.empty()) clips.front().name = fs::path(options.motion).stem().string();
  }
  const std::string slides = allow_motion(clips, colliders);
  Export made = format.of_source != nullptr ? format.of_source(colliders, source) : format.of_colliders(colliders);
  if (!slides.empty()) made.notes.push_back(slides);
  if (format.of_clips != nullptr) {
    for (ExportFile& table : format.of_clips(colliders, clips)) made.files.push_back(std::move(table));
  }
  for (std::size_t i = 0; i < made.files.size(); ++i) {
    const std::string& ending = made.files[i].ending;
    name_output(made.files[i].bytes, made.stem_mark, options.output);
    if (ending.empty()) continue;
    fs::path name = options.output;
    ending.front() == '.' ? name.replace_extension(ending) : name.replace_filename(ending);
    const FileKind beside = name.extension() == ".csv" ? FileKind::kTable : FileKind::kColliders;
    outputs.push_back({"the file beside it", name.string(), beside});
  }
  check_outputs(inputs, outputs, force);
  for (std::size_t i = 0; i < outputs.size(); ++i) write_atomically(outputs[i].path, made.files[i].bytes);
  const ColliderFit fit = measure_fit(asset, colliders);
  say("{} volumes ({}) on {} body parts; {} pairs of parts are not tested\n", fit.volumes, shape, fit.bodies,
      colliders.ignored.size());
  if (filter) say_how_sure(*filter);
  say("at rest: {}; volume {:.0f} % of the body's\n", fit_text(fit), 100 * fit.volume_ratio);
  if (animated && animated->frame_count() > 1) {
    const ColliderFit moving = measure_fit(*animated, colliders, kFramesMeasured);
    say("on its clips: {}\n", fit_text(moving));
    say_what_leaves(colliders, moving);
  }
  if (!options.size.is_given() && !settings_of(asset, options.asset).size.is_given()) {
    std::vector<std::string> parts;
    for (const ColliderBody& body : colliders.bodies) parts.push_back(body.name);
    if (const std::string note = unit_note(colliders.height, parts); !note.empty()) {
      say("note: {}: {}\n", colliders.source_file, note);
    }
  }
  for (const std::string& note : made.notes) say("note: {}\n", note);
  for (const OutputFile& file : outputs) say("wrote {}\n", file.path);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
