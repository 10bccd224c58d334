// SPDX-License-Identifier: MIT
#include "runtime/src/depth/shadow.h"

#include <algorithm>

namespace spherechain {
namespace {

// Cuts off where `keep`, which is linear, is negative. The cut's edge gets the number `edge`.
template <typename Keep>
void clip(Shadow& shadow, int edge, const Keep& keep) {
  double at[Shadow::kCornersMax];
  int kept = 0;
  for (int i = 0; i < shadow.count; ++i) {
    at[i] = keep(shadow.corners[i]);
    kept += at[i] >= 0 ? 1 : 0;
  }
  if (kept == 0 || kept == shadow.count) {
    shadow.count = kept;
    return;
  }
  Shadow::Corner out[Shadow::kCornersMax];
  int count = 0;
  for (int i = 0; i < shadow.count && count + 2 <= Shadow::kCornersMax; ++i) {
    const int next = i + 1 < shadow.count ? i + 1 : 0;
    const Shadow::Corner &from = shadow.corners[i], &to = shadow.corners[next];
    const double at_from = at[i], at_to = at[next];
    if (at_from >= 0) {
      out[count++] = from;
    }
    if ((at_from >= 0) != (at_to >= 0)) {
      const double share = at_from / (at_from - at_to);
      out[count++] = {from.x + share * (to.x - from.x), from.y + share * (to.y - from.y),
                      from.rise + share * (to.rise - from.rise), at_from >= 0 ? edge : from.edge};
    }
  }
  std::copy(out, out + count, shadow.corners);
  shadow.count = count;
}

// Is b, seen along d, beyond one of a's edges?
bool is_beside(const Corners& a, const Corners& b, double sign_of_a) {
  for (int i = 0; i < 3; ++i) {
    const Double3 &from = a.p[i], &to = a.p[(i + 1) % 3];
    const double x = sign_of_a * (to.x - from.x), y = sign_of_a * (to.y - from.y);
    const auto beyond = [&](const Double3& p) { return x * (p.y - from.y) - y * (p.x - from.x) < 0; };
    if (beyond(b.p[0]) && beyond(b.p[1]) && beyond(b.p[2])) {
      return true;
    }
  }
  return false;
}

}  // namespace

View::View(const Double3& direction, const Double3& center) : d(direction), origin(center) {
  const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
  const Double3 aside = x <= y && x <= z ? Double3{1, 0, 0} : y <= z ? Double3{0, 1, 0} : Double3{0, 0, 1};
  v = cross(d, aside);
  normalize(v);
  u = cross(v, d);
}

Shadow::Shadow(const SeenTriangle& seen_a, const SeenTriangle& seen_b, double above, double below) {
  const Corners &a = seen_a.corners, &b = seen_b.corners;
  const double turn_a = seen_a.turn, turn_b = seen_b.turn;
  // Heights are those of the plane that is seen more from the front: the other may be seen edge-on.
  stands_on_a = turn_a * turn_a * seen_b.size >= turn_b * turn_b * seen_a.size;
  const Corners &base = stands_on_a ? a : b, &other = stands_on_a ? b : a;
  const double turn = stands_on_a ? turn_a : turn_b, sign = turn > 0 ? 1 : -1;
  if (!(turn > 0) && !(turn < 0)) {
    return;
  }
  const int base_edge = stands_on_a ? 3 : 0, other_edge = 3 - base_edge;
  const Slope& slope = stands_on_a ? seen_a.slope : seen_b.slope;
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    const Double3& p = other.p[i];
    const double over = slope.at(p.x, p.y) - p.z, rise = stands_on_a ? over : -over;
    corners[i] = {p.x, p.y, rise, other_edge + i};
    least = std::min(least, rise);
    most = std::max(most, rise);
  }
  if (most <= above || least > below ||
      is_beside(a, b,
                turn_a > 0   ? 1
                : turn_a < 0 ? -1
                             : 0) ||
      is_beside(b, a,
                turn_b > 0   ? 1
                : turn_b < 0 ? -1
                             : 0)) {
    return;
  }
  count = 3;
  for (int i = 0; i < 3 && count > 0; ++i) {
    const Double3 &from = base.p[i], &to = base.p[(i + 1) % 3];
    const double x = sign * (to.x - from.x), y = sign * (to.y - from.y);
    clip(*this, base_edge + i, [&](const Corner& c) { return x * (c.y - from.y) - y * (c.x - from.x); });
  }
}

void Shadow::keep_above(double rise) {
  clip(*this, 6, [&](const Corner& c) { return c.rise - rise; });
}

void Shadow::keep_below(double rise) {
  clip(*this, 6, [&](const Corner& c) { return rise - c.rise; });
}

double Shadow::area() const {
  double twice = 0;
  for (int i = 1; i + 1 < count; ++i) {
    const Corner &o = corners[0], &p = corners[i], &q = corners[i + 1];
    twice += (p.x - o.x) * (q.y - o.y) - (q.x - o.x) * (p.y - o.y);
  }
  return 0.5 * std::abs(twice);
}

double Shadow::volume() const {
  double six_times = 0;
  for (int i = 1; i + 1 < count; ++i) {
    const Corner &o = corners[0], &p = corners[i], &q = corners[i + 1];
    six_times += ((p.x - o.x) * (q.y - o.y) - (q.x - o.x) * (p.y - o.y)) * (o.rise + p.rise + q.rise);
  }
  return std::abs(six_times) / 6;
}

}  // namespace spherechain
