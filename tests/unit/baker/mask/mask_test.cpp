// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain mask`: a rod in a tube, of which it is known what is seen.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "baker/import/glb_file.h"
#include "baker/import/import.h"
#include "baker/mask/raised_limbs.h"
#include "baker/mesh/even_directions.h"
#include "baker/mesh/surface_query.h"
#include "glb_writer.h"
#include "named_rig.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

constexpr double kRod = 0.2, kTube = 0.23, kHalfRod = 0.9, kHalfTube = 0.4;  // metres

// The side of a cylinder along y, without ends. Its rims are narrower by `rim`, and its middle
// ring is wider by `bulge`.
int add_tube(Glb& glb, const char* name, double radius, double half, int rings, double rim, double bulge = 0) {
  constexpr std::uint16_t kAround = 24;
  std::vector<float> positions;
  std::vector<std::uint16_t> corners;
  for (int ring = 0; ring <= rings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      const double r = ring == 0 || ring == rings ? radius - rim : radius + (2 * ring == rings ? bulge : 0);
      for (const double x : {r * std::sin(angle), half * (2.0 * ring / rings - 1), r * std::cos(angle)}) {
        positions.push_back(static_cast<float>(x));
      }
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      const int a = ring * kAround + k, b = ring * kAround + (k + 1) % kAround;
      for (const int corner : {a, b, b + kAround, a, b + kAround, a + kAround}) {
        corners.push_back(static_cast<std::uint16_t>(corner));
      }
    }
  }
  const std::size_t number = glb.json["meshes"].size();
  const int at = glb.accessor(positions, "VEC3");
  glb.json["meshes"].push_back(
      {{"name", name},
       {"primitives",
        {{{"attributes", {{"POSITION", at}}}, {"indices", glb.accessor(corners, "SCALAR")}, {"material", number}}}}});
  return static_cast<int>(number);
}

// A rod in a tube that nearly touches it at its rims, so that nobody looks in from above. It goes up by `rise` within a
// second.
Glb rod_in_tube(double rise, double tube = kTube, double bulge = 0) {
  Glb glb;
  const int rod = add_tube(glb, "rod", kRod, kHalfRod, 72, kRod, bulge),
            cloth = add_tube(glb, "tube", tube, kHalfTube, 16, tube - kRod - 0.002);
  glb.json["materials"] = {{{"name", "skin"}, {"extras", {{"mine", 7}}}}, {{"name", "cloth"}, {"doubleSided", true}}};
  glb.json["nodes"] = {{{"name", "whole"}, {"children", {1}}},
                       {{"name", "rod"}, {"mesh", rod}, {"children", {2}}},
                       {{"name", "tube"}, {"mesh", cloth}}};
  const int times = glb.accessor(std::vector<float>{0, 1}, "SCALAR"),
            places = glb.accessor(std::vector<float>{0, 0, 0, 0, static_cast<float>(rise), 0}, "VEC3");
  glb.json["animations"] = {{{"name", "rise"},
                             {"samplers", {{{"input", times}, {"output", places}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}}}}}};
  return glb;
}

struct Masked {
  tool::Run run;
  std::string bytes;  // of the output
};

Masked mask(const Glb& glb, const std::string& options, const char* output) {
  const TemporaryFolder folder;
  const auto in = folder.write("rod.glb", glb.bytes()), out = folder.path / output;
  Masked masked;
  masked.run = tool::run(fmt::format("mask {} -o {} {}", in.string(), out.string(), options));
  CHECK_MESSAGE(masked.run.code == 0, masked.run.error);
  masked.bytes = tool::contents(out);
  return masked;
}

json mask_as_json(const Glb& glb, const std::string& options = {}) {
  return json::parse(mask(glb, "--as json " + options, "mask.json").bytes);
}

std::vector<std::uint32_t> corners_of(const GlbFile& glb, std::size_t mesh) {
  const auto& primitive = glb.json["meshes"][mesh]["primitives"][0];
  const auto& accessor = glb.json["accessors"][primitive["indices"].get<std::size_t>()];
  const auto& view = glb.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  REQUIRE(accessor["componentType"] == 5123);
  std::vector<std::uint16_t> out(accessor["count"].get<std::size_t>());
  std::memcpy(out.data(), glb.binary.data() + view["byteOffset"].get<std::size_t>(), 2 * out.size());
  return {out.begin(), out.end()};
}

// Lowest and highest corner of the hidden triangles of the rod, whose rings are 1/40 m apart.
std::pair<double, double> hidden_range(const json& mask) {
  double low = 1, high = -1;
  for (const json& triangle : mask["meshes"][0]["hidden"]) {
    const int ring = triangle.get<int>() / 48;
    low = std::min(low, ring / 40.0 - kHalfRod);
    high = std::max(high, (ring + 1) / 40.0 - kHalfRod);
  }
  return {low, high};
}

}  // namespace

TEST_CASE("mask: skin in a tube is hidden, but not near the tube's rims") {
  const json found = mask_as_json(rod_in_tube(0));
  REQUIRE(found["meshes"].size() == 2);
  CHECK(found["meshes"][0]["mesh"] == "rod");
  CHECK(found["meshes"][0]["triangles"] == 72 * 48);
  CHECK(found["meshes"][1]["hidden"].empty());
  const auto [low, high] = hidden_range(found);
  CHECK(low > -kHalfTube);
  CHECK(low < -kHalfTube + 0.2);
  CHECK(high < kHalfTube);
  CHECK(high > kHalfTube - 0.2);
  // The lower rings are hidden wholly; steep views see a little through the upper rim.
  std::size_t in_middle = 0;
  for (const json& t : found["meshes"][0]["hidden"]) in_middle += t >= 24 * 48 && t < 36 * 48 ? 1 : 0;
  CHECK(in_middle == 12 * 48);
  CHECK(found["clips"] == json{"rise"});
  const auto hidden = static_cast<double>(found["meshes"][0]["hidden"].size());
  CHECK(found["hidden_percent"].get<double>() == doctest::Approx(hidden / (72 + 16) / 48 * 100));
  CHECK(found["poke_removed_percent"].is_null());  // nothing shows
  const std::string page = tool::contents(SPHERECHAIN_SAMPLES "/../docs/json.md");
  for (const auto& [key, value] : found.items()) CHECK_MESSAGE(page.find("`" + key + "`") != std::string::npos, key);
  for (const auto& [key, value] : found["meshes"][0].items()) CHECK(page.find("`" + key + "`") != std::string::npos);
}

TEST_CASE("mask: skin that a clip shows stays") {
  const auto [low, high] = hidden_range(mask_as_json(rod_in_tube(0.3)));
  CHECK(low > -kHalfTube + 0.3);
  CHECK(high > kHalfTube - 0.2);
}

TEST_CASE("mask: random poses within the clips' limits are looked at on request") {
  const Masked masked = mask(rod_in_tube(0.05), "--as json --random-poses 20", "mask.json");
  CHECK(masked.run.out.find(" of 1 clip, 20 random poses\n") != std::string::npos);
  const auto [low, high] = hidden_range(mask_as_json(rod_in_tube(0.05)));
  const auto [low_too, high_too] = hidden_range(json::parse(masked.bytes));
  CHECK(low_too >= low);
  CHECK(high_too < high);  // some turn the tube, too, and show more of the rod
}

TEST_CASE("mask: a larger margin keeps more skin") {
  const auto [low, high] = hidden_range(mask_as_json(rod_in_tube(0), "--margin 0"));
  const auto [low_4, high_4] = hidden_range(mask_as_json(rod_in_tube(0), "--margin 4"));
  constexpr double kExpected = 0.04 * 2 * kHalfRod, kRing = 1 / 40.0;
  CHECK(high - high_4 >= kExpected - kRing);
  CHECK(std::abs(low_4 - low - kExpected) <= kRing);
}

TEST_CASE("mask: no view shows a difference at rest") {
  const TemporaryFolder folder;
  const Glb glb = rod_in_tube(0.1);
  const auto before = folder.write("before.glb", glb.bytes()), after = folder.path / "after.glb";
  REQUIRE(tool::run(fmt::format("mask {} -o {} --margin 0", before.string(), after.string())).code == 0);
  const Character whole = import_character(before), masked = import_character(after);
  REQUIRE(masked.source_triangles.size() < whole.source_triangles.size() - 500);
  const SurfaceQuery all(Mesh{whole.source_positions, whole.source_triangles}),
      left(Mesh{masked.source_positions, masked.source_triangles});
  int hits = 0, differences = 0;
  for (const Vec3& eye : even_directions(61)) {  // others than those of the tool
    if (eye.y() < -0.5) continue;
    const Vec3 right = eye.unitOrthogonal(), up = eye.cross(right);
    for (int i = -40; i <= 40; ++i) {
      for (int k = -40; k <= 40; ++k) {
        const Vec3 from = 5 * eye + 0.0251 * (i * right + k * up);
        const auto a = all.first_hit(from, -eye), b = left.first_hit(from, -eye);
        hits += a ? 1 : 0;
        differences += a.has_value() != b.has_value() || (a && (a->point - b->point).norm() > 1e-9) ? 1 : 0;
      }
    }
  }
  CHECK(hits > 10000);
  CHECK(differences == 0);
}

TEST_CASE("mask: skin that has come through at rest is hidden, the cloth below it is not") {
  const json found = mask_as_json(rod_in_tube(0, kTube, 0.035));
  CHECK(found["meshes"][1]["hidden"].empty());
  std::size_t in_bulge = 0;
  for (const json& t : found["meshes"][0]["hidden"]) in_bulge += t >= 34 * 48 && t < 38 * 48 ? 1 : 0;
  CHECK(in_bulge > 180);  // of 192
}

TEST_CASE("mask: all else of the file stays") {
  const Glb glb = rod_in_tube(0);
  const Masked masked = mask(glb, "", "masked.glb");
  const GlbFile before = glb_of_bytes(glb.bytes(), "before"), after = glb_of_bytes(masked.bytes, "after");
  for (const char* key : {"nodes", "materials", "animations", "scenes"}) CHECK(after.json[key] == before.json[key]);
  CHECK(after.json["meshes"][1] == before.json["meshes"][1]);
  CHECK(after.json["meshes"][0]["primitives"][0]["attributes"] ==
        before.json["meshes"][0]["primitives"][0]["attributes"]);
  CHECK(after.binary.substr(0, before.binary.size()) == before.binary);
  // The triangles that the JSON does not name, in their order.
  const std::vector<std::uint32_t> all = corners_of(before, 0);
  const json hidden = mask_as_json(glb)["meshes"][0]["hidden"];
  std::vector<std::uint32_t> expected;
  for (std::uint32_t t = 0, h = 0; t < all.size() / 3; ++t) {
    if (h < hidden.size() && hidden[h] == t) {
      ++h;
    } else {
      expected.insert(expected.end(), {all[3 * t], all[3 * t + 1], all[3 * t + 2]});
    }
  }
  CHECK(corners_of(after, 0) == expected);
  CHECK(masked.run.out.find("hidden") != std::string::npos);
}

TEST_CASE("mask: a mask is 0 at vertices whose triangles are all hidden, and no triangle is missing") {
  const Glb glb = rod_in_tube(0);
  const GlbFile before = glb_of_bytes(glb.bytes(), "before");
  const json hidden = mask_as_json(glb)["meshes"][0]["hidden"];
  std::vector<float> expected(73 * 24, 0);
  const std::vector<std::uint32_t> corners = corners_of(before, 0);
  std::vector<char> is_hidden(corners.size() / 3);
  for (const json& t : hidden) is_hidden[t.get<std::size_t>()] = 1;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (is_hidden[i / 3] == 0) expected[corners[i]] = 1;
  }
  for (const auto& [form, attribute, width] :
       {std::tuple{"attribute", "_MASK", 1}, std::tuple{"vertex-colour", "COLOR_0", 4}}) {
    const GlbFile after = glb_of_bytes(mask(glb, std::string("--as ") + form, "masked.glb").bytes, "after");
    CHECK(corners_of(after, 0) == corners);
    const auto& accessor =
        after.json["accessors"][after.json["meshes"][0]["primitives"][0]["attributes"][attribute].get<std::size_t>()];
    const auto& view = after.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    REQUIRE(accessor["count"] == expected.size());
    for (std::size_t v = 0; v < expected.size(); ++v) {
      float value = -1;
      std::memcpy(&value,
                  after.binary.data() + view["byteOffset"].get<std::size_t>() + v * 4 * static_cast<std::size_t>(width),
                  4);
      CHECK(value == expected[v]);
    }
  }
}

TEST_CASE("mask: the page has as many hidden triangles as the JSON, and all frames") {
  const auto viewer =
      std::filesystem::path(SPHERECHAIN_TOOL).parent_path().parent_path() / "share/spherechain/viewer.html";
  if (!std::filesystem::exists(viewer)) return;  // the build has no Node
  const Glb glb = rod_in_tube(0.1);
  const std::string html = mask(glb, "--as page", "mask.html").bytes, open = R"(type="application/json">)";
  const std::size_t at = html.find(open) + open.size();
  const json page = json::parse(html.substr(at, html.find('<', at) - at)), found = mask_as_json(glb);
  const std::size_t hidden = found["meshes"][0]["hidden"].size();
  CHECK(hidden > 0);
  CHECK(page["mask"]["hidden"] == hidden);
  for (const char* key : {"hidden_percent", "area_percent"}) CHECK(page["mask"][key] == found[key]);
  CHECK(page["parts"] == json{"rod", "tube"});
  CHECK(page["clips"] == json{{{"name", "rise"}, {"first", 0}, {"count", 31}, {"own_count", 31}}});
}

TEST_CASE("mask: a character without clips, or without covered skin, is refused, and nothing is written") {
  const TemporaryFolder folder;
  const auto refuse = [&](const json& glb_json, Glb glb, int code, const std::vector<std::string>& parts,
                          const std::string& output) {
    glb.json = glb_json;
    const auto in = folder.write("rod.glb", glb.bytes());
    const std::size_t files = tool::files_in(folder.path);
    tool::check_error(tool::run(fmt::format("mask {} -o {}", in.string(), (folder.path / output).string())), code,
                      parts);
    CHECK(tool::files_in(folder.path) == files);
  };
  const Glb glb = rod_in_tube(0);
  json still = glb.json;
  still.erase("animations");
  refuse(still, glb, 3, {"rod.glb", "has no clips to look at (--motion brings one)"}, "out.glb");
  json glass = glb.json;
  glass["materials"][1]["alphaMode"] = "BLEND";
  refuse(glass, glb, 3, {"rod.glb", "no other piece covers it"}, "out.glb");
  const Glb wide = rod_in_tube(0, kRod + 0.2);  // farther away than clothes are
  refuse(wide.json, wide, 3, {"rod.glb", "no other piece covers it"}, "out.glb");
  refuse(glb.json, glb, 2, {"out.fbx", "name it .glb or .vrm"}, "out.fbx");
  refuse(glb.json, glb, 2, {"out.json", "--as json"}, "out.json");
  refuse(glb.json, glb, 2, {"out.html", "--as page"}, "out.html");
  folder.write("mine.glb", "precious");
  refuse(glb.json, glb, 3, {"mine.glb", "--force replaces it"}, "mine.glb");
  CHECK(tool::contents(folder.path / "mine.glb") == "precious");
}

TEST_CASE("mask: says which limbs no clip raises") {
  const NamedRig human = named_rig(
      "Hips = pelvis\n"
      " Spine = spine\n"
      "  Chest = chest\n"
      "   Neck = neck\n"
      "    Head = head\n"
      "   LeftArm = left_shoulder\n"
      "    LeftForeArm = left_elbow\n"
      "     LeftHand = left_wrist\n"
      "   RightArm = right_shoulder\n"
      "    RightForeArm = right_elbow\n"
      "     RightHand = right_wrist\n"
      " LeftUpLeg = left_hip\n"
      "  LeftLeg = left_knee\n"
      "   LeftFoot = left_ankle\n"
      " RightUpLeg = right_hip\n"
      "  RightLeg = right_knee\n"
      "   RightFoot = right_ankle\n");
  Character character;
  character.rig = human.rig;
  character.source_positions = human.positions;
  const auto node = [&](const char* name) {
    Index n = 0;
    while (human.rig.nodes[n].name != name) ++n;
    return n;
  };
  // About the forward axis an arm goes up at its side, about the left axis a thigh goes up in front.
  const auto clip = [&](const char* name, double degrees, const Vec3& axis) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis));
    const Eigen::Quaterniond rotation = human.rig.nodes[node(name)].rotation * turn;
    Clip out{name, 1, {}, 0};
    Channel channel{ChannelPath::kRotation, node(name), Interpolation::kLinear, {0, 1}, {}};
    for (int key = 0; key < 2; ++key) {
      channel.values.insert(channel.values.end(), rotation.coeffs().begin(), rotation.coeffs().end());
    }
    out.channels.push_back(channel);
    return out;
  };
  const Clip arm_up = clip("LeftArm", 120, Vec3::UnitZ()), leg_up = clip("RightUpLeg", -80, Vec3::UnitX());
  CHECK(limbs_never_raised(character, {leg_up, arm_up}).empty());
  CHECK(limbs_never_raised(character, {arm_up}) == std::vector<std::string>{"legs"});
  CHECK(limbs_never_raised(character, {leg_up}) == std::vector<std::string>{"arms"});
}
