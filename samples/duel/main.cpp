// SPDX-License-Identifier: MIT
// duel ASSET.sphc MODEL.glb: two fighters of one model play its clip face to face, half a clip apart. Who hits whom,
// when, where and how deep? And whose foot goes through the floor?
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

constexpr double kFrame = 1.0 / 30;
constexpr float kDistance = 0.3F;  // of the height, from one fighter's origin to the other's

void check(Status status) {
  if (status != SC_OK) throw std::runtime_error(std::string(field_name(status)) + ": " + code_text(status));
}

// Turned half around the model's own upward axis, or not, and moved along its forward axis.
Transform place_of(const AssetInfo& info, bool turned, float forward) {
  const Vec3 up = info.up, way = info.forward;
  const Vec3 to{forward * way.x, forward * way.y, forward * way.z}, same_size{1, 1, 1};
  return turned ? Transform{to, {up.x, up.y, up.z, 0}, same_size} : Transform{to, {0, 0, 0, 1}, same_size};
}

struct Score {
  std::size_t hits = 0, passing = 0;
};

// Prints the hits on the way from the last frame to this one, with the depth where they last until this frame.
void report(const Model& model, std::size_t frame, const Steps& steps, const Penetrations& depths, Score& score) {
  const double before = static_cast<double>(frame) - 1;
  for (const StepContact& hit : steps) {
    if (hit.at_start != 0) continue;  // not a new one
    ++score.hits;
    std::printf("frame %.2f: red's %s meets blue's %s at (%.2f, %.2f, %.2f)", before + double{hit.begin},
                model.part_name(hit.part_a), model.part_name(hit.part_b), double{hit.at.x}, double{hit.at.y},
                double{hit.at.z});
    if (hit.at_end == 0) {
      ++score.passing;
      std::printf(" and leaves it at %.2f", before + double{hit.end});
    }
    for (const Penetration& depth : depths) {
      if (depth.part != hit.part_a || depth.other != hit.part_b) continue;
      std::printf(", %.0f mm deep in frame %zu", double{model.millimetres(depth.measures.depth)}, frame);
    }
    std::printf("\n");
  }
}

void fight(const std::vector<char>& file, const samples::GltfCharacter& clips) {
  if (clips.clip_count() == 0) throw std::runtime_error("the model has no clip");
  const std::vector<Bone> joints = clips.joints();
  const Model model(file.data(), file.size(), joints.data(), joints.size(), SC_COLUMNS_4X4);
  if (!model) throw std::runtime_error(model.message());
  BodyDef def;
  def.finds_steps = 1;
  Body red(model, def), blue(model, def);
  check(red.status());
  check(blue.status());
  const AssetInfo info = model.info();
  const Transform red_place = place_of(info, false, 0), blue_place = place_of(info, true, kDistance * info.height);
  Ground floor;
  floor.up = {0, 1, 0};  // in a glTF file y is up
  Query all;
  all.classes = ~0U;  // touches, too
  all.full = 1;
  const double duration = clips.duration(0);
  Score score;
  std::size_t frames = 0;
  float deepest = 0;
  for (double now = 0; now <= duration; now += kFrame, ++frames) {
    check(red.set_pose(samples::pose_of(clips.palette(0, now)), red_place));
    const double later = now < duration / 2 ? now + duration / 2 : now - duration / 2;
    check(blue.set_pose(samples::pose_of(clips.palette(0, later)), blue_place));
    if (frames > 0) {
      const Steps steps = red.steps(blue);
      check(red.status());
      report(model, frames, steps, red.penetrations(blue, all), score);
      check(red.status());
    }
    for (Body* fighter : {&red, &blue}) {
      for (const Penetration& part : fighter->below(floor, all)) deepest = std::max(deepest, part.measures.depth);
      check(fighter->status());
    }
  }
  std::printf("%zu frames, %zu hits, %zu of them between two frames; below the floor by %.0f mm at most\n", frames,
              score.hits, score.passing, double{model.millimetres(deepest)});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: duel ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    fight(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "duel: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
