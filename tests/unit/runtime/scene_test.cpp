// SPDX-License-Identifier: MIT
// Which bodies of a scene meet, against all pairs of all spheres.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "spherechain/spherechain.h"

using namespace spherechain;

namespace {

struct Scene {
  std::vector<std::vector<Sphere>> spheres;
  std::vector<SceneBody> bodies;

  // Some bodies have a box alone; some spheres a negative radius.
  Scene(std::size_t count, std::mt19937& random, float size) {
    std::uniform_real_distribution<float> place(0, size), off(-0.5F, 0.5F), radius(-0.05F, 0.3F);
    spheres.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const float x = place(random), y = off(random), z = place(random);
      spheres[i].resize(random() % 100);
      for (Sphere& s : spheres[i]) s = {x + off(random), y + off(random), z + off(random), radius(random)};
      SceneBody body;
      body.layer = static_cast<std::uint32_t>(random() % 3);
      if (random() % 4 == 0) {
        body.low = {x - 0.4F, y - 0.3F, z - 0.2F};
        body.high = {x + 0.2F, y + 0.3F, z + 0.4F};
      } else {
        body.spheres = spheres[i].data();
        body.sphere_count = spheres[i].size();
      }
      bodies.push_back(body);
    }
  }
};

struct BodyBox {
  Vec3 low, high;
};

BodyBox box_of(const SceneBody& body) {
  if (body.spheres == nullptr) return {body.low, body.high};
  BodyBox box{{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};
  for (std::size_t i = 0; i < body.sphere_count; ++i) {
    const Sphere& s = body.spheres[i];
    if (s.radius < 0) continue;
    box.low = {std::min(box.low.x, s.x - s.radius), std::min(box.low.y, s.y - s.radius),
               std::min(box.low.z, s.z - s.radius)};
    box.high = {std::max(box.high.x, s.x + s.radius), std::max(box.high.y, s.y + s.radius),
                std::max(box.high.z, s.z + s.radius)};
  }
  return box;
}

bool meet(const SceneBody& a, const SceneBody& b) {
  if (a.spheres == nullptr || b.spheres == nullptr) {
    const BodyBox p = box_of(a), q = box_of(b);
    return p.low.x <= q.high.x && q.low.x <= p.high.x && p.low.y <= q.high.y && q.low.y <= p.high.y &&
           p.low.z <= q.high.z && q.low.z <= p.high.z;
  }
  for (std::size_t i = 0; i < a.sphere_count; ++i) {
    for (std::size_t k = 0; k < b.sphere_count; ++k) {
      const Sphere &p = a.spheres[i], &q = b.spheres[k];
      const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z, s = p.radius + q.radius;
      if (p.radius >= 0 && q.radius >= 0 && (dx * dx + dy * dy) + dz * dz < s * s) return true;
    }
  }
  return false;
}

std::vector<Pair> run(SceneJob job) {
  std::vector<std::uint64_t> scratch(sc_scene_scratch_words(job.body_count));
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  REQUIRE(job.run() == SC_OK);
  std::vector<Pair> pairs(job.pair_count);
  job.pairs = pairs.data();
  job.pair_capacity = pairs.size();
  REQUIRE(job.run() == SC_OK);
  REQUIRE(job.pair_count == pairs.size());
  return pairs;
}

SceneJob job_of(const Scene& scene) {
  SceneJob job;
  job.bodies = scene.bodies.data();
  job.body_count = scene.bodies.size();
  return job;
}

}  // namespace

TEST_CASE("a scene's meetings are those of all pairs of bodies, but for layers and ignored pairs") {
  std::mt19937 random(5);
  std::size_t total = 0;
  for (int turn = 0; turn < 30; ++turn) {
    const Scene scene(turn == 0 ? 0 : random() % 60, random, turn % 2 == 0 ? 6.0F : 2.0F);
    std::vector<std::uint32_t> layers(32, ~0U);
    layers[1] &= ~(1U << 2);
    layers[2] &= ~(1U << 1);
    std::vector<Pair> expected, ignored;
    for (std::uint32_t b = 0; b < scene.bodies.size(); ++b) {
      for (std::uint32_t a = 0; a < b; ++a) {
        if (meet(scene.bodies[a], scene.bodies[b])) expected.push_back({a, b});
        if (random() % 5 == 0) ignored.push_back({a, b});
      }
    }
    std::sort(expected.begin(), expected.end());
    std::sort(ignored.begin(), ignored.end());
    SceneJob job = job_of(scene);
    CHECK(run(job) == expected);
    total += expected.size();
    job.layers = layers.data();
    job.ignored = ignored.data();
    job.ignored_count = ignored.size();
    expected.erase(std::remove_if(expected.begin(), expected.end(),
                                  [&](const Pair& pair) {
                                    return scene.bodies[pair.a].layer + scene.bodies[pair.b].layer == 3 ||
                                           std::binary_search(ignored.begin(), ignored.end(), pair);
                                  }),
                   expected.end());
    CHECK(run(job) == expected);
    if (expected.size() < 2) continue;
    // A list without room has the first.
    std::vector<std::uint64_t> scratch(sc_scene_scratch_words(job.body_count));
    std::vector<Pair> first(expected.size() / 2);
    job.scratch = scratch.data();
    job.scratch_words = scratch.size();
    job.pairs = first.data();
    job.pair_capacity = first.size();
    CHECK(job.run() == Status{SC_OVERFLOW, SC_FIELD_PAIRS});
    CHECK(job.pair_count == expected.size());
    CHECK(std::equal(first.begin(), first.end(), expected.begin()));
  }
  CHECK(total > 1000);
}

TEST_CASE("a scene's transforms move spheres and boxes") {
  using Vec = std::array<double, 3>;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1, 1);
  // By Rodrigues' formula.
  const auto moved = [](const Transform& t, const Vec3& p) {
    const Vec scaled{double{t.scale.x * p.x}, double{t.scale.y * p.y}, double{t.scale.z * p.z}};
    const Vec q{double{t.rotation[0]}, double{t.rotation[1]}, double{t.rotation[2]}};
    const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], double{t.rotation[3]}));
    const auto cross = [](const Vec& a, const Vec& b) {
      return Vec{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Vec once = cross(q, scaled), twice = cross(q, once);
    const Vec from{double{t.translation.x}, double{t.translation.y}, double{t.translation.z}};
    Vec out;
    for (std::size_t k = 0; k < 3; ++k) {
      out[k] = from[k] + scaled[k] + 2 * (double{t.rotation[3]} * once[k] + twice[k]) / (norm * norm);
    }
    return Vec3{static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2])};
  };
  std::size_t total = 0;
  for (int turn = 0; turn < 30; ++turn) {
    Scene scene(40, random, 3);
    std::vector<Transform> transforms(scene.bodies.size());
    // Bodies that certainly meet, and bodies that may: radii and boxes a little smaller, and a little larger.
    std::vector<SceneBody> less = scene.bodies, more = scene.bodies;
    std::vector<std::vector<Sphere>> small = scene.spheres, large = scene.spheres;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      SceneBody& body = scene.bodies[i];
      const float size = 0.7F + 0.3F * any(random), mirror = i % 3 == 0 ? -1.0F : 1.0F;
      transforms[i] = {{any(random), any(random), any(random)},
                       {any(random), any(random), any(random), 1 + any(random)},
                       {size, mirror * size, size}};
      body.transform = i % 5 == 0 ? nullptr : &transforms[i];
      const auto at = [&](const Vec3& p) { return body.transform == nullptr ? p : moved(transforms[i], p); };
      const float stretch = body.transform == nullptr ? 1 : size;
      for (std::size_t k = 0; k < body.sphere_count; ++k) {
        const Sphere& s = body.spheres[k];
        const Vec3 p = at({s.x, s.y, s.z});
        small[i][k] = {p.x, p.y, p.z, stretch * s.radius - 1e-5F};
        large[i][k] = {p.x, p.y, p.z, s.radius < 0 ? s.radius : stretch * s.radius + 1e-5F};
      }
      if (body.spheres != nullptr) {
        less[i].spheres = small[i].data();
        more[i].spheres = large[i].data();
        continue;
      }
      Vec3 low{HUGE_VALF, HUGE_VALF, HUGE_VALF}, high{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p = at({(corner & 1) != 0 ? body.low.x : body.high.x, (corner & 2) != 0 ? body.low.y : body.high.y,
                           (corner & 4) != 0 ? body.low.z : body.high.z});
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
      }
      const float e = 1e-5F;
      less[i].low = {low.x + e, low.y + e, low.z + e};
      less[i].high = {high.x - e, high.y - e, high.z - e};
      more[i].low = {low.x - e, low.y - e, low.z - e};
      more[i].high = {high.x + e, high.y + e, high.z + e};
    }
    const std::vector<Pair> found = run(job_of(scene));
    std::vector<Pair> certain, possible;
    for (std::uint32_t a = 0; a < scene.bodies.size(); ++a) {
      for (std::uint32_t b = a + 1; b < scene.bodies.size(); ++b) {
        if (meet(less[a], less[b])) certain.push_back({a, b});
        if (meet(more[a], more[b])) possible.push_back({a, b});
      }
    }
    CHECK(std::includes(found.begin(), found.end(), certain.begin(), certain.end()));
    CHECK(std::includes(possible.begin(), possible.end(), found.begin(), found.end()));
    CHECK(possible.size() <= certain.size() + 2);
    total += found.size();
  }
  CHECK(total > 1000);
}

TEST_CASE("a scene that is not sound is refused, and nothing is written") {
  std::mt19937 random(6);
  Scene scene(9, random, 1);
  std::vector<std::uint64_t> scratch(sc_scene_scratch_words(9));
  std::vector<Pair> pairs(36, Pair{7, 7});
  const auto refused = [&](const auto& spoil) {
    std::vector<SceneBody> bodies = scene.bodies;
    SceneJob job = job_of(scene);
    job.bodies = bodies.data();
    job.scratch = scratch.data();
    job.scratch_words = scratch.size();
    job.pairs = pairs.data();
    job.pair_capacity = pairs.size();
    spoil(job, bodies);
    const Status status = job.run();
    CHECK(std::all_of(pairs.begin(), pairs.end(), [](const Pair& p) { return p == Pair{7, 7}; }));
    return status;
  };
  using Bodies = std::vector<SceneBody>;
  CHECK(refused([](SceneJob& job, Bodies&) { job.bodies = nullptr; }) == Status{SC_NULL, SC_FIELD_BODIES});
  CHECK(refused([](SceneJob& job, Bodies&) { --job.scratch_words; }) == Status{SC_TOO_SMALL, SC_FIELD_SCRATCH});
  CHECK(refused([](SceneJob& job, Bodies&) { job.scratch = nullptr; }) == Status{SC_NULL, SC_FIELD_SCRATCH});
  CHECK(refused([](SceneJob& job, Bodies&) { job.pairs = nullptr; }) == Status{SC_NULL, SC_FIELD_PAIRS});
  CHECK(refused([](SceneJob&, Bodies& of) { of[3].layer = 32; }) == Status{SC_BAD_VALUE, SC_FIELD_BODIES});
  CHECK(refused([](SceneJob&, Bodies& of) {
          of[2].spheres = nullptr;
          of[2].sphere_count = 0;
          of[2].high.y = HUGE_VALF;
        }) == Status{SC_BAD_VALUE, SC_FIELD_BODIES});
  const Transform turned{{}, {0, 0, 0, 0}, {1, 1, 1}}, far{{HUGE_VALF, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
  for (const Transform& bad : {turned, far}) {
    CHECK(refused([&](SceneJob&, Bodies& of) { of[1].transform = &bad; }) == Status{SC_BAD_VALUE, SC_FIELD_TRANSFORM});
  }
  std::vector<std::uint32_t> layers(32, 0);
  layers[4] = 1U << 3;
  CHECK(refused([&](SceneJob& job, Bodies&) { job.layers = layers.data(); }) == Status{SC_BAD_VALUE, SC_FIELD_LAYERS});
  for (const std::vector<Pair>& bad : {std::vector<Pair>{{1, 1}}, {{2, 1}}, {{1, 9}}, {{1, 2}, {1, 2}}}) {
    CHECK(refused([&](SceneJob& job, Bodies&) {
            job.ignored = bad.data();
            job.ignored_count = bad.size();
          }) == Status{SC_BAD_VALUE, SC_FIELD_IGNORED});
  }
  CHECK(refused([&](SceneJob& job, Bodies&) { job.scratch = reinterpret_cast<std::uint64_t*>(pairs.data()); }) ==
        Status{SC_ALIASED, SC_FIELD_OUTPUT});
}
