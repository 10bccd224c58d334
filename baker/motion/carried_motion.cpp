// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/carried_motion.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "baker/mesh/decompose.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/motion/frame_times.h"
#include "baker/motion/robot_motion.h"

namespace spherechain::baker {
namespace {

// The first node of each name.
class NodesByName {
 public:
  explicit NodesByName(const std::vector<Node>& nodes) {
    for (Index n = 0; n < nodes.size(); ++n) number_.try_emplace(nodes[n].name, n);
  }
  std::optional<Index> find(const std::string& name) const {
    const auto found = number_.find(name);
    return found == number_.end() ? std::nullopt : std::optional(found->second);
  }

 private:
  std::unordered_map<std::string, Index> number_;
};

// Nodes that move skin and hang on such a node: bones with a length. Others are moved about.
std::vector<char> hanging_bones(const SourceRig& rig) {
  std::vector<char> is_bone(rig.nodes.size(), 0), out(rig.nodes.size(), 0);
  for (const Bone& bone : rig.bones) is_bone[bone.node] = 1;
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    const int parent = rig.nodes[n].parent;
    out[n] = is_bone[n] != 0 && parent >= 0 && is_bone[static_cast<std::size_t>(parent)] != 0 ? 1 : 0;
  }
  return out;
}

// The unit of `capture` in that of `rig` where each node that moves skin is in both, and most lie where they do in
// their parents; else 0. A skeleton whose joints have other axes has its bones in other directions.
double same_skeleton(const SourceRig& rig, const SourceRig& capture) {
  const NodesByName others(capture.nodes);
  const std::vector<char> hangs = hanging_bones(rig);
  double length_sum = 0;
  std::vector<std::pair<Vec3, Vec3>> bones;
  std::vector<std::pair<double, double>> ratios;
  for (const Bone& bone : rig.bones) {
    const Node& own = rig.nodes[bone.node];
    const std::optional<Index> other = others.find(own.name);
    if (!other) return 0;
    if (hangs[bone.node] == 0) continue;
    bones.emplace_back(own.local.translation(), capture.nodes[*other].local.translation());
    const double own_length = bones.back().first.norm(), other_length = bones.back().second.norm();
    length_sum += own_length;
    if (other_length > 0) ratios.emplace_back(own_length / other_length, other_length);
  }
  if (ratios.empty()) return 0;
  const double unit = weighted_quantile(std::move(ratios), 0.5);
  constexpr double kSame = 0.02, kAlikeMin = 0.75;
  const double tolerance = kSame * length_sum / static_cast<double>(bones.size());
  const auto alike = std::count_if(bones.begin(), bones.end(), [&](const auto& pair) {
    return (pair.first - unit * pair.second).norm() <= tolerance;
  });
  return static_cast<double>(alike) >= kAlikeMin * static_cast<double>(bones.size()) ? unit : 0;
}

const Affine& parent_of(const Node& node, const std::vector<Affine>& world) {
  static const Affine kScene = Affine::Identity();
  return node.parent < 0 ? kScene : world[static_cast<std::size_t>(node.parent)];
}

Eigen::Quaterniond rotation_of(const Affine& transform) { return Eigen::Quaterniond(turn_in(transform.linear())); }

// A clip of another file on the rig's own nodes of the same names. A bone keeps its own length.
class CarriedByName : public CarriedMotion {
 public:
  CarriedByName(Capture capture, const SourceRig& rig, double unit)
      : rig_(rig), own_(rig.nodes), capture_(std::move(capture)) {
    const std::vector<Node>& theirs = capture_.rig.nodes;
    const std::vector<char> hangs = hanging_bones(rig);
    std::vector<char> is_turned(rig.nodes.size(), 0);
    clip_.name = capture_.clip.name;
    clip_.duration = capture_.clip.duration;
    for (Channel channel : capture_.clip.channels) {
      if (channel.path == ChannelPath::kMorphWeight) continue;
      const Node& other = theirs[channel.target];
      const std::optional<Index> own = own_.find(other.name);
      if (!own) continue;
      channel.target = *own;
      if (channel.path == ChannelPath::kRotation) is_turned[*own] = 1;
      if (channel.path == ChannelPath::kTranslation) {
        const double length = other.local.translation().norm();
        const double scale =
            hangs[*own] != 0 && length > 0 ? rig.nodes[*own].local.translation().norm() / length : unit;
        for (double& value : channel.values) value *= scale;
      }
      clip_.channels.push_back(std::move(channel));
    }
    // Bones without a key stay as the recording's file has them.
    for (const Node& other : theirs) {
      const std::optional<Index> own = own_.find(other.name);
      constexpr double kSame = 1e-5;  // radians
      if (!own || hangs[*own] == 0 || is_turned[*own] != 0) continue;
      is_turned[*own] = 1;
      if (other.rotation.angularDistance(rig.nodes[*own].rotation) < kSame) continue;
      const Eigen::Vector4d q = other.rotation.coeffs();
      clip_.channels.push_back({ChannelPath::kRotation, *own, Interpolation::kLinear, {0}, {q.begin(), q.end()}});
    }
  }
  Deformation at(double t) const override { return sample(rig_, clip_, t * clip_.duration); }
  double duration() const override { return clip_.duration; }
  double rate() const override { return rate_of(clip_); }

  const Capture& capture() const override { return capture_; }
  Clip clip() const override { return clip_; }

  std::vector<Index> recorded_nodes() const override {
    std::vector<Index> out;
    for (const Channel& channel : clip_.channels) {
      if (channel.path == ChannelPath::kRotation) out.push_back(channel.target);
    }
    return out;
  }

  std::vector<Eigen::Quaterniond> recorded_rotations(double seconds, const std::vector<Affine>& world) const override {
    std::vector<Node> nodes = capture_.rig.nodes;
    for (const Channel& channel : capture_.clip.channels) {
      if (channel.path == ChannelPath::kRotation)
        nodes[channel.target].rotation = Eigen::Quaterniond(sample(channel, seconds));
    }
    std::vector<Eigen::Quaterniond> out;
    for (const Node& node : nodes) {
      const std::optional<Index> own = own_.find(node.name);
      if (!own) {
        out.push_back(node.rotation);
      } else {
        out.push_back(rotation_of(parent_of(rig_.nodes[*own], world)).inverse() * rotation_of(world[*own]));
      }
    }
    return out;
  }

 private:
  const SourceRig& rig_;
  NodesByName own_;
  Capture capture_;
  Clip clip_;
};

// A channel in the making: a key at each time.
struct Path {
  ChannelPath path;
  Eigen::Vector4d rest;
  std::vector<Eigen::Vector4d> values;
};

// Adds a path's keys: none if it stays at rest, one if it stands still within `tolerance`, else all.
void add_channel(const Path& path, Index node, const std::vector<double>& times, double tolerance, Clip& clip) {
  const auto is = [&](const Eigen::Vector4d& value) {
    return [&, value](const Eigen::Vector4d& one) { return (one - value).norm() <= tolerance; };
  };
  const bool is_still = std::all_of(path.values.begin(), path.values.end(), is(path.values.front()));
  if (is_still && is(path.rest)(path.values.front())) return;
  Channel channel{path.path, node, Interpolation::kLinear, {}, {}};
  for (std::size_t k = 0; k < (is_still ? 1 : times.size()); ++k) {
    channel.times.push_back(times[k]);
    const Eigen::Index width = path.path == ChannelPath::kRotation ? 4 : 3;
    channel.values.insert(channel.values.end(), path.values[k].begin(), path.values[k].begin() + width);
  }
  clip.channels.push_back(std::move(channel));
}

Eigen::Vector4d wide(const Vec3& v) { return {v.x(), v.y(), v.z(), 0}; }

class CarriedByRole : public CarriedMotion {
 public:
  CarriedByRole(Capture capture, CaptureBody body, const SourceRig& rig, const std::string& character)
      : rig_(rig), character_(character), motion_(std::move(capture), std::move(body)) {
    std::vector<const Bone*> bone_of(rig.nodes.size(), nullptr);
    std::vector<char> is_under_joint(rig.nodes.size(), 0);
    std::vector<double> moved(rig.bones.size(), 0);
    for (const VertexWeights& weights : rig.weights) {
      for (std::size_t k = 0; k < kMaxInfluences; ++k) moved[weights.joint[k]] += weights.weight[k];
    }
    moves_.assign(rig.nodes.size(), 0);
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
      const Bone& bone = rig.bones[b];
      if (std::abs(bone.inverse_bind.linear().determinant()) == 0) continue;
      if (bone_of[bone.node] == nullptr) bone_of[bone.node] = &bone;
      if (moved[b] > 0) moves_[bone.node] = 1;
    }
    // Nodes above all joints that move no skin stay in place: the root of a scene, an armature.
    for (const Index node : motion_.body().joints.node) is_under_joint[node] = 1;
    for (Index n = 0; n < rig.nodes.size(); ++n) {
      const Node& node = rig.nodes[n];
      if (node.parent >= 0 && is_under_joint[static_cast<std::size_t>(node.parent)] != 0) is_under_joint[n] = 1;
      if (is_under_joint[n] != 0) moves_[n] = 1;
      const Affine parent = node.parent < 0 ? rig.to_rest : binds_[static_cast<std::size_t>(node.parent)];
      binds_.push_back(bone_of[n] != nullptr ? Affine(bone_of[n]->inverse_bind.inverse())
                                             : Affine(parent * node.local));
    }
  }

  Deformation at(double t) const override { return motion_.at(t); }
  double duration() const override { return motion_.duration(); }
  double rate() const override { return motion_.rate(); }
  const Capture& capture() const override { return motion_.capture(); }

  Clip clip() const override {
    const double fps = rate();
    std::vector<double> times;
    for (int i = 0; i < frames_in(duration(), fps); ++i) times.push_back(i / fps);
    if (duration() - times.back() > kFrameRounding / fps) times.push_back(duration());
    std::vector<std::array<Path, 3>> paths;
    double longest = 0;
    for (const Node& node : rig_.nodes) {
      paths.push_back({{{ChannelPath::kTranslation, wide(node.translation), {}},
                        {ChannelPath::kRotation, node.rotation.coeffs(), {}},
                        {ChannelPath::kScale, wide(node.scale), {}}}});
      longest = std::max(longest, node.translation.norm());
    }
    for (const double time : times) {
      const std::vector<Affine> world = world_for(share(time));
      for (std::size_t n = 0; n < rig_.nodes.size(); ++n) {
        Node now;
        now.local = parent_of(rig_.nodes[n], world).inverse() * world[n];
        decompose(now);
        auto& [move, turn, scale] = paths[n];
        const Eigen::Vector4d& before = turn.values.empty() ? turn.rest : turn.values.back();
        if (now.rotation.coeffs().dot(before) < 0) now.rotation.coeffs() = -now.rotation.coeffs();
        move.values.push_back(wide(now.translation));
        turn.values.push_back(now.rotation.coeffs());
        scale.values.push_back(wide(now.scale));
      }
    }
    constexpr double kStill = 1e-7;
    Clip out;
    out.name = capture().clip.name;
    out.duration = times.back();
    for (Index n = 0; n < rig_.nodes.size(); ++n) {
      const auto& [move, turn, scale] = paths[n];
      add_channel(move, n, times, kStill * longest, out);
      add_channel(turn, n, times, kStill, out);
      add_channel(scale, n, times, kStill * rig_.nodes[n].scale.norm(), out);
    }
    check(out, times);
    return out;
  }

  std::vector<Index> recorded_nodes() const override {
    const RoleJoints& joints = motion_.body().joints;
    std::vector<Index> out;
    for (Index j = 1; j < joints.joints.size(); ++j) {  // the first one turns about the middle of the hips
      const int source = motion_.source(j);
      if (source < 0 || !is_turned(source) || carries_hips(source)) continue;
      // Others that turn with the same node must turn with this joint.
      bool can_turn = true;
      for (Index k = 0; k < joints.joints.size(); ++k) can_turn &= motion_.source(k) != source || is_below(k, j);
      if (can_turn) out.push_back(joints.node[j]);
    }
    return out;
  }

  std::vector<Eigen::Quaterniond> recorded_rotations(double seconds, const std::vector<Affine>& world) const override {
    const SourceRig& rig = capture().rig;
    const std::vector<Affine> before = world_at(rig, capture().clip, seconds);
    const CaptureBody& body = motion_.body();
    std::vector<int> follower(rig.nodes.size(), -1);
    for (std::size_t j = body.joints.joints.size(); j-- > 0;) {
      if (const int source = motion_.source(static_cast<Index>(j)); source >= 0)
        follower[static_cast<std::size_t>(source)] = static_cast<int>(j);
    }
    std::vector<Eigen::Quaterniond> after, out;
    for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
      const int parent = rig.nodes[n].parent;
      const Eigen::Quaterniond old_parent = rotation_of(parent_of(rig.nodes[n], before)),
                               up = parent < 0 ? Eigen::Quaterniond::Identity()
                                               : after[static_cast<std::size_t>(parent)];
      if (follower[n] < 0) {
        out.push_back(old_parent.inverse() * rotation_of(before[n]));
        after.push_back(up * out.back());
        continue;
      }
      const auto joint = static_cast<Index>(follower[n]);
      const Index node = body.joints.node[joint];
      const Affine moved = rig_.to_rest * world[node] * binds_[node].inverse();
      after.emplace_back(motion_.source_rotation(joint, turn_in(moved.linear())));
      out.push_back(up.inverse() * after.back());
    }
    return out;
  }

 private:
  double share(double seconds) const { return duration() > 0 ? std::min(seconds / duration(), 1.0) : 0; }

  std::vector<Affine> world_for(double t) const {
    const std::vector<Affine> joints = motion_.joints_at(t);
    const Affine from_rest = rig_.to_rest.inverse();
    std::vector<Affine> out;
    for (std::size_t n = 0; n < rig_.nodes.size(); ++n) {
      const Affine& joint = joints[motion_.body().joints.joint_of_node[n]];
      out.push_back(moves_[n] != 0 ? Affine(from_rest * joint * binds_[n])
                                   : Affine(parent_of(rig_.nodes[n], out) * rig_.nodes[n].local));
    }
    return out;
  }

  bool is_below(Index joint, Index other) const {
    int j = static_cast<int>(joint);
    while (j >= 0 && j != static_cast<int>(other)) j = motion_.body().joints.joints[static_cast<std::size_t>(j)].parent;
    return j >= 0;
  }

  // An end site, say, is not.
  bool is_turned(int node) const {
    const std::vector<Channel>& channels = capture().clip.channels;
    return std::any_of(channels.begin(), channels.end(), [&](const Channel& channel) {
      return channel.path == ChannelPath::kRotation && static_cast<int>(channel.target) == node;
    });
  }

  // The pelvis goes where the hips of the capture go.
  bool carries_hips(int node) const {
    for (const Index hip : motion_.hips()) {
      for (int n = capture().rig.nodes[hip].parent; n >= 0;
           n = capture().rig.nodes[static_cast<std::size_t>(n)].parent) {
        if (n == node) return true;
      }
    }
    return false;
  }

  void check(const Clip& clip, const std::vector<double>& times) const {
    constexpr double kSame = 1e-4, kArm = 0.15;  // of the height
    const double height = motion_.body().frame.height;
    for (const double time : times) {
      const Deformation wanted = at(share(time)), got = sample(rig_, clip, time);
      for (std::size_t b = 0; b < rig_.bones.size(); ++b) {
        const Index node = rig_.bones[b].node;
        if (moves_[node] == 0) continue;
        for (int axis = -1; axis < 3; ++axis) {
          const Vec3 arm = axis < 0 ? Vec3(Vec3::Zero()) : Vec3(kArm * height * Vec3::Unit(axis)),
                     p = binds_[node].translation() + arm;
          if ((wanted.bones[b] * p - got.bones[b] * p).norm() <= kSame * height) continue;
          throw Error(ExitCode::kFile, character_ + ": the bone '" + rig_.nodes[node].name +
                                           "' is sheared or bound twice, no clip of it can be a recording (apply "
                                           "scales, and bind its skin anew)");
        }
      }
    }
  }

  const SourceRig& rig_;
  std::string character_;
  CaptureMotion motion_;
  std::vector<Affine> binds_;  // of each node, to the rest positions' space
  std::vector<char> moves_;    // with a joint
};

}  // namespace

std::unique_ptr<CarriedMotion> carried_motion(const std::filesystem::path& file, const SourceRig& rig,
                                              const std::vector<Vec3>& rest, const BodyFrame& frame,
                                              const std::string& character) {
  if (rig.robot.is_robot) return std::make_unique<CarriedByName>(read_robot_motion(file, rig), rig, 1);
  Capture capture = read_capture(file);
  if (const double unit = same_skeleton(rig, capture.rig); unit > 0)
    return std::make_unique<CarriedByName>(std::move(capture), rig, unit);
  return std::make_unique<CarriedByRole>(std::move(capture), body_of(rig, rest, frame, character), rig, character);
}

}  // namespace spherechain::baker
