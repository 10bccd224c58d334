// SPDX-License-Identifier: MIT
// stop_at_contact ASSET.sphc MODEL.glb: a clip that never shows a hand inside the body. Where its next pose would, the
// character stops at the last moment before, and goes on when the clip is clear again.
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

#include "gltf_pose.h"
#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

constexpr double kFrame = 1.0 / 30;
constexpr int kHalvings = 7;  // of a frame: to a quarter of a millisecond

class Player {
 public:
  Player(const Model& model, const samples::GltfCharacter& clips) : model_(model), clips_(clips), body_(model) {}

  // The contact with the most triangles at this time of the clip, among those that this sample watches; or null.
  const PartContact* worst_contact(double seconds) {
    body_.set_pose(samples::pose_of(clips_.palette(0, seconds)));
    const Contacts contacts = body_.contacts();
    if (body_.status() != SC_OK) throw std::runtime_error("the palette does not fit");
    ++queries;
    const PartContact* worst = nullptr;
    for (const PartContact& contact : contacts) {
      const bool is_worse = worst == nullptr || contact.triangle_pairs > worst->triangle_pairs;
      if (is_worse && is_watched(contact)) worst = &contact;
    }
    return worst;
  }

  // The last moment that is clear, between one that is and one that is not.
  double stop_between(double clear, double touching) {
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (clear + touching) / 2;
      (worst_contact(middle) == nullptr ? clear : touching) = middle;
    }
    return clear;
  }

  std::size_t queries = 0;

 private:
  // A hand in anything but its own forearm: there it is a fold of the wrist.
  bool is_watched(const PartContact& contact) const {
    const BodyPart a = model_.part(contact.part_a), b = model_.part(contact.part_b);
    const auto is = [](const BodyPart& part, const char* what) { return std::strstr(part.name, what) != nullptr; };
    const bool is_wrist = a.side == b.side && (is(a, "forearm") || is(b, "forearm"));
    return contact.part_a != contact.part_b && (is(a, "hand") || is(b, "hand")) && !is_wrist;
  }

  const Model& model_;
  const samples::GltfCharacter& clips_;
  Body body_;
};

void play(const std::vector<char>& file, const samples::GltfCharacter& clips) {
  const std::vector<Bone> joints = clips.joints();
  const Model model(file.data(), file.size(), joints.data(), joints.size(), SC_COLUMNS_4X4);
  if (!model) throw std::runtime_error(model.message());
  Player player(model, clips);
  double shown = -1;  // the moment of the clip on the screen; none yet
  bool is_stopped = false;
  std::size_t frames = 0, held = 0, stops = 0;
  for (double now = 0; now <= clips.duration(0); now += kFrame, ++frames) {
    const PartContact* const contact = player.worst_contact(now);
    if (contact == nullptr) {
      shown = now;
      is_stopped = false;
      continue;
    }
    held += shown < 0 ? 0 : 1;
    if (is_stopped || shown < 0) continue;
    const Vec3 low = contact->low, high = contact->high;
    const std::string who =
        std::string(model.part_name(contact->part_a)) + " would meet " + model.part_name(contact->part_b);
    shown = player.stop_between(shown, now);
    is_stopped = true;
    ++stops;
    std::printf("frame %zu: %s around (%.2f, %.2f, %.2f): stopped at %.4f s\n", frames, who.c_str(),
                static_cast<double>(low.x + high.x) / 2, static_cast<double>(low.y + high.y) / 2,
                static_cast<double>(low.z + high.z) / 2, shown);
  }
  if (shown < 0) {
    throw std::runtime_error("parts touch in every frame of the clip: there is no clear pose to stop in");
  }
  std::printf("%zu frames, %zu held in %zu stops, %zu queries\n", frames, held, stops, player.queries);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: stop_at_contact ASSET.sphc MODEL.glb\n", stderr);
    return 2;
  }
  try {
    const std::vector<char> file = samples::read_file(argv[1]);
    play(file, samples::GltfCharacter(argv[2]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stop_at_contact: error: %s\n", error.what());
    return 3;
  }
  return 0;
}
