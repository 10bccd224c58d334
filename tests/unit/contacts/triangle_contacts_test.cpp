// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's triangle contacts of a baked body in motion, against CGAL's intersections of the same positions.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "moving_human.h"
#include "truth/intersections.h"
#include "truth/truth.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

using Pairs = std::vector<TrianglePair>;

// CGAL's, less what the runtime leaves out.
Pairs expected_contacts(const MovingHuman& human, const std::vector<float>& positions, const Asset& asset) {
  static const baker::Surface surface = baker::surface_of(asset, human.bake.character);
  static const std::vector<baker::TrianglePair> rest = baker::find_intersections(surface, human.rest_positions()).pairs;
  const baker::FrameTruth truth = baker::judge(baker::find_intersections(surface, positions), rest, surface, asset);
  Pairs out;
  for (const auto& pair : truth.pairs) out.push_back({pair.a, pair.b});
  return out;
}

struct Found {
  Status status;
  Pairs pairs;
  std::vector<TriangleContact> contacts;
  std::vector<SphereContact> sphere_contacts;
};

// Runs twice: to count, then with buffers of exactly that many.
Found run(TriangleContactJob job) {
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(*job.asset));
  TriangleContactContext context{{words.data(), words.size()}};
  job.context = &context;
  REQUIRE(job.run() == Status::kOk);
  Found found;
  found.pairs.resize(job.pair_count);
  found.contacts.resize(job.pair_count);
  found.sphere_contacts.resize(job.sphere_contact_count);
  job.pairs = {found.pairs.data(), found.pairs.size()};
  job.contacts = {found.contacts.data(), found.contacts.size()};
  job.sphere_contacts = {found.sphere_contacts.data(), found.sphere_contacts.size()};
  found.status = job.run();
  return found;
}

TriangleContactJob job_of(const Asset& asset, const std::vector<float>& positions) {
  TriangleContactJob job;
  job.asset = &asset;
  job.positions = positions.data();
  job.vertex_count = positions.size() / 3;
  return job;
}

}  // namespace

TEST_CASE("the contacts of a body in motion are CGAL's: none missing, none extra") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  std::size_t total = 0;
  for (const auto& [name, deformation] : human.frames()) {
    CAPTURE(name);
    const std::vector<float> positions = human.deformed(deformation);
    const Pairs expected = expected_contacts(human, positions, asset);
    total += expected.size();
    const Found found = run(job_of(asset, positions));
    REQUIRE(found.status == Status::kOk);
    CHECK(found.pairs == expected);
  }
  CHECK(total > 1000);
}
