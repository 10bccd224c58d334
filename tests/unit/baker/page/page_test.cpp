// SPDX-License-Identifier: GPL-3.0-or-later
// How large the page of `view` may become.
#include "baker/page/page.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/volumes/fit_volumes.h"
#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;

namespace {

struct Viewed {
  int frames_played = 0;
  std::string page, error;  // one of them
};

// The human's page with `frames` of a motion, in a template without a viewer.
Viewed view(int frames, std::size_t max_bytes = PageOptions().max_bytes, const Colliders* colliders = nullptr) {
  const TemporaryFolder folder;
  PageOptions options;
  options.template_file =
      folder.write("viewer.html", R"(<script id="spherechain-data" type="application/json">null</script>)").string();
  options.max_bytes = max_bytes;
  options.colliders = colliders;
  MotionChoice motion;
  motion.poses = tool::pose("arms_crossed.json");
  const AnimatedAsset animated(tool::baked_files().asset.string(), kHumanFile, motion, {frames, 30});
  Viewed out;
  try {
    out.page = view_page(animated, options, [&](int) { ++out.frames_played; });
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kUsage);
    out.error = error.what();
  }
  return out;
}

int advised(const std::string& error) {
  const std::size_t at = error.find("(--frames ");
  return at == std::string::npos ? 0 : std::stoi(error.substr(at + 10));
}

}  // namespace

TEST_CASE("more frames than fit a page that browsers open are refused at the first, with a number that does" *
          doctest::test_suite("many bakes")) {
  const Viewed million = view(1000000);
  CHECK(million.frames_played == 1);
  CHECK_MESSAGE(million.error.find(": 1000000 frames make a page of ") != std::string::npos, million.error);
  CHECK(million.error.find(" MB, of which browsers open 512.0 MB (--frames ") != std::string::npos);
  CHECK(advised(million.error) > 50000);

  const std::size_t little = view(1).page.size() + 1000000;
  const Viewed many = view(1000, little);
  CHECK(many.frames_played == 1);
  REQUIRE(advised(many.error) > 100);
  CHECK(view(advised(many.error), little).error == "");
}

TEST_CASE("a page is the same byte for byte each time, and no larger than it may be, whatever it is that is large" *
          doctest::test_suite("long runs")) {
  const std::string page = view(3).page;
  const std::size_t size = page.size(), digits = 1000;  // more than an estimate is off
  CHECK(view(3, size + digits).page == page);
  const Viewed moving = view(3, size - digits);
  CHECK(moving.frames_played == 3);
  CHECK_MESSAGE(advised(moving.error) > 0, moving.error);
  const Viewed still = view(3, size / 2);
  CHECK_MESSAGE(still.error.find("(its mesh has too many triangles)") != std::string::npos, still.error);
}

TEST_CASE("a page of colliders has each body's bone, and its volumes around the skin at rest" *
          doctest::test_suite("many bakes")) {
  const OpenAsset asset = open_asset(tool::baked_files().asset.string());
  Colliders colliders = fit_volumes(asset, VolumeShape::kCapsules, 8);
  // The same human in another unit: metres of the volumes stay, positions of the page are in source units.
  colliders.metres_per_unit /= 2;
  const std::string page = view(2, PageOptions().max_bytes, &colliders).page;
  const std::size_t from = page.find('{'), to = page.rfind('}');
  const auto data = nlohmann::json::parse(page.substr(from, to + 1 - from));
  REQUIRE(data["colliders"].size() == colliders.bodies.size());
  std::vector<Volume> at_rest;  // in the human's own units
  for (std::size_t i = 0; i < colliders.bodies.size(); ++i) {
    const auto& body = data["colliders"][i];
    CHECK(body["part"] == colliders.bodies[i].name);
    CHECK(body["bone"] == colliders.bodies[i].bone_index);
    for (const auto& volume : body["volumes"]) {
      const auto vec = [&](const char* key) { return Vec3(volume[key][0], volume[key][1], volume[key][2]); };
      const double radius = volume["radius"];
      at_rest.push_back(ConeVolume{vec("a") / 2, vec("b") / 2, radius / 2, radius / 2});
    }
  }
  const std::vector<Vec3>& skin = human().character.source_positions;
  const auto inside = std::count_if(skin.begin(), skin.end(), [&](const Vec3& point) {
    return std::any_of(at_rest.begin(), at_rest.end(),
                       [&](const Volume& one) { return signed_distance(one, point) <= 0; });
  });
  // Most vertices are in the face and the fingers, less of the area.
  CHECK(static_cast<double>(inside) > 0.7 * static_cast<double>(skin.size()));
  CHECK(data["frames"]["colliders"]["counts"].get<std::string>().size() == 12);  // of two frames
}
