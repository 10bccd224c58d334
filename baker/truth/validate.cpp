// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/validate.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "baker/mesh/error.h"
#include "baker/os/parallel.h"
#include "baker/play/player.h"
#include "baker/truth/far_parts.h"
#include "baker/truth/missed_depth.h"
#include "baker/truth/truth_cache.h"

namespace spherechain::baker {
namespace {

struct Frame {
  FrameTruth truth;
  std::vector<Pair> reported;
  Score score, skin, all_pairs;
  std::vector<Miss> misses;
  ContactErrors contacts, neighbour_contacts;
  std::optional<ContactErrors> contacts_from_bones, neighbour_contacts_from_bones;
};

// Data that all frames share.
struct Context {
  const AnimatedAsset& animated;
  const ValidateSettings& settings;
  TruthSurface surface = surface_of(animated.asset(), animated.character());
  CachedIntersections intersections{surface, settings.cache};
  std::vector<float> rest = pack(animated.character().source_positions);
  std::vector<Pair> rest_pairs = intersections.find(rest).pairs;
  double close = kCloseSurface * animated.frame().height;
  FarParts is_far{animated, surface, close};
  BodyParts parts = body_parts_of(animated.asset());
  std::set<Pair> close_spheres = close_owners(surface, rest, surface.sphere, close);  // at rest
};

void add(ContactErrors& sum, const ContactErrors& frame) {
  sum.missing += frame.missing;
  sum.extra += frame.extra;
}

void add(std::optional<ContactErrors>& sum, const std::optional<ContactErrors>& frame) {
  if (!frame) return;
  if (!sum) sum.emplace();
  add(*sum, *frame);
}

Frame validate_frame(const Context& context, int index, const std::function<void(const ValidatedFrame&)>& observe) {
  const AnimatedAsset& animated = context.animated;
  const TruthSurface& surface = context.surface;
  const ValidateSettings& settings = context.settings;
  const Deformation deformation = animated.deformation(index);
  const std::vector<float> positions = pack(animated.positions(deformation));
  const Intersections found = context.intersections.find(positions);
  Closeness closeness(surface, positions, context.close);
  const std::function<bool(const Pair&)> is_close = [&](const Pair& pair) { return closeness(pair); };
  const std::function<bool(const Pair&)> is_apart = [&](const Pair& pair) {
    return context.close_spheres.count(pair) == 0;
  };

  Frame frame;
  const auto ignored = [&](std::uint32_t a, std::uint32_t b) { return is_ignored(animated.asset(), a, b); };
  frame.truth = frame_truth(found, context.rest_pairs, surface, ignored, context.is_far);
  Player player(animated.asset(), settings.radius, settings.target);
  player.run(positions);
  const std::vector<Pair> all_pairs{player.pairs().begin(), player.pairs().end()};
  const Player::TriangleDetection skin = player.detect_triangles(pose_of(positions), false);
  const std::vector<Pair> skin_pairs = player.spheres_of(skin.pairs);
  const auto missed = [&](const std::vector<Pair>& reported) {
    return MissedDepth(context.parts.of_triangle, frame.truth, reported, skin.penetrations);
  };
  frame.reported = settings.skin ? skin_pairs : all_pairs;
  frame.score = score_frame(frame.truth, frame.reported, is_close, is_apart, [&](const TrueContact& contact) {
    frame.misses.push_back({index, contact.spheres, contact.triangles.size(), missed(frame.reported)(contact)});
    return frame.misses.back().depth;
  });
  frame.skin = score_frame(frame.truth, skin_pairs, is_close, is_apart, missed(skin_pairs));
  frame.all_pairs = score_frame(frame.truth, all_pairs, is_close, is_apart, missed(all_pairs));
  if (observe) {
    observe({index, surface, context.is_far, context.rest_pairs, deformation, positions, found, frame.truth,
             player.spheres(), all_pairs, frame.reported, is_close, is_apart});
  }
  if (settings.contacts) {
    const auto found = [&](Scope scope) { return find_contacts(animated.asset(), positions, scope, settings.target); };
    frame.contacts = compare(found(SC_SCOPE_LAYERS), frame.truth.pairs);
    frame.neighbour_contacts = compare(found(SC_SCOPE_NEIGHBOURS), frame.truth.neighbours);
    if (moved_by_bones(animated.asset(), deformation)) {
      // Exact contacts of these very positions, which differ from the baker's by rounding.
      const ContactsFromBones of_bones =
          find_contacts_from_bones(animated.asset(), animated.character(), deformation, settings.target);
      const FrameTruth truth = frame_truth(context.intersections.find(of_bones.positions), context.rest_pairs, surface,
                                           ignored, context.is_far);
      frame.contacts_from_bones = compare(of_bones.pairs, truth.pairs);
      frame.neighbour_contacts_from_bones = compare(of_bones.neighbours, truth.neighbours);
    }
  }
  return frame;
}

}  // namespace

Validation validate(const AnimatedAsset& animated, const ValidateSettings& settings,
                    const std::function<void(int)>& progress,
                    const std::function<void(const ValidatedFrame&)>& observe) {
  animated.check_clusters();
  const Context context{animated, settings};
  std::vector<Frame> frames(static_cast<std::size_t>(animated.frame_count()));
  std::mutex mutex;
  int done = 0;
  run_parallel(thread_count(), frames.size(), [&](std::size_t, std::size_t i) {
    frames[i] = validate_frame(context, static_cast<int>(i), observe);
    const std::lock_guard lock(mutex);
    progress(++done);
  });
  Validation out;
  RegionGroups regions(animated.asset());
  for (const Frame& frame : frames) {
    out.raw_pairs += frame.truth.raw_pairs;
    out.rest += frame.truth.rest;
    out.same_sphere += frame.truth.same_sphere;
    out.ignored += frame.truth.ignored;
    out.degenerate += frame.truth.degenerate;
    out.score.add(frame.score);
    out.skin.add(frame.skin);
    out.all_pairs.add(frame.all_pairs);
    add(out.contacts, frame.contacts);
    add(out.neighbour_contacts, frame.neighbour_contacts);
    add(out.contacts_from_bones, frame.contacts_from_bones);
    add(out.neighbour_contacts_from_bones, frame.neighbour_contacts_from_bones);
    regions.add(frame.truth, frame.reported);
    out.misses.insert(out.misses.end(), frame.misses.begin(), frame.misses.end());
  }
  std::copy_if(regions.groups().begin(), regions.groups().end(), std::back_inserter(out.by_region),
               [](const PairGroup& group) { return group.true_pairs > 0 || group.reported > 0; });
  std::stable_sort(out.misses.begin(), out.misses.end(),
                   [](const Miss& l, const Miss& r) { return l.depth > r.depth; });
  return out;
}

}  // namespace spherechain::baker
