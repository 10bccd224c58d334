// SPDX-License-Identifier: MIT
#include "runtime/src/inside/inside.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/base/pair_bits.h"

namespace spherechain {
namespace {

constexpr int kHalvesMin = 4;          // of six
constexpr std::size_t kShortAxis = 2;  // most characters stand along y, and are thinnest along z

int middle_of(int a, int b, int c) { return std::max(std::min(a, b), std::min(std::max(a, b), c)); }

// How often the skin winds around the line's start.
class Winding : public Crossings {
 public:
  explicit Winding(const Surface& surface) : surface_(surface) {}
  void add(std::uint32_t triangle, int side, double) override { total += side * surface_.facings[triangle]; }

  int total = 0;

 private:
  const Surface& surface_;
};

// The surfaces that a half-line leaves without having entered them: those that its start is inside of.
class Enclosing : public Crossings {
 public:
  Enclosing(const InsideTest& test, std::size_t sphere, int handedness)
      : test_(test), sphere_(sphere), handedness_(handedness) {}

  void add(std::uint32_t triangle, int side, double height) override {
    Entry entry{std::abs(height), triangle, side * test_.skin.surface->facings[triangle] * handedness_ > 0};
    entry.is_left = entry.is_left == (height > 0);
    Half& half = halves_[height > 0 ? 0 : 1];
    std::size_t place = half.count;
    while (place > 0 && is_before(entry, half.entries[place - 1])) {
      --place;
    }
    if (place < kMost) {
      half.count = std::min(half.count + 1, kMost);
      std::copy_backward(half.entries + place, half.entries + half.count - 1, half.entries + half.count);
      half.entries[place] = entry;
    }
  }

  // Calls visit(part, distance) for each of the two half-lines, of the nearest of these surfaces that is neither of the
  // probe's own part nor of one that this hangs together with; kOutside where there is none.
  template <typename Visit>
  void for_halves(const Visit& visit) const {
    for (const Half& half : halves_) {
      std::size_t entered = 0, i = 0;
      std::uint16_t part = kOutside;
      for (; i < half.count && part == kOutside; ++i) {
        if (!half.entries[i].is_left) {
          ++entered;
        } else if (entered > 0) {
          --entered;
        } else if (is_another(half.entries[i].triangle)) {
          part = test_.skin.surface->parts[half.entries[i].triangle];
        }
      }
      visit(part, part == kOutside ? HUGE_VAL : half.entries[i - 1].distance);
    }
  }

 private:
  static constexpr std::size_t kMost = 48;  // the nearest so many crossings
  struct Entry {
    double distance;
    std::uint32_t triangle;
    bool is_left;
  };
  struct Half {
    Entry entries[kMost];
    std::size_t count = 0;
  };

  static bool is_before(const Entry& l, const Entry& r) {
    return l.distance < r.distance || (!(l.distance > r.distance) && l.triangle < r.triangle);
  }
  // Pairs that contacts leave out are left out here, too.
  bool is_another(std::uint32_t triangle) const {
    const Surface& skin = *test_.skin.surface;
    const std::size_t of = skin.parts[triangle];
    if (!test_.are_one) {
      const std::uint64_t* const ignored = test_.ignored_parts;
      return ignored == nullptr || (ignored[of / 64] >> of % 64 & 1) == 0;
    }
    const std::size_t own = test_.surface.sphere_parts[sphere_], other = skin.triangle_spheres[triangle];
    const auto hangs_on = [&](std::size_t a, std::size_t b) {
      return test_.asset.part(a).parent == static_cast<std::int32_t>(b);
    };
    if (of == own || hangs_on(of, own) || hangs_on(own, of) || other == sphere_) {
      return false;
    }
    const std::size_t bit = ignored_bit(std::min(sphere_, other), std::max(sphere_, other));
    return (test_.skin.ignored[bit / 64] >> bit % 64 & 1) == 0;
  }

  const InsideTest& test_;
  std::size_t sphere_;
  int handedness_;
  Half halves_[2];
};

class Tester {
 public:
  explicit Tester(const InsideTest& test) : test_(test) {}

  void run() {
    std::fill(test_.part.begin(), test_.part.end(), kOutside);
    int turns = 0;
    for_probes([&](std::size_t s) {
      count_windings(s);
      turns += middle(test_.windings + 3 * s);
    });
    // A pose that mirrors the skin turns it inside out: then most probes of a body lie inside it the other way round.
    const int handedness = test_.are_one && turns < 0 ? -1 : 1;
    for_probes([&](std::size_t s) {
      if (is_deeper(s, handedness)) {
        test_.part[s] = holder_of(s, handedness);
      }
    });
  }

 private:
  template <typename Visit>
  void for_probes(const Visit& visit) {
    for (std::size_t s = 0; s < test_.centers.size; ++s) {
      const Sphere& center = test_.centers[s];
      const bool is_finite = std::isfinite(center.x) && std::isfinite(center.y) && std::isfinite(center.z);
      if ((test_.asked[s / 64] >> s % 64 & 1) != 0 && is_finite && is_core(test_.surface, s)) {
        visit(s);
      }
    }
  }

  // The part whose skin is nearest, where most half-lines along the axes leave another part's skin.
  std::uint16_t holder_of(std::size_t sphere, int handedness) {
    std::uint16_t nearest = kOutside;
    double least = HUGE_VAL;
    int count = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Enclosing enclosing(test_, sphere, handedness);
      follow_from(sphere, axis, true, enclosing);
      enclosing.for_halves([&](std::uint16_t part, double distance) {
        count += part == kOutside ? 0 : 1;
        if (distance < least || (!(distance > least) && part < nearest)) {
          least = distance;
          nearest = part;
        }
      });
    }
    return count >= kHalvesMin ? nearest : kOutside;
  }

  template <typename T>
  static int middle(const T* of) {
    return middle_of(of[0], of[1], of[2]);
  }

  const std::int8_t* at_rest(std::size_t sphere) const { return test_.surface.rest_windings.data + 3 * sphere; }

  void follow_from(std::size_t sphere, std::size_t axis, bool goes_down, Crossings& found) {
    const Sphere& center = test_.centers[sphere];
    follow(test_.target, test_.skin, {{center.x, center.y, center.z}, axis, true, goes_down}, found);
    test_.skin.has_sphere_boxes = true;
  }

  // Along one axis, where a closed skin gives the same along each; else along all three, and the middle counts.
  void count_windings(std::size_t sphere) {
    const std::int8_t* const rest = at_rest(sphere);
    const bool is_closed = test_.are_one && rest[0] == rest[1] && rest[1] == rest[2];
    std::int16_t* const out = test_.windings + 3 * sphere;
    for (std::size_t axis = is_closed ? kShortAxis : 0; axis < 3; ++axis) {
      Winding winding(*test_.skin.surface);
      follow_from(sphere, axis, false, winding);
      out[axis] = static_cast<std::int16_t>(std::max(-9999, std::min(winding.total, 9999)));
    }
    if (is_closed) {
      out[0] = out[1] = out[kShortAxis];
    }
  }

  bool is_deeper(std::size_t sphere, int handedness) const {
    const std::int16_t* const now = test_.windings + 3 * sphere;
    if (!test_.are_one) {
      return middle(now) != 0;
    }
    int more[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      more[axis] = handedness * now[axis] - at_rest(sphere)[axis];
    }
    return middle(more) > 0;
  }

  const InsideTest& test_;
};

}  // namespace

bool is_core(const Surface& surface, std::size_t sphere) {
  const std::int8_t* const rest = surface.rest_windings.data + 3 * sphere;
  return middle_of(rest[0], rest[1], rest[2]) > 0;
}

void find_inside(const InsideTest& test) { Tester(test).run(); }

}  // namespace spherechain
