// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/steps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "baker/play/asset_file.h"
#include "baker/play/skin_player.h"
#include "runtime/src/step/step_job.h"

namespace spherechain::baker {
namespace {

constexpr double kPartsMax = 64;     // of a step
constexpr double kApart = 1.0 / 16;  // of a step: nearer to each other they share a frame

}  // namespace

StepPlayer::StepPlayer(const AnimatedAsset& animated, Target target)
    : animated_(animated), target_(target), joints_(animated) {}

const std::vector<StepContact>& StepPlayer::find(const Deformation& from, const Deformation& to) {
  const OpenAsset& asset = animated_.asset();
  StepJob job;
  job.a.body.asset = asset.handle();
  job.a.body.skin_table = asset.skin_table();
  job.target = target_;
  std::vector<sc_transform> joints[2];
  std::vector<float> vertices[2], morphs[2];
  const Deformation* const ends[] = {&from, &to};
  sc_pose* const poses[] = {&job.a.body.pose, &job.a.end};
  bool has_joints = moved_by_bones(asset, from) && moved_by_bones(asset, to);
  for (int end = 0; end < 2 && has_joints; ++end) {
    joints[end] = joints_.joints_of(*ends[end]);
    has_joints = !joints[end].empty();
  }
  for (int end = 0; end < 2; ++end) {
    if (has_joints) {
      morphs[end].assign(ends[end]->morphs.begin(), ends[end]->morphs.end());
      morphs[end].resize(asset->morph_count());
      poses[end]->morph_weights = morphs[end].empty() ? nullptr : morphs[end].data();
      poses[end]->morph_weight_count = morphs[end].size();
    } else {
      vertices[end] = pack(animated_.positions(*ends[end]));
      *poses[end] = pose_of(vertices[end]);
    }
  }
  if (has_joints) {
    job.a.blend = SC_BLEND_SLERP;
    job.a.start_joints = joints[0].data();
    job.a.end_joints = joints[1].data();
    job.a.joint_count = joints[0].size();
    job.a.parents = joints_.parents().data();
    job.a.joint_of_bone = joints_.joint_of_bone().data();
  }
  scratch_.resize(std::max(scratch_.size(), step_scratch_words(&job.a, nullptr)));
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();
  contacts_.resize(std::max<std::size_t>(contacts_.capacity(), 64));
  for (;;) {
    job.contacts = contacts_.data();
    job.contact_capacity = contacts_.size();
    const Status status = job.run();
    if (status.code != SC_OVERFLOW) check_runtime(status);
    const bool fits = job.contact_count <= contacts_.size();
    contacts_.resize(job.contact_count);
    if (fits) return contacts_;
  }
}

namespace {

// Tries poses along the step and takes the one in which two body parts are deepest while they touch. If they touch in
// no pose (one part may be wholly inside the other), takes the first time of contact.
double deepest_share(const AnimatedAsset& animated, int frame, const StepContact& contact, SkinPlayer& player) {
  constexpr int kParts = 8;
  double share = double{contact.begin}, most = -1;
  for (int k = 1; k < kParts; ++k) {
    const double at = double{contact.begin} + k * (double{contact.end} - double{contact.begin}) / kParts;
    const Deformation deformation =
        animated.deformation(frame_between(animated.frame_at(frame), animated.frame_at(frame + 1), at));
    const SkinPose skin(animated, deformation);
    player.set_pose(skin.pose());
    for (const Penetration& found : player.measure_quickly()) {
      if (are_of(found, contact.part_a, contact.part_b) && double{found.measures.depth} > most) {
        most = double{found.measures.depth};
        share = at;
      }
    }
  }
  return share;
}

// Finds contacts between a frame and the next that neither frame has. The motion goes through the clip's own keys, in
// `parts` steps a frame.
std::vector<StepContact> find_between(const AnimatedAsset& animated, int frame, const Deformation& from,
                                      const Deformation& to, int parts, StepPlayer& steps) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, StepContact> found;
  Deformation before = from;
  for (int k = 0; k < parts; ++k) {
    const auto share = [&](double t) { return (k + t) / parts; };
    Deformation next =
        k + 1 == parts
            ? to
            : animated.deformation(frame_between(animated.frame_at(frame), animated.frame_at(frame + 1), share(1)));
    for (StepContact contact : steps.find(before, next)) {
      contact.begin = static_cast<float>(share(double{contact.begin}));
      contact.end = static_cast<float>(share(double{contact.end}));
      contact.at_start = k == 0 ? contact.at_start : 0;
      contact.at_end = k + 1 == parts ? contact.at_end : 0;
      const auto [known, is_new] = found.try_emplace({contact.part_a, contact.part_b}, contact);
      if (is_new) continue;
      known->second.at_end = contact.at_end;
      known->second.end = contact.end;
    }
    before = std::move(next);
  }
  std::vector<StepContact> out;
  for (const auto& [pair, contact] : found) {
    if (contact.at_start == 0 && contact.at_end == 0) out.push_back(contact);
  }
  return out;
}

}  // namespace

void look_between_frames(AnimatedAsset& animated, Target target, std::size_t clip,
                         const std::function<void(int)>& progress) {
  animated.check_clusters();
  StepPlayer steps(animated, target);
  SkinPlayer player(animated.asset(), target);
  std::vector<std::vector<double>> between(static_cast<std::size_t>(animated.frame_count()));
  Deformation before;
  const int first = animated.clips()[clip].first, end = first + animated.clips()[clip].count;
  for (int i = first; i < end; ++i) {
    progress(i);
    Deformation deformation = animated.deformation(i);
    if (i > first) {
      std::vector<double>& shares = between[static_cast<std::size_t>(i - 1)];
      const double seconds = animated.time(i) - animated.time(i - 1);
      const double parts = std::clamp(std::ceil(seconds * animated.own_rate(clip) - 0.01), 1.0, kPartsMax);
      for (const StepContact& contact :
           find_between(animated, i - 1, before, deformation, static_cast<int>(parts), steps)) {
        shares.push_back(deepest_share(animated, i - 1, contact, player));
      }
      std::sort(shares.begin(), shares.end());
      const auto is_near = [](double l, double r) { return r - l < kApart; };
      shares.erase(std::unique(shares.begin(), shares.end(), is_near), shares.end());
    }
    before = std::move(deformation);
  }
  animated.put_between(between);
}

void look_between_frames(AnimatedAsset& animated, Target target, const std::function<void(int)>& progress) {
  for (std::size_t clip = 0; clip < animated.clips().size(); ++clip)
    look_between_frames(animated, target, clip, progress);
}

}  // namespace spherechain::baker
