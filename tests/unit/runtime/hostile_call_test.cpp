// SPDX-License-Identifier: MIT
// Calls that no C++ program should make, but bindings of other languages do: each gives a status. tests/fuzz makes many
// more of them.
#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "jobs.h"
#include "spherechain/contacts.h"
#include "spherechain/crowd.h"
#include "spherechain/spherechain.h"
#include "spherechain/triangle_contacts.h"
#include "tiny_bones.h"

namespace spherechain::test {
namespace {

// The same memory, two bytes on.
template <typename T>
T* askew(T* data) {
  return reinterpret_cast<T*>(reinterpret_cast<std::uintptr_t>(data) + 2);
}

struct Scene {
  Scene() : tiny(random_asset(20, 1)), skin(add_bones(tiny, 3, 2)), opened(tiny.parts), matrices(3 * 12 + 1) {}

  TinyAsset tiny;
  TinySkin skin;
  OpenedAsset opened;
  std::vector<float> matrices, morph_weights = std::vector<float>(4);
  std::vector<Sphere> spheres = std::vector<Sphere>(21);
  std::vector<Pair> pairs = std::vector<Pair>(11, Pair{0, 1});
  std::vector<std::uint64_t> words = std::vector<std::uint64_t>(5000), bits = std::vector<std::uint64_t>(4);
  std::vector<std::uint32_t> counts = std::vector<std::uint32_t>(2);
};

// Each pointer askew in turn; the job as it is works.
template <typename Job, typename... Skew>
void check_each(const Job& good, Skew... skews) {
  Job works = good;
  CHECK(works.run() == Status::kOk);
  const auto check = [&](auto skew) {
    Job job = good;
    skew(job);
    CHECK(job.run() == Status::kMisaligned);
  };
  (check(skews), ...);
}

}  // namespace

TEST_CASE("every job refuses a misaligned buffer") {
  Scene s;
  RefitJob refit;
  refit.asset = &s.opened.asset;
  refit.positions = s.tiny.rest.data();
  refit.vertex_count = s.tiny.parts.vertex_count;
  refit.spheres = {s.spheres.data(), 20};
  check_each(
      refit, [](RefitJob& j) { j.positions = askew(j.positions); },
      [](RefitJob& j) { j.spheres.data = askew(j.spheres.data); });

  RefitBonesJob bones;
  bones.asset = refit.asset;
  bones.bones = {s.matrices.data(), 3};
  bones.morph_weights = {s.morph_weights.data(), 3};
  bones.spheres = refit.spheres;
  check_each(
      bones, [](RefitBonesJob& j) { j.bones.data = askew(j.bones.data); },
      [](RefitBonesJob& j) { j.morph_weights.data = askew(j.morph_weights.data); },
      [](RefitBonesJob& j) { j.spheres.data = askew(j.spheres.data); });

  DetectContext context{{s.words.data(), 4}}, askew_context{{askew(s.words.data()), 4}};
  const DetectTable askew_table{{askew(s.words.data()), 4}};
  DetectJob detect;
  detect.asset = refit.asset;
  detect.spheres = {s.spheres.data(), 20};
  detect.method = Method::kM1;
  detect.context = &context;
  detect.bits = {s.bits.data(), 3};
  ChainPair chain_pair{};
  detect.chain_pairs = {&chain_pair, 0};
  check_each(
      detect, [](DetectJob& j) { j.spheres.data = askew(j.spheres.data); },
      [&](DetectJob& j) { j.table = &askew_table; }, [](DetectJob& j) { j.bits.data = askew(j.bits.data); },
      [&](DetectJob& j) { j.pairs.data = askew(s.pairs.data()); },
      [](DetectJob& j) { j.chain_pairs.data = askew(j.chain_pairs.data); },
      [&](DetectJob& j) { j.context = &askew_context; });

  ContactJob contacts;
  contacts.asset = refit.asset;
  contacts.spheres = detect.spheres;
  contacts.pairs = {s.pairs.data(), 10};
  Contact contact{};
  contacts.contacts = {&contact, 0};
  check_each(
      contacts, [](ContactJob& j) { j.spheres.data = askew(j.spheres.data); },
      [](ContactJob& j) { j.pairs.data = askew(j.pairs.data); },
      [](ContactJob& j) { j.contacts.data = askew(j.contacts.data); });

  REQUIRE(s.words.size() > CrowdContext::words_needed(s.opened.asset, 1));
  CrowdContext crowd_context{{s.words.data(), s.words.size() - 1}};
  CrowdContext askew_crowd_context{{askew(s.words.data()), s.words.size() - 1}};
  CrowdJob crowd;
  crowd.asset = refit.asset;
  crowd.spheres = s.spheres.data();
  crowd.instance_count = 1;
  crowd.context = &crowd_context;
  crowd.counts = {s.counts.data(), 1};
  crowd.bits = detect.bits;
  check_each(
      crowd, [](CrowdJob& j) { j.spheres = askew(j.spheres); },
      [](CrowdJob& j) { j.counts.data = askew(j.counts.data); }, [](CrowdJob& j) { j.bits.data = askew(j.bits.data); },
      [&](CrowdJob& j) { j.context = &askew_crowd_context; },
      [&](CrowdJob& j) { j.morph_weights.data = askew(s.morph_weights.data()); });
}

TEST_CASE("a misaligned filter, and misaligned positions, are refused") {
  const Scene s;
  std::vector<std::uint64_t> ignored(4), disabled(2);
  std::vector<float> padding(21);
  const Filter good{{ignored.data(), 3}, {disabled.data(), 1}, {padding.data(), 20}};
  CHECK(check_filter(s.opened.asset, good) == Status::kOk);
  Filter filter = good;
  filter.ignored.data = askew(filter.ignored.data);
  CHECK(check_filter(s.opened.asset, filter) == Status::kMisaligned);
  filter = good;
  filter.disabled.data = askew(filter.disabled.data);
  CHECK(check_filter(s.opened.asset, filter) == Status::kMisaligned);
  filter = good;
  filter.padding.data = askew(filter.padding.data);
  CHECK(check_filter(s.opened.asset, filter) == Status::kMisaligned);
  CHECK(check_source(s.opened.asset, askew(s.tiny.rest.data()), s.tiny.parts.vertex_count) == Status::kMisaligned);
}

TEST_CASE("spheres on top of the positions they come from are refused, beside them they are not") {
  Scene s;
  std::vector<float> memory = s.tiny.rest;
  memory.resize(memory.size() + 4 * 20);
  RefitJob job;
  job.asset = &s.opened.asset;
  job.positions = memory.data();
  job.vertex_count = s.tiny.parts.vertex_count;
  const auto status_at = [&](std::size_t place) {
    job.spheres = {reinterpret_cast<Sphere*>(memory.data() + place), 20};
    return job.run();
  };
  CHECK(status_at(0) == Status::kSharedMemory);
  CHECK(status_at(s.tiny.rest.size() - 1) == Status::kSharedMemory);
  CHECK(std::memcmp(memory.data(), s.tiny.rest.data(), s.tiny.rest.size() * sizeof(float)) == 0);
  CHECK(status_at(s.tiny.rest.size()) == Status::kOk);
}

TEST_CASE("C: an asset that did not open has nothing, and says so") {
  std::vector<std::uint64_t> memory(sc_asset_size() / 8 + 1);
  const sc_asset* none = nullptr;
  CHECK(sc_asset_open(SC_ABI_VERSION, memory.data(), 8 * memory.size(), memory.data(), 0, &none, nullptr, 0) ==
        SC_TRUNCATED);
  CHECK(none == nullptr);
  const auto* closed = reinterpret_cast<const sc_asset*>(memory.data());
  sc_asset_info info;
  info.struct_size = sizeof info;
  CHECK(sc_asset_get_info(closed, &info) == SC_NOT_OPEN);
  sc_region region;
  sc_chain chain;
  sc_joint joint;
  sc_bone bone;
  CHECK(sc_asset_region(closed, 0, &region) == SC_NOT_OPEN);
  CHECK(sc_asset_chain(closed, 0, &chain) == SC_NOT_OPEN);
  CHECK(sc_asset_joint(closed, 0, &joint) == SC_NOT_OPEN);
  CHECK(sc_asset_bone(closed, 0, &bone) == SC_NOT_OPEN);
  CHECK(sc_asset_morph_name(closed, 0) == nullptr);
}

TEST_CASE("what is asked of an asset that is not open takes no words") {
  const Asset closed;
  CHECK(DetectContext::words_needed(closed) == 0);
  CHECK(DetectJob::bit_words(closed) == 0);
  CHECK(DetectTable::words_needed(closed) == 0);
  CHECK(Filter::ignored_words(closed) == 0);
  CHECK(Filter::disabled_words(closed) == 0);
  CHECK(TriangleContactContext::words_needed(closed) == 0);
  CHECK(CrowdContext::words_needed(closed, 1) == 0);
  CHECK(CrowdContext::words_needed(closed, 0) == 0);

  std::vector<std::uint64_t> memory(sc_asset_size() / 8 + 1);
  const sc_asset* none = nullptr;
  REQUIRE(sc_asset_open(SC_ABI_VERSION, memory.data(), 8 * memory.size(), memory.data(), 0, &none, nullptr, 0) ==
          SC_TRUNCATED);
  for (const sc_asset* asset : {none, reinterpret_cast<const sc_asset*>(memory.data())}) {
    CHECK(sc_detect_scratch_words(asset) == 0);
    CHECK(sc_detect_bit_words(asset) == 0);
    CHECK(sc_detect_table_words(asset) == 0);
    CHECK(sc_filter_ignored_words(asset) == 0);
    CHECK(sc_filter_disabled_words(asset) == 0);
    CHECK(sc_triangle_contact_scratch_words(asset) == 0);
    CHECK(sc_crowd_scratch_words(asset, 1) == 0);
  }
}

TEST_CASE("C: the hash of no positions is 0") {
  const float positions[6] = {1, 2, 3, 4, 5, 6};
  CHECK(sc_hash_positions(positions, 1, 12) != 0);
  CHECK(sc_hash_positions(nullptr, 1, 12) == 0);
  CHECK(sc_hash_positions(askew(positions), 1, 12) == 0);
  CHECK(sc_hash_positions(positions, 1, 8) == 0);
  CHECK(sc_hash_positions(positions, 1, 14) == 0);
}

}  // namespace spherechain::test
