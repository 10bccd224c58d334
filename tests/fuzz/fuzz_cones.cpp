// SPDX-License-Identifier: MIT
// Cones, against the rule of docs/arithmetic.md pair by pair.
#include <algorithm>

#include "fuzz_case.h"
#include "pairs/cone.h"
#include "pairs/pair_bits.h"

namespace spherechain::test {
namespace {

bool is_set(const std::uint64_t* words, std::size_t bit) { return (words[bit / 64] >> (bit % 64) & 1) != 0; }

// What may never be reported; scales[a * count + b] below 0.
std::vector<float> draw_scales(Case& c, const Pair* links, std::size_t count, const Filter* filter) {
  const std::uint64_t* const ignored = filter == nullptr ? c.view().ignored().data : filter->ignored;
  const auto never = [&](Pair l, Pair r) {
    bool all_ignored = true;
    for (const std::uint32_t i : {l.a, l.b}) {
      for (const std::uint32_t k : {r.a, r.b}) {
        if (i == k) return true;
        all_ignored = all_ignored && is_set(ignored, ignored_bit(std::min(i, k), std::max(i, k)));
        const bool disabled = filter != nullptr && filter->disabled_words > 0 &&
                              (is_set(filter->disabled, i) || is_set(filter->disabled, k));
        if (disabled) return true;
      }
    }
    return all_ignored;
  };
  std::vector<float> scales(count * count, -1);
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (!never(links[a], links[b])) scales[a * count + b] = 1;
    }
  }
  return scales;
}

std::vector<Pair> find(const Pair* links, std::size_t count, const Sphere* spheres, const std::vector<float>& scales) {
  std::vector<Pair> pairs;
  const auto is_whole = [&](Pair link) { return is_cone_end(spheres[link.a]) && is_cone_end(spheres[link.b]); };
  const auto cone = [&](Pair link) { return cone_of(spheres[link.a], spheres[link.b]); };
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) {
      const float scale = scales[a * count + b];
      if (scale >= 0 && is_whole(links[a]) && is_whole(links[b]) &&
          cones_touch(cone(links[a]), cone(links[b]), scale)) {
        pairs.push_back({a, b});
      }
    }
  }
  return pairs;
}

// Now and then like characters, now and then degenerate.
void fill_spheres(Case& c, Sphere* spheres) {
  fill_figures(c, &spheres->x, 4 * c.n);
  const std::size_t kind = c.random.below(4);
  for (std::size_t i = 1; i < c.n && kind > 0; ++i) {
    switch (kind == 1 ? 0 : c.random.below(8)) {
      case 0:
        spheres[i].radius = spheres[i - 1].radius;
        break;
      case 1:
        spheres[i] = spheres[i - 1];
        break;
      case 2:  // one just in the other
        spheres[i] = spheres[i - 1], spheres[i].x += 0.125F, spheres[i].radius += 0.125F;
        break;
      case 3:
        spheres[i].y = spheres[i - 1].y, spheres[i].z = spheres[i - 1].z;
        break;
      default:
        break;
    }
  }
}

}  // namespace

void fuzz_cones(Case& c) {
  if (!draw_asset(c) || c.n == 0) {
    return;
  }
  const auto n = static_cast<std::uint32_t>(c.n);
  std::size_t count = c.random.below(40);
  Pair* links = c.arena.add<Pair>(std::max<std::size_t>(count, c.n));
  if (c.random.one_in(4)) {
    count = std::min({sc_chain_links(&c.asset, links, c.n), c.n, kMaxCones});
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      links[i] = {c.random.below(n), c.random.below(n)};
    }
  }
  Filter filter;
  const Filter* const used = c.random.one_in(2) ? &filter : nullptr;
  if (used != nullptr) filter = draw_filter(c);
  const Sphere* rest = nullptr;
  if (c.random.one_in(3)) {
    Sphere* const drawn = c.arena.add<Sphere>(c.n);
    fill_spheres(c, drawn);
    rest = drawn;
  }
  const std::size_t words = sc_cone_table_words(count);
  std::uint64_t* const table = c.arena.add<std::uint64_t>(words);
  const auto prepare = [&](const Pair* own, std::size_t own_count, std::size_t size) {
    return sc_prepare_cones(&c.asset, used, own, own_count, rest, table, size);
  };
  c.expect(prepare(links, count, words - 1) == Status{SC_TOO_SMALL, SC_FIELD_TABLE}, "a table that is too small");
  c.expect(prepare(nullptr, count, words) == Status{SC_NULL, SC_FIELD_PAIRS}, "links that are null");
  if (count > 0) {
    const Pair before = links[count - 1];
    links[count - 1].b = static_cast<std::uint32_t>(c.n + c.random.below(1000000));
    c.expect(prepare(links, count, words) == Status{SC_BAD_VALUE, SC_FIELD_INDEX}, "a link to no sphere");
    links[count - 1] = before;
  }
  if (!c.expect(prepare(links, count, words) == SC_OK, "a table of cones is refused")) {
    return;
  }
  std::vector<float> scales = draw_scales(c, links, count, used);
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = a + 1; b < count; ++b) {
      float& scale = scales[a * count + b];
      if (rest == nullptr && !c.random.one_in(8)) continue;
      if (scale >= 0) scale = c.random.one_in(2) ? 1.0F : static_cast<float>(c.random.below(64)) / 32.0F;
      c.expect(sc_scale_cones(table, words, a, b, scale) == SC_OK, "a scale is refused");
    }
  }
  Sphere* const spheres = c.arena.add<Sphere>(c.n);
  fill_spheres(c, spheres);
  const std::vector<Pair> expected = find(links, count, spheres, scales);
  ConeJob job;
  job.asset = &c.asset;
  job.spheres = spheres;
  job.sphere_count = c.n + c.random.below(2);
  job.table = table;
  job.pair_capacity = draw_capacity(c, expected.size());
  job.pairs = c.arena.add<Pair>(job.pair_capacity);

  Target other = SC_TARGET_BEST;
  Ways ways = {
      [&] { job.spheres = nullptr, c.spoil(SC_NULL, SC_FIELD_SPHERES); },
      [&] { job.sphere_count = c.random.up_to(c.n - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SPHERES); },
      [&] { job.pairs = nullptr, job.pair_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PAIRS); },
      [&] { job.table = nullptr, c.spoil(SC_NULL, SC_FIELD_TABLE); },
      [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
      [&] { put_askew(c, job.spheres), c.spoil(SC_MISALIGNED, SC_FIELD_SPHERES); },
      [&] { put_askew(c, job.table), c.spoil(SC_MISALIGNED, SC_FIELD_TABLE); },
      [&] { job.pairs = c.arena.add<Pair>(9), put_askew(c, job.pairs), c.spoil(SC_MISALIGNED, SC_FIELD_PAIRS); },
      [&] {  // that it is a table, and of what
        if (job.table == table) table[c.random.below(3)] ^= 1, c.spoil(SC_BAD_VALUE, SC_FIELD_TABLE);
      },
      [&] {
        const Bytes others[] = {bytes_of(spheres, c.n), bytes_of(table, words)};
        if (job.pair_capacity > 0 && put_over(c, job.pairs, c.random.pick(others))) {
          c.spoil(SC_ALIASED, SC_FIELD_PAIRS);
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
  call.outputs = [&] { return std::vector<Bytes>{bytes_of(job.pairs, std::min(job.pair_capacity, job.pair_count))}; };
  const Status status = run_twice(c, call);
  if (status != SC_OK && status != SC_OVERFLOW) {
    c.expect(job.pair_count == 77, "a count of nothing");
    return;
  }
  const std::size_t listed = std::min(job.pair_capacity, expected.size());
  c.expect((status == SC_OVERFLOW) == (job.pair_capacity > 0 && listed < expected.size()), "overflow");
  c.expect(job.pair_count == expected.size(), "the count of pairs of cones");
  c.expect(std::equal(job.pairs, job.pairs + listed, expected.begin()), "the pairs of cones");
}

}  // namespace spherechain::test
