// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/validate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

#include "play/player.h"
#include "truth/depth.h"
#include "truth/truth_cache.h"

namespace spherechain::baker {
namespace {

struct Frame {
  FrameTruth truth;
  Score score;
  std::vector<Miss> misses;
};

std::vector<Pair> reported_pairs(const Asset& asset, const std::vector<float>& positions,
                                 const ValidateSettings& settings) {
  Player player(asset, settings.radius, settings.method == Method::kM1, settings.method == Method::kM2,
                settings.target);
  player.run(positions);
  return {player.pairs().begin(), player.pairs().end()};
}

Frame validate_frame(const AnimatedAsset& animated, int index, const Surface& surface,
                     const CachedIntersections& intersections, const std::vector<TrianglePair>& rest_pairs,
                     const ValidateSettings& settings) {
  const std::vector<float> positions = pack(animated.positions(animated.deformation(index)));
  Frame frame;
  frame.truth = judge(intersections.find(positions), rest_pairs, surface, animated.asset());
  const double close = kCloseSurface * animated.frame().height;
  frame.score = score_frame(
      frame.truth, reported_pairs(animated.asset(), positions, settings),
      [&](const Pair& pair) {
        return any_closer(surface, positions, surface.of_sphere[pair.a], surface.of_sphere[pair.b], close);
      },
      [&](const SphereContact& contact) {
        frame.misses.push_back(
            {index, contact.spheres, contact.triangles.size(), penetration(contact, surface, positions)});
        return frame.misses.back().depth;
      });
  return frame;
}

}  // namespace

Validation validate(const AnimatedAsset& animated, const ValidateSettings& settings,
                    const std::function<void(int)>& progress) {
  const Surface surface = surface_of(animated.asset(), animated.character());
  const CachedIntersections intersections(surface, settings.cache);
  const std::vector<TrianglePair> rest_pairs = intersections.find(pack(animated.character().source_positions)).pairs;
  std::vector<Frame> frames(static_cast<std::size_t>(animated.frame_count()));
  std::mutex mutex;
  int done = 0;
  tbb::parallel_for(0, animated.frame_count(), [&](int i) {
    frames[static_cast<std::size_t>(i)] = validate_frame(animated, i, surface, intersections, rest_pairs, settings);
    const std::lock_guard lock(mutex);
    progress(++done);
  });
  Validation out;
  for (const Frame& frame : frames) {
    out.raw_pairs += frame.truth.raw_pairs;
    out.rest += frame.truth.rest;
    out.same_sphere += frame.truth.same_sphere;
    out.ignored += frame.truth.ignored;
    out.degenerate += frame.truth.degenerate;
    out.score.add(frame.score);
    out.misses.insert(out.misses.end(), frame.misses.begin(), frame.misses.end());
  }
  std::stable_sort(out.misses.begin(), out.misses.end(),
                   [](const Miss& l, const Miss& r) { return l.depth > r.depth; });
  return out;
}

}  // namespace spherechain::baker
