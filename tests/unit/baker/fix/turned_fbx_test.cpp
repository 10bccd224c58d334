// SPDX-License-Identifier: GPL-3.0-or-later
// Turns of joints, written into FBX files, and read back by assimp. tests/export asks three.js.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "baker/fix/turned_fbx.h"
#include "baker/fix/write_clip.h"
#include "baker/import/fbx_file.h"
#include "baker/import/import.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/motion/frame_times.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;

namespace {

constexpr double kTurnFps = 30;
constexpr int kChainFrames = 61;

// A chain of joints: Hip, Arm, Hand. The hip has keys each frame, the arm sparse cubic ones, other ones for each axis.
struct JointChain {
  int order = 0;
  std::string properties;      // of the arm, one a line
  std::string curves = "XYZ";  // of the arm
  std::string more_objects, more_links;
  std::string crlf = "\n";
  bool winds = false;   // the hip's angle about y goes from 180 to -180 degrees
  long long first = 0;  // frame of the first key, where the stack begins

  static std::string curve(int id, const std::vector<int>& frames, const std::vector<double>& values, int flags,
                           long long first = 0) {
    std::string times, numbers;
    for (const int f : frames) times += fmt::format("{}{}", times.empty() ? "" : ",", (first + f) * 1539538600LL);
    for (const double v : values) numbers += fmt::format("{}{}", numbers.empty() ? "" : ",", v);
    return fmt::format(
        "\tAnimationCurve: {}, \"AnimCurve::\", \"\" {{\n\t\tDefault: 0\n\t\tKeyVer: 4009\n\t\tKeyTime: *{} "
        "{{\n\t\t\ta: {}\n\t\t}}\n"
        "\t\tKeyValueFloat: *{} {{\n\t\t\ta: {}\n\t\t}}\n\t\tKeyAttrFlags: *1 {{\n\t\t\ta: {}\n\t\t}}\n"
        "\t\tKeyAttrDataFloat: *4 {{\n\t\t\ta: 1.5,-0.5,218434821,0\n\t\t}}\n\t\tKeyAttrRefCount: *1 {{\n\t\t\ta: "
        "{}\n\t\t}}\n\t}}\n",
        id, frames.size(), times, values.size(), numbers, flags, frames.size());
  }

  std::string text() const {
    std::string objects, links;
    const std::vector<std::string> names{"Hip", "Arm", "Hand"};
    for (std::size_t k = 0; k < names.size(); ++k) {
      objects += fmt::format("\tModel: {}, \"Model::{}\", \"LimbNode\" {{\n\t\tVersion: 232\n\t\tProperties70:  {{\n",
                             10 + k, names[k]);
      if (k == 1) objects += fmt::format("\t\t\tP: \"RotationOrder\", \"enum\", \"\", \"\",{}\n", order) + properties;
      objects += fmt::format("\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",{},20,0\n", 3 * k);
      objects += fmt::format("\t\t\tP: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",{},20,-30\n", 10 * k);
      objects += "\t\t}\n\t\tShading: T\n\t\tCulling: \"CullingOff\"\n\t}\n";
      links += fmt::format("\tC: \"OO\",{},{}\n", 10 + k, k == 0 ? 0 : 9 + k);
    }
    objects += "\tAnimationStack: 30, \"AnimStack::Take 001\", \"\" {\n\t\tProperties70:  {\n";
    for (const auto& [end, frame] : {std::pair("Start", first), std::pair("Stop", first + kChainFrames - 1)})
      objects += fmt::format("\t\t\tP: \"Local{}\", \"KTime\", \"Time\", \"\",{}\n", end, frame * 1539538600LL);
    objects += "\t\t}\n\t}\n\tAnimationLayer: 31, \"AnimLayer::Base\", \"\" {\n\t}\n";
    links += "\tC: \"OO\",31,30\n";
    std::vector<int> all;
    std::vector<double> values;
    for (int f = 0; f < kChainFrames; ++f) {
      all.push_back(f);
      values.push_back(winds ? std::remainder(170 + f, 360) : 170 + f);
    }
    const std::vector<std::vector<int>> frames{{0, 20, 40, 60}, {0, 30, 60}, {0, 60}};
    const std::vector<std::vector<double>> degrees{{10, 60, -20, 30}, {0, 80, 20}, {-30, 50}};
    const auto node = [&](int id, int model) {
      objects += fmt::format("\tAnimationCurveNode: {}, \"AnimCurveNode::R\", \"\" {{\n\t\tProperties70:  {{\n", id);
      for (const char axis : {'X', 'Y', 'Z'})
        objects += fmt::format("\t\t\tP: \"d|{}\", \"Number\", \"\", \"A\",{}\n", axis,
                               axis == 'X'   ? 10
                               : axis == 'Y' ? 20
                                             : -30);
      objects += "\t\t}\n\t}\n";
      links += fmt::format("\tC: \"OO\",{},31\n\tC: \"OP\",{},{}, \"Lcl Rotation\"\n", id, id, model);
    };
    node(40, 10);
    for (int axis = 0; axis < 3; ++axis) {
      objects += curve(41 + axis, all, axis == 1 ? values : std::vector<double>(all.size(), 5.0 * axis), 24836, first);
      links += fmt::format("\tC: \"OP\",{},40, \"d|{}\"\n", 41 + axis, "XYZ"[axis]);
    }
    if (!curves.empty()) node(50, 11);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (curves.find("XYZ"[axis]) == std::string::npos) continue;
      objects += curve(static_cast<int>(51 + axis), frames[axis], degrees[axis], 24840, first);
      links += fmt::format("\tC: \"OP\",{},50, \"d|{}\"\n", 51 + axis, "XYZ"[axis]);
    }
    std::string out =
        "; FBX 7.4.0 project file\n\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n}\n"
        "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n\t\tP: \"TimeMode\", \"enum\", \"\", \"\",6\n\t}\n}\n"
        "Definitions:  {\n\tVersion: 100\n\tCount: 12\n\tObjectType: \"AnimationCurve\" {\n\t\tCount: 6\n\t}\n}\n"
        "Objects:  {\n" +
        objects + more_objects + "}\nConnections:  {\n" + links + more_links + "}\nTakes:  {\n\tCurrent: \"\"\n}\n";
    for (std::size_t at = 0; crlf != "\n" && (at = out.find('\n', at)) != std::string::npos; at += crlf.size())
      out.replace(at, 1, crlf);
    return out;
  }
};

struct TurnedFile {
  std::string before, after;
  double apart = 0;  // of the poses that were asked for, over all nodes and frames
};

// All nodes are turned between the frames, more in the middle.
TurnedFile turn_all(const std::filesystem::path& path, const std::vector<std::string>& names, double degrees = 40) {
  TurnedFile out;
  out.before = out.after = tool::contents(path);
  const SourceRig rig = read_source(path).rig;
  std::vector<TurningJoint> joints;
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    if (names.empty() ? rig.nodes[n].fbx_id != 0 : std::count(names.begin(), names.end(), rig.nodes[n].name) > 0)
      joints.push_back({n, Eigen::Matrix3d::Identity(), {}});
  }
  REQUIRE(!joints.empty());
  std::vector<Clip> wanted;
  for (const Clip& clip : rig.clips) {
    const int frames = frames_in(clip.duration, kTurnFps), first = frames / 3, last = frames - frames / 3;
    const TurnedClip turned(rig, clip, kTurnFps, frames, joints);
    Turns turns(joints.size() * static_cast<std::size_t>(frames), Vec3::Zero());
    std::vector<char> in_window(static_cast<std::size_t>(frames), 0);
    for (int f = first; f < last; ++f) {
      in_window[static_cast<std::size_t>(f)] = 1;
      const double share = std::sin(std::numbers::pi * (f - first + 1) / (last - first + 1));
      for (std::size_t j = 0; j < joints.size(); ++j) {
        const auto k = static_cast<double>(j);
        turns[static_cast<std::size_t>(f) * joints.size() + j] =
            share * to_radians(degrees) * Vec3(std::sin(1 + k), std::sin(2 + 3 * k), 0.5).normalized();
      }
    }
    const std::vector<Channel> channels = turned_channels(turned, turns, in_window);
    out.after = with_turned_joints(out.after, path.string(), rig, clip, channels, in_window, kTurnFps);
    wanted.push_back(clip);
    for (const Channel& channel : channels) {
      std::erase_if(wanted.back().channels, [&](const Channel& own) {
        return own.path == ChannelPath::kRotation && own.target == channel.target;
      });
      wanted.back().channels.push_back(channel);
    }
  }
  const TemporaryFolder folder;
  const SourceRig got = read_source(folder.write("after.fbx", out.after)).rig;
  REQUIRE(got.clips.size() == wanted.size());
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    CHECK(got.clips[c].duration == doctest::Approx(wanted[c].duration));
    for (int f = 0; f < frames_in(wanted[c].duration, kTurnFps); ++f) {
      const auto a = world_at(rig, wanted[c], f / kTurnFps), b = world_at(got, got.clips[c], f / kTurnFps);
      for (std::size_t n = 0; n < a.size(); ++n)
        out.apart = std::max(out.apart, (a[n].matrix() - b[n].matrix()).cwiseAbs().maxCoeff());
    }
  }
  return out;
}

TurnedFile turn_all(const std::string& text, const std::vector<std::string>& names, double degrees = 40) {
  const TemporaryFolder folder;
  return turn_all(folder.write("chain.fbx", text), names, degrees);
}

std::vector<double> curve_numbers(const std::string& text, const char* curve, const char* array) {
  const std::size_t at = text.find("a: ", text.find(array, text.find(curve))) + 3;
  std::istringstream in(text.substr(at, text.find('\n', at) - at));
  std::vector<double> out;
  for (std::string number; std::getline(in, number, ',');) out.push_back(std::stod(number));
  return out;
}

std::string refused_turn(const std::string& text, const std::vector<std::string>& names = {"Arm"}) {
  try {
    turn_all(text, names);
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kFile);
    return error.what();
  }
  return "";
}

constexpr double kSamePose = 1e-4;  // of lengths up to 60, and of axes

const char* const kPreLine = "\t\t\tP: \"PreRotation\", \"Vector3D\", \"Vector\", \"\",30,-50,110\n";
const char* const kPostLine = "\t\t\tP: \"PostRotation\", \"Vector3D\", \"Vector\", \"\",-20,70,15\n";
const char* const kActiveLine = "\t\t\tP: \"RotationActive\", \"bool\", \"\", \"\",1\n";
const char* const kPivotLines =
    "\t\t\tP: \"RotationPivot\", \"Vector3D\", \"Vector\", \"\",1,2,3\n"
    "\t\t\tP: \"ScalingOffset\", \"Vector3D\", \"Vector\", \"\",0,-1,2\n";

}  // namespace

TEST_CASE("turned fbx: joints turn as asked for, whatever their rotation order, pre- and post-rotation and pivots") {
  for (int order = 0; order < 6; ++order) {
    for (const std::string& more : {std::string(), std::string(kPreLine), std::string(kPostLine),
                                    std::string(kPreLine) + kPostLine, std::string(kPreLine) + kPivotLines}) {
      JointChain chain;
      chain.order = order;
      chain.properties = kActiveLine + more;
      CAPTURE(order);
      CAPTURE(more);
      // Between keys, what turns about a pivot moves on an arc, which is read as lines.
      CHECK(turn_all(chain.text(), {"Hip", "Arm"}).apart <
            (more.find("Pivot") == std::string::npos ? kSamePose : 50 * kSamePose));
    }
  }
}

TEST_CASE("turned fbx: a stack may begin anywhere on the file's time line") {
  for (const long long first : {-90, 45}) {
    for (const bool has_pivot : {false, true}) {
      JointChain chain;
      chain.first = first;
      if (has_pivot) chain.properties = kPivotLines;
      CAPTURE(first);
      CAPTURE(has_pivot);
      const TemporaryFolder folder;
      const auto path = folder.write("chain.fbx", chain.text());
      CHECK(read_source(path).rig.clips.at(0).duration == doctest::Approx((kChainFrames - 1) / kTurnFps));
      CHECK(turn_all(path, {"Hip", "Arm", "Hand"}).apart < (has_pivot ? 50 * kSamePose : kSamePose));
    }
  }
}

TEST_CASE("turned fbx: a joint gets the curves that it lacks") {
  for (const std::string curves : {"XY", "Z", ""}) {
    for (const std::string line_end : {"\n", "\r\n"}) {
      JointChain chain;
      chain.curves = curves;
      chain.crlf = line_end;
      const TurnedFile turned = turn_all(chain.text(), {"Arm", "Hand"});
      CAPTURE(curves);
      CHECK(turned.apart < kSamePose);
      const auto count = [&](const std::string& text, const std::string& word) {
        std::size_t n = 0;
        for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
        return n;
      };
      CHECK(count(turned.after, "\n\tAnimationCurve: ") == 9);
      CHECK(count(turned.after, "\n\tAnimationCurveNode: ") == 3);
      CHECK(turned.after.find("\t\tCount: " + std::to_string(12 - curves.size())) != std::string::npos);
      CHECK(count(turned.after, "\n") == count(turned.after, line_end));
    }
  }
}

TEST_CASE("turned fbx: outside of the window a curve keeps its keys and tangents, and leads into it in a line") {
  const TurnedFile turned = turn_all(JointChain().text(), {"Arm"});
  const std::string curve = "AnimationCurve: 51,";
  const std::vector<double> times = curve_numbers(turned.after, curve.c_str(), "KeyTime"),
                            values = curve_numbers(turned.after, curve.c_str(), "KeyValueFloat"),
                            flags = curve_numbers(turned.after, curve.c_str(), "KeyAttrFlags"),
                            counts = curve_numbers(turned.after, curve.c_str(), "KeyAttrRefCount");
  const double frame = 1539538600;
  // Frames 20 to 40 are the window; one key beside it at each end.
  REQUIRE(times.size() == 1 + 23 + 1);
  CHECK(times.front() == 0);
  CHECK(times[1] == 19 * frame);
  CHECK(times[23] == 41 * frame);
  CHECK(times[24] == 60 * frame);
  CHECK(values.front() == 10);
  CHECK(values.back() == 30);
  // The first key leads into the window; the last is as it was.
  REQUIRE(counts.size() == flags.size());
  CHECK(flags.front() == 24836);
  CHECK(flags.back() == 24840);
  CHECK(counts.back() == 1);
  // Lines of other objects stay.
  std::istringstream before(turned.before), after(turned.after);
  std::string old, now;
  std::size_t changed = 0;
  while (std::getline(before, old) && std::getline(after, now)) {
    while (now != old && now.find("a: ") == std::string::npos && now.find(": *") == std::string::npos &&
           std::getline(after, now))
      ++changed;
    changed += now != old;
  }
  CHECK(changed <= 3 * 5 * 2);  // two lines of each array of three curves
}

TEST_CASE("turned fbx: angles go on from key to key, and wind where the file's own do") {
  for (const bool winds : {false, true}) {
    JointChain chain;
    chain.winds = winds;
    const TurnedFile turned = turn_all(chain.text(), {"Hip"}, 30);
    const std::vector<double> after = curve_numbers(turned.after, "AnimationCurve: 42,", "KeyValueFloat");
    REQUIRE(after.size() == kChainFrames);
    int jumps = 0;
    for (std::size_t k = 1; k < after.size(); ++k) jumps += std::abs(after[k] - after[k - 1]) > 90;
    CHECK(jumps == (winds ? 1 : 0));
  }
}

TEST_CASE("turned fbx: what cannot be turned in the file is refused, with the names that one needs to find it") {
  const auto says = [](const std::string& message, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) CHECK_MESSAGE(message.find(part) != std::string::npos, message);
  };
  JointChain layers;
  layers.more_objects =
      "\tAnimationLayer: 32, \"AnimLayer::Pose\", \"\" {\n\t}\n\tAnimationCurveNode: 60, \"AnimCurveNode::R\", \"\" "
      "{\n\t}\n" +
      JointChain::curve(61, {0, 60}, {0, 1}, 24836);
  layers.more_links =
      "\tC: \"OO\",32,30\n\tC: \"OO\",60,32\n\tC: \"OP\",60,11, \"Lcl Rotation\"\n\tC: \"OP\",61,60, \"d|X\"\n";
  for (const char* const joint : {"Arm", "Hip"})  // the arm's motion is read wrongly
    says(refused_turn(layers.text(), {joint}), {"chain.fbx: several layers", "'Arm'", "'Take 001'", "'Base', 'Pose'"});
  JointChain other = layers;
  other.more_links.replace(other.more_links.find("60,11"), 5, "60,12");
  CHECK(turn_all(other.text(), {"Hip", "Arm"}).apart < kSamePose);  // each layer turns joints of its own
  CHECK(turn_all(other.text(), {"Hand"}).apart < kSamePose);
  JointChain empty = layers;
  empty.more_links = empty.more_links.substr(0, empty.more_links.rfind("\tC:"));
  CHECK(turn_all(empty.text(), {"Arm"}).apart < kSamePose);  // the other layer has no curves
  JointChain spheric;
  spheric.order = 6;
  says(refused_turn(spheric.text()), {"chain.fbx: ", "'Arm'", "spheric"});
  JointChain shared;
  shared.more_links = "\tC: \"OP\",51,40, \"d|X\"\n";
  says(refused_turn(shared.text()), {"chain.fbx: ", "'Arm'", "shares its curves"});

  // Curves that are not those that the clip was read from: what is written would be as wrong.
  const TemporaryFolder folder;
  std::string text = JointChain().text();
  const SourceRig rig = read_source(folder.write("a.fbx", text)).rig;
  const Index arm = static_cast<Index>(
      std::find_if(rig.nodes.begin(), rig.nodes.end(), [](const Node& node) { return node.name == "Arm"; }) -
      rig.nodes.begin());
  const TurnedClip turned(rig, rig.clips[0], kTurnFps, kChainFrames, {{arm, Eigen::Matrix3d::Identity(), {}}});
  const std::vector<char> all(kChainFrames, 1);
  const std::vector<Channel> channels = turned_channels(turned, Turns(kChainFrames, Vec3(0.1, 0, 0)), all);
  text.replace(text.find("a: 10,60,-20,30"), 15, "a: 10,60,-20,35");
  CHECK_THROWS_WITH(with_turned_joints(text, "a.fbx", rig, rig.clips[0], channels, all, kTurnFps),
                    doctest::Contains("a.fbx: the joint 'Arm' turns otherwise in the file"));

  CHECK_THROWS_AS(check_turnable_fbx("glTF", "a.glb"), Error);
  std::string old = JointChain().text();
  old.replace(old.find("7400"), 4, "6100");
  CHECK_THROWS_WITH(check_turnable_fbx(old, "a.fbx"), doctest::Contains("a.fbx: is FBX 6.1"));
  const std::string whole = JointChain().text();
  CHECK_THROWS_WITH(check_turnable_fbx(whole.substr(0, whole.size() - 60), "a.fbx"), doctest::Contains("damaged"));
}

TEST_CASE("turned fbx: a damaged file is refused, or its copy is whole") {
  const TemporaryFolder folder;
  const char* const kBadNumbers[] = {"0", "-1", "99999999999", "-9223372036854775808", "1e300", "nan", "*",
                                     "{", "}",  "\""};
  for (const std::string& good : {JointChain().text(), tool::contents("/usr/share/assimp/models/FBX/huesitos.fbx")}) {
    const SourceRig rig = read_source(folder.write("good.fbx", good)).rig;
    const Clip& clip = rig.clips[0];
    std::vector<TurningJoint> joints;
    for (Index n = 0; n < rig.nodes.size(); ++n)
      if (rig.nodes[n].fbx_id != 0) joints.push_back({n, Eigen::Matrix3d::Identity(), {}});
    const TurnedClip turned(rig, clip, kTurnFps, 30, joints);
    const std::vector<char> in_window(30, 1);
    const std::vector<Channel> channels =
        turned_channels(turned, Turns(30 * joints.size(), Vec3(0.1, 0.2, 0)), in_window);
    std::mt19937 random(7);
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
    int written = 0, refused = 0;
    // In a binary file most bytes are of the mesh.
    const std::size_t first = good.find("AnimationStack");
    for (int k = 0; k < 400; ++k) {
      std::string bad = good;
      for (std::size_t n = 1 + below(3); n > 0; --n) {
        const std::size_t at = (k % 2 == 0 ? first : 0) + below(good.size() - first), size = 1 + below(40);
        const std::size_t kind = below(5);
        if (kind == 0) bad[std::min(at, bad.size() - 1)] ^= static_cast<char>(1U << below(8));
        if (kind == 1) bad.erase(std::min(at, bad.size()), size);
        if (kind == 2) bad.insert(std::min(at, bad.size()), good.substr(below(good.size()), size));
        if (kind == 3)
          bad.replace(std::min(bad.find_first_of("0123456789", at), bad.size() - 1), 1 + below(4),
                      kBadNumbers[below(std::size(kBadNumbers))]);
        if (kind == 4 && below(5) == 0) bad.resize(at);
      }
      try {
        const std::string out = with_turned_joints(bad, "bad.fbx", rig, clip, channels, in_window, kTurnFps);
        CHECK(parse_fbx(out).is_whole);
        ++written;
      } catch (const Error& error) {
        CHECK(std::string(error.what()).starts_with("bad.fbx: "));
        ++refused;
      }
    }
    CHECK(written > 50);
    CHECK(refused > 50);
  }
}

namespace {

// The records of a binary file with offsets of 64 bits, as version 7.5 has them.
void put_number(std::string& out, const auto value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); }
void put_wide(const std::vector<FbxRecord>& records, std::string& out) {
  for (const FbxRecord& record : records) {
    const std::size_t at = out.size();
    put_number(out, std::uint64_t{0});
    put_number(out, std::uint64_t{record.value_count});
    put_number(out, std::uint64_t{record.values.size()});
    put_number(out, static_cast<std::uint8_t>(record.name.size()));
    out += record.name;
    out += record.values;
    if (record.inside_end > 0) put_wide(record.inside, out);
    const std::uint64_t end = out.size();
    out.replace(at, sizeof end, reinterpret_cast<const char*>(&end), sizeof end);
  }
  out.append(25, '\0');
}

// Compares all but the curves.
void check_same_records(const std::vector<FbxRecord>& before, const std::vector<FbxRecord>& after) {
  REQUIRE(after.size() >= before.size());
  for (std::size_t k = 0; k < before.size(); ++k) {
    CHECK(before[k].name == after[k].name);
    if (before[k].name.starts_with("Key") || before[k].name == "Count") continue;
    CHECK(before[k].values == after[k].values);
    check_same_records(before[k].inside, after[k].inside);
  }
}

}  // namespace

TEST_CASE("turned fbx: of a binary file with offsets of 32 or 64 bits only curves change") {
  const std::string narrow = tool::contents("/usr/share/assimp/models/FBX/huesitos.fbx");
  const FbxTree tree = parse_fbx(narrow);
  REQUIRE(tree.is_whole);
  std::string wide = narrow.substr(0, 27);
  wide[23] = static_cast<char>(7500 % 256);
  wide[24] = static_cast<char>(7500 / 256);
  put_wide(tree.records, wide);
  wide += narrow.substr(tree.end);
  for (const std::string& file : {narrow, wide}) {
    const TurnedFile turned = turn_all(file, {"Bone.001", "Bone.002"});
    CHECK(turned.apart < kSamePose);
    const FbxTree before = parse_fbx(turned.before), after = parse_fbx(turned.after);
    REQUIRE(after.is_whole);
    CHECK(after.version == before.version);
    check_same_records(before.records, after.records);
    // The footer: its padding keeps what follows where it was aligned.
    CAPTURE(turned.after.size() - turned.before.size());
    const auto version_place = [](const std::string& bytes) { return (bytes.size() - 140) % 16; };
    CHECK(version_place(turned.after) == version_place(turned.before));
    CHECK(turned.after.substr(turned.after.size() - 144) == turned.before.substr(turned.before.size() - 144));
    CHECK(turned.after.substr(after.end, 16) == turned.before.substr(before.end, 16));
  }
}
