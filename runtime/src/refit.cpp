// SPDX-License-Identifier: MIT
#include "spherechain/refit.h"

#include <cmath>

#include "arithmetic.h"
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

Vec3 center_of(const VertexBuffer& vertices, Span<const Pivot> pivots) {
  Vec3 center{0.0F, 0.0F, 0.0F};
  for (const Pivot& pivot : pivots) {
    const Vec3 p = centroid(vertices, pivot);
    center.x += pivot.weight * p.x;
    center.y += pivot.weight * p.y;
    center.z += pivot.weight * p.z;
  }
  return center;
}

// Works the centroids out a second time: a sphere may have any number of pivots, and there is no memory to keep them
// in.
float mean_distance(const VertexBuffer& vertices, Span<const Pivot> pivots, const Vec3& center) {
  float sum = 0.0F;
  for (const Pivot& pivot : pivots) {
    const Vec3 p = centroid(vertices, pivot);
    const float dx = p.x - center.x;
    const float dy = p.y - center.y;
    const float dz = p.z - center.z;
    sum += std::sqrt((dx * dx + dy * dy) + dz * dz);
  }
  return sum / static_cast<float>(pivots.size);
}

float radius_of(const RestSphere& rest, float mean, RefitRule rule, RadiusKind kind) {
  if (rule == RefitRule::kCalibrated) {
    return (kind == RadiusKind::kFit ? rest.radius : rest.detect_radius) * (mean / rest.pivot_spread);
  }
  return kind == RadiusKind::kFit ? mean : mean * (rest.detect_radius / rest.radius);
}

}  // namespace

Status RefitJob::run() const noexcept {
  if (asset == nullptr || positions == nullptr || spheres.data == nullptr) {
    return Status::kNullArgument;
  }
  if (!asset->is_open()) {
    return Status::kNotOpen;
  }
  if (radius != RadiusKind::kFit && radius != RadiusKind::kDetect) {
    return Status::kBadArgument;
  }
  if (!is_valid_stride(stride)) {
    return Status::kBadStride;
  }
  const AssetInfo info = asset->info();
  if (vertex_count < info.source_vertex_count) {
    return Status::kTooFewVertices;
  }
  const Span<const RestSphere> rest = asset->spheres();
  if (spheres.size < rest.size) {
    return Status::kTooFewSpheres;
  }

  const VertexBuffer vertices{positions, stride};
  for (std::size_t i = 0; i < rest.size; ++i) {
    const Span<const Pivot> pivots{asset->pivots().data + rest[i].first_pivot, rest[i].pivot_count};
    const Vec3 center = center_of(vertices, pivots);
    const float mean = mean_distance(vertices, pivots, center);
    spheres[i] = {center.x, center.y, center.z, radius_of(rest[i], mean, info.refit, radius)};
  }
  return Status::kOk;
}

}  // namespace spherechain
