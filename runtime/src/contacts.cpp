// SPDX-License-Identifier: MIT
#include "spherechain/contacts.h"

#include <algorithm>
#include <cmath>

#include "arithmetic.h"
#include "memory.h"
#include "padded_radius.h"

namespace spherechain {
namespace {

constexpr float kBallVolume = 4.18879F;      // 4 pi / 3
constexpr float kLensVolume = 0.261799F;     // pi / 12
constexpr float kSmallestDistance = 1e-19F;  // its square is still a normal float

Sphere sphere_at(const ContactJob& job, std::uint32_t i) {
  Sphere sphere = job.spheres[i];
  if (job.filter != nullptr && job.filter->padding.size > 0) {
    sphere.radius = padded_radius(sphere.radius, job.filter->padding[i]);
  }
  return sphere;
}

float lens_volume(float ra, float rb, float d, float depth) {
  const float q = ra - rb;
  if (depth <= 0.0F) {
    return 0.0F;
  }
  if (d <= std::abs(q)) {
    const float r = std::min(ra, rb);
    return kBallVolume * (r * r * r);
  }
  return (kLensVolume * (depth * depth)) * ((d * d + (2.0F * d) * (ra + rb)) - (3.0F * q) * q) / d;
}

Contact contact_of(const ContactJob& job, const Pair& pair) {
  const Sphere a = sphere_at(job, pair.a);
  const Sphere b = sphere_at(job, pair.b);
  const Vec3 e{b.x - a.x, b.y - a.y, b.z - a.z};
  const float d = std::sqrt((e.x * e.x + e.y * e.y) + e.z * e.z);
  Contact contact{};
  contact.pair = pair;
  contact.depth = (a.radius + b.radius) - d;
  contact.severity = lens_volume(a.radius, b.radius, d, contact.depth);
  contact.normal = d < kSmallestDistance ? Vec3{1.0F, 0.0F, 0.0F} : Vec3{e.x / d, e.y / d, e.z / d};
  const float t = 0.5F * (std::max(-a.radius, d - b.radius) + std::min(a.radius, d + b.radius));
  contact.point = {a.x + t * contact.normal.x, a.y + t * contact.normal.y, a.z + t * contact.normal.z};
  const RestSphere& rest_a = job.asset->spheres()[pair.a];
  const RestSphere& rest_b = job.asset->spheres()[pair.b];
  contact.triangles_a = {rest_a.first_triangle, rest_a.triangle_count};
  contact.triangles_b = {rest_b.first_triangle, rest_b.triangle_count};
  return contact;
}

bool shares_memory(const ContactJob& job) {
  const MemoryRange written[] = {range_of(job.contacts)};
  const MemoryRange read[] = {range_of(job.spheres), range_of(job.pairs), range_of(job.asset->spheres()),
                              job.filter == nullptr ? MemoryRange{} : range_of(job.filter->padding)};
  return any_shared(written, read);
}

Status check(const ContactJob& job) {
  if (job.asset == nullptr || job.spheres.data == nullptr || is_missing(job.pairs) || is_missing(job.contacts)) {
    return Status::kNullArgument;
  }
  if (!job.asset->is_open()) {
    return Status::kNotOpen;
  }
  if (any_misaligned(job.spheres.data, job.pairs.data, job.contacts.data)) {
    return Status::kMisaligned;
  }
  const std::size_t n = job.asset->spheres().size;
  if (job.spheres.size < n) {
    return Status::kTooFewSpheres;
  }
  if (job.filter != nullptr) {
    const Status status = check_filter(*job.asset, *job.filter);
    if (status != Status::kOk) {
      return status;
    }
  }
  for (const Pair& pair : job.pairs) {
    if (pair.a >= pair.b || pair.b >= n) {
      return Status::kBadArgument;
    }
  }
  return shares_memory(job) ? Status::kSharedMemory : Status::kOk;
}

}  // namespace

Status ContactJob::run() noexcept {
  const Status status = check(*this);
  if (status != Status::kOk) {
    return status;
  }
  float greatest = 0.0F;
  deepest = pairs.size;
  for (std::size_t i = 0; i < pairs.size; ++i) {
    const Contact contact = contact_of(*this, pairs[i]);
    if (contact.depth > greatest) {
      greatest = contact.depth;
      deepest = i;
    }
    if (i < contacts.size) {
      contacts[i] = contact;
    }
  }
  contact_count = pairs.size;
  return contacts.size > 0 && contacts.size < pairs.size ? Status::kOverflow : Status::kOk;
}

}  // namespace spherechain
