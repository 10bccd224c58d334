// SPDX-License-Identifier: MIT
// The measure of skin contacts: of those that there are, and of any that name triangles of the skin.
#include <algorithm>
#include <cmath>

#include "fuzz_case.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kMaxContacts = 60, kMaxScratch = std::size_t{1} << 18;

// Takes contacts of the pose, or any triangles with any segments.
void draw_contacts(Case& c, PenetrationJob& job, const Surface& surface) {
  TriangleContact* const contacts = c.arena.add<TriangleContact>(job.contact_count);
  job.contacts = contacts;
  if (c.random.one_in(2)) {
    std::vector<std::uint64_t> scratch(skin_scratch_words(&c.asset));
    SkinContactJob find;
    find.asset = job.asset;
    find.pose = job.pose;
    find.skin_table = job.skin_table;
    find.scratch = scratch.data();
    find.scratch_words = scratch.size();
    find.scope = job.scope;
    find.triangles = contacts;
    find.triangle_capacity = job.contact_count;
    find.run();
    job.contact_count = std::min(find.triangle_count, job.contact_count);
    return;
  }
  for (std::size_t i = 0; i < job.contact_count; ++i) {
    contacts[i].triangle_a = surface.triangles[c.random.up_to(surface.triangles.size - 1)];
    contacts[i].triangle_b = surface.triangles[c.random.up_to(surface.triangles.size - 1)];
    fill_figures(c, &contacts[i].from.x, 6);
  }
}

Ways ways_of(Case& c, PenetrationJob& job, Target& other) {
  const std::size_t words = job.scratch_words;
  Ways ways = {
      [&] { job.skin_table = nullptr, c.spoil(SC_NULL, SC_FIELD_SKIN_TABLE); },
      [&] { job.scratch = nullptr, c.spoil(SC_NULL, SC_FIELD_SCRATCH); },
      [&, words] { job.scratch_words = c.random.up_to(words - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SCRATCH); },
      [&] { job.penetrations = nullptr, job.penetration_capacity = 1, c.spoil(SC_NULL, SC_FIELD_PENETRATIONS); },
      [&] { job.previous = nullptr, job.previous_count = 1, c.spoil(SC_NULL, SC_FIELD_PREVIOUS); },
      [&] { job.rule = &bad_rule(), c.spoil(SC_BAD_VALUE, SC_FIELD_RULE); },
      [&] { job.scope = draw_none<Scope>(c, 4), c.spoil(SC_BAD_VALUE, SC_FIELD_SCOPE); },
      [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
      [&] {
        if (job.contact_count > 0) {
          const_cast<TriangleContact*>(job.contacts)->triangle_b = 0xFFFFFFFFU;
          c.spoil(SC_BAD_VALUE, SC_FIELD_CONTACTS);
        }
      },
      [&] {
        if (job.penetration_capacity > 0 && put_over(c, job.penetrations, bytes_of(job.scratch, job.scratch_words))) {
          c.spoil(SC_ALIASED, SC_FIELD_OUTPUT);
        }
      }};
  add_asset_ways(c, job.asset, ways);
  return ways;
}

}  // namespace

const Rule& bad_rule() {
  static const Rule rule = [] {
    Rule out = sc_default_rule();
    out.fold_depth = NAN;
    return out;
  }();
  return rule;
}

void make_comparable(Penetration& one) {
  make_one_nan(&one.direction.x, 13);
  make_one_nan(&one.measures.depth, 11);
  for (SkinPoint* point : {&one.deepest, &one.deepest_other}) {
    make_one_nan(&point->position.x, 3);
    make_one_nan(point->weights, 3);
  }
}

void fuzz_penetrations(Case& c) {
  const std::size_t table_words = draw_asset(c) ? skin_table_words(&c.asset) : 0;
  if (table_words == 0 || table_words > kMaxScratch ||
      penetration_scratch_words(&c.asset, kMaxContacts) > kMaxScratch) {
    return;
  }
  PenetrationJob job;
  job.asset = &c.asset;
  if (c.view().bone_count() > 0 && c.random.one_in(2)) {
    draw_bones(c, job.pose);
  } else if (!draw_vertices(c, job.pose)) {
    return;
  }
  std::uint64_t* const table = c.arena.add<std::uint64_t>(table_words);
  c.expect(prepare_skin(&c.asset, table, table_words) == SC_OK, "a skin table is refused");
  job.skin_table = table;
  Surface surface;
  c.expect(read_skin_table(c.view(), table, surface) == SC_OK, "a skin table is not read");
  job.scope = static_cast<Scope>(c.random.below(4));
  job.quick = c.random.one_in(3) ? 1 : 0;
  job.contact_count = c.random.below(kMaxContacts);
  draw_contacts(c, job, surface);
  Penetration* const previous = c.arena.add<Penetration>(4);
  for (std::size_t i = 0; i < 4; ++i) {
    previous[i] = {};
    previous[i].part = static_cast<std::uint32_t>(c.random.below(3));
    previous[i].other = static_cast<std::uint32_t>(c.random.below(3));
    previous[i].kind = SC_CLASS_PENETRATION;
    fill_figures(c, &previous[i].direction.x, 3);
  }
  job.previous = previous;
  job.previous_count = 4;
  job.scratch_words = penetration_scratch_words(&c.asset, job.contact_count);
  job.scratch = c.arena.add<std::uint64_t>(job.scratch_words);
  job.penetration_capacity = c.random.below(10);
  job.penetrations = c.arena.add<Penetration>(job.penetration_capacity);
  Target other = SC_TARGET_BEST;
  spoil_some(c, ways_of(c, job, other));

  Call call;
  call.run = [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
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

}  // namespace spherechain::test
