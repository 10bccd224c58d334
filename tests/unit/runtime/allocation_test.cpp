// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>

#include "counting_new.h"
#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "palette.h"
#include "runtime/src/pose/pose.h"
#include "tiny_skin.h"

namespace spherechain::test {

// symbol_rules.cmake sees to malloc. body_test.cpp has the questions about a body.
TEST_CASE("no job allocates, nor does opening or binding an asset, on any target, however many bones there are") {
  for (const std::size_t bones : {9U, 300U}) {
    TinyAsset tiny = random_band(30, 1);
    for (std::size_t i = 0; i < 30; ++i) give_pivots(tiny, i, 2, static_cast<unsigned>(i));
    const TinySkin skin = add_bones(tiny, bones, 2);
    add_skin(tiny, &skin, 4);
    const OpenedAsset opened(tiny.parts);
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    const std::vector<Matrix> matrices = random_matrices(bones, 3);
    std::vector<Sphere> spheres(30);
    std::vector<Pair> pairs(435), touching(465);
    std::vector<CrowdPair> crowd_pairs(2000);
    std::vector<PartContact> parts(15);
    std::vector<TriangleContact> triangles(100000);
    std::vector<std::uint64_t> detect_table(detect_table_words(&opened.asset));
    std::vector<std::uint64_t> skin_table(skin_table_words(&opened.asset));
    std::vector<std::uint64_t> scratch(skin_scratch_words(&opened.asset));
    std::vector<std::uint32_t> joint_of_bone(bones);
    std::vector<float> gathered(12 * bones);
    std::vector<sc_bone> joints;
    for (std::size_t b = 0; b < bones; ++b) joints.push_back(sc_asset_bone(&opened.asset, b));
    OwnedFilter owned(opened.asset);
    CrowdBuffers buffers(opened.asset, 1, 2);
    RefitJob refit;
    refit.pose = pose_of(matrices);
    refit.spheres = spheres.data();
    refit.sphere_capacity = spheres.size();
    DetectJob detect;
    detect.spheres = spheres.data();
    detect.sphere_count = spheres.size();
    detect.table = detect_table.data();
    detect.pairs = pairs.data();
    detect.pair_capacity = pairs.size();
    CrowdJob crowd = buffers.job;
    crowd.pose = refit.pose;
    crowd.pairs = crowd_pairs.data();
    crowd.pair_capacity = crowd_pairs.size();
    SkinContactJob contacts;
    contacts.pose = refit.pose;
    contacts.scope = SC_SCOPE_ALL;
    contacts.skin_table = skin_table.data();
    contacts.scratch = scratch.data();
    contacts.scratch_words = scratch.size();
    contacts.parts = parts.data();
    contacts.part_capacity = parts.size();
    contacts.spheres = touching.data();
    contacts.sphere_capacity = touching.size();
    contacts.triangles = triangles.data();
    contacts.triangle_capacity = triangles.size();
    BodyContactJob meeting;
    std::vector<std::uint64_t> meeting_scratch(body_scratch_words(&opened.asset, &opened.asset));
    meeting.a.pose = meeting.b.pose = refit.pose;
    meeting.a.skin_table = meeting.b.skin_table = skin_table.data();
    meeting.scratch = meeting_scratch.data();
    meeting.scratch_words = meeting_scratch.size();
    meeting.triangles = triangles.data();
    meeting.triangle_capacity = 1000;
    BodyPenetrationJob measure;
    std::vector<std::uint64_t> measure_scratch(body_penetration_scratch_words(&opened.asset, &opened.asset, 1000));
    measure.contacts = triangles.data();
    measure.scratch = measure_scratch.data();
    measure.scratch_words = measure_scratch.size();
    StepJob step;
    std::vector<StepContact> step_contacts(15);
    std::vector<sc_transform> transforms[2];
    for (std::size_t b = 0; b < 2 * bones; ++b) {
      const float turn = b % 2 == 0 ? 0.0F : 0.3F;
      transforms[b % 2].push_back({{0, 0, 0}, {turn, 0, 0, 1}, {1, 1, 1}});
    }
    step.a.blend = SC_BLEND_SLERP;
    step.a.start_joints = transforms[0].data();
    step.a.end_joints = transforms[1].data();
    step.a.joint_count = bones;
    step.a.body.skin_table = skin_table.data();
    step.contacts = step_contacts.data();
    step.contact_capacity = step_contacts.size();
    step.a.body.asset = &opened.asset;
    std::vector<std::uint64_t> step_scratch(step_scratch_words(&step.a, nullptr));
    step.scratch = step_scratch.data();
    step.scratch_words = step_scratch.size();
    FloorJob ground;
    std::vector<std::uint64_t> ground_scratch(floor_scratch_words(&opened.asset));
    ground.up = {0, 1, 0};
    ground.scratch = ground_scratch.data();
    ground.scratch_words = ground_scratch.size();
    SceneJob scene;
    std::vector<SceneBody> scene_bodies(2);
    std::vector<std::uint64_t> scene_scratch(sc_scene_scratch_words(2));
    scene.bodies = scene_bodies.data();
    scene.body_count = 2;
    scene.scratch = scene_scratch.data();
    scene.scratch_words = scene_scratch.size();

    const std::size_t before = allocation_count();
    Asset asset, closed;
    char message[160];
    sc_status worst{SC_OK, SC_FIELD_NONE};
    const auto run = [&](sc_status status) { worst = worst == SC_OK ? status : worst; };
    run(sc_asset_open(&asset, SC_ABI_VERSION, opened.bytes.data(), opened.bytes.size(), message, sizeof message));
    refit.asset = detect.asset = crowd.asset = contacts.asset = &asset;
    run(sc_check_source(&asset, SC_WHOLE_SOURCE, tiny.rest.data(), tiny.parts.vertex_count, 12));
    run(sc_ignore_parts(&asset, owned.ignored.data(), 0, 1, 1));
    run(prepare_detect(&asset, SC_RADIUS_DETECT, &owned.filter, detect_table.data(), detect_table.size()));
    run(prepare_skin(&asset, skin_table.data(), skin_table.size()));
    run(sc_bind_joints(&asset, joints.data(), bones, SC_ROWS_3X4, joint_of_bone.data(), bones, message, 160));
    run(sc_gather_bones(&asset, joint_of_bone.data(), &refit.pose, gathered.data()));
    const Transform place{{1, 2, 3}, {0, 0, 0, 1}, {1, 1, 1}};
    run(sc_place_bones(&place, gathered.data(), bones));
    const sc_status rest = check_rest_pose(asset, refit.pose, message, 160);
    meeting.a.asset = meeting.b.asset = step.a.body.asset = &asset;
    for (const Target target : supported_targets()) {
      refit.target = detect.target = crowd.target = contacts.target = target;
      run(refit.run());
      run(detect.run());
      run(crowd.run());
      run(contacts.run());
      meeting.target = measure.target = ground.target = step.target = target;
      run(step.run());
      const sc_status met = meeting.run();
      run(met == SC_OVERFLOW ? sc_status{SC_OK, SC_FIELD_NONE} : met);
      measure.a = ground.body = meeting.a;
      measure.b = meeting.b;
      measure.contact_count = std::min<std::size_t>(meeting.triangle_count, 1000);
      run(measure.run());
      run(ground.run());
      for (SceneBody& body : scene_bodies) run(bound_body(meeting.a, body.low, body.high));
      run(scene.run());
    }
    refit.pose = {};
    refit.pose.vertices = tiny.rest.data();
    refit.pose.vertex_count = tiny.parts.vertex_count;
    run(refit.run());
    const sc_status bad = sc_asset_open(&closed, SC_ABI_VERSION, opened.bytes.data(), 2000, message, sizeof message);
    const std::size_t after = allocation_count();

    CHECK(after == before);
    CHECK(before > 0);  // the counter does count
    CHECK(worst == SC_OK);
    CHECK(rest == SC_OTHER_BIND);
    CHECK(bad == SC_CORRUPT);
    CHECK(detect.pair_count > 0);
    CHECK(crowd.pair_count > 0);
    CHECK(contacts.triangle_count > 0);
    CHECK(measure.penetration_count > 0);
    CHECK(scene.pair_count == 1);
    CHECK(step.contact_count > 0);
  }
}

}  // namespace spherechain::test
