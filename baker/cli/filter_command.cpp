// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "baker/cli/commands.h"
#include "baker/cli/console.h"
#include "baker/cli/outputs.h"
#include "baker/cli/progress.h"
#include "baker/filter/confidence.h"
#include "baker/filter/find_filter.h"
#include "baker/filter/joint_limits.h"
#include "baker/filter/srdf.h"
#include "baker/mesh/error.h"
#include "baker/os/written_file.h"
#include "baker/play/target.h"

namespace spherechain::baker {
namespace {

std::string poses_text(int count) { return fmt::format("{} pose{}", count, count == 1 ? "" : "s"); }

// A percentage to three digits.
std::string percent_text(double share) { return fmt::format("{:.3g} %", 100 * share); }

// The pairs of one kind, those that touch most often first.
std::string rows_text(const PartFilter& filter, PairKind kind) {
  std::vector<FilteredPair> pairs;
  std::copy_if(filter.pairs.begin(), filter.pairs.end(), std::back_inserter(pairs),
               [&](const FilteredPair& pair) { return pair.kind == kind; });
  std::stable_sort(pairs.begin(), pairs.end(), [](const FilteredPair& a, const FilteredPair& b) {
    return std::pair(a.random_poses, a.clip_poses) > std::pair(b.random_poses, b.clip_poses);
  });
  std::string out;
  for (const FilteredPair& pair : pairs) {
    out += fmt::format("  {:<18} {:<18} {:>7} {:>8}   {}\n", filter.parts[pair.parts[0]], filter.parts[pair.parts[1]],
                       pair.clip_poses, pair.random_poses, percent_text(pair.at_most));
  }
  return out;
}

std::string filter_text(const PartFilter& filter) {
  std::string out = fmt::format("{} body parts, {} pairs; {} of clips, {} at random\n", filter.parts.size(),
                                filter.pairs.size(), poses_text(filter.clip_poses), poses_text(filter.random_poses));
  for (const auto& [kind, what] :
       {std::pair{PairKind::kAdjacent, "one hangs on the other"}, std::pair{PairKind::kNever, "met in no pose"},
        std::pair{PairKind::kAlways, "intersect in every pose"}, std::pair{PairKind::kRest, "intersect at rest"},
        std::pair{PairKind::kSometimes, "intersect in some poses"}}) {
    const auto count = std::count_if(filter.pairs.begin(), filter.pairs.end(),
                                     [kind = kind](const FilteredPair& pair) { return pair.kind == kind; });
    out += fmt::format("{:<10} {:>5}  {}", kind_name(kind), count, what);
    if (kind == PairKind::kNever && count > 0 && filter.random_poses > 0) {
      out += fmt::format(": each in fewer than {} of such random poses, at {:.0f} %",
                         percent_text(upper_bound_of_share(0, filter.random_poses)), 100 * kConfidence);
    }
    out += '\n';
  }
  const auto to_test = std::count_if(filter.pairs.begin(), filter.pairs.end(),
                                     [](const FilteredPair& pair) { return needs_test(pair.kind); });
  out += fmt::format("{} pairs need testing\n", to_test);
  if (filter.random_poses > 0) {
    out += filter.settled_after > 0
               ? fmt::format("the first {} at random give the same answer\n", poses_text(filter.settled_after))
               : std::string("no random pose was needed for this answer\n");
  }
  const std::string rows = rows_text(filter, PairKind::kAlways) + rows_text(filter, PairKind::kRest) +
                           rows_text(filter, PairKind::kSometimes);
  if (rows.empty()) return out;
  return out +
         fmt::format("\n  {:<37} {:>7} {:>8}   {}\n", "poses in which skins intersect", "clips", "random", "at most") +
         rows;
}

}  // namespace

ExitCode run_filter(const FilterOptions& options) {
  const MotionChoice recording{{}, {}, options.motion};
  const bool is_srdf = has_ending(options.output, ".srdf");
  check_outputs(
      with_motion(with_source({{"ASSET", options.asset}, {"--limits", options.limits}}, "--source", options.source),
                  recording),
      {{"--output", options.output, is_srdf ? FileKind::kColliders : FileKind::kJson}}, Force::kNone);
  const FrameChoice own_frames{0, 0};
  AnimatedAsset animated(options.asset, options.source, {}, own_frames);
  animated.check_clusters();
  if (is_srdf && !animated.character().rig.robot.is_robot) {
    throw Error(ExitCode::kUsage, "-o: " + options.output + ": an SRDF is written of a robot alone (name it .json)");
  }
  RandomPoses poses(animated.character(), joints_of(animated.asset()));
  if (!options.limits.empty()) read_joint_limits(options.limits, poses);
  FilterSearch search(animated, choose_target("auto"));
  {
    Progress progress("filter " + options.asset + ":");
    const auto count_poses = [&](const char* what, int count) {
      return [&progress, what, count](int done) { progress.show(fmt::format("{} {} of {}", what, done, count)); };
    };
    if (!animated.character().rig.clips.empty()) search.look_at_frames(count_poses("frame", animated.frame_count()));
    if (!options.motion.empty()) {
      animated.play(recording, own_frames);
      search.look_at_frames(count_poses("frame", animated.frame_count()));
    }
    if (poses.any() && animated.asset()->bone_count() > 0) {
      search.look_at_random(poses, options.poses, count_poses("random pose", options.poses));
    }
  }
  const PartFilter filter = search.result();
  if (!options.output.empty()) {
    write_atomically(options.output, is_srdf ? srdf_of(filter, animated.character().rig)
                                             : part_filter_json(filter, animated.asset(), options.asset));
  }
  say("{}", filter_text(filter));
  if (!options.output.empty()) say("wrote {}\n", options.output);
  return ExitCode::kDone;
}

}  // namespace spherechain::baker
