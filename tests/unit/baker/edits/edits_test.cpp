// SPDX-License-Identifier: GPL-3.0-or-later
// Edits that a person made: spheres that move, grow, come and go, and body parts that ignore each other.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <set>

#include "baked_human.h"
#include "baked_person.h"
#include "baker/edits/hidden_contacts.h"
#include "baker/edits/ignore_parts.h"
#include "baker/edits/region_axes.h"
#include "baker/mesh/error.h"
#include "baker/segment/by_bones.h"
#include "creatures.h"
#include "human.h"
#include "refusal.h"
#include "tool.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

// A character and spheres that nobody edited.
struct Fitted {
  Character character;
  Regions regions;
  Spheres spheres;

  RegionAxes axes(std::uint8_t region) const {
    return region_axes(regions.frame, character.skin, regions.of_skin, regions.count())[region];
  }
  SpherePlace place(std::uint32_t sphere) const {
    const FittedSphere& of = spheres.spheres[sphere];
    return place(of.region, of.ball.center, of.ball.radius);
  }
  SpherePlace place(std::uint8_t region, const Vec3& center, double radius) const {
    const RegionAxes of = axes(region);
    const Vec3 from = (center - of.start) / of.length;
    return {from.dot(of.axis), {from.dot(of.across[0]), from.dot(of.across[1])}, radius / of.length, std::nullopt};
  }
  SphereEdit edit(std::uint32_t sphere) const {
    return {regions.name(spheres.spheres[sphere].region), place(sphere), std::nullopt};
  }
};

Fitted of(const Bake& bake) { return {bake.character, bake.regions, bake.spheres}; }

struct Edited {
  Spheres spheres;
  EditsDone done;
  std::vector<AppliedEdit> applied;
};

Edited edited(const Fitted& fitted, const std::vector<SphereEdit>& edits) {
  Edited out;
  out.spheres = edit_spheres(fitted.character, fitted.regions, fitted.spheres, edits, out.done, out.applied);
  return out;
}

bool is_near(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-9; }

Fitted quadruped(const SourceMesh& mesh) {
  Fitted out;
  out.character = build_character(mesh, "quadruped");
  out.regions = *segment_by_shape(out.character, out.character.largest_piece, {});
  out.spheres = *fit_spheres(out.regions, {});
  return out;
}

// Each triangle in four.
SourceMesh subdivided(const SourceMesh& mesh) {
  SourceMesh out = mesh;
  out.triangles.clear();
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(out.positions.size()));
    if (is_new) out.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    return found->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t : {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}}) {
      out.triangles.push_back(t);
    }
  }
  return out;
}

SourceMesh shuffled(const SourceMesh& mesh) {
  SourceMesh out = mesh;
  std::mt19937 random(3);
  std::vector<Index> places(mesh.positions.size());
  std::iota(places.begin(), places.end(), Index{0});
  std::shuffle(places.begin(), places.end(), random);
  for (std::size_t v = 0; v < places.size(); ++v) out.positions[places[v]] = mesh.positions[v];
  for (Triangle& t : out.triangles) t = {places[t[0]], places[t[1]], places[t[2]]};
  std::shuffle(out.triangles.begin(), out.triangles.end(), random);
  return out;
}

template <typename Move>
SourceMesh moved(const SourceMesh& mesh, const Move& move) {
  SourceMesh out = mesh;
  for (Vec3& p : out.positions) p = move(p);
  return out;
}

}  // namespace

TEST_CASE("a sphere is moved and resized, one is added, one deleted; all others stay as they are") {
  const Fitted human = of(baked_human());
  const std::vector<std::uint32_t>& arm = human.spheres.of_region[0];
  const std::vector<std::uint32_t>& leg = human.spheres.of_region[2];
  SphereEdit change = human.edit(arm[4]), add = human.edit(leg[5]), remove = human.edit(arm[8]);
  change.to = change.from;
  change.to->across[0] += 0.05;
  change.to->radius *= 1.5;
  change.to->detect_radius = 2 * change.to->radius;
  add.to = add.from;
  add.from.reset();
  add.to->along += 0.01;
  const Edited out = edited(human, {change, add, remove});
  CHECK(out.done.applied == 3);
  CHECK(out.done.missed.empty());
  REQUIRE(out.spheres.spheres.size() == human.spheres.spheres.size());

  const std::vector<std::uint32_t>& new_arm = out.spheres.of_region[0];
  const std::vector<std::uint32_t>& new_leg = out.spheres.of_region[2];
  REQUIRE(new_arm.size() == arm.size() - 1);
  REQUIRE(new_leg.size() == leg.size() + 1);
  const RegionAxes axes = human.axes(0);
  for (std::size_t i = 0; i < new_arm.size(); ++i) {
    const FittedSphere& now = out.spheres.spheres[new_arm[i]];
    const FittedSphere& was = human.spheres.spheres[arm[i < 8 ? i : i + 1]];
    if (i == 4) {
      CHECK(is_near(now.ball.center, was.ball.center + 0.05 * axes.length * axes.across[0]));
      CHECK(now.ball.radius == doctest::Approx(1.5 * was.ball.radius));
      CHECK(*now.detect_radius == doctest::Approx(3 * was.ball.radius));
    } else {
      CHECK(now.ball.center == was.ball.center);
      CHECK(now.ball.radius == was.ball.radius);
      CHECK_FALSE(now.detect_radius);
    }
  }
  // The new one stands in the order of the chain, and everyone is its neighbours' neighbour.
  CHECK(is_near(out.spheres.spheres[new_leg[6]].ball.center, human.axes(2).point(*add.to)));
  const std::set<std::pair<std::uint32_t, std::uint32_t>> links(out.spheres.links.begin(), out.spheres.links.end());
  for (const auto* ids : {&new_arm, &new_leg}) {
    for (std::size_t i = 1; i < ids->size(); ++i) CHECK(links.count({(*ids)[i - 1], (*ids)[i]}) == 1);
  }

  // Bound, it is where it was asked to be, and keeps the radii.
  Attempt<Binding> binding = bind_spheres(human.character, human.regions, out.spheres, {});
  REQUIRE(binding);
  const BoundSphere& bound = binding->spheres[new_arm[4]];
  CHECK((bound.rest.center - out.spheres.spheres[new_arm[4]].ball.center).norm() < 1e-6);
  CHECK(bound.rest.radius == out.spheres.spheres[new_arm[4]].ball.radius);
  CHECK(bound.detect_radius == *out.spheres.spheres[new_arm[4]].detect_radius);
  CHECK(bound.keeps_detect_radius);
  EditsDone done;
  check_places(human.regions, out.spheres, *binding, {change, add, remove}, out.applied, done);
  CHECK(done.missed.empty());
  binding->spheres[new_arm[4]].rest.center += 0.01 * human.regions.frame.height * Vec3::UnitX();
  check_places(human.regions, out.spheres, *binding, {change, add, remove}, out.applied, done);
  REQUIRE(done.missed.size() == 1);
  CHECK(contains(done.missed[0], "spheres[0] changes the sphere of left_arm"));
  CHECK(contains(done.missed[0], "1.0 % of the height away"));
}

TEST_CASE("an edit that would take its sphere away from the skin is none") {
  const Fitted human = of(baked_human());
  const std::uint32_t sphere = human.spheres.of_region[0][4];
  SphereEdit far{human.regions.name(0), std::nullopt, human.place(sphere)}, moved = human.edit(sphere);
  far.to->across = {2, 2};
  moved.to = far.to;
  const Edited after = edited(human, {far, moved});
  CHECK(after.done.applied == 0);
  REQUIRE(after.done.missed.size() == 2);
  CHECK(contains(after.done.missed[0], "% of the height away from the region's skin"));
  CHECK(after.spheres.spheres.size() == human.spheres.spheres.size());
  CHECK(is_near(after.spheres.spheres[sphere].ball.center, human.spheres.spheres[sphere].ball.center));
}

TEST_CASE("where edits make neighbours of two parts, their contacts that are left out are reported") {
  const Bake& human = baked_human();
  Binding after = human.binding;
  CHECK(hidden_contacts(human.character, human.body_parts, human.binding, after).empty());
  const std::vector<std::uint32_t>&left = human.spheres.of_region[0], &right = human.spheres.of_region[1];
  for (const std::uint32_t a : left) {
    for (const std::uint32_t b : right) after.ignored.push_back(std::minmax(a, b));
  }
  const auto lines = hidden_contacts(human.character, human.body_parts, human.binding, after);
  CHECK(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return contains(line, "left hand and right hand: ") && contains(line, "100 % of the two skins, before 0 %");
  }));
}

TEST_CASE("edits of the torso keep the levels, and the report's fits are those of spheres that nobody edited") {
  const Fitted human = of(baked_human());
  const std::vector<std::uint32_t>& torso = human.spheres.of_region[4];
  SphereEdit change = human.edit(torso[2]), add = human.edit(torso[3]), remove = human.edit(torso[0]);
  change.to = change.from;
  change.to->radius *= 0.8;
  add.to = add.from;
  add.from.reset();
  const Edited out = edited(human, {change, add, remove});
  CHECK(out.done.missed.empty());
  REQUIRE(out.spheres.torso.size() == human.spheres.torso.size() - 2);
  for (const TorsoFit& fit : out.spheres.torso) {
    CHECK(out.spheres.spheres[fit.sphere].ball.center == fit.phi1_adjusted.center);
    CHECK(out.spheres.spheres[fit.sphere].ball.radius == fit.phi1_adjusted.radius);
  }
  int level = 0;
  for (const std::uint32_t s : out.spheres.of_region[4]) {
    CHECK(out.spheres.spheres[s].level >= level);
    level = out.spheres.spheres[s].level;
  }
}

TEST_CASE("an edit that fits nothing says so, and changes nothing") {
  const Fitted human = of(baked_human());
  const std::uint32_t sphere = human.spheres.of_region[1][3];
  SphereEdit tail = human.edit(sphere), far = human.edit(sphere);
  tail.region = "tail";
  far.from->across = {1, 1};
  const Edited out = edited(human, {tail, far, human.edit(sphere), human.edit(sphere)});
  CHECK(out.done.applied == 1);
  REQUIRE(out.done.missed.size() == 3);
  CHECK(contains(out.done.missed[0], "spheres[0] deletes the sphere of tail"));
  CHECK(contains(out.done.missed[0], "there is no region 'tail'"));
  CHECK(contains(out.done.missed[1], "there is no sphere (the nearest is"));
  CHECK(contains(out.done.missed[2], "another edit is about the sphere that is there"));
  CHECK(out.spheres.spheres.size() == human.spheres.spheres.size() - 1);
}

TEST_CASE("a region keeps its last sphere") {
  const Fitted human = of(baked_human());
  std::vector<SphereEdit> all;
  for (const std::uint32_t s : human.spheres.of_region[0]) all.push_back(human.edit(s));
  const Edited out = edited(human, all);
  REQUIRE(out.done.missed.size() == 1);
  CHECK(contains(out.done.missed[0], "it is the last sphere of its region, which needs one"));
  REQUIRE(out.spheres.of_region[0].size() == 1);
  CHECK(bind_spheres(human.character, human.regions, out.spheres, {}));
}

TEST_CASE("where regions follow the bones, triangles find an owner again, and each sphere has some") {
  Fitted person;
  person.character = baked_person().character;
  person.regions = segment_by_bones(person.character, baked_person().roles, {}, 24);
  FitSettings few;
  few.spheres = 24;
  person.spheres = fit_halves(person.character, person.regions, few);
  const auto most = std::max_element(person.spheres.of_region.begin(), person.spheres.of_region.end(),
                                     [](const auto& a, const auto& b) { return a.size() < b.size(); });
  REQUIRE(most->size() > 1);
  SphereEdit add = person.edit(most->back()), remove = person.edit(most->front());
  add.to = add.from;
  add.from.reset();
  add.to->along += 0.1;
  const Edited out = edited(person, {add, remove});
  CHECK(out.done.missed.empty());
  std::vector<std::size_t> owned(out.spheres.spheres.size(), 0);
  bool in_region = true, others_stay = true;
  for (std::size_t t = 0; t < out.spheres.of_skin.size(); ++t) {
    const FittedSphere& owner = out.spheres.spheres[out.spheres.of_skin[t]];
    const FittedSphere& before = person.spheres.spheres[person.spheres.of_skin[t]];
    ++owned[out.spheres.of_skin[t]];
    in_region = in_region && owner.region == person.regions.of_skin[t];
    const bool is_edited = person.regions.name(before.region) == add.region;
    others_stay = others_stay && (is_edited || owner.ball.center == before.ball.center);
  }
  CHECK(in_region);
  CHECK(others_stay);
  CHECK(std::count(owned.begin(), owned.end(), 0) == 0);
  CHECK(bind_spheres(person.character, person.regions, out.spheres, {}));
}

TEST_CASE("a region's axes turn, move and grow with the mesh, and finer triangles do not change them") {
  const Fitted human = of(baked_human());
  const std::vector<RegionAxes> own =
      region_axes(human.regions.frame, human.character.skin, human.regions.of_skin, human.regions.count());
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  Mesh fine = human.character.skin;
  std::vector<std::uint8_t> of_fine;
  fine.triangles.clear();
  for (std::size_t t = 0; t < human.character.skin.triangles.size(); ++t) {
    const auto& [a, b, c] = human.character.skin.triangles[t];
    const auto center = static_cast<Index>(fine.positions.size());
    fine.positions.push_back(triangle_centroid(human.character.skin, t));
    for (const Triangle& third : {Triangle{a, b, center}, Triangle{b, c, center}, Triangle{c, a, center}}) {
      fine.triangles.push_back(third);
      of_fine.push_back(human.regions.of_skin[t]);
    }
  }
  for (Vec3& p : fine.positions) p = 100 * (turn * p) + Vec3(3, -2, 5);
  BodyFrame frame = human.regions.frame;
  for (Vec3* axis : {&frame.left, &frame.up, &frame.forward}) *axis = turn * *axis;
  frame.height *= 100;
  const std::vector<RegionAxes> turned = region_axes(frame, fine, of_fine, human.regions.count());
  for (std::size_t r = 0; r < own.size(); ++r) {
    CAPTURE(r);
    CHECK((turned[r].start - 100 * (turn * own[r].start) - Vec3(3, -2, 5)).norm() < 1e-6);
    CHECK(is_near(turned[r].axis, turn * own[r].axis));
    for (std::size_t k = 0; k < 2; ++k) CHECK(is_near(turned[r].across[k], turn * own[r].across[k]));
    CHECK(turned[r].length == doctest::Approx(100 * own[r].length));
  }
  // From shoulder and hip to the tip; up the torso.
  for (std::size_t r = 0; r < 4; ++r) {
    CHECK((human.regions.limbs[r].line.points().back() - own[r].point({1, {0, 0}, 0, {}})).norm() < 0.2);
  }
  CHECK(own[4].axis.dot(human.regions.frame.up) > 0.99);
}

TEST_CASE("edits hold on a changed mesh: moved, scaled and reordered, or finer and longer in the leg" *
          doctest::test_suite("many bakes")) {
  const SourceMesh mesh = melt(quadruped_tubes(), 0.05);
  const Fitted own = quadruped(mesh);
  const std::vector<std::uint32_t>& ids = own.spheres.of_region[1];
  REQUIRE(ids.size() > 4);
  SphereEdit change = own.edit(ids[1]), remove = own.edit(ids[3]), add = own.edit(own.spheres.of_region[0][1]);
  change.to = change.from;
  change.to->across[1] += 0.1;
  add.to = add.from;
  add.from.reset();
  add.to->across[0] += 0.05;
  const std::vector<SphereEdit> edits{change, remove, add};
  // Where the first is, changed, and the last, added.
  const auto places = [](const Edited& out) {
    std::array<Vec3, 2> found{Vec3::Zero(), Vec3::Zero()};
    for (const AppliedEdit& one : out.applied) found[one.edit / 2] = out.spheres.spheres[one.sphere].ball.center;
    return found;
  };
  const std::array<Vec3, 2> asked = places(edited(own, edits));

  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(-2, 0.3, 1).normalized()).toRotationMatrix();
  const auto scaled = [&](const Vec3& p) { return Vec3(40 * (turn * p) + Vec3(9, 8, 7)); };
  const auto longer = [](const Vec3& p) { return Vec3(p.x(), p.y() < 0.4 ? 1.1 * p.y() - 0.04 : p.y(), p.z()); };
  const auto check = [&](const SourceMesh& other, const auto& move) {
    const Fitted again = quadruped(other);
    const Edited out = edited(again, edits);
    CHECK(out.done.applied == 3);
    for (const std::string& missed : out.done.missed) MESSAGE(missed);
    const std::array<Vec3, 2> found = places(out);
    for (std::size_t k = 0; k < 2; ++k) {
      const double off = (found[k] - move(asked[k])).norm() / again.regions.frame.height;
      CHECK(off < 0.02);
    }
  };
  check(shuffled(moved(mesh, scaled)), scaled);
  check(subdivided(moved(mesh, longer)), longer);
}

TEST_CASE("two parts ignore each other: all of their triangles, and no other parts'") {
  const Bake& bake = baked_human();
  const PartPairs pairs{{"left hand", "head"}, {"left hand", "tail"}, {"left thigh", "left upper arm"}};
  const Spheres spheres = add_part_spheres(bake.character, bake.regions, bake.spheres, bake.body_parts, pairs);
  CHECK(spheres.spheres.size() == bake.spheres.spheres.size() + 2);  // thigh and upper arm reach into the torso
  Attempt<Binding> binding = bind_spheres(bake.character, bake.regions, spheres, {});
  REQUIRE(binding);
  EditsDone done;
  ignore_parts(bake.character, bake.regions, spheres, bake.body_parts, pairs, 0, *binding, done);
  CHECK(done.applied == 2);
  REQUIRE(done.missed.size() == 1);
  CHECK(done.missed[0] == "ignored_parts[1]: left hand and tail: there is no body part 'tail'");
  std::vector<std::set<std::string>> parts(spheres.spheres.size());
  bool in_region = true;
  for (std::size_t t = 0; t < binding->sphere_of_triangle.size(); ++t) {
    const std::uint32_t owner = binding->sphere_of_triangle[t];
    parts[owner].insert(
        bake.body_parts.parts[bake.body_parts.of_triangle[bake.character.skin_source_triangle[t]]].name);
    in_region = in_region && spheres.spheres[owner].region == bake.regions.of_skin[t];
  }
  CHECK(in_region);
  const std::set<std::pair<std::uint32_t, std::uint32_t>> ignored(binding->ignored.begin(), binding->ignored.end());
  CHECK(std::is_sorted(binding->ignored.begin(), binding->ignored.end()));
  for (const auto& [first, second] : {std::pair("left hand", "head"), std::pair("left thigh", "left upper arm")}) {
    std::size_t count = 0;
    for (std::uint32_t a = 0; a < parts.size(); ++a) {
      for (std::uint32_t b = 0; b < parts.size(); ++b) {
        if (!parts[a].count(first) || !parts[b].count(second)) continue;
        CHECK(parts[a].size() == 1);
        CHECK(parts[b].size() == 1);
        CHECK(ignored.count(std::minmax(a, b)) == 1);
        ++count;
      }
    }
    CHECK(count > 0);
  }
}

TEST_CASE("edits as JSON: what is written is read again, and each fault is reported by its field") {
  const char* whole = R"({"spherechain_edits": 1, "spheres": [
    {"region": "left_arm", "from": {"along": 0.5, "across": [0, 0.1], "radius": 0.1},
     "to": {"along": 0.6, "across": [0, 0.1], "radius": 0.1, "detect_radius": 0.12}}],
    "ignored_parts": [["left hand", "head"]]})";
  const Edits edits = parse_edits(whole, "e.json");
  CHECK(edits.spheres.size() == 1);
  CHECK(parse_edits(to_json(edits), "again") == edits);
  const json good = json::parse(whole);
  const auto refused = [&](const json& text, const char* part) {
    const std::string what = refusal("e.json", [&](const auto& file) { parse_edits(text.dump(), file.string()); });
    CHECK_MESSAGE(contains(what, part), what);
  };
  const auto with = [&](const char* pointer, const json& value) {
    json out = good;
    out[json::json_pointer(pointer)] = value;
    return out;
  };
  refused("text", "is not a file of edits");
  refused(json::object(), "'spherechain_edits' is missing");
  refused(with("/spherechain_edits", 2), "another version");
  refused(with("/sphere", 1), "sphere is unknown");
  refused(with("/spheres", 1), "spheres is not a list");
  refused(with("/spheres/0", json{{"region", "torso"}}), "spheres[0] has neither 'from' nor 'to'");
  refused(with("/spheres/0/region", 5), "spheres[0].region is not a name");
  refused(with("/spheres/0/to/along", "far"), "spheres[0].to.along is not a number from -3 to 3");
  refused(with("/spheres/0/to/radius", 0), "spheres[0].to.radius is not a number from 0.0001 to 2");
  refused(with("/spheres/0/to/detect_radius", 0.09), "spheres[0].to.detect_radius is not a number from 0.1 to 2");
  refused(with("/spheres/0/from/across", json{1}), "spheres[0].from.across is not two numbers");
  refused(with("/spheres/0/from/speed", 1), "spheres[0].from.speed is unknown");
  refused(with("/ignored_parts/0", json{"head"}), "ignored_parts[0] is not two body parts");
  refused(with("/ignored_parts/0/1", "left hand"), "ignored_parts[0] names one body part twice");
  const std::string deep = std::string(100'000, '[');
  CHECK(contains(refusal("e.json", [&](const auto& file) { parse_edits(deep, file.string()); }), "nested more deeply"));
  // As a setting they come back, too.
  const BakeSettings settings = make_settings("balanced", json{{"edits", good}}.dump(), "c.json");
  CHECK(make_settings("balanced", to_json(settings), "c.json").edits == edits);
  CHECK_FALSE(json::parse(to_json(make_settings("balanced", "{}", "c.json"))).contains("edits"));
}

TEST_CASE("bake --edits refuses what is no file of edits, and edits of a prop or by the paper's refit") {
  const TemporaryFolder folder;
  const auto bad = folder.write("bad.json", R"({"spherechain_edits": 1, "spheres": [{"region": 1}]})").string();
  const auto good = folder.write("good.json", R"({"spherechain_edits": 1, "ignored_parts": [["a", "b"]]})").string();
  const auto bake = [&](const std::string& options) {
    return tool::run(fmt::format("bake {} -o {}/out.sphc {}", kHumanFile, folder.path.string(), options));
  };
  tool::check_error(bake("--edits " + bad), 3, {"bad.json", "spheres[0].region is not a name"});
  tool::check_error(bake("--edits none.json"), 3, {"none.json"});
  tool::check_error(bake("--profile paper --edits " + good), 3, {"good.json", "the paper's refit"});
  CHECK(bake("--prop --edits " + good).code == 2);
  CHECK(tool::files_in(folder.path) == 2);
}

TEST_CASE("bake --edits applies what it can, names the rest in a line each, and ends with 5" *
          doctest::test_suite("many bakes")) {
  const Fitted human = of(baked_human());
  Edits edits;
  edits.spheres.push_back(human.edit(human.spheres.of_region[0][4]));
  edits.ignored_parts.push_back({"left hand", "tail"});
  const TemporaryFolder folder;
  const auto file = folder.write("e.json", to_json(edits)).string();
  const tool::Run run = tool::run(
      fmt::format("bake {0} -o {1}/out.sphc --edits {2} --report {1}/r.json", kHumanFile, folder.path.string(), file));
  CHECK(run.code == 5);
  CHECK(run.error == fmt::format("spherechain: edit missed: {}: ignored_parts[0]: left hand and tail: there is no body "
                                 "part 'tail'\n",
                                 file));
  CHECK(contains(run.out, "1 of 2 edits applied"));
  const json report = json::parse(tool::contents(folder.path / "r.json"));
  CHECK(report["edits"]["asked"] == 2);
  CHECK(report["edits"]["applied"] == 1);
  CHECK(report["edits"]["missed"].size() == 1);
  CHECK(report["counts"]["spheres"] == human.spheres.spheres.size() - 1);
  const json settings = json::parse(tool::run("inspect --json " + (folder.path / "out.sphc").string()).out)["settings"];
  CHECK(settings["edits"] == json::parse(to_json(edits)));
  // The asset is whole: its answers are CGAL's.
  const tool::Run valid = tool::run(fmt::format("validate {}/out.sphc --source {} --poses {} --frames 3 --contacts",
                                                folder.path.string(), kHumanFile, tool::pose("arms_crossed.json")));
  CHECK_MESSAGE(valid.code == 0, valid.error);
}
