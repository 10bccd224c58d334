// SPDX-License-Identifier: MIT
// A game in C++. It also calls every other function: one that a shared library does not export does not link.
#include <spherechain/spherechain.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

using namespace spherechain;

namespace {

std::vector<std::uint64_t> read(const char* path) {
  std::vector<std::uint64_t> bytes;
  if (std::FILE* file = std::fopen(path, "rb")) {
    std::uint64_t word = 0;
    while (std::fread(&word, 1, sizeof word, file) > 0) {
      bytes.push_back(word);
      word = 0;
    }
    std::fclose(file);
  }
  return bytes;
}

int failed = 0;

void expect(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "stranger_cpp: %s\n", what);
    ++failed;
  }
}

void call_accessors(const Asset& asset) {
  expect(sc_asset_sphere(&asset, 0).radius > 0, "sphere");
  expect(sc_asset_part(&asset, 0).name != nullptr, "part");
  expect(sc_asset_morph_name(&asset, 0) != nullptr, "morph");
  expect(sc_asset_region_name(&asset, 0) != nullptr, "region");
  expect(sc_asset_source_buffer(&asset, 1000).vertex_count == 0, "source buffer");
  const float position[3] = {0.0F, 0.0F, 0.0F};
  expect(sc_hash_positions(position, 1, 12) != 0, "hash");
  expect(sc_check_source(&asset, SC_WHOLE_SOURCE, position, 1, 12) != SC_OK, "source");
  std::size_t targets = 0;
  expect(sc_supported_targets(&targets)[targets - 1] == SC_TARGET_SCALAR, "targets");
  expect(std::strcmp(sc_target_name(SC_TARGET_SCALAR), "scalar") == 0, "target name");
  expect(*sc_code_text(SC_NULL) != '\0' && *sc_field_name(SC_FIELD_BONES) != '\0', "texts");
}

void call_ignored_pairs(const Asset& asset) {
  const std::uint64_t* const own = sc_asset_get_info(&asset).ignored_pairs;
  std::vector<std::uint64_t> ignored(own, own + sc_pair_words(&asset));
  expect(!ignored.empty(), "pair words");
  expect(sc_ignore_parts(&asset, ignored.data(), 0, 1, 1) == SC_OK, "ignore parts");
  expect(sc_part_words(&asset) > 0, "part words");
}

std::size_t count_pairs(const Model& model, const Pose& pose) {
  Body body(model);
  expect(body.set_pose(pose) == SC_OK, "a pose");
  const SpherePairs found = body.sphere_pairs();
  expect(body.status() == SC_OK, "pairs");
  return found.total;
}

// Two boxes in one place.
void call_scene() {
  const SceneBody bodies[2] = {};
  std::uint64_t scratch[64];
  SceneJob scene;
  scene.bodies = bodies;
  scene.body_count = 2;
  scene.scratch = scratch;
  scene.scratch_words = sc_scene_scratch_words(2);
  expect(scene.scratch_words <= 64 && scene.run() == SC_OK && scene.pair_count == 1, "scene");
}

// A crowd of one.
void call_crowd(const Asset& asset, const Pose& pose, std::size_t pair_count) {
  std::vector<std::uint64_t> scratch(sc_crowd_scratch_words(&asset, 1));
  CrowdJob crowd;
  crowd.asset = &asset;
  crowd.pose = pose;
  crowd.instance_count = 1;
  crowd.scratch = scratch.data();
  crowd.scratch_words = scratch.size();
  expect(crowd.run() == SC_OK && crowd.pair_count == pair_count, "crowd");
}

void call_binding(const Asset& asset, const std::vector<Bone>& joints, const Pose& pose) {
  char message[160];
  std::vector<std::uint32_t> joint_of_bone(joints.size());
  expect(sc_bind_joints(&asset, joints.data(), joints.size(), SC_ROWS_3X4, joint_of_bone.data(), joint_of_bone.size(),
                        message, sizeof message) == SC_OK,
         message);
  std::vector<float> bones(12 * joints.size());
  expect(sc_gather_bones(&asset, joint_of_bone.data(), &pose, bones.data()) == SC_OK, "gather bones");
  const Transform still{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
  expect(sc_place_bones(&still, bones.data(), joints.size()) == SC_OK, "place bones");
}

void call_model(const Model& model) {
  expect(sc_part_words(sc_get_asset(model.handle())) > 0, "the model's asset");
  expect(model.part_count() > 0 && model.part_name(0) != nullptr && model.part(0).name != nullptr, "the model's parts");
  expect(model.part_joint(0) < model.info().bone_count, "a part's joint");
  expect(model.triangle(0).part < model.part_count(), "a triangle's part");
  expect(model.millimetres(1) > 0, "millimetres");
  expect(!is_fault(sc_classify(nullptr, nullptr)) && *sc_penetration_class_name(SC_CLASS_FOLD) != '\0', "a class");
}

// The number of contacts of body parts.
std::size_t call_body(const Model& model, const Pose& pose) {
  BodyDef def;
  def.finds_steps = 1;
  Body body(model, def), other(model);
  expect(body.set_pose(pose) == SC_OK && other.set_pose(pose, {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}) == SC_OK, "poses");
  const Contacts contacts = body.contacts();
  for (const PartContact& contact : contacts) expect(model.part_name(contact.part_a) != nullptr, "part names");
  Query query;
  query.classes = ~0U;
  expect(body.penetrations(query).count == contacts.part_count && body.status() == SC_OK, "penetrations");
  expect(body.contacts(other).part_count >= contacts.part_count && body.status() == SC_OK, "contacts of two");
  expect(body.penetrations(other, query).count > 0 && body.status() == SC_OK, "penetrations of two");
  Vec3 low, high;
  expect(body.bounds(low, high) == SC_OK && low.x < high.x, "bounds");
  Ground ground;
  ground.up = {1, 0, 0};
  ground.height = high.x;
  expect(body.below(ground, query).count > 0 && body.status() == SC_OK, "the ground");
  expect(body.sphere_pairs().sphere_count == model.info().sphere_count, "sphere pairs");
  expect(body.set_pose(pose) == SC_OK && body.steps().count >= contacts.part_count, "steps");
  return contacts.part_count;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::uint64_t> bytes = read(argc > 1 ? argv[1] : "");
  const std::size_t size = bytes.size() * sizeof bytes[0];
  Asset asset;
  char message[160];
  if (sc_asset_open(&asset, SC_ABI_VERSION, bytes.data(), size, message, sizeof message) != SC_OK) {
    std::fprintf(stderr, "stranger_cpp: %s\n", message);
    return 3;
  }
  const AssetInfo info = sc_asset_get_info(&asset);
  const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::vector<Bone> joints;
  std::vector<float> matrices;
  for (std::size_t i = 0; i < info.bone_count; ++i) {
    joints.push_back(sc_asset_bone(&asset, i));
    matrices.insert(matrices.end(), identity, identity + 12);
  }
  Pose pose;
  pose.bones = matrices.data();
  pose.bone_count = info.bone_count;
  pose.bone_layout = SC_ROWS_3X4;

  Model model(bytes.data(), size, joints.data(), joints.size(), SC_ROWS_3X4);
  expect(model && model.check_rest(pose) == SC_OK, model.message());
  if (!model) return failed;
  call_model(model);
  call_binding(asset, joints, pose);
  const std::size_t pair_count = count_pairs(model, pose);
  call_crowd(asset, pose, pair_count);
  for (std::size_t b = 0; b < info.bone_count; ++b) {  // pull the body apart
    matrices[12 * b + 3] = 0.5F * static_cast<float>(b);
  }
  const std::size_t contact_count = call_body(model, pose);
  std::printf("%zu spheres, %zu pairs, %zu pairs of body parts\n", info.sphere_count, pair_count, contact_count);

  call_accessors(asset);
  call_ignored_pairs(asset);
  call_scene();
  return failed;
}
