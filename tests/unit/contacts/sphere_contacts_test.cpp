// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs of spheres whose skins intersect, searched for or confirmed among candidates, against the list of all
// triangles.
#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>

#include "moving_human.h"
#include "owned_filter.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

std::vector<Pair> every_pair() {
  std::vector<Pair> out;
  const std::size_t count = moving_human().asset->spheres().size;
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) out.push_back({a, b});
  }
  return out;
}

// Ignores nothing.
const Filter& empty_filter() {
  static std::vector<std::uint64_t> words(sc_pair_words(moving_human().asset.handle()));
  static Filter filter;
  filter.ignored = words.data();
  filter.ignored_words = words.size();
  return filter;
}

SkinContacts all_contacts(const Pose& pose, const Filter* filter) {
  SkinContactJob job = job_of(pose);
  job.filter = filter;
  return run(job);
}

std::vector<Pair> spheres_only(const Pose& pose, Target target = SC_TARGET_BEST, const Filter* filter = nullptr) {
  SkinContactJob job = job_of(pose, target);
  job.spheres_only = 1;
  job.filter = filter;
  return run(job).spheres;
}

std::vector<Pair> confirmed(const Pose& pose, const std::vector<Pair>& candidates, Target target = SC_TARGET_BEST) {
  SkinContactJob job = job_of(pose, target);
  job.spheres_only = 1;
  job.candidates = candidates.data();
  job.candidate_count = candidates.size();
  return run(job).spheres;
}

// A job with memory of its own that lists as many pairs of spheres as `out` has room for.
struct ShortJob : SkinContactJob {
  ShortJob(const SkinContactJob& job, std::vector<Pair>& out)
      : SkinContactJob(job), memory(skin_scratch_words(job.asset)) {
    skin_table = moving_human().asset.skin_table();
    scratch = memory.data();
    scratch_words = memory.size();
    spheres = out.data();
    sphere_capacity = out.size();
    spheres_only = 1;
  }
  std::vector<std::uint64_t> memory;
};

}  // namespace

TEST_CASE("pairs of spheres alone are those of all triangle contacts, from each kind of pose, on every target") {
  std::size_t total = 0;
  for (const auto& frame : moving_human().frames) {
    CAPTURE(frame.name);
    const std::vector<Pair> expected = all_contacts(vertices_of(frame.vertices), nullptr).spheres;
    const std::vector<Pair> expected_of_bones = all_contacts(bones_of(frame.palette), nullptr).spheres;
    total += expected.size();
    for (const Target target : supported_targets()) {
      CAPTURE(sc_target_name(target));
      CHECK(spheres_only(vertices_of(frame.vertices), target) == expected);
      CHECK(spheres_only(bones_of(frame.palette), target) == expected_of_bones);
      CHECK(spheres_only(both_of(frame), target) == expected);
    }
  }
  CHECK(total > 20);
}

TEST_CASE("pairs of spheres heed a filter's ignored pairs") {
  const sc_asset* asset = moving_human().asset.handle();
  const Pose pose = vertices_of(moving_human().frames.back().vertices);
  OwnedFilter owned(*asset);
  std::vector<Pair> expected = spheres_only(pose);
  REQUIRE(expected.size() > 2);
  CHECK(spheres_only(pose, SC_TARGET_BEST, &owned.filter) == expected);
  const Pair first = expected[0];
  owned.ignore(first.a, first.b);
  expected.erase(expected.begin());
  CHECK(spheres_only(pose, SC_TARGET_BEST, &owned.filter) == expected);
  CHECK(all_contacts(pose, &owned.filter).spheres == expected);
}

TEST_CASE("candidates are confirmed where triangles of the two spheres intersect, ignored or not, on every target") {
  const std::vector<Pair> every = every_pair();
  std::size_t total = 0;
  for (const auto& frame : moving_human().frames) {
    CAPTURE(frame.name);
    const Pose vertices = vertices_of(frame.vertices), bones = bones_of(frame.palette);
    const std::vector<Pair> expected = all_contacts(vertices, &empty_filter()).spheres;
    const std::vector<Pair> expected_of_bones = all_contacts(bones, &empty_filter()).spheres;
    total += expected.size();
    for (const Target target : supported_targets()) {
      CAPTURE(sc_target_name(target));
      CHECK(confirmed(vertices, every, target) == expected);
      CHECK(confirmed(bones, every, target) == expected_of_bones);
      CHECK(confirmed(both_of(frame), every, target) == expected);
    }
    // Whatever else is asked about.
    for (const Pair& pair : expected) CHECK(confirmed(vertices, {pair}) == std::vector<Pair>{pair});
  }
  CHECK(total > 100);
}

TEST_CASE("triangles of candidates are those of all triangles that belong to them") {
  const std::vector<Pair> every = every_pair();
  std::vector<Pair> candidates;
  for (std::size_t i = 0; i < every.size(); i += 2) candidates.push_back(every[i]);
  std::size_t total = 0;
  for (const auto& frame : moving_human().frames) {
    CAPTURE(frame.name);
    std::vector<Pair> expected;
    for (const TriangleContact& c : all_contacts(both_of(frame), &empty_filter()).triangles) {
      const Pair spheres{std::min(c.sphere_a, c.sphere_b), std::max(c.sphere_a, c.sphere_b)};
      if (std::binary_search(candidates.begin(), candidates.end(), spheres)) {
        expected.push_back({c.triangle_a, c.triangle_b});
      }
    }
    total += expected.size();
    SkinContactJob job = job_of(both_of(frame));
    job.candidates = candidates.data();
    job.candidate_count = candidates.size();
    CHECK(triangle_pairs(run(job)) == expected);
  }
  CHECK(total > 500);
}

TEST_CASE("a list without room has the first pairs of spheres, and the count says how many there are") {
  const std::vector<Pair> every = every_pair();
  SkinContactJob search = job_of(vertices_of(moving_human().frames.back().vertices)), confirmation = search;
  confirmation.candidates = every.data();
  confirmation.candidate_count = every.size();
  for (SkinContactJob job : {search, confirmation}) {
    job.spheres_only = 1;
    const std::vector<Pair> expected = run(job).spheres;
    REQUIRE(expected.size() > 1);
    std::vector<Pair> out(expected.size() - 1);
    ShortJob short_job(job, out);
    CHECK(short_job.run() == SC_OVERFLOW);
    CHECK(short_job.sphere_count == expected.size());
    CHECK(std::equal(out.begin(), out.end(), expected.begin()));
  }
}

TEST_CASE("candidates that are no two spheres, or are not sorted, are refused; none is an answer of none") {
  const auto last = static_cast<std::uint32_t>(moving_human().asset->spheres().size - 1);
  const std::vector<Pair> sound{{0, 1}, {0, 2}, {1, 2}};
  std::vector<Pair> out(4);
  const auto status_of = [&](std::vector<Pair> candidates) {
    SkinContactJob job = job_of(vertices_of(moving_human().rest));
    job.candidates = candidates.data();
    job.candidate_count = candidates.size();
    ShortJob run(job, out);
    run.sphere_count = 77;
    const Status status = run.run();
    CHECK((status == SC_OK) == (run.sphere_count != 77));
    return status;
  };
  const Status bad{SC_BAD_VALUE, SC_FIELD_CANDIDATES};
  CHECK(status_of(sound) == SC_OK);
  CHECK(status_of({{3, 3}}) == SC_OK);
  CHECK(status_of({{2, 1}}) == bad);
  CHECK(status_of({{0, last + 1}}) == bad);
  CHECK(status_of({{0, 2}, {0, 1}}) == bad);
  CHECK(status_of({{0, 1}, {0, 1}}) == bad);
  SkinContactJob none = job_of(vertices_of(moving_human().frames.back().vertices));
  none.candidates = sound.data();
  CHECK(run(none).triangles.empty());
}
