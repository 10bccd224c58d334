// SPDX-License-Identifier: MIT
// Skin contacts: from vertices against all pairs of triangles, from bones on two targets.
#include <algorithm>
#include <map>

#include "fuzz_case.h"
#include "runtime/src/pose/pose.h"
#include "runtime/src/skin/left_out.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kMaxTested = 300;  // triangles: of more, all pairs take too long
constexpr std::size_t kMaxWords = std::size_t{1} << 17;

struct Triangle {
  std::uint32_t number, sphere, part, cluster;
  std::uint32_t welds[3];
  TriangleCorners corners;
};

std::vector<Triangle> triangles_of(const Surface& surface, const Pose& pose) {
  std::vector<Triangle> triangles;
  for (std::uint32_t c = 0; c < surface.clusters.size; ++c) {
    const Cluster& cluster = surface.clusters[c];
    for (std::size_t i = cluster.first_triangle; i < cluster.first_triangle + cluster.triangle_count; ++i) {
      Triangle t{surface.triangles[i], cluster.sphere, surface.parts[i], c, {}, {}};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = surface.cluster_vertices[cluster.first_vertex + surface.corners[3 * i + k]];
        const float* const p = pose.vertices + surface.source_vertices[vertex] * (vertex_stride(pose) / sizeof(float));
        t.welds[k] = surface.welds[vertex];
        t.corners.p[k] = {p[0], p[1], p[2]};
      }
      triangles.push_back(t);
    }
  }
  return triangles;
}

// Is this pair of spheres asked about?
bool is_asked(const Case& c, const SkinContactJob& job, std::uint32_t p, std::uint32_t q) {
  const std::uint32_t a = std::min(p, q), b = std::max(p, q);
  if (job.candidates != nullptr) {
    return std::binary_search(job.candidates, job.candidates + job.candidate_count, Pair{a, b});
  }
  const auto is_set = [](const std::uint64_t* words, std::size_t bit) {
    return (words[bit / 64] >> (bit % 64) & 1) != 0;
  };
  const Filter* const f = job.filter;
  const std::uint64_t* const ignored = f == nullptr ? c.view().ignored().data : f->ignored;
  const bool are_neighbours = a == b || is_set(ignored, std::size_t{b} * (b - 1) / 2 + a);
  return job.scope == SC_SCOPE_ALL || are_neighbours == (job.scope == SC_SCOPE_NEIGHBOURS);
}

std::map<Pair, std::pair<Triangle, Triangle>> all_contacts(const Case& c, const SkinContactJob& job,
                                                           const Surface& surface) {
  const std::vector<Triangle> triangles = triangles_of(surface, job.pose);
  std::map<Pair, std::pair<Triangle, Triangle>> found;
  for (const Triangle& a : triangles) {
    for (const Triangle& b : triangles) {
      const Pair pair{a.number, b.number};
      if (a.number >= b.number || !is_asked(c, job, a.sphere, b.sphere)) continue;
      const bool is_hidden = is_buried(surface, a.cluster) || is_buried(surface, b.cluster);
      if (job.scope == SC_SCOPE_APART && (is_hidden || are_layers(surface, a.cluster, b.cluster))) continue;
      const bool are_neighbours = std::any_of(a.welds, a.welds + 3, [&](std::uint32_t weld) {
        return std::find(b.welds, b.welds + 3, weld) != b.welds + 3;
      });
      const auto& rest = surface.rest_contacts;
      if (!are_neighbours && !std::binary_search(rest.begin(), rest.end(), pair) &&
          triangles_intersect(a.corners, b.corners)) {
        found.insert({pair, {a, b}});
      }
    }
  }
  return found;
}

void check_contacts(Case& c, const SkinContactJob& job, const Surface& surface) {
  std::vector<TriangleContact> triangles;
  std::map<Pair, std::uint32_t> parts, spheres;
  for (const auto& [pair, contact] : all_contacts(c, job, surface)) {
    const auto& [a, b] = contact;
    triangles.push_back({a.number, b.number, a.sphere, b.sphere, a.part, b.part, {}, {}});
    ++parts[{std::min(a.part, b.part), std::max(a.part, b.part)}];
    ++spheres[{std::min(a.sphere, b.sphere), std::max(a.sphere, b.sphere)}];
  }
  c.expect(job.sphere_count == spheres.size(), "the count of pairs of spheres");
  auto sphere = spheres.begin();
  for (std::size_t i = 0; i < std::min(job.sphere_capacity, spheres.size()); ++i, ++sphere) {
    c.expect(job.spheres[i] == sphere->first, "a pair of spheres");
  }
  if (job.spheres_only != 0) {
    return;
  }
  c.expect(job.triangle_count == triangles.size() && job.part_count == parts.size(), "the counts");
  for (std::size_t i = 0; i < std::min(job.triangle_capacity, triangles.size()); ++i) {
    const TriangleContact &l = job.triangles[i], &r = triangles[i];
    c.expect(l.triangle_a == r.triangle_a && l.triangle_b == r.triangle_b && l.sphere_a == r.sphere_a &&
                 l.sphere_b == r.sphere_b && l.part_a == r.part_a && l.part_b == r.part_b,
             "a triangle contact");
  }
  auto part = parts.begin();
  for (std::size_t i = 0; i < std::min(job.part_capacity, parts.size()); ++i, ++part) {
    const PartContact& contact = job.parts[i];
    c.expect(Pair{contact.part_a, contact.part_b} == part->first && contact.triangle_pairs == part->second,
             "a contact of parts");
  }
}

void draw_question(Case& c, SkinContactJob& job, Filter& filter) {
  job.spheres_only = c.random.one_in(4) ? 1 : 0;
  if (c.n > 1 && c.random.one_in(3)) {
    std::vector<Pair> pairs;
    for (std::size_t i = c.random.below(40); i > 0; --i) {
      const std::size_t b = c.random.up_to(c.n - 1);  // a pair of one sphere asks about its own triangles
      pairs.push_back({static_cast<std::uint32_t>(c.random.up_to(b)), static_cast<std::uint32_t>(b)});
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    Pair* const candidates = c.arena.add<Pair>(pairs.size());
    std::copy(pairs.begin(), pairs.end(), candidates);
    job.candidates = candidates;
    job.candidate_count = pairs.size();
    return;
  }
  job.scope = static_cast<Scope>(c.random.below(4));
  if (c.random.one_in(2)) {
    filter = draw_filter(c);
    job.filter = &filter;
  }
}

Ways ways_of(Case& c, SkinContactJob& job, Filter& filter, Target& other) {
  const std::size_t words = job.scratch_words;
  Ways ways = {[&] { job.skin_table = nullptr, c.spoil(SC_NULL, SC_FIELD_SKIN_TABLE); },
               [&] { put_askew(c, job.skin_table), c.spoil(SC_MISALIGNED, SC_FIELD_SKIN_TABLE); },
               [&] {
                 // Another way may have moved it off its alignment, or taken it.
                 const std::size_t byte = sizeof(std::uint64_t) * c.random.below(2);
                 auto* const bytes = reinterpret_cast<unsigned char*>(const_cast<std::uint64_t*>(job.skin_table));
                 if (bytes != nullptr) bytes[byte] ^= 1;
                 c.spoil(SC_BAD_VALUE, SC_FIELD_SKIN_TABLE);
               },
               [&] { job.scratch = nullptr, c.spoil(SC_NULL, SC_FIELD_SCRATCH); },
               [&, words] { job.scratch_words = c.random.up_to(words - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SCRATCH); },
               [&] { job.parts = nullptr, job.part_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PARTS); },
               [&] { job.spheres = nullptr, job.sphere_capacity = 1, c.spoil(SC_NULL, SC_FIELD_SPHERES); },
               [&] {
                 job.triangles = c.arena.add<TriangleContact>(9);
                 put_askew(c, job.triangles);
                 c.spoil(SC_MISALIGNED, SC_FIELD_TRIANGLES);
               },
               [&] { job.scope = draw_none<Scope>(c, 4), c.spoil(SC_BAD_VALUE, SC_FIELD_SCOPE); },
               [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
               [&] {
                 if (job.candidates != nullptr) {
                   job.filter = &filter;
                   filter = draw_filter(c);
                   return c.spoil(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS);
                 }
                 if (job.filter == nullptr) filter = draw_filter(c);
                 job.filter = &filter;
                 spoil_filter(c, filter);
               },
               [&] {
                 const auto n = static_cast<std::uint32_t>(c.n);
                 const Pair bad[] = {{0, n}, {n, n + 1}, {n, n}, {1, 0}, {0xFFFFFFFFU, 0xFFFFFFFFU}, {0, 0xFFFFFFFFU}};
                 Pair* const candidates = c.arena.add<Pair>(1);
                 *candidates = c.random.pick(bad);
                 job.candidates = candidates;
                 job.candidate_count = 1;
                 c.spoil(SC_BAD_VALUE, SC_FIELD_CANDIDATES);
               },
               [&] { job.candidates = nullptr, job.candidate_count = 1, c.spoil(SC_NULL, SC_FIELD_CANDIDATES); },
               [&] {
                 if (job.sphere_capacity > 0 && put_over(c, job.spheres, bytes_of(job.scratch, job.scratch_words))) {
                   c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
                 }
               }};
  add_asset_ways(c, job.asset, ways);
  if (job.pose.bones != nullptr) {
    add_bone_ways(c, job.pose, ways);
  } else {
    add_vertex_ways(c, job.pose, ways);
    ways.emplace_back([&] { job.pose.vertices = nullptr, c.spoil(SC_NULL, SC_FIELD_BONES); });
  }
  return ways;
}

}  // namespace

void fuzz_contacts(Case& c) {
  const std::size_t table_words = draw_asset(c) ? skin_table_words(&c.asset) : 0;
  if (table_words == 0 || table_words > kMaxWords || skin_scratch_words(&c.asset) > kMaxWords) {
    return;
  }
  SkinContactJob job;
  job.asset = &c.asset;
  const bool has_bones = c.view().bone_count() > 0 && c.random.one_in(2);
  if (has_bones) {
    draw_bones(c, job.pose);
  } else if (!draw_vertices(c, job.pose)) {
    return;
  }
  std::uint64_t* const table = c.arena.add<std::uint64_t>(table_words);
  c.expect(prepare_skin(&c.asset, table, table_words) == SC_OK, "a skin table is refused");
  job.skin_table = table;
  Surface surface;
  c.expect(read_skin_table(c.view(), table, surface) == SC_OK, "a skin table is not read");
  Filter filter;
  draw_question(c, job, filter);
  job.scratch_words = skin_scratch_words(&c.asset);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.sphere_capacity = c.random.below(30);
  job.spheres = c.arena.add<Pair>(job.sphere_capacity);
  job.part_capacity = c.random.below(20);
  job.parts = c.arena.add<PartContact>(job.part_capacity);
  job.triangle_capacity = c.random.below(300);
  job.triangles = c.arena.add<TriangleContact>(job.triangle_capacity);
  Target other = SC_TARGET_BEST;
  spoil_some(c, ways_of(c, job, filter, other));

  Call call;
  call.run = [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.parts, std::min(job.part_capacity, job.part_count)),
                              bytes_of(job.spheres, std::min(job.sphere_capacity, job.sphere_count)),
                              bytes_of(job.triangles, std::min(job.triangle_capacity, job.triangle_count)),
                              bytes_of(job.scratch, job.scratch_words)};
  };
  call.tidy = [&] { std::fill_n(job.scratch, job.scratch_words, std::uint64_t{0}); };
  const Status status = run_twice(c, call);
  const bool ran = status == SC_OK || status == SC_OVERFLOW;
  if (ran && !has_bones && surface.triangles.size <= kMaxTested) {
    check_contacts(c, job, surface);
  }
}

}  // namespace spherechain::test
