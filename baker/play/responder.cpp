// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/responder.h"

#include <algorithm>
#include <ctime>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

double processor_us() { return 1e6 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace

Responder::Responder(const AnimatedAsset& animated, Target target, int ahead, const OpenAsset* other)
    : animated_(animated),
      target_(target),
      ahead_(ahead),
      joints_(animated),
      meter_(animated, target),
      tally_(animated.frame().height) {
  BodyDef body;
  body.largest_other = other == nullptr ? nullptr : other->model().handle();
  body_ = Body(animated.asset().model(), body);
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

Responder::Corrected Responder::correct(int frame, const sc_transform* place, const Body* other) {
  const MotionFrame& now = animated_.frame_at(frame);
  const bool starts_clip = frame == 0 || animated_.frame_at(frame - 1).clip != now.clip;
  if (starts_clip) state_ = {};
  int last_ahead = frame;
  while (last_ahead < frame + ahead_ && last_ahead + 1 < animated_.frame_count() &&
         animated_.frame_at(last_ahead + 1).clip == now.clip) {
    ++last_ahead;
  }
  const Deformation deformation = animated_.deformation(frame);
  std::vector<sc_transform> joints = joints_at(now), ahead;
  const std::vector<float> morphs(deformation.morphs.begin(), deformation.morphs.end());
  ResponseFrame asked;
  const sc_body* const others[] = {other == nullptr ? nullptr : other->handle()};
  asked.joints = joints.data();
  asked.place = place;
  asked.others = others;
  asked.other_count = other == nullptr ? 0 : 1;
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
  const double start = processor_us();
  check_runtime(response_.respond(state_, asked));
  const double us = processor_us() - start;
  Corrected out{deformation, deformation, asked.turned > 0, starts_clip, us};
  if (!out.is_turned) return out;
  std::vector<sc_transform> sorted(joints.size());
  for (std::size_t b = 0; b < joints.size(); ++b) sorted[joints_.joint_of_bone()[b]] = joints[b];
  const std::vector<Affine> bones = joints_.bones_of(sorted);
  std::copy_n(bones.begin(), out.corrected.bones.size(), out.corrected.bones.begin());
  return out;
}

Deformation Responder::respond(int frame) {
  Corrected made = correct(frame);
  const ArmPose before = meter_.look_at(made.animated);
  tally_.add(before, made.is_turned ? meter_.look_at(made.corrected) : before, made.us, made.starts_clip);
  return std::move(made.corrected);
}

}  // namespace spherechain::baker
