// SPDX-License-Identifier: MIT
// Steps of a plate and a spike, whose times are known.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "jobs.h"
#include "palette.h"
#include "random_poses.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kHeight = 1.75;  // of tiny assets
constexpr Transform kStill{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};

// A plate, part 0, in the plane y = 0, that bone 0 moves; a spike, part 1, that bone 1 moves, with its tip at (0, -1,
// 0) and its base at y = -0.5.
struct PlateAndSpike {
  PlateAndSpike() : tiny(random_asset(2, 1)) {
    const Vec3 rim[] = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
    const Vec3 base[] = {{0.25F, -0.5F, 0.125F}, {-0.25F, -0.5F, 0.25F}, {-0.125F, -0.5F, -0.25F}};
    for (std::size_t k = 0; k < 4; ++k) {
      put(3 * k, {Vec3{0, 0, 0}, rim[k], rim[(k + 1) % 4]});
      put(12 + 3 * k, {k < 3 ? Vec3{0, -1, 0} : base[2], base[k % 3], base[(k + 1) % 3]});
    }
    for (std::size_t t = 0; t < 8; ++t) tiny.part_of_triangle[t] = t < 4 ? 0 : 1;
    tiny.parts.ignored = {0};
    TinySkin skin = add_bones(tiny, 3, 1);
    for (BoneEntry& bone : tiny.parts.bones) bone.inverse_bind[3] = 0;
    for (std::size_t v = 0; v < 24; ++v) {
      skin.weights[v] = {{v < 12 ? 0U : 1U, 1.0}};
      skin.morphs[v].clear();
    }
    add_skin(tiny, &skin, 2);
    tiny.parts.skin.rest_contacts.clear();
    opened = std::make_unique<OpenedAsset>(tiny.parts);
    REQUIRE_MESSAGE(opened->status == SC_OK, opened->message);
  }
  void put(std::size_t first, const std::array<Vec3, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const float p[] = {corners[k].x, corners[k].y, corners[k].z};
      std::copy(p, p + 3, &tiny.rest[3 * (first + k)]);
    }
  }

  TinyAsset tiny;
  std::unique_ptr<OpenedAsset> opened;
};

const PlateAndSpike& plate_and_spike() {
  static const PlateAndSpike both;
  return both;
}

Matrix moved_by(float x, float y, float z) { return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z}; }
const std::vector<Matrix>& placed(std::vector<Matrix>& out, float x, float y) {
  out = {moved_by(0, 0, 0), moved_by(x, y, 0), moved_by(0, 0, 0)};
  return out;
}

Transform turned(double degrees, const Vec3& translation = {0, 0, 0}) {  // about z
  const double half = degrees * kPi / 360;
  return {translation, {0, 0, static_cast<float>(std::sin(half)), static_cast<float>(std::cos(half))}, {1, 1, 1}};
}

// Bone 1 hangs on the second of two joints: on an axis at a height above the plate.
struct Swing {
  std::vector<Transform> start, end;
  std::vector<std::uint32_t> parents{SC_NO_JOINT, SC_NO_JOINT, 1}, joint_of_bone{0, 2, SC_NO_JOINT};

  Swing(double height, const Transform& from, const Transform& to)
      : start{kStill, turned(0, {0, static_cast<float>(height), 0}), from}, end{start[0], start[1], to} {}
  Motion motion(Blend blend) const {
    Motion out;
    out.body.asset = &plate_and_spike().opened->asset;
    out.blend = blend;
    out.start_joints = start.data();
    out.end_joints = end.data();
    out.joint_count = start.size();
    out.parents = parents.data();
    out.joint_of_bone = joint_of_bone.data();
    return out;
  }
};

// On every target the same; the one contact there is, or none.
StepContacts find_on_all(StepJob job) {
  job.target = SC_TARGET_SCALAR;
  const StepContacts found = find_contacts(job);
  REQUIRE(found.status == SC_OK);
  for (const Target target : supported_targets()) {
    job.target = target;
    CHECK(same_bits(find_contacts(job).contacts, found.contacts));
  }
  return found;
}

void check_times(const StepJob& job, double begin, double end, double error) {
  const StepContacts found = find_on_all(job);
  REQUIRE(found.contacts.size() == 1);
  const StepContact& of = found.contacts[0];
  CHECK(of.part_a == 0);
  CHECK(of.part_b == 1);
  CHECK(of.at_start == 0);
  CHECK(of.at_end == 0);
  CHECK(double{of.begin} == doctest::Approx(begin).epsilon(error));
  CHECK(double{of.end} == doctest::Approx(end).epsilon(error));
  CHECK(of.triangle_a < 4);
  CHECK(of.triangle_b >= 4);
  CHECK(std::abs(double{of.at.y}) < 2 * kHeight * 1e-2);
}

StepJob job_of(const Motion& motion, float tolerance = 0) {
  StepJob job;
  job.a = motion;
  job.tolerance = tolerance;
  return job;
}

}  // namespace

TEST_CASE("a spike that falls through a plate touches it from when its tip does until its base has passed") {
  std::vector<Matrix> above, below;
  StepJob job;
  job.a.body.asset = &plate_and_spike().opened->asset;
  job.a.body.pose = pose_of(placed(above, 0.25F, 1.3F));
  job.a.end = pose_of(placed(below, 0.25F, 0.0F));
  for (const double tolerance : {0.0, 1e-6, 1e-3, 1e-2}) {
    CAPTURE(tolerance);
    job.tolerance = static_cast<float>(tolerance);
    const double error = (tolerance > 0 ? tolerance : 1e-4) * kHeight / 1.3 + 1e-6;
    check_times(job, 0.3 / 1.3, 0.8 / 1.3, error);
  }
}

TEST_CASE("a spike that swings through a plate touches it at the angles at which its tip is as deep as the plate") {
  const double deep = std::cos(40 * kPi / 180);  // the tip is in from -40 to 40 degrees
  const Swing swing(deep, turned(-60), turned(60));
  check_times(job_of(swing.motion(SC_BLEND_SLERP)), 1.0 / 6, 5.0 / 6, 2e-4);
  const double begin = (1 - std::tan(20 * kPi / 180) / std::tan(30 * kPi / 180)) / 2;
  check_times(job_of(swing.motion(SC_BLEND_NLERP)), begin, 1 - begin, 2e-4);
}

TEST_CASE("a spike that dips by more than the tolerance is found, one that stays away by more is not") {
  for (const double tolerance : {0.0, 1e-3, 1e-2}) {
    const double dip = 1.01 * (tolerance > 0 ? tolerance : 1e-4) * kHeight;
    for (const Blend blend : {SC_BLEND_SLERP, SC_BLEND_NLERP}) {
      CAPTURE(tolerance);
      const Swing into(1 - dip, turned(-70), turned(30)), over(1 + dip, turned(-70), turned(30));
      CHECK(find_on_all(job_of(into.motion(blend), static_cast<float>(tolerance))).contacts.size() == 1);
      CHECK(find_on_all(job_of(over.motion(blend), static_cast<float>(tolerance))).contacts.empty());
    }
  }
}

TEST_CASE("a joint turns the shorter way round; exactly half way round, as the signs of the quaternions have it") {
  const auto touches = [](const Transform& from, const Transform& to, Blend blend) {
    Swing swing(0.9, from, to);
    swing.start[1] = swing.end[1] = turned(-90, {0, 0.9F, 0});  // the spike lies to the left
    return !find_on_all(job_of(swing.motion(blend))).contacts.empty();
  };
  const Transform half{{0, 0, 0}, {0, 0, 1, 0}, {1, 1, 1}}, other_half{{0, 0, 0}, {0, 0, -1, 0}, {1, 1, 1}};
  for (const Blend blend : {SC_BLEND_SLERP, SC_BLEND_NLERP}) {
    CHECK(touches(kStill, turned(170), blend));
    CHECK(touches(kStill, half, blend));
    CHECK(!touches(kStill, other_half, blend));
    CHECK(!touches(kStill, turned(190), blend));
    CHECK(!touches(turned(360), turned(-10), blend));  // in all 10 degrees up
  }
}

TEST_CASE("a negative scale mirrors") {
  const double deep = std::cos(40 * kPi / 180);
  Swing swing(deep, turned(-60), turned(60));
  swing.start[1] = swing.end[1] = turned(180, {0, static_cast<float>(deep), 0});
  swing.start[2].scale = swing.end[2].scale = {1, -1, 1};
  check_times(job_of(swing.motion(SC_BLEND_SLERP)), 1.0 / 6, 5.0 / 6, 2e-4);
}

TEST_CASE("two bodies, one of vertices and one of joints: times are those of one body that has both") {
  const double deep = std::cos(40 * kPi / 180);
  const Swing swing(deep, turned(-60), turned(60));
  StepJob job = job_of(swing.motion(SC_BLEND_SLERP));
  job.b.body.asset = &plate_and_spike().opened->asset;
  job.b.body.pose.vertices = plate_and_spike().tiny.rest.data();
  job.b.body.pose.vertex_count = 24;
  job.b.end = job.b.body.pose;
  const std::uint64_t plate = 1, spike = 2;
  job.a.body.ignored_parts = &plate;
  job.b.body.ignored_parts = &spike;
  const StepContacts found = find_on_all(job);
  REQUIRE(found.contacts.size() == 1);
  CHECK(found.contacts[0].part_a == 1);
  CHECK(found.contacts[0].part_b == 0);
  CHECK(double{found.contacts[0].begin} == doctest::Approx(1.0 / 6).epsilon(2e-4));
  CHECK(double{found.contacts[0].end} == doctest::Approx(5.0 / 6).epsilon(2e-4));
}

TEST_CASE("where nothing moves a step's contacts are the frame's, from its start to its end") {
  std::size_t total = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    TinyAsset tiny = random_band(11, seed);
    const TinySkin skin = add_bones(tiny, 6, seed + 1);
    add_skin(tiny, &skin, 1 + seed % 5);
    const OpenedAsset opened(tiny.parts);
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    std::mt19937 random(seed);
    const std::vector<Matrix> matrices = random_pose(6, PoseKind::kGentle, 1, random);
    const std::vector<float> weights = random_morph_weights(3, random);
    SkinContactJob frame;
    frame.asset = &opened.asset;
    frame.pose = pose_of(matrices, weights);
    StepJob job;
    job.a.body.asset = &opened.asset;
    job.a.body.pose = job.a.end = frame.pose;
    const std::vector<PartContact> parts = find_contacts(frame).parts;
    const StepContacts found = find_on_all(job);
    total += parts.size();
    CHECK(found.contacts.size() == parts.size());
    for (const PartContact& part : parts) {
      const StepContact* const of = found.of(part.part_a, part.part_b);
      REQUIRE(of != nullptr);
      CHECK(of->at_start == 1);
      CHECK(of->at_end == 1);
      CHECK(of->begin == 0);
      CHECK(of->end == 1);
      CHECK(of->triangle_a == SC_NO_TRIANGLE);
    }
  }
  CHECK(total > 10);
}

TEST_CASE("a list of step contacts that is too small gets its first entries") {
  TinyAsset tiny = random_band(11, 2);
  const TinySkin skin = add_bones(tiny, 6, 3);
  add_skin(tiny, &skin, 3);
  const OpenedAsset opened(tiny.parts);
  std::mt19937 random(2);
  const std::vector<Matrix> start = random_pose(6, PoseKind::kGentle, 1, random),
                            end = random_pose(6, PoseKind::kGentle, 1, random);
  const PreparedSkin table(opened.asset);
  StepJob job;
  job.a.body.asset = &opened.asset;
  job.a.body.skin_table = table.words.data();
  job.a.body.pose = pose_of(start);
  job.a.end = pose_of(end);
  const StepContacts all = find_contacts(job);
  REQUIRE(all.contacts.size() > 3);
  std::vector<std::uint64_t> scratch(step_scratch_words(&job.a, nullptr));
  std::vector<StepContact> first(all.contacts.size() - 2);
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.contacts = first.data();
  job.contact_capacity = first.size();
  CHECK(job.run() == Status{SC_OVERFLOW, SC_FIELD_CONTACTS});
  CHECK(job.contact_count == all.contacts.size());
  CHECK(same_bits(first, {all.contacts.begin(), all.contacts.end() - 2}));
}

}  // namespace spherechain::test
