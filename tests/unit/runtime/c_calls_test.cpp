// SPDX-License-Identifier: MIT
// A C99 program that calls every function once gets what C++ gets.
#include <doctest/doctest.h>

#include <memory>

#include "c_calls.h"
#include "jobs.h"
#include "owned_filter.h"
#include "palette.h"
#include "random_poses.h"
#include "tiny_skin.h"

namespace spherechain::test {

TEST_CASE("every function called from C99 gives what C++ gets") {
  constexpr std::size_t kBoneCount = 6;
  TinyAsset tiny = random_band(20, 3);
  const TinySkin skin = add_bones(tiny, kBoneCount, 4);
  add_skin(tiny, &skin, 4);
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(5);
  const std::vector<Matrix> matrices = random_pose(kBoneCount, PoseKind::kGentle, 1, random);
  const auto c = std::make_unique<c_calls_result>();
  c_call_all(opened.bytes.data(), opened.bytes.size(), matrices[0].data(), kBoneCount, tiny.rest.data(),
             tiny.parts.vertex_count, c.get());
  CHECK_MESSAGE(c->failed == nullptr, std::string(c->failed == nullptr ? "" : c->failed));

  const Pose pose = pose_of(matrices);
  const std::vector<Sphere> spheres = refit(opened.asset, pose, SC_RADIUS_DETECT).spheres;
  CHECK(same_bits({c->spheres, c->spheres + 20}, spheres));
  OwnedFilter owned(opened.asset);
  owned.ignore(2, 5);
  REQUIRE(sc_ignore_parts(&opened.asset, owned.ignored.data(), 0, 1, 1) == SC_OK);
  CHECK(same_bits({c->pairs, c->pairs + c->pair_count}, detect(opened.asset, spheres, SC_RADIUS_DETECT).pairs));
  const std::vector<Pair> pairs = detect(opened.asset, spheres, SC_RADIUS_DETECT, SC_TARGET_BEST, &owned.filter).pairs;
  CHECK(!pairs.empty());
  REQUIRE(c->crowd_pair_count == pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) CHECK(c->crowd_pairs[i].pair == pairs[i]);

  SkinContactJob job;
  job.asset = &opened.asset;
  job.pose = pose;
  const SkinContacts contacts = find_contacts(job);
  CHECK(!contacts.triangles.empty());
  CHECK(same_bits({c->triangles, c->triangles + c->triangle_count}, contacts.triangles));
  CHECK(same_bits({c->parts, c->parts + c->part_count}, contacts.parts));

  BodyContactJob bodies;
  bodies.a.asset = bodies.b.asset = &opened.asset;
  bodies.a.pose = bodies.b.pose = pose;
  const SkinContacts with_itself = find_contacts(bodies);
  CHECK(c->body_triangle_count == with_itself.triangles.size());
  CHECK(c->body_part_count == with_itself.parts.size());
  CHECK(c->floor_part_count > 0);

  const std::vector<Matrix> rest(kBoneCount, Matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0});
  StepJob step;
  step.a.body.asset = &opened.asset;
  step.a.body.pose = pose;
  step.a.end = pose_of(rest);
  const StepContacts on_the_way = find_contacts(step);
  CHECK(!on_the_way.contacts.empty());
  CHECK(same_bits({c->step_contacts, c->step_contacts + c->step_contact_count}, on_the_way.contacts));
}

}  // namespace spherechain::test
