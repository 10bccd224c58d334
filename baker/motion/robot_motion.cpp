// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/robot_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

#include "baker/import/named_file.h"
#include "baker/import/notes.h"
#include "baker/import/robot_joints.h"
#include "baker/import/robot_motion.h"
#include "baker/mesh/error.h"
#include "baker/motion/frame_times.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kRootWidth = 7;
constexpr std::array<const char*, kRootWidth> kRootNames{"root_x",  "root_y",  "root_z", "root_qx",
                                                         "root_qy", "root_qz", "root_qw"};

std::string_view trimmed(std::string_view text) {
  constexpr const char* kSpaces = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kSpaces);
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(kSpaces) + 1 - first);
}

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> out;
  while (true) {
    const std::size_t comma = line.find(',');
    out.emplace_back(trimmed(line.substr(0, comma)));
    if (comma == line.npos) return out;
    line.remove_prefix(comma + 1);
  }
}

std::optional<double> number_in(const std::string& cell) {
  double value = 0;
  const auto [last, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || last != cell.data() + cell.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// A CSV file of numbers, with a header or without.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<double>> rows;
  double fps = kRobotFps;  // of rows without times
};

// The tables of research data as such a file.
Table table_of(const RobotMotion& motion) {
  Table out;
  out.fps = motion.fps;
  if (!motion.joint_names.empty()) {
    out.header.assign(kRootNames.begin(), kRootNames.end());
    out.header.insert(out.header.end(), motion.joint_names.begin(), motion.joint_names.end());
  }
  for (std::size_t f = 0; f < motion.frames(); ++f) {
    const Vec3& place = motion.root_positions[f];
    const Eigen::Quaterniond& turn = motion.root_rotations[f];
    std::vector<double>& row = out.rows.emplace_back(
        std::vector<double>{place.x(), place.y(), place.z(), turn.x(), turn.y(), turn.z(), turn.w()});
    row.insert(row.end(), motion.values(f), motion.values(f) + motion.joint_count);
  }
  return out;
}

Table read_table(const std::filesystem::path& file) {
  check_regular_file(file);
  std::ifstream in(file);
  Table out;
  std::size_t number = 0;
  const auto fail = [&](const std::string& what) {
    throw Error(ExitCode::kFile, fmt::format("{}: line {}: {}", file.string(), number, what));
  };
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (trimmed(line).empty()) continue;
    const std::vector<std::string> cells = cells_of(line);
    if (out.rows.empty() && out.header.empty() && !number_in(cells[0])) {
      out.header = cells;
      continue;
    }
    if (static_cast<double>(out.rows.size()) >= kFramesMax) fail(fmt::format("more than {:.0f} rows", kFramesMax));
    std::vector<double>& row = out.rows.emplace_back();
    for (const std::string& cell : cells) {
      const std::optional<double> value = number_in(cell);
      if (!value) fail(in_quotes(cell) + " is no number (a robot's motion is a CSV file: docs/robots.md)");
      row.push_back(*value);
    }
    if (row.size() != (out.header.empty() ? out.rows[0].size() : out.header.size()))
      fail(fmt::format("has {} numbers, and the first line {}", row.size(),
                       out.header.empty() ? out.rows[0].size() : out.header.size()));
  }
  if (out.rows.empty()) throw Error(ExitCode::kFile, file.string() + ": has no rows of numbers");
  return out;
}

std::array<double, kRootWidth> root_of(const double* numbers, const std::string& file, std::size_t row) {
  std::array<double, kRootWidth> out{};
  std::copy_n(numbers, kRootWidth, out.begin());
  if (!(Eigen::Vector4d(out.data() + 3).norm() > 0))
    throw Error(ExitCode::kFile, fmt::format("{}: row {}: the root's quaternion has no length", file, row + 1));
  return out;
}

RobotFrames frames_by_name(const SourceRig& rig, const Table& table, const std::string& file) {
  const RobotRig& robot = rig.robot;
  RobotFrames out;
  std::optional<std::size_t> time;
  std::vector<std::size_t> column_of;  // of out.joints
  std::array<std::size_t, kRootWidth> root{};
  std::size_t roots = 0;
  std::vector<std::string> unknown;
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const std::string& name = table.header[c];
    const auto of_root = std::find(kRootNames.begin(), kRootNames.end(), name);
    const auto joint =
        std::find_if(robot.joints.begin(), robot.joints.end(), [&](const RigJoint& one) { return one.name == name; });
    if (name == "time") {
      time = c;
    } else if (of_root != kRootNames.end()) {
      root[static_cast<std::size_t>(of_root - kRootNames.begin())] = c;
      ++roots;
    } else if (joint == robot.joints.end() || joint->kind == RigJointKind::kFree ||
               joint->kind == RigJointKind::kBall) {
      unknown.push_back(name);
    } else {
      out.joints.push_back(static_cast<Index>(joint - robot.joints.begin()));
      column_of.push_back(c);
    }
  }
  if (out.joints.empty() && roots == 0)
    throw Error(ExitCode::kFile,
                file + ": names no joint of the robot (its first line has " + in_quotes(table.header[0]) + ")");
  if (roots != 0 && roots != kRootWidth)
    throw Error(ExitCode::kFile, file + ": has some of the columns root_x ... root_qw, and needs all seven or none");
  if (!unknown.empty())
    add_note(fmt::format("{}: no hinge or slide of the robot, left out: {}", file, fmt::join(unknown, ", ")));
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::vector<double>& row = table.rows[r];
    out.seconds.push_back(time ? row[*time] - table.rows[0][*time] : static_cast<double>(r) / table.fps);
    if (r > 0 && !(out.seconds[r] > out.seconds[r - 1]))
      throw Error(ExitCode::kFile, fmt::format("{}: row {}: its time is not after the one before", file, r + 1));
    if (roots != 0) {
      std::array<double, kRootWidth> numbers{};
      for (std::size_t k = 0; k < kRootWidth; ++k) numbers[k] = row[root[k]];
      out.roots.push_back(root_of(numbers.data(), file, r));
    }
    std::vector<double>& values = out.values.emplace_back();
    for (const std::size_t c : column_of) values.push_back(row[c]);
  }
  return out;
}

void note_limits(const SourceRig& rig, const RobotFrames& frames, const std::string& file) {
  constexpr double kRounding = 1e-4;
  for (std::size_t k = 0; k < frames.joints.size(); ++k) {
    const RigJoint& joint = rig.robot.joints[frames.joints[k]];
    double beyond = 0, worst = 0;
    for (const std::vector<double>& values : frames.values) {
      const double by = std::max(joint.lower - values[k], values[k] - joint.upper);
      if (by > beyond) {
        beyond = by;
        worst = values[k];
      }
    }
    if (beyond <= kRounding) continue;
    add_note(fmt::format("{}: joint '{}' goes to {:.4g}, beyond its limits {:.4g} to {:.4g}", file, joint.name, worst,
                         joint.lower, joint.upper));
  }
}

}  // namespace

RobotFrames frames_of_rows(const SourceRig& rig, const std::vector<std::vector<double>>& rows, double fps,
                           const std::string& file) {
  RobotFrames out;
  for (const Index joint : driven_joints(rig.robot)) {
    if (rig.robot.joints[joint].kind == RigJointKind::kBall)
      throw Error(ExitCode::kFile, file + ": the robot has the ball joint '" + rig.robot.joints[joint].name +
                                       "': name the other joints in a header");
    out.joints.push_back(joint);
  }
  const std::size_t joints = out.joints.size();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::vector<double>& row = rows[r];
    const bool has_root = row.size() == kRootWidth + joints;
    if (!has_root && row.size() != joints) {
      throw Error(
          ExitCode::kFile,
          fmt::format("{}: has {} numbers in a row, and the robot needs {} (7 of its root and {} of its joints), "
                      "or {} without the root",
                      file, row.size(), kRootWidth + joints, joints, joints));
    }
    out.seconds.push_back(static_cast<double>(r) / fps);
    if (has_root) out.roots.push_back(root_of(row.data(), file, r));
    out.values.emplace_back(row.end() - static_cast<std::ptrdiff_t>(joints), row.end());
  }
  return out;
}

Clip clip_of_robot(const SourceRig& rig, const RobotFrames& frames, const std::string& file) {
  const RobotRig& robot = rig.robot;
  note_limits(rig, frames, file);
  std::vector<char> is_moved(rig.nodes.size(), 0);
  for (const RigJoint& joint : robot.joints) is_moved[joint.node] = 1;
  if (!frames.roots.empty()) is_moved[robot.root] = 1;
  Clip clip;
  clip.name = std::filesystem::path(file).stem().string();
  clip.duration = frames.seconds.back();
  std::vector<Channel> moves(rig.nodes.size()), turns(rig.nodes.size());
  std::vector<double> values;
  for (const RigJoint& joint : robot.joints) values.push_back(joint.zero);
  for (std::size_t f = 0; f < frames.seconds.size(); ++f) {
    for (std::size_t k = 0; k < frames.joints.size(); ++k) values[frames.joints[k]] = frames.values[f][k];
    follow_mimics(robot, values);
    for (Index n = 0; n < rig.nodes.size(); ++n) {
      if (is_moved[n] == 0) continue;
      Affine local = moved_by_joints(robot, n, values);
      if (n == robot.root && !frames.roots.empty()) {
        const std::array<double, kRootWidth>& root = frames.roots[f];
        local = Eigen::Translation3d(root[0], root[1], root[2]) *
                Eigen::Quaterniond(root[6], root[3], root[4], root[5]).normalized();
      }
      Node now;
      now.local = local;
      decompose(now);
      const Vec3& move = now.translation;
      const Eigen::Vector4d turn = now.rotation.coeffs();
      moves[n].values.insert(moves[n].values.end(), move.begin(), move.end());
      turns[n].values.insert(turns[n].values.end(), turn.begin(), turn.end());
    }
  }
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    if (is_moved[n] == 0) continue;
    moves[n] = {ChannelPath::kTranslation, n, Interpolation::kLinear, frames.seconds, std::move(moves[n].values)};
    turns[n] = {ChannelPath::kRotation, n, Interpolation::kLinear, frames.seconds, std::move(turns[n].values)};
    clip.channels.push_back(std::move(moves[n]));
    clip.channels.push_back(std::move(turns[n]));
  }
  return clip;
}

Capture read_robot_motion(const std::filesystem::path& file, const SourceRig& rig) {
  const Table table = is_arrays(file) ? table_of(read_robot_arrays(file)) : read_table(file);
  const RobotFrames frames = table.header.empty() ? frames_of_rows(rig, table.rows, table.fps, file.string())
                                                  : frames_by_name(rig, table, file.string());
  Capture out;
  out.file = file.string();
  out.rig = rig;
  out.clip = clip_of_robot(rig, frames, out.file);
  return out;
}

}  // namespace spherechain::baker
