// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/read_bvh.h"

#include <cctype>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "baker/import/bvh_file.h"
#include "baker/import/notes.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

// Positions take the place of the offset. Some programs write them from the offset on: where all begin at 0, they are
// added to the offsets. A root's only say where the recording begins.
bool are_added(const BvhFile& bvh) {
  double from_nothing = 0, from_offset = 0;
  for (const BvhJoint& joint : bvh.joints) {
    for (std::size_t c = 0; joint.parent >= 0 && c < joint.channels.size(); ++c) {
      if (joint.channels[c].kind != BvhChannel::Kind::kPosition) continue;
      const double value = bvh.numbers[joint.first_column + c];
      from_nothing += std::abs(value);
      from_offset += std::abs(value - joint.offset[joint.channels[c].axis]);
    }
  }
  constexpr double kNothing = 0.1;
  return from_nothing < kNothing * from_offset;
}

class ChannelsOfJoint {
 public:
  ChannelsOfJoint(const BvhFile& bvh, Index joint, bool added)
      : bvh_(bvh), joint_(bvh.joints[joint]), node_(joint), added_(added && joint_.parent >= 0) {}

  void add_to(Clip& clip) const {
    using Kind = BvhChannel::Kind;
    if (has(Kind::kPosition)) add(ChannelPath::kTranslation, Kind::kPosition, joint_.offset, clip);
    if (has(Kind::kRotation)) add(ChannelPath::kRotation, Kind::kRotation, Vec3::Zero(), clip);
    if (has(Kind::kScale)) add(ChannelPath::kScale, Kind::kScale, Vec3::Ones(), clip);
  }

 private:
  bool has(BvhChannel::Kind kind) const {
    for (const BvhChannel& channel : joint_.channels) {
      if (channel.kind == kind) return true;
    }
    return false;
  }

  void add(ChannelPath path, BvhChannel::Kind kind, const Vec3& rest, Clip& clip) const {
    Channel out{path, node_, Interpolation::kLinear, {}, {}};
    for (std::size_t f = 0; f < bvh_.frames(); ++f) {
      out.times.push_back(static_cast<double>(f) * bvh_.frame_time);
      Vec3 vector = rest;
      Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
      for (std::size_t c = 0; c < joint_.channels.size(); ++c) {
        const auto& [of, axis] = joint_.channels[c];
        if (of != kind) continue;
        const double value = bvh_.numbers[f * bvh_.width + joint_.first_column + c];
        turn = turn * Eigen::AngleAxisd(value * std::numbers::pi / 180, Vec3::Unit(axis));
        vector[axis] = value + (kind == BvhChannel::Kind::kPosition && added_ ? rest[axis] : 0);
      }
      if (path == ChannelPath::kRotation)
        out.values.insert(out.values.end(), turn.coeffs().begin(), turn.coeffs().end());
      else
        out.values.insert(out.values.end(), vector.begin(), vector.end());
    }
    clip.channels.push_back(std::move(out));
  }

  const BvhFile& bvh_;
  const BvhJoint& joint_;
  Index node_;
  bool added_;
};

// The joints as nodes, by their numbers, and the recording as a clip.
SourceRig rig_of(const BvhFile& bvh) {
  SourceRig out;
  for (const BvhJoint& joint : bvh.joints) {
    Node node;
    node.name = joint.name;
    node.parent = joint.parent;
    node.translation = joint.offset;
    node.local.translation() = joint.offset;
    out.nodes.push_back(std::move(node));
  }
  Clip clip;
  clip.name = "Motion";
  clip.duration = static_cast<double>(bvh.frames() - 1) * bvh.frame_time;
  clip.in_file = 0;
  const bool added = are_added(bvh);
  for (Index j = 0; j < bvh.joints.size(); ++j) ChannelsOfJoint(bvh, j, added).add_to(clip);
  out.clips.push_back(std::move(clip));
  return out;
}

}  // namespace

bool is_recording(const std::filesystem::path& path) {
  std::string start(64, '\0'), ending = path.extension().string();
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return is_bvh(start) || ending == ".bvh";
}

SourceRig read_bvh(const std::filesystem::path& path) {
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  std::string text(failed ? 0 : size, '\0');
  std::ifstream file(path, std::ios::binary);
  if (failed || !file.read(text.data(), static_cast<std::streamsize>(text.size()))) {
    throw Error(ExitCode::kFile, path.string() + ": cannot be read");
  }
  const BvhFile bvh = parse_bvh(text, path.string());
  if (!bvh.note.empty()) add_note(path.string() + ": " + bvh.note);
  return rig_of(bvh);
}

}  // namespace spherechain::baker
