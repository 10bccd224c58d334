// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/find_faults.h"

#include <algorithm>

#include "baker/os/parallel.h"
#include "baker/play/target.h"

namespace spherechain::baker {
namespace {

constexpr double kSame = 2e-4;  // radians: smaller turns need no new measurement

}  // namespace

FaultFinder::FaultFinder(const AnimatedAsset& animated, const TurnedClip& clip) : animated_(animated), clip_(clip) {
  leave_out({});
  for (std::size_t t = 0; t < thread_count(); ++t) {
    players_.emplace_back(animated.asset(), choose_target("auto"));
    steps_.emplace_back(animated, choose_target("auto"));
  }
}

std::vector<PosePenetration> FaultFinder::look(SkinPlayer& player, double frame, const Turns& turns) const {
  const BonePose bones(animated_.asset(), clip_.pose(frame, turns).deformation);
  player.set_pose(bones.pose());
  std::vector<PosePenetration> out;
  for (const Penetration& found : player.measure_strictly(asked_)) out.push_back({frame, found});
  return out;
}

std::vector<PosePenetration> FaultFinder::in_sequence(const Turns& turns) {
  std::vector<PosePenetration> out;
  for (int f = 0; f < clip_.frames(); ++f) {
    const BonePose bones(animated_.asset(), clip_.pose(f, turns).deformation);
    players_[0].set_pose(bones.pose());
    for (const Penetration& found : players_[0].measure_quickly(nullptr, f > 0)) {
      out.push_back({static_cast<double>(f), found});
    }
  }
  return out;
}

double FaultFinder::volume(double frame, const Penetration& of, const Turns& turns) {
  const BonePose bones(animated_.asset(), clip_.pose(frame, turns).deformation);
  players_[0].set_pose(bones.pose());
  const std::optional<Penetration> found = players_[0].measure_parts(of.part, of.other);
  return found ? std::max(0.0, double{found->measures.volume}) : 0.0;
}

void FaultFinder::leave_out(std::set<std::pair<std::uint32_t, std::uint32_t>> pairs) {
  left_out_ = std::move(pairs);
  asked_ = part_pairs(animated_.asset(), [&](std::uint32_t a, std::uint32_t b) { return !left_out_.contains({a, b}); });
  seen_.clear();
  seen_between_.clear();
}

std::vector<double> FaultFinder::changed(SeenFrames& seen,
                                         const std::vector<std::pair<double, std::vector<Vec3>>>& now) {
  std::vector<double> out;
  for (const auto& [frame, turns] : now) {
    const auto known = seen.find(frame);
    bool is_same = known != seen.end();
    for (std::size_t j = 0; is_same && j < turns.size(); ++j) {
      is_same = (turns[j] - known->second.turns[j]).norm() < kSame;
    }
    if (is_same) continue;
    out.push_back(frame);
    seen[frame] = {turns, {}};
  }
  return out;
}

template <typename Frames>
std::vector<PosePenetration> FaultFinder::found_in(const SeenFrames& seen, const Frames& frames) {
  std::vector<PosePenetration> out;
  for (const auto frame : frames) {
    const std::vector<PosePenetration>& of_it = seen.at(frame).found;
    out.insert(out.end(), of_it.begin(), of_it.end());
  }
  return out;
}

std::vector<PosePenetration> FaultFinder::in_frames(const std::vector<double>& frames, const Turns& turns) {
  std::vector<std::pair<double, std::vector<Vec3>>> now;
  for (const double frame : frames) now.emplace_back(frame, clip_.turns_at(frame, turns));
  const std::vector<double> again = changed(seen_, now);
  std::vector<std::vector<PosePenetration>> found(again.size());
  run_parallel(players_.size(), again.size(),
               [&](std::size_t t, std::size_t i) { found[i] = look(players_[t], again[i], turns); });
  for (std::size_t i = 0; i < again.size(); ++i) seen_[again[i]].found = std::move(found[i]);
  return found_in(seen_, frames);
}

std::vector<std::vector<PosePenetration>> FaultFinder::in_poses(const std::vector<TriedPose>& poses,
                                                                const std::vector<char>& moves) {
  std::vector<std::vector<PosePenetration>> found(poses.size());
  const PartPairBits asked = part_pairs(animated_.asset(), [&](std::uint32_t a, std::uint32_t b) {
    return a != b && (moves[a] != 0 || moves[b] != 0) && !left_out_.contains({a, b});
  });
  run_parallel(players_.size(), poses.size(), [&](std::size_t t, std::size_t i) {
    const BonePose bones(animated_.asset(), clip_.pose_of(poses[i].frame, poses[i].turns).deformation);
    players_[t].set_pose(bones.pose());
    for (const Penetration& one : players_[t].measure_strictly(asked)) {
      found[i].push_back({static_cast<double>(poses[i].frame), one});
    }
  });
  return found;
}

std::vector<PosePenetration> FaultFinder::look_after(std::size_t thread, int frame, const Turns& turns) {
  std::vector<PosePenetration> out;
  if (frame + 1 >= clip_.frames()) return out;
  const std::vector<StepContact> contacts =
      steps_[thread].find(clip_.pose(frame, turns).deformation, clip_.pose(frame + 1, turns).deformation);
  for (const StepContact& contact : contacts) {
    if (contact.at_start != 0 || contact.at_end != 0) continue;
    const double middle = 0.5 * (double{contact.begin} + double{contact.end});
    for (const PosePenetration& penetration : look(players_[thread], frame + middle, turns)) {
      const Penetration& found = penetration.found;
      if (are_of(found, contact.part_a, contact.part_b) && is_fault(found.kind)) out.push_back(penetration);
    }
  }
  return out;
}

std::vector<PosePenetration> FaultFinder::between(const std::vector<int>& frames, const Turns& turns) {
  std::vector<std::pair<double, std::vector<Vec3>>> now;
  for (const int frame : frames) {
    std::vector<Vec3> both = clip_.turns_at(frame, turns);
    const std::vector<Vec3> next = clip_.turns_at(frame + 1, turns);
    both.insert(both.end(), next.begin(), next.end());
    now.emplace_back(frame, std::move(both));
  }
  const std::vector<double> again = changed(seen_between_, now);
  std::vector<std::vector<PosePenetration>> found(again.size());
  run_parallel(players_.size(), again.size(),
               [&](std::size_t t, std::size_t i) { found[i] = look_after(t, static_cast<int>(again[i]), turns); });
  for (std::size_t i = 0; i < again.size(); ++i) seen_between_[again[i]].found = std::move(found[i]);
  return found_in(seen_between_, frames);
}

}  // namespace spherechain::baker
