// SPDX-License-Identifier: GPL-3.0-or-later
// Which frames are played: each clip's own, or as many as were asked for.
#include "play/motion_frames.h"

#include <doctest/doctest.h>

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
