// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/bvh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>

#include "baker/mesh/error.h"

namespace spherechain::baker {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kNestedMax = 500, kChannelsMax = 100'000;
constexpr double kLargest = 1e9;  // of a length or an angle
constexpr double kSecondsMin = 1e-4, kSecondsMax = 1000;

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::optional<double> number_of(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double out = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (error != std::errc() || end != word.data() + word.size() || !(std::abs(out) <= kLargest)) return {};
  return out;
}

// Many a file writes 1/30 s as 0.0333. The usual rate is meant that a time of three digits or more is rounded or cut
// off from.
double usual_time(std::string_view word, double seconds) {
  const std::size_t exponent_at = std::min(word.find_first_of("eE"), word.size());
  const std::string_view digits = word.substr(0, exponent_at);
  const std::size_t point = std::min(digits.find('.'), digits.size() - 1);
  double exponent = 0;
  if (exponent_at < word.size()) exponent = number_of(word.substr(exponent_at + 1)).value_or(0);
  const double last_digit = std::pow(10, exponent - static_cast<double>(digits.size() - 1 - point));
  if (seconds < 100 * last_digit) return seconds;
  for (const double rate : {30.0, 24.0, 25.0, 60.0, 120.0, 50.0, 48.0, 100.0, 90.0, 240.0, 15.0, 12.0, 30 / 1.001,
                            24 / 1.001, 60 / 1.001, 120 / 1.001}) {
    if (std::abs(seconds - 1 / rate) < last_digit) return 1 / rate;
  }
  return seconds;
}

const char* name_of(BvhChannel::Kind kind) {
  return kind == BvhChannel::Kind::kPosition ? "position" : kind == BvhChannel::Kind::kRotation ? "rotation" : "scale";
}

std::string name_of(const BvhChannel& channel) { return "XYZ"[channel.axis] + std::string(name_of(channel.kind)); }

std::optional<BvhChannel> channel_of(std::string_view word) {
  const std::string name = lower(word);
  const int axis = name.empty() ? -1 : name[0] - 'x';
  if (axis < 0 || axis > 2) return {};
  for (const auto kind : {BvhChannel::Kind::kPosition, BvhChannel::Kind::kRotation, BvhChannel::Kind::kScale}) {
    if (name.substr(1) == name_of(kind)) return BvhChannel{kind, axis};
  }
  return {};
}

class BvhReader {
 public:
  BvhReader(std::string_view text, const std::string& file, bool with_places)
      : text_(text), file_(file), with_places_(with_places) {
    if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) fail("is UTF-16 text (save it as UTF-8)");
    if (text_.starts_with(kByteOrderMark)) at_ = kByteOrderMark.size();
  }

  BvhFile read() {
    if (lower(next()) != "hierarchy") {
      fail_here("is no BVH recording: it does not begin with HIERARCHY (export it again)");
    }
    read_joints();
    read_header();
    read_frames();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_ + ": " + what); }
  [[noreturn]] void fail_here(const std::string& what) const { fail(fmt::format("line {}: {}", line_, what)); }
  std::string quoted() const {
    constexpr std::size_t kShown = 40;
    return word_.empty() ? "the file ends" : fmt::format("'{}'", word_.substr(0, kShown));
  }

  // Spaces and comments. Old Macs end a line with a carriage return alone.
  void skip_space() {
    while (true) {
      for (; at_ < text_.size() && is_space(text_[at_]); ++at_) {
        const bool ends_line = text_[at_] == '\n' || (text_[at_] == '\r' && !text_.substr(at_ + 1).starts_with('\n'));
        if (!ends_line) continue;
        ++line_;
        ended_line_ = true;
      }
      const std::string_view rest = text_.substr(at_);
      if (!ended_line_ || !(rest.starts_with('#') || rest.starts_with("//"))) return;
      at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
    }
  }

  // The next word; braces are words, and so is nothing at the end.
  std::string_view next() {
    skip_space();
    ended_line_ = false;
    const std::size_t begin = at_;
    const auto is_brace = [](char c) { return c == '{' || c == '}'; };
    const auto ends = [&](char c) { return is_space(c) || is_brace(c) || (in_header_ && c == ':'); };
    while (at_ < text_.size() && !ends(text_[at_])) ++at_;
    if (at_ == begin && at_ < text_.size()) ++at_;
    return word_ = text_.substr(begin, at_ - begin);
  }
  std::size_t place_of_word() const { return static_cast<std::size_t>(word_.data() - text_.data()); }
  // The rest of the line, or of it up to a brace.
  std::string_view rest_of_line() {
    skip_space();
    ended_line_ = false;
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r' && text_[at_] != '{') ++at_;
    std::size_t end = at_;
    while (end > begin && is_space(text_[end - 1])) --end;
    return text_.substr(begin, end - begin);
  }

  double next_number(const std::string& expected) {
    const std::optional<double> out = number_of(next());
    if (!out) fail_here(fmt::format("{} where {} is expected (a number, with a point)", quoted(), expected));
    return *out;
  }

  void open_joint(std::string name, int parent) {
    if (next() != "{") fail_here(fmt::format("{} where a brace opens the joint '{}'", quoted(), name));
    if (open_.size() == kNestedMax)
      fail_here(fmt::format("more than {} joints within each other (export fewer)", kNestedMax));
    if (parent >= 0) has_children_[static_cast<std::size_t>(parent)] = 1;
    open_.push_back(out_.joints.size());
    out_.joints.emplace_back();
    out_.joints.back().name = std::move(name);
    out_.joints.back().parent = parent;
    has_children_.push_back(0);
  }

  // Up to MOTION.
  void read_joints() {
    for (std::string word = lower(next()); word != "motion"; word = lower(next())) {
      const int parent = open_.empty() ? -1 : static_cast<int>(open_.back());
      const auto joint = [&]() -> BvhJoint& { return out_.joints[open_.back()]; };
      if (word.empty()) fail("ends before its motion (export it again)");
      if (word == "root" || (word == "joint" && parent >= 0)) {
        std::string name(rest_of_line());
        open_joint(name.empty() ? fmt::format("joint {}", out_.joints.size()) : std::move(name), parent);
      } else if ((word == "end" || word == "endsite") && parent >= 0) {
        rest_of_line();
        open_joint("EndSite_" + joint().name, parent);
      } else if (word == "}" && parent >= 0) {
        open_.pop_back();
      } else if (word == "offset" && parent >= 0) {
        for (Eigen::Index k = 0; k < 3; ++k) joint().offset[k] = next_number("OFFSET's " + std::string(1, "xyz"[k]));
      } else if (word == "channels" && parent >= 0) {
        read_channels(joint());
      } else {
        fail_here(fmt::format("{} where a joint, its OFFSET or CHANNELS, or MOTION is expected", quoted()));
      }
    }
    if (out_.width == 0) fail("has no channels: nothing moves in it (export it again)");
  }

  void read_channels(BvhJoint& joint) {
    if (has_children_[open_.back()] != 0) {
      fail_here(fmt::format("the channels of '{}' come after its children (put them before)", joint.name));
    }
    const double count = next_number("the number of channels");
    for (double c = 0; c < count; ++c) {
      const std::optional<BvhChannel> channel = channel_of(next());
      if (!channel) {
        fail_here(fmt::format("{} where channel {} of {} of '{}' is expected (Xposition, Zrotation ...)", quoted(),
                              c + 1, count, joint.name));
      }
      if (joint.channels.empty()) joint.first_column = out_.width;
      joint.channels.push_back(*channel);
      if (++out_.width > kChannelsMax) fail_here(fmt::format("more than {} channels", kChannelsMax));
    }
  }

  // The number of frames and the time of one, up to the first number of a frame.
  void read_header() {
    in_header_ = true;
    bool has_time = false;
    while (true) {
      const std::size_t begin = at_, line = line_;
      std::string word = lower(next());
      while (word == ":") word = lower(next());
      const std::size_t place = place_of_word();
      const auto value = [&] {
        do next();
        while (word_ == ":");
        return word_;
      };
      if (word == "frames") {
        stated_frames_ = number_of(value());
        out_.count_begin = place_of_word();
        out_.count_end = at_;
      } else if (word == "frametime" || (word == "frame" && lower(value()) == "time")) {
        const std::string_view text = value();
        const double seconds = number_of(text).value_or(0);
        if (!(seconds >= kSecondsMin && seconds <= kSecondsMax)) {
          fail_here(
              fmt::format("a frame time of {} (write seconds, from {} to {})", quoted(), kSecondsMin, kSecondsMax));
        }
        out_.frame_time = usual_time(text, seconds);
        has_time = true;
        if (out_.count_end == 0) out_.count_begin = out_.count_end = place;
      } else {
        if (!has_time) fail_here(fmt::format("{} where the frame time is expected (Frame Time: 0.0333333)", quoted()));
        at_ = begin;
        line_ = line;
        break;
      }
    }
    in_header_ = false;
  }

  // Frames end where lines end.
  void read_frames() {
    const std::size_t first_line = line_;
    std::size_t in_frame = 0, begun_in = first_line, filled_in = first_line;
    while (true) {
      const std::size_t before = line_;
      skip_space();
      const bool is_end = at_ >= text_.size();
      if (in_frame >= out_.width && (is_end || line_ != before)) {
        if (in_frame % out_.width != 0) fail_frame(begun_in, in_frame);
        in_frame = 0;
      }
      if (is_end) break;
      if (in_frame == 0) begun_in = line_;
      filled_in = line_;
      const std::size_t place = at_;
      const std::optional<double> number = number_of(next());
      if (!number) fail_number(in_frame % out_.width);
      if (with_places_) out_.places.push_back(place);
      out_.numbers.push_back(*number);
      ++in_frame;
    }
    if (in_frame > 0) {
      line_ = filled_in;
      fail_here(fmt::format("the file ends within frame {}, after {} of {} numbers (it is cut off: export it again)",
                            out_.frames(), in_frame, out_.width));
    }
    if (out_.numbers.empty()) fail("has no frames: nothing moves in it (export it again)");
    // Some programs state the steps between frames.
    const auto frames = static_cast<double>(out_.frames());
    if (stated_frames_ == frames || stated_frames_ == frames - 1) return;
    const std::string stated = stated_frames_ ? fmt::format("{} frames", *stated_frames_) : "no number of frames";
    out_.note = fmt::format("names {}, and has {}: these are read", stated, frames);
  }

  [[noreturn]] void fail_frame(std::size_t line, std::size_t numbers) const {
    fail(fmt::format("line {}: {} numbers, and a frame has {}, one for each channel (export it again)", line, numbers,
                     out_.width));
  }

  [[noreturn]] void fail_number(std::size_t column) const {
    std::string channel;
    for (const BvhJoint& joint : out_.joints) {
      if (column < joint.first_column || column >= joint.first_column + joint.channels.size()) continue;
      channel = name_of(joint.channels[column - joint.first_column]) + " of '" + joint.name + "'";
    }
    fail_here(fmt::format("{} in frame {} is no number, as {} (mend it, or export the recording again)", quoted(),
                          out_.frames(), channel));
  }

  std::string_view text_, word_;
  const std::string& file_;
  std::size_t at_ = 0, line_ = 1;
  bool ended_line_ = true, in_header_ = false, with_places_;
  std::vector<std::size_t> open_;  // joints whose braces are open
  std::vector<char> has_children_;
  std::optional<double> stated_frames_;
  BvhFile out_;
};

}  // namespace

bool is_bvh(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  constexpr std::string_view kFirst = "hierarchy";
  return lower(text.substr(0, kFirst.size())) == kFirst;
}

BvhFile parse_bvh(std::string_view text, const std::string& file, bool with_places) {
  return BvhReader(text, file, with_places).read();
}

}  // namespace spherechain::baker
