// SPDX-License-Identifier: GPL-3.0-or-later
// A recording as a clip of a character's own nodes, and what is turned in the clip back in the recording.
#include "baker/motion/carried_motion.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

#include "baker/fix/bvh_text.h"
#include "baker/fix/turned_clip.h"
#include "baker/fix/turned_recording.h"
#include "baker/mesh/error.h"
#include "baker/motion/clip.h"
#include "baker/play/asset_file.h"
#include "baker/roles/roles.h"
#include "human.h"
#include "temporary_folder.h"
#include "test_characters.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

constexpr double kSame = 1e-4;  // of the height
const fs::path kWalk = kModels / "BVH/01_03.bvh";

// The farthest that a vertex is in one pose from where it is in the other.
double farthest_vertices(const Character& character, const Deformation& a, const Deformation& b) {
  const std::vector<Vec3> p = deform(character.source_positions, character.rig.weights, a.bones),
                          q = deform(character.source_positions, character.rig.weights, b.bones);
  double out = 0;
  for (std::size_t v = 0; v < p.size(); ++v) out = std::max(out, (p[v] - q[v]).norm());
  return out;
}

// Nodes that are turned about their own x.
Clip with_turns(const SourceRig& rig, Clip clip, const std::vector<Index>& nodes, double degrees, double from,
                double to) {
  for (const Index node : nodes) {
    for (Channel& channel : clip.channels) {
      if (channel.target != node || channel.path != ChannelPath::kRotation || channel.times.size() < 2) continue;
      for (std::size_t k = 0; k < channel.times.size(); ++k) {
        if (channel.times[k] < from || channel.times[k] > to) continue;
        const double share = std::sin((channel.times[k] - from) / (to - from) * std::numbers::pi);
        const Eigen::Map<Eigen::Vector4d> value(&channel.values[4 * k]);
        const Vec3 turn = share * degrees * std::numbers::pi / 180 * Vec3::UnitX();
        Eigen::Map<Eigen::Vector4d>(&channel.values[4 * k]) = turned(Eigen::Quaterniond(value), turn).coeffs();
      }
    }
  }
  CHECK(!rig.nodes.empty());
  return clip;
}

void check_carried(const Character& character, const BodyFrame& frame) {
  const SourceRig& rig = character.rig;
  const auto carried = carried_motion(kWalk, rig, character.source_positions, frame, "character");
  const Clip clip = carried->clip();
  const double fps = carried->rate();
  CHECK(fps == 120);
  CHECK(clip.duration == doctest::Approx(carried->duration()).epsilon(1e-3));
  for (double second = 0; second < carried->duration(); second += 307 / fps) {
    const double off =
        farthest_vertices(character, carried->at(second / carried->duration()), sample(rig, clip, second));
    CHECK(off < kSame * frame.height);
  }

  // Arms and trunk turn for a second. Legs stay: a recording's height is where its feet reach the ground.
  std::vector<Index> nodes = carried->recorded_nodes();
  CHECK(nodes.size() >= 12);
  const Roles roles = find_roles(rig, character.source_positions);
  std::erase_if(nodes, [&](Index n) {
    const std::string& role = roles.of_node[n].role;
    return role.ends_with("hip") || role.ends_with("knee") || role.ends_with("ankle") || role.ends_with("toe");
  });
  CHECK(nodes.size() >= 6);
  const Clip after = with_turns(rig, clip, nodes, 12, 2, 3);
  std::vector<char> in_window(static_cast<std::size_t>(clip.duration * fps) + 1, 0);
  std::fill_n(in_window.begin() + 240, 121, char{1});
  const TemporaryFolder folder;
  const std::string text = turned_recording(*carried, rig, clip, after, in_window, fps);
  const auto again = carried_motion(folder.write("again.bvh", text), rig, character.source_positions, frame, "again");
  double turned = 0;
  for (double second = 1.5; second < 3.5; second += 17 / fps) {
    const Deformation wanted = sample(rig, after, second);
    CHECK(farthest_vertices(character, again->at(second / again->duration()), wanted) < kSame * frame.height);
    turned = std::max(turned, farthest_vertices(character, sample(rig, clip, second), wanted));
  }
  CHECK(turned > 0.05 * frame.height);
  // Frames before and after the second are the file's, letter by letter.
  std::istringstream before_lines(read_file(kWalk.string())), after_lines(text);
  int line = 0, changed = 0;
  for (std::string a, b; std::getline(before_lines, a) && std::getline(after_lines, b); ++line) {
    changed += a != b ? 1 : 0;
    const int at = line - 187;  // of the motion's lines
    if (at < 239 || at > 362) CHECK(a == b);
  }
  CHECK(changed >= 119);
}

const std::string kBvh =
    "HIERARCHY\nROOT hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    " JOINT knee\n {\n  OFFSET 0 -1 0\n  CHANNELS 1 Xrotation\n  End Site\n  {\n   OFFSET 0 -1 0\n  }\n }\n}\n"
    "MOTION\nFrames:   3\nFrame Time: 0.04\n"
    "0 1 0  170 0\t0  5\r\n0 1 0  178 0\t0  6\r\n0 1 0  186 0\t0  7.50\r\n";

}  // namespace

TEST_CASE("a recording on a character is a clip of its nodes; what turns in the clip can turn in the recording" *
          doctest::test_suite("many bakes")) {
  const Character character = import_character(kModels / "X/BCN_Epileptic.X");
  double top = 0;
  for (const Vec3& p : character.source_positions) top = std::max(top, p.y());
  check_carried(character, {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), top});
}

TEST_CASE("characters of SPHERECHAIN_TEST_DATA: a recording is a clip of their nodes, and back") {
  int bipeds = 0;
  for_each_test_character([&](const Bake& baked) {
    const std::string name = fs::path(baked.character.file).filename();
    if (baked.roles.kind != BodyKind::kBiped || name == "quaternius_dragon.fbx") return;  // a dragon by its names
    INFO(name);
    check_carried(baked.character, baked.regions.frame);
    ++bipeds;
  });
  if (std::getenv("SPHERECHAIN_TEST_DATA") != nullptr) CHECK(bipeds >= 5);
}

TEST_CASE("a BVH file's text changes where a joint turns, and nowhere else; angles go on without a jump") {
  BvhText bvh(kBvh, "a.bvh");
  CHECK(bvh.text() == kBvh);
  CHECK(bvh.frames() == 3);
  CHECK(bvh.frame_time() == 0.04);
  const BvhJoint hips = bvh.joints()[0];
  CHECK(BvhText::turns_freely(hips));
  CHECK(!BvhText::turns_freely(bvh.joints()[1]));
  const auto about_z = [](double degrees) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitZ()));
  };
  CHECK(bvh.rotation(1, hips).angularDistance(about_z(178)) < 1e-9);
  bvh.turn(1, hips, bvh.rotation(1, hips) * about_z(4));
  bvh.turn(2, hips, bvh.rotation(2, hips) * about_z(-4));
  std::string wanted = kBvh;
  wanted.replace(wanted.find("178 0\t0"), 7, "182.000000 0.000000\t0.000000");
  wanted.replace(wanted.find("186 0\t0"), 7, "182.000000 0.000000\t0.000000");
  std::string got = bvh.text();
  for (std::size_t at = got.find("-0.000000"); at != std::string::npos; at = got.find("-0.000000")) got.erase(at, 1);
  CHECK(got == wanted);
  CHECK_THROWS_WITH_AS(BvhText(kBvh.substr(0, kBvh.size() - 8), "a.bvh"),
                       doctest::Contains("a.bvh: line 21: the file ends within frame 2"), Error);
  CHECK_THROWS_WITH_AS(BvhText("ply\n", "a.bvh"), doctest::Contains("a.bvh: line 1: is no BVH recording"), Error);
}
