// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts of two bodies, against CGAL's intersections of the same positions.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "baker/truth/intersections.h"
#include "moving_human.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

using Matrix = std::array<float, 12>;  // by rows

// Turned about a random axis and moved off by up to `reach` along each axis.
Matrix random_place(std::mt19937& random, double reach) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> off(-reach, reach);
  double q[4], size = 0;
  for (double& part : q) {
    part = normal(random);
    size += part * part;
  }
  for (double& part : q) part /= std::sqrt(size);
  const auto [w, x, y, z] = q;
  const double m[12] = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),     off(random),
                        2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),     off(random),
                        2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y), off(random)};
  Matrix out;
  std::copy(m, m + 12, out.begin());
  return out;
}

std::vector<float> placed(const Matrix& place, const std::vector<float>& palette) {
  std::vector<float> out(palette.size());
  for (std::size_t i = 0; i < palette.size(); ++i) {
    const std::size_t bone = i / 12 * 12, row = i % 12 / 4, column = i % 4;
    float sum = column == 3 ? place[4 * row + 3] : 0;
    for (std::size_t k = 0; k < 3; ++k) sum += place[4 * row + k] * palette[bone + 4 * k + column];
    out[i] = sum;
  }
  return out;
}

// Two of the moving human.
struct Two {
  MovingHuman::Frame a, b;
  std::vector<Pair> expected;

  explicit Two(std::mt19937& random) {
    const MovingHuman& human = moving_human();
    const auto any = [&] { return human.frames[random() % human.frames.size()]; };
    const double reach = 0.2 * double{sc_asset_get_info(human.asset.handle()).height};
    a = skinned(any());
    b = any();
    b.palette = placed(random_place(random, reach), b.palette);
    b = skinned(b);
    expected = baker::find_intersections(truth_surface(), a.vertices, truth_surface(), b.vertices);
  }
};

BodyContactJob meeting_of(const Pose& a, const Pose& b, Target target = SC_TARGET_BEST) {
  BodyContactJob job;
  job.a.asset = job.b.asset = moving_human().asset.handle();
  job.a.skin_table = job.b.skin_table = human_skin_table();
  job.a.pose = a;
  job.b.pose = b;
  job.target = target;
  return job;
}

SkinContacts met(const BodyContactJob& job) {
  SkinContacts found = find_contacts(job);
  REQUIRE(found.status == SC_OK);
  return found;
}

}  // namespace

TEST_CASE("two bodies' contacts are CGAL's wherever they stand: from bones, from vertices and mixed, on every target" *
          doctest::test_suite("long runs")) {
  std::mt19937 random(24);
  std::size_t total = 0, apart = 0;
  for (int i = 0; i < 16; ++i) {
    CAPTURE(i);
    const Two two(random);
    total += two.expected.size();
    apart += two.expected.empty() ? 1 : 0;
    const Pose of_a[] = {bones_of(two.a.palette), vertices_of(two.a.vertices), both_of(two.a)};
    const Pose of_b[] = {bones_of(two.b.palette), vertices_of(two.b.vertices), both_of(two.b)};
    for (const Target target : supported_targets()) {
      CAPTURE(sc_target_name(target));
      for (const auto& [a, b] : {std::pair{0, 0}, {1, 1}, {0, 1}, {1, 0}, {2, 0}, {1, 2}}) {
        CHECK(triangle_pairs(met(meeting_of(of_a[a], of_b[b], target))) == two.expected);
      }
    }
    if (two.expected.empty()) continue;
    // A table that is not prepared is made for the call: the contacts are the same.
    BodyContactJob unprepared = meeting_of(of_a[0], of_b[1]);
    (i % 2 == 0 ? unprepared.a : unprepared.b).skin_table = nullptr;
    CHECK(triangle_pairs(met(unprepared)) == two.expected);
  }
  CHECK(total > 1000);
  CHECK(apart > 0);
}

TEST_CASE("with the bodies swapped all is the same, the other way round; crossings are where they were" *
          doctest::test_suite("long runs")) {
  std::mt19937 random(25);
  std::size_t total = 0;
  for (int i = 0; i < 10; ++i) {
    const Two two(random);
    const SkinContacts found = met(meeting_of(bones_of(two.a.palette), bones_of(two.b.palette)));
    const SkinContacts other = met(meeting_of(bones_of(two.b.palette), bones_of(two.a.palette)));
    std::vector<Pair> back = triangle_pairs(other), spheres = other.spheres;
    for (std::vector<Pair>* pairs : {&back, &spheres}) {
      for (Pair& pair : *pairs) std::swap(pair.a, pair.b);
      std::sort(pairs->begin(), pairs->end());
    }
    CHECK(back == triangle_pairs(found));
    CHECK(spheres == found.spheres);
    CHECK(other.parts.size() == found.parts.size());
    total += found.triangles.size();
    for (const TriangleContact& contact : found.triangles) {
      CHECK(contact.sphere_a == truth_surface().sphere[truth_surface().of_source[contact.triangle_a]]);
      CHECK(contact.part_b == moving_human().bake.body_parts.of_triangle[contact.triangle_b]);
    }
  }
  CHECK(total > 100);
}

TEST_CASE("parts and spheres sum up two bodies' triangles; parts that a body ignores meet nothing") {
  std::mt19937 random(26);
  std::size_t left_out = 0;
  for (int i = 0; i < 20; ++i) {
    const Two two(random);
    BodyContactJob job = meeting_of(bones_of(two.a.palette), bones_of(two.b.palette));
    const SkinContacts all = met(job);
    std::vector<Pair> parts, spheres;
    for (const TriangleContact& c : all.triangles) {
      parts.push_back({c.part_a, c.part_b});
      spheres.push_back({c.sphere_a, c.sphere_b});
    }
    for (std::vector<Pair>* pairs : {&parts, &spheres}) {
      std::sort(pairs->begin(), pairs->end());
      pairs->erase(std::unique(pairs->begin(), pairs->end()), pairs->end());
    }
    CHECK(all.spheres == spheres);
    REQUIRE(all.parts.size() == parts.size());
    std::size_t triangles = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      CHECK(Pair{all.parts[k].part_a, all.parts[k].part_b} == parts[k]);
      triangles += all.parts[k].triangle_pairs;
    }
    CHECK(triangles == all.triangles.size());
    job.spheres_only = 1;
    CHECK(met(job).spheres == all.spheres);
    job.spheres_only = 0;
    if (parts.empty()) continue;

    std::vector<std::uint64_t> none(sc_part_words(job.b.asset));
    none[parts[0].b / 64] |= std::uint64_t{1} << parts[0].b % 64;
    job.b.ignored_parts = none.data();
    std::vector<Pair> expected;
    for (const TriangleContact& c : all.triangles) {
      if (c.part_b != parts[0].b) expected.push_back({c.triangle_a, c.triangle_b});
    }
    CHECK(triangle_pairs(met(job)) == expected);
    left_out += all.triangles.size() - expected.size();
  }
  CHECK(left_out > 100);
}

TEST_CASE("moved along the way out, a part of body b no longer meets the part of body a; nine tenths of it do not do" *
          doctest::test_suite("long runs")) {
  std::mt19937 random(27);
  std::size_t measured = 0;
  for (int i = 0; i < 24; ++i) {
    CAPTURE(i);
    const Two two(random);
    const BodyContactJob job = meeting_of(bones_of(two.a.palette), bones_of(two.b.palette));
    const SkinContacts found = met(job);
    BodyPenetrationJob of;
    of.a = job.a;
    of.b = job.b;
    of.contacts = found.triangles.data();
    of.contact_count = found.triangles.size();
    const std::vector<Penetration> all = measure(of, SC_TARGET_BEST);
    REQUIRE(all.size() == found.parts.size());
    for (std::size_t k = 0; k < all.size(); ++k) {
      CAPTURE(k);
      const Penetration& one = all[k];
      CHECK(Pair{one.part, one.other} == Pair{found.parts[k].part_a, found.parts[k].part_b});
      CHECK(one.kind >= SC_CLASS_SHELL);
      const auto meets_after = [&](float share) {
        const float way = -share * one.distance;  // of body b, in place of a
        const Matrix move{1, 0, 0, way * one.direction.x, 0, 1, 0, way * one.direction.y,
                          0, 0, 1, way * one.direction.z};
        const std::vector<float> palette = placed(move, two.b.palette);
        const SkinContacts after = met(meeting_of(job.a.pose, bones_of(palette)));
        return std::any_of(after.parts.begin(), after.parts.end(), [&](const PartContact& part) {
          return part.part_a == one.part && part.part_b == one.other;
        });
      };
      CHECK(!meets_after(1.001F));
      CHECK(meets_after(0.9F));
      ++measured;
    }
  }
  CHECK(measured > 15);
}

TEST_CASE("as two bodies go apart their contacts are CGAL's to the last few" * doctest::test_suite("long runs")) {
  std::mt19937 random(28);
  std::size_t few = 0;
  for (int i = 0; i < 30; ++i) {
    const Two two(random);
    std::size_t left = two.expected.size();
    for (int step = 1; step <= 12 && left > 0; ++step) {
      CAPTURE(i);
      CAPTURE(step);
      const float way = 0.06F * static_cast<float>(step);
      Matrix move{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
      move[static_cast<std::size_t>(3 + 4 * (i % 3))] = i % 2 == 0 ? way : -way;
      MovingHuman::Frame b = two.b;
      b.palette = placed(move, b.palette);
      b = skinned(b);
      const auto expected = baker::find_intersections(truth_surface(), two.a.vertices, truth_surface(), b.vertices);
      CHECK(triangle_pairs(met(meeting_of(bones_of(two.a.palette), bones_of(b.palette)))) == expected);
      left = expected.size();
      few += !expected.empty() && expected.size() < 60 ? 1 : 0;
    }
  }
  CHECK(few > 3);
}
