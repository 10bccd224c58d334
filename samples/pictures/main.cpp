// SPDX-License-Identifier: GPL-3.0-or-later
// Draws what the baker makes of a character: its regions and joints at rest, or a frame of a pose file's motion.
#include <CLI/CLI.hpp>
#include <iostream>

#include "baker/mesh/error.h"
#include "baker/motion/poses.h"
#include "baker/pipeline/pipeline.h"
#include "picture.h"

using namespace spherechain;
using namespace spherechain::baker;
using namespace spherechain::pictures;

namespace {

struct Options {
  std::string character, out, poses;
  int frame = -1, frames = 40, height = 900;
  bool bones = false, back = false;
};

// A joint's two ends move with the joint itself.
std::vector<VertexWeights> rigid_ends(const std::vector<Joint>& joints) {
  std::vector<VertexWeights> weights;
  for (Index j = 0; j < joints.size(); ++j) weights.insert(weights.end(), 2, VertexWeights{{j}, {1.0}});
  return weights;
}

void draw(const Options& options) {
  const Character character = import_character(options.character);
  const Regions regions = segment_character(character, {}, {}, Wraps::kAll)->regions;
  const std::vector<Joint> joints = place_joints(regions);
  std::vector<Vec3> ends;
  for (const Joint& joint : joints) ends.insert(ends.end(), {joint.position, joint.tail});

  Picture picture{regions.body.mesh, {}, {}, {}, {kFront, kLeftSide, kThreeQuarter}, regions.frame, 1, options.height};
  if (options.back) picture.views.push_back(kBack);
  for (const std::uint8_t region : regions.of_triangle)
    picture.triangle_colours.push_back(kRegionColours[region % kRegionColours.size()]);
  if (!options.poses.empty()) {
    const PoseMotion motion = read_pose_motion(options.poses, joints);
    const int frame = options.frame < 0 ? options.frames - 1 : options.frame;
    const double t = options.frames > 1 ? static_cast<double>(frame) / (options.frames - 1) : 1.0;
    const std::vector<VertexWeights> weights = bone_heat_weights(regions.body.mesh, joints);
    const std::vector<Affine> bones = BezierMotion(joints, regions.frame, motion).at(t).bones;
    picture.mesh.positions = deform(regions.body.mesh.positions, weights, bones);
    ends = deform(ends, rigid_ends(joints), bones);
  }
  if (options.bones || options.poses.empty()) {
    for (std::size_t j = 0; j < joints.size(); ++j) picture.lines.push_back({ends[2 * j], ends[2 * j + 1], {0, 0, 0}});
  }
  write_picture(options.out, picture);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Draws a character's regions and joints at rest, or a frame of a pose file's motion, as a PNG"};
  Options options;
  app.add_option("character", options.character, "mesh file")->required();
  app.add_option("-o,--out", options.out, "PNG file to write")->required();
  app.add_option("--poses", options.poses, "pose file (samples/poses)");
  app.add_option("--frame", options.frame, "frame to draw, from 0; default: the last one");
  app.add_option("--frames", options.frames, "frames in the motion")->check(CLI::PositiveNumber);
  app.add_option("--height", options.height, "pixels")->check(CLI::Range(16, 4000));
  app.add_flag("--bones", options.bones, "draw the joints' bones in a pose too");
  app.add_flag("--back", options.back, "add the view from behind");
  CLI11_PARSE(app, argc, argv);
  try {
    draw(options);
  } catch (const Error& error) {
    std::cerr << "draw_character: error: " << error.what() << '\n';
    return static_cast<int>(error.code());
  }
  return 0;
}
