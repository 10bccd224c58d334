// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "cli/commands.h"
#include "cli/outputs.h"
#include "export/formats.h"
#include "export/ignore_by_filter.h"
#include "import/import.h"
#include "mesh/error.h"
#include "volumes/fit_volumes.h"
#include "volumes/measure.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

struct ExportFormat {
  const char* name;
  const char* volumes;  // what it holds best
  Export (*of_colliders)(const Colliders&);
  Export (*of_source)(const Colliders&, const SourceGlb&);  // of a format that is written into the source
};

constexpr ExportFormat kExportFormats[] = {
    {"capsules.json", "cones", export_json, nullptr},
    {"vrm", "capsules", nullptr, export_vrm},
    {"khr", "cones", nullptr, export_khr},
    {"omi", "cones", nullptr, export_omi},
    {"mjcf", "capsules", export_mjcf, nullptr},
    {"urdf", "spheres", export_urdf, nullptr},
    {"xrdf", "spheres", export_xrdf, nullptr},
    {"curobo", "spheres", export_curobo, nullptr},
    {"usd", "cones", export_usd, nullptr},
    {"godot", "capsules", export_godot, nullptr},
    {"unity", "capsules", export_unity, nullptr},
    {"unreal", "capsules", export_unreal, nullptr},
};

const ExportFormat& format_of(const std::string& name) {
  return *std::find_if(std::begin(kExportFormats), std::end(kExportFormats),
                       [&](const ExportFormat& format) { return format.name == name; });
}

SourceGlb read_source_glb(const OpenAsset& asset, const ExportOptions& options) {
  const SourceMesh source = read_source(options.source);
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

// What this tool wrote says so in its first lines.
void check_ours(const std::string& file, bool force) {
  std::error_code ignored;
  if (force || !fs::is_regular_file(file, ignored) || fs::file_size(file, ignored) == 0) return;
  std::string start(4096, '\0');
  std::ifstream(file, std::ios::binary).read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start.find("spherechain") == std::string::npos) {
    throw Error(ExitCode::kFile, file + ": is there already, and not of this tool (--force replaces it)");
  }
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
  check_outputs(with_source({{"ASSET", options.asset}, {"--filter", options.filter}}, "--source", options.source),
                {{"--output", options.output}});
  if (format.of_source != nullptr) {
    if (options.source.empty()) throw Error(ExitCode::kUsage, "--to " + options.format + " needs --source");
    check_replaceable(options.output, "glTF", "a binary glTF", options.force);
  } else {
    check_ours(options.output, options.force);
  }
  const OpenAsset asset = open_asset(options.asset);
  const std::string shape = options.volumes.empty() ? format.volumes : options.volumes;
  Colliders colliders = fit_volumes(asset, volume_shape(shape), options.at_most);
  if (!options.filter.empty()) ignore_by_filter(read_part_filter(options.filter, asset), colliders);
  Export made = format.of_source != nullptr ? format.of_source(colliders, read_source_glb(asset, options))
                                            : format.of_colliders(colliders);
  std::vector<std::string> names;
  for (const ExportFile& file : made.files) {
    fs::path name = options.output;
    if (!file.ending.empty() && file.ending.front() == '.') name.replace_extension(file.ending);
    if (!file.ending.empty() && file.ending.front() != '.') name.replace_filename(file.ending);
    names.push_back(name.string());
    if (!file.ending.empty()) check_ours(names.back(), options.force);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0 && names[i] == options.output) {
      throw Error(ExitCode::kUsage, options.output + ": --to " + options.format +
                                        " writes a second file of this name " + "(give -o another ending)");
    }
    name_output(made.files[i].bytes, made.stem_mark, options.output);
  }
  for (std::size_t i = 0; i < names.size(); ++i) write_atomically(names[i], made.files[i].bytes);
  const ColliderFit fit = measure_fit(asset, colliders);
  fmt::print("{} volumes ({}) on {} body parts; {} pairs of parts are not tested\n", fit.volumes, shape, fit.bodies,
             colliders.ignored.size());
  fmt::print("at rest: {}; volume {:.0f} % of the body's\n", fit_text(fit), 100 * fit.volume_ratio);
  if (!options.source.empty()) {
    const AnimatedAsset animated(open_asset(options.asset), options.asset, options.source, {}, {});
    if (animated.clips().size() > 1 || animated.frame_count() > 1) {
      fmt::print("on its clips: {}\n", fit_text(measure_fit(animated, colliders, kFramesMeasured)));
    }
  }
  for (const std::string& note : made.notes) fmt::print("note: {}\n", note);
  for (const std::string& name : names) fmt::print("wrote {}\n", name);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
