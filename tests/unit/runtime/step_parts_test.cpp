// SPDX-License-Identifier: MIT
// The pieces of a step, by brute force.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "jobs.h"
#include "palette.h"
#include "random_poses.h"
#include "runtime/src/step/approach.h"
#include "runtime/src/step/motion.h"
#include "runtime/src/triangles/exact_triangles.h"
#include "tiny_skin.h"

namespace spherechain::test {

TEST_CASE("of two triangles that go straight no contact longer than a step of the way goes unnoticed") {
  std::mt19937 random(7);
  constexpr int kSamples = 2000;
  std::size_t touch = 0, apart = 0;
  for (int i = 0; i < 3000; ++i) {
    CAPTURE(i);
    CornerPaths way{};
    for (std::size_t k = 0; k < 6; ++k) {
      const auto any = [&] { return double{uniform(random, -0.5F, 0.5F)}; };
      way.from.p[k] = {any() + (k < 3 ? 0 : 0.7), any(), any()};
      way.to.p[k] = way.from.p[k] + Double3{any() * 0.3 - (k < 3 ? 0 : 1), any() * 0.3, any() * 0.3};
    }
    way.step = 0.01;
    way.shortest = 1.0 / 65536;
    double fastest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 3; b < 6; ++b) {
        fastest = std::max(fastest, length((way.to.p[b] - way.from.p[b]) - (way.to.p[a] - way.from.p[a])));
      }
    }
    const Approach found = approach(way, 1);
    const auto touches_at = [&](double time) {
      const SixCorners corners = way.at(time);
      return triangles_intersect(corners.triangle(0), corners.triangle(3));
    };
    REQUIRE(found.outcome != Outcome::kTooCoarse);
    const bool touches = found.outcome == Outcome::kTouch;
    (touches ? touch : apart) += 1;
    if (touches) CHECK(touches_at(found.time));
    const int until = touches ? static_cast<int>(found.time * kSamples) : kSamples;
    int row = 0, longest = 0;
    for (int s = 0; s <= until; ++s) {
      row = touches_at(static_cast<double>(s) / kSamples) ? row + 1 : 0;
      longest = std::max(longest, row);
    }
    CHECK((longest - 1) * fastest / kSamples <= way.step);
    // The same up to any limit.
    const double limit = double{uniform(random, 0, 1)};
    const Approach limited = approach(way, limit);
    CHECK((limited.outcome == Outcome::kTouch) == (touches && found.time <= limit));
    if (limited.outcome == Outcome::kTouch) CHECK(limited.time == found.time);
  }
  CHECK(touch > 500);
  CHECK(apart > 500);
}

TEST_CASE("no vertex strays from a straight line by more than is said") {
  std::size_t checked = 0;
  double nearest = 0;  // share of the bound that was used
  for (unsigned seed = 1; seed <= 12; ++seed) {
    CAPTURE(seed);
    TinyAsset tiny = random_band(6, seed);
    const TinySkin skin_of = add_bones(tiny, 5, seed + 1);
    add_skin(tiny, &skin_of, 4);
    const OpenedAsset opened(tiny.parts);
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    const PreparedSkin table(opened.asset);
    std::mt19937 random(seed);
    const auto any = [&](float size) { return uniform(random, -size, size); };
    std::vector<Transform> ends[2];
    for (std::vector<Transform>& joints : ends) {
      for (int i = 0; i < 5; ++i) {
        joints.push_back({{any(1), any(1), any(1)}, {any(1), any(1), any(1), any(1)}, {any(1), 1 + any(0.5F), any(2)}});
      }
    }
    const std::vector<float> weights[2] = {random_morph_weights(3, random), random_morph_weights(3, random)};
    const std::vector<std::uint32_t> parents{SC_NO_JOINT, 0, 1, 1, SC_NO_JOINT};
    const std::vector<Matrix> matrices[2] = {random_pose(5, PoseKind::kAny, 1, random),
                                             random_pose(5, PoseKind::kAny, 1, random)};
    Motion motion;
    motion.body.asset = &opened.asset;
    motion.blend = static_cast<Blend>(seed % 3);
    if (motion.blend == SC_BLEND_LINEAR) {
      motion.body.pose = pose_of(matrices[0], weights[0]);
      motion.end = pose_of(matrices[1], weights[1]);
    } else {
      motion.start_joints = ends[0].data();
      motion.end_joints = ends[1].data();
      motion.joint_count = 5;
      motion.parents = seed % 2 == 0 ? parents.data() : nullptr;
      Pose* const poses[] = {&motion.body.pose, &motion.end};
      for (std::size_t k = 0; k < 2; ++k) {
        poses[k]->morph_weights = weights[k].data();
        poses[k]->morph_weight_count = seed < 7 ? 3 : 0;
        if (seed >= 7) poses[k]->morph_weights = nullptr;
      }
    }
    WordMemory counter(nullptr);
    BodyMotion().take(counter, opened.view(), motion.joint_count);
    std::vector<std::uint64_t> words(counter.used());
    WordMemory memory(words.data());
    BodyMotion way;
    way.take(memory, opened.view(), motion.joint_count);
    way.start(motion, opened.view(), table.surface);
    std::map<std::uint32_t, std::uint32_t> sphere_of_vertex;
    for (std::uint32_t s = 0; s < tiny.triangles.size(); ++s) {
      for (const std::uint32_t t : tiny.triangles[s]) {
        for (const std::uint32_t v : tiny.corners[t]) sphere_of_vertex[v] = s;
      }
    }
    std::vector<float> bones(60), morphs(3);
    const auto positions_at = [&](double time) {
      return skin(opened.asset, way.pose_at(time, bones.data(), morphs.data(), nullptr));
    };
    for (int i = 0; i < 100; ++i) {
      const double h = std::ldexp(1.0, -static_cast<int>(random() % 5));
      const double from = h * static_cast<double>(random() % static_cast<unsigned>(1 / h));
      const double share = static_cast<double>(1 + random() % 15) / 16;
      const std::vector<float> a = positions_at(from), b = positions_at(from + h), p = positions_at(from + share * h);
      for (const auto& [vertex, sphere] : sphere_of_vertex) {
        double squared = 0, size = 0;
        for (std::size_t k = 3 * vertex; k < 3 * vertex + 3; ++k) {
          const double off = double{p[k]} - (double{a[k]} + share * (double{b[k]} - double{a[k]}));
          squared += off * off;
          size = std::max(size, std::abs(double{p[k]}));
        }
        if (!std::isfinite(squared)) continue;  // no packed vertex stands for it
        const double bound = double{way.strays()[sphere]} * h * h;
        CHECK(std::sqrt(squared) <= bound + 1e-6 * (1 + size));
        nearest = std::max(nearest, std::sqrt(squared) / (bound + 1e-6 * (1 + size)));
        ++checked;
      }
    }
  }
  CHECK(checked > 10000);
  CHECK(nearest > 0.1);
}

}  // namespace spherechain::test
