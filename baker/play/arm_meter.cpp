// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/play/arm_meter.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr double kFaultDepth = 0.003 / 1.75, kMoved = 0.003;  // shares of the height

// The sum of the squares of second differences, of all places together.
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

// Does the last value but one stand out from its neighbours?
bool is_flicker(const std::vector<double>& shifts) {
  if (shifts.size() < 3) return false;
  const double* const last = &shifts.back();
  const double from = last[-1] - last[-2], to = last[-1] - last[0];
  return (from > kMoved && to > kMoved) || (from < -kMoved && to < -kMoved);
}

}  // namespace

bool is_of_arm(std::string_view part) {
  return part.ends_with(" upper arm") || part.ends_with(" forearm") || part.ends_with(" hand");
}

bool is_deep_fault(const Penetration& found) {
  return is_fault(found.kind) &&
         static_cast<double>(found.measures.depth) >= kFaultDepth * static_cast<double>(found.measures.height);
}

ArmMeter::ArmMeter(const AnimatedAsset& animated, Target target)
    : animated_(animated), joints_(animated), skin_(animated.asset(), target) {
  const OpenAsset& asset = animated.asset();
  if (asset->bone_count() == 0 || animated.bone_names().empty()) {
    throw Error(ExitCode::kFile, animated.file() + ": no bones move it here, so no joint can be turned (choose a " +
                                     "motion of its own skeleton, or a recording)");
  }
  is_arm_.resize(asset->part_count());
  for (std::uint32_t part = 0; part < asset->part_count(); ++part) {
    const std::string_view name = asset.model().part_name(part);
    const std::int32_t bone = asset.model().part(part).bone;
    is_arm_[part] = is_of_arm(name);
    if (name.ends_with(" hand") && bone >= 0) wrists_.push_back(static_cast<std::size_t>(bone));
    if (name.ends_with(" forearm") && bone >= 0) elbows_.push_back(static_cast<std::size_t>(bone));
  }
  if (std::find(is_arm_.begin(), is_arm_.end(), true) == is_arm_.end()) {
    throw Error(ExitCode::kFile, animated.file() +
                                     ": has no arms, which the response turns (body parts that end with " +
                                     "'upper arm', 'forearm' or 'hand')");
  }
}

ArmPose ArmMeter::look_at(const Deformation& deformation) {
  const BonePose pose(animated_.asset(), deformation);
  skin_.set_pose(pose.pose());
  ArmPose out;
  for (const Penetration& found : skin_.measure_as_games()) {
    if ((is_arm_[found.part] || is_arm_[found.other]) && found.measures.relation != SC_RELATION_JOINED &&
        is_deep_fault(found)) {
      out.faults.push_back(found);
    }
  }
  for (const std::size_t bone : wrists_) out.wrists.push_back(joints_.place_of(deformation, bone));
  for (const std::size_t bone : elbows_) out.elbows.push_back(joints_.place_of(deformation, bone));
  return out;
}

void ResponseTally::add(const ArmPose& before, const ArmPose& after, double us, bool starts_clip) {
  Frame frame{!before.faults.empty(),
              !after.faults.empty(),
              false,
              starts_clip,
              0,
              {{before.wrists, after.wrists}, {before.elbows, after.elbows}},
              us};
  for (const Penetration& fault : after.faults) {
    frame.depth = std::max(frame.depth, static_cast<double>(fault.measures.depth));
    frame.is_new =
        frame.is_new || std::none_of(before.faults.begin(), before.faults.end(),
                                     [&](const Penetration& old) { return are_of(old, fault.part, fault.other); });
  }
  frames_.push_back(std::move(frame));
}

ResponseMeasures ResponseTally::measures() const {
  ResponseMeasures out;
  std::vector<double> depths, times;
  int without = 0, moved = 0;
  std::vector<std::vector<double>> shifts;  // of each wrist, frame by frame of a clip
  double sums[2][2] = {};                   // wrists and elbows, before and after
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
    depths.push_back(frame.depth / height_);
    times.push_back(frame.us);
    out.us_mean += frame.us / static_cast<double>(frames_.size());
    if (frame.starts_clip) shifts.assign(frame.ends[0][0].size(), {});
    double farthest = 0;
    bool has_flickered = false;  // in the frame before
    for (std::size_t w = 0; w < frame.ends[0][0].size(); ++w) {
      shifts[w].push_back((frame.ends[0][1][w] - frame.ends[0][0][w]).norm() / height_);
      farthest = std::max(farthest, shifts[w].back());
      has_flickered = has_flickered || is_flicker(shifts[w]);
    }
    out.flickers += has_flickered ? 1 : 0;
    without += frame.is_faulty_before ? 0 : 1;
    moved += !frame.is_faulty_before && farthest > kMoved ? 1 : 0;
    for (int end = 0; end < 2; ++end) {
      for (std::size_t p = 0; p < frame.ends[end][0].size() && !tracks[end][0].empty(); ++p) {
        const double step = (frame.ends[end][0][p] - tracks[end][0].back()[p]).norm(),
                     step_after = (frame.ends[end][1][p] - tracks[end][1].back()[p]).norm();
        out.largest_jump = std::max(out.largest_jump, (step_after - step) / height_);
      }
      for (int side = 0; side < 2; ++side) tracks[end][side].push_back(frame.ends[end][side]);
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
