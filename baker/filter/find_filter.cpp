// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/filter/find_filter.h"

#include <algorithm>
#include <climits>
#include <optional>

#include "baker/filter/confidence.h"
#include "baker/os/parallel.h"

namespace spherechain::baker {

FilterSearch::FilterSearch(const AnimatedAsset& animated, Target target)
    : animated_(animated), skin_(animated.asset()), target_(target), parts_(animated.asset()->part_count()) {
  for (Tally* tally : {&rest_, &clips_, &random_}) {
    tally->touching.assign(pair_count(), 0);
    tally->first_touching = tally->first_apart = std::vector<int>(pair_count(), INT_MAX);
  }
  look(
      1, [](int) { return Deformation(); }, [](int) {}, rest_);
}

// Block by block: within one the threads share the poses, and after it the pairs are counted in the poses' order.
void FilterSearch::look(int count, const std::function<Deformation(int)>& pose, const Progress& progress,
                        Tally& tally) const {
  constexpr int kBlock = 256;
  std::vector<std::optional<TouchingParts>> finders(thread_count());
  std::vector<std::vector<bool>> touching(kBlock);
  for (int start = 0; start < count; start += kBlock) {
    const int end = std::min(count, start + kBlock);
    run_parallel(finders.size(), static_cast<std::size_t>(end - start), [&](std::size_t thread, std::size_t i) {
      std::vector<bool>& pairs = touching[i];
      pairs.assign(pair_count(), false);
      std::optional<TouchingParts>& finder = finders[thread];
      if (!finder) finder.emplace(animated_, skin_, target_);
      for (const PartContact& contact : finder->find(pose(start + static_cast<int>(i)))) {
        const std::size_t a = contact.part_a, b = contact.part_b;
        if (a != b) pairs[a * (2 * parts_ - a - 1) / 2 + (b - a - 1)] = true;
      }
    });
    for (int i = start; i < end; ++i) {
      for (std::size_t p = 0; p < pair_count(); ++p) {
        const bool is_touching = touching[static_cast<std::size_t>(i - start)][p];
        int& first = is_touching ? tally.first_touching[p] : tally.first_apart[p];
        first = std::min(first, tally.count);
        tally.touching[p] += is_touching ? 1 : 0;
      }
      ++tally.count;
    }
    progress(end);
  }
}

void FilterSearch::look_at_frames(const Progress& progress) {
  look(
      animated_.frame_count(), [&](int i) { return animated_.deformation(i); }, progress, clips_);
}

void FilterSearch::look_at_random(const RandomPoses& poses, int count, const Progress& progress) {
  constexpr int kWithinLimits = 2;
  const auto pose = [&](int i) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    RandomPoses::Pose out = poses.next(random, kWithinLimits, 0);
    return Deformation{std::move(out.bones), std::move(out.morphs), {}};
  };
  look(count, pose, progress, random_);
}

PartFilter FilterSearch::result() const {
  PartFilter out;
  out.clip_poses = clips_.count;
  out.random_poses = random_.count;
  std::vector<int> parents;
  for (std::size_t p = 0; p < parts_; ++p) {
    const sc_part part = animated_.asset()->part(p);
    out.parts.emplace_back(part.name);
    parents.push_back(part.parent);
  }
  const int count = clips_.count + random_.count;
  for (std::size_t a = 0, i = 0; a < parts_; ++a) {
    for (std::size_t b = a + 1; b < parts_; ++b, ++i) {
      const int clips = clips_.touching[i], random = random_.touching[i];
      const bool at_rest = rest_.touching[i] > 0;
      FilteredPair pair{{a, b}, PairKind::kNever, clips, random, upper_bound_of_share(random, random_.count)};
      if (parents[a] == static_cast<int>(b) || parents[b] == static_cast<int>(a)) {
        pair.kind = PairKind::kAdjacent;
      } else if (at_rest && count > 0 && clips + random == count) {
        pair.kind = PairKind::kAlways;
      } else if (at_rest) {
        pair.kind = PairKind::kRest;
        if (clips == clips_.count && random_.count > 0)
          out.settled_after = std::max(out.settled_after, random_.first_apart[i] + 1);
      } else if (clips + random > 0) {
        pair.kind = PairKind::kSometimes;
        if (clips == 0) out.settled_after = std::max(out.settled_after, random_.first_touching[i] + 1);
      }
      out.pairs.push_back(pair);
    }
  }
  return out;
}

}  // namespace spherechain::baker
