// SPDX-License-Identifier: MIT
// Leaves' balls and the surface's vertices from bones.
#include "fuzz_bones.h"
#include "spherechain/cover.h"
#include "spherechain/skin.h"

namespace spherechain::test {
namespace {

void spoil_cover(Case& c, CoverJob& job, sc_cover_job& c_job, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
      job.leaves.data = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 1:
      job.leaves.size = c.random.up_to(c.asset.leaf_count() - 1);
      return spoiled.with(Status::kTooFewSpheres);
    case 2:
      put_askew(c, job.leaves.data);
      return spoiled.with(Status::kMisaligned);
    case 3:
      job.spheres = {nullptr, c.n};
      return spoiled.with(Status::kNullArgument);
    case 4:
      put_over(c, job.leaves.data, bytes_of(job.bones.data, 12));
      return spoiled.with(Status::kSharedMemory);
    case 5:
      job.spheres = {job.leaves.data, c.n};
      return spoiled.with(Status::kSharedMemory);
    default:
      spoil_bone_inputs(c, job, c_job, way - 6, spoiled);
  }
}

void spoil_skin(Case& c, SkinJob& job, sc_skin_job& c_job, std::uint32_t way, Spoiled& spoiled) {
  switch (way) {
    case 0:
      job.positions = nullptr;
      return spoiled.with(Status::kNullArgument);
    case 1:
      job.vertex_count = c.random.up_to(c.asset.info().source_vertex_count - 1);
      return spoiled.with(Status::kTooFewVertices);
    case 2:
      put_askew(c, job.positions);
      return spoiled.with(Status::kMisaligned);
    case 3: {
      const std::size_t strides[] = {0, 4, 8, 11, 13, 18, ~std::size_t{0}};
      job.stride = c.random.pick(strides);
      return spoiled.with(Status::kBadStride);
    }
    case 4:
      put_over(c, job.positions, bytes_of(job.bones.data, 12));
      return spoiled.with(Status::kSharedMemory);
    default:
      spoil_bone_inputs(c, job, c_job, way - 5, spoiled);
  }
}

// False where the asset drawn has no surface or no bones, after which the call is expected to say so.
bool has_surface(const Case& c, Spoiled& spoiled) {
  const bool is_there = c.asset.bone_count() > 0 && c.asset.leaf_count() > 0;
  if (!is_there) {
    spoiled.with(Status::kNotInAsset);
  }
  return is_there;
}

}  // namespace

void fuzz_cover(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  CoverJob job;
  Spoiled spoiled;
  draw_bone_inputs(c, job);
  const bool is_there = has_surface(c, spoiled);
  job.leaves.size = c.asset.leaf_count() + c.random.below(3);
  job.leaves.data = c.arena.add<Sphere>(job.leaves.size);
  if (c.random.one_in(2)) {
    job.spheres.size = c.n + c.random.below(3);
    job.spheres.data = c.arena.add<Sphere>(job.spheres.size);
  }
  sc_cover_job c_job = SC_COVER_JOB_INIT;
  choose_bone_inputs(c, job, c_job);
  if (is_there) {
    spoil_some(c, 6 + kBoneWays, [&](std::uint32_t way) { spoil_cover(c, job, c_job, way, spoiled); });
  }
  copy_bone_inputs(job, c_job);
  c_job.leaves = reinterpret_cast<sc_sphere*>(job.leaves.data);
  c_job.leaf_count = job.leaves.size;
  c_job.spheres = reinterpret_cast<sc_sphere*>(job.spheres.data);
  c_job.sphere_count = job.spheres.size;
  const std::size_t spheres = job.spheres.size > 0 ? c.n : 0;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_cover(&c_job); },
      [&](Status) {
        return std::vector<Bytes>{bytes_of(job.leaves.data, c.asset.leaf_count()), bytes_of(job.spheres.data, spheres)};
      },
      [&](bool ran) {
        if (ran) {
          make_one_nan(&job.leaves.data->x, 4 * c.asset.leaf_count());
        }
        if (ran && spheres > 0) {
          make_one_nan(&job.spheres.data->x, 4 * spheres);
        }
      });
}

void fuzz_skin(Case& c) {
  if (!draw_asset(c)) {
    return;
  }
  const std::size_t needed = c.asset.info().source_vertex_count;
  if (needed == 0 || needed > kMostVertices) {
    return;
  }
  SkinJob job;
  Spoiled spoiled;
  draw_bone_inputs(c, job);
  const bool is_there = has_surface(c, spoiled);
  job.stride = 12 + 4 * (c.random.one_in(2) ? 0 : c.random.below(8));
  job.vertex_count = needed + c.random.below(2);
  const std::size_t floats = (job.vertex_count - 1) * job.stride / sizeof(float) + 3;
  float* const positions = c.arena.add<float>(floats);
  fill_figures(c, positions, floats);
  job.positions = positions;
  sc_skin_job c_job = SC_SKIN_JOB_INIT;
  choose_bone_inputs(c, job, c_job);
  if (is_there) {
    spoil_some(c, 5 + kBoneWays, [&](std::uint32_t way) { spoil_skin(c, job, c_job, way, spoiled); });
  }
  copy_bone_inputs(job, c_job);
  c_job.positions = job.positions;
  c_job.vertex_count = job.vertex_count;
  c_job.stride = job.stride;
  run_both(
      c, spoiled, [&] { return job.run(); }, [&] { return sc_skin(&c_job); },
      [&](Status) { return std::vector<Bytes>{bytes_of(positions, floats)}; },
      [&](bool ran) {
        if (ran) {
          make_one_nan(positions, floats);
        }
      },
      false);  // not those that move as another does
}

}  // namespace spherechain::test
