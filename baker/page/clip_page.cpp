// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/page/clip_page.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "baker/page/base64.h"
#include "baker/page/page_penetrations.h"
#include "baker/report/json_text.h"

namespace spherechain::baker {

std::string clip_page(const AnimatedAsset& animated, const ClipFrames& clip, const ClipEvents& found,
                      const std::vector<PagePoke>& pokes, const PageMotion& motion) {
  FrameLists<TrianglePair> contacts;
  FrameLists<PenetrationEntry> penetrations;
  for (std::size_t i = 0, m = 0; i < static_cast<std::size_t>(clip.count); ++i) {
    std::vector<TrianglePair> triangles;
    std::vector<Penetration> in_frame;
    for (; m < found.penetrations.size() && found.penetrations[m].frame == static_cast<int>(i); ++m) {
      in_frame.push_back(found.penetrations[m].found);
      if (is_shown(in_frame.back().kind)) {
        triangles.insert(triangles.end(), found.contacts[m].begin(), found.contacts[m].end());
      }
    }
    std::stable_sort(in_frame.begin(), in_frame.end(),
                     [](const auto& l, const auto& r) { return l.measures.depth > r.measures.depth; });
    contacts.add(triangles);
    penetrations.add(entries_of(in_frame, mm_per_unit(animated.asset())));
  }
  std::vector<float> numbers, seconds;
  for (int i = clip.first; i < clip.first + clip.count; ++i) {
    numbers.push_back(static_cast<float>(animated.number(i)));
    seconds.push_back(static_cast<float>(animated.number(i) / clip.fps));
  }
  nlohmann::ordered_json shown = nlohmann::ordered_json::array();
  for (const PagePoke& poke : pokes) shown.push_back({{"pieces", poke.pieces}, {"triangles", base64(poke.triangles)}});
  return json_text({{"pokes", std::move(shown)},
                    {"frames",
                     {{"count", clip.count},
                      {"fps", clip.fps},
                      {"numbers", base64(numbers)},
                      {"seconds", base64(seconds)},
                      {"times", base64(seconds)},
                      {"contacts", contacts.json()},
                      {"penetrations", penetrations.json()}}},
                    {"motion", motion.json(PageMotion::Still::kInMotion)}},
                   -1);
}

}  // namespace spherechain::baker
