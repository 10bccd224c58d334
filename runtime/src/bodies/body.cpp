// SPDX-License-Identifier: MIT
// A body's memory, and its pose.
#include "runtime/src/bodies/body.h"

#include <algorithm>
#include <new>

#include "runtime/src/base/pair_bits.h"
#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/clusters/set_up.h"
#include "runtime/src/gaps/gaps.h"
#include "runtime/src/inside/inside_job.h"
#include "runtime/src/penetrations/measure.h"
#include "runtime/src/step/step_job.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_body_def, allocator);

namespace {

constexpr std::size_t kTrianglesMin = 4096;  // pairs that there is room for, at least
constexpr std::size_t kPenetrations = 128;
constexpr std::size_t kPairsOfSphere = 16;  // a sphere touches so many others at most, in the mean of all

// The most that any question about this model needs, alone or with the other.
std::size_t scratch_words_of(const sc_model& model, const sc_model& other, std::size_t max_triangles,
                             bool finds_steps) {
  const AssetView &a = view_of(model.asset), &b = view_of(other.asset);
  std::size_t words = std::max({inside_scratch_words(a, a), inside_scratch_words(a, b), inside_scratch_words(b, a),
                                gap_scratch_words(a, b), gap_scratch_words(b, a), skin_scratch_words(a),
                                body_scratch_words(a, b), body_scratch_words(b, a),
                                measure_words(a, a, true, max_triangles), measure_words(a, b, false, max_triangles),
                                measure_words(b, a, false, max_triangles), floor_scratch_words(&model.asset)});
  if (finds_steps) {
    Motion of_a{}, of_b{};
    of_a.body.asset = &model.asset;
    of_b.body.asset = &other.asset;
    of_a.body.pose.vertices = of_b.body.pose.vertices = reinterpret_cast<const float*>(&words);  // with vertices or not
    words = std::max({words, step_scratch_words(&of_a, nullptr), step_scratch_words(&of_a, &of_b)});
  }
  return words;
}

// Lays out the body's arrays in `words`. If `words` is null, it only counts them.
std::size_t lay_out(sc_body& body, const sc_body_def& def, std::uint64_t* words) {
  WordMemory memory(words);
  const AssetView& asset = asset_of(body);
  const sc_model& other = def.largest_other == nullptr ? *body.model : *def.largest_other;
  const std::size_t spheres = asset.spheres().size, count = asset.part_count(),
                    parts = std::max(count * (count + 1) / 2, count * view_of(other.asset).part_count());
  const std::size_t max_triangles =
      def.max_triangles > 0 ? def.max_triangles : std::max(kTrianglesMin, asset.skin().sizes.triangles / 2);
  sc_body* self = nullptr;
  memory.take(self, 1);
  for (GivenPose* given : {&body.now, &body.before}) {
    memory.take(given->bones, 12 * asset.bone_count());
    memory.take(given->morph_weights, asset.morph_count());
  }
  memory.take(body.spheres, spheres);
  memory.take(body.sphere_pairs, std::min(spheres * (spheres - 1) / 2, kPairsOfSphere * spheres));
  memory.take(body.parts, parts);
  memory.take(body.contact_spheres, max_triangles);
  memory.take(body.triangles, max_triangles);
  memory.take(body.part_pairs, words_for(parts));
  memory.take(body.inside[0], probe_count(asset));
  memory.take(body.inside[1], probe_count(view_of(other.asset)));
  memory.take(body.other_spheres, view_of(other.asset).spheres().size);
  for (Span<sc_penetration>& list : body.penetrations) {
    memory.take(list, def.max_penetrations > 0 ? def.max_penetrations : kPenetrations);
  }
  memory.take(body.steps, def.finds_steps != 0 ? parts : 0);
  body.scratch_words = scratch_words_of(*body.model, other, max_triangles, def.finds_steps != 0);
  memory.take(body.scratch, body.scratch_words);
  return memory.used();
}

Status gather(sc_body& body, const sc_pose& pose, const sc_transform* place, bool in_asset_order, GivenPose& given) {
  const AssetView& asset = asset_of(body);
  given.pose = pose;
  if (pose.bones != nullptr) {
    const Status status = in_asset_order
                              ? check_bones(asset, pose)
                              : sc_gather_bones(&body.model->asset, body.model->joint_of_bone, &pose, given.bones);
    if (status != SC_OK) {
      return status;
    }
    if (in_asset_order) {
      const BoneMatrices from = matrices_of(pose);
      for (std::size_t i = 0; i < 12 * asset.bone_count(); ++i) {
        given.bones[i] = from.data[i / 12 * from.stride + i % 12 / 4 * from.row + i % 4 * from.column];
      }
    }
    given.pose.bones = given.bones;
    given.pose.bone_count = asset.bone_count();
    given.pose.bone_layout = SC_ROWS_3X4;
    given.pose.bone_stride = 0;
  }
  const Status status = check_skin_pose(asset, given.pose);
  if (status != SC_OK) {
    return status;
  }
  if (given.pose.morph_weights != nullptr) {
    std::copy_n(pose.morph_weights, asset.morph_count(), given.morph_weights);
    given.pose.morph_weights = given.morph_weights;
    given.pose.morph_weight_count = asset.morph_count();
  }
  if (place == nullptr) {
    return done();
  }
  return pose.vertices != nullptr ? refuse(SC_BAD_VALUE, SC_FIELD_TRANSFORM)
                                  : sc_place_bones(place, given.bones, asset.bone_count());
}

}  // namespace

Status take_pose(sc_body& body, const sc_pose& pose, const sc_transform* place, bool in_asset_order) {
  std::swap(body.now, body.before);
  body.has_contacts = body.has_spheres = false;
  const Status status = gather(body, pose, place, in_asset_order, body.now);
  body.now.is_given = status == SC_OK;
  return status;
}

}  // namespace spherechain

using namespace spherechain;

extern "C" {

sc_status sc_create_body(const sc_model* model, const sc_body_def* def, sc_body** body) noexcept {
  if (body != nullptr) {
    *body = nullptr;
  }
  if (model == nullptr || body == nullptr) {
    return refuse(SC_NULL, model == nullptr ? SC_FIELD_ASSET : SC_FIELD_OUTPUT);
  }
  sc_body_def wanted{};
  const Status known = def == nullptr ? done() : read_struct(def, wanted);
  if (known != SC_OK) {
    return known;
  }
  constexpr std::size_t kCountMax = std::size_t{1} << 31;
  if (wanted.max_triangles > kCountMax || wanted.max_penetrations > kCountMax) {
    return refuse(SC_BAD_VALUE, SC_FIELD_TRIANGLES);
  }
  sc_body made{};
  made.model = model;
  const Status complete = choose_allocator(wanted.allocator, model->allocator, made.allocator);
  if (complete != SC_OK) {
    return complete;
  }
  if (!made.block.allocate(made.allocator, lay_out(made, wanted, nullptr))) {
    return refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  }
  lay_out(made, wanted, made.block.words);
  *body = new (made.block.words) sc_body(made);
  return done();
}

void sc_destroy_body(sc_body* body) noexcept {
  if (body != nullptr) {
    Block block = body->block;
    const sc_allocator allocator = body->allocator;
    block.release(allocator);
  }
}

sc_status sc_set_pose(sc_body* body, const sc_pose* pose, const sc_transform* place) noexcept {
  if (body == nullptr || pose == nullptr) {
    return refuse(SC_NULL, body == nullptr ? SC_FIELD_BODIES : SC_FIELD_BONES);
  }
  return take_pose(*body, *pose, place, body->model->joint_of_bone == nullptr);
}

sc_status sc_get_bounds(const sc_body* body, sc_vec3* low, sc_vec3* high) noexcept {
  if (body == nullptr || low == nullptr || high == nullptr) {
    return refuse(SC_NULL, body == nullptr ? SC_FIELD_BODIES : SC_FIELD_OUTPUT);
  }
  if (!body->now.is_given) {
    return refuse(SC_NOT_OPEN, SC_FIELD_BODIES);
  }
  const JobBody side = side_of(*body, nullptr);
  return bound_body(side, *low, *high);
}

}  // extern "C"
