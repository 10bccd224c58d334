// SPDX-License-Identifier: MIT
#include "runtime/src/inside/inside.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/skin/core_point.h"
#include "runtime/src/skin/windings.h"

namespace spherechain {
namespace {

constexpr int kHalvesMin = 4;  // of six

// How often the skin winds around the line's start.
class Winding : public Crossings {
 public:
  explicit Winding(const Surface& surface) : surface_(surface) {}
  void add(std::uint32_t triangle, int side, double) override { total += side * facing(surface_, triangle); }

  int total = 0;

 private:
  const Surface& surface_;
};

struct Probe {
  Vec3 at;
  const std::int8_t* at_rest;  // windings
  std::size_t sphere, part;    // its own
};

// The surfaces that a half-line leaves without having entered them: those that its start is inside of.
class Enclosing : public Crossings {
 public:
  Enclosing(const InsideTest& test, const Probe& probe, int handedness)
      : test_(test), probe_(probe), handedness_(handedness) {}

  void add(std::uint32_t triangle, int side, double height) override {
    Entry entry{std::abs(height), triangle, side * facing(*test_.skin.surface, triangle) * handedness_ > 0};
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
    const std::size_t own = probe_.part, sphere = probe_.sphere, other = skin.triangle_spheres[triangle];
    const auto hangs_on = [&](std::size_t a, std::size_t b) {
      return test_.asset.part(a).parent == static_cast<std::int32_t>(b);
    };
    if (of == own || hangs_on(of, own) || hangs_on(own, of) || other == sphere) {
      return false;
    }
    const std::size_t bit = ignored_bit(std::min(sphere, other), std::max(sphere, other));
    return (test_.skin.ignored[bit / 64] >> bit % 64 & 1) == 0;
  }

  const InsideTest& test_;
  const Probe& probe_;
  int handedness_;
  Half halves_[2];
};

class Tester {
 public:
  explicit Tester(const InsideTest& test) : test_(test) {}

  void run() {
    std::fill(test_.part.begin(), test_.part.end(), kOutside);
    int turns = 0;
    for_spheres([&](std::size_t s, const Probe& probe) {
      count_windings(probe, test_.windings + 3 * s);
      turns += middle_of(test_.windings + 3 * s);
    });
    // A pose that mirrors the skin turns it inside out: then most probes of a body lie inside it the other way round.
    handedness_ = test_.are_one && turns < 0 ? -1 : 1;
    bool holds[kMaxPartCount + 1] = {};
    for_spheres([&](std::size_t s, const Probe& probe) {
      if (is_deeper(probe, test_.windings + 3 * s)) {
        test_.part[s] = holder_of(probe);
        holds[probe.part] = holds[probe.part] || test_.part[s] != kOutside;
      }
    });
    for (std::size_t part = 0; part < test_.asset.part_count(); ++part) {
      if (holds[part]) {
        test_core(part);
      }
    }
  }

 private:
  template <typename Visit>
  void for_spheres(const Visit& visit) {
    for (std::size_t s = 0; s < test_.centers.size; ++s) {
      const Sphere& center = test_.centers[s];
      if ((test_.asked[s / 64] >> s % 64 & 1) != 0 && is_finite(center) && is_core(test_.surface, s)) {
        visit(
            s,
            Probe{
                {center.x, center.y, center.z}, test_.surface.windings.data + 3 * s, s, test_.asset.spheres()[s].part});
      }
    }
  }

  template <typename T>
  static bool is_finite(const T& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z);
  }

  void test_core(std::size_t part) {
    const Surface& surface = test_.surface;
    for (std::size_t k = 0; k < kCorePoints; ++k) {
      const std::size_t place = kCorePoints * part + k;
      const std::uint32_t triangle = surface.core_triangles[place];
      if (triangle == kNoPlace) {
        continue;
      }
      const std::size_t sphere = surface.triangle_spheres[triangle];
      const Sphere& center = test_.centers[sphere];
      float corners[3][3];
      find_corners(test_.target, test_.own, triangle, corners);
      const Probe probe{core_point(corners, {center.x, center.y, center.z}, k), surface.core_windings.data + 3 * place,
                        sphere, part};
      std::int16_t windings[3];
      if (is_finite(probe.at)) {
        count_windings(probe, windings);
        if (is_deeper(probe, windings)) {
          test_.part[test_.centers.size + place] = holder_of(probe);
        }
      }
    }
  }

  // The part whose skin is nearest, where most half-lines along the axes leave another part's skin.
  std::uint16_t holder_of(const Probe& probe) {
    std::uint16_t nearest = kOutside;
    double least = HUGE_VAL;
    int count = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Enclosing enclosing(test_, probe, handedness_);
      follow_from(probe, axis, true, enclosing);
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

  void follow_from(const Probe& probe, std::size_t axis, bool goes_down, Crossings& found) {
    follow(test_.target, test_.skin, {{probe.at.x, probe.at.y, probe.at.z}, axis, true, goes_down}, found);
    test_.skin.has_sphere_boxes = true;
  }

  // Along one axis, where a closed skin gives the same along each; else along all three, and the middle counts.
  void count_windings(const Probe& probe, std::int16_t* out) {
    const bool one_axis = test_.are_one && is_closed(probe.at_rest);
    for (std::size_t axis = one_axis ? kShortAxis : 0; axis < 3; ++axis) {
      Winding winding(*test_.skin.surface);
      follow_from(probe, axis, false, winding);
      out[axis] = static_cast<std::int16_t>(std::max(-9999, std::min(winding.total, 9999)));
    }
    if (one_axis) {
      out[0] = out[1] = out[kShortAxis];
    }
  }

  bool is_deeper(const Probe& probe, const std::int16_t* now) const {
    if (!test_.are_one) {
      return middle_of(now) != 0;
    }
    int more[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      more[axis] = handedness_ * now[axis] - probe.at_rest[axis];
    }
    return middle_of(more) > 0;
  }

  const InsideTest& test_;
  int handedness_ = 1;
};

}  // namespace

bool is_core(const Surface& surface, std::size_t sphere) { return middle_of(surface.windings.data + 3 * sphere) > 0; }

void find_inside(const InsideTest& test) { Tester(test).run(); }

}  // namespace spherechain
