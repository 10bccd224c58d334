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

// For each of the asset's bones the nearest one above it; -1: no bone.
std::vector<int> bone_parents(const AnimatedAsset& animated) {
  const OpenAsset& asset = animated.asset();
  const SourceRig& rig = animated.character().rig;
  std::vector<int> out(asset->bone_count(), -1);
  if (rig.bones.empty()) {
    for (std::size_t b = 0; b < std::min(out.size(), asset->joint_count()); ++b) {
      if (std::string(asset->joint(b).name) == asset->bone(b).name) out[b] = asset->joint(b).parent;
    }
    return out;
  }
  std::vector<int> bone_of(rig.nodes.size(), -1);
  for (std::size_t b = 0; b < rig.bones.size(); ++b) bone_of[rig.bones[b].node] = static_cast<int>(b);
  std::vector<int> above(rig.nodes.size(), -1);  // a node's nearest bone above
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    if (rig.nodes[n].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(rig.nodes[n].parent);
    above[n] = bone_of[parent] >= 0 ? bone_of[parent] : above[parent];
  }
  for (std::size_t b = 0; b < std::min(out.size(), rig.bones.size()); ++b) out[b] = above[rig.bones[b].node];
  return out;
}

// How many are above each; a parent may come after its children.
std::vector<std::size_t> depths_of(const std::vector<int>& parents) {
  std::vector<std::size_t> depths(parents.size(), 0), way;
  std::vector<bool> is_known(parents.size(), false);
  for (std::size_t b = 0; b < parents.size(); ++b) {
    for (int up = static_cast<int>(b); up >= 0 && !is_known[static_cast<std::size_t>(up)];
         up = parents[static_cast<std::size_t>(up)]) {
      way.push_back(static_cast<std::size_t>(up));
    }
    for (; !way.empty(); way.pop_back()) {
      const int parent = parents[way.back()];
      depths[way.back()] = parent < 0 ? 0 : depths[static_cast<std::size_t>(parent)] + 1;
      is_known[way.back()] = true;
    }
  }
  return depths;
}

Affine affine_of(const float* rows) {
  Affine out;
  for (Eigen::Index i = 0; i < 12; ++i) out(i / 4, i % 4) = double{rows[i]};
  return out;
}

sc_transform transform_of(const Affine& local) {
  Node node;
  node.local = local;
  decompose(node);
  const auto to_float = [](const Vec3& v) {
    return spherechain::Vec3{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
  };
  const Eigen::Quaterniond& q = node.rotation;
  return {to_float(node.translation),
          {static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z()), static_cast<float>(q.w())},
          to_float(node.scale)};
}

bool is_sheared(const Affine& local) {
  const Eigen::Matrix3d gram = local.linear().transpose() * local.linear();
  const Vec3 sizes = gram.diagonal().cwiseSqrt();
  const auto share = [&](Eigen::Index i, Eigen::Index j) { return std::abs(gram(i, j)) / (sizes[i] * sizes[j]); };
  return !(std::max({share(0, 1), share(1, 2), share(2, 0)}) < 1e-4);
}

}  // namespace

StepPlayer::StepPlayer(const AnimatedAsset& animated, Target target) : animated_(animated), target_(target) {
  const OpenAsset& asset = animated.asset();
  const std::vector<int> parents = bone_parents(animated);
  const std::vector<std::size_t> depths = depths_of(parents);
  for (std::size_t b = 0; b < parents.size(); ++b) {
    binds_.push_back(asset->bone(b).is_rest ? Affine::Identity() : affine_of(asset->bone(b).inverse_bind).inverse());
    order_.push_back(b);
  }
  std::stable_sort(order_.begin(), order_.end(), [&](auto l, auto r) { return depths[l] < depths[r]; });
  joint_of_bone_.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) joint_of_bone_[order_[i]] = static_cast<std::uint32_t>(i);
  for (const std::size_t b : order_) {
    parents_.push_back(parents[b] < 0 ? SC_NO_JOINT : joint_of_bone_[static_cast<std::size_t>(parents[b])]);
  }
}

// Empty where one is sheared, which no joint can be.
std::vector<sc_transform> StepPlayer::joints_of(const Deformation& deformation) const {
  const auto world = [&](std::size_t b) -> Affine {
    return b < deformation.bones.size() ? deformation.bones[b] * binds_[b] : binds_[b];
  };
  std::vector<sc_transform> out;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::uint32_t parent = parents_[i];
    const Affine local =
        parent == SC_NO_JOINT ? world(order_[i]) : Affine(world(order_[parent]).inverse() * world(order_[i]));
    if (is_sheared(local)) return {};
    out.push_back(transform_of(local));
  }
  return out;
}

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
    joints[end] = joints_of(*ends[end]);
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
    job.a.parents = parents_.data();
    job.a.joint_of_bone = joint_of_bone_.data();
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
