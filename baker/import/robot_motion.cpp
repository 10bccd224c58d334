// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/robot_motion.h"

#include <fmt/format.h>

#include <initializer_list>

#include "baker/import/archive.h"
#include "baker/import/notes.h"
#include "baker/import/read_in_child.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

// Some converters write w first. A robot stands upright most of the time, and read the wrong way it would not.
bool is_w_first(const std::vector<double>& rotations) {
  double upright_last = 0, upright_first = 0;
  for (std::size_t k = 0; k + 3 < rotations.size(); k += 4) {
    const double* q = rotations.data() + k;
    upright_last += 1 - 2 * (q[0] * q[0] + q[1] * q[1]);
    upright_first += 1 - 2 * (q[1] * q[1] + q[2] * q[2]);
  }
  return upright_last < 0 && upright_first > 0;
}

class MotionOfArrays {
 public:
  MotionOfArrays(const Arrays& arrays, const std::string& file) : arrays_(arrays), file_(file) {}

  std::optional<RobotMotion> read() {
    const Array* joints = find({"dof_pos", "dof"});
    if (joints == nullptr) return std::nullopt;
    const Array *places = find({"root_pos", "root_trans_offset"}), *turns = find({"root_rot"});
    if (places == nullptr || turns == nullptr) fail("has joints of a robot, but no 'root_pos' and 'root_rot'");
    check(*joints, "dof_pos", 0, 0);
    const std::size_t frames = joints->shape[0];
    check(*places, "root_pos", frames, 3);
    check(*turns, "root_rot", frames, 4);
    RobotMotion out;
    out.fps = frame_rate(arrays_, file_);
    out.joint_count = joints->numbers.size() / frames;
    out.joint_values = joints->numbers;
    const bool w_first = is_w_first(turns->numbers);
    if (w_first) add_note(file_ + ": its 'root_rot' is upright only with w first, so it is read that way");
    for (std::size_t f = 0; f < frames; ++f) {
      const double *p = places->numbers.data() + 3 * f, *q = turns->numbers.data() + 4 * f;
      const Eigen::Quaterniond turn =
          w_first ? Eigen::Quaterniond(q[0], q[1], q[2], q[3]) : Eigen::Quaterniond(q[3], q[0], q[1], q[2]);
      constexpr double kNormMin = 0.5;
      if (turn.norm() < kNormMin) fail(fmt::format("'root_rot' of frame {} is no unit quaternion", f));
      out.root_positions.emplace_back(p[0], p[1], p[2]);
      out.root_rotations.push_back(turn.normalized());
    }
    if (const Array* names = find({"dof_names", "joint_names"}); names != nullptr && !names->texts.empty()) {
      if (names->texts.size() != out.joint_count)
        fail(fmt::format("has {} names for {} joints", names->texts.size(), out.joint_count));
      out.joint_names = names->texts;
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  const Array* find(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (const Array* found = find_table(arrays_, name, file_); found != nullptr) return found;
    }
    return nullptr;
  }
  // Frames and numbers of a frame; 0: any.
  void check(const Array& table, const char* name, std::size_t frames, std::size_t width) const {
    const std::size_t rows = table.shape.empty() ? 0 : table.shape[0];
    const std::size_t columns = rows == 0 ? 0 : table.numbers.size() / rows;
    if (columns == 0 || (frames > 0 && rows != frames) || (width > 0 && columns != width)) {
      fail(fmt::format("'{}' has {} rows of {} numbers; {} of {} are expected", name, rows, columns,
                       frames > 0 ? std::to_string(frames) : "some",
                       width > 0 ? std::to_string(width) : "one a joint"));
    }
  }

  const Arrays& arrays_;
  const std::string& file_;
};

// The motion that the child process sends, with its notes.
struct NotedMotion {
  RobotMotion motion;
  std::vector<std::string> notes;
};
void members(auto& io, Is<NotedMotion> auto& m) {
  io(m.motion.fps, m.motion.root_positions, m.motion.root_rotations, m.motion.joint_count, m.motion.joint_values,
     m.motion.joint_names, m.notes);
}

}  // namespace

std::optional<RobotMotion> robot_motion(const Arrays& arrays, const std::string& file) {
  return MotionOfArrays(arrays, file).read();
}

RobotMotion read_robot_arrays(const std::filesystem::path& path) {
  check_regular_file(path);
  const std::string name = path.string();
  auto read = from_bytes<NotedMotion>(read_in_child(name, [&] {
    take_notes();  // the parent's
    const Arrays arrays = read_arrays(path);
    auto motion = robot_motion(arrays, name);
    if (!motion)
      throw Error(ExitCode::kFile, name + ": holds no motion of a robot ('root_pos', 'root_rot', 'dof_pos')");
    NotedMotion out{std::move(*motion), take_notes()};
    return to_bytes(out);
  }));
  for (const std::string& note : read.notes) add_note(note);
  return std::move(read.motion);
}

}  // namespace spherechain::baker
