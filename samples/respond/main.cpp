// SPDX-License-Identifier: MIT
// respond ASSET.sphc MODEL.glb: a clip whose arms and hands are kept out of the body. The page to copy from is play().
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

constexpr int kRate = 30;  // frames a second

[[noreturn]] void fail(const char* message) { throw std::runtime_error(message); }

// Counts what the response is there for: a fault of an arm or a hand. Folds of a joint are left out.
class FaultCounter {
 public:
  explicit FaultCounter(const Model& model) : model_(model), body_(model) {}

  bool has_fault(const samples::Palette& palette) {
    if (body_.set_pose(samples::pose_of(palette)) != SC_OK) fail("the palette does not fit");
    const Penetrations found = body_.penetrations();
    return std::any_of(found.begin(), found.end(), [&](const Penetration& p) {
      return p.measures.relation != SC_RELATION_JOINED && (is_arm(p.part) || is_arm(p.other));
    });
  }

 private:
  bool is_arm(std::uint32_t part) const {
    const char* const name = model_.part_name(part);
    return std::strstr(name, " upper arm") != nullptr || std::strstr(name, " forearm") != nullptr ||
           std::strstr(name, " hand") != nullptr;
  }

  const Model& model_;
  Body body_;
};

// The angle between two rotations, in degrees.
double angle_between(const float (&a)[4], const float (&b)[4]) {
  double cosine = 0, sizes = 0, other = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    cosine += double{a[k]} * double{b[k]};
    sizes += double{a[k]} * double{a[k]};
    other += double{b[k]} * double{b[k]};
  }
  return 360 / 3.14159265358979 * std::acos(std::min(std::abs(cosine) / std::sqrt(sizes * other), 1.0));
}

struct Tally {
  int frames = 0, before = 0, after = 0;
  double largest = 0;  // degrees
};

void print(const char* what, const Tally& tally) {
  std::printf("%s: %d of %d frames had a fault of an arm, %d have one now; largest correction %.1f degrees\n", what,
              tally.before, tally.frames, tally.after, tally.largest);
}

void add(Tally& sum, const Tally& more) {
  sum.frames += more.frames;
  sum.before += more.before;
  sum.after += more.after;
  sum.largest = std::max(sum.largest, more.largest);
}

void play(const std::vector<char>& file, const samples::GltfCharacter& rig) {
  const std::vector<Bone> joints = rig.joints();
  Model model(file.data(), file.size(), joints.data(), joints.size(), SC_COLUMNS_4X4);
  if (!model) fail(model.message());
  Body body(model);  // the response's own
  const std::vector<std::uint32_t> parents = rig.parents();
  ResponseDef def;
  def.parents = parents.data();
  def.joint_count = parents.size();
  Response response(body, def);  // allocates here, never in a frame
  if (!response) fail("the response was not made");
  ResponseState state;  // one for each character

  FaultCounter counter(model);
  Tally second, all;
  const int frame_count = rig.frame_count(0, kRate);
  for (int f = 0; f < frame_count; ++f) {
    const std::vector<Transform> animated = rig.locals(0, f / double{kRate});
    std::vector<Transform> corrected = animated;
    ResponseFrame frame;
    frame.joints = corrected.data();
    frame.seconds = 1.0F / kRate;
    if (response.respond(state, frame) != SC_OK) fail("the response failed");
    const samples::Palette palette = rig.palette(corrected);  // for your skinning shader

    Tally now{1, counter.has_fault(rig.palette(animated)) ? 1 : 0, counter.has_fault(palette) ? 1 : 0, 0};
    for (std::size_t j = 0; frame.turned > 0 && j < corrected.size(); ++j) {
      now.largest = std::max(now.largest, angle_between(animated[j].rotation, corrected[j].rotation));
    }
    add(second, now);
    if ((f + 1) % kRate == 0 || f + 1 == frame_count) {
      print(("second " + std::to_string(f / kRate)).c_str(), second);
      add(all, second);
      second = {};
    }
  }
  print("all", all);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: respond ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    play(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "respond: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
