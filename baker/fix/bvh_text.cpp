// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/bvh_text.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>

#include "mesh/error.h"

namespace spherechain::baker {

// The words of a text, one after another.
class BvhWords {
 public:
  BvhWords(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }

  // Empty at the end.
  std::string_view next() {
    const auto is_space = [&] { return std::isspace(static_cast<unsigned char>(text_[at_])) != 0; };
    while (at_ < text_.size() && is_space()) ++at_;
    begin_ = at_;
    while (at_ < text_.size() && !is_space()) ++at_;
    return std::string_view(text_).substr(begin_, at_ - begin_);
  }
  void expect(const char* word) {
    if (next() != word) fail(std::string("is no BVH file that can be written again ('") + word + "' is missing)");
  }
  double number() {
    const std::string word(next());
    char* end = nullptr;
    const double out = std::strtod(word.c_str(), &end);
    if (word.empty()) fail("ends before its motion does");
    if (*end != '\0' || !std::isfinite(out)) fail("'" + word + "' is no number");
    return out;
  }
  std::size_t begin() const { return begin_; }  // of the last word
  std::size_t end() const { return at_; }

 private:
  const std::string &text_, &file_;
  std::size_t begin_ = 0, at_ = 0;
};

namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

Eigen::Quaterniond about(int axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees / kDegreesPerRadian, Eigen::Vector3d::Unit(axis)));
}

// The same angle, as near to another as whole turns bring it.
double wound(double degrees, double near) { return degrees + 360 * std::round((near - degrees) / 360); }

}  // namespace

BvhText::BvhText(std::string text, const std::string& file) : text_(std::move(text)), file_(file) {
  BvhWords words(text_, file_);
  words.expect("HIERARCHY");
  read_joints(words);
  words.expect("Frames:");
  const double frames = words.number();
  words.expect("Frame");
  words.expect("Time:");
  frame_time_ = words.number();
  if (width_ == 0 || !(frames >= 1) || !(frame_time_ > 0)) words.fail("has no motion");
  for (std::size_t i = 0; i < static_cast<std::size_t>(frames) * width_; ++i) {
    const double value = words.number();
    numbers_.push_back({words.begin(), words.end() - words.begin(), value});
  }
}

// Up to the word MOTION.
void BvhText::read_joints(BvhWords& words) {
  std::set<std::string> names;
  for (std::string_view word = words.next(); word != "MOTION"; word = words.next()) {
    if (word.empty()) words.fail("ends before its motion");
    if (word == "ROOT" || word == "JOINT") {
      joints_.push_back({std::string(words.next()), {}, {}});
      if (!names.insert(joints_.back().name).second) {
        words.fail("two joints are called '" + joints_.back().name + "' (name them apart)");
      }
    }
    if (word != "CHANNELS" || joints_.empty()) continue;
    for (double left = words.number(); left >= 1; --left, ++width_) {
      const std::string channel(words.next());
      if (channel.size() != 9 || channel.substr(1) != "rotation") continue;
      joints_.back().axes.push_back(channel[0] == 'X' ? 0 : channel[0] == 'Y' ? 1 : 2);
      joints_.back().columns.push_back(width_);
    }
  }
}

Eigen::Quaterniond BvhText::rotation(int frame, const Joint& joint) const {
  Eigen::Quaterniond out = Eigen::Quaterniond::Identity();
  for (std::size_t k = 0; k < joint.axes.size(); ++k) {
    out = out * about(joint.axes[k], number(frame, joint.columns[k]).value);
  }
  return out;
}

void BvhText::turn(int frame, const Joint& joint, const Eigen::Quaterniond& rotation) {
  Eigen::Vector3d near;
  for (std::size_t k = 0; k < 3; ++k) {
    near[static_cast<Eigen::Index>(k)] = number(frame, joint.columns[k]).value;
    if (frame == 0) continue;
    const std::size_t before = static_cast<std::size_t>(frame - 1) * width_ + joint.columns[k];
    const auto changed = changed_.find(before);
    if (changed != changed_.end()) near[static_cast<Eigen::Index>(k)] += changed->second - numbers_[before].value;
  }
  const Eigen::Vector3d one =
      rotation.toRotationMatrix().eulerAngles(joint.axes[0], joint.axes[1], joint.axes[2]) * kDegreesPerRadian;
  Eigen::Vector3d best;
  double least = HUGE_VAL;
  for (const Eigen::Vector3d& angles : {one, Eigen::Vector3d(one[0] + 180, 180 - one[1], one[2] + 180)}) {
    Eigen::Vector3d here;
    for (Eigen::Index k = 0; k < 3; ++k) here[k] = wound(angles[k], near[k]);
    if (const double apart = (here - near).norm(); apart < least) {
      least = apart;
      best = here;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    changed_[static_cast<std::size_t>(frame) * width_ + joint.columns[k]] = best[static_cast<Eigen::Index>(k)];
  }
}

std::string BvhText::text() const {
  std::string out;
  std::size_t at = 0;
  for (const auto& [place, degrees] : changed_) {
    const Number& number = numbers_[place];
    out.append(text_, at, number.at - at);
    out += fmt::format("{:.6f}", degrees == 0 ? 0.0 : degrees);
    at = number.at + number.size;
  }
  return out + text_.substr(at);
}

}  // namespace spherechain::baker
