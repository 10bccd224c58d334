// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/size.h"
#include "baker/mesh/error.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// One struct of options and one function a subcommand. They throw Error; what they return is the exit code.

struct BakeOptions {
  std::string input, output, config, report, preview, roles, body, edits, character;
  GivenSize size;
  std::string profile = "balanced";
  int spheres = 0;  // 0: no limit
  bool extremities = false, prop = false, force = false;
};
ExitCode run_bake(const BakeOptions& options);

struct InspectOptions {
  std::string asset;  // with `roles` a character's file
  std::string character;
  bool roles = false;  // print the roles of its rig's nodes
  bool json = false;
};
ExitCode run_inspect(const InspectOptions& options);

struct PlayOptions {
  std::string asset, source, json, palettes;
  MotionChoice motion;
  FrameChoice frames;
  std::string radius = "detect", backend = "auto";
  bool contacts = false, continuous = false, respond = false;
  int ahead = 0;  // frames
};
ExitCode run_play(const PlayOptions& options);

struct ValidateOptions {
  std::string asset, source, json;
  MotionChoice motion;
  FrameChoice frames;
  std::string radius = "detect";
  bool contacts = false, spheres_alone = false, continuous = false;
};
ExitCode run_validate(const ValidateOptions& options);

// A second character beside the first.
struct WithOptions {
  std::string asset, source;  // an empty source is the first's, of one asset
  MotionChoice motion;
  std::vector<double> at;  // left and forward in metres, then degrees; empty: where its file has it
};

struct ViewOptions {
  std::string asset, source, output, report, validation;
  WithOptions with;
  MotionChoice motion;
  FrameChoice frames;
  std::string radius = "detect", volumes, filter;  // empty volumes: no colliders are shown
  int at_most = 0;                                 // as for export
  bool force = false, continuous = false, respond = false;
  int ahead = 0;  // frames
};
ExitCode run_view(const ViewOptions& options);

struct CheckOptions {
  std::vector<std::string> library;  // with `merge` folders of shards
  std::string output, config, baseline, motion, shard, cache, json, junit, sarif, fix, character;
  GivenSize size;
  std::string fail_on = "penetration";
  double max_depth = 0, fps = 0;  // 0: each clip's own
  int jobs = 0;                   // 0: as many as the machine has cores
  bool accept = false, folds = false, merge = false, continuous = false;
};
ExitCode run_check(const CheckOptions& options);

struct FixOptions {
  std::string input, output, clip, motion, keep, baseline, decisions, report, character;
  GivenSize size;
  std::vector<std::string> parts;
  double budget = 25, margin = 1.5;  // degrees; mm
  bool force = false;
};
ExitCode run_fix(const FixOptions& options);

struct ScoreOptions {
  std::vector<std::string> library, bodies, metrics, keep_below, keep_above;
  std::string output, motion, clip, reference, character;
  GivenSize size;
  double fps = 0;  // 0: each clip's own
  bool json = false, csv = false;
};
ExitCode run_score(const ScoreOptions& options);

struct ExportOptions {
  std::string asset, source, motion, format, output, filter, volumes;  // empty volumes: what the format holds best
  GivenSize size;                                                      // the asset's in place of a file's
  int at_most = 0;                                                     // 0: as many as pay
  bool force = false;
};
ExitCode run_export(const ExportOptions& options);
std::vector<std::string> export_formats();

struct FilterOptions {
  std::string asset, source, motion, limits, output;
  int poses = 20000;
};
ExitCode run_filter(const FilterOptions& options);

struct MaskOptions {
  std::string input, output, as = "triangles", character;
  std::vector<std::string> motions;
  double margin = 0.3;  // % of the height
  int random_poses = 0;
  bool force = false;
};
ExitCode run_mask(const MaskOptions& options);
std::vector<std::string> mask_forms();

}  // namespace spherechain::baker
