// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/robot_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>

#include "baker/import/archive.h"
#include "baker/import/notes.h"
#include "baker/import/read_in_child.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr std::size_t kRoot = 7;  // numbers of the root's place

bool ends_with_csv(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".csv";
}

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

// The tables of a .csv, by GMR's names.
Arrays parse_csv(std::string_view text, const std::string& file) {
  Arrays out;
  Array &places = out["root_pos"], &turns = out["root_rot"], &joints = out["dof_pos"];
  out["fps"].numbers = {30};
  std::size_t line = 0, frames = 0, width = 0;
  std::vector<std::string> names;
  const auto fail = [&](const std::string& what) {
    throw Error(ExitCode::kFile, fmt::format("{}: line {}: {}", file, line, what));
  };
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view row = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (row.ends_with('\r')) row.remove_suffix(1);
    if (row.empty()) continue;
    std::vector<double> numbers;
    std::vector<std::string> words;
    while (true) {
      const std::size_t comma = std::min(row.find(','), row.size());
      std::string_view word = row.substr(0, comma);
      while (word.starts_with(' ')) word.remove_prefix(1);
      while (word.ends_with(' ')) word.remove_suffix(1);
      double number = 0;
      const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), number);
      if (error == std::errc() && last == word.data() + word.size() && !word.empty()) numbers.push_back(number);
      words.emplace_back(word);
      if (comma == row.size()) break;
      row.remove_prefix(comma + 1);
    }
    if (frames == 0 && names.empty() && numbers.empty()) {
      names = std::move(words);
      continue;
    }
    if (numbers.size() != words.size()) fail("has a word that is no number");
    if (width == 0) width = numbers.size();
    if (width <= kRoot || numbers.size() != width || (!names.empty() && names.size() != width))
      fail(fmt::format("{} numbers, where x y z, a quaternion x y z w and joints are expected, as in every line",
                       numbers.size()));
    const auto at = numbers.begin();
    places.numbers.insert(places.numbers.end(), at, at + 3);
    turns.numbers.insert(turns.numbers.end(), at + 3, at + kRoot);
    joints.numbers.insert(joints.numbers.end(), at + kRoot, numbers.end());
    ++frames;
  }
  if (frames == 0) throw Error(ExitCode::kFile, file + ": has no frames");
  places.shape = {frames, 3};
  turns.shape = {frames, 4};
  joints.shape = {frames, width - kRoot};
  if (!names.empty()) out["dof_names"].texts.assign(names.begin() + kRoot, names.end());
  return out;
}

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

bool is_robot_motion(const std::filesystem::path& path) { return ends_with_csv(path) || is_arrays(path); }

RobotMotion read_robot_motion(const std::filesystem::path& path) {
  check_regular_file(path);
  const std::string name = path.string();
  auto read = from_bytes<NotedMotion>(read_in_child(name, [&] {
    take_notes();  // the parent's
    Arrays arrays;
    if (ends_with_csv(path)) {
      std::ifstream file(path, std::ios::binary);
      arrays = parse_csv(std::string(std::istreambuf_iterator<char>(file), {}), name);
    } else {
      arrays = read_arrays(path);
    }
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
