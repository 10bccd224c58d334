// SPDX-License-Identifier: GPL-3.0-or-later
// How large the page of `view` may become.
#include "page/page.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "human.h"
#include "mesh/error.h"
#include "temporary_folder.h"
#include "tool.h"

using namespace spherechain::baker;

namespace {

struct Viewed {
  int frames_played = 0;
  std::string page, error;  // one of them
};

// The human's page with `frames` of a motion, in a template without a viewer.
Viewed view(int frames, std::size_t max_bytes = PageOptions().max_bytes) {
  const TemporaryFolder folder;
  PageOptions options;
  options.template_file =
      folder.write("viewer.html", R"(<script id="spherechain-data" type="application/json">null</script>)").string();
  options.max_bytes = max_bytes;
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

TEST_CASE("more frames than fit a page that browsers open are refused at the first, with a number that does") {
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

TEST_CASE("a page is no larger than it may be, whatever it is that is large") {
  const std::size_t size = view(3).page.size(), digits = 1000;  // times differ from run to run by a few digits
  CHECK(view(3, size + digits).error == "");
  const Viewed moving = view(3, size - digits);
  CHECK(moving.frames_played == 3);
  CHECK_MESSAGE(advised(moving.error) > 0, moving.error);
  const Viewed still = view(3, size / 2);
  CHECK_MESSAGE(still.error.find("(its mesh has too many triangles)") != std::string::npos, still.error);
}
