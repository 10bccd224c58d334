// SPDX-License-Identifier: GPL-3.0-or-later
// BVH recordings as programs write them: what is readable is read, and the rest refused by line.
#include "baker/import/bvh_file.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "human.h"
#include "temporary_folder.h"

using namespace spherechain::baker;

namespace {

const std::string kJoints =
    "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 90 0\n\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
    "Yrotation\n"
    "\tJOINT Chest\n\t{\n\t\tOFFSET 0 30 0\n\t\tCHANNELS 3 Zrotation Xrotation Yrotation\n"
    "\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 20 0\n\t\t}\n\t}\n}\n";
const std::string kRows = "0 90 0 0 0 0 10 0 0\n1 90 0 0 0 0 20 0 0\n2 90.5 0 0 0 0 -30 0 5\n";
const std::string kGood = kJoints + "MOTION\nFrames: 3\nFrame Time: 0.0333333\n" + kRows;

std::string with(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(text.find(from) != std::string::npos);
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

std::string bvh_refusal(const std::string& text) {
  try {
    parse_bvh(text, "a.bvh");
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kFile);
    return error.what();
  }
  return "accepted";
}

SourceMesh read(const std::string& text) {
  const TemporaryFolder folder;
  return read_source(folder.write("a.bvh", text));
}

// Where the joints of a recording are in one of its frames.
std::vector<Vec3> places_in(const SourceRig& rig, std::size_t frame) {
  const Clip& clip = rig.clips[0];
  const std::vector<double>* times = nullptr;
  for (const Channel& channel : clip.channels) {
    if (times == nullptr || channel.times.size() > times->size()) times = &channel.times;
  }
  std::vector<Vec3> out;
  for (const Affine& node : world_at(rig, clip, (*times)[frame])) out.push_back(node.translation());
  return out;
}

}  // namespace

TEST_CASE("a recording is read as assimp reads it") {
  for (const char* name : {"01_01.bvh", "01_03.bvh", "Boxing_Toes.bvh"}) {
    CAPTURE(name);
    const SourceRig own = read_source(kModels / "BVH" / name).rig,
                    theirs = read_with_assimp(kModels / "BVH" / name).rig;
    REQUIRE(own.nodes.size() == theirs.nodes.size());
    for (std::size_t n = 0; n < own.nodes.size(); ++n) {
      CHECK(own.nodes[n].name == theirs.nodes[n].name);
      CHECK(own.nodes[n].parent == theirs.nodes[n].parent);
    }
    // Boxing_Toes has a frame of 0.01 s more than it states, which assimp leaves out.
    CHECK(std::abs(own.clips[0].duration - theirs.clips[0].duration) < 0.0101);
    for (const std::size_t frame : {0, 1, 700, 2750}) {
      const std::vector<Vec3> a = places_in(own, frame), b = places_in(theirs, frame);
      for (std::size_t n = 0; n < a.size(); ++n) CHECK((a[n] - b[n]).norm() < 1e-4);  // singles, of about 100 units
    }
  }
}

TEST_CASE("what programs write otherwise is the same recording") {
  const BvhFile good = parse_bvh(kGood, "a.bvh");
  REQUIRE(good.joints.size() == 3);
  CHECK(good.joints[2].name == "EndSite_Chest");
  CHECK(good.joints[2].offset == Vec3(0, 20, 0));
  CHECK(good.frame_time == 1.0 / 30);
  CHECK(good.numbers[15] == 20);
  const std::vector<std::pair<const char*, std::string>> others{
      {"lines of DOS", with(kGood, "\n", "\r\n")},
      {"lines of old Macs", with(kGood, "\n", "\r")},
      {"a byte order mark", "\xEF\xBB\xBF" + kGood},
      {"keywords in small letters",
       with(with(with(with(with(with(with(with(kGood, "HIERARCHY", "hierarchy"), "ROOT", "Root"), "JOINT", "joint"),
                                "CHANNELS", "channels"),
                           "OFFSET", "offset"),
                      "rotation", "ROTATION"),
                 "MOTION", "Motion"),
            "End Site", "end site")},
      {"tabs and blanks at the ends of lines", with(with(kGood, "\n", " \t\n"), " 0 ", "\t0 ")},
      {"braces beside names", with(with(kGood, "Hips\n{", "Hips {"), "Chest\n\t{", "Chest{")},
      {"no end of the last line", kGood.substr(0, kGood.size() - 1)},
      {"empty lines", with(kGood, "\n", "\n\n")},
      {"comments", with(with(kGood, "MOTION", "# made by hand\nMOTION"), "1 90 0", "// here\n1 90 0")},
      {"no blank after a colon", with(with(kGood, "Frames: ", "Frames:"), "Time: ", "Time:")},
      {"no colon", with(with(kGood, "Frames:", "FRAMES"), "Time:", "time")},
      {"powers of ten, and signs",
       with(with(with(kGood, "90.5", "+9.05E+01"), "-30", "-3.0e1"), "0.0333333", "3.33333e-2")},
      {"a frame on two lines", with(with(kGood, "0 0 0 20", "0 0\n0 20"), "0 0 0 10", "0 0\n0 10")},
      {"a name for the end site", with(kGood, "End Site", "End Site Crown")}};
  for (const auto& [what, text] : others) {
    CAPTURE(what);
    const BvhFile same = parse_bvh(text, "a.bvh");
    REQUIRE(same.joints.size() == good.joints.size());
    for (std::size_t j = 0; j < good.joints.size(); ++j) {
      CHECK(same.joints[j].name == good.joints[j].name);
      CHECK(same.joints[j].parent == good.joints[j].parent);
      CHECK(same.joints[j].offset == good.joints[j].offset);
      CHECK(same.joints[j].first_column == good.joints[j].first_column);
    }
    CHECK(same.frame_time == good.frame_time);
    CHECK(same.numbers == good.numbers);
    CHECK(same.note.empty());
  }
  const BvhFile spaced = parse_bvh(with(kGood, "JOINT Chest", "JOINT Bip01 L UpperArm \t"), "a.bvh");
  CHECK(spaced.joints[1].name == "Bip01 L UpperArm");
  CHECK(spaced.joints[2].name == "EndSite_Bip01 L UpperArm");
}

TEST_CASE("all frames of a recording are read, and another number of them in its header is reported") {
  for (const char* stated : {"1", "4", "0", "4000000000", "-1", "many"}) {
    CAPTURE(stated);
    const BvhFile bvh = parse_bvh(with(kGood, "Frames: 3", std::string("Frames: ") + stated), "a.bvh");
    CHECK(bvh.frames() == 3);
    CHECK(bvh.note.find("has 3") != std::string::npos);
  }
}

TEST_CASE("a frame time that is rounded means the usual rate it is rounded from") {
  const auto rate = [](const std::string& time) {
    return 1 / parse_bvh(with(kGood, "0.0333333", time), "a.bvh").frame_time;
  };
  for (const char* time : {"0.0333", "0.03333", "0.033333", ".0333333", "0.0333333333"})
    CHECK(rate(time) == doctest::Approx(30).epsilon(1e-12));
  for (const char* time : {"0.041667", "0.041666", "0.0417"}) CHECK(rate(time) == doctest::Approx(24).epsilon(1e-12));
  CHECK(rate("0.00833") == doctest::Approx(120).epsilon(1e-12));
  CHECK(rate("0.0333667") == doctest::Approx(30 / 1.001).epsilon(1e-12));
  CHECK(rate("0.0417083") == doctest::Approx(24 / 1.001).epsilon(1e-12));
  CHECK(rate("0.04") == 25);
  CHECK(rate("0.032") == 1 / 0.032);
  CHECK(rate("0.03") == 1 / 0.03);
}

TEST_CASE("joints move, turn and grow by the channels that they have, in any order") {
  const auto turned = [](int axis, double degrees) {
    return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::Unit(axis));
  };
  const std::string text =
      "HIERARCHY\nROOT a\n{\nOFFSET 1 2 3\nCHANNELS 3 Yrotation Xposition Zrotation\nJOINT b\n{\nOFFSET 0 5 0\n"
      "CHANNELS 4 Xrotation Xposition Yposition Yscale\nJOINT c\n{\nOFFSET 0 1 0\nCHANNELS 0\n}\n}\n}\n"
      "ROOT d\n{\nOFFSET 7 7 7\nCHANNELS 1 Xrotation\n}\nMOTION\nFrames: 1\nFrame Time: 0.04\n30 9 40 50 1 5 2 60\n";
  const SourceRig rig = read(text).rig;
  const std::vector<Affine> world = world_at(rig, rig.clips[0], 0);
  const Vec3 a(9, 2, 3);
  const Eigen::Matrix3d of_a = (turned(1, 30) * turned(2, 40)).toRotationMatrix();
  CHECK(world[0].linear().isApprox(of_a));
  CHECK(world[1].translation().isApprox(a + of_a * Vec3(1, 5, 0)));
  CHECK(world[2].translation().isApprox(a + of_a * (Vec3(1, 5, 0) + turned(0, 50) * Vec3(0, 2, 0))));
  CHECK(world[3].translation() == Vec3(7, 7, 7));
  CHECK(rig.nodes[3].parent == -1);
  // Positions that begin at the offset are added to it.
  const SourceRig added = read(with(text, "50 1 5 2", "50 0.1 0.2 2")).rig;
  const std::vector<Affine> moved = world_at(added, added.clips[0], 0);
  CHECK(moved[1].translation().isApprox(a + of_a * Vec3(0.1, 5.2, 0)));
}

TEST_CASE("what is wrong with a recording is reported by line, joint and frame") {
  const std::vector<std::array<std::string, 2>> cases{
      {with(kGood, "-30", "nan"), "line 21: 'nan' in frame 2 is no number, as Zrotation of 'Chest'"},
      {with(kGood, "20 0 0", "1.#QNAN 0 0"), "line 20: '1.#QNAN' in frame 1"},
      {with(kGood, "-30", "1e30"), "line 21: '1e30' in frame 2 is no number"},
      {with(kGood, "90.5", "90,5"), "line 21: '90,5' in frame 2 is no number, as Yposition of 'Hips'"},
      {with(kGood, "OFFSET 0 30", "OFFSET 0 inf"), "line 8: 'inf' where OFFSET's y is expected"},
      {with(kGood, "1 90 0 0", "1 90 0 0 7"), "line 20: 10 numbers, and a frame has 9"},
      {with(kGood, "1 90 0 0", "1 90 0"), "line 20: 17 numbers, and a frame has 9"},
      {kGood.substr(0, kGood.size() - 5), "line 21: the file ends within frame 2, after 7 of 9 numbers"},
      {kJoints + "MOTION\nFrames: 0\nFrame Time: 0.04\n", "has no frames"},
      {kJoints, "ends before its motion"},
      {with(kGood, "Frame Time: 0.0333333\n", ""), "line 18: '0' where the frame time is expected"},
      {with(kGood, "0.0333333", "0"), "line 18: a frame time of '0'"},
      {with(kGood, "0.0333333", "1e-9"), "line 18: a frame time of '1e-9'"},
      {with(kGood, "0.0333333", "1e6"), "line 18: a frame time of '1e6'"},
      {with(kGood, "CHANNELS 3 Zrotation", "CHANNELS 3 Wrotation"),
       "line 9: 'Wrotation' where channel 1 of 3 of 'Chest'"},
      {with(kGood, "CHANNELS 3", "CHANNELS 4"), "line 10: 'End' where channel 4 of 4 of 'Chest'"},
      {with(kGood, "CHANNELS 3", "CHANNELS 2"), "line 9: 'Yrotation' where a joint, its OFFSET or CHANNELS, or MOTION"},
      {with(kGood, "JOINT", "BONE"), "line 6: 'BONE' where a joint"},
      {"\xFF\xFEH", "is UTF-16 text (save it as UTF-8)"},
      {"ply\n", "line 1: is no BVH recording"}};
  for (const auto& [text, part] : cases) {
    const std::string came = bvh_refusal(text);
    CHECK_MESSAGE(came.find("a.bvh: " + part) == 0, came);
  }
}
