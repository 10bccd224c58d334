// SPDX-License-Identifier: MIT
#include "spherechain/refit.h"

#include <cmath>

#include "arithmetic.h"
#include "memory.h"
#include "stride.h"

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

float radius_of(const RestSphere& rest, float mean, RefitRule rule, RadiusKind kind) {
  if (rule != RefitRule::kPaper) {
    return (kind == RadiusKind::kFit ? rest.radius : rest.detect_radius) * (mean / rest.pivot_spread);
  }
  return kind == RadiusKind::kFit ? mean : mean * (rest.detect_radius / rest.radius);
}

// Do the spheres lie on top of the positions that are read?
bool shares_memory(const RefitJob& job, std::size_t vertices) {
  const auto first = reinterpret_cast<std::uintptr_t>(job.positions);
  const MemoryRange positions{first, vertices == 0 ? first : first + (vertices - 1) * job.stride + 3 * sizeof(float)};
  return any_shared({range_of(Span<Sphere>{job.spheres.data, job.asset->spheres().size})}, {positions});
}

}  // namespace

Status RefitJob::run() const noexcept {
  if (asset == nullptr || positions == nullptr || spheres.data == nullptr) {
    return Status::kNullArgument;
  }
  if (!asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(positions, spheres.data)) {
    return Status::kMisaligned;
  }
  if ((radius != RadiusKind::kFit && radius != RadiusKind::kDetect) ||
      (vertices != VertexSet::kSource && vertices != VertexSet::kPivots)) {
    return Status::kBadArgument;
  }
  if (!is_valid_stride(stride)) {
    return Status::kBadStride;
  }
  const bool packed = vertices == VertexSet::kPivots;
  if (packed && asset->packed_pivots().size == 0) {
    return Status::kNotInAsset;
  }
  const std::size_t wanted = packed ? asset->pivot_vertices().size : asset->info().source_vertex_count;
  if (vertex_count < wanted) {
    return Status::kTooFewVertices;
  }
  const Span<const RestSphere> rest = asset->spheres();
  if (spheres.size < rest.size) {
    return Status::kTooFewSpheres;
  }
  if (shares_memory(*this, wanted)) {
    return Status::kSharedMemory;
  }

  const VertexBuffer buffer{positions, stride};
  const Pivot* pivots = (packed ? asset->packed_pivots() : asset->pivots()).data;
  const RefitRule rule = asset->refit_rule();
  for (std::size_t i = 0; i < rest.size; ++i) {
    const Span<const Pivot> own{pivots + rest[i].first_pivot, rest[i].pivot_count};
    Sphere sphere = rule == RefitRule::kMoments ? mean_sphere<true>(buffer, own) : mean_sphere<false>(buffer, own);
    sphere.radius = radius_of(rest[i], sphere.radius, rule, radius);
    spheres[i] = sphere;
  }
  return Status::kOk;
}

}  // namespace spherechain
