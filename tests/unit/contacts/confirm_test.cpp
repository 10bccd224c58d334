// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of spheres whose skins intersect, searched for and confirmed, against the list of all triangle contacts.
#include <doctest/doctest.h>

#include <algorithm>

#include "moving_human.h"
#include "play/play.h"
#include "spherechain/confirm.h"
#include "spherechain/detect_skin.h"
#include "spherechain/filter.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

// Every two spheres, the last pair first.
std::vector<Pair> all_pairs(const Asset& asset) {
  std::vector<Pair> out;
  for (std::uint32_t b = 1; b < asset.spheres().size; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) out.push_back({a, b});
  }
  std::reverse(out.begin(), out.end());
  return out;
}

template <typename Job>
void set_pose(Job& job, const std::vector<float>& positions) {
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
}

// The spheres with a triangle contact, sorted.
template <typename SetPose>
std::vector<Pair> contact_spheres(const Asset& asset, const Filter* filter, const SetPose& set) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
  TriangleContactContext context{{words.data(), words.size()}};
  TriangleContactJob job;
  job.asset = &asset;
  job.filter = filter;
  job.context = &context;
  set(job);
  REQUIRE(job.run() == Status::kOk);
  std::vector<SphereContact> contacts(job.sphere_contact_count);
  job.sphere_contacts = {contacts.data(), contacts.size()};
  REQUIRE(job.run() == Status::kOk);
  std::vector<Pair> out;
  for (const SphereContact& contact : contacts) out.push_back(contact.spheres);
  return out;
}

// Of the candidates, in their order, those with a triangle contact, whether they are ignored or not.
template <typename SetPose>
std::vector<Pair> expected_pairs(const Asset& asset, const std::vector<Pair>& candidates, const SetPose& set) {
  std::vector<std::uint64_t> none(Filter::ignored_words(asset));
  const Filter filter{{none.data(), none.size()}, {}, {}};
  const std::vector<Pair> touching = contact_spheres(asset, &filter, set);
  std::vector<Pair> out;
  std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(out),
               [&](const Pair& pair) { return std::find(touching.begin(), touching.end(), pair) != touching.end(); });
  return out;
}

template <typename SetPose>
std::vector<Pair> confirmed_pairs(const Asset& asset, const std::vector<Pair>& candidates, Target target,
                                  const SetPose& set) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset), 0x5555555555555555U);
  TriangleContactContext context{{words.data(), words.size()}};
  ConfirmJob job;
  job.asset = &asset;
  job.target = target;
  job.context = &context;
  job.candidates = {candidates.data(), candidates.size()};
  set(job);
  REQUIRE(job.run() == Status::kOk);
  std::vector<Pair> out(job.pair_count);
  job.pairs = {out.data(), out.size()};
  REQUIRE(job.run() == Status::kOk);
  return out;
}

template <typename SetPose>
std::vector<Pair> skin_pairs(const Asset& asset, const Filter* filter, Target target, const SetPose& set) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset), 0x5555555555555555U);
  TriangleContactContext context{{words.data(), words.size()}};
  DetectSkinJob job;
  job.asset = &asset;
  job.filter = filter;
  job.target = target;
  job.context = &context;
  set(job);
  REQUIRE(job.run() == Status::kOk);
  std::vector<Pair> out(job.pair_count);
  job.pairs = {out.data(), out.size()};
  REQUIRE(job.run() == Status::kOk);
  return out;
}

}  // namespace

TEST_CASE("the skin's pairs are the spheres of all triangle contacts, from vertices and from bones, on every target") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  std::size_t total = 0;
  for (const auto& [name, deformation] : human.frames()) {
    CAPTURE(name);
    const std::vector<float> positions = human.deformed(deformation), palette = baker::bone_palette(asset, deformation);
    const auto by_vertices = [&](auto& job) { set_pose(job, positions); };
    const auto by_bones = [&](auto& job) { job.bones = {palette.data(), asset.bone_count()}; };
    const auto by_both = [&](auto& job) {
      by_vertices(job);
      by_bones(job);
    };
    const std::vector<Pair> expected = contact_spheres(asset, nullptr, by_vertices),
                            expected_of_bones = contact_spheres(asset, nullptr, by_bones);
    total += expected.size();
    for (const Target target : supported_targets()) {
      CAPTURE(to_string(target));
      CHECK(skin_pairs(asset, nullptr, target, by_vertices) == expected);
      CHECK(skin_pairs(asset, nullptr, target, by_bones) == expected_of_bones);
      CHECK(skin_pairs(asset, nullptr, target, by_both) == expected);
    }
  }
  CHECK(total > 20);
}

TEST_CASE("the skin's pairs heed a filter's ignored pairs and its disabled spheres") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  const auto frames = human.frames();
  const std::vector<float> positions = human.deformed(frames.back().deformation);
  const auto set = [&](auto& job) { set_pose(job, positions); };
  std::vector<std::uint64_t> ignored(Filter::ignored_words(asset)), disabled(Filter::disabled_words(asset));
  Filter filter{{ignored.data(), ignored.size()}, {disabled.data(), disabled.size()}, {}};
  std::vector<Pair> expected = skin_pairs(asset, nullptr, Target::kBest, set);
  REQUIRE(expected.size() > 2);
  REQUIRE(reset_filter(asset, filter) == Status::kOk);
  CHECK(skin_pairs(asset, &filter, Target::kBest, set) == expected);
  const Pair first = expected[0], last = expected.back();
  REQUIRE(ignore_pair(asset, filter, first.a, first.b) == Status::kOk);
  REQUIRE(disable_sphere(asset, filter, last.b) == Status::kOk);
  expected.erase(std::remove_if(expected.begin(), expected.end(),
                                [&](const Pair& p) { return p == first || p.a == last.b || p.b == last.b; }),
                 expected.end());
  CHECK(skin_pairs(asset, &filter, Target::kBest, set) == expected);
}

TEST_CASE("a search of the skin's pairs without room writes the first ones and says how much it needs") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  const auto frames = human.frames();
  const std::vector<float> positions = human.deformed(frames.back().deformation);
  const auto set = [&](auto& job) { set_pose(job, positions); };
  const std::vector<Pair> expected = contact_spheres(asset, nullptr, set);
  REQUIRE(expected.size() > 1);
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
  TriangleContactContext context{{words.data(), words.size()}};
  std::vector<Pair> out(expected.size() - 1);
  DetectSkinJob job;
  job.asset = &asset;
  job.context = &context;
  job.pairs = {out.data(), out.size()};
  set(job);
  CHECK(job.run() == Status::kOverflow);
  CHECK(job.pair_count == expected.size());
  CHECK(std::equal(out.begin(), out.end(), expected.begin()));
  job.pair_count = 77;
  job.pairs = {reinterpret_cast<Pair*>(words.data()), 1};
  CHECK(job.run() == Status::kSharedMemory);
  context.words.size -= 1;
  CHECK(job.run() == Status::kContextTooSmall);
  CHECK(job.pair_count == 77);
}

TEST_CASE("confirmed are the pairs of spheres with a triangle contact, from vertices and from bones, on every target") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  const std::vector<Pair> every = all_pairs(asset);
  std::size_t total = 0;
  for (const auto& [name, deformation] : human.frames()) {
    CAPTURE(name);
    const std::vector<float> positions = human.deformed(deformation), palette = baker::bone_palette(asset, deformation);
    const auto by_vertices = [&](auto& job) { set_pose(job, positions); };
    const auto by_bones = [&](auto& job) { job.bones = {palette.data(), asset.bone_count()}; };
    const auto by_both = [&](auto& job) {
      by_vertices(job);
      by_bones(job);
    };
    const std::vector<Pair> expected = expected_pairs(asset, every, by_vertices),
                            expected_of_bones = expected_pairs(asset, every, by_bones);
    total += expected.size();
    for (const Target target : supported_targets()) {
      CAPTURE(to_string(target));
      CHECK(confirmed_pairs(asset, every, target, by_vertices) == expected);
      CHECK(confirmed_pairs(asset, every, target, by_bones) == expected_of_bones);
      CHECK(confirmed_pairs(asset, every, target, by_both) == expected);
    }
    // Whatever else is asked about.
    for (const Pair& pair : expected) CHECK(confirmed_pairs(asset, {pair}, Target::kBest, by_vertices).size() == 1);
  }
  CHECK(total > 100);
}

TEST_CASE("a confirmation without room says how much it needs; candidates that are no two spheres are refused") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  const auto frames = human.frames();
  const std::vector<float> positions = human.deformed(frames.back().deformation);
  const auto set = [&](auto& job) { set_pose(job, positions); };
  std::vector<Pair> candidates = all_pairs(asset);
  const std::vector<Pair> expected = expected_pairs(asset, candidates, set);
  REQUIRE(expected.size() > 1);
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
  TriangleContactContext context{{words.data(), words.size()}};
  std::vector<Pair> out(expected.size() - 1);
  ConfirmJob job;
  job.asset = &asset;
  job.context = &context;
  job.candidates = {candidates.data(), candidates.size()};
  job.pairs = {out.data(), out.size()};
  set(job);
  CHECK(job.run() == Status::kOverflow);
  CHECK(job.pair_count == expected.size());
  CHECK(std::equal(out.begin(), out.end(), expected.begin()));

  job.pair_count = 77;
  const auto status_of = [&](Pair bad) {
    candidates.back() = bad;
    return job.run();
  };
  CHECK(status_of({3, 3}) == Status::kBadArgument);
  CHECK(status_of({0, static_cast<std::uint32_t>(asset.spheres().size)}) == Status::kBadArgument);
  CHECK(job.pair_count == 77);
  job.candidates = {};
  CHECK(job.run() == Status::kOk);
  CHECK(job.pair_count == 0);
  job.pairs = {reinterpret_cast<Pair*>(words.data()), 1};
  CHECK(job.run() == Status::kSharedMemory);
}
