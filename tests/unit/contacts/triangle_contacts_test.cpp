// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's triangle contacts of a baked body in motion, against CGAL's intersections of the same positions.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "moving_human.h"
#include "play/play.h"
#include "spherechain/skin.h"
#include "truth/intersections.h"
#include "truth/truth.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

using Pairs = std::vector<TrianglePair>;

// CGAL's, sorted into the scopes.
baker::FrameTruth truth_of(const MovingHuman& human, const std::vector<float>& positions, const Asset& asset) {
  static const baker::TruthSurface surface = baker::surface_of(asset, human.bake.character);
  static const std::vector<TrianglePair> rest = baker::find_intersections(surface, human.rest_positions()).pairs;
  return baker::judge(baker::find_intersections(surface, positions), rest, surface,
                      [&](std::uint32_t a, std::uint32_t b) { return baker::is_ignored(asset, a, b); });
}

// Of spheres that are not ignored.
Pairs expected_contacts(const MovingHuman& human, const std::vector<float>& positions, const Asset& asset) {
  return truth_of(human, positions, asset).pairs;
}

// The source vertices whose positions the runtime reads for a source triangle.
std::array<std::uint32_t, 3> vertices_of(const Asset& asset, std::uint32_t source_triangle) {
  const spherechain::Surface& surface = asset.surface();
  for (const Leaf& leaf : surface.leaves) {
    for (std::size_t t = leaf.first_triangle; t < std::size_t{leaf.first_triangle} + leaf.triangle_count; ++t) {
      if (asset.triangles()[t] == source_triangle) {
        const auto vertex = [&](std::size_t k) {
          return surface.source_vertices[surface.leaf_vertices[leaf.first_vertex + surface.corners[3 * t + k]]];
        };
        return {vertex(0), vertex(1), vertex(2)};
      }
    }
  }
  FAIL("no such triangle");
  return {};
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

TEST_CASE(
    "from bones, and from them and vertices, the contacts are CGAL's of what the runtime skins, on every target") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  std::size_t total = 0;
  for (const auto& [name, deformation] : human.frames()) {
    CAPTURE(name);
    const std::vector<float> palette = baker::bone_palette(asset, deformation);
    SkinJob skin;
    skin.asset = &asset;
    skin.bones = {palette.data(), asset.bone_count()};
    std::vector<float> positions = human.deformed(deformation);
    skin.positions = positions.data();
    skin.vertex_count = positions.size() / 3;
    REQUIRE(skin.run() == Status::kOk);
    const Pairs expected = expected_contacts(human, positions, asset);
    total += expected.size();
    for (const Target target : supported_targets()) {
      CAPTURE(to_string(target));
      TriangleContactJob job;
      job.asset = &asset;
      job.bones = skin.bones;
      job.target = target;
      CHECK(run(job).pairs == expected);
      TriangleContactJob from_vertices = job_of(asset, positions);
      from_vertices.target = target;
      CHECK(run(from_vertices).pairs == expected);
      from_vertices.bones = skin.bones;
      CHECK(run(from_vertices).pairs == expected);
    }
  }
  CHECK(total > 1000);
}

TEST_CASE("contacts of neighbours are CGAL's, from vertices and from bones, and with the others they are all" *
          doctest::test_suite("long runs")) {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  std::size_t total = 0, within = 0;
  const auto frames = human.frames();
  for (std::size_t i = 0; i < frames.size(); i += 3) {
    CAPTURE(frames[i].name);
    const std::vector<float> palette = baker::bone_palette(asset, frames[i].deformation);
    std::vector<float> positions = human.deformed(frames[i].deformation);
    SkinJob skin;
    skin.asset = &asset;
    skin.bones = {palette.data(), asset.bone_count()};
    skin.positions = positions.data();
    skin.vertex_count = positions.size() / 3;
    REQUIRE(skin.run() == Status::kOk);
    const baker::FrameTruth truth = truth_of(human, positions, asset);
    Pairs all;
    std::merge(truth.pairs.begin(), truth.pairs.end(), truth.neighbours.begin(), truth.neighbours.end(),
               std::back_inserter(all));
    total += truth.neighbours.size();
    for (const Target target : supported_targets()) {
      CAPTURE(to_string(target));
      TriangleContactJob vertices = job_of(asset, positions), bones;
      bones.asset = &asset;
      bones.bones = skin.bones;
      for (TriangleContactJob* job : {&vertices, &bones}) {
        job->target = target;
        job->scope = ContactScope::kNeighbours;
        const Found found = run(*job);
        CHECK(found.pairs == truth.neighbours);
        for (const SphereContact& contact : found.sphere_contacts) {
          const auto [a, b] = contact.spheres;
          CHECK((a == b || baker::is_ignored(asset, a, b)));
          within += a == b ? contact.count : 0;
        }
        job->scope = ContactScope::kAll;
        CHECK(run(*job).pairs == all);
      }
    }
  }
  CHECK(total > 500);
  CHECK(within > 500);
}

TEST_CASE("at rest nothing intersects that the asset does not list, whatever the scope") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  const std::vector<float> rest = human.rest_positions();
  REQUIRE(asset.surface().rest_contacts.size > 0);
  for (const ContactScope scope : {ContactScope::kApart, ContactScope::kNeighbours, ContactScope::kAll}) {
    TriangleContactJob job = job_of(asset, rest);
    job.scope = scope;
    CHECK(run(job).pairs.empty());
  }
  std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
  TriangleContactContext context{{words.data(), words.size()}};
  TriangleContactJob job = job_of(asset, rest);
  job.context = &context;
  job.scope = static_cast<ContactScope>(3);
  CHECK(job.run() == Status::kBadArgument);
}

TEST_CASE("summaries, segments and shortened lists agree with the list of all pairs") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  std::size_t shortened = 0;
  for (const auto& [name, deformation] : human.frames()) {
    const std::vector<float> positions = human.deformed(deformation);
    const Found all = run(job_of(asset, positions));
    std::size_t counted = 0;
    for (const SphereContact& contact : all.sphere_contacts) counted += contact.count;
    CHECK(counted == all.pairs.size());
    CHECK(std::is_sorted(all.sphere_contacts.begin(), all.sphere_contacts.end()));
    float deepest = 0, deepest_of_spheres = 0;
    for (std::size_t i = 0; i < all.pairs.size(); ++i) {
      CHECK(all.contacts[i].triangles == all.pairs[i]);
      deepest = std::max(deepest, all.contacts[i].overlap.depth);
    }
    for (const SphereContact& contact : all.sphere_contacts) {
      deepest_of_spheres = std::max(deepest_of_spheres, contact.deepest.overlap.depth);
    }
    CHECK(deepest == deepest_of_spheres);
    if (all.pairs.size() < 2) continue;
    ++shortened;
    std::vector<std::uint64_t> words(TriangleContactContext::words_needed(asset));
    TriangleContactContext context{{words.data(), words.size()}};
    Pairs first(all.pairs.size() / 2);
    TriangleContactJob job = job_of(asset, positions);
    job.context = &context;
    job.pairs = {first.data(), first.size()};
    CHECK(job.run() == Status::kOverflow);
    CHECK(job.pair_count == all.pairs.size());
    CHECK(std::equal(first.begin(), first.end(), all.pairs.begin()));
  }
  CHECK(shortened > 5);
}

TEST_CASE("positions that are not finite take their own triangles out, and nothing else") {
  const MovingHuman& human = moving_human();
  const Asset asset = human.asset();
  const auto frames = human.frames();
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const auto& [name, deformation] : frames) {
      std::vector<float> positions = human.deformed(deformation);
      const Found sound = run(job_of(asset, positions));
      if (sound.pairs.empty()) continue;
      for (const auto vertex : vertices_of(asset, sound.pairs[0].a)) positions[3 * vertex + 1] = bad;
      Pairs expected;
      const auto is_touched = [&](std::uint32_t triangle) {
        for (const auto vertex : vertices_of(asset, triangle)) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!std::isfinite(positions[3 * vertex + axis])) return true;
          }
        }
        return false;
      };
      for (const TrianglePair& pair : sound.pairs) {
        if (!is_touched(pair.a) && !is_touched(pair.b)) expected.push_back(pair);
      }
      for (const Target target : supported_targets()) {
        TriangleContactJob job = job_of(asset, positions);
        job.target = target;
        CHECK(run(job).pairs == expected);
      }
    }
  }
}
