// SPDX-License-Identifier: GPL-3.0-or-later
// Draws an asset's spheres in its source's skin, at rest or in a frame of a pose file's motion; touching spheres stand
// out.
#include <CLI/CLI.hpp>
#include <iostream>
#include <set>

#include "baker/mesh/error.h"
#include "baker/play/play.h"
#include "baker/play/player.h"
#include "picture.h"
#include "runtime/src/pairs/detect_job.h"

using namespace spherechain::baker;
using namespace spherechain::pictures;
using spherechain::Radius;
using Vec3 = spherechain::baker::Vec3;

namespace {

struct Options {
  std::string asset, source, out, radius = "fit";
  MotionChoice motion;
  FrameChoice frames;
  int frame = -1, height = 900;
};

std::set<std::uint32_t> touching(const OpenAsset& asset, const std::vector<spherechain::Sphere>& spheres,
                                 Radius radius) {
  std::vector<spherechain::Pair> pairs(spheres.size() * (spheres.size() - 1) / 2);
  spherechain::DetectJob job;
  job.asset = asset.handle();
  job.spheres = spheres.data();
  job.sphere_count = spheres.size();
  job.radius = radius;
  job.pairs = pairs.data();
  job.pair_capacity = pairs.size();
  check_runtime(job.run());
  std::set<std::uint32_t> ids;
  for (std::size_t i = 0; i < job.pair_count; ++i) {
    ids.insert({pairs[i].a, pairs[i].b});
    std::cout << asset->region(asset->spheres()[pairs[i].a].region).name << ' ' << pairs[i].a << " - "
              << asset->region(asset->spheres()[pairs[i].b].region).name << ' ' << pairs[i].b << '\n';
  }
  return ids;
}

void draw(const Options& options) {
  const AnimatedAsset animated(options.asset, options.source, options.motion, options.frames);
  const OpenAsset& asset = animated.asset();
  const Character& character = animated.character();
  const std::vector<Vec3> positions = animated.positions(animated.deformation(
      options.frame < 0 ? animated.frame_count() - 1 : std::min(options.frame, animated.frame_count() - 1)));

  Picture picture{character.skin, {}, {}, {}, {kFront, kLeftSide, kThreeQuarter}, animated.frame(), 0.35,
                  options.height};
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (character.skin_of_source[v] != kNoIndex) picture.mesh.positions[character.skin_of_source[v]] = positions[v];
  }
  const Radius radius = options.radius == "fit" ? SC_RADIUS_FIT : SC_RADIUS_DETECT;
  const std::vector<spherechain::Sphere> spheres = refit_spheres(asset, pack(positions), radius);
  const std::set<std::uint32_t> ids = touching(asset, spheres, radius);
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    const std::uint8_t region = asset->spheres()[i].region;
    picture.spheres.push_back({Vec3(spheres[i].x, spheres[i].y, spheres[i].z), static_cast<double>(spheres[i].radius),
                               kRegionColours[region % kRegionColours.size()], ids.count(i) > 0});
  }
  write_picture(options.out, picture);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Draws an asset's spheres in its source's skin as a PNG and lists the pairs that touch"};
  Options options;
  app.add_option("asset", options.asset, "asset (.sphc)")->required();
  app.add_option("source", options.source, "the mesh it was baked from")->required();
  app.add_option("-o,--out", options.out, "PNG file to write")->required();
  app.add_option("--poses", options.motion.poses, "as for spherechain play");
  app.add_option("--clip", options.motion.clip, "as for spherechain play");
  app.add_option("--motion", options.motion.motion, "as for spherechain play");
  app.add_option("--frame", options.frame, "frame of the motion; the last one by default");
  app.add_option("--frames", options.frames.count, "frames of the motion")->check(CLI::Range(1, 100000));
  app.add_option("--radius", options.radius, "fit or detect")
      ->check(CLI::IsMember({"fit", "detect"}))
      ->capture_default_str();
  app.add_option("--height", options.height, "height of the picture in pixels")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    draw(options);
  } catch (const Error& error) {
    std::cerr << "draw_asset: error: " << error.what() << '\n';
    return static_cast<int>(error.code());
  }
  return 0;
}
