// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/validate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <set>

#include "mesh/error.h"
#include "play/player.h"
#include "truth/capsules.h"
#include "truth/far_parts.h"
#include "truth/missed_depth.h"
#include "truth/truth_cache.h"

namespace spherechain::baker {
namespace {

struct Frame {
  FrameTruth truth;
  std::vector<Pair> reported;
  Score score, skin, chains, all_pairs;
  std::vector<Miss> misses;
  std::vector<CurvePoint> curve;
  ContactErrors contacts, neighbour_contacts;
  std::optional<ContactErrors> contacts_from_bones, neighbour_contacts_from_bones;
  std::vector<CapsulePoint> capsules;
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
  Curve curve{animated.asset(), settings.radius};
  std::vector<std::pair<double, CapsuleRagdoll>> ragdolls = make_ragdolls();
  std::set<Pair> close_capsules =
      close_owners(ragdolls.front().second.surface(), rest, ragdolls.front().second.surface().sphere, close);

  std::vector<std::pair<double, CapsuleRagdoll>> make_ragdolls() const {
    std::vector<std::pair<double, CapsuleRagdoll>> out;
    for (int tenths = 5; tenths <= 10; ++tenths) {
      out.emplace_back(tenths / 10.0, CapsuleRagdoll(animated, surface, tenths / 10.0));
    }
    return out;
  }
};

// Answers, each found once, to whether two owners' triangles are closer than `distance`.
class Closeness {
 public:
  Closeness(const TruthSurface& surface, const std::vector<float>& positions, double distance)
      : surface_(surface), positions_(positions), distance_(distance) {}

  bool operator()(const Pair& pair) {
    const auto [entry, is_new] = known_.try_emplace(pair, false);
    if (is_new) {
      entry->second =
          any_closer(surface_, positions_, surface_.of_sphere[pair.a], surface_.of_sphere[pair.b], distance_);
    }
    return entry->second;
  }

 private:
  const TruthSurface& surface_;
  const std::vector<float>& positions_;
  double distance_;
  std::map<Pair, bool> known_;
};

double no_depth(const TrueContact&) { return 0; }

std::vector<CapsulePoint> score_ragdolls(const Context& context, const Intersections& found, const FrameTruth& truth,
                                         const std::vector<float>& positions, const Deformation& deformation) {
  // All of them own the same triangles.
  const CapsuleRagdoll& any = context.ragdolls.front().second;
  // Whole meshes as poses have nothing a capsule could hang on.
  if (any.capsules().empty() || !deformation.positions.empty()) return {};
  Closeness closeness(any.surface(), positions, context.close);
  const auto is_close = [&](const Pair& pair) { return closeness(pair); };
  const auto is_apart = [&](const Pair& pair) { return context.close_capsules.count(pair) == 0; };
  const FrameTruth shared = any.by_capsules(truth),
                   own = frame_truth(
                       found, context.rest_pairs, any.surface(),
                       [&](std::uint32_t a, std::uint32_t b) { return any.is_ignored(a, b); }, context.is_far);
  std::vector<CapsulePoint> points;
  for (const auto& [quantile, ragdoll] : context.ragdolls) {
    const std::vector<Pair> pairs = ragdoll.pairs(deformation);
    points.push_back({quantile, score_frame(shared, pairs, is_close, is_apart, no_depth),
                      score_frame(own, pairs, is_close, is_apart, no_depth)});
  }
  return points;
}

void add(std::vector<CapsulePoint>& sum, const std::vector<CapsulePoint>& frame) {
  if (sum.empty()) {
    sum = frame;
    return;
  }
  for (std::size_t i = 0; i < frame.size(); ++i) {
    sum[i].score.add(frame[i].score);
    sum[i].own.add(frame[i].own);
  }
}

void add(ContactErrors& sum, const ContactErrors& frame) {
  sum.missing += frame.missing;
  sum.extra += frame.extra;
}

void add(std::optional<ContactErrors>& sum, const std::optional<ContactErrors>& frame) {
  if (!frame) return;
  if (!sum) sum.emplace();
  add(*sum, *frame);
}

std::vector<Pair> touching_spheres(Player& player, const std::vector<float>& positions) {
  player.run(positions);
  return {player.pairs().begin(), player.pairs().end()};
}

Frame validate_frame(const Context& context, int index) {
  const AnimatedAsset& animated = context.animated;
  const TruthSurface& surface = context.surface;
  const ValidateSettings& settings = context.settings;
  const Deformation deformation = animated.deformation(index);
  const std::vector<float> positions = pack(animated.positions(deformation));
  const Intersections found = context.intersections.find(positions);
  Closeness closeness(surface, positions, context.close);
  const auto is_close = [&](const Pair& pair) { return closeness(pair); };
  const auto is_apart = [&](const Pair& pair) { return context.close_spheres.count(pair) == 0; };

  Frame frame;
  const auto ignored = [&](std::uint32_t a, std::uint32_t b) { return is_ignored(animated.asset(), a, b); };
  frame.truth = frame_truth(found, context.rest_pairs, surface, ignored, context.is_far);
  Player chains(animated.asset(), settings.radius, true, false, settings.target),
      all(animated.asset(), settings.radius, false, true, settings.target);
  const std::vector<Pair> chains_pairs = touching_spheres(chains, positions),
                          all_pairs = touching_spheres(all, positions);
  const Player::TriangleDetection skin = all.detect_triangles(pose_of(positions), false);
  const std::vector<Pair> skin_pairs = all.spheres_of(skin.pairs);
  const auto missed = [&](const std::vector<Pair>& reported) {
    return MissedDepth(context.parts.of_triangle, frame.truth, reported, skin.penetrations);
  };
  frame.reported = settings.skin ? skin_pairs : settings.method == Method::kChains ? chains_pairs : all_pairs;
  frame.score = score_frame(frame.truth, frame.reported, is_close, is_apart, [&](const TrueContact& contact) {
    frame.misses.push_back({index, contact.spheres, contact.triangles.size(), missed(frame.reported)(contact)});
    return frame.misses.back().depth;
  });
  frame.skin = score_frame(frame.truth, skin_pairs, is_close, is_apart, missed(skin_pairs));
  frame.chains = score_frame(frame.truth, chains_pairs, is_close, is_apart, missed(chains_pairs));
  frame.all_pairs = score_frame(frame.truth, all_pairs, is_close, is_apart, missed(all_pairs));
  frame.curve = context.curve.measure(all.spheres(), frame.truth, is_close, is_apart);
  frame.capsules = score_ragdolls(context, found, frame.truth, positions, deformation);
  if (settings.contacts) {
    const auto found = [&](Scope scope) { return find_contacts(animated.asset(), positions, scope, settings.target); };
    frame.contacts = compare(found(SC_SCOPE_APART), frame.truth.pairs);
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
                    const std::function<void(int)>& progress) {
  animated.check_clusters();
  const Context context{animated, settings};
  std::vector<Frame> frames(static_cast<std::size_t>(animated.frame_count()));
  std::mutex mutex;
  int done = 0;
  tbb::parallel_for(0, animated.frame_count(), [&](int i) {
    frames[static_cast<std::size_t>(i)] = validate_frame(context, i);
    const std::lock_guard lock(mutex);
    progress(++done);
  });
  Validation out;
  RegionGroups regions(animated.asset());
  ChainGroups chains(animated.asset());
  for (const Frame& frame : frames) {
    out.raw_pairs += frame.truth.raw_pairs;
    out.rest += frame.truth.rest;
    out.same_sphere += frame.truth.same_sphere;
    out.ignored += frame.truth.ignored;
    out.degenerate += frame.truth.degenerate;
    out.score.add(frame.score);
    out.skin.add(frame.skin);
    out.chains.add(frame.chains);
    out.all_pairs.add(frame.all_pairs);
    add(out.curve, frame.curve);
    add(out.capsule_curve, frame.capsules);
    add(out.contacts, frame.contacts);
    add(out.neighbour_contacts, frame.neighbour_contacts);
    add(out.contacts_from_bones, frame.contacts_from_bones);
    add(out.neighbour_contacts_from_bones, frame.neighbour_contacts_from_bones);
    regions.add(frame.truth, frame.reported);
    chains.add(frame.truth, frame.reported);
    out.misses.insert(out.misses.end(), frame.misses.begin(), frame.misses.end());
  }
  std::copy_if(regions.groups().begin(), regions.groups().end(), std::back_inserter(out.by_region),
               [](const PairGroup& group) { return group.true_pairs > 0 || group.reported > 0; });
  if (!out.capsule_curve.empty()) out.capsules = context.ragdolls.front().second.capsules().size();
  out.by_chain = chains.groups();
  std::stable_sort(out.misses.begin(), out.misses.end(),
                   [](const Miss& l, const Miss& r) { return l.depth > r.depth; });
  return out;
}

}  // namespace spherechain::baker
