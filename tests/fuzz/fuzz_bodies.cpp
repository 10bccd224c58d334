// SPDX-License-Identifier: MIT
// Two bodies, the ground and scenes: what they find is checked where that is fast, and hostile calls are refused.
#include <algorithm>
#include <cmath>

#include "fuzz_case.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/skin/skin_table.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kBodyTriangles = 100;  // triangles: of more, all pairs take too long
constexpr std::size_t kBodyWords = std::size_t{1} << 17;
constexpr std::size_t kBodyContacts = 60;

// False where the asset has no skin, or a large one.
bool draw_body(Case& c, JobBody& body) {
  const std::size_t table_words = skin_table_words(&c.asset);
  if (table_words == 0 || table_words > kBodyWords || body_scratch_words(&c.asset, &c.asset) > kBodyWords) {
    return false;
  }
  body.asset = &c.asset;
  if (c.view().bone_count() > 0 && c.random.one_in(2)) {
    draw_bones(c, body.pose);
  } else if (!draw_vertices(c, body.pose)) {
    return false;
  }
  std::uint64_t* const table = c.arena.add<std::uint64_t>(table_words);
  c.expect(prepare_skin(&c.asset, table, table_words) == SC_OK, "a skin table is refused");
  body.skin_table = table;
  if (c.random.one_in(3)) {
    std::uint64_t* const parts = c.arena.add<std::uint64_t>(sc_part_words(&c.asset));
    for (std::size_t i = 0; i < sc_part_words(&c.asset); ++i) {
      parts[i] = c.random.up_to(~std::size_t{0} - 1);
    }
    body.ignored_parts = parts;
  }
  return true;
}

void add_body_ways(Case& c, JobBody& body, Ways& ways) {
  ways.emplace_back([&] { body.skin_table = nullptr, c.spoil(SC_NULL, SC_FIELD_SKIN_TABLE); });
  ways.emplace_back([&] { put_askew(c, body.skin_table), c.spoil(SC_MISALIGNED, SC_FIELD_SKIN_TABLE); });
  add_asset_ways(c, body.asset, ways);
  if (body.pose.bones != nullptr) {
    add_bone_ways(c, body.pose, ways);
  } else {
    add_vertex_ways(c, body.pose, ways);
  }
}

// Ways that all jobs of this file share.
template <typename Job>
void add_common_ways(Case& c, Job& job, Target& other, Ways& ways) {
  ways.emplace_back([&] { job.scratch = nullptr, c.spoil(SC_NULL, SC_FIELD_SCRATCH); });
  ways.emplace_back([&c, &job, words = job.scratch_words] {
    job.scratch_words = c.random.up_to(words - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  });
  ways.emplace_back([&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); });
}

template <typename Job>
std::function<Status()> runs(Case& c, Job& job, const Target& other) {
  return [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
}

std::vector<TriangleCorners> corners_of(const Surface& surface, const Pose& pose) {
  std::vector<TriangleCorners> out(surface.triangles.size);
  for (std::size_t t = 0; t < out.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t v = surface.source_vertices[surface.triangle_vertices[3 * t + k]];
      const float* const p = vertex_at(pose.vertices, v, vertex_stride(pose));
      out[t].p[k] = {p[0], p[1], p[2]};
    }
  }
  return out;
}

void check_contacts(Case& c, const BodyContactJob& job) {
  Surface surface;
  if (!c.expect(read_skin_table(c.view(), job.a.skin_table, surface) == SC_OK, "a skin table is not read") ||
      surface.triangles.size > kBodyTriangles || job.spheres_only != 0) {
    return;
  }
  const std::vector<TriangleCorners> a = corners_of(surface, job.a.pose), b = corners_of(surface, job.b.pose);
  const auto meets = [&](const JobBody& body, std::size_t triangle) {
    const std::size_t part = surface.parts[triangle];
    return body.ignored_parts == nullptr || (body.ignored_parts[part / 64] >> part % 64 & 1) == 0;
  };
  std::vector<Pair> expected;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) {
      if (meets(job.a, i) && meets(job.b, k) && triangles_intersect(a[i], b[k])) {
        expected.push_back({surface.triangles[i], surface.triangles[k]});
      }
    }
  }
  std::sort(expected.begin(), expected.end());
  c.expect(job.triangle_count == expected.size(), "the count of two bodies' triangles");
  for (std::size_t i = 0; i < std::min(job.triangle_capacity, expected.size()); ++i) {
    c.expect(Pair{job.triangles[i].triangle_a, job.triangles[i].triangle_b} == expected[i], "two bodies' triangles");
  }
}

void fuzz_body_contacts(Case& c) {
  BodyContactJob job;
  if (!draw_body(c, job.a) || !draw_body(c, job.b)) {
    return;
  }
  job.spheres_only = c.random.one_in(4) ? 1 : 0;
  job.scratch_words = body_scratch_words(&c.asset, &c.asset);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.sphere_capacity = c.random.below(30);
  job.spheres = c.arena.add<Pair>(job.sphere_capacity);
  job.part_capacity = c.random.below(20);
  job.parts = c.arena.add<PartContact>(job.part_capacity);
  job.triangle_capacity = c.random.below(300);
  job.triangles = c.arena.add<TriangleContact>(job.triangle_capacity);
  Target other = SC_TARGET_BEST;
  Ways ways;
  add_body_ways(c, c.random.one_in(2) ? job.a : job.b, ways);
  add_common_ways(c, job, other, ways);
  ways.emplace_back([&] { job.parts = nullptr, job.part_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PARTS); });
  ways.emplace_back([&] {
    if (job.triangle_capacity > 0 && put_over(c, job.triangles, bytes_of(job.scratch, job.scratch_words))) {
      c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
    }
  });
  spoil_some(c, ways);

  Call call;
  call.run = runs(c, job, other);
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.parts, std::min(job.part_capacity, job.part_count)),
                              bytes_of(job.spheres, std::min(job.sphere_capacity, job.sphere_count)),
                              bytes_of(job.triangles, std::min(job.triangle_capacity, job.triangle_count)),
                              bytes_of(job.scratch, job.scratch_words)};
  };
  call.tidy = [&] { std::fill_n(job.scratch, job.scratch_words, std::uint64_t{0}); };
  const Status status = run_twice(c, call);
  const bool ran = status == SC_OK || status == SC_OVERFLOW;
  if (ran && job.a.pose.bones == nullptr && job.b.pose.bones == nullptr) {
    check_contacts(c, job);
  }
}

// Runs a job that gives penetrations.
template <typename Job>
void run_measure(Case& c, Job& job, const Target& other) {
  Call call;
  call.run = runs(c, job, other);
  const auto written = [&] { return std::min(job.penetration_capacity, job.penetration_count); };
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.penetrations, written()), bytes_of(job.scratch, job.scratch_words)};
  };
  call.tidy = [&] {
    std::fill_n(job.scratch, job.scratch_words, std::uint64_t{0});
    for (std::size_t i = 0; i < written(); ++i) make_comparable(job.penetrations[i]);
  };
  run_twice(c, call);
}

template <typename Job>
void add_measure_ways(Case& c, Job& job, Ways& ways) {
  ways.emplace_back(
      [&] { job.penetrations = nullptr, job.penetration_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PENETRATIONS); });
  ways.emplace_back([&] { job.rule = &bad_rule(), c.spoil(SC_BAD_VALUE, SC_FIELD_RULE); });
}

void fuzz_body_penetrations(Case& c) {
  BodyPenetrationJob job;
  if (!draw_body(c, job.a) || !draw_body(c, job.b)) {
    return;
  }
  Surface surface;
  c.expect(read_skin_table(c.view(), job.a.skin_table, surface) == SC_OK, "a skin table is not read");
  job.contact_count = c.random.below(kBodyContacts);
  TriangleContact* const contacts = c.arena.add<TriangleContact>(job.contact_count);
  for (std::size_t i = 0; i < job.contact_count; ++i) {
    contacts[i].triangle_a = surface.triangles[c.random.up_to(surface.triangles.size - 1)];
    contacts[i].triangle_b = surface.triangles[c.random.up_to(surface.triangles.size - 1)];
    fill_figures(c, &contacts[i].from.x, 6);
  }
  job.contacts = contacts;
  job.quick = c.random.one_in(3) ? 1 : 0;
  job.scratch_words = body_penetration_scratch_words(&c.asset, &c.asset, job.contact_count);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.penetration_capacity = c.random.below(10);
  job.penetrations = c.arena.add<Penetration>(job.penetration_capacity);
  Target other = SC_TARGET_BEST;
  Ways ways;
  add_body_ways(c, c.random.one_in(2) ? job.a : job.b, ways);
  add_common_ways(c, job, other, ways);
  add_measure_ways(c, job, ways);
  ways.emplace_back([&] {
    if (job.contact_count > 0) {
      contacts[0].triangle_b = 0xFFFFFFFFU;
      c.spoil(SC_BAD_VALUE, SC_FIELD_CONTACTS);
    }
  });
  spoil_some(c, ways);
  run_measure(c, job, other);
}

void fuzz_floor(Case& c) {
  FloorJob job;
  if (!draw_body(c, job.body)) {
    return;
  }
  const sc_vec3 ups[] = {{0, 1, 0}, {0, 0, -1}, {0.6F, 0, 0.8F}};
  job.up = c.random.pick(ups);
  job.height = static_cast<float>(c.random.below(5)) - 2;
  if (c.random.one_in(2)) {
    job.terrain = [](const void*, sc_vec3 p) { return p.x > 0 ? 0.5F : NAN; };
  }
  job.scratch_words = floor_scratch_words(&c.asset);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.penetration_capacity = c.random.below(10);
  job.penetrations = c.arena.add<Penetration>(job.penetration_capacity);
  Target other = SC_TARGET_BEST;
  Ways ways;
  add_body_ways(c, job.body, ways);
  add_common_ways(c, job, other, ways);
  add_measure_ways(c, job, ways);
  ways.emplace_back([&] { job.up = {1, 1, 0}, c.spoil(SC_BAD_VALUE, SC_FIELD_FLOOR); });
  ways.emplace_back([&] { job.height = NAN, c.spoil(SC_BAD_VALUE, SC_FIELD_FLOOR); });
  spoil_some(c, ways);
  run_measure(c, job, other);
}

void fuzz_scene(Case& c) {
  SceneJob job;
  job.body_count = c.random.below(30);
  SceneBody* const bodies = c.arena.add<SceneBody>(job.body_count);
  Transform* transform = nullptr;  // of one of them
  for (std::size_t i = 0; i < job.body_count; ++i) {
    bodies[i] = {};
    bodies[i].layer = static_cast<std::uint32_t>(c.random.below(32));
    const auto x = static_cast<float>(c.random.below(20));
    bodies[i].low = {x, 0, 0};
    bodies[i].high = {x + 2, 1, 1};
    if (c.random.one_in(2)) {
      bodies[i].sphere_count = c.random.below(150);
      Sphere* const spheres = c.arena.add<Sphere>(bodies[i].sphere_count);
      fill_figures(c, &spheres->x, 4 * bodies[i].sphere_count);
      bodies[i].spheres = spheres;
    }
    if (c.random.one_in(3)) {
      transform = c.arena.add<Transform>(1);
      *transform = {{x, 1, 0}, {0, 0.6F, 0, 0.8F}, {1, 1, 1}};
      bodies[i].transform = transform;
    }
  }
  job.bodies = bodies;
  job.scratch_words = sc_scene_scratch_words(job.body_count);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.pair_capacity = c.random.below(40);
  job.pairs = c.arena.add<Pair>(job.pair_capacity);
  Ways ways = {[&] { job.scratch = nullptr, c.spoil(SC_NULL, SC_FIELD_SCRATCH); },
               [&] { --job.scratch_words, c.spoil(SC_TOO_SMALL, SC_FIELD_SCRATCH); },
               [&] { job.pairs = nullptr, job.pair_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PAIRS); },
               [&] {
                 if (job.body_count > 0) {
                   bodies[0].layer = 32;
                   c.spoil(SC_BAD_VALUE, SC_FIELD_BODIES);
                 }
               },
               [&] {
                 if (transform != nullptr) {
                   transform->rotation[c.random.below(4)] = NAN;
                   c.spoil(SC_BAD_VALUE, SC_FIELD_TRANSFORM);
                 }
               },
               [&] { job.ignored = nullptr, job.ignored_count = 1, c.spoil(SC_NULL, SC_FIELD_IGNORED); },
               [&] {
                 if (job.pair_capacity > 0 && put_over(c, job.pairs, bytes_of(job.scratch, job.scratch_words))) {
                   c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
                 }
               }};
  spoil_some(c, ways);
  Call call;
  call.run = [&] { return job.run(); };
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.pairs, std::min(job.pair_capacity, job.pair_count)),
                              bytes_of(job.scratch, job.scratch_words)};
  };
  call.tidy = [&] { std::fill_n(job.scratch, job.scratch_words, std::uint64_t{0}); };
  run_twice(c, call);
}

}  // namespace

void fuzz_bodies(Case& c) {
  if (c.random.one_in(4)) {
    return fuzz_scene(c);
  }
  if (draw_asset(c)) {
    void (*const kinds[])(Case&) = {fuzz_body_contacts, fuzz_body_penetrations, fuzz_floor};
    c.random.pick(kinds)(c);
  }
}

}  // namespace spherechain::test
