// SPDX-License-Identifier: MIT
// Which bodies of a scene may meet: boxes sorted along an axis and swept, then their spheres.
#include <algorithm>
#include <cfloat>
#include <cmath>

#include "runtime/src/base/least_entries.h"
#include "runtime/src/base/memory.h"
#include "runtime/src/base/sized.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pairs/filter.h"
#include "runtime/src/pose/transform.h"
#include "spherechain/crowd.h"

namespace spherechain {

SPHERECHAIN_LAST_FIELD(sc_scene_job, pair_count);

namespace {

constexpr std::size_t kBodiesMax = std::size_t{1} << 24, kLayers = 32;
constexpr std::size_t kAtATime = 64;  // spheres of one side
constexpr float kRounding = 0x1p-20F;

// A body's, along the axis that is swept and the two others.
struct SweptBox {
  float low[3], high[3];
  std::uint32_t body;
};

struct WorldBox {
  Vec3 low, high;
};

// A body where it is in the scene.
class PlacedBody {
 public:
  explicit PlacedBody(const SceneBody& body) : body_(body) {
    if (body.transform == nullptr) {
      return;
    }
    const Affine place = affine_of(*body.transform);
    for (std::size_t i = 0; i < 12; ++i) {
      place_[i] = static_cast<float>(place.m[i / 4][i % 4]);
    }
    const Vec3& scale = body.transform->scale;
    stretch_ = std::max({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)});
  }

  bool has_spheres() const { return body_.spheres != nullptr; }
  std::size_t sphere_count() const { return body_.sphere_count; }
  Sphere sphere(std::size_t i) const {
    const Sphere& s = body_.spheres[i];
    if (body_.transform == nullptr) {
      return s;
    }
    const auto row = [&](const float* m) { return ((m[0] * s.x + m[1] * s.y) + m[2] * s.z) + m[3]; };
    return {row(place_), row(place_ + 4), row(place_ + 8), stretch_ * s.radius};
  }
  // Around the spheres that can touch something: wider by more than a sphere's sides, or a sum of squares, are rounded.
  WorldBox box() const { return has_spheres() ? box_of_spheres() : box_of_corners(); }

 private:
  WorldBox box_of_spheres() const {
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (std::size_t i = 0; i < body_.sphere_count; ++i) {
      const Sphere s = sphere(i);
      const float at[3] = {s.x, s.y, s.z}, reach = s.radius * (1 + kRounding);
      for (std::size_t k = 0; k < 3; ++k) {
        const float from = at[k] - reach, to = at[k] + reach;
        low[k] = from < low[k] && s.radius >= 0 ? from : low[k];
        high[k] = to > high[k] && s.radius >= 0 ? to : high[k];
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] -= kRounding * std::abs(low[k]);
      high[k] += kRounding * std::abs(high[k]);
    }
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }
  // Around the box, as it was given or moved.
  WorldBox box_of_corners() const {
    if (body_.transform == nullptr) {
      return {body_.low, body_.high};
    }
    const float from[3] = {body_.low.x, body_.low.y, body_.low.z}, to[3] = {body_.high.x, body_.high.y, body_.high.z};
    float low[3], high[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const float* const m = place_ + 4 * k;
      float size = std::abs(m[3]);
      low[k] = high[k] = m[3];
      for (std::size_t i = 0; i < 3; ++i) {
        low[k] += std::min(m[i] * from[i], m[i] * to[i]);
        high[k] += std::max(m[i] * from[i], m[i] * to[i]);
        size += std::max(std::abs(m[i] * from[i]), std::abs(m[i] * to[i]));
      }
      low[k] -= kRounding * size;
      high[k] += kRounding * size;
    }
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }

  const SceneBody& body_;
  float place_[12] = {}, stretch_ = 1;
};

// Spheres by coordinates.
struct SphereList {
  std::size_t count = 0;
  float x[kAtATime], y[kAtATime], z[kAtATime], radius[kAtATime];

  // Adds a body's spheres that reach into the box, from `first` on, until the memory is full. Returns the sphere at
  // which it stopped.
  std::size_t fill(const PlacedBody& body, std::size_t first, const WorldBox& box) {
    count = 0;
    for (; first < body.sphere_count() && count < kAtATime; ++first) {
      const Sphere s = body.sphere(first);
      x[count] = s.x;
      y[count] = s.y;
      z[count] = s.z;
      radius[count] = s.radius;
      // Without && the compiler makes no branches of it.
      const bool is_in = (s.radius >= 0) & (s.x - s.radius <= box.high.x) & (s.x + s.radius >= box.low.x) &
                         (s.y - s.radius <= box.high.y) & (s.y + s.radius >= box.low.y) &
                         (s.z - s.radius <= box.high.z) & (s.z + s.radius >= box.low.z);
      count += is_in ? 1 : 0;
    }
    return first;
  }
  // docs/arithmetic.md, "Detection": no pair is a rest pair.
  bool touches(const SphereList& other, std::size_t i) const {
    const float at_x = other.x[i], at_y = other.y[i], at_z = other.z[i], reach = other.radius[i];
    int any = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const float dx = at_x - x[k], dy = at_y - y[k], dz = at_z - z[k];
      const float d2 = (dx * dx + dy * dy) + dz * dz, s = reach + radius[k];
      any |= static_cast<int>(d2 < s * s) & static_cast<int>(s * s <= FLT_MAX);
    }
    return any != 0;
  }
};

bool spheres_meet(const PlacedBody& a, const WorldBox& box_a, const PlacedBody& b, const WorldBox& box_b) {
  SphereList of_a, of_b;
  for (std::size_t i = 0; i < a.sphere_count();) {
    i = of_a.fill(a, i, box_b);
    for (std::size_t j = 0; j < b.sphere_count() && of_a.count > 0;) {
      j = of_b.fill(b, j, box_a);
      for (std::size_t k = 0; k < of_a.count; ++k) {
        if (of_b.touches(of_a, k)) {
          return true;
        }
      }
    }
  }
  return false;
}

class Finder {
 public:
  Finder(const SceneJob& job, SweptBox* boxes) : job_(job), boxes_(boxes), pairs_({job.pairs, job.pair_capacity}) {}

  Status run(std::size_t& found) {
    sort();
    const SweptBox* const end = boxes_ + job_.body_count;
    for (const SweptBox* one = boxes_; one != end; ++one) {
      for (const SweptBox* other = one + 1; other != end && other->low[0] <= one->high[0]; ++other) {
        if (one->low[1] <= other->high[1] && other->low[1] <= one->high[1] && one->low[2] <= other->high[2] &&
            other->low[2] <= one->high[2]) {
          decide(*one, *other);
        }
      }
    }
    pairs_.finish();
    found = pairs_.count();
    return pairs_.overflowed() ? refuse(SC_OVERFLOW, SC_FIELD_PAIRS) : done();
  }

 private:
  // Along the axis on which the bodies' middles are spread farthest.
  void sort() {
    double sums[3] = {}, squares[3] = {};
    for (std::size_t i = 0; i < job_.body_count; ++i) {
      const WorldBox box = PlacedBody(job_.bodies[i]).box();
      boxes_[i] = {
          {box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}, static_cast<std::uint32_t>(i)};
      for (std::size_t k = 0; k < 3; ++k) {
        const double middle = 0.5 * (double{boxes_[i].low[k]} + double{boxes_[i].high[k]});
        sums[k] += middle;
        squares[k] += middle * middle;
      }
    }
    const auto spread = [&](std::size_t k) {
      return squares[k] - sums[k] * sums[k] / static_cast<double>(job_.body_count);
    };
    const std::size_t last = spread(2) > spread(1) ? 2 : 1;
    axis_ = spread(last) > spread(0) ? last : 0;
    for (std::size_t i = 0; i < job_.body_count; ++i) {
      std::swap(boxes_[i].low[0], boxes_[i].low[axis_]);
      std::swap(boxes_[i].high[0], boxes_[i].high[axis_]);
    }
    std::sort(boxes_, boxes_ + job_.body_count, [](const SweptBox& l, const SweptBox& r) {
      return l.low[0] < r.low[0] || (l.low[0] == r.low[0] && l.body < r.body);
    });
  }

  // With x, y and z in their places again.
  WorldBox box_in(const SweptBox& swept) const {
    SweptBox out = swept;
    std::swap(out.low[0], out.low[axis_]);
    std::swap(out.high[0], out.high[axis_]);
    return {{out.low[0], out.low[1], out.low[2]}, {out.high[0], out.high[1], out.high[2]}};
  }

  void decide(const SweptBox& one, const SweptBox& other) {
    const SweptBox &first = one.body < other.body ? one : other, &second = one.body < other.body ? other : one;
    const Pair pair{first.body, second.body};
    const SceneBody &a = job_.bodies[pair.a], &b = job_.bodies[pair.b];
    if (job_.layers != nullptr && (job_.layers[a.layer] >> b.layer & 1) == 0) {
      return;
    }
    if (std::binary_search(job_.ignored, job_.ignored + job_.ignored_count, pair,
                           [](const Pair& l, const Pair& r) { return l < r; })) {
      return;
    }
    if (a.spheres == nullptr || b.spheres == nullptr ||
        spheres_meet(PlacedBody(a), box_in(first), PlacedBody(b), box_in(second))) {
      pairs_.add(pair);
    }
  }

  const SceneJob& job_;
  SweptBox* boxes_;
  std::size_t axis_ = 0;  // that is swept: its sides are the boxes' first
  LeastEntries<Pair> pairs_;
};

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Status check_bodies(const SceneJob& job) {
  for (std::size_t i = 0; i < job.body_count; ++i) {
    const SceneBody& body = job.bodies[i];
    const Status spheres = check_list(body.spheres, body.sphere_count, SC_FIELD_SPHERES);
    if (spheres != SC_OK) {
      return spheres;
    }
    if (any_misaligned(body.transform)) {
      return refuse(SC_MISALIGNED, SC_FIELD_TRANSFORM);
    }
    if (body.transform != nullptr && !is_sound(*body.transform)) {
      return refuse(SC_BAD_VALUE, SC_FIELD_TRANSFORM);
    }
    const bool has_box = body.spheres != nullptr || (is_finite(body.low) && is_finite(body.high));
    if (body.layer >= kLayers || !has_box) {
      return refuse(SC_BAD_VALUE, SC_FIELD_BODIES);
    }
  }
  for (std::size_t i = 0; i < job.ignored_count; ++i) {
    const Pair& pair = job.ignored[i];
    if (pair.a >= pair.b || pair.b >= job.body_count || (i > 0 && !(job.ignored[i - 1] < pair))) {
      return refuse(SC_BAD_VALUE, SC_FIELD_IGNORED);
    }
  }
  for (std::size_t l = 0; job.layers != nullptr && l < kLayers; ++l) {
    for (std::size_t k = 0; k < l; ++k) {
      if ((job.layers[l] >> k & 1) != (job.layers[k] >> l & 1)) {
        return refuse(SC_BAD_VALUE, SC_FIELD_LAYERS);
      }
    }
  }
  return done();
}

bool is_aliased(const SceneJob& job) {
  const MemoryRange pairs = range_of(Span<Pair>{job.pairs, job.pair_capacity});
  const MemoryRange scratch = range_of(Span<std::uint64_t>{job.scratch, sc_scene_scratch_words(job.body_count)});
  bool shared = any_shared({pairs, scratch},
                           {range_of(Span<const SceneBody>{job.bodies, job.body_count}),
                            range_of(Span<const std::uint32_t>{job.layers, job.layers == nullptr ? 0 : kLayers}),
                            range_of(Span<const Pair>{job.ignored, job.ignored_count})});
  for (std::size_t i = 0; i < job.body_count; ++i) {
    const MemoryRange spheres = range_of(Span<const Sphere>{job.bodies[i].spheres, job.bodies[i].sphere_count});
    const MemoryRange transform =
        range_of(Span<const Transform>{job.bodies[i].transform, std::size_t{job.bodies[i].transform != nullptr}});
    shared |= any_shared({pairs, scratch}, {spheres, transform});
  }
  return shared;
}

Status check(const SceneJob& job) {
  if (job.body_count > kBodiesMax) {
    return refuse(SC_BAD_VALUE, SC_FIELD_BODIES);
  }
  const Status statuses[] = {
      check_list(job.bodies, job.body_count, SC_FIELD_BODIES), check_list(job.layers, 0, SC_FIELD_LAYERS),
      check_list(job.ignored, job.ignored_count, SC_FIELD_IGNORED), check_list(job.scratch, 1, SC_FIELD_SCRATCH),
      check_list(job.pairs, job.pair_capacity, SC_FIELD_PAIRS)};
  for (const Status& status : statuses) {
    if (status != SC_OK) {
      return status;
    }
  }
  if (job.scratch_words < sc_scene_scratch_words(job.body_count)) {
    return refuse(SC_TOO_SMALL, SC_FIELD_SCRATCH);
  }
  const Status bodies = check_bodies(job);
  return bodies == SC_OK && is_aliased(job) ? refuse(SC_ALIASED, SC_FIELD_OUTPUT) : bodies;
}

}  // namespace
}  // namespace spherechain

using namespace spherechain;

extern "C" {

size_t sc_scene_scratch_words(size_t body_count) noexcept {
  return body_count > kBodiesMax ? 0 : 1 + (body_count * sizeof(SweptBox) + 7) / 8;
}

sc_status sc_find_meetings(sc_scene_job* given) noexcept {
  if (given == nullptr) {
    return refuse(SC_NULL, SC_FIELD_NONE);
  }
  sc_scene_job job{};
  Status status = read_struct(given, job);
  status = status == SC_OK ? check(job) : status;
  return status == SC_OK ? Finder(job, reinterpret_cast<SweptBox*>(job.scratch)).run(given->pair_count) : status;
}

}  // extern "C"
