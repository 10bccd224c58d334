// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/event_pictures.h"

#include <map>
#include <tuple>

#include "baker/check/tickets.h"

namespace spherechain::baker {

std::vector<std::string> draw_events(const AnimatedAsset& animated, const ClipFrames& clip, ClipEvents& found,
                                     Picture& picture) {
  std::vector<std::string> out;
  const auto patches_of = [&](const Event& event, const std::vector<TrianglePair>& contacts) {
    Patches patches;
    Vec3 sum = Vec3::Zero();
    for (const TrianglePair& pair : contacts) {
      patches.triangles[0].push_back(pair[0]);
      patches.triangles[1].push_back(pair[1]);
      for (const std::uint32_t t : pair) {
        for (const Index v : animated.character().source_triangles[t]) sum += picture.position(v);
      }
    }
    patches.point = sum / (6 * static_cast<double>(contacts.size()));
    patches.way = event.direction;
    return patches;
  };
  picture.pose(animated.positions(animated.deformation(clip.first)));
  out.push_back(picture.png(nullptr, picture.forward()));
  // No event has an eye yet, so severity() counts all alike for it.
  struct Shown {
    const Event *deepest = nullptr, *worst = nullptr;
  };
  std::map<std::tuple<std::string, std::string, PenetrationClass>, Shown> shown;
  for (const Event& event : found.events) {
    auto& [deepest, worst] = shown[{event.parts[0], event.parts[1], event.kind}];
    if (deepest == nullptr || event.depth_mm > deepest->depth_mm) deepest = &event;
    if (worst == nullptr || severity(event, clip.fps) > severity(*worst, clip.fps)) worst = &event;
  }
  for (std::size_t i = 0; i < found.events.size(); ++i) {
    Event& event = found.events[i];
    if (!is_fault(event.kind)) continue;
    picture.pose(animated.positions(animated.deformation(clip.first + event.place)));
    const std::vector<TrianglePair>& contacts = found.contacts[found.spans[i].deepest];
    // A part that is wholly inside has no contact. A person sees that it is missing.
    const bool is_gone = contacts.empty();
    const Patches patches = is_gone ? Patches{} : patches_of(event, contacts);
    event.eye = is_gone ? picture.forward() : picture.find_eye(patches);
    const Shown& of_parts = shown[{event.parts[0], event.parts[1], event.kind}];
    if (of_parts.deepest != &event && of_parts.worst != &event) continue;
    event.picture = static_cast<int>(out.size());
    out.push_back(picture.png(is_gone ? nullptr : &patches, *event.eye));
  }
  return out;
}

}  // namespace spherechain::baker
