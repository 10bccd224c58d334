// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/responder.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr double kFaultDepth = 0.003 / 1.75, kMoved = 0.003;  // shares of the height

double height_of(const AnimatedAsset& animated) { return animated.frame().height; }

// The root mean square of second differences, of all places together.
double acceleration(const std::vector<std::vector<Vec3>>& track) {
  double sum = 0;
  for (std::size_t f = 2; f < track.size(); ++f) {
    for (std::size_t p = 0; p < track[f].size(); ++p) {
      sum += (track[f][p] - 2 * track[f - 1][p] + track[f - 2][p]).squaredNorm();
    }
  }
  return sum;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(static_cast<std::size_t>(share * static_cast<double>(values.size())), values.size() - 1)];
}

}  // namespace

Responder::Responder(const AnimatedAsset& animated, Target target, int ahead)
    : animated_(animated), target_(target), ahead_(ahead), joints_(animated), judge_(animated.asset(), target) {
  const OpenAsset& asset = animated.asset();
  if (asset->bone_count() == 0 || animated.bone_names().empty()) {
    throw Error(ExitCode::kFile, animated.file() + ": no bones move it here, so no joint can be turned (choose a " +
                                     "motion of its own skeleton, or a recording)");
  }
  is_arm_.resize(asset->part_count());
  for (std::uint32_t part = 0; part < asset->part_count(); ++part) {
    const std::string_view name = asset.model().part_name(part);
    const std::int32_t bone = asset.model().part(part).bone;
    is_arm_[part] = name.ends_with(" upper arm") || name.ends_with(" forearm") || name.ends_with(" hand");
    if (name.ends_with(" hand") && bone >= 0) wrists_.push_back(static_cast<std::size_t>(bone));
    if (name.ends_with(" forearm") && bone >= 0) elbows_.push_back(static_cast<std::size_t>(bone));
  }
  if (std::find(is_arm_.begin(), is_arm_.end(), true) == is_arm_.end()) {
    throw Error(ExitCode::kFile, animated.file() +
                                     ": has no arms, which the response turns (body parts that end with " +
                                     "'upper arm', 'forearm' or 'hand')");
  }
  body_ = Body(asset.model());
  check_runtime(body_.status());
  const std::vector<std::uint32_t>& joint = joints_.joint_of_bone();
  std::vector<std::uint32_t> parents(joint.size()), bone_of(joint.size());
  for (std::uint32_t b = 0; b < joint.size(); ++b) bone_of[joint[b]] = b;
  for (std::size_t b = 0; b < joint.size(); ++b) {
    const std::uint32_t above = joints_.parents()[joint[b]];
    parents[b] = above == SC_NO_JOINT ? SC_NO_JOINT : bone_of[above];
  }
  ResponseDef def;
  def.parents = parents.data();
  def.joint_count = parents.size();
  response_ = Response(body_, def);
  check_runtime(response_.status());
}

// By bone.
std::vector<sc_transform> Responder::joints_at(const MotionFrame& frame) const {
  const std::vector<sc_transform> joints = joints_.joints_of(animated_.deformation(frame));
  if (joints.empty()) {
    throw Error(ExitCode::kFile, animated_.file() + ": a joint is sheared, which a response cannot turn");
  }
  std::vector<sc_transform> out;
  for (const std::uint32_t joint : joints_.joint_of_bone()) out.push_back(joints[joint]);
  return out;
}

Responder::Ends Responder::ends_of(const Deformation& deformation) const {
  Ends out;
  for (const std::size_t bone : wrists_) out.wrists.push_back(joints_.place_of(deformation, bone));
  for (const std::size_t bone : elbows_) out.elbows.push_back(joints_.place_of(deformation, bone));
  return out;
}

std::vector<Penetration> Responder::faults_of(const Deformation& deformation) {
  const BonePose pose(animated_.asset(), deformation);
  judge_.set_pose(pose.pose());
  std::vector<Penetration> out;
  for (const Penetration& found : judge_.measure_as_games()) {
    const bool is_of_arm = is_arm_[found.part] || is_arm_[found.other];
    const double least = kFaultDepth * static_cast<double>(found.measures.height);
    if (is_of_arm && is_fault(found.kind) && found.measures.relation != SC_RELATION_JOINED &&
        static_cast<double>(found.measures.depth) >= least) {
      out.push_back(found);
    }
  }
  return out;
}

Deformation Responder::respond(int frame) {
  const MotionFrame& now = animated_.frame_at(frame);
  const bool starts_clip = frame == 0 || animated_.frame_at(frame - 1).clip != now.clip;
  if (starts_clip) state_ = {};
  int last_ahead = frame;
  while (last_ahead < frame + ahead_ && last_ahead + 1 < animated_.frame_count() &&
         animated_.frame_at(last_ahead + 1).clip == now.clip) {
    ++last_ahead;
  }
  Deformation deformation = animated_.deformation(frame);
  std::vector<sc_transform> joints = joints_at(now), ahead;
  const std::vector<float> morphs(deformation.morphs.begin(), deformation.morphs.end());
  ResponseFrame asked;
  asked.joints = joints.data();
  asked.morph_weights = morphs.empty() ? nullptr : morphs.data();
  asked.morph_weight_count = morphs.size();
  asked.seconds =
      starts_clip ? 0 : static_cast<float>(std::clamp(now.seconds - animated_.frame_at(frame - 1).seconds, 0.0, 1.0));
  asked.target = target_;
  if (ahead_ > 0) {
    ahead = joints_at(animated_.frame_at(last_ahead));
    asked.ahead = ahead.data();
    asked.ahead_frames = static_cast<std::uint32_t>(ahead_);
  }
  const auto start = std::chrono::steady_clock::now();
  check_runtime(response_.respond(state_, asked));
  const double us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  Frame seen{};
  seen.us = us;
  seen.starts_clip = starts_clip;
  seen.before = seen.after = ends_of(deformation);
  const std::vector<Penetration> before = faults_of(deformation);
  std::vector<Penetration> after = before;
  if (asked.turned > 0) {
    std::vector<sc_transform> sorted(joints.size());
    for (std::size_t b = 0; b < joints.size(); ++b) sorted[joints_.joint_of_bone()[b]] = joints[b];
    const std::vector<Affine> bones = joints_.bones_of(sorted);
    for (std::size_t b = 0; b < deformation.bones.size(); ++b) deformation.bones[b] = bones[b];
    seen.after = ends_of(deformation);
    after = faults_of(deformation);
  }
  seen.is_faulty_before = !before.empty();
  seen.is_faulty_after = !after.empty();
  for (const Penetration& fault : after) {
    seen.depth = std::max(seen.depth, static_cast<double>(fault.measures.depth));
    seen.is_new = seen.is_new || std::none_of(before.begin(), before.end(), [&](const Penetration& old) {
                    return are_of(old, fault.part, fault.other);
                  });
  }
  frames_.push_back(std::move(seen));
  return deformation;
}

ResponseMeasures Responder::measures() const {
  ResponseMeasures out;
  const double height = height_of(animated_);
  std::vector<double> depths, times;
  int without = 0, moved = 0;
  double sums[2][2] = {};  // wrists and elbows, before and after
  std::vector<std::vector<Vec3>> tracks[2][2];
  const auto end_clip = [&] {
    for (int end = 0; end < 2; ++end) {
      for (int side = 0; side < 2; ++side) {
        sums[end][side] += acceleration(tracks[end][side]);
        tracks[end][side].clear();
      }
    }
  };
  for (const Frame& frame : frames_) {
    if (frame.starts_clip) end_clip();
    ++out.frames;
    out.faulty_before += frame.is_faulty_before ? 1 : 0;
    out.faulty_after += frame.is_faulty_after ? 1 : 0;
    out.new_faults += frame.is_new ? 1 : 0;
    depths.push_back(frame.depth / height);
    times.push_back(frame.us);
    out.us_mean += frame.us / static_cast<double>(frames_.size());
    double farthest = 0;
    for (std::size_t w = 0; w < wrists_.size(); ++w) {
      farthest = std::max(farthest, (frame.after.wrists[w] - frame.before.wrists[w]).norm());
    }
    without += frame.is_faulty_before ? 0 : 1;
    moved += !frame.is_faulty_before && farthest > kMoved * height ? 1 : 0;
    const std::vector<Vec3>* const places[2][2] = {{&frame.before.wrists, &frame.after.wrists},
                                                   {&frame.before.elbows, &frame.after.elbows}};
    for (int end = 0; end < 2; ++end) {
      for (std::size_t p = 0; p < places[end][0]->size() && !tracks[end][0].empty(); ++p) {
        const double step = ((*places[end][0])[p] - tracks[end][0].back()[p]).norm(),
                     step_after = ((*places[end][1])[p] - tracks[end][1].back()[p]).norm();
        out.largest_jump = std::max(out.largest_jump, (step_after - step) / height);
      }
      for (int side = 0; side < 2; ++side) tracks[end][side].push_back(*places[end][side]);
    }
  }
  end_clip();
  const auto ratio = [](const double(&of)[2]) { return of[0] > 0 ? std::sqrt(of[1] / of[0]) : 1.0; };
  out.wrist_acceleration = ratio(sums[0]);
  out.elbow_acceleration = ratio(sums[1]);
  out.moved_without_fault = without > 0 ? static_cast<double>(moved) / without : 0;
  out.residual_p95 = percentile(depths, 0.95);
  out.us_p99 = percentile(times, 0.99);
  return out;
}

}  // namespace spherechain::baker
