// SPDX-License-Identifier: MIT
// Programs and libraries of different versions: a struct that the caller fills is shorter or longer than the library's.
#include "runtime/src/base/sized.h"

#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "../../golden/clip.h"
#include "runtime/src/penetrations/rule.h"
#include "spherechain/spherechain.h"

namespace spherechain {

// A struct that got a field after 0.1.0.
struct Grown {
  std::uint32_t struct_size = sizeof(Grown), old = 0;
  std::uint64_t added = 0;
};
SPHERECHAIN_LAST_FIELD(Grown, old);

namespace test {
namespace {

constexpr sc_status kRefused{SC_BAD_VALUE, SC_FIELD_STRUCT_SIZE};

// A struct as a later version has it.
template <typename T>
struct Later {
  T known;
  std::uint64_t added = 0;
};

// The call takes the struct of a program of 0.1.0, of one that says so by 0, and of a later one that does not use what
// is new. It refuses a later one that does, and garbage.
template <typename T, typename Call>
void check_versions(const T& good, const Call& call) {
  Later<T> later{good};
  for (const std::size_t size : {sizeof(T), std::size_t{0}, sizeof(Later<T>)}) {
    later.known = good;
    later.known.struct_size = static_cast<std::uint32_t>(size);
    CHECK(call(&later.known) == SC_OK);
  }
  later.known = good;
  later.known.struct_size = sizeof(Later<T>);
  later.added = std::uint64_t{1} << 63;
  CHECK(call(&later.known) == kRefused);
  for (const std::size_t size : {std::size_t{4}, sizeof(T) - 1, std::size_t{4097}, std::size_t{0xFFFFFFFF}}) {
    later.known.struct_size = static_cast<std::uint32_t>(size);
    CHECK(call(&later.known) == kRefused);
  }
}

}  // namespace

TEST_CASE("a program that lacks a field of the library has zeros there, and nothing behind its struct is read") {
  alignas(Grown) std::uint32_t words[] = {0, 7, 8, 9};  // two of the struct, and what lies behind it
  auto* const old = reinterpret_cast<const Grown*>(words);
  for (const std::uint32_t size : {0U, 8U}) {
    words[0] = size;
    Grown own{1, 1, 1};
    REQUIRE(read_struct(old, own) == SC_OK);
    CHECK((own.struct_size == sizeof own && own.old == 7 && own.added == 0));
  }
  Grown own, now{sizeof now, 5, 6};
  REQUIRE(read_struct(&now, own) == SC_OK);
  CHECK(own.added == 6);
}

TEST_CASE("every struct that may grow is read by the size that the program states") {
  const Doll doll(DOLL_FOLDER, "doll.sphc");
  const std::vector<std::array<float, 12>> palette = matrices_at(doll.asset, 100);
  const std::vector<std::uint32_t> parents = parents_of(doll.asset);
  std::vector<Transform> joints = joints_at(doll.asset, 100);
  sc_model* model = nullptr;
  ModelDef model_def;
  model_def.data = doll.bytes.data();
  model_def.size = 8 * doll.bytes.size();
  check_versions(model_def, [&](const ModelDef* def) {
    sc_destroy_model(model);
    char message[256];
    const Status status = sc_create_model(SC_ABI_VERSION, def, &model, message, sizeof message);
    CHECK((status == SC_OK) == (message[0] == '\0'));
    return status;
  });
  REQUIRE(sc_create_model(SC_ABI_VERSION, &model_def, &model, nullptr, 0) == SC_OK);
  sc_body* body = nullptr;
  BodyDef body_def;
  body_def.finds_steps = 1;
  check_versions(body_def, [&](const BodyDef* def) {
    sc_destroy_body(body);
    return sc_create_body(model, def, &body);
  });
  REQUIRE(sc_create_body(model, &body_def, &body) == SC_OK);
  Pose pose;
  pose.bones = palette[0].data();
  pose.bone_count = palette.size();
  pose.bone_layout = SC_ROWS_3X4;
  for (int i = 0; i < 2; ++i) REQUIRE(sc_set_pose(body, &pose, nullptr) == SC_OK);

  const Query query;
  Ground ground;
  ground.up = {0, 1, 0};
  Penetrations penetrations{};
  Contacts contacts{};
  SpherePairs pairs{};
  Steps steps{};
  check_versions(query, [&](const Query* of) { return sc_find_penetrations(body, nullptr, of, &penetrations); });
  check_versions(query, [&](const Query* of) { return sc_find_contacts(body, nullptr, of, &contacts); });
  check_versions(query, [&](const Query* of) { return sc_find_sphere_pairs(body, of, &pairs); });
  check_versions(query, [&](const Query* of) { return sc_find_steps(body, nullptr, of, &steps.items, &steps.count); });
  check_versions(query, [&](const Query* of) { return sc_find_in_ground(body, &ground, of, &penetrations); });
  check_versions(ground, [&](const Ground* of) { return sc_find_in_ground(body, of, &query, &penetrations); });

  sc_response* response = nullptr;
  ResponseDef response_def;
  response_def.parents = parents.data();
  response_def.joint_count = parents.size();
  check_versions(response_def, [&](const ResponseDef* def) {
    sc_destroy_response(response);
    return sc_create_response(body, def, &response);
  });
  REQUIRE(sc_create_response(body, &response_def, &response) == SC_OK);
  ResponseFrame frame;
  ResponseState state;
  frame.joints = joints.data();
  frame.ground = &ground;
  check_versions(frame, [&](const ResponseFrame* of) {
    ResponseFrame* const out = const_cast<ResponseFrame*>(of);
    out->row_count = 99;
    const Status status = sc_respond(response, state.words, out);
    CHECK((out->row_count == 99) == (status != SC_OK));
    return status;
  });
  sc_destroy_response(response);
  sc_destroy_body(body);
  sc_destroy_model(model);

  std::vector<std::uint64_t> scratch(sc_crowd_scratch_words(&doll.asset, 1));
  CrowdJob crowd;
  crowd.asset = &doll.asset;
  crowd.pose = pose;
  crowd.scratch = scratch.data();
  crowd.scratch_words = scratch.size();
  check_versions(crowd, [&](const CrowdJob* of) { return const_cast<CrowdJob*>(of)->run(); });
  SceneJob scene;
  scene.scratch = scratch.data();
  scene.scratch_words = scratch.size();
  check_versions(scene, [&](const SceneJob* of) { return const_cast<SceneJob*>(of)->run(); });
}

TEST_CASE("a rule whose reserved fields are set is refused") {
  Rule rule = sc_default_rule();
  rule.reserved[3] = 1;
  CHECK(check_rule(&rule) == sc_status{SC_BAD_VALUE, SC_FIELD_RULE});
}

}  // namespace test
}  // namespace spherechain
