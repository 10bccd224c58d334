// SPDX-License-Identifier: GPL-3.0-or-later
// Which frames are played: each clip's own, or as many as were asked for.
#include "baker/play/motion_frames.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace spherechain::baker;

namespace {

// A motion of a second that knows nothing else.
struct Second : Motion {
  Deformation at(double) const override { return {}; }
  double duration() const override { return 1; }
};

struct Meshes : Motion {
  Deformation at(double) const override { return {}; }
  int frame_count() const override { return 7; }
};

struct Poses : Motion {
  Deformation at(double) const override { return {}; }
};

}  // namespace

TEST_CASE("every clip has its own frames, counted from its start") {
  const SourceRig rig;
  const Clip walk{"walk", 1.05, {}}, pose{"pose", 0, {}}, run{"run", 0.5, {}};
  const MotionFrames frames = frames_of(rig, {&walk, &pose, &run}, {0, 10});
  REQUIRE(frames.clips.size() == 3);
  REQUIRE(frames.frames.size() == 11 + 1 + 6);
  CHECK(frames.clips[0].name == "walk");
  CHECK(frames.clips[0].clip == &walk);
  CHECK(frames.clips[0].count == 11);
  CHECK(frames.clips[1].count == 1);
  CHECK(frames.clips[2].first == 12);
  CHECK(frames.clips[2].own_count == 6);
  CHECK(frames.frames[10].seconds == 1);
  CHECK(frames.frames[11].clip == 1);
  CHECK(frames.frames[11].seconds == 0);
  CHECK(frames.frames[12].seconds == 0);
  CHECK(frames.frames[14].clip == 2);
  CHECK(frames.frames[14].number == 2);
  CHECK(frames.frames[14].seconds == doctest::Approx(0.2));
  CHECK(frames.frames[14].time == doctest::Approx(1.05 + 1.0 / 30 + 0.2));  // a pose shows for a frame
}

TEST_CASE("a clip has the frames that its keys lie on, to the last, however its file rounds their times") {
  const SourceRig rig;
  const auto rounded = [](double seconds, int digits) {
    const double scale = std::pow(10, digits);
    return std::round(seconds * scale) / scale;
  };
  for (const double rate : {30.0, 24.0, 25.0, 60.0, 120.0, 30 / 1.001, 24 / 1.001}) {
    for (const int digits : {4, 5, 6, 7, 17}) {
      for (const int count : {1, 2, 13, 50, 51, 1000}) {
        for (const bool add_up : {false, true}) {  // a rounded step, over and over
          CAPTURE(rate);
          CAPTURE(digits);
          CAPTURE(count);
          CAPTURE(add_up);
          Channel turn{ChannelPath::kTranslation, 0, Interpolation::kLinear, {}, {}};
          for (int i = 0; i < count; ++i) {
            const double time = add_up ? i * rounded(1 / rate, digits) : rounded(i / rate, digits);
            turn.times.push_back(static_cast<double>(static_cast<float>(time)));
            turn.values.insert(turn.values.end(), {1.0 * i, 0, 0});
          }
          const Clip clip{"clip", turn.times.back(), {turn}};
          for (const double fps : {0.0, rate, std::round(rate)}) {
            const MotionFrames frames = frames_of(rig, {&clip}, {0, fps});
            REQUIRE(frames.frames.size() == static_cast<std::size_t>(count));
            CHECK(sample(turn, frames.frames.back().seconds)[0] > count - 1.1);
            CHECK(sample(turn, frames.frames.back().seconds)[0] <= count - 1);
          }
          if (rate > 100 && digits > 5) CHECK(frames_of(rig, {&clip}, {0, 30}).frames.size() == (count + 3U) / 4);
        }
      }
    }
  }
}

TEST_CASE("a number of frames is spread over all clips, and says where in its clip each is") {
  const SourceRig rig;
  const Clip walk{"walk", 3, {}}, run{"run", 1, {}};
  const MotionFrames frames = frames_of(rig, {&walk, &run}, {5, 30});
  REQUIRE(frames.frames.size() == 5);
  REQUIRE(frames.clips.size() == 2);
  CHECK(frames.clips[0].count == 3);
  CHECK(frames.clips[0].own_count == 91);
  CHECK(frames.clips[1].first == 3);
  CHECK(frames.frames[2].number == 60);
  CHECK(frames.frames[3].number == 0);
  CHECK(frames.frames[4].number == 30);
  CHECK(frames.frames[4].time == 4);
  const MotionFrames few = frames_of(rig, {&walk, &run}, {1, 30});
  CHECK(few.clips.size() == 1);  // clips without a frame are left out
}

TEST_CASE("other motions have the frames they are made of, or their pace's, or 40; the rest pose is one") {
  const Second second;
  const MotionFrames paced = frames_of(&second, {0, 4});
  REQUIRE(paced.frames.size() == 5);
  CHECK(paced.frames[3].along == doctest::Approx(0.75));
  CHECK(paced.frames[3].time == doctest::Approx(0.75));
  CHECK(paced.frames[3].number == 3);
  const MotionFrames spread = frames_of(&second, {3, 30});
  CHECK(spread.frames[1].number == 15);
  CHECK(spread.clips[0].own_count == 31);
  const Meshes meshes;
  CHECK(frames_of(&meshes, {}).frames.size() == 7);
  CHECK(frames_of(&meshes, {4, 30}).frames[1].number == 2);
  const Poses poses;
  CHECK(frames_of(&poses, {}).frames.size() == 40);
  CHECK(frames_of(&poses, {5, 10}).frames[4].time == doctest::Approx(0.4));
  CHECK(frames_of(&poses, {1, 30}).frames[0].along == 1);  // the pose, not rest
  CHECK(frames_of(&meshes, {1, 30}).frames[0].along == 0);
  CHECK(frames_of(nullptr, {}).frames.size() == 1);
  CHECK(frames_of(nullptr, {3, 30}).frames.size() == 3);
}
