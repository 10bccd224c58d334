// SPDX-License-Identifier: MIT
// Detection, against the rule of docs/arithmetic.md pair by pair.
#include <algorithm>
#include <cfloat>

#include "fuzz_case.h"

namespace spherechain::test {
namespace {

std::vector<Pair> find(const Case& c, const Sphere* spheres, Radius radius, const Filter* filter) {
  const auto is_set = [](const std::uint64_t* words, std::size_t bit) {
    return (words[bit / 64] >> (bit % 64) & 1) != 0;
  };
  std::vector<float> scales(c.n * c.n, -1.0F);
  for (const RestPair& pair : c.view().rest_pairs(radius)) scales[pair.a * c.n + pair.b] = pair.rest_scale;
  const std::uint64_t* const ignored = filter == nullptr ? c.view().ignored().data : filter->ignored;
  std::vector<Pair> pairs;
  for (std::uint32_t a = 0; a < c.n; ++a) {
    for (std::uint32_t b = a + 1; b < c.n; ++b) {
      if (is_set(ignored, std::size_t{b} * (b - 1) / 2 + a)) continue;
      const Sphere &p = spheres[a], &q = spheres[b];
      const float x = p.x - q.x, y = p.y - q.y, z = p.z - q.z, s = p.radius + q.radius;
      const float d2 = (x * x + y * y) + z * z, scale = scales[a * c.n + b], t = scale * s;
      if (d2 < s * s && s * s <= FLT_MAX && (scale < 0.0F || d2 < t * t)) pairs.push_back({a, b});
    }
  }
  return pairs;
}

}  // namespace

void fuzz_detect(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  DetectJob job;
  job.asset = &c.asset;
  job.radius = static_cast<Radius>(c.random.below(2));
  Sphere* const spheres = c.arena.add<Sphere>(c.n);
  fill_figures(c, &spheres->x, 4 * c.n);
  job.spheres = spheres;
  job.sphere_count = c.n + c.random.below(2);
  Filter filter;
  const Filter* const used = c.random.one_in(2) ? &filter : nullptr;
  if (used != nullptr) filter = draw_filter(c);
  const std::vector<Pair> expected = find(c, spheres, job.radius, used);
  const std::size_t table_words = detect_table_words(&c.asset);
  std::uint64_t* const table = c.arena.add<std::uint64_t>(table_words);
  if (c.random.one_in(2)) {
    c.expect(prepare_detect(&c.asset, job.radius, used, table, table_words) == SC_OK, "a table is refused");
    job.table = table;
  } else {
    job.filter = used;
  }
  const std::size_t words = sc_pair_words(&c.asset);
  job.pair_capacity = draw_capacity(c, expected.size());
  job.pairs = c.arena.add<Pair>(job.pair_capacity);
  job.bit_words = c.random.one_in(2) ? words : 0;
  job.bits = c.arena.add<std::uint64_t>(job.bit_words);

  Target other = SC_TARGET_BEST;
  Ways ways = {
      [&] { job.spheres = nullptr, c.spoil(SC_NULL, SC_FIELD_SPHERES); },
      [&] { job.sphere_count = c.random.up_to(c.n - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SPHERES); },
      [&] { job.pairs = nullptr, job.pair_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PAIRS); },
      [&] { job.bits = nullptr, job.bit_words = words + 1, c.spoil(SC_NULL, SC_FIELD_BITS); },
      [&] {
        job.bits = c.arena.add<std::uint64_t>(1), job.bit_words = words + 1, c.spoil(SC_BAD_VALUE, SC_FIELD_BITS);
      },
      [&] { job.radius = draw_none<Radius>(c, 2), c.spoil(SC_BAD_VALUE, SC_FIELD_RADIUS); },
      [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
      [&] { put_askew(c, job.spheres), c.spoil(SC_MISALIGNED, SC_FIELD_SPHERES); },
      [&] { job.pairs = c.arena.add<Pair>(9), put_askew(c, job.pairs), c.spoil(SC_MISALIGNED, SC_FIELD_PAIRS); },
      [&] {
        if (job.pair_capacity > 0 && put_over(c, job.pairs, bytes_of(spheres, c.n)))
          c.spoil(SC_ALIASED, SC_FIELD_PAIRS);
      },
      [&] {
        const Bytes others[] = {bytes_of(spheres, c.n), bytes_of(job.table, job.table == nullptr ? 0 : table_words)};
        if (job.bit_words > 0 && put_over(c, job.bits, c.random.pick(others))) {
          c.spoil(SC_ALIASED, job.pair_capacity > 0 ? SC_FIELD_PAIRS : SC_FIELD_BITS);
        }
      },
      [&] {
        if (job.table == nullptr) {
          if (used == nullptr) filter = draw_filter(c);
          job.filter = &filter;
          return spoil_filter(c, filter);
        }
        switch (c.random.below(3)) {
          case 0:
            put_askew(c, job.table);
            return c.spoil(SC_MISALIGNED, SC_FIELD_TABLE);
          case 1:  // what it is of
            table[c.random.below(4)] ^= 1;
            return c.spoil(SC_BAD_VALUE, SC_FIELD_TABLE);
          default:
            job.filter = &filter;
            return c.spoil(SC_BAD_VALUE, SC_FIELD_IGNORED_PAIRS);
        }
      }};
  add_asset_ways(c, job.asset, ways);
  spoil_some(c, ways);
  job.pair_count = 77;
  Call call;
  call.run = [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
  call.outputs = [&] {
    return std::vector<Bytes>{bytes_of(job.pairs, std::min(job.pair_capacity, job.pair_count)),
                              bytes_of(job.bits, job.bit_words)};
  };
  const Status status = run_twice(c, call);
  if (status != SC_OK && status != SC_OVERFLOW) {
    c.expect(job.pair_count == 77, "a count of nothing");
    return;
  }
  const std::size_t there_are = expected.size(), listed = std::min(job.pair_capacity, there_are);
  c.expect((status == SC_OVERFLOW) == (job.pair_capacity > 0 && listed < there_are), "overflow");
  c.expect(job.pair_count == there_are, "the count of pairs");
  c.expect(std::equal(job.pairs, job.pairs + listed, expected.begin()), "the pairs");
  std::vector<std::uint64_t> bits(job.bit_words);
  for (const Pair& pair : expected) {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    if (job.bit_words > 0) bits[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  c.expect(std::equal(bits.begin(), bits.end(), job.bits), "the bits");
}

}  // namespace spherechain::test
