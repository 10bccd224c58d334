// SPDX-License-Identifier: GPL-3.0-or-later
// Contacts between two poses, against the exact contacts of many poses on the way.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "moving_human.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

std::vector<float> blend(const std::vector<float>& from, const std::vector<float>& to, double t) {
  std::vector<float> out(from.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<float>(double{from[i]} + t * (double{to[i]} - double{from[i]}));
  }
  return out;
}

StepJob step_of(const Pose& from, const Pose& to) {
  StepJob job;
  job.a.body.asset = moving_human().asset.handle();
  job.a.body.pose = from;
  job.a.end = to;
  return job;
}

StepContacts stepped(const StepJob& job) {
  StepContacts found = find_contacts(job);
  REQUIRE(found.status == SC_OK);
  return found;
}

}  // namespace

TEST_CASE("steps: what poses on the way have is found, and nothing else") {
  const auto& frames = moving_human().frames;
  constexpr int kPoses = 64;
  int begun = 0, ended = 0, only_between = 0, kept = 0;
  for (std::size_t f = 0; f + 1 < 24; ++f) {
    CAPTURE(f);
    const StepContacts found = stepped(step_of(bones_of(frames[f].palette), bones_of(frames[f + 1].palette)));
    for (int k = 0; k <= kPoses; ++k) {
      const double t = static_cast<double>(k) / kPoses;
      const std::vector<float> palette = blend(frames[f].palette, frames[f + 1].palette, t);
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
        const std::vector<float> palette = blend(frames[f].palette, frames[f + 1].palette, double{t});
        const auto parts = run(job_of(bones_of(palette))).parts;
        CHECK(std::any_of(parts.begin(), parts.end(),
                          [&](const PartContact& p) { return p.part_a == of.part_a && p.part_b == of.part_b; }));
      }
    }
  }
  std::printf("begun %d ended %d between %d kept %d\n", begun, ended, only_between, kept);
}
