// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of joints, against the exact contacts of poses on the way, which Eigen makes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "baker/mesh/decompose.h"
#include "moving_joints.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

StepContacts stepped(const Motion& motion) {
  StepJob job;
  job.a = motion;
  return run(job);
}

// How deep two parts are in each other in a pose.
double depth_of(const std::vector<float>& palette, const SkinContacts& found, const PartContact& part) {
  PenetrationJob job;
  job.asset = moving_human().asset.handle();
  job.pose = bones_of(palette);
  job.contacts = found.triangles.data();
  job.contact_count = found.triangles.size();
  for (const Penetration& one : measure(job, SC_TARGET_BEST)) {
    if (std::minmax(one.part, one.other) == std::minmax(part.part_a, part.part_b)) return double{one.measures.depth};
  }
  return HUGE_VAL;
}

// All that poses on the way have is reported, and in time; gives how many contacts that are not at the start were seen.
int check_all_are_found(const StepContacts& found, const MovingJoints& joints, Blend blend) {
  constexpr int kPoses = 64;
  int seen = 0;
  for (int k = 0; k <= kPoses; ++k) {
    const double t = static_cast<double>(k) / kPoses;
    CAPTURE(t);
    const std::vector<float> palette = joints.palette_at(t, blend);
    const SkinContacts frame = run(job_of(bones_of(palette)));
    for (const PartContact& part : frame.parts) {
      CAPTURE(part.part_a);
      CAPTURE(part.part_b);
      const StepContact* const of = found.of(part.part_a, part.part_b);
      const bool in_time = of != nullptr && double{of->begin} <= t + 0.01 && double{of->end} >= t - 0.01;
      if (!in_time) CHECK(depth_of(palette, frame, part) <= step_tolerance());
      seen += of == nullptr || of->at_start == 0 ? 1 : 0;
    }
  }
  return seen;
}

// A contact that is reported to begin on the way does so: its triangles are no farther apart than the tolerance.
void check_none_is_made_up(const StepContacts& found, const MovingJoints& joints, Blend blend) {
  for (const StepContact& of : found.contacts) {
    CAPTURE(of.part_a);
    CAPTURE(of.part_b);
    CAPTURE(of.begin);
    if (of.at_start != 0) continue;
    if (of.triangle_a == SC_NO_TRIANGLE) {
      CHECK(of.begin == 1);
      CHECK(of.at_end == 1);
      continue;
    }
    const PosedTriangles posed(joints.palette_at(double{of.begin}, blend));
    const TriangleCorners a = posed[of.triangle_a], b = posed[of.triangle_b];
    CHECK(distance_between(a, b) <= step_tolerance());
    const TriangleCorners at{{of.at, {of.at.x + 1e-6F, of.at.y, of.at.z}, {of.at.x, of.at.y + 1e-6F, of.at.z}}};
    CHECK(distance_between(a, at) <= step_tolerance());
    CHECK(distance_between(b, at) <= step_tolerance());
    const auto& part_of = moving_human().bake.body_parts.of_triangle;
    CHECK(part_of[of.triangle_a] == of.part_a);
    CHECK(part_of[of.triangle_b] == of.part_b);
  }
}

}  // namespace

TEST_CASE("steps of joints: what poses on the way have is found, and nothing else" * doctest::test_suite("long runs")) {
  const auto& frames = moving_human().frames;
  int seen = 0, begun = 0;
  for (const auto order : {MovingJoints::Order::kFlat, MovingJoints::Order::kDownTheSkeleton}) {
    for (const Blend blend : {SC_BLEND_SLERP, SC_BLEND_NLERP}) {
      for (const std::size_t f : {0, 7, 14, 26}) {
        CAPTURE(f);
        const bool is_down = order == MovingJoints::Order::kDownTheSkeleton;
        const std::vector<float>& from = frames[f].palette;
        const std::vector<float>& to = frames[f + (is_down ? 3 : 1)].palette;
        const MovingJoints joints(from, to, order, f == 7 ? 1.1 : 1.0);
        const StepContacts found = stepped(joints.motion(blend));
        seen += check_all_are_found(found, joints, blend);
        check_none_is_made_up(found, joints, blend);
        begun += static_cast<int>(std::count_if(found.contacts.begin(), found.contacts.end(),
                                                [](const StepContact& of) { return of.begin > 0 && of.begin < 1; }));
      }
    }
  }
  CHECK(seen > 100);
  CHECK(begun > 20);
}

TEST_CASE("a fist that goes through the thigh within one step is found there, though neither end has a contact") {
  const AssetView& view = view_of(*moving_human().asset.handle());
  const auto place = [&](const char* name) {
    const Vec3 p = view.joint(bone_named(name)).position;
    return Eigen::Vector3d(double{p.x}, double{p.y}, double{p.z});
  };
  const auto turned = [](std::vector<float>& palette, const Eigen::Vector3d& about, const Eigen::Quaterniond& by,
                         const std::vector<const char*>& bones) {
    const Eigen::Affine3d turn = Eigen::Translation3d(about) * by * Eigen::Translation3d(-about);
    for (const char* bone : bones) {
      for (Eigen::Index i = 0; i < 12; ++i) {
        palette[12 * bone_named(bone) + static_cast<std::size_t>(i)] = static_cast<float>(turn(i / 4, i % 4));
      }
    }
  };
  // The thigh is raised forward; the arm points at its middle, and swings across.
  const Eigen::Vector3d left = moving_human().bake.regions.frame.left;
  const Eigen::Vector3d shoulder = place("left_shoulder"), hand = place("left_wrist"), hip = place("left_hip");
  const Eigen::Quaterniond raised(Eigen::AngleAxisd(-1.9, left));
  const Eigen::Vector3d inside = hip + raised * (0.5 * (place("left_knee") - hip));
  const Eigen::Quaterniond pointed = spherechain::baker::turn_between(hand - shoulder, inside - shoulder);
  const Eigen::Vector3d axis = (inside - shoulder).cross(left).normalized();
  const auto posed = [&](double angle) {
    std::vector<float> out = rest_palette();
    turned(out, hip, raised, {"left_hip", "left_knee", "left_ankle"});
    turned(out, shoulder, Eigen::AngleAxisd(angle, axis) * pointed, {"left_shoulder", "left_elbow", "left_wrist"});
    return out;
  };
  const std::vector<float> outside = posed(-0.6), beyond = posed(0.6);
  const std::uint32_t fist = part_of_bone("left_wrist"), thigh = part_of_bone("left_hip");
  const std::uint32_t part_a = std::min(fist, thigh), part_b = std::max(fist, thigh);
  const MovingJoints joints(outside, beyond, MovingJoints::Order::kDownTheSkeleton);
  for (const Blend blend : {SC_BLEND_LINEAR, SC_BLEND_SLERP, SC_BLEND_NLERP}) {
    CAPTURE(blend);
    Motion motion = joints.motion(blend);
    if (blend == SC_BLEND_LINEAR) {
      motion = Motion();
      motion.body.asset = moving_human().asset.handle();
      motion.body.skin_table = human_skin_table();
      motion.body.pose = bones_of(outside);
      motion.end = bones_of(beyond);
    }
    for (const auto* end : {&outside, &beyond}) {
      for (const PartContact& part : run(job_of(bones_of(*end))).parts) {
        CHECK((part.part_a != part_a || part.part_b != part_b));
      }
    }
    const StepContacts found = stepped(motion);
    const StepContact* const of = found.of(part_a, part_b);
    REQUIRE(of != nullptr);
    CHECK(of->at_start == 0);
    CHECK(of->at_end == 0);
    CHECK(of->begin > 0.1F);
    CHECK(of->begin < of->end);
    CHECK(of->end < 0.9F);
    if (blend != SC_BLEND_LINEAR) {
      check_all_are_found(found, joints, blend);
      check_none_is_made_up(found, joints, blend);
    }
  }
}
