// SPDX-License-Identifier: MIT
#include "runtime/src/triangles/exact_orientation.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "runtime/src/base/arithmetic.h"

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

  // Replaces x by the rounded sum x + y and returns the rounding error (Knuth).
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

int sign_by_sums(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  PlaneSum sum;
  add_determinant(b, c, d, 1, sum);
  add_determinant(a, c, d, -1, sum);
  add_determinant(a, b, d, 1, sum);
  add_determinant(a, b, c, -1, sum);
  return sum.sign();
}

int sign_by_sums(const Vec2& a, const Vec2& b, const Vec2& c) {
  ExactSum<6> sum;
  sum.add(double{a.x} * double{b.y});
  sum.add(-double{a.y} * double{b.x});
  sum.add(double{b.x} * double{c.y});
  sum.add(-double{b.y} * double{c.x});
  sum.add(double{c.x} * double{a.y});
  sum.add(-double{c.y} * double{a.x});
  return sum.sign();
}

#ifdef __SIZEOF_INT128__
#define SPHERECHAIN_HAS_INTEGERS
__extension__ using Wide = __int128;

// How far points are from the first one along an axis, in units of the least bit that a coordinate may have. A sign
// does not depend on the unit of an axis, and points of one body have few bits along each: then integers hold a
// determinant, and are dozens of times faster than sums of doubles.
template <std::size_t kPoints>
class Differences {
 public:
  explicit Differences(const float (&along)[kPoints + 1]) {
    std::uint32_t bits[kPoints + 1], least = kExponents;
    for (std::size_t i = 0; i <= kPoints; ++i) {
      std::memcpy(&bits[i], &along[i], sizeof bits[i]);
      const std::uint32_t exponent = exponent_of(bits[i]);
      // A processor may take subnormal figures as zero, and what is not finite is no integer.
      fits_ = fits_ && exponent < kExponents && (exponent > 0 || (bits[i] & kMantissa) == 0);
      least = exponent > 0 && exponent < least ? exponent : least;
    }
    std::int64_t at[kPoints + 1] = {};
    for (std::size_t i = 0; i <= kPoints; ++i) {
      if (exponent_of(bits[i]) == 0) continue;
      const std::uint32_t shift = exponent_of(bits[i]) - least;
      if (!fits_ || shift > kShiftMax) {
        fits_ = false;
        return;
      }
      const std::int64_t size = std::int64_t{(bits[i] & kMantissa) | (kMantissa + 1)} << shift;
      at[i] = (bits[i] >> 31) != 0 ? -size : size;
    }
    std::uint64_t used = 1;
    for (std::size_t i = 0; i < kPoints; ++i) {
      values_[i] = at[i + 1] - at[0];
      used |= static_cast<std::uint64_t>(values_[i] < 0 ? -values_[i] : values_[i]);
    }
    width_ = 64 - __builtin_clzll(used);
  }
  bool fits() const { return fits_; }
  int width() const { return width_; }  // bits of the largest
  std::int64_t operator[](std::size_t i) const { return values_[i]; }

 private:
  static constexpr std::uint32_t kMantissa = 0x7FFFFF, kExponents = 255, kShiftMax = 38;  // 62 bits with the mantissa's
  static std::uint32_t exponent_of(std::uint32_t bits) { return (bits >> 23) & kExponents; }

  std::int64_t values_[kPoints] = {};
  int width_ = 0;
  bool fits_ = true;
};

int sign_of(Wide value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }
Wide minor_of(std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) { return Wide{a} * d - Wide{b} * c; }
#endif

}  // namespace

// det(b - a, c - a, d - a). As sums of doubles multiplied out: differences of floats need not be doubles, products of
// them are.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
#ifdef SPHERECHAIN_HAS_INTEGERS
  const Differences<3> x({a.x, b.x, c.x, d.x}), y({a.y, b.y, c.y, d.y}), z({a.z, b.z, c.z, d.z});
  constexpr int kBits = 127 - 3;  // of six products
  if (x.fits() && y.fits() && z.fits() && x.width() + y.width() + z.width() <= kBits) {
    return sign_of(minor_of(y[1], z[1], y[2], z[2]) * x[0] - minor_of(y[0], z[0], y[2], z[2]) * x[1] +
                   minor_of(y[0], z[0], y[1], z[1]) * x[2]);
  }
#endif
  return sign_by_sums(a, b, c, d);
}

int side_of_line(const Vec2& a, const Vec2& b, const Vec2& c) noexcept {
#ifdef SPHERECHAIN_HAS_INTEGERS
  const Differences<2> x({a.x, b.x, c.x}), y({a.y, b.y, c.y});
  if (x.fits() && y.fits() && x.width() + y.width() <= 127 - 1) {
    return sign_of(minor_of(x[0], y[0], x[1], y[1]));
  }
#endif
  return sign_by_sums(a, b, c);
}

}  // namespace spherechain
