// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "counting_new.h"
#include "jobs.h"
#include "spherechain/contacts.h"
#include "spherechain/crowd.h"
#include "spherechain/refit_bones.h"
#include "tiny_moments.h"

namespace spherechain::test {

// symbol_rules.cmake sees to malloc.
TEST_CASE("open, both refits, detect, filters, contacts and crowds allocate nothing, on any target") {
  TinyAsset tiny = random_asset(60, 1);
  add_bones(tiny, 9, 2);
  const OpenedAsset opened(tiny.parts);
  std::vector<Sphere> spheres(60);
  std::vector<Pair> pairs(2000);
  std::vector<ChainPair> chain_pairs(4000);
  std::vector<std::uint64_t> words(DetectContext::words_needed(opened.asset));
  std::vector<std::uint64_t> bits(words.size()), ignored(words.size()), disabled(1);
  std::vector<float> padding(60);
  std::vector<Contact> contacts(2000);
  Filter filter{{ignored.data(), ignored.size()}, {disabled.data(), 1}, {padding.data(), padding.size()}};
  std::vector<std::uint64_t> crowd_words(CrowdContext::words_needed(opened.asset, 2));
  std::vector<CrowdPair> crowd_pairs(2000);
  std::uint32_t crowd_count = 0;
  CrowdContext crowd_context{{crowd_words.data(), crowd_words.size()}};
  DetectContext context{{words.data(), words.size()}};
  std::vector<std::uint64_t> table_words(DetectTable::words_needed(opened.asset));
  DetectTable table{{table_words.data(), table_words.size()}};
  RefitJob refit;
  refit.positions = tiny.rest.data();
  refit.vertex_count = tiny.parts.vertex_count;
  refit.spheres = {spheres.data(), spheres.size()};
  const std::vector<Matrix> matrices = random_matrices(9, 3);
  const std::vector<float> morph_weights(3, 0.5F);
  RefitBonesJob refit_bones;
  refit_bones.bones = {matrices[0].data(), matrices.size()};
  refit_bones.morph_weights = {morph_weights.data(), morph_weights.size()};
  refit_bones.spheres = refit.spheres;
  DetectJob detect;
  detect.spheres = {spheres.data(), spheres.size()};
  detect.context = &context;
  detect.pairs = {pairs.data(), pairs.size()};
  detect.bits = {bits.data(), bits.size()};
  detect.chain_pairs = {chain_pairs.data(), chain_pairs.size()};

  const std::size_t before = allocation_count();
  Asset asset;
  char message[160];
  const Status open_status = asset.open(opened.bytes.data(), opened.bytes.size(), message, sizeof message);
  const Status source_status = check_source(asset, refit.positions, refit.vertex_count);
  refit.asset = &asset;
  detect.asset = &asset;
  refit_bones.asset = &asset;
  const Status bones_status = refit_bones.run();
  const Status refit_status = refit.run();
  const Status m2_status = detect.run();
  const std::size_t m2_pairs = detect.pair_count;
  detect.method = Method::kM1;
  const Status m1_status = detect.run();
  const Status filter_status = reset_filter(asset, filter);
  const Status edit_status = ignore_regions(asset, filter, 0, 1);
  detect.filter = &filter;
  const Status table_status = prepare_detect(asset, detect.radius, &filter, table);
  Status target_status = Status::kOk;
  for (const Target target : supported_targets()) {
    for (const Method method : {Method::kM1, Method::kM2}) {
      detect.target = target;
      detect.method = method;
      detect.table = target == Target::kScalar ? nullptr : &table;
      target_status = target_status == Status::kOk ? detect.run() : target_status;
    }
  }
  ContactJob contact;
  contact.asset = &asset;
  contact.spheres = {spheres.data(), spheres.size()};
  contact.pairs = {pairs.data(), detect.pair_count};
  contact.contacts = {contacts.data(), contacts.size()};
  const Status contact_status = contact.run();
  CrowdJob crowd;
  crowd.asset = &asset;
  crowd.spheres = spheres.data();
  crowd.instance_count = 1;
  crowd.context = &crowd_context;
  crowd.task_count = 2;
  crowd.counts = {&crowd_count, 1};
  crowd.pairs = {crowd_pairs.data(), crowd_pairs.size()};
  const Status crowd_status = crowd.run();
  Asset closed;
  const Status bad_status = closed.open(opened.bytes.data(), opened.bytes.size() - 100, message, sizeof message);
  const std::size_t after = allocation_count();

  CHECK(after == before);
  CHECK(open_status == Status::kOk);
  CHECK(source_status == Status::kOk);
  CHECK(refit_status == Status::kOk);
  CHECK(bones_status == Status::kOk);
  CHECK(m2_status == Status::kOk);
  CHECK(m1_status == Status::kOk);
  CHECK(filter_status == Status::kOk);
  CHECK(edit_status == Status::kOk);
  CHECK(table_status == Status::kOk);
  CHECK(target_status == Status::kOk);
  CHECK(contact_status == Status::kOk);
  CHECK(crowd_status == Status::kOk);
  CHECK(crowd_count > 0);
  CHECK(contact.contact_count > 0);
  CHECK(bad_status == Status::kCorrupt);
  CHECK(m2_pairs > 0);
  CHECK(before > 0);  // the counter does count
}

TEST_CASE("refit by moments allocates nothing, on any target, however many bones there are") {
  for (const std::size_t bones : {9U, 300U}) {
    TinyAsset tiny = random_asset(30, 1);
    for (std::size_t i = 0; i < 30; ++i) {
      give_pivots(tiny, i, 2, static_cast<unsigned>(i));
    }
    TinySkin skin = add_bones(tiny, bones, 2);
    add_moments(tiny, skin);
    const OpenedAsset opened(tiny.parts);
    REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
    const std::vector<Matrix> matrices = random_matrices(bones, 3);
    std::vector<Sphere> spheres(30);
    RefitBonesJob from_bones;
    from_bones.asset = &opened.asset;
    from_bones.bones = {matrices[0].data(), matrices.size()};
    from_bones.spheres = {spheres.data(), spheres.size()};
    RefitJob from_vertices;
    from_vertices.asset = &opened.asset;
    from_vertices.positions = tiny.rest.data();
    from_vertices.vertex_count = tiny.parts.vertex_count;
    from_vertices.spheres = from_bones.spheres;
    const std::size_t before = allocation_count();
    Status status = from_vertices.run();
    for (const Target target : supported_targets()) {
      from_bones.target = target;
      status = status == Status::kOk ? from_bones.run() : status;
    }
    CHECK(allocation_count() == before);
    CHECK(status == Status::kOk);
  }
}

}  // namespace spherechain::test
