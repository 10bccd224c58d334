// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of two bodies, against the exact contacts of poses on the way.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "moving_joints.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

// A frame of the moving human, moved.
std::vector<float> frame_at(std::size_t frame, const Eigen::Affine3d& place) {
  std::vector<float> out = moving_human().frames[frame].palette;
  for (std::size_t b = 0; b < out.size(); b += 12) {
    const Eigen::Affine3d m = place * matrix_of(&out[b]);
    for (Eigen::Index i = 0; i < 12; ++i) out[b + static_cast<std::size_t>(i)] = static_cast<float>(m(i / 4, i % 4));
  }
  return out;
}

// One of the human stands, with a move of its own; another of it comes from the side, into it, while it turns.
struct TwoBodies {
  std::vector<float> a[2], b[2];

  explicit TwoBodies(std::size_t frame) {
    const double height = double{sc_asset_get_info(moving_human().asset.handle()).height};
    const Eigen::AngleAxisd turn(0.15, Eigen::Vector3d(0.3, 0.8, 0.2).normalized());
    a[0] = moving_human().frames[frame].palette;
    a[1] = moving_human().frames[frame + 1].palette;
    b[0] = frame_at(frame + 2, Eigen::Translation3d(0.4 * height, 0.02, 0.1) * Eigen::Affine3d::Identity());
    b[1] = frame_at(frame + 2, Eigen::Translation3d(0.1 * height, -0.05, -0.05 * height) * Eigen::Affine3d(turn));
  }
  StepJob job() const {
    StepJob out;
    out.a.body.asset = out.b.body.asset = moving_human().asset.handle();
    out.a.body.skin_table = out.b.body.skin_table = human_skin_table();
    out.a.body.pose = bones_of(a[0]);
    out.a.end = bones_of(a[1]);
    out.b.body.pose = bones_of(b[0]);
    out.b.end = bones_of(b[1]);
    return out;
  }
};

SkinContacts meeting_at(const std::vector<float>& a, const std::vector<float>& b) {
  BodyContactJob job;
  job.a.asset = job.b.asset = moving_human().asset.handle();
  job.a.skin_table = job.b.skin_table = human_skin_table();
  job.a.pose = bones_of(a);
  job.b.pose = bones_of(b);
  return find_contacts(job);
}

}  // namespace

TEST_CASE("steps of two bodies: what poses on the way have is found, and nothing else" *
          doctest::test_suite("long runs")) {
  constexpr int kPoses = 32;
  std::size_t total = 0, passed = 0;
  for (const std::size_t frame : {0, 12}) {
    const TwoBodies two(frame);
    const StepContacts found = run(two.job());
    total += found.contacts.size();
    for (int k = 0; k <= kPoses; ++k) {
      const double t = static_cast<double>(k) / kPoses;
      CAPTURE(t);
      for (const PartContact& part : meeting_at(blended(two.a[0], two.a[1], t), blended(two.b[0], two.b[1], t)).parts) {
        const StepContact* const of = found.of(part.part_a, part.part_b);
        REQUIRE(of != nullptr);
        CHECK(double{of->begin} <= t + 1e-3);
        CHECK(double{of->end} >= t - 1e-3);
      }
    }
    for (const StepContact& of : found.contacts) {
      if (of.at_start != 0) continue;
      const double t{of.begin};
      CAPTURE(t);
      const PosedTriangles a(blended(two.a[0], two.a[1], t)), b(blended(two.b[0], two.b[1], t));
      CHECK(distance_between(a[of.triangle_a], b[of.triangle_b]) <= step_tolerance());
      passed += of.at_end == 0 ? 1 : 0;
    }
  }
  CHECK(total > 40);
  CHECK(passed > 20);
}

TEST_CASE("with the bodies of a step swapped all is the same, the other way round") {
  const TwoBodies two(4);
  StepJob job = two.job();
  const StepContacts found = run(job);
  std::swap(job.a, job.b);
  const StepContacts other = run(job);
  CHECK(!found.contacts.empty());
  CHECK(found.contacts.size() == other.contacts.size());
  for (const StepContact& of : found.contacts) {
    const StepContact* const back = other.of(of.part_b, of.part_a);
    REQUIRE(back != nullptr);
    CHECK(double{back->begin} == doctest::Approx(double{of.begin}).epsilon(1e-3));
    CHECK(double{back->end} == doctest::Approx(double{of.end}).epsilon(1e-3));
    CHECK(back->at_start == of.at_start);
    CHECK(back->at_end == of.at_end);
  }
}

TEST_CASE("parts that a body ignores touch nothing in a step") {
  const TwoBodies two(4);
  StepJob job = two.job();
  const StepContacts all = run(job);
  REQUIRE(!all.contacts.empty());
  const std::uint32_t without = all.contacts[0].part_b;
  std::vector<std::uint64_t> ignored(sc_part_words(job.b.body.asset));
  ignored[without / 64] |= std::uint64_t{1} << without % 64;
  job.b.body.ignored_parts = ignored.data();
  std::vector<StepContact> expected = all.contacts;
  expected.erase(
      std::remove_if(expected.begin(), expected.end(), [&](const StepContact& of) { return of.part_b == without; }),
      expected.end());
  CHECK(same_bits(run(job).contacts, expected));
  CHECK(expected.size() < all.contacts.size());
}

TEST_CASE(
    "a step of two bodies is the same from bones, from joints that do not turn, and from vertices but for roundings") {
  // b goes straight as a whole; a stands.
  const auto& frames = moving_human().frames;
  const double height = double{sc_asset_get_info(moving_human().asset.handle()).height};
  const std::vector<float> from = frame_at(3, Eigen::Affine3d(Eigen::Translation3d(0.4 * height, 0, 0.1))),
                           to = frame_at(3, Eigen::Affine3d(Eigen::Translation3d(0.15 * height, 0.05, 0)));
  StepJob job;
  job.a.body.asset = job.b.body.asset = moving_human().asset.handle();
  job.a.body.skin_table = job.b.body.skin_table = human_skin_table();
  job.a.body.pose = bones_of(frames[0].palette);
  job.a.end = bones_of(frames[0].palette);
  job.b.body.pose = bones_of(from);
  job.b.end = bones_of(to);
  const StepContacts expected = run(job);
  CHECK(expected.contacts.size() > 20);
  const auto check = [&](const StepJob& other) {
    const StepContacts found = run(other);
    CHECK(found.contacts.size() == expected.contacts.size());
    for (const StepContact& of : expected.contacts) {
      const StepContact* const as = found.of(of.part_a, of.part_b);
      REQUIRE(as != nullptr);
      CHECK(double{as->begin} == doctest::Approx(double{of.begin}).epsilon(2e-4));
      CHECK(double{as->end} == doctest::Approx(double{of.end}).epsilon(2e-4));
    }
  };
  const MovingJoints straight(from, to, MovingJoints::Order::kFlat);
  StepJob of_joints = job;
  of_joints.b = straight.motion(SC_BLEND_SLERP);
  check(of_joints);
  const std::vector<float> starts = skin(*moving_human().asset.handle(), bones_of(from)),
                           ends = skin(*moving_human().asset.handle(), bones_of(to));
  StepJob of_vertices = job;
  of_vertices.b.body.pose = vertices_of(starts);
  of_vertices.b.end = vertices_of(ends);
  check(of_vertices);
}
