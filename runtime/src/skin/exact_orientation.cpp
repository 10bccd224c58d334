// SPDX-License-Identifier: MIT
#include "skin/exact_orientation.h"

#include "skin/exact_sum.h"

namespace spherechain {
namespace {

using PlaneSum = ExactSum<48>;  // four determinants of six products, two parts each

// The determinant of the rows p, q, r, or with `sign` -1 its negative.
void add_determinant(const Vec3& p, const Vec3& q, const Vec3& r, double sign, PlaneSum& sum) {
  const double x = sign * double{r.x}, y = sign * double{r.y}, z = sign * double{r.z};
  sum.add_product(double{p.y} * double{q.z}, x);
  sum.add_product(double{p.z} * double{q.y}, -x);
  sum.add_product(double{p.z} * double{q.x}, y);
  sum.add_product(double{p.x} * double{q.z}, -y);
  sum.add_product(double{p.x} * double{q.y}, z);
  sum.add_product(double{p.y} * double{q.x}, -z);
}

}  // namespace

// det(b - a, c - a, d - a), multiplied out: differences of floats need not be doubles, products of them are.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
  PlaneSum sum;
  add_determinant(b, c, d, 1, sum);
  add_determinant(a, c, d, -1, sum);
  add_determinant(a, b, d, 1, sum);
  add_determinant(a, b, c, -1, sum);
  return sum.sign();
}

int side_of_line(const Vec2& a, const Vec2& b, const Vec2& c) noexcept {
  ExactSum<6> sum;
  sum.add(double{a.x} * double{b.y});
  sum.add(-double{a.y} * double{b.x});
  sum.add(double{b.x} * double{c.y});
  sum.add(-double{b.y} * double{c.x});
  sum.add(double{c.x} * double{a.y});
  sum.add(-double{c.y} * double{a.x});
  return sum.sign();
}

}  // namespace spherechain
