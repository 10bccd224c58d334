// SPDX-License-Identifier: MIT
// Spheres from bones (refit/moments_kernel.cpp), or from the pivots' deformed corners.
#include "runtime/src/refit/refit_job.h"

#include <cmath>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/status.h"
#include "runtime/src/refit/inputs.h"
#include "runtime/src/simd/simd.h"

namespace spherechain {
namespace {

struct VertexBuffer {
  const float* positions;
  std::size_t stride;

  const float* operator[](std::size_t index) const { return vertex_at(positions, index, stride); }
};

Vec3 centroid(const VertexBuffer& vertices, const Pivot& pivot) {
  constexpr float kThird = 1.0F / 3.0F;
  const float* a = vertices[pivot.a];
  const float* b = vertices[pivot.b];
  const float* c = vertices[pivot.c];
  return {((a[0] + b[0]) + c[0]) * kThird, ((a[1] + b[1]) + c[1]) * kThird, ((a[2] + b[2]) + c[2]) * kThird};
}

// Centre, and in place of the radius the pivots' mean distance from it, or the root of the mean of its square.
template <bool kSquared>
Sphere mean_sphere(const VertexBuffer& vertices, Span<const Pivot> pivots) {
  // A sphere may have any number of pivots; of more than this the centroids are worked out twice.
  constexpr std::size_t kKept = 16;
  Vec3 kept[kKept];
  const bool keeps = pivots.size <= kKept;
  Sphere sphere{0.0F, 0.0F, 0.0F, 0.0F};
  for (std::size_t k = 0; k < pivots.size; ++k) {
    const Vec3 p = centroid(vertices, pivots[k]);
    if (keeps) {
      kept[k] = p;
    }
    sphere.x += pivots[k].weight * p.x;
    sphere.y += pivots[k].weight * p.y;
    sphere.z += pivots[k].weight * p.z;
  }
  float sum = 0.0F;
  for (std::size_t k = 0; k < pivots.size; ++k) {
    const Vec3 p = keeps ? kept[k] : centroid(vertices, pivots[k]);
    const float dx = p.x - sphere.x;
    const float dy = p.y - sphere.y;
    const float dz = p.z - sphere.z;
    const float squared = (dx * dx + dy * dy) + dz * dz;
    sum += kSquared ? squared : std::sqrt(squared);
  }
  const float mean = sum / static_cast<float>(pivots.size);
  sphere.radius = kSquared ? std::sqrt(mean) : mean;
  return sphere;
}

float radius_of(const RestSphere& rest, float mean, RefitRule rule, Radius radius) {
  if (rule != RefitRule::kPaper) {
    return (radius == SC_RADIUS_FIT ? rest.radius : rest.detect_radius) * (mean / rest.pivot_spread);
  }
  return radius == SC_RADIUS_FIT ? mean : mean * (rest.detect_radius / rest.radius);
}

void refit_from_vertices(const AssetView& asset, const Pose& pose, Radius radius, Sphere* spheres) {
  const VertexBuffer buffer{pose.vertices, vertex_stride(pose)};
  const Span<const RestSphere> rest = asset.spheres();
  const RefitRule rule = asset.refit_rule();
  for (std::size_t i = 0; i < rest.size; ++i) {
    const Span<const Pivot> own{asset.pivots().data + rest[i].first_pivot, rest[i].pivot_count};
    Sphere sphere = rule == RefitRule::kMoments ? mean_sphere<true>(buffer, own) : mean_sphere<false>(buffer, own);
    sphere.radius = radius_of(rest[i], sphere.radius, rule, radius);
    spheres[i] = sphere;
  }
}

Status check(const RefitJob& job, Target& resolved) {
  if (job.asset == nullptr) {
    return refuse(SC_NULL, SC_FIELD_ASSET);
  }
  const AssetView& asset = view_of(*job.asset);
  if (!asset.is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_ASSET);
  }
  const bool has_bones = job.pose.bones != nullptr;
  const Status status = has_bones ? check_refit_bones(asset, job.pose, job.radius) : check_vertices(asset, job.pose);
  if (status != SC_OK) {
    return status;
  }
  const MemoryRange read = has_bones ? range_of_bones(asset, job.pose) : range_of_vertices(asset, job.pose);
  if (has_bones) {
    fetch(read);
  }
  if (!is_radius(job.radius)) {
    return refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
  }
  if (job.spheres == nullptr) {
    return refuse(SC_NULL, SC_FIELD_SPHERES);
  }
  if (any_misaligned(job.spheres)) {
    return refuse(SC_MISALIGNED, SC_FIELD_SPHERES);
  }
  if (job.sphere_capacity < asset.spheres().size) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SPHERES);
  }
  if (!resolve_target(job.target, resolved)) {
    return refuse(SC_UNSUPPORTED_TARGET, SC_FIELD_TARGET);
  }
  return any_shared({range_of(Span<Sphere>{job.spheres, asset.spheres().size})}, {read})
             ? refuse(SC_ALIASED, SC_FIELD_SPHERES)
             : done();
}

}  // namespace

Status check_refit_bones(const AssetView& asset, const Pose& pose, Radius radius) {
  const Status status = check_bones(asset, pose);
  if (status != SC_OK) {
    return status;
  }
  if (asset.refit_rule() != RefitRule::kMoments) {
    return refuse(SC_NOT_IN_ASSET, SC_FIELD_BONES);
  }
  return is_radius(radius) ? done() : refuse(SC_BAD_VALUE, SC_FIELD_RADIUS);
}

RefitInputs refit_inputs(const AssetView& asset, const Pose& pose, Radius radius) {
  RefitInputs in{};
  in.rest = asset.spheres().data;
  in.sphere_count = asset.spheres().size;
  in.bone_count = asset.bone_count();
  in.moments = &asset.moment_tables();
  in.matrices = pose.bones;
  in.stride = bone_stride(pose) / sizeof(float);
  in.layout = pose.bone_layout;
  in.radius = radius;
  return in;
}

Status RefitJob::run() const noexcept {
  Target resolved{};
  const Status status = check(*this, resolved);
  if (status != SC_OK) {
    return status;
  }
  const AssetView& view = view_of(*asset);
  if (pose.bones != nullptr) {
    refit_from_moments(refit_inputs(view, pose, radius), resolved, spheres);
  } else {
    refit_from_vertices(view, pose, radius, spheres);
  }
  return done();
}

}  // namespace spherechain
