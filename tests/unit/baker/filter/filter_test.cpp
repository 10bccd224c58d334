// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain filter`: a doll of which it is known which parts meet, and in what share of the poses.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string_view>

#include "baker/check/rules.h"
#include "baker/filter/confidence.h"
#include "baker/filter/find_filter.h"
#include "baker/filter/joint_limits.h"
#include "baker/play/skin_player.h"
#include "human.h"
#include "refusal.h"
#include "runtime/src/contacts/contact_jobs.h"
#include "runtime/src/pairs/detect_job.h"
#include "temporary_folder.h"
#include "tool.h"
#include "wall_and_arm.h"

using namespace spherechain::baker;
using spherechain::Pair;

namespace {

namespace fs = std::filesystem;

// A wall, and on it a block far away, on which a paddle and a core hang: rigid parts, each with a joint. The clip has
// one frame. It leaves the block where it is, and the core in the wall; or it `moves` the block so that the paddle's
// hinge is 0.1015 from the wall: hanging down the paddle is free by 0.0015, turned towards the wall by more than kFree
// degrees it is not. The clip turns it by `degrees`.
std::string doll(bool moves, double degrees = 0) {
  Glb glb;
  const int wall = mesh_of(glb, box(0.5, 1, 1), 0, 0), far = mesh_of(glb, box(0.1, 0.1, 0.1), 2, 0),
            paddle = mesh_of(glb, box(0.1, 0.4, 0.1), 0, -0.4), core = mesh_of(glb, box(0.2, 0.2, 0.2), 0, 0);
  glb.json["nodes"] = {{{"name", "wall"}, {"mesh", wall}, {"children", {1}}},
                       {{"name", "block"}, {"mesh", far}, {"translation", {3, 0.5, 0}}, {"children", {2}}},
                       {{"name", "paddle"}, {"mesh", paddle}, {"children", {3}}},
                       {{"name", "core"}, {"mesh", core}, {"translation", {-2.5, -0.5, 0}}}};
  const auto half = static_cast<float>(-degrees * std::numbers::pi / 360);
  const int input = glb.accessor(std::vector<float>{0}, "SCALAR");
  const std::vector<std::vector<float>> values{
      {0, 0, std::sin(half), std::cos(half)}, {moves ? 0.6015F : 3, 0.5F, 0}, {-2.5F, -0.5F, 0}};
  auto& clip = glb.json["animations"][0];
  clip["name"] = "stand";
  const auto add = [&](int node, const char* path, const std::vector<float>& value) {
    clip["channels"].push_back({{"sampler", clip["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    clip["samplers"].push_back(
        {{"input", input}, {"output", glb.accessor(value, value.size() == 4 ? "VEC4" : "VEC3")}});
  };
  add(2, "rotation", values[0]);
  add(1, "translation", values[1]);
  add(3, "translation", values[2]);
  return glb.bytes();
}
constexpr double kFree = 0.1075;  // 0.1 cos + 0.8 sin = 0.1015

struct Doll {
  explicit Doll(const std::string& glb) : source(folder.write("doll.glb", glb)), asset(folder.path / "doll.sphc") {
    const tool::Run bake = tool::run(fmt::format("bake {} -o {}", source.string(), asset.string()));
    REQUIRE_MESSAGE((bake.code == 0 || bake.code == 5), bake.error);
  }
  AnimatedAsset animated() const { return {asset.string(), source.string(), {}, FrameChoice{0, 0}}; }
  // Random poses with the paddle between two angles from hanging down; negative is towards the wall.
  PartFilter filter(double low, double high, int count) const {
    const auto limits = folder.write(
        "limits.json",
        fmt::format(R"({{"wall": {{}}, "block": {{}}, "core": {{}}, "paddle": {{"z": [{}, {}]}}}})", low, high));
    const AnimatedAsset played = animated();
    RandomPoses poses(played.character(), {});
    read_joint_limits(limits.string(), poses);
    FilterSearch search(played, SC_TARGET_SCALAR);
    search.look_at_frames([](int) {});
    search.look_at_random(poses, count, [](int) {});
    return search.result();
  }

  TemporaryFolder folder;
  fs::path source, asset;
};

const FilteredPair& pair_of(const PartFilter& filter, std::string_view a, std::string_view b) {
  const auto number = [&](std::string_view name) {
    const auto found = std::find(filter.parts.begin(), filter.parts.end(), name);
    REQUIRE_MESSAGE(found != filter.parts.end(), name);
    return static_cast<std::size_t>(found - filter.parts.begin());
  };
  return filter.of(number(b), number(a));
}

std::string refused_filter(const fs::path& file, const OpenAsset& asset) {
  return refusal(file, [&](const fs::path& path) { read_part_filter(path.string(), asset); });
}

}  // namespace

TEST_CASE("a filter's kinds, and its shares of random poses, are those that a doll is made for") {
  const Doll doll(::doll(true));
  const int count = 2000;
  const PartFilter half = doll.filter(-40, 20, count);
  CHECK(half.parts.size() == 4);
  CHECK(half.pairs.size() == 6);
  CHECK(half.clip_poses == 1);
  CHECK(half.random_poses == count);
  CHECK(pair_of(half, "wall", "block").kind == PairKind::kAdjacent);
  CHECK(pair_of(half, "block", "paddle").kind == PairKind::kAdjacent);
  CHECK(pair_of(half, "wall", "core").kind == PairKind::kRest);  // the clip takes it out
  const FilteredPair& met = pair_of(half, "wall", "paddle");
  CHECK(met.kind == PairKind::kSometimes);
  CHECK(met.clip_poses == 0);
  const double share = (40 - kFree) / 60, deviation = std::sqrt(share * (1 - share) / count);
  CHECK(std::abs(met.random_poses / double{count} - share) < 4 * deviation);
  CHECK(met.at_most > met.random_poses / double{count});
  CHECK(met.at_most < share + 6 * deviation);

  const FilteredPair free = pair_of(doll.filter(-kFree + 0.01, 20, count), "wall", "paddle");
  CHECK(free.kind == PairKind::kNever);
  CHECK(free.at_most == doctest::Approx(1 - std::pow(0.05, 1.0 / count)));
  CHECK(pair_of(doll.filter(-kFree - 0.01, -kFree - 0.01, 1), "wall", "paddle").random_poses == 1);
}

TEST_CASE("what intersects in every pose is always in each other, and what only a clip shows is met sometimes") {
  const Doll still(doll(false));
  const PartFilter filter = still.filter(0, 0, 10);
  CHECK(pair_of(filter, "wall", "core").kind == PairKind::kAlways);
  CHECK(pair_of(filter, "wall", "core").random_poses == 10);
  CHECK(filter.settled_after == 0);
  const Doll hit(doll(true, 5));
  const FilteredPair met = pair_of(hit.filter(0, 20, 300), "wall", "paddle");
  CHECK(met.kind == PairKind::kSometimes);
  CHECK(met.clip_poses == 1);
  CHECK(met.random_poses == 0);
}

TEST_CASE("more random poses begin with the fewer, and those that settle the kinds settle them") {
  const Doll doll(::doll(true));
  const PartFilter all = doll.filter(-1, 20, 600), again = doll.filter(-1, 20, 600);
  const auto same = [](const PartFilter& a, const PartFilter& b, bool counts) {
    return std::equal(a.pairs.begin(), a.pairs.end(), b.pairs.begin(), b.pairs.end(),
                      [&](const FilteredPair& p, const FilteredPair& q) {
                        return p.kind == q.kind && (!counts || p.random_poses == q.random_poses);
                      });
  };
  CHECK(same(all, again, true));
  REQUIRE(all.settled_after > 1);
  CHECK(same(all, doll.filter(-1, 20, all.settled_after), false));
  CHECK(!same(all, doll.filter(-1, 20, all.settled_after - 1), false));
}

TEST_CASE("on a human, the parts found to touch are those of a search through the whole skin") {
  const tool::BakedFiles& files = tool::baked_files();
  const AnimatedAsset animated(files.asset.string(), kHumanFile, {}, {});
  const OpenAsset& asset = animated.asset();
  const PartSkin skin(asset);
  TouchingParts touching(animated, skin, SC_TARGET_SCALAR);
  using Parts = std::set<std::pair<std::uint32_t, std::uint32_t>>;
  const auto set_of = [](const std::vector<spherechain::PartContact>& contacts) {
    Parts out;
    for (const auto& contact : contacts) {
      if (contact.part_a != contact.part_b) out.insert({contact.part_a, contact.part_b});
    }
    return out;
  };
  const RandomPoses poses(animated.character(), joints_of(asset));
  std::vector<std::uint64_t> scratch(spherechain::skin_scratch_words(asset.handle()));
  Random random(1);
  std::size_t most = 0;
  for (int i = 0; i < 30; ++i) {
    const RandomPoses::Pose drawn = poses.next(random, 2, 0);
    const Deformation deformation{drawn.bones, drawn.morphs, {}};
    const BonePose pose(asset, deformation);
    std::vector<spherechain::PartContact> contacts(asset->part_count() * asset->part_count());
    spherechain::SkinContactJob job;
    job.asset = asset.handle();
    job.pose = pose.pose();
    job.scope = SC_SCOPE_ALL;
    job.skin_table = skin.table.data();
    job.scratch = scratch.data();
    job.scratch_words = scratch.size();
    job.parts = contacts.data();
    job.part_capacity = contacts.size();
    REQUIRE(job.run() == SC_OK);
    contacts.resize(job.part_count);
    CHECK(set_of(touching.find(deformation)) == set_of(contacts));
    most = std::max(most, contacts.size());
  }
  CHECK(most > 10);
}

TEST_CASE("the bound of a share is Clopper and Pearson's") {
  CHECK(upper_bound_of_share(0, 0) == 1);
  CHECK(upper_bound_of_share(7, 7) == 1);
  for (const int n : {1, 20, 20000, 120000}) {
    CHECK(upper_bound_of_share(0, n) == doctest::Approx(1 - std::pow(0.05, 1.0 / n)).epsilon(1e-9));
    CHECK(upper_bound_of_share(n - 1, n) == doctest::Approx(std::pow(0.95, 1.0 / n)).epsilon(1e-9));
  }
  CHECK(upper_bound_of_share(0, 120000) < 0.003e-2);  // the rule of three: 0.0025 %
  const double p = upper_bound_of_share(1, 50);
  CHECK(std::pow(1 - p, 50) + 50 * p * std::pow(1 - p, 49) == doctest::Approx(0.05).epsilon(1e-9));
}

TEST_CASE("filter writes what is read back, the same bytes each time, and idle pairs of spheres that lose no contact") {
  const Doll doll(::doll(true, 5));
  const fs::path file = doll.folder.path / "filter.json";
  const std::string command =
      fmt::format("filter {} --source {} --poses 300 -o {}", doll.asset.string(), doll.source.string(), file.string());
  const tool::Run first = tool::run(command);
  REQUIRE_MESSAGE(first.code == 0, first.error);
  CHECK(contains(first.out, "of such random poses, at 95 %"));
  const std::string bytes = tool::contents(file);
  CHECK(tool::run(command).code == 0);
  CHECK(tool::contents(file) == bytes);

  const AnimatedAsset animated = doll.animated();
  const OpenAsset& asset = animated.asset();
  const PartFilter filter = read_part_filter(file.string(), asset);
  CHECK(part_filter_json(filter, asset, doll.asset.string()) == bytes);
  CHECK(part_filter_json(read_part_filter(file.string()), asset, doll.asset.string()) == bytes);

  // As docs/integration.md has it.
  const std::uint64_t* const own = asset->info().ignored_pairs;
  std::vector<std::uint64_t> ignored(own, own + sc_pair_words(asset.handle()));
  const nlohmann::json json = nlohmann::json::parse(bytes);
  for (const auto& pair : json["idle_sphere_pairs"]) {
    const std::size_t a = pair[0], b = pair[1], bit = b * (b - 1) / 2 + a;
    REQUIRE((a < b && b < asset->info().sphere_count));
    ignored[bit / 64] |= std::uint64_t{1} << bit % 64;
  }
  CHECK(!json["idle_sphere_pairs"].empty());
  const std::string page = tool::contents(SPHERECHAIN_SAMPLES "/../docs/json.md");
  for (const auto& object : {json, json["poses"], json["pairs"][0]}) {
    for (const auto& [key, value] : object.items()) CHECK_MESSAGE(contains(page, ("`" + key + "`").c_str()), key);
  }
  const BonePose pose(asset, animated.deformation(0));
  std::vector<std::uint64_t> scratch(spherechain::skin_scratch_words(asset.handle()));
  spherechain::SkinContactJob job;
  job.asset = asset.handle();
  job.pose = pose.pose();
  job.skin_table = asset.skin_table();
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  REQUIRE(job.run() == SC_OK);
  const std::size_t all = job.triangle_count;
  const spherechain::Filter spheres{ignored.data(), ignored.size()};
  job.filter = &spheres;
  REQUIRE(job.run() == SC_OK);
  CHECK(all > 0);
  CHECK(job.triangle_count == all);
}

TEST_CASE("rules that name a filter excuse what it found in each other in every pose, and nothing else") {
  const Doll doll(::doll(false));
  const PartFilter filter = doll.filter(0, 0, 5);
  doll.folder.write("filter.json", part_filter_json(filter, open_asset(doll.asset.string()), "doll.sphc"));
  const fs::path rules = doll.folder.write("rules.json", R"({"filter": "filter.json"})");
  const CheckConfig config = read_config(tool::contents(rules), rules.string(), default_config());
  const auto excuse = [&](const char* a, const char* b) {
    Event event{};
    event.parts = {a, b};
    event.kind = SC_CLASS_PENETRATION;
    event.depth_mm = 500;
    return config.rules.excuse(event);
  };
  CHECK(excuse("core", "wall") == "wall and core: any depth is allowed");
  CHECK(excuse("wall", "paddle").empty());
  CHECK(excuse("wall", "block").empty());
  const fs::path missing = doll.folder.write("missing.json", "{}");
  CHECK(
      contains(refusal(missing, [&](const fs::path& path) { read_part_filter(path.string()); }), "is not what filter"));
}

TEST_CASE("a filter that is not of this asset, and limits that are none, are refused by name") {
  const Doll doll(::doll(false));
  const OpenAsset asset = open_asset(doll.asset.string());
  const PartFilter filter = doll.filter(0, 1, 5);
  const std::string good = part_filter_json(filter, asset, "doll.sphc");
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t place = text.find(from);
    REQUIRE(place != std::string::npos);
    text.replace(place, from.size(), to);
    return refused_filter(doll.folder.write("bad.json", text), asset);
  };
  CHECK(refused_filter(doll.folder.write("good.json", good), asset) == "accepted");
  CHECK(
      contains(refused_filter(doll.folder.write("bad.json", good.substr(0, 300)), asset), "is not what filter writes"));
  CHECK(contains(refused("\"paddle\"", "\"oar\""), "'oar', which is no body part"));
  CHECK(contains(refused("\"always\"", "\"often\""), "'kind' of pair"));
  CHECK(contains(refused("\"clips\": 1", "\"clips\": -1"), "'clips' of 'poses'"));
  CHECK(contains(refused("\"random_poses\":", "\"other\":"), "has no 'random_poses'"));
  CHECK(contains(refused("\"at_most\":1", "\"at_most\":7"), "'at_most'"));
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(good);
  for (const nlohmann::ordered_json& other : {nlohmann::ordered_json("of another file"), nlohmann::ordered_json(7)}) {
    json["source"]["sha256"] = other;
    CHECK(contains(refused_filter(doll.folder.write("bad.json", json.dump()), asset), "is of another character"));
  }
  json = nlohmann::ordered_json::parse(good);
  json["pairs"].erase(2);
  CHECK(contains(refused_filter(doll.folder.write("bad.json", json.dump()), asset), "lacks the pair"));
  json["pairs"].push_back(json["pairs"][0]);
  CHECK(contains(refused_filter(doll.folder.write("bad.json", json.dump()), asset), "a pair twice"));

  const AnimatedAsset animated = doll.animated();
  const auto refused_limits = [&](const std::string& text) {
    RandomPoses poses(animated.character(), {});
    return refusal(doll.folder.write("limits.json", text),
                   [&](const fs::path& path) { read_joint_limits(path.string(), poses); });
  };
  CHECK(refused_limits(R"({"paddle": {"z": [-10, 20]}})") == "accepted");
  CHECK(contains(refused_limits("[]"), "is not a JSON object"));
  CHECK(contains(refused_limits(R"({"oar": {"z": [-10, 20]}})"), "'oar': the character has no such joint"));
  CHECK(contains(refused_limits(R"({"paddle": {"w": [-10, 20]}})"), "'w' is no axis"));
  CHECK(contains(refused_limits(R"({"paddle": {"z": [20, -10]}})"), "is not [low, high]"));
}
