// SPDX-License-Identifier: MIT
#include "runtime/src/depth/way_out.h"

#include <algorithm>

namespace spherechain {
namespace {

constexpr int kSteps = 4;      // of a direction towards the normal of what blocks it last
constexpr int kWidenings = 4;  // of what is near
// A way shorter than this share of the contour's width is the shortest (841 faults of seven characters: no other
// direction was shorter by a hundredth).
constexpr double kShallow = 0.5;
constexpr double kLikely = 2;          // times what the contour alone blocks: ways are seldom longer
constexpr double kNearlyAsGood = 1.5;  // times the shortest: the last frame's direction is kept
constexpr double kSameWay = 0.866;     // cosine: a direction that turns farther from the last frame's is another
constexpr double kSame = 0.9998;       // cosine: a direction that is as near to another is not tried again

class Search {
 public:
  Search(Sweep& sweep, const Contour& contour, double outwards, bool are_joined)
      : sweep_(sweep), contour_(contour), outwards_(outwards), are_joined_(are_joined) {}

  bool has_any() const { return has_any_; }
  const Exit& best() const { return best_; }
  // A way that is known.
  void start(const Exit& first) {
    best_ = first;
    has_any_ = true;
    is_new(first.direction);
  }
  bool is_enclosed(const Double3& direction, const WayOut& way) {
    return !are_joined_ && sweep_.is_enclosed(direction, way, contour_, outwards_);
  }
  // From now on, ways that end inside the other part are none.
  void be_careful() {
    is_careful_ = true;
    has_any_ = false;
    tried_count_ = 0;
  }

  // Along that direction, and along those that its blockers' normals lead to: where it is not shorter than the best,
  // so many steps.
  void refine(Double3 direction, int steps_in_vain) {
    for (int step = 0; step <= kSteps && normalize(direction) && is_new(direction); ++step) {
      WayOut way;
      const double bound = has_any_ ? best_.way.depth : HUGE_VAL;
      if (sweep_.find(direction, contour_, bound, way) && !is_refused(direction, way)) {
        best_ = {direction, way};
        has_any_ = true;
      } else if (step >= steps_in_vain) {
        return;
      }
      if (dot(way.normal, direction) > 0.9999) {
        return;
      }
      direction = way.normal;
    }
  }

  // Takes that direction, or what is near it, where it is nearly as good as the best.
  void prefer(const Double3& wanted) {
    if (dot(wanted, best_.direction) > kSameWay) {
      return;
    }
    Exit kept;
    double bound = kNearlyAsGood * best_.way.depth;
    bool found = false;
    Double3 direction = wanted;
    for (int step = 0; step <= kSteps && normalize(direction) && dot(direction, wanted) > kSameWay; ++step) {
      WayOut way;
      if (sweep_.find(direction, contour_, bound, way) && !is_enclosed(direction, way)) {
        kept = {direction, way};
        bound = way.depth;
        found = true;
      } else if (step > 1) {
        break;
      }
      direction = way.normal;
    }
    if (found) {
      best_ = kept;
    }
  }

 private:
  // Is it another than all that were tried?
  bool is_new(const Double3& direction) {
    const auto is_same = [&](const Double3& tried) { return dot(tried, direction) > kSame; };
    if (std::any_of(tried_, tried_ + tried_count_, is_same)) {
      return false;
    }
    if (tried_count_ < kTriedMax) {
      tried_[tried_count_++] = direction;
    }
    return true;
  }

  bool is_refused(const Double3& direction, const WayOut& way) { return is_careful_ && is_enclosed(direction, way); }

  Sweep& sweep_;
  const Contour& contour_;
  double outwards_;
  bool are_joined_;
  bool is_careful_ = false, has_any_ = false;
  Exit best_;
  static constexpr std::size_t kTriedMax = 64;
  Double3 tried_[kTriedMax];
  std::size_t tried_count_ = 0;
};

}  // namespace

void axes_of(const Contour& contour, const Double3& direction, Double3 (&axes)[3]) {
  Double3 aside{0, 0, 0};
  double most = 0;
  for (const Segment3& segment : contour.segments) {
    Double3 arm = segment.from - contour.center;
    arm = arm - dot(arm, direction) * direction;
    if (dot(arm, arm) > most) {
      most = dot(arm, arm);
      aside = arm;
    }
  }
  axes[0] = direction;
  axes[1] = aside;
  if (!normalize(axes[1])) {
    axes[1] = View(direction, contour.center).u;
  }
  axes[2] = cross(axes[0], axes[1]);
  // In a mirrored pose the axes are mirrored, too, and so is what is found along them.
  const double along[2] = {dot(axes[2], contour.normals), dot(axes[2], contour.largest_area)};
  if (along[std::abs(along[0]) > std::abs(along[1]) ? 0 : 1] < 0) {
    axes[2] = -1.0 * axes[2];
  }
}

namespace {

double outwards_of(const Contour& contour) {
  return contour.is_closed && dot(contour.area, contour.normals) < 0 ? -1 : 1;  // -1: the skin is inside out
}

}  // namespace

Exit first_exit(Sweep& sweep, const Contour& contour, double near) {
  const Double3 normals = outwards_of(contour) * contour.normals;
  Double3 first = contour.is_closed ? contour.area : normals;
  if (!normalize(first)) {
    first = contour.is_closed ? normals : contour.area;
    if (!normalize(first)) {
      first = {0, 0, 1};
    }
  }
  // Near triangles alone, while the way is shorter than what is near.
  Exit out{first, {}};
  double reach = std::max(near, kLikely * sweep.find_by_contour(first, contour, HUGE_VAL, out.way));
  for (int i = 0; i < kWidenings; ++i, reach *= 4) {
    sweep.keep_on_way(first, i + 1 < kWidenings ? reach : HUGE_VAL);
    if (sweep.find(first, contour, i + 1 < kWidenings ? reach : HUGE_VAL, out.way)) {
      break;
    }
  }
  return out;
}

Exit shortest_exit(Sweep& sweep, const Contour& contour, const ExitSettings& settings, const Exit& first) {
  const double outwards = outwards_of(contour);
  Search search(sweep, contour, outwards, settings.are_joined);
  search.start(first);
  sweep.keep_near(kNearlyAsGood * first.way.depth);
  Double3 axes[3];
  axes_of(contour, first.direction, axes);
  const double width = std::sqrt(length(contour.area));
  const double likely_shortest = std::max(settings.deep, kShallow * width);
  const auto try_all = [&] {
    for (const Double3& direction :
         {first.direction, first.way.normal, outwards * contour.normals, contour.area, contour.largest_area}) {
      search.refine(direction, 2);
    }
    if (!search.has_any() || search.best().way.depth > likely_shortest) {
      for (int k = 0; k < 27; ++k) {
        const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
        search.refine(double(x) * axes[0] + (double(y) * axes[1] + double(z) * axes[2]), 0);
      }
    }
  };
  try_all();
  if (!search.has_any() || search.is_enclosed(search.best().direction, search.best().way)) {
    const Exit fallback = search.has_any() ? search.best() : first;
    search.be_careful();
    sweep.keep_near(HUGE_VAL);
    try_all();
    if (!search.has_any()) {
      return fallback;
    }
  }
  return search.best();
}

Exit steady_exit(Sweep& sweep, const Contour& contour, const ExitSettings& settings, const Exit& shortest,
                 const Double3& wanted) {
  Search search(sweep, contour, outwards_of(contour), settings.are_joined);
  search.start(shortest);
  search.prefer(wanted);
  return search.best();
}

Exit parting_exit(Sweep& sweep) {
  const Contour none;
  Search search(sweep, none, 1, true);
  sweep.keep_near(HUGE_VAL);
  for (int k = 0; k < 27; ++k) {
    const int x = k % 3 - 1, y = k / 3 % 3 - 1, z = k / 9 - 1;
    search.refine({double(x), double(y), double(z)}, 0);
  }
  return search.best();
}

}  // namespace spherechain
