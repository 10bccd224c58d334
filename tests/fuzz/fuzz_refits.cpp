// SPDX-License-Identifier: MIT
// Refit from vertices and from bones.
#include <cstring>

#include "fuzz_bones.h"
#include "spherechain/refit.h"
#include "spherechain/refit_bones.h"

namespace spherechain::test {
namespace {

void spoil_refit(Case& c, RefitJob& job, sc_refit_job& c_job, std::size_t needed, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
    case 1:
      return spoil_asset(c, job, c_job, way, spoiled);
    case 2:
      job.positions = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 3:
      job.spheres.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 4:
      if (needed > 0) {
        job.vertex_count = c.random.one_in(2) ? needed - 1 : 0;
        spoiled.with(Status::kTooFewVertices);
      }
      return;
    case 5:
      job.spheres.size = c.random.one_in(2) ? c.n - 1 : 0;
      return spoiled.with(Status::kTooFewSpheres);
    case 6: {
      const std::size_t strides[] = {0, 4, 8, 11, 13, 14, 18, ~std::size_t{0}, ~std::size_t{0} - 1};
      job.stride = c.random.pick(strides);
      return spoiled.with(Status::kBadStride);
    }
    case 7:
      job.radius = draw_none<RadiusKind>(c, 2);
      c_job.radius = draw_c_none(c, 2);
      return spoiled.with(Status::kBadArgument);
    case 8:
      job.vertices = draw_none<VertexSet>(c, 2);
      c_job.vertices = draw_c_none(c, 2);
      return spoiled.with(Status::kBadArgument);
    case 9:
      put_askew(c, job.positions);
      return spoiled.with(Status::kMisaligned);
    case 10:
      put_askew(c, job.spheres.data);
      return spoiled.with(Status::kMisaligned);
    default:
      if (needed > 0) {
        put_over(c, job.spheres.data, bytes_of(job.positions, 3));
        spoiled.with(Status::kSharedMemory);
      }
  }
}

void spoil_refit_bones(Case& c, RefitBonesJob& job, sc_refit_bones_job& c_job, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
      job.spheres.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 1:
      job.spheres.size = c.random.up_to(c.n - 1);
      return spoiled.with(Status::kTooFewSpheres);
    case 2:
      job.radius = draw_none<RadiusKind>(c, 2);
      c_job.radius = draw_c_none(c, 2);
      return spoiled.with(Status::kBadArgument);
    case 3:
      put_askew(c, job.spheres.data);
      return spoiled.with(Status::kMisaligned);
    case 4:
      put_over(c, job.spheres.data, bytes_of(job.bones.data, 12));
      return spoiled.with(Status::kSharedMemory);
    default:
      spoil_bone_inputs(c, job, c_job, way - 5, spoiled);
  }
}

}  // namespace

void fuzz_refit(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  RefitJob job;
  job.asset = &c.asset;
  job.vertices = static_cast<VertexSet>(c.random.below(2));
  job.radius = static_cast<RadiusKind>(c.random.below(2));
  job.stride = 12 + 4 * (c.random.one_in(2) ? 0 : c.random.below(8));
  const bool packed = job.vertices == VertexSet::kPivots;
  const std::size_t needed = packed ? c.asset.pivot_vertices().size : c.asset.info().source_vertex_count;
  if (needed > kMostVertices) {
    return;
  }
  job.vertex_count = needed + c.random.below(2);
  const std::size_t floats = job.vertex_count == 0 ? 0 : (job.vertex_count - 1) * job.stride / sizeof(float) + 3;
  float* positions = c.arena.add<float>(floats);
  fill_figures(c, positions, floats);
  job.positions = positions;
  job.spheres.size = c.n + c.random.below(3);
  job.spheres.data = c.arena.add<Sphere>(job.spheres.size);

  sc_refit_job c_job = SC_REFIT_JOB_INIT;
  c_job.asset = c.c_asset;
  c_job.vertices = static_cast<sc_vertex_set>(job.vertices);
  c_job.radius = static_cast<sc_radius>(job.radius);
  Spoiled spoiled;
  if (packed && c.asset.packed_pivots().size == 0) {
    spoiled.with(Status::kNotInAsset);
  } else {
    spoil_some(c, 12, [&](std::uint32_t way) { spoil_refit(c, job, c_job, needed, way, spoiled); });
  }
  c_job.positions = job.positions;
  c_job.vertex_count = job.vertex_count;
  c_job.stride = job.stride;
  c_job.spheres = reinterpret_cast<sc_sphere*>(job.spheres.data);
  c_job.sphere_count = job.spheres.size;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_refit(&c_job); },
      [&](Status) { return std::vector<Bytes>{bytes_of(job.spheres.data, c.n)}; }, [](bool) {});
}

void fuzz_refit_bones(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  RefitBonesJob job;
  draw_bone_inputs(c, job);
  job.radius = static_cast<RadiusKind>(c.random.below(2));
  job.spheres.size = c.n + c.random.below(3);
  job.spheres.data = c.arena.add<Sphere>(job.spheres.size);

  sc_refit_bones_job c_job = SC_REFIT_BONES_JOB_INIT;
  choose_bone_inputs(c, job, c_job);
  c_job.radius = static_cast<sc_radius>(job.radius);
  Spoiled spoiled;
  if (c.asset.bone_count() == 0) {
    spoiled.with(Status::kNotInAsset);
  } else {
    spoil_some(c, 5 + kBoneWays, [&](std::uint32_t way) { spoil_refit_bones(c, job, c_job, way, spoiled); });
  }
  copy_bone_inputs(job, c_job);
  c_job.spheres = reinterpret_cast<sc_sphere*>(job.spheres.data);
  c_job.sphere_count = job.spheres.size;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_refit_bones(&c_job); },
      [&](Status) { return std::vector<Bytes>{bytes_of(job.spheres.data, c.n)}; },
      [&](bool ran) {
        if (ran) {
          make_one_nan(&job.spheres.data->x, 4 * c.n);
        }
      });
}

}  // namespace spherechain::test
