// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime's skin contacts of a baked body in motion, against CGAL's intersections of the same positions.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>

#include "baker/truth/truth.h"
#include "moving_human.h"
#include "runtime/src/triangles/exact_triangles.h"

using namespace spherechain;
using namespace spherechain::test;

namespace {

// CGAL's, sorted into the scopes.
baker::FrameTruth truth_of(const std::vector<float>& vertices) {
  const MovingHuman& human = moving_human();
  static const std::vector<Pair> rest = baker::find_intersections(truth_surface(), human.rest).pairs;
  return baker::frame_truth(
      baker::find_intersections(truth_surface(), vertices), rest, truth_surface(),
      [&](std::uint32_t a, std::uint32_t b) { return baker::is_ignored(human.asset, a, b); },
      [](const Pair&) { return false; });
}

// The source vertices whose positions the runtime reads for a source triangle.
std::array<std::uint32_t, 3> vertices_of_triangle(std::uint32_t source_triangle) {
  static const std::map<std::uint32_t, std::array<std::uint32_t, 3>> all = [] {
    std::map<std::uint32_t, std::array<std::uint32_t, 3>> out;
    const spherechain::Surface& surface = moving_human().asset.surface();
    for (const Cluster& cluster : surface.clusters) {
      for (std::size_t t = cluster.first_triangle; t < std::size_t{cluster.first_triangle} + cluster.triangle_count;
           ++t) {
        const auto vertex = [&](std::size_t k) {
          return surface.source_vertices[surface.cluster_vertices[cluster.first_vertex + surface.corners[3 * t + k]]];
        };
        out[surface.triangles[t]] = {vertex(0), vertex(1), vertex(2)};
      }
    }
    return out;
  }();
  return all.at(source_triangle);
}

TriangleCorners corners_of(std::uint32_t source_triangle, const std::vector<float>& vertices) {
  TriangleCorners out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const float* p = &vertices[3 * std::size_t{vertices_of_triangle(source_triangle)[k]}];
    out.p[k] = {p[0], p[1], p[2]};
  }
  return out;
}

bool same_bits(const Vec3& l, const Vec3& r) { return std::memcmp(&l, &r, sizeof l) == 0; }

}  // namespace

TEST_CASE("the contacts of a body in motion are CGAL's: none missing, none extra" * doctest::test_suite("long runs")) {
  std::size_t total = 0;
  for (const auto& frame : moving_human().frames) {
    CAPTURE(frame.name);
    const std::vector<Pair> expected = truth_of(frame.vertices).pairs;
    total += expected.size();
    CHECK(triangle_pairs(run(job_of(vertices_of(frame.vertices)))) == expected);
  }
  CHECK(total > 1000);
}

TEST_CASE("from bones, and from bones and vertices, contacts are CGAL's of what the runtime skins, on every target") {
  std::size_t total = 0;
  for (const auto& unskinned : moving_human().frames) {
    CAPTURE(unskinned.name);
    const MovingHuman::Frame frame = skinned(unskinned);
    const std::vector<Pair> expected = truth_of(frame.vertices).pairs;
    total += expected.size();
    for (const Target target : supported_targets()) {
      CAPTURE(sc_target_name(target));
      for (const Pose& pose : {vertices_of(frame.vertices), bones_of(frame.palette), both_of(frame)}) {
        CHECK(triangle_pairs(run(job_of(pose, target))) == expected);
      }
    }
  }
  CHECK(total > 1000);
}

TEST_CASE("contacts of neighbours are CGAL's, from vertices and from bones, and with the others they are all" *
          doctest::test_suite("long runs")) {
  const MovingHuman& human = moving_human();
  std::size_t total = 0, within = 0;
  for (std::size_t i = 0; i < human.frames.size(); i += 6) {
    CAPTURE(human.frames[i].name);
    const MovingHuman::Frame frame = skinned(human.frames[i]);
    const baker::FrameTruth truth = truth_of(frame.vertices);
    std::vector<Pair> all;
    std::merge(truth.pairs.begin(), truth.pairs.end(), truth.neighbours.begin(), truth.neighbours.end(),
               std::back_inserter(all));
    total += truth.neighbours.size();
    for (const Target target : supported_targets()) {
      CAPTURE(sc_target_name(target));
      for (const Pose& pose : {vertices_of(frame.vertices), bones_of(frame.palette)}) {
        SkinContactJob job = job_of(pose, target);
        job.scope = SC_SCOPE_NEIGHBOURS;
        const SkinContacts found = run(job);
        CHECK(triangle_pairs(found) == truth.neighbours);
        for (const TriangleContact& contact : found.triangles) {
          const bool is_within = contact.sphere_a == contact.sphere_b;
          CHECK((is_within || baker::is_ignored(human.asset, contact.sphere_a, contact.sphere_b)));
          within += is_within ? 1 : 0;
        }
        job.scope = SC_SCOPE_ALL;
        CHECK(triangle_pairs(run(job)) == all);
      }
    }
  }
  CHECK(total > 300);
  CHECK(within > 500);
}

TEST_CASE("at rest nothing intersects that the asset does not list, whatever the scope") {
  const MovingHuman& human = moving_human();
  REQUIRE(human.asset.surface().rest_contacts.size > 0);
  for (const Scope scope : {SC_SCOPE_APART, SC_SCOPE_NEIGHBOURS, SC_SCOPE_ALL}) {
    SkinContactJob job = job_of(vertices_of(human.rest));
    job.scope = scope;
    CHECK(run(job).triangles.empty());
  }
}

TEST_CASE("a triangle contact tells whose it is and where the triangles cross") {
  const MovingHuman& human = moving_human();
  std::size_t total = 0;
  for (const auto& frame : human.frames) {
    CAPTURE(frame.name);
    for (const TriangleContact& contact : run(job_of(vertices_of(frame.vertices))).triangles) {
      ++total;
      CHECK(contact.triangle_a < contact.triangle_b);
      CHECK(contact.sphere_a == truth_surface().sphere[truth_surface().of_source[contact.triangle_a]]);
      CHECK(contact.sphere_b == truth_surface().sphere[truth_surface().of_source[contact.triangle_b]]);
      CHECK(contact.part_a == human.bake.body_parts.of_triangle[contact.triangle_a]);
      CHECK(contact.part_b == human.bake.body_parts.of_triangle[contact.triangle_b]);
      const Segment segment = crossing_segment(corners_of(contact.triangle_a, frame.vertices),
                                               corners_of(contact.triangle_b, frame.vertices));
      CHECK(same_bits(contact.from, segment.from));
      CHECK(same_bits(contact.to, segment.to));
    }
  }
  CHECK(total > 1000);
}

TEST_CASE("body parts and spheres sum up the triangles that intersect") {
  for (const auto& frame : moving_human().frames) {
    CAPTURE(frame.name);
    const SkinContacts found = run(job_of(vertices_of(frame.vertices)));
    std::map<Pair, std::vector<std::uint32_t>> parts;  // two triangles for each contact
    std::set<Pair> spheres;
    for (const TriangleContact& c : found.triangles) {
      auto& triangles = parts[{std::min(c.part_a, c.part_b), std::max(c.part_a, c.part_b)}];
      triangles.insert(triangles.end(), {c.triangle_a, c.triangle_b});
      spheres.insert({std::min(c.sphere_a, c.sphere_b), std::max(c.sphere_a, c.sphere_b)});
    }
    CHECK(found.spheres == std::vector<Pair>(spheres.begin(), spheres.end()));
    REQUIRE(found.parts.size() == parts.size());
    std::size_t at = 0;
    for (const auto& [pair, triangles] : parts) {
      const PartContact& contact = found.parts[at++];
      CHECK(Pair{contact.part_a, contact.part_b} == pair);
      CHECK(contact.triangle_pairs == triangles.size() / 2);
      Vec3 low = corners_of(triangles[0], frame.vertices).p[0], high = low;
      for (const std::uint32_t triangle : triangles) {
        for (const Vec3& p : corners_of(triangle, frame.vertices).p) {
          low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
          high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
      }
      CHECK(same_bits(contact.low, low));
      CHECK(same_bits(contact.high, high));
    }
  }
}

TEST_CASE("a list without room has the first triangles of the sorted list, and the counts are those of all") {
  const MovingHuman& human = moving_human();
  std::size_t shortened = 0;
  for (const auto& frame : human.frames) {
    CAPTURE(frame.name);
    SkinContactJob job = job_of(vertices_of(frame.vertices));
    const SkinContacts all = run(job);
    if (all.triangles.size() < 2) continue;
    ++shortened;
    std::vector<std::uint64_t> scratch(skin_scratch_words(job.asset));
    std::vector<TriangleContact> first(all.triangles.size() / 2);
    job.skin_table = human.asset.skin_table();
    job.scratch = scratch.data();
    job.scratch_words = scratch.size();
    job.triangles = first.data();
    job.triangle_capacity = first.size();
    CHECK(job.run() == SC_OVERFLOW);
    CHECK(job.triangle_count == all.triangles.size());
    CHECK(job.sphere_count == all.spheres.size());
    CHECK(job.part_count == all.parts.size());
    CHECK(std::memcmp(first.data(), all.triangles.data(), first.size() * sizeof first[0]) == 0);
  }
  CHECK(shortened > 5);
}

TEST_CASE("positions that are not finite take their own triangles out, and nothing else") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    for (const auto& frame : moving_human().frames) {
      std::vector<float> vertices = frame.vertices;
      const std::vector<Pair> sound = triangle_pairs(run(job_of(vertices_of(vertices))));
      if (sound.empty()) continue;
      for (const auto vertex : vertices_of_triangle(sound[0].a)) vertices[3 * std::size_t{vertex} + 1] = bad;
      const auto is_spoiled = [&](std::uint32_t triangle) {
        for (const Vec3& p : corners_of(triangle, vertices).p) {
          if (!std::isfinite(p.y)) return true;
        }
        return false;
      };
      std::vector<Pair> expected;
      std::copy_if(sound.begin(), sound.end(), std::back_inserter(expected),
                   [&](const Pair& pair) { return !is_spoiled(pair.a) && !is_spoiled(pair.b); });
      for (const Target target : supported_targets()) {
        CHECK(triangle_pairs(run(job_of(vertices_of(vertices), target))) == expected);
      }
    }
  }
}
