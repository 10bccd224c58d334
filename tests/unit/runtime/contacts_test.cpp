// SPDX-License-Identifier: MIT
#include "spherechain/contacts.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

using doctest::Approx;

struct Contacts {
  explicit Contacts(const Asset& asset, const std::vector<Sphere>& spheres, const std::vector<Pair>& pairs)
      : contacts(pairs.size()) {
    job.asset = &asset;
    job.spheres = {spheres.data(), spheres.size()};
    job.pairs = {pairs.data(), pairs.size()};
    job.contacts = {contacts.data(), contacts.size()};
  }
  std::vector<Contact> contacts;
  ContactJob job;
};

Contact contact_of(const Sphere& a, const Sphere& b) {
  static const OpenedAsset opened(random_asset(2, 1).parts);
  const std::vector<Sphere> spheres{a, b};
  const std::vector<Pair> pairs{{0, 1}};
  Contacts run(opened.asset, spheres, pairs);
  REQUIRE(run.job.run() == Status::kOk);
  return run.contacts[0];
}

// The volume in both balls, by slices across the line of centres: the smaller of the two discs of each.
double volume_by_slices(double ra, double rb, double d) {
  constexpr int kSlices = 20000;
  const double low = std::max(-ra, d - rb), high = std::min(ra, d + rb);
  if (high <= low) return 0;
  double volume = 0;
  for (int i = 0; i < kSlices; ++i) {
    const double t = low + (high - low) * (i + 0.5) / kSlices;
    const double disc = std::min(ra * ra - t * t, rb * rb - (t - d) * (t - d));
    volume += std::max(disc, 0.0) * 3.141592653589793 * (high - low) / kSlices;
  }
  return volume;
}

}  // namespace

TEST_CASE("two unit spheres one apart: a contact by hand") {
  const Contact contact = contact_of({0, 0, 0, 1}, {0, 0, 1, 1});
  CHECK(contact.pair == Pair{0, 1});
  CHECK(contact.depth == 1.0F);
  CHECK(contact.normal.x == 0.0F);
  CHECK(contact.normal.y == 0.0F);
  CHECK(contact.normal.z == 1.0F);
  CHECK(contact.point.z == 0.5F);
  CHECK(contact.severity == Approx(5 * 3.14159265 / 12));
}

TEST_CASE("the point is in the middle of the lens, and in the inner ball's centre where it is inside the other") {
  const Contact lens = contact_of({1, 0, 0, 2}, {4, 0, 0, 1.5F});  // in both: x from 2.5 to 3
  CHECK(lens.point.x == 2.75F);
  CHECK(lens.depth == 0.5F);
  const Contact inner = contact_of({0, 0, 0, 5}, {1, 2, 2, 1});
  CHECK(inner.point.x == Approx(1));
  CHECK(inner.point.y == Approx(2));
  CHECK(inner.point.z == Approx(2));
  CHECK(inner.severity == Approx(4.18879));
  const Contact outer = contact_of({1, 2, 2, 1}, {0, 0, 0, 5});
  CHECK(outer.point.x == Approx(1));
  CHECK(outer.normal.x == Approx(-1.0 / 3));
}

TEST_CASE("spheres in one place have a stated normal and the smaller ball's volume") {
  for (const float apart : {0.0F, 1e-30F, 1e-20F}) {
    const Contact contact = contact_of({3, apart, 0, 2}, {3, 0, 0, 1});
    CHECK(contact.normal.x == 1.0F);
    CHECK(contact.normal.y == 0.0F);
    CHECK(contact.depth == 3.0F);
    CHECK(contact.severity == Approx(4.18879));
  }
}

TEST_CASE("the severity is the volume in both balls, to 2e-5 of the smaller ball") {
  std::mt19937 random(1);
  for (int i = 0; i < 400; ++i) {
    const float ra = uniform(random, 0.05F, 2), rb = i % 4 == 0 ? ra : uniform(random, 0.05F, 2);
    const float d = uniform(random, 0, 1.05F) * (ra + rb);
    const Contact contact = contact_of({0, 0, 0, ra}, {d, 0, 0, rb});
    const double smaller = std::min(ra, rb);
    CHECK(std::abs(static_cast<double>(contact.severity) - volume_by_slices(ra, rb, d)) <
          2e-5 * 4.18879 * smaller * smaller * smaller);
    CHECK(contact.severity >= 0.0F);
    CHECK((contact.severity > 0.0F) == (contact.depth > 0.0F));
  }
}

TEST_CASE("turning and moving both spheres turns and moves the contact and changes no other figure") {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const auto unit = [&] { return uniform(random, -1, 1); };
    const std::array<Sphere, 2> spheres{{{unit(), unit(), unit(), 1.0F}, {unit(), unit(), unit(), 0.8F}}};
    // A rotation from a random quaternion.
    double w = unit(), x = unit(), y = unit(), z = unit();
    const double length = std::sqrt(w * w + x * x + y * y + z * z);
    w /= length, x /= length, y /= length, z /= length;
    const std::array<float, 3> shift{unit(), unit(), unit()};
    const auto turned = [&](const Vec3& v, bool moved) {
      const double m[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                              {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                              {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
      std::array<float, 3> out{};
      for (std::size_t k = 0; k < 3; ++k) {
        out[k] = static_cast<float>(m[k][0] * v.x + m[k][1] * v.y + m[k][2] * v.z) + (moved ? shift[k] : 0.0F);
      }
      return Vec3{out[0], out[1], out[2]};
    };
    const auto moved = [&](const Sphere& s) {
      const Vec3 c = turned({s.x, s.y, s.z}, true);
      return Sphere{c.x, c.y, c.z, s.radius};
    };
    const Contact before = contact_of(spheres[0], spheres[1]), after = contact_of(moved(spheres[0]), moved(spheres[1]));
    const auto near = [](const Vec3& p, const Vec3& q) {  // float rounding at coordinates of about 1
      return std::abs(p.x - q.x) < 2e-6F && std::abs(p.y - q.y) < 2e-6F && std::abs(p.z - q.z) < 2e-6F;
    };
    CHECK(after.depth == Approx(before.depth).epsilon(1e-5));
    CHECK(after.severity == Approx(before.severity).epsilon(1e-4));
    CHECK(near(after.point, turned(before.point, true)));
    if (before.depth < 1.7F) CHECK(near(after.normal, turned(before.normal, false)));
    // Seen from the other sphere, the same with the normal turned round.
    const Contact swapped = contact_of(spheres[1], spheres[0]);
    CHECK(swapped.depth == before.depth);
    CHECK(swapped.severity == before.severity);
    CHECK(swapped.normal.x == -before.normal.x);
    CHECK(near(swapped.point, before.point));
  }
}

TEST_CASE("contacts come in the pairs' order with their triangles, and the deepest is named, the first of several") {
  const TinyAsset tiny = random_asset(4, 1);
  const OpenedAsset opened(tiny.parts);
  const std::vector<Sphere> spheres{{0, 0, 0, 1}, {1.5F, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
  const std::vector<Pair> pairs{{0, 1}, {0, 2}, {0, 3}};
  Contacts run(opened.asset, spheres, pairs);
  REQUIRE(run.job.run() == Status::kOk);
  CHECK(run.job.contact_count == 3);
  CHECK(run.job.deepest == 1);
  for (std::size_t i = 0; i < 3; ++i) {
    const RestSphere &a = tiny.parts.spheres[pairs[i].a], &b = tiny.parts.spheres[pairs[i].b];
    CHECK(run.contacts[i].pair == pairs[i]);
    CHECK(run.contacts[i].triangles_a.first == a.first_triangle);
    CHECK(run.contacts[i].triangles_a.count == a.triangle_count);
    CHECK(run.contacts[i].triangles_b.first == b.first_triangle);
    CHECK(run.contacts[i].triangles_b.count == b.triangle_count);
  }
  run.job.contacts = {};
  run.job.deepest = 99;
  CHECK(run.job.run() == Status::kOk);
  CHECK(run.job.deepest == 1);
  const std::vector<Pair> apart{{1, 3}, {1, 2}};
  const std::vector<Sphere> small{{0, 0, 0, 1}, {3, 0, 0, 1}, {-3, 0, 0, 1}, {0, 4, 0, 1}};
  Contacts none(opened.asset, small, apart);
  REQUIRE(none.job.run() == Status::kOk);
  CHECK(none.job.deepest == 2);
  CHECK(none.contacts[0].severity == 0.0F);
}

TEST_CASE("a filter's padding counts in depth and severity") {
  const OpenedAsset opened(random_asset(2, 1).parts);
  std::vector<std::uint64_t> ignored(1);
  std::vector<float> padding{0.25F, 0.5F};
  const Filter filter{{ignored.data(), 1}, {}, {padding.data(), 2}};
  const std::vector<Sphere> spheres{{0, 0, 0, 0.75F}, {1, 0, 0, 0.5F}};
  const std::vector<Pair> pairs{{0, 1}};
  Contacts run(opened.asset, spheres, pairs);
  run.job.filter = &filter;
  REQUIRE(run.job.run() == Status::kOk);
  CHECK(run.contacts[0].depth == 1.0F);
  CHECK(run.contacts[0].severity == Approx(5 * 3.14159265 / 12));
}

TEST_CASE("too small a contact buffer says how many there are and still finds the deepest") {
  const OpenedAsset opened(random_asset(4, 1).parts);
  const std::vector<Sphere> spheres{{0, 0, 0, 1}, {1.5F, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 0.5F, 1}};
  const std::vector<Pair> pairs{{0, 1}, {0, 2}, {0, 3}};
  Contacts run(opened.asset, spheres, pairs);
  std::memset(static_cast<void*>(run.contacts.data()), 7, 3 * sizeof(Contact));
  run.job.contacts.size = 2;
  CHECK(run.job.run() == Status::kOverflow);
  CHECK(run.job.contact_count == 3);
  CHECK(run.job.deepest == 2);
  CHECK(run.contacts[1].pair == pairs[1]);
  CHECK(run.contacts[2].pair.a == 0x07070707U);
}

TEST_CASE("contacts refuse what they cannot use and write nothing; spheres that are not finite do no harm") {
  const OpenedAsset opened(random_asset(4, 1).parts);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  std::vector<Sphere> spheres{{nan, 0, 0, 1}, {1.5F, infinity, 0, 1}, {0, 1, 0, -infinity}, {0, 0, 0.5F, 1}};
  std::vector<Pair> pairs{{0, 1}, {0, 2}, {2, 3}};
  Contacts run(opened.asset, spheres, pairs);
  CHECK(run.job.run() == Status::kOk);
  CHECK(run.job.deepest == 3);
  const Asset closed;
  const auto refused = [&](Status wanted, auto change) {
    ContactJob job = run.job;
    job.contact_count = job.deepest = 99;
    change(job);
    const std::vector<Contact> before = run.contacts;
    CHECK(job.run() == wanted);
    CHECK(job.contact_count == 99);
    CHECK(job.deepest == 99);
    CHECK(same_bits(before, run.contacts));
  };
  refused(Status::kNullArgument, [](ContactJob& j) { j.asset = nullptr; });
  refused(Status::kNullArgument, [](ContactJob& j) { j.spheres.data = nullptr; });
  refused(Status::kNullArgument, [](ContactJob& j) { j.pairs.data = nullptr; });
  refused(Status::kNullArgument, [](ContactJob& j) { j.contacts.data = nullptr; });
  refused(Status::kNotOpen, [&](ContactJob& j) { j.asset = &closed; });
  refused(Status::kTooFewSpheres, [](ContactJob& j) { j.spheres.size = 3; });
  const Filter small{};
  refused(Status::kBadFilter, [&](ContactJob& j) { j.filter = &small; });
  refused(Status::kSharedMemory, [&](ContactJob& j) { j.contacts = {reinterpret_cast<Contact*>(spheres.data()), 1}; });
  refused(Status::kSharedMemory, [&](ContactJob& j) { j.contacts = {reinterpret_cast<Contact*>(pairs.data()), 1}; });
  for (const Pair bad : {Pair{1, 4}, Pair{2, 2}, Pair{3, 1}, Pair{0, 0xFFFFFFFFU}}) {
    const std::vector<Pair> wrong{{0, 1}, bad};
    refused(Status::kBadArgument, [&](ContactJob& j) { j.pairs = {wrong.data(), 2}; });
  }
}

}  // namespace spherechain::test
