// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/smpl_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr Index kBody = 22;  // joints that all of SMPL's kin begin with

// A joint at rest, of an average person: metres from its parent to the left, up and forward.
struct SmplJoint {
  const char* name;
  int parent;
  double left, up, forward;
};
constexpr SmplJoint kBodyJoints[kBody] = {
    {"pelvis", -1, 0, 0, 0},          {"left_hip", 0, 0.08, -0.09, 0},      {"right_hip", 0, -0.08, -0.09, 0},
    {"spine1", 0, 0, 0.11, 0},        {"left_knee", 1, 0, -0.40, 0},        {"right_knee", 2, 0, -0.40, 0},
    {"spine2", 3, 0, 0.13, 0},        {"left_ankle", 4, 0, -0.40, 0},       {"right_ankle", 5, 0, -0.40, 0},
    {"spine3", 6, 0, 0.06, 0},        {"left_foot", 7, 0, -0.06, 0.13},     {"right_foot", 8, 0, -0.06, 0.13},
    {"neck", 9, 0, 0.21, 0},          {"left_collar", 9, 0.07, 0.12, 0},    {"right_collar", 9, -0.07, 0.12, 0},
    {"head", 12, 0, 0.09, 0.02},      {"left_shoulder", 13, 0.11, 0.03, 0}, {"right_shoulder", 14, -0.11, 0.03, 0},
    {"left_elbow", 16, 0.27, 0, 0},   {"right_elbow", 17, -0.27, 0, 0},     {"left_wrist", 18, 0.25, 0, 0},
    {"right_wrist", 19, -0.25, 0, 0},
};

bool is_body(std::size_t joints) { return joints == kBody || joints == 24 || joints == 52 || joints == 55; }

// The body's joints, and where the hands end. Others (fingers, jaw, eyes) are carried to no character.
std::vector<Node> smpl_nodes() {
  std::vector<Node> out;
  const auto add = [&](const char* name, int parent, const Vec3& offset) {
    Node node;
    node.name = name;
    node.parent = parent;
    node.translation = offset;
    node.local.translation() = offset;
    out.push_back(std::move(node));
  };
  for (const SmplJoint& joint : kBodyJoints) add(joint.name, joint.parent, {joint.left, joint.up, joint.forward});
  add("left_hand", 20, {0.15, 0, 0});
  add("right_hand", 21, {-0.15, 0, 0});
  return out;
}

// Numbers of each frame, row by row.
struct Table {
  std::size_t frames = 0, width = 0;
  std::vector<double> numbers;
  const double* row(std::size_t frame) const { return numbers.data() + frame * width; }
};

class SmplMotion {
 public:
  SmplMotion(const Arrays& arrays, const std::string& file) : arrays_(arrays), file_(file) {}

  std::optional<SourceRig> read() {
    if (!find_turns()) return std::nullopt;
    SourceRig rig;
    rig.nodes = smpl_nodes();
    const Table places = travel();
    const double fps = frame_rate(arrays_, file_);
    Clip clip;
    clip.name = "Motion";
    clip.in_file = 0;
    clip.duration = static_cast<double>(turns_.frames - 1) / fps;
    for (Index j = 0; j < kBody; ++j)
      clip.channels.push_back({ChannelPath::kRotation, j, Interpolation::kLinear, {}, {}});
    if (places.frames > 0) clip.channels.push_back({ChannelPath::kTranslation, 0, Interpolation::kLinear, {}, {}});
    for (std::size_t f = 0; f < turns_.frames; ++f) {
      for (Index j = 0; j < kBody; ++j) {
        const Eigen::Quaterniond turn = is_6d_ ? turn_of_6d(f, j) : turn_of_axis(f, j);
        clip.channels[j].values.insert(clip.channels[j].values.end(), turn.coeffs().begin(), turn.coeffs().end());
      }
      if (places.frames > 0) {
        std::vector<double>& values = clip.channels.back().values;
        values.insert(values.end(), places.row(f), places.row(f) + 3);
      }
      for (Channel& channel : clip.channels) channel.times.push_back(static_cast<double>(f) / fps);
    }
    rig.clips.push_back(std::move(clip));
    return rig;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  const Array* find(const std::string& name) const { return find_table(arrays_, name, file_); }
  // The table of one of these names, as a row a frame; nothing where there is none.
  std::optional<Table> table(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      const Array* array = find(name);
      if (array != nullptr) return table(*array, name);
    }
    return std::nullopt;
  }
  Table table(const Array& array, const std::string& name) const {
    const std::string quoted = name.empty() ? "its table" : "'" + name + "'";
    if (array.shape.size() < 2 || array.shape.size() > 3 || !array.texts.empty())
      fail(fmt::format("{} is no table of numbers with a row a frame", quoted));
    if (array.shape[0] == 0) fail(fmt::format("{} has no frames", quoted));
    return {array.shape[0], array.numbers.size() / array.shape[0], array.numbers};
  }

  // Sets the rotations, from the first of the layouts that the file has.
  bool find_turns() {
    if (const Array* only = find(""); only != nullptr) return find_6d(table(*only, ""));
    for (const char* name : {"rot6d", "rotations_6d", "poses_6d"}) {
      if (const Array* array = find(name); array != nullptr) return find_6d(table(*array, name));
    }
    if (auto whole = table({"poses", "fullpose", "pose_aa"})) return take_angles(std::move(*whole));
    const auto root = table({"root_orient", "global_orient"}), body = table({"pose_body", "body_pose"});
    if (!root && !body) return false;
    if (!root || !body)
      fail(root ? "has no 'pose_body' beside 'root_orient'" : "has no 'root_orient' beside 'pose_body'");
    if (root->width != 3 || root->frames != body->frames)
      fail("'root_orient' is no axis angle for each frame of 'pose_body'");
    Table joined{root->frames, 3 + body->width, {}};
    for (std::size_t f = 0; f < joined.frames; ++f) {
      joined.numbers.insert(joined.numbers.end(), root->row(f), root->row(f) + 3);
      joined.numbers.insert(joined.numbers.end(), body->row(f), body->row(f) + body->width);
    }
    return take_angles(std::move(joined));
  }

  bool take_angles(Table angles) {
    turns_ = std::move(angles);
    if (turns_.width % 3 == 0 && is_body(turns_.width / 3)) return true;
    fail(fmt::format("has {} angles a frame; 66 (body), 72 (SMPL), 156 (SMPL-H) and 165 (SMPL-X) are read",
                     turns_.width));
  }

  // 6D rotations are two axes of a joint, one after the other or mixed, with three numbers of travel before them,
  // behind them or nowhere. Only one of these makes all axes unit vectors at right angles.
  bool find_6d(const Table& all) {
    int found = 0;
    std::size_t first = 0;
    bool is_mixed = false;
    for (const std::size_t travel : {0, 3}) {
      if (all.width < travel || (all.width - travel) % 6 != 0 || !is_body((all.width - travel) / 6)) continue;
      for (const std::size_t before : travel == 0 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{0, 3}) {
        for (const bool mixed : {false, true}) {
          if (!are_axes(all, before, all.width - travel, mixed)) continue;
          ++found;
          first = before;
          is_mixed = mixed;
          turns_ = {all.frames, all.width - travel, {}};
          travel_ = {travel == 0 ? 0 : all.frames, 3, {}};
        }
      }
    }
    if (found != 1) {
      fail(
          fmt::format("has {} numbers a frame, which are no 6D rotations of 22, 24, 52 or 55 joints, or may be read in "
                      "several ways (save an .npz with axis angles 'poses', 'trans' and 'fps')",
                      all.width));
    }
    is_6d_ = true;
    for (std::size_t f = 0; f < all.frames; ++f) {
      const double* row = all.row(f);
      for (std::size_t k = 0; k < turns_.width; k += 6) {
        for (std::size_t c = 0; c < 6; ++c)
          turns_.numbers.push_back(row[first + k + (is_mixed ? 2 * (c % 3) + c / 3 : c)]);
      }
      if (travel_.frames > 0) {
        const double* place = first > 0 ? row : row + turns_.width;
        travel_.numbers.insert(travel_.numbers.end(), place, place + 3);
      }
    }
    choose_rows();
    return true;
  }

  static bool are_axes(const Table& all, std::size_t first, std::size_t width, bool is_mixed) {
    constexpr double kSame = 0.02;
    for (std::size_t f = 0; f < all.frames; ++f) {
      for (std::size_t k = first; k < first + width; k += 6) {
        const double* at = all.row(f) + k;
        const std::size_t step = is_mixed ? 2 : 1, second = is_mixed ? 1 : 3;
        const Vec3 a(at[0], at[step], at[2 * step]), b(at[second], at[second + step], at[second + 2 * step]);
        if (std::abs(a.norm() - 1) > kSame || std::abs(b.norm() - 1) > kSame || std::abs(a.dot(b)) > kSame)
          return false;
      }
    }
    return true;
  }

  // The axes are columns of the joint's matrix (Zhou et al.) or its rows (PyTorch3D), which is the opposite turn. Knees
  // and elbows bend one way only.
  void choose_rows() {
    constexpr Index kKnees[2] = {4, 5}, kElbows[2] = {18, 19};
    constexpr double kBent = 0.05;  // radians, on average
    double bent = 0;
    for (std::size_t f = 0; f < turns_.frames; ++f) {
      const auto angle = [&](Index joint, int axis) {
        const Eigen::AngleAxisd turn(turn_of_6d(f, joint));
        return turn.angle() * turn.axis()[axis];
      };
      bent += angle(kKnees[0], 0) + angle(kKnees[1], 0) + angle(kElbows[1], 1) - angle(kElbows[0], 1);
    }
    bent /= static_cast<double>(turns_.frames);
    if (std::abs(bent) < kBent) {
      fail(
          "bends neither knees nor elbows, so nobody can tell if its 6D rotations are columns or rows of matrices "
          "(save "
          "an .npz with axis angles 'poses', 'trans' and 'fps')");
    }
    are_rows_ = bent < 0;
  }

  Table travel() const {
    if (travel_.frames > 0) return travel_;
    const std::optional<Table> out = table({"trans", "transl"});
    if (!out) return {};
    if (out->width != 3 || out->frames != turns_.frames)
      fail(fmt::format("'trans' has {} rows of {} numbers; the poses have {} frames, with 3", out->frames, out->width,
                       turns_.frames));
    return *out;
  }

  // The axis times the angle.
  Eigen::Quaterniond turn_of_axis(std::size_t frame, Index joint) const {
    const double* at = turns_.row(frame) + 3 * std::size_t{joint};
    const Vec3 vector(at[0], at[1], at[2]);
    const double angle = vector.norm();
    return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle)) : Eigen::Quaterniond::Identity();
  }
  Eigen::Quaterniond turn_of_6d(std::size_t frame, Index joint) const {
    const double* at = turns_.row(frame) + 6 * std::size_t{joint};
    Eigen::Matrix3d axes;
    axes.col(0) = Vec3(at[0], at[1], at[2]).normalized();
    axes.col(2) = axes.col(0).cross(Vec3(at[3], at[4], at[5])).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    const Eigen::Quaterniond out(axes);
    return are_rows_ ? out.conjugate() : out;
  }

  const Arrays& arrays_;
  const std::string& file_;
  Table turns_, travel_;
  bool is_6d_ = false, are_rows_ = false;
};

}  // namespace

std::optional<SourceRig> smpl_motion(const Arrays& arrays, const std::string& file) {
  return SmplMotion(arrays, file).read();
}

}  // namespace spherechain::baker
