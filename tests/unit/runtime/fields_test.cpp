// SPDX-License-Identifier: MIT
// Inputs that each job refuses: the status names the field, and nothing is written. tests/fuzz makes many more such
// calls.
#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <string>

#include "crowds.h"
#include "jobs.h"
#include "owned_filter.h"
#include "palette.h"
#include "random_poses.h"
#include "tiny_skin.h"

namespace spherechain::test {
namespace {

// The same memory, two bytes on.
template <typename T>
T* askew(T* data) {
  return reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(data) + 2);
}
template <typename T, typename U>
T* as(U* data) {
  return reinterpret_cast<T*>(const_cast<std::remove_const_t<U>*>(data));
}

template <typename Job>
struct Refusal {
  sc_code code;
  sc_field field;
  std::function<void(Job&)> spoil;
};

// The job as it is runs; each spoilt one is refused, and leaves the outputs as they were.
template <typename Job>
void check_each(const Job& good, const std::vector<std::uint64_t>& memory, const std::vector<Refusal<Job>>& refusals) {
  Job works = good;
  CHECK(works.run() == SC_OK);
  const std::vector<std::uint64_t> before = memory;
  for (std::size_t i = 0; i < refusals.size(); ++i) {
    const Refusal<Job>& refusal = refusals[i];
    Job job = good;
    refusal.spoil(job);
    const sc_status status = job.run();
    INFO("refusal ", i, ": ", std::string(sc_code_text(status.code)), ", ", std::string(sc_field_name(status.field)));
    CHECK(status == sc_status{refusal.code, refusal.field});
    CHECK(memory == before);
  }
}

constexpr std::size_t kSceneSpheres = 20, kSceneBones = 5;

struct Scene {
  Scene() : tiny(random_band(kSceneSpheres, 1)), skin(add_bones(tiny, kSceneBones, 2)) {
    add_skin(tiny, &skin, 4);
    opened = std::make_unique<OpenedAsset>(tiny.parts);
    REQUIRE_MESSAGE(opened->status == SC_OK, opened->message);
    asset = &opened->asset;
    spheres = refit(*asset, tiny.rest, SC_RADIUS_DETECT).spheres;
    pose = pose_of(matrices, weights);
  }
  // The job's outputs lie in here.
  template <typename T>
  T* output(std::size_t words) {
    return reinterpret_cast<T*>(memory.data() + words);
  }

  TinyAsset tiny;
  TinySkin skin;
  std::unique_ptr<OpenedAsset> opened;
  const Asset* asset;
  const Asset closed{};
  std::mt19937 random{3};
  std::vector<Matrix> matrices = random_pose(kSceneBones, PoseKind::kGentle, 1, random);
  std::vector<float> weights = std::vector<float>(3, 0.5F);
  std::vector<Sphere> spheres;
  Pose pose;
  std::vector<std::uint64_t> memory = std::vector<std::uint64_t>(20000, 7);
};

// Errors of a pose's bones, whatever the job.
template <typename Job>
std::vector<Refusal<Job>> bone_refusals() {
  return {
      {SC_MISALIGNED, SC_FIELD_BONES, [](Job& j) { j.pose.bones = askew(j.pose.bones); }},
      {SC_TOO_SMALL, SC_FIELD_BONE_COUNT, [](Job& j) { --j.pose.bone_count; }},
      {SC_TOO_SMALL, SC_FIELD_BONE_COUNT, [](Job& j) { j.pose.bone_count = 0; }},
      {SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT, [](Job& j) { j.pose.bone_layout = SC_LAYOUT_UNSET; }},
      {SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT, [](Job& j) { j.pose.bone_layout = static_cast<MatrixLayout>(5); }},
      {SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT, [](Job& j) { j.pose.bone_layout = static_cast<MatrixLayout>(-1); }},
      {SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE, [](Job& j) { j.pose.bone_stride = 44; }},
      {SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE, [](Job& j) { j.pose.bone_stride = 50; }},
      {SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE,
       [](Job& j) {
         j.pose.bone_layout = SC_ROWS_4X4;
         j.pose.bone_stride = 48;
       }},
      {SC_NULL, SC_FIELD_MORPH_WEIGHTS, [](Job& j) { j.pose.morph_weights = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_MORPH_WEIGHTS, [](Job& j) { j.pose.morph_weights = askew(j.pose.morph_weights); }},
      {SC_TOO_SMALL, SC_FIELD_MORPH_WEIGHTS, [](Job& j) { --j.pose.morph_weight_count; }},
  };
}

// And with its vertices.
template <typename Job>
std::vector<Refusal<Job>> vertex_refusals() {
  return {
      {SC_MISALIGNED, SC_FIELD_VERTICES, [](Job& j) { j.pose.vertices = askew(j.pose.vertices); }},
      {SC_TOO_SMALL, SC_FIELD_VERTEX_COUNT, [](Job& j) { --j.pose.vertex_count; }},
      {SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE, [](Job& j) { j.pose.vertex_stride = 8; }},
      {SC_BAD_STRIDE, SC_FIELD_VERTEX_STRIDE, [](Job& j) { j.pose.vertex_stride = 14; }},
  };
}

template <typename Job>
std::vector<Refusal<Job>> operator+(std::vector<Refusal<Job>> l, const std::vector<Refusal<Job>>& r) {
  l.insert(l.end(), r.begin(), r.end());
  return l;
}

template <typename Job>
std::vector<Refusal<Job>> asset_refusals(const Scene& s) {
  return {{SC_NULL, SC_FIELD_ASSET, [](Job& j) { j.asset = nullptr; }},
          {SC_NOT_OPEN, SC_FIELD_ASSET, [&s](Job& j) { j.asset = &s.closed; }},
          {SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET, [](Job& j) { j.target = static_cast<Target>(99); }},
          {SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET, [](Job& j) { j.target = static_cast<Target>(-1); }}};
}

}  // namespace

TEST_CASE("a refit names what it cannot use") {
  Scene s;
  RefitJob job;
  job.asset = s.asset;
  job.pose = s.pose;
  job.spheres = s.output<Sphere>(0);
  job.sphere_capacity = kSceneSpheres;
  using R = std::vector<Refusal<RefitJob>>;
  const R common{
      {SC_BAD_VALUE, SC_FIELD_RADIUS, [](RefitJob& j) { j.radius = static_cast<Radius>(2); }},
      {SC_NULL, SC_FIELD_SPHERES, [](RefitJob& j) { j.spheres = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SPHERES, [](RefitJob& j) { j.spheres = askew(j.spheres); }},
      {SC_TOO_SMALL, SC_FIELD_SPHERES, [](RefitJob& j) { --j.sphere_capacity; }},
  };
  TinyAsset paper = s.tiny;
  paper.parts.refit = 0;
  paper.parts.moments = {};
  const OpenedAsset by_paper(paper.parts);
  TinyAsset without = random_asset(kSceneSpheres, 1);
  const OpenedAsset without_bones(without.parts);
  const R of_bones{
      {SC_NOT_IN_ASSET, SC_FIELD_BONES, [&](RefitJob& j) { j.asset = &by_paper.asset; }},
      {SC_NOT_IN_ASSET, SC_FIELD_BONES, [&](RefitJob& j) { j.asset = &without_bones.asset; }},
      {SC_ALIASED, SC_FIELD_SPHERES, [&](RefitJob& j) { j.pose.bones = s.output<float>(10); }},
      {SC_NULL, SC_FIELD_VERTICES, [](RefitJob& j) { j.pose = {}; }},
  };
  check_each(job, s.memory, asset_refusals<RefitJob>(s) + bone_refusals<RefitJob>() + common + of_bones);

  job.pose = {};
  job.pose.vertices = s.tiny.rest.data();
  job.pose.vertex_count = s.tiny.parts.vertex_count;
  const R of_vertices{
      {SC_ALIASED, SC_FIELD_SPHERES, [&](RefitJob& j) { j.pose.vertices = s.output<float>(39); }},
  };
  check_each(job, s.memory, asset_refusals<RefitJob>(s) + vertex_refusals<RefitJob>() + common + of_vertices);
}

TEST_CASE("a detection names what it cannot use") {
  Scene s;
  OwnedFilter owned(*s.asset);
  std::vector<std::uint64_t> table(detect_table_words(s.asset));
  REQUIRE(prepare_detect(s.asset, SC_RADIUS_DETECT, nullptr, table.data(), table.size()) == SC_OK);
  DetectJob job;
  job.asset = s.asset;
  job.spheres = s.spheres.data();
  job.sphere_count = kSceneSpheres;
  job.filter = &owned.filter;
  job.pairs = s.output<Pair>(0);
  job.pair_capacity = 400;
  job.bits = s.output<std::uint64_t>(500);
  job.bit_words = sc_pair_words(s.asset);
  using J = DetectJob;
  const std::vector<Refusal<J>> own{
      {SC_NULL, SC_FIELD_SPHERES, [](J& j) { j.spheres = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SPHERES, [](J& j) { j.spheres = askew(j.spheres); }},
      {SC_TOO_SMALL, SC_FIELD_SPHERES, [](J& j) { --j.sphere_count; }},
      {SC_BAD_VALUE, SC_FIELD_RADIUS, [](J& j) { j.radius = static_cast<Radius>(2); }},
      {SC_NULL, SC_FIELD_PAIRS, [](J& j) { j.pairs = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_PAIRS, [](J& j) { j.pairs = askew(j.pairs); }},
      {SC_NULL, SC_FIELD_BITS, [](J& j) { j.bits = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_BITS, [](J& j) { j.bits = askew(j.bits); }},
      {SC_BAD_VALUE, SC_FIELD_BITS, [](J& j) { ++j.bit_words; }},
      {SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS, [&](J& j) { j.table = table.data(); }},
      {SC_MISALIGNED, SC_FIELD_TABLE,
       [&](J& j) {
         j.filter = nullptr;
         j.table = askew(table.data());
       }},
      {SC_ALIASED, SC_FIELD_PAIRS, [&](J& j) { j.bits = s.output<std::uint64_t>(399); }},
      {SC_ALIASED, SC_FIELD_PAIRS, [&](J& j) { j.pairs = as<Pair>(s.spheres.data()); }},
      {SC_ALIASED, SC_FIELD_PAIRS, [&](J& j) { j.pairs = as<Pair>(owned.ignored.data()); }},
      {SC_ALIASED, SC_FIELD_BITS,
       [&](J& j) {
         j.pairs = nullptr;
         j.pair_capacity = 0;
         j.filter = nullptr;
         j.table = table.data();
         j.bits = table.data() + 8;
       }},
  };
  check_each(job, s.memory, asset_refusals<J>(s) + own);

  const auto prepare = [&](const Asset* asset, Radius radius, const Filter* filter, std::uint64_t* words,
                           std::size_t count) { return prepare_detect(asset, radius, filter, words, count); };
  std::uint64_t* const words = table.data();
  const std::size_t count = table.size();
  const std::vector<std::uint64_t> before = table;
  const Filter inside{words, sc_pair_words(s.asset)};
  CHECK(prepare(nullptr, SC_RADIUS_FIT, nullptr, words, count) == sc_status{SC_NULL, SC_FIELD_ASSET});
  CHECK(prepare(&s.closed, SC_RADIUS_FIT, nullptr, words, count) == sc_status{SC_NOT_OPEN, SC_FIELD_ASSET});
  CHECK(prepare(s.asset, static_cast<Radius>(2), nullptr, words, count) == sc_status{SC_BAD_VALUE, SC_FIELD_RADIUS});
  CHECK(prepare(s.asset, SC_RADIUS_FIT, nullptr, nullptr, count) == sc_status{SC_NULL, SC_FIELD_TABLE});
  CHECK(prepare(s.asset, SC_RADIUS_FIT, nullptr, askew(words), count) == sc_status{SC_MISALIGNED, SC_FIELD_TABLE});
  CHECK(prepare(s.asset, SC_RADIUS_FIT, nullptr, words, count - 1) == sc_status{SC_TOO_SMALL, SC_FIELD_TABLE});
  CHECK(prepare(s.asset, SC_RADIUS_FIT, &inside, words, count) == sc_status{SC_ALIASED, SC_FIELD_TABLE});
  CHECK(table == before);
}

TEST_CASE("a search for skin contacts names what it cannot use") {
  Scene s;
  OwnedFilter owned(*s.asset);
  std::vector<std::uint64_t> table(skin_table_words(s.asset));
  REQUIRE(prepare_skin(s.asset, table.data(), table.size()) == SC_OK);
  std::vector<std::uint64_t> scratch(skin_scratch_words(s.asset));
  std::vector<Pair> candidates{{0, 3}, {1, 4}, {1, 7}};
  SkinContactJob job;
  job.asset = s.asset;
  job.pose = s.pose;
  job.skin_table = table.data();
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.parts = s.output<PartContact>(0);
  job.part_capacity = 100;
  job.spheres = s.output<Pair>(1000);
  job.sphere_capacity = 300;
  job.triangles = s.output<TriangleContact>(2000);
  job.triangle_capacity = 2700;
  using J = SkinContactJob;
  const auto with_candidates = [&](auto spoil) {
    return [&candidates, spoil](J& j) {
      j.candidates = candidates.data();
      j.candidate_count = candidates.size();
      spoil(j);
    };
  };
  static const std::vector<Pair> unsorted{{1, 4}, {0, 3}}, twice{{0, 3}, {0, 3}}, turned{{4, 1}},
      past{{1, kSceneSpheres}};
  const auto bad = [](const std::vector<Pair>& list) {
    return [&list](J& j) {
      j.candidates = list.data();
      j.candidate_count = list.size();
    };
  };
  const OpenedAsset without(random_asset(kSceneSpheres, 1).parts);
  TinyAsset still = random_band(kSceneSpheres, 1);
  add_skin(still, nullptr, 4);
  const OpenedAsset of_still(still.parts);
  const std::vector<Refusal<J>> own{
      {SC_NOT_IN_ASSET, SC_FIELD_ASSET, [&](J& j) { j.asset = &without.asset; }},
      {SC_NOT_IN_ASSET, SC_FIELD_BONES, [&](J& j) { j.asset = &of_still.asset; }},
      {SC_NULL, SC_FIELD_BONES, [](J& j) { j.pose.bones = nullptr; }},
      {SC_NULL, SC_FIELD_SKIN_TABLE, [](J& j) { j.skin_table = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SKIN_TABLE, [](J& j) { j.skin_table = askew(j.skin_table); }},
      {SC_BAD_VALUE, SC_FIELD_SKIN_TABLE, [&](J& j) { j.skin_table = s.memory.data(); }},
      {SC_NULL, SC_FIELD_SCRATCH, [](J& j) { j.scratch = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SCRATCH, [](J& j) { j.scratch = askew(j.scratch); }},
      {SC_TOO_SMALL, SC_FIELD_SCRATCH, [](J& j) { --j.scratch_words; }},
      {SC_NULL, SC_FIELD_PARTS, [](J& j) { j.parts = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_PARTS, [](J& j) { j.parts = askew(j.parts); }},
      {SC_NULL, SC_FIELD_SPHERES, [](J& j) { j.spheres = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SPHERES, [](J& j) { j.spheres = askew(j.spheres); }},
      {SC_NULL, SC_FIELD_TRIANGLES, [](J& j) { j.triangles = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_TRIANGLES, [](J& j) { j.triangles = askew(j.triangles); }},
      {SC_BAD_VALUE, SC_FIELD_SCOPE, [](J& j) { j.scope = static_cast<Scope>(4); }},
      {SC_BAD_VALUE, SC_FIELD_SCOPE, [](J& j) { j.scope = static_cast<Scope>(-1); }},
      {SC_NULL, SC_FIELD_CANDIDATES, [](J& j) { j.candidate_count = 1; }},
      {SC_MISALIGNED, SC_FIELD_CANDIDATES, with_candidates([](J& j) { j.candidates = askew(j.candidates); })},
      {SC_BAD_VALUE, SC_FIELD_CANDIDATES, bad(unsorted)},
      {SC_BAD_VALUE, SC_FIELD_CANDIDATES, bad(twice)},
      {SC_BAD_VALUE, SC_FIELD_CANDIDATES, bad(turned)},
      {SC_BAD_VALUE, SC_FIELD_CANDIDATES, bad(past)},
      {SC_BAD_VALUE, SC_FIELD_SCOPE, with_candidates([](J& j) { j.scope = SC_SCOPE_ALL; })},
      {SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS, with_candidates([&](J& j) { j.filter = &owned.filter; })},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.spheres = s.output<Pair>(399); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.parts = as<PartContact>(scratch.data()); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.scratch = table.data(); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.spheres = as<Pair>(&s.matrices.back()); }},
      {SC_ALIASED, SC_FIELD_OUTPUT,
       [&](J& j) {
         j.filter = &owned.filter;
         j.spheres = as<Pair>(owned.ignored.data());
       }},
  };
  check_each(job, s.memory, asset_refusals<J>(s) + bone_refusals<J>() + own);

  job.pose = {};
  job.pose.vertices = s.tiny.rest.data();
  job.pose.vertex_count = s.tiny.parts.vertex_count;
  check_each(job, s.memory, asset_refusals<J>(s) + vertex_refusals<J>());

  const auto prepare = [&](const Asset* asset, std::uint64_t* words, std::size_t count) {
    return prepare_skin(asset, words, count);
  };
  const std::vector<std::uint64_t> before = table;
  CHECK(prepare(nullptr, table.data(), table.size()) == sc_status{SC_NULL, SC_FIELD_ASSET});
  CHECK(prepare(&s.closed, table.data(), table.size()) == sc_status{SC_NOT_OPEN, SC_FIELD_ASSET});
  CHECK(prepare(&without.asset, table.data(), table.size()) == sc_status{SC_NOT_IN_ASSET, SC_FIELD_ASSET});
  CHECK(prepare(s.asset, nullptr, table.size()) == sc_status{SC_NULL, SC_FIELD_SKIN_TABLE});
  CHECK(prepare(s.asset, askew(table.data()), table.size()) == sc_status{SC_MISALIGNED, SC_FIELD_SKIN_TABLE});
  CHECK(prepare(s.asset, table.data(), table.size() - 1) == sc_status{SC_TOO_SMALL, SC_FIELD_SKIN_TABLE});
  CHECK(table == before);
}

TEST_CASE("a step names what it cannot use") {
  Scene s;
  OwnedFilter owned(*s.asset);
  const PreparedSkin table(*s.asset);
  const std::vector<Matrix> end = random_pose(kSceneBones, PoseKind::kGentle, 1, s.random);
  std::vector<Transform> joints(kSceneBones, Transform{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}), good = joints;
  std::vector<std::uint32_t> parents{SC_NO_JOINT, 0, 1, 1, SC_NO_JOINT};
  StepJob job;
  job.a.body.asset = s.asset;
  job.a.body.pose = s.pose;
  job.a.body.skin_table = table.words.data();
  job.a.end = pose_of(end, s.weights);
  std::vector<std::uint64_t> scratch(2 * step_scratch_words(&job.a, &job.a) + 100000);
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.contacts = s.output<StepContact>(0);
  job.contact_capacity = 100;
  using J = StepJob;
  const OpenedAsset without(random_asset(kSceneSpheres, 1).parts);
  const auto other = [](J& j) -> Motion& {  // of two bodies
    j.b = j.a;
    return j.b;
  };
  const std::vector<Refusal<J>> common{
      {SC_NULL, SC_FIELD_ASSET, [](J& j) { j.a.body.asset = nullptr; }},
      {SC_NOT_OPEN, SC_FIELD_ASSET, [&](J& j) { j.a.body.asset = &s.closed; }},
      {SC_NOT_OPEN, SC_FIELD_ASSET, [&](J& j) { other(j).body.asset = &s.closed; }},
      {SC_NOT_IN_ASSET, SC_FIELD_ASSET, [&](J& j) { j.a.body.asset = &without.asset; }},
      {SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET, [](J& j) { j.target = static_cast<Target>(99); }},
      {SC_NULL, SC_FIELD_SKIN_TABLE, [](J& j) { j.a.body.skin_table = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SKIN_TABLE, [](J& j) { j.a.body.skin_table = askew(j.a.body.skin_table); }},
      {SC_BAD_VALUE, SC_FIELD_SKIN_TABLE, [&](J& j) { other(j).body.skin_table = s.memory.data(); }},
      {SC_NULL, SC_FIELD_SCRATCH, [](J& j) { j.scratch = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SCRATCH, [](J& j) { j.scratch = askew(j.scratch); }},
      {SC_TOO_SMALL, SC_FIELD_SCRATCH, [](J& j) { j.scratch_words = step_scratch_words(&j.a, nullptr) - 1; }},
      {SC_TOO_SMALL, SC_FIELD_SCRATCH, [&](J& j) { j.scratch_words = step_scratch_words(&j.a, &other(j)) - 1; }},
      {SC_NULL, SC_FIELD_CONTACTS, [](J& j) { j.contacts = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_CONTACTS, [](J& j) { j.contacts = askew(j.contacts); }},
      {SC_MISALIGNED, SC_FIELD_IGNORED_PARTS, [&](J& j) { other(j).body.ignored_parts = askew(s.memory.data()); }},
      {SC_BAD_VALUE, SC_FIELD_BLEND, [](J& j) { j.a.blend = static_cast<Blend>(3); }},
      {SC_BAD_VALUE, SC_FIELD_BLEND, [](J& j) { j.a.blend = static_cast<Blend>(-1); }},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, [](J& j) { j.a.joint_count = 65537; }},
      {SC_BAD_VALUE, SC_FIELD_TOLERANCE, [](J& j) { j.tolerance = -1; }},
      {SC_BAD_VALUE, SC_FIELD_TOLERANCE, [](J& j) { j.tolerance = 1.5F; }},
      {SC_BAD_VALUE, SC_FIELD_TOLERANCE, [](J& j) { j.tolerance = kNan; }},
      {SC_BAD_VALUE, SC_FIELD_TOLERANCE, [](J& j) { j.tolerance = kInfinity; }},
      {SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS,
       [&](J& j) {
         other(j);
         j.filter = &owned.filter;
       }},
      {SC_TOO_SMALL, SC_FIELD_IGNORED_PAIRS,
       [](J& j) {
         static const Filter empty{};
         j.filter = &empty;
       }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.contacts = as<StepContact>(scratch.data()); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.scratch = const_cast<std::uint64_t*>(table.words.data()); }},
      {SC_ALIASED, SC_FIELD_OUTPUT,
       [&](J& j) {
         j.filter = &owned.filter;
         j.contacts = as<StepContact>(owned.ignored.data());
       }},
  };
  const std::vector<Refusal<J>> of_bones{
      {SC_NULL, SC_FIELD_BONES, [](J& j) { j.a.end = {}; }},
      {SC_TOO_SMALL, SC_FIELD_BONE_COUNT, [](J& j) { --j.a.body.pose.bone_count; }},
      {SC_TOO_SMALL, SC_FIELD_BONE_COUNT, [](J& j) { --j.a.end.bone_count; }},
      {SC_BAD_VALUE, SC_FIELD_BONE_LAYOUT, [](J& j) { j.a.end.bone_layout = SC_LAYOUT_UNSET; }},
      {SC_TOO_SMALL, SC_FIELD_MORPH_WEIGHTS, [](J& j) { --j.a.end.morph_weight_count; }},
      {SC_BAD_VALUE, SC_FIELD_END,
       [&](J& j) {
         j.a.end = {};
         j.a.end.vertices = s.tiny.rest.data();
         j.a.end.vertex_count = s.tiny.parts.vertex_count;
       }},
      {SC_BAD_VALUE, SC_FIELD_MORPH_WEIGHTS,
       [](J& j) {
         static const float wild[] = {1e9F, 0, -1e9F};
         j.a.end.morph_weights = wild;
       }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.contacts = as<StepContact>(end.data()); }},
  };
  check_each(job, s.memory, common + of_bones);

  job.a.body.pose = job.a.end = {};
  job.a.blend = SC_BLEND_SLERP;
  job.a.start_joints = good.data();
  job.a.end_joints = joints.data();
  job.a.joint_count = kSceneBones;
  job.a.parents = parents.data();
  const auto spoilt = [&](auto change) {
    return [&joints, &good, change](J&) {
      joints = good;
      change(joints[3]);
    };
  };
  const std::vector<Refusal<J>> of_joints{
      {SC_NULL, SC_FIELD_JOINTS, [](J& j) { j.a.start_joints = nullptr; }},
      {SC_NULL, SC_FIELD_JOINTS, [](J& j) { j.a.end_joints = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_JOINTS, [](J& j) { j.a.end_joints = askew(j.a.end_joints); }},
      {SC_TOO_SMALL, SC_FIELD_JOINTS, [](J& j) { j.a.joint_count = 2; }},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, [&](J& j) { j.a.end = s.pose; }},
      {SC_MISALIGNED, SC_FIELD_PARENTS, [](J& j) { j.a.parents = askew(j.a.parents); }},
      {SC_BAD_VALUE, SC_FIELD_PARENTS,
       [](J& j) {
         static const std::uint32_t own[] = {SC_NO_JOINT, 1, 1, 1, 1};
         j.a.parents = own;
       }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.contacts = as<StepContact>(joints.data()); }},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, spoilt([](Transform& t) { t.translation.y = kNan; })},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, spoilt([](Transform& t) { t.scale.z = -kInfinity; })},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, spoilt([](Transform& t) { t.rotation[0] = kInfinity; })},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, spoilt([](Transform& t) { t.rotation[3] = 0; })},
      {SC_BAD_VALUE, SC_FIELD_JOINTS, spoilt([](Transform& t) {
         t.rotation[0] = 1;  // by 90 degrees, and so large
         t.scale.y = 1e9F;
       })},
  };
  check_each(job, s.memory, common + of_joints);
}

TEST_CASE("a crowd names what it cannot use") {
  Scene s;
  constexpr std::size_t kInstances = 4;
  OwnedFilter owned(*s.asset);
  const std::size_t words = sc_pair_words(s.asset) * kInstances;
  std::vector<Matrix> matrices;
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < kInstances; ++i) {
    matrices.insert(matrices.end(), s.matrices.begin(), s.matrices.end());
    spheres.insert(spheres.end(), s.spheres.begin(), s.spheres.end());
  }
  CrowdBuffers buffers(*s.asset, kInstances, 2);
  CrowdJob job = buffers.job;
  job.counts = s.output<std::uint32_t>(0);
  job.bits = s.output<std::uint64_t>(100);
  job.bit_words = words;
  job.pairs = s.output<CrowdPair>(1000);
  job.pair_capacity = 4000;
  job.ignored_pairs = owned.ignored.data();
  job.pose = s.pose;
  job.pose.bones = matrices[0].data();
  using J = CrowdJob;
  const std::vector<Refusal<J>> common{
      {SC_BAD_VALUE, SC_FIELD_INSTANCES, [](J& j) { j.instance_count = ~std::size_t{0}; }},
      {SC_BAD_VALUE, SC_FIELD_VERTICES, [&](J& j) { j.pose.vertices = s.tiny.rest.data(); }},
      {SC_BAD_VALUE, SC_FIELD_RADIUS, [](J& j) { j.radius = static_cast<Radius>(2); }},
      {SC_NULL, SC_FIELD_SCRATCH, [](J& j) { j.scratch = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_SCRATCH, [](J& j) { j.scratch = askew(j.scratch); }},
      {SC_TOO_SMALL, SC_FIELD_SCRATCH, [](J& j) { --j.scratch_words; }},
      {SC_TOO_SMALL, SC_FIELD_SCRATCH, [](J& j) { j.task_count = 3; }},
      {SC_BAD_VALUE, SC_FIELD_TASKS, [](J& j) { j.task_count = ~std::size_t{0}; }},
      {SC_NULL, SC_FIELD_COUNTS, [](J& j) { j.counts = nullptr; }},
      {SC_NULL, SC_FIELD_COUNTS,
       [](J& j) {
         j.counts = nullptr;
         j.count_capacity = 0;
       }},
      {SC_MISALIGNED, SC_FIELD_COUNTS, [](J& j) { j.counts = askew(j.counts); }},
      {SC_TOO_SMALL, SC_FIELD_COUNTS, [](J& j) { --j.count_capacity; }},
      {SC_NULL, SC_FIELD_BITS, [](J& j) { j.bits = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_BITS, [](J& j) { j.bits = askew(j.bits); }},
      {SC_BAD_VALUE, SC_FIELD_BITS, [](J& j) { --j.bit_words; }},
      {SC_NULL, SC_FIELD_PAIRS, [](J& j) { j.pairs = nullptr; }},
      {SC_MISALIGNED, SC_FIELD_PAIRS, [](J& j) { j.pairs = askew(j.pairs); }},
      {SC_MISALIGNED, SC_FIELD_IGNORED_PAIRS, [](J& j) { j.ignored_pairs = askew(j.ignored_pairs); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.bits = s.output<std::uint64_t>(1); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.pairs = as<CrowdPair>(buffers.scratch.data()); }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.counts = as<std::uint32_t>(owned.ignored.data()); }},
  };
  const std::vector<Refusal<J>> of_bones{
      {SC_BAD_VALUE, SC_FIELD_SPHERES, [&](J& j) { j.spheres = spheres.data(); }},
      {SC_BAD_STRIDE, SC_FIELD_BONE_STRIDE, [](J& j) { j.pose.bone_stride = ~std::size_t{3}; }},
      {SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](J& j) { j.instance_stride = kSceneBones * sizeof(Matrix) - 4; }},
      {SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](J& j) { j.instance_stride = kSceneBones * sizeof(Matrix) + 2; }},
      {SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](J& j) { j.instance_stride = ~std::size_t{3}; }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.counts = as<std::uint32_t>(&matrices.back()); }},
      {SC_NULL, SC_FIELD_SPHERES, [](J& j) { j.pose = {}; }},
  };
  check_each(job, s.memory, asset_refusals<J>(s) + bone_refusals<J>() + common + of_bones);

  job.pose = {};
  job.spheres = spheres.data();
  const std::vector<Refusal<J>> of_spheres{
      {SC_MISALIGNED, SC_FIELD_SPHERES, [](J& j) { j.spheres = askew(j.spheres); }},
      {SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](J& j) { j.instance_stride = kSceneSpheres - 1; }},
      {SC_BAD_STRIDE, SC_FIELD_INSTANCE_STRIDE, [](J& j) { j.instance_stride = ~std::size_t{0}; }},
      {SC_ALIASED, SC_FIELD_OUTPUT, [&](J& j) { j.counts = as<std::uint32_t>(&spheres.back()); }},
  };
  check_each(job, s.memory, asset_refusals<J>(s) + common + of_spheres);
  CHECK(sc_detect_crowd(nullptr) == SC_NULL);
}

}  // namespace spherechain::test
