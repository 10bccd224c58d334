// SPDX-License-Identifier: MIT
// Refit, from vertices and from bones.
#include "fuzz_case.h"

namespace spherechain::test {

void fuzz_refit(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  RefitJob job;
  job.asset = &c.asset;
  job.radius = static_cast<Radius>(c.random.below(2));
  job.sphere_capacity = c.n + c.random.below(3);
  job.spheres = c.arena.add<Sphere>(job.sphere_capacity);
  Target other = SC_TARGET_BEST;
  Ways ways = {[&] { job.spheres = nullptr, c.spoil(SC_NULL, SC_FIELD_SPHERES); },
               [&] { job.sphere_capacity = c.random.up_to(c.n - 1), c.spoil(SC_TOO_SMALL, SC_FIELD_SPHERES); },
               [&] { job.radius = draw_none<Radius>(c, 2), c.spoil(SC_BAD_VALUE, SC_FIELD_RADIUS); },
               [&] { other = draw_none<Target>(c, 8), c.spoil(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET); },
               [&] { put_askew(c, job.spheres), c.spoil(SC_MISALIGNED, SC_FIELD_SPHERES); }};
  add_asset_ways(c, job.asset, ways);
  const bool has_bones = c.random.one_in(2);
  if (has_bones) {
    draw_bones(c, job.pose);
    if (c.random.one_in(2)) draw_vertices(c, job.pose);  // not looked at
    ways.emplace_back([&] {
      if (put_over(c, job.spheres, bytes_of(job.pose.bones, 12))) c.spoil(SC_ALIASED, SC_FIELD_SPHERES);
    });
    add_bone_ways(c, job.pose, ways);
  } else {
    if (!draw_vertices(c, job.pose)) return;
    ways.emplace_back([&] {
      const std::size_t floats = c.view().vertex_count() == 0 ? 0 : 3;
      if (put_over(c, job.spheres, bytes_of(job.pose.vertices, floats))) c.spoil(SC_ALIASED, SC_FIELD_SPHERES);
    });
    ways.emplace_back([&] { job.pose.vertices = nullptr, c.spoil(SC_NULL, SC_FIELD_VERTICES); });
    add_vertex_ways(c, job.pose, ways);
  }
  if (has_bones && (c.view().bone_count() == 0 || c.view().refit_rule() != RefitRule::kMoments)) {
    c.spoil(SC_NOT_IN_ASSET, SC_FIELD_BONES);
  } else {
    spoil_some(c, ways);
  }
  Call call;
  call.run = [&] {
    job.target = other == SC_TARGET_BEST ? draw_target(c) : other;
    return job.run();
  };
  call.outputs = [&] { return std::vector<Bytes>{bytes_of(job.spheres, c.n)}; };
  call.tidy = [&] { make_one_nan(&job.spheres->x, 4 * c.n); };
  run_twice(c, call);
}

}  // namespace spherechain::test
