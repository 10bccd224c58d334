// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/joint_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <set>

#include "baker/export/names.h"
#include "baker/export/robot.h"
#include "baker/mesh/euler.h"
#include "baker/play/skin_player.h"

namespace spherechain::baker {
namespace {

// How a body stands in its parent, in the world where it has none.
struct Placed {
  Vec3 shift;               // from its place at rest, along the parent's axes
  Eigen::Quaterniond turn;  // from the rest pose, around its own axes
  Eigen::Isometry3d at;
};

Placed placed(const Colliders& colliders, const std::vector<Eigen::Isometry3d>& bodies, std::size_t body) {
  const int parent = colliders.bodies[body].parent;
  const Eigen::Isometry3d up(to_z_up(colliders));
  const Eigen::Isometry3d rest = rest_in_parent(colliders, body);
  const Eigen::Isometry3d in_parent = parent < 0 ? up : bodies[static_cast<std::size_t>(parent)].inverse();
  const Eigen::Isometry3d at = in_parent * bodies[body], at_rest = parent < 0 ? up * rest : rest;
  return {at.translation() - at_rest.translation(),
          Eigen::Quaterniond(at_rest.linear().transpose() * at.linear()).normalized(), at};
}

// The angles with turn = X(x) Y(y) Z(z) in radians, each at most half a turn: a robot's joint reaches no farther.
Vec3 three_angles(const Eigen::Quaterniond& turn, const Vec3& before) {
  constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
  const Vec3 angles = angles_near(turn, {0, 1, 2}, before * kDegreesPerRadian) / kDegreesPerRadian;
  return angles.unaryExpr([](double angle) { return std::remainder(angle, 2 * std::numbers::pi); });
}

bool is_in_file_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-'; }

// One file a clip: header() are its columns, row(frame, is_first) the numbers of a frame.
template <typename Header, typename Row>
std::vector<ExportFile> tables(const char* format, const std::vector<PosedClip>& clips, const Header& header,
                               const Row& row) {
  std::vector<ExportFile> out;
  std::set<std::string> taken;
  for (const PosedClip& clip : clips) {
    const std::string stem = clip.name.empty() ? "clip" : with_allowed(clip.name, is_in_file_name);
    std::string name = stem;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", stem, k);
    std::string text = "time" + header() + "\n";
    for (std::size_t f = 0; f < clip.frames.size(); ++f) {
      text += fmt::format("{:.9g}", clip.seconds[f]) + row(clip.frames[f], f == 0) + "\n";
    }
    out.push_back({fmt::format(".{}.{}.csv", name, format), std::move(text)});
  }
  return out;
}

std::string number(double value) { return fmt::format(",{:.9g}", value == 0 ? 0.0 : value); }

std::string numbers(const Vec3& v) { return number(v.x()) + number(v.y()) + number(v.z()); }

}  // namespace

std::vector<PosedClip> posed_clips(const AnimatedAsset& animated, const Colliders& colliders) {
  std::vector<PosedClip> out;
  const bool is_at_rest = animated.clips()[0].clip == nullptr && animated.frame_count() == 1;
  if (is_at_rest) return out;
  if (!moved_by_bones(animated.asset(), animated.deformation(0))) return out;
  for (const ClipFrames& clip : animated.clips()) {
    out.push_back({clip.name, {}, {}});
    for (int i = clip.first; i < clip.first + clip.count; ++i) {
      out.back().seconds.push_back(animated.frame_at(i).seconds);
      out.back().frames.push_back(posed(colliders, animated.deformation(i).bones));
    }
  }
  return out;
}

std::string allow_motion(const std::vector<PosedClip>& clips, Colliders& colliders) {
  constexpr double kStays = 3e-5;  // of the height: a row of joints adds up to less than a millimetre on a human
  std::vector<std::string> names;
  for (std::size_t b = 0; b < colliders.bodies.size(); ++b) {
    if (colliders.bodies[b].parent < 0) continue;
    double farthest = 0;
    for (const PosedClip& clip : clips) {
      for (const auto& bodies : clip.frames) {
        const Placed at = placed(colliders, bodies, b);
        farthest = std::max(farthest, at.shift.norm());
        colliders.bodies[b].turn = std::max(colliders.bodies[b].turn, Eigen::AngleAxisd(at.turn).angle());
      }
    }
    if (farthest <= kStays * colliders.height) continue;
    colliders.bodies[b].slide = farthest;
    names.push_back(fmt::format("{} ({:.1f} mm)", colliders.bodies[b].name, 1000 * farthest));
  }
  if (names.empty()) return {};
  return fmt::format("clips move parts in those that they hang on, so these slide, too: {}", fmt::join(names, ", "));
}

std::vector<ExportFile> urdf_joint_tables(const Colliders& colliders, const std::vector<PosedClip>& clips) {
  std::vector<Vec3> angles(colliders.bodies.size());
  return tables(
      "urdf", clips,
      [&] {
        std::string out;
        for (const RobotJoint& joint : robot_joints(colliders)) out += "," + joint.name;
        return out;
      },
      [&](const std::vector<Eigen::Isometry3d>& bodies, bool is_first) {
        std::string out;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const Placed at = placed(colliders, bodies, b);
          if (colliders.bodies[b].parent < 0 || colliders.bodies[b].slide > 0) out += numbers(at.shift);
          angles[b] = three_angles(at.turn, is_first ? Vec3(Vec3::Zero()) : angles[b]);
          out += numbers(angles[b]);
        }
        return out;
      });
}

std::vector<ExportFile> mjcf_joint_tables(const Colliders& colliders, const std::vector<PosedClip>& clips) {
  const std::vector<std::string> names = link_names(colliders);
  std::vector<Eigen::Quaterniond> turns(names.size());
  return tables(
      "mjcf", clips,
      [&] {
        std::string out;
        for (std::size_t b = 0; b < names.size(); ++b) {
          const bool is_free = colliders.bodies[b].parent < 0;
          for (const char axis : std::string(is_free || colliders.bodies[b].slide > 0 ? "xyz" : "")) {
            out += fmt::format(",{}_{}{}", names[b], is_free ? "" : "t", axis);
          }
          for (const char axis : std::string("wxyz")) out += fmt::format(",{}_q{}", names[b], axis);
        }
        return out;
      },
      [&](const std::vector<Eigen::Isometry3d>& bodies, bool is_first) {
        std::string out;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
          const Placed at = placed(colliders, bodies, b);
          const bool is_free = colliders.bodies[b].parent < 0;
          Eigen::Quaterniond turn = is_free ? Eigen::Quaterniond(at.at.linear()).normalized() : at.turn;
          if (is_free) {
            out += numbers(at.at.translation());
          } else if (colliders.bodies[b].slide > 0) {
            out += numbers(rest_in_parent(colliders, b).linear().transpose() * at.shift);
          }
          if (is_first ? turn.w() < 0 : turn.dot(turns[b]) < 0) turn.coeffs() = -turn.coeffs();
          turns[b] = turn;
          out += number(turn.w()) + numbers(turn.vec());
        }
        return out;
      });
}

}  // namespace spherechain::baker
