// SPDX-License-Identifier: MIT
#include "skin/exact_orientation.h"

#include <cstddef>

#include "simd/arithmetic.h"

namespace spherechain {
namespace {

// Sums of products of up to three floats, and their signs, without an error. In double precision, rounded to nearest,
// with additions and multiplications alone: the same on machines that fuse and on those that do not.
//
// Why nothing over- or underflows: a float is a multiple of 2^-149 below 2^128, so a product of three is a multiple of
// 2^-447 below 2^384, and so are a thousand of them. Doubles hold multiples of 2^-1074 below 2^1024.
//
// Holds a number as doubles that overlap in no bit, the least first, zeros left out.
template <std::size_t kCapacity>
class ExactSum {
 public:
  // At most kCapacity times, `term` a multiple of 2^-1074 that keeps the sum finite.
  void add(double term) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double rest = two_sum(term, parts_[i]);
      parts_[kept] = rest;
      kept += is_zero(rest) ? 0 : 1;
    }
    parts_[kept] = term;
    size_ = kept + (is_zero(term) ? 0 : 1);
  }

  // `product` is one of two floats, which a double holds. One more float makes 72 bits: as two halves of at most 26
  // bits each, with it 50.
  void add_product(double product, double factor) {
    constexpr double kSplit = 0x1p27 + 1;
    const double scaled = kSplit * product;
    const double high = scaled - (scaled - product);
    add((product - high) * factor);
    add(high * factor);
  }

  int sign() const { return size_ == 0 ? 0 : parts_[size_ - 1] > 0 ? 1 : -1; }

 private:
  static bool is_zero(double x) { return !(x < 0) && !(x > 0); }

  // What x + y is more than its rounding, which becomes x (Knuth).
  static double two_sum(double& x, double y) {
    const double sum = x + y;
    const double y_rounded = sum - x;
    const double rest = (x - (sum - y_rounded)) + (y - y_rounded);
    x = sum;
    return rest;
  }

  double parts_[kCapacity + 1];
  std::size_t size_ = 0;
};

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
