// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts between two poses, against the exact contacts of many poses on the way.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "moving_human.h"
#include "owned_filter.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

StepJob step_of(const Pose& from, const Pose& to) {
  StepJob job;
  job.a.body.asset = moving_human().asset.handle();
  job.a.body.skin_table = human_skin_table();
  job.a.body.pose = from;
  job.a.end = to;
  return job;
}

}  // namespace

TEST_CASE("steps: what poses on the way have is found, and nothing else" * doctest::test_suite("long runs")) {
  const auto& frames = moving_human().frames;
  constexpr int kPoses = 64;
  int begun = 0, ended = 0, only_between = 0, kept = 0;
  for (std::size_t f = 0; f + 1 < 24; ++f) {
    CAPTURE(f);
    const StepContacts found = run(step_of(bones_of(frames[f].palette), bones_of(frames[f + 1].palette)));
    for (int k = 0; k <= kPoses; ++k) {
      const double t = static_cast<double>(k) / kPoses;
      const std::vector<float> palette = blended(frames[f].palette, frames[f + 1].palette, t);
      for (const PartContact& part : run(job_of(bones_of(palette))).parts) {
        CAPTURE(t);
        const StepContact* const of = found.of(part.part_a, part.part_b);
        REQUIRE(of != nullptr);
        CHECK(double{of->begin} <= t + 0.01);
        CHECK(double{of->end} >= t - 0.01);
      }
    }
    for (const StepContact& of : found.contacts) {
      CAPTURE(of.begin);
      CAPTURE(of.end);
      begun += of.at_start == 0 ? 1 : 0;
      ended += of.at_end == 0 ? 1 : 0;
      only_between += of.at_start == 0 && of.at_end == 0 ? 1 : 0;
      kept += of.at_start != 0 && of.at_end != 0 ? 1 : 0;
      for (const float t : {of.begin, of.end}) {
        const std::vector<float> palette = blended(frames[f].palette, frames[f + 1].palette, double{t});
        const auto parts = run(job_of(bones_of(palette))).parts;
        CHECK(std::any_of(parts.begin(), parts.end(),
                          [&](const PartContact& p) { return p.part_a == of.part_a && p.part_b == of.part_b; }));
      }
    }
  }
  CHECK(begun > 20);
  CHECK(ended > 20);
  CHECK(only_between > 0);
  CHECK(kept > 10);
}

TEST_CASE("a step of vertices has the contacts of a step of bones that put them there") {
  const auto& frames = moving_human().frames;
  const Asset& asset = *moving_human().asset.handle();
  for (const std::size_t f : {2, 15}) {
    // So short that neither is cut into pieces, whose poses would be rounded differently.
    const std::vector<float> end = blended(frames[f].palette, frames[f + 1].palette, 0.3);
    const Pose from = bones_of(frames[f].palette), to = bones_of(end);
    const std::vector<float> starts = skin(asset, from), ends = skin(asset, to);
    const StepContacts of_bones = run(step_of(from, to));
    const StepContacts of_vertices = run(step_of(vertices_of(starts), vertices_of(ends)));
    CHECK(!of_bones.contacts.empty());
    CHECK(same_bits(of_bones.contacts, of_vertices.contacts));
  }
}

TEST_CASE("every target finds the same step contacts, bit for bit") {
  const auto& frames = moving_human().frames;
  for (const std::size_t f : {4, 9, 20}) {
    StepJob job = step_of(bones_of(frames[f].palette), bones_of(frames[f + 2].palette));
    job.target = SC_TARGET_SCALAR;
    const StepContacts expected = run(job);
    for (const Target target : supported_targets()) {
      CAPTURE(sc_target_name(target));
      job.target = target;
      CHECK(same_bits(run(job).contacts, expected.contacts));
    }
  }
}

TEST_CASE("a step played backwards has its times mirrored") {
  const auto& frames = moving_human().frames;
  std::size_t total = 0;
  for (const std::size_t f : {1, 8, 16}) {
    const Pose from = bones_of(frames[f].palette), to = bones_of(frames[f + 1].palette);
    const StepContacts found = run(step_of(from, to)), back = run(step_of(to, from));
    for (const StepContact& of : found.contacts) {
      const StepContact* const other = back.of(of.part_a, of.part_b);
      if (other == nullptr) {
        CHECK(of.end - of.begin < 0.01F);  // they but graze each other
        continue;
      }
      CHECK(other->at_start == of.at_end);
      CHECK(other->at_end == of.at_start);
      CHECK(std::abs(other->begin - (1 - of.end)) < 0.01F);
      CHECK(std::abs(other->end - (1 - of.begin)) < 0.01F);
      ++total;
    }
  }
  CHECK(total > 5);
}

TEST_CASE("spheres that a filter disables, and pairs that it ignores, touch nothing in a step") {
  const auto& frames = moving_human().frames;
  const Asset& asset = *moving_human().asset.handle();
  const auto count = static_cast<std::uint32_t>(sc_asset_get_info(&asset).sphere_count);
  StepJob job = step_of(bones_of(frames[8].palette), bones_of(frames[9].palette));
  const StepContacts all = run(job);
  OwnedFilter owned(asset);
  job.filter = &owned.filter;
  CHECK(same_bits(run(job).contacts, all.contacts));
  // All of one body part's spheres: its triangles are gone, and nobody else's contacts change.
  const auto& part_of = moving_human().bake.body_parts.of_triangle;
  for (const std::uint32_t without : {all.contacts.front().part_a, all.contacts.back().part_b}) {
    std::vector<bool> has_part(count);
    for (std::size_t t = 0; t < part_of.size(); ++t) {
      const std::uint32_t place = truth_surface().of_source[t];
      if (part_of[t] == without) has_part[truth_surface().sphere[place]] = true;
    }
    owned.ignored = ignored_pairs_of(asset);
    owned.filter.ignored = owned.ignored.data();
    for (std::uint32_t s = 0; s < count; ++s) {
      for (std::uint32_t other = 0; other < count && has_part[s]; ++other) {
        if (other != s) {
          owned.ignore(s, other);
        }
      }
    }
    const StepContacts found = run(job);
    CHECK(found.contacts.size() < all.contacts.size());
    for (const StepContact& of : found.contacts) {
      CHECK(of.part_a != without);
      CHECK(of.part_b != without);
      const StepContact* const before = all.of(of.part_a, of.part_b);
      REQUIRE(before != nullptr);
      CHECK(of.begin >= before->begin);
      CHECK(of.end <= before->end);
    }
  }
}
