// SPDX-License-Identifier: GPL-3.0-or-later
// spherechain_bench_response [--each] [--fps N] [--seconds S] ASSET SOURCE [ASSET SOURCE ...]: characters as animated,
// by sc_respond and by capsules, in one run. All are measured by penetrations in full, as `play --respond` does.
// `--each` prints every frame, too.
// With --facing, --beside or --passing METRES ASSET SOURCE ASSET SOURCE: two characters that stand so, and stay out of
// each other. Any number of these.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "baker/play/responder.h"
#include "baker/play/target.h"
#include "capsule_response.h"
#include "table.h"
#include "two_characters.h"

using namespace spherechain;

namespace {

constexpr double kHuman = 1750;  // millimetres

void print(const std::string& name, const baker::ResponseMeasures& of) {
  fmt::print("{:10} {:8} {:6} {:6.2f} {:6.2f} {:8.0f} {:8} {:9.1f} {:9.1f} {:8.0f} {:8.0f}\n", name, of.faulty_after,
             of.new_faults, of.wrist_acceleration, of.elbow_acceleration, kHuman * of.largest_jump, of.flickers,
             100 * of.moved_without_fault, kHuman * of.residual_p95, of.us_mean, of.us_p99);
}

// A row of the tables in docs/response-figures.md: the response before the slash, capsules after it.
struct Row {
  std::string name;
  baker::ResponseMeasures response, capsules;

  std::string text() const {
    const baker::ResponseMeasures &r = response, &c = capsules;
    return fmt::format(
        "| {} | {} | {} / {} | {} / {} | {:.2f} / {:.2f} | {:.2f} / {:.2f} | {:.0f} / {:.0f} | {} / {} | "
        "{:.0f} / {:.0f} | {:.0f} / {:.0f} |",
        name, r.faulty_before, r.faulty_after, c.faulty_after, r.new_faults, c.new_faults, r.wrist_acceleration,
        c.wrist_acceleration, r.elbow_acceleration, c.elbow_acceleration, kHuman * r.largest_jump,
        kHuman * c.largest_jump, r.flickers, c.flickers, 100 * r.moved_without_fault, 100 * c.moved_without_fault,
        r.us_mean, c.us_mean);
  }
};

void print(const std::vector<Row>& rows) {
  int frames = 0, before = 0, response = 0, capsules = 0;
  for (const Row& row : rows) {
    fmt::print("{}\n", row.text());
    frames += row.response.frames;
    before += row.response.faulty_before;
    response += row.response.faulty_after;
    capsules += row.capsules.faulty_after;
  }
  fmt::print("\n{} of {} frames had a fault of an arm, {} by the response, {} by capsules\n", before, frames, response,
             capsules);
}

double depth_of(const baker::ArmPose& pose, double height) {
  double deepest = 0;
  for (const Penetration& fault : pose.faults) deepest = std::max(deepest, double{fault.measures.depth});
  return kHuman * deepest / height;
}

// The deepest fault, and how far wrists and elbows are moved.
std::string text_of(const baker::ArmPose& before, const baker::ArmPose& after, double height) {
  std::string out = fmt::format("fault {:5.1f}, wrists", depth_of(after, height));
  const auto add = [&](const std::vector<baker::Vec3>& from, const std::vector<baker::Vec3>& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      out += fmt::format(" {:5.1f}", kHuman * (to[i] - from[i]).norm() / height);
    }
  };
  add(before.wrists, after.wrists);
  out += ", elbows";
  add(before.elbows, after.elbows);
  return out;
}

struct Choice {
  double fps = 30, seconds = 1e9;  // of the animation, counted through all clips
  bool each = false;
};

Row run(const char* asset, const char* source, const Choice& choice) {
  const baker::AnimatedAsset animated(asset, source, baker::MotionChoice(), baker::FrameChoice{0, choice.fps});
  const Target target = baker::choose_target("auto");
  baker::Responder responder(animated, target, 0);
  bench::CapsuleResponse capsules(animated);
  baker::ArmMeter meter(animated, target);
  const double height = animated.frame().height;
  baker::ResponseTally as_animated(height), by_response(height), by_capsules(height);
  for (int f = 0; f < animated.frame_count() && f < choice.seconds * choice.fps; ++f) {
    const baker::Responder::Corrected response = responder.correct(f);
    const bool starts = response.starts_clip;
    const double passed = starts ? 0 : animated.frame_at(f).seconds - animated.frame_at(f - 1).seconds;
    const bench::CapsuleResponse::Corrected pushed = capsules.correct(response.animated, passed, starts);
    const baker::ArmPose before = meter.look_at(response.animated);
    as_animated.add(before, before, 0, starts);
    const baker::ArmPose turned = response.is_turned ? meter.look_at(response.corrected) : before;
    const baker::ArmPose apart = meter.look_at(pushed.pose);
    by_response.add(before, turned, response.us, starts);
    by_capsules.add(before, apart, pushed.us, starts);
    if (choice.each) {
      fmt::print("frame {}: fault {:5.1f} | response: {} | capsules: {}\n", f, depth_of(before, height),
                 text_of(before, turned, height), text_of(before, apart, height));
    }
  }
  const baker::ResponseMeasures measures = as_animated.measures();
  const std::string name = std::filesystem::path(source).stem().string();
  fmt::print("{}: {} frames at {:g} a second\n", name, measures.frames, choice.fps);
  fmt::print("{:10} {:>8} {:>6} {:>6} {:>6} {:>8} {:>8} {:>9} {:>9} {:>8} {:>8}\n", "", "faulty", "new", "wrist",
             "elbow", "jump mm", "flickers", "moved %", "p95 mm", "us", "p99");
  print("animated", measures);
  print("response", by_response.measures());
  print("capsules", by_capsules.measures());
  fmt::print("\n");
  std::fflush(stdout);
  return {name, by_response.measures(), by_capsules.measures()};
}

std::optional<bench::Stance> stance_of(const std::string& word) {
  if (word == "--facing") return bench::Stance::kFacing;
  if (word == "--beside") return bench::Stance::kBeside;
  return word == "--passing" ? std::optional(bench::Stance::kPassing) : std::nullopt;
}

// Two characters of four files.
struct Two {
  bench::Stance stance;
  const char *name, *metres;  // as it was asked for
  const char* const* files;
};

void print_heads_of_two() {
  fmt::print(
      "| | frames | arm in the other | anything in the other | alone, first | alone, second | new | wrists | elbows | "
      "jump, "
      "mm | flickers | left, mm | us a character |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

// Both are measured together: an arm's faults with the other character, wrists and elbows of both.
void run(const Two& asked, const Choice& choice) {
  const baker::FrameChoice frames{0, choice.fps};
  const char* const* const files = asked.files;
  const baker::AnimatedAsset first(files[0], files[1], baker::MotionChoice(), frames),
      second(files[2], files[3], baker::MotionChoice(), frames);
  constexpr double kMetres = kHuman / 1000;
  bench::TwoCharacters two(first, second, baker::choose_target("auto"), asked.stance, std::stod(asked.metres));
  baker::ResponseTally both(kMetres),
      alone[] = {baker::ResponseTally(first.frame().height), baker::ResponseTally(second.frame().height)};
  int before = 0, after = 0;
  double left = 0;
  for (int f = 0; f < two.frame_count() && f < choice.seconds * choice.fps; ++f) {
    const bench::TwoCharacters::Frame frame = two.frame(f);
    both.add(frame.before, frame.after, frame.us, frame.starts_clip);
    for (std::size_t i = 0; i < 2; ++i) {
      alone[i].add(frame.alone_before[i], frame.alone_after[i], 0, frame.starts_clip);
    }
    before += frame.is_faulty_before ? 1 : 0;
    after += frame.is_faulty_after ? 1 : 0;
    left = std::max(left, depth_of(frame.after, kMetres));
    if (choice.each) {
      fmt::print("frame {}: fault {:5.1f} | response: {}\n", f, depth_of(frame.before, kMetres),
                 text_of(frame.before, frame.after, kMetres));
    }
  }
  const baker::ResponseMeasures m = both.measures(), own[] = {alone[0].measures(), alone[1].measures()};
  const auto name = [](const char* source) { return std::filesystem::path(source).stem().string(); };
  fmt::print(
      "| {} {}: {}, {} | {} | {} / {} | {} / {} | {} / {} | {} / {} | {} | {:.2f} | {:.2f} | {:.0f} | {} | {:.0f} | "
      "{:.0f} |\n",
      asked.name, asked.metres, name(files[1]), name(files[3]), m.frames, m.faulty_before, m.faulty_after, before,
      after, own[0].faulty_before, own[0].faulty_after, own[1].faulty_before, own[1].faulty_after, m.new_faults,
      m.wrist_acceleration, m.elbow_acceleration, kHuman * m.largest_jump, m.flickers, left, m.us_mean / 2);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  std::vector<const char*> files;
  std::vector<Two> twos;
  Choice choice;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if ((word == "--fps" || word == "--seconds") && i + 1 < argc) {
      (word == "--fps" ? choice.fps : choice.seconds) = std::stod(argv[++i]);
    } else if (const auto stance = stance_of(word); stance && i + 5 < argc) {
      twos.push_back({*stance, argv[i] + 2, argv[i + 1], argv + i + 2});
      i += 5;
    } else if (word == "--each") {
      choice.each = true;
    } else {
      files.push_back(argv[i]);
    }
  }
  if (files.empty() == twos.empty() || files.size() % 2 != 0) throw std::runtime_error("pass pairs of ASSET SOURCE");
  fmt::print("{}\n\n", bench::machine());
  std::fflush(stdout);
  if (!twos.empty()) print_heads_of_two();
  for (const Two& two : twos) run(two, choice);
  if (!twos.empty()) return 0;
  std::vector<Row> rows;
  for (std::size_t i = 0; i < files.size(); i += 2) rows.push_back(run(files[i], files[i + 1], choice));
  print(rows);
  return 0;
} catch (const std::exception& e) {
  fmt::print(stderr, "spherechain_bench_response: {}\n", e.what());
  return 1;
}
